"""Groups of options that several commands have: each is parsed as one, and checked at once."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import wraps
from typing import Any


def taking(
    name: str, parse: Callable[..., Any]
) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Make a decorator that gives a command a group of options in place of one parameter.

    Parameters
    ----------
    name : str
        The parameter of the command.
    parse : callable
        Its parameters are the options; what it returns becomes the parameter.

    Returns
    -------
    callable
        The decorator of commands as typer sees them, or of other groups; several can follow each
        other. An option that the command has itself, under the same name, is not taken from the
        group.

    Examples
    --------
    >>> def parse(words: str = "", count: int = 0) -> dict:
    ...     return {"words": words, "count": count}
    >>> @taking("table", parse)
    ... def run(path: str, table: dict) -> None:
    ...     print(path, table)
    >>> run(path="a.csv", count=2)
    a.csv {'words': '', 'count': 2}
    """
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
