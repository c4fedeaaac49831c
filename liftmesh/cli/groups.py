"""Groups of options that several commands have: each is parsed as one, and checked at once."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from typing import Any


def taking(
    name: str, parse: Callable[..., Any]
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Make a decorator that gives a command a group of options in place of one parameter."""
    options = inspect.signature(parse, eval_str=True).parameters

    def decorate(run: Callable[..., Any]) -> Callable[..., Any]:
        parameters: list[inspect.Parameter] = []
        signature = inspect.signature(run, eval_str=True)
        own = signature.parameters.keys() - {name}
        taken = {k: option for k, option in options.items() if k not in own}
        for each in signature.parameters.values():
            parameters += taken.values() if each.name == name else [each]

        @wraps(run)
        def command(**values: Any) -> Any:
            given = {key: values.pop(key) for key in taken if key in values}
            return run(**values, **{name: parse(**given)})

        command.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
        command.__annotations__ = {each.name: each.annotation for each in parameters}
        return command

    return decorate
