"""The values of options, converted from text without pydantic.

Some versions of typer convert values with pydantic, whose import and schemas take longer than most
commands. The options here have a handful of simple types, and those are converted by themselves:
typer asks each parameter by `get_runtime_param` for what converts its value. A parameter of another
type, or of a typer that is made otherwise, is left as it is.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin

import typer

from liftmesh.cli.python_options import as_on_command_line
from liftmesh.errors import InputError


@contextmanager
def checked() -> Iterator[None]:
    """Tell what the library refuses of the values of options as wrong usage."""
    try:
        yield
    except InputError as error:
        raise typer.BadParameter(as_on_command_line(str(error))) from error


def convert_simply(parameters: list[Any]) -> list[Any]:
    """Let parameters of simple types convert their values themselves."""
    for each in parameters:
        kind = getattr(getattr(each, "type_descriptor", None), "annotation", None)
        if hasattr(each, "get_runtime_param") and _is_simple(_wanted(kind)):
            each.get_runtime_param = partial(_Conversion, _wanted(kind))
    return parameters


class _Conversion:
    """What typer calls for a value of the type."""

    def __init__(self, kind: Any) -> None:
        self.kind = kind

    def coerce(self, value: Any, param: Any, ctx: Any) -> Any:
        """Convert the value of a parameter, or the values of one that may have several."""
        if param.multiple or isinstance(value, list | tuple):
            return [self._one(each, param, ctx) for each in value or ()]
        return self._one(value, param, ctx)

    def _one(self, value: Any, param: Any, ctx: Any) -> Any:
        if not isinstance(value, str):
            return value
        try:
            return _converted(self.kind, value)
        except ValueError as error:
            raise typer.BadParameter(f"{value!r} is no such value", ctx=ctx, param=param) from error


def _wanted(kind: Any) -> Any:
    """Return the type of one value: X of ``X | None`` and of ``list[X]``."""
    if get_origin(kind) in (UnionType, Union):
        kinds = [each for each in get_args(kind) if each is not NoneType]
        return _wanted(kinds[0]) if len(kinds) == 1 else kind
    return get_args(kind)[0] if get_origin(kind) is list else kind


def _is_simple(kind: Any) -> bool:
    return kind in (str, int, bool, Path) or get_origin(kind) is Literal


def _converted(kind: Any, text: str) -> Any:
    if kind is bool or (get_origin(kind) is Literal and text not in get_args(kind)):
        raise ValueError(text)  # a flag takes no text
    return text if get_origin(kind) is Literal else kind(text)
