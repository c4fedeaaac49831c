"""Signatures that `help` shows with one parameter in a line, as it does itself from Python 3.13 on.

Otherwise a signature is one line of up to 500 characters, with every type in quotation marks. The
parameters and their types are the same for all programs that read them.
"""

from __future__ import annotations

import inspect
from typing import Any

_WIDTH = 72


class _Unquoted(str):
    """An annotation as it stands in the source."""

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)


class Readable(inspect.Signature):
    """A signature whose text has one parameter in a line if it is long.

    Examples
    --------
    >>> def move(points: list, *, by: float = 1.0) -> None: ...
    >>> print(Readable.from_callable(move))
    (points: list, *, by: float = 1.0) -> None
    """

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
    """Give a function, or the public methods of a class, a signature that `help` shows well.

    Parameters
    ----------
    value : object
        Others stay as they are.

    Examples
    --------
    >>> make_readable(make_readable)
    >>> print(inspect.signature(make_readable))
    (value: Any) -> None
    """
    if inspect.isclass(value):
        for name, member in vars(value).items():
            if inspect.isfunction(member) and not name.startswith("_"):
                make_readable(member)
    elif inspect.isfunction(value):
        value.__signature__ = Readable.from_callable(value)  # type: ignore[attr-defined]
