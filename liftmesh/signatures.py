"""Signatures that `help` shows with one parameter in a line, as it does itself from Python 3.13 on.

Otherwise a signature is one line of up to 500 characters, with every type in quotation marks. The
parameters and their types are the same for all programs that read them.
"""

from __future__ import annotations

import inspect
from typing import Any

_WIDTH = 72
_PACKAGE = __name__.partition(".")[0]


class _Unquoted(str):
    """An annotation as it stands in the source."""

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)


class Readable(inspect.Signature):
    """A signature whose text has one parameter in a line if it is long."""

    __slots__ = ()

    def __str__(self) -> str:
        returns = self.return_annotation
        parts, end = self._parts(), ""
        if returns is not inspect.Signature.empty:
            end = f" -> {inspect.formatannotation(_unquoted(returns))}"
        line = f"({', '.join(parts)}){end}"
        if len(line) <= _WIDTH:
            return line
        return "(\n" + "".join(f"    {part},\n" for part in parts) + f"){end}"

    def _parts(self) -> list[str]:
        parts: list[str] = []
        kinds = inspect.Parameter
        before: Any = None
        for each in self.parameters.values():
            if before is kinds.POSITIONAL_ONLY and each.kind is not before:
                parts.append("/")
            starred = {kinds.KEYWORD_ONLY, kinds.VAR_POSITIONAL}
            if each.kind is kinds.KEYWORD_ONLY and before not in starred:
                parts.append("*")
            parts.append(str(each.replace(annotation=_unquoted(each.annotation))))
            before = each.kind
        return parts


def _unquoted(annotation: Any) -> Any:
    return _Unquoted(annotation) if isinstance(annotation, str) else annotation


def make_readable(value: Any) -> None:
    """Give a function, or a class and its public methods, signatures that `help` shows well."""
    if inspect.isclass(value):
        for kind in value.__mro__:
            if kind.__module__.partition(".")[0] == _PACKAGE:
                _make_methods_readable(kind)
    elif inspect.isfunction(value):
        value.__signature__ = Readable.from_callable(value)  # type: ignore[attr-defined]


def _make_methods_readable(kind: type) -> None:
    for name, member in vars(kind).items():
        function = getattr(member, "__func__", member)  # of a class method
        if inspect.isfunction(function) and (name == "__init__" or not name.startswith("_")):
            make_readable(function)
