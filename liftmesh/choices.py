"""Options with a fixed set of values: the values of each, and their check."""

from __future__ import annotations

from typing import Any, Literal, TypeAlias

from liftmesh.errors import InputError

Method: TypeAlias = Literal["auto", "divide-and-conquer", "lf", "lfres", "lfres-indexed"]
HullMethod: TypeAlias = Literal["auto", "lf"]
NonFinite: TypeAlias = Literal["error", "skip"]
RowOrder: TypeAlias = Literal["engine", "canonical"]
PlyEncoding: TypeAlias = Literal["binary", "ascii"]
PlyColors: TypeAlias = Literal["uint8", "exact"]
ObjColors: TypeAlias = Literal["values", "comments", "none"]
Duplicates: TypeAlias = Literal["first", "last", "lowest", "highest", "mean", "error"]


def check_option(name: str, value: object, words: Any) -> None:
    """Raise unless an option has one of its allowed values.

    Parameters
    ----------
    name : str
        The option's name, for the message.
    value : object
        The value given.
    words : typing.Literal
        The allowed values.

    Raises
    ------
    InputError
        The value is not allowed; the message lists those that are.

    Examples
    --------
    >>> check_option("nonfinite", "drop", NonFinite)
    Traceback (most recent call last):
    liftmesh.errors.InputError: nonfinite is 'drop': give one of 'error', 'skip'
    """
    known = words.__args__  # what get_args returns, without its checks
    if not isinstance(value, str) or value not in known:
        raise InputError(f"{name} is {value!r}: give one of {', '.join(map(repr, known))}")
