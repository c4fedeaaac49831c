"""The exceptions of liftmesh: one base class; messages say what is wrong and how to fix it.

A message names options by `Option`, so that whoever shows it can word them: ``str(error)`` as
Python writes them, ``band=2``, the command line as a shell does, ``--band 2``.
"""

from __future__ import annotations

import json
import pickle
from collections.abc import Iterator, Mapping
from types import EllipsisType
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from typing_extensions import Self

_OPEN, _CLOSE = "\ufdd0", "\ufdd1"  # noncharacters of Unicode, which are for internal use


class Option(NamedTuple):
    """An option that a message names: by its name, or as it is to be given.

    In an f-string it stands between marks, which exceptions, `DataWarning` and `Message` take out.

    Parameters
    ----------
    name : str
        The name of the option.
    value : str, float, bool or Ellipsis, optional
        The value to give, or ``...`` for any.

    See Also
    --------
    InputError : The exception of wrong options.

    Examples
    --------
    >>> print(*map(str, [Option("band"), Option("band", ...), Option("band", 2)]))
    band band= band=2
    >>> raise InputError(f"give {Option('unit', 'meter')}")
    Traceback (most recent call last):
    ...
    liftmesh.errors.InputError: give unit='meter'
    """

    name: str
    value: str | float | EllipsisType | None = None

    def __str__(self) -> str:
        if self.value is None:
            return self.name
        return f"{self.name}={'' if self.value is ... else repr(self.value)}"

    def __format__(self, _: str) -> str:
        given = "" if self.value is ... else json.dumps(self.value)
        return f"{_OPEN}{self.name}={given}{_CLOSE}"


class Message(str):
    """A text that knows where it names options."""

    parts: tuple[str | Option, ...]

    def __new__(cls, text: str) -> Self:
        """Take out the marks of options."""
        parts = text.parts if isinstance(text, Message) else tuple(_parts(text))
        made = super().__new__(cls, "".join(map(str, parts)))
        made.parts = parts
        return made

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.marked,)

    @property
    def marked(self) -> str:
        """The text with the marks of its options, for a message that it becomes a part of."""
        return "".join(f"{each}" for each in self.parts)

    def renamed(self, names: Mapping[str, str]) -> Message:
        """Give options other names."""
        renamed = (
            each if isinstance(each, str) else each._replace(name=names.get(each.name, each.name))
            for each in self.parts
        )
        return Message("".join(f"{each}" for each in renamed))


def _parts(text: str) -> Iterator[str | Option]:
    first, *others = text.split(_OPEN)
    yield first
    for each in others:
        option, _, rest = each.partition(_CLOSE)
        name, _, value = option.partition("=")
        try:
            yield Option(name, json.loads(value))
        except ValueError:
            yield Option(name, ...) if option.endswith("=") else option  # not marked by us
        yield rest


class LiftmeshError(Exception):
    """Base class of all exceptions that liftmesh raises deliberately.

    Attributes
    ----------
    option : str or None
        The option whose value is wrong, if that is what is wrong.
    value : object
        The value that was given. Of an exception from another process, its text if it cannot be
        sent.
    reason : str or None
        What is wrong with the value, or what to give instead.

    See Also
    --------
    InputError : Points, options or arrays are invalid.
    FormatError : A file cannot be read or written.

    Examples
    --------
    >>> import liftmesh
    >>> try:
    ...     liftmesh.delaunay([[0, 0], [1, 0], [0, 1]], threads=0)
    ... except liftmesh.LiftmeshError as error:
    ...     print(error.option, error.value, error.reason, sep=", ")
    threads, 0, give a whole number from 1 to 1024
    """

    def __init__(
        self,
        message: str = "",
        *,
        option: str | None = None,
        value: object = None,
        reason: str | None = None,
    ) -> None:
        super().__init__(Message(message))
        self.option = option
        self.value = value
        self.reason = None if reason is None else Message(reason)

    @property
    def message(self) -> Message:
        """The text, which knows where it names options."""
        return Message(self.args[0])

    def within(self, context: object) -> Self:
        """Say before the message what it is about, as the file; return the same exception.

        Parameters
        ----------
        context : object
            What the message is about.

        Returns
        -------
        LiftmeshError
            This exception.

        See Also
        --------
        BaseException.add_note : What follows a message.

        Examples
        --------
        >>> FormatError("line 3: no number").within("a.xyz")
        FormatError('a.xyz: line 3: no number')
        """
        self.args = (Message(f"{context}: {self.message.marked}"),)
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        # Some take keyword arguments, which Exception's own pickling does not support.
        return _rebuild, (type(self), self.args), {**self.__dict__, "value": _sent(self.value)}


class InputError(LiftmeshError, ValueError):
    """Points, options or arrays are invalid.

    See Also
    --------
    LiftmeshError : The base class, whose attributes say which option is wrong, and why.
    """


class NonFiniteError(InputError):
    """A coordinate is NaN, infinite or masked.

    Attributes
    ----------
    row : int
        The first such row of the caller's array.

    See Also
    --------
    triangulate : Skips such rows with ``nonfinite="skip"``.
    """

    def __init__(self, message: str, *, row: int) -> None:
        super().__init__(message)
        self.row = row


class DegenerateInputError(InputError):
    """Fewer than three distinct points, or all points on one line: no triangle exists.

    See Also
    --------
    delaunay : Needs three points that are not on one line.
    """


class DuplicateHeightError(InputError):
    """Rows at one planar position have different heights, and the caller asked for an error.

    Attributes
    ----------
    rows : tuple of int
        Two rows in conflict.

    See Also
    --------
    triangulate : Takes a policy for such rows.
    """

    def __init__(self, message: str, *, rows: tuple[int, int]) -> None:
        super().__init__(message)
        self.rows = rows


class CrossingError(InputError):
    """Edges of a constrained triangulation cross where no row is.

    Attributes
    ----------
    crossings : (c, 2) ndarray of int32
        All pairs of edges that cross, as indices into the input edges: those given as edges come
        first, then those of polylines, then those of polygons.
    rows : (c, 4) ndarray of int32
        The rows of the ends of each pair.
    places : (p, 2) ndarray of float64
        Where they cross, rounded to the nearest float64: of the first 10,000 pairs.

    See Also
    --------
    constrained_delaunay : Inserts the crossings with ``crossing="split"``.
    """

    def __init__(self, message: str, *, crossings: Any, rows: Any, places: Any) -> None:
        super().__init__(message)
        self.crossings = crossings
        self.rows = rows
        self.places = places


class FormatError(LiftmeshError, ValueError):
    """A file cannot be read or written; the message gives file, line or byte, and cause.

    See Also
    --------
    read, write : The functions that raise it.
    """


class DataWarning(UserWarning):
    """Points are usable, but hardly what their user wants: degrees, or units that differ.

    See Also
    --------
    warnings.simplefilter : Makes an exception of it, or leaves it out.
    """

    def __init__(self, message: str) -> None:
        super().__init__(Message(message))


class UnsupportedTypeError(LiftmeshError, TypeError):
    """No adapter can convert an object to a point cloud.

    See Also
    --------
    as_cloud : Converts objects, or raises it.
    """


class MissingDependencyError(LiftmeshError, ImportError):
    """An optional package, or a system library it needs, is not installed.

    See Also
    --------
    ImportError : The base class besides `LiftmeshError`.
    """


def _rebuild(kind: type[LiftmeshError], args: tuple[Any, ...]) -> LiftmeshError:
    error = kind.__new__(kind)
    error.args = args
    return error


def _sent(value: object) -> object:
    """Return a value as another process gets it: by its text, if it cannot be sent."""
    try:
        pickle.dumps(value)
    except Exception:  # noqa: BLE001 - whatever the object of a caller raises
        return repr(value)
    return value
