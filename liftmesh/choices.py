"""Options and their checks: the values of those with a fixed set, switches, and callbacks."""

from __future__ import annotations

import operator
import os
from contextlib import suppress
from reprlib import Repr
from typing import Any, Literal, TypeAlias

from liftmesh.errors import InputError

_LONGEST = 64  # characters of a value in a message
_REPR = Repr()  # of a list it shows the first few, and looks at no others
_REPR.maxstring = _REPR.maxother = _LONGEST

Method: TypeAlias = Literal["auto", "divide-and-conquer", "lf", "lfres", "lfres-indexed"]
HullMethod: TypeAlias = Literal["auto", "lf"]
NonFinite: TypeAlias = Literal["error", "skip"]
RowOrder: TypeAlias = Literal["engine", "canonical"]
PlyEncoding: TypeAlias = Literal["binary", "ascii"]
PlyColors: TypeAlias = Literal["uint8", "exact"]
ObjColors: TypeAlias = Literal["values", "comments", "none"]
CellRow: TypeAlias = Literal["lowest", "highest", "center"]
GroundMethod: TypeAlias = Literal["csf"]
Unit3MF: TypeAlias = Literal["micron", "millimeter", "centimeter", "inch", "foot", "meter"]
SampleMethod: TypeAlias = Literal["linear", "nearest", "laplace", "sibson"]
Pinched: TypeAlias = Literal["error", "trim"]
RasterQuantity: TypeAlias = Literal["height", "slope", "aspect", "hillshade"]
Returns: TypeAlias = Literal["first", "last", "only"]
ShardFormat: TypeAlias = Literal["npy", "parquet", "ply"]
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
        raise InputError(f"{name} is {shown(value)}: give one of {', '.join(map(repr, known))}")


def as_switch(name: str, value: object) -> bool:
    """Convert an option that is true or false.

    Parameters
    ----------
    name : str
        The option's name, for the message.
    value : object
        The value given: a bool, also NumPy's, or 0 or 1.

    Returns
    -------
    bool
        The value.

    Raises
    ------
    InputError
        The value is anything else.

    Examples
    --------
    >>> as_switch("copy", 1)
    True
    >>> as_switch("copy", "no")
    Traceback (most recent call last):
    liftmesh.errors.InputError: copy is 'no': give True or False
    """
    try:
        return {True: True, False: False}[value]  # type: ignore[index]
    except (KeyError, TypeError, ValueError) as error:  # arrays cannot be looked up
        raise InputError(f"{name} is {shown(value)}: give True or False") from error


def as_count(name: str, value: object, least: int) -> int:
    """Convert an option that is a whole number; True does not count as 1.

    Parameters
    ----------
    name : str
        The option's name, for the message.
    value : object
        The value given.
    least : int
        The least number allowed.

    Returns
    -------
    int
        The number.

    Raises
    ------
    InputError
        The value is no whole number, or too small.

    Examples
    --------
    >>> as_count("rows", 1.5, 1)
    Traceback (most recent call last):
    liftmesh.errors.InputError: rows is 1.5: give a whole number from 1
    """
    with suppress(TypeError):
        if not isinstance(value, bool) and (count := operator.index(value)) >= least:  # type: ignore[arg-type]
            return count
    raise InputError(f"{name} is {shown(value)}: give a whole number from {least}")


def check_progress(progress: object) -> None:
    """Raise unless the option ``progress`` is a function or None.

    Parameters
    ----------
    progress : object
        The value given.

    Raises
    ------
    InputError
        It cannot be called.

    Examples
    --------
    >>> check_progress(True)
    Traceback (most recent call last):
    liftmesh.errors.InputError: progress is True: give a function of the fraction done, ...
    """
    if progress is not None and not callable(progress):
        raise InputError(
            f"progress is {shown(progress)}: give a function of the fraction done, such as print"
        )


def shown(value: object) -> str:
    """Show a value in a message, in one line that is not too long.

    >>> shown("ab" * 100)[-4:], shown([1, 2] * 100)
    ("bab'", '[1, 2, 1, 2, 1, 2, ...]')
    """
    text = " ".join(_REPR.repr(value).split())
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."


def counted(number: int, noun: str) -> str:
    """Return a number with its noun in the singular or the plural.

    >>> counted(1, "row"), counted(1000, "row")
    ('1 row', '1,000 rows')
    """
    return f"{number:,} {noun}" if number == 1 else f"{number:,} {noun}s"


def as_folder(name: str, given: object) -> str:
    """Return the path of a folder that a caller names.

    Parameters
    ----------
    name : str
        The parameter.
    given : object
        A string or a path.

    Returns
    -------
    str
        With the home directory in place of ``~``.

    Raises
    ------
    InputError
        It is something else.
    """
    if not isinstance(given, str | os.PathLike) or isinstance(os.fspath(given), bytes):
        raise InputError(f"{name} is a {type(given).__name__}: give the path of a folder")
    return os.path.expanduser(given)  # noqa: PTH111 - where there is no home, it stays
