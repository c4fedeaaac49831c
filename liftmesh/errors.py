"""The exceptions of liftmesh: one base class; messages say what is wrong and how to fix it."""

from __future__ import annotations

from typing import Any


class LiftmeshError(Exception):
    """Base class of all exceptions that liftmesh raises deliberately."""

    def __reduce__(self) -> tuple[Any, ...]:
        # Some take keyword arguments, which Exception's own pickling does not support.
        return _rebuild, (type(self), self.args), self.__dict__


class InputError(LiftmeshError, ValueError):
    """Points, options or arrays are invalid."""


class NonFiniteError(InputError):
    """A coordinate is NaN, infinite or masked.

    Attributes
    ----------
    row : int
        The first such row of the caller's array.
    """

    def __init__(self, message: str, *, row: int) -> None:
        super().__init__(message)
        self.row = row


class DegenerateInputError(InputError):
    """Fewer than three distinct points, or all points on one line: no triangle exists."""


class DuplicateHeightError(InputError):
    """Rows at one planar position have different heights, and the caller asked for an error.

    Attributes
    ----------
    rows : tuple of int
        Two rows in conflict.
    """

    def __init__(self, message: str, *, rows: tuple[int, int]) -> None:
        super().__init__(message)
        self.rows = rows


class FormatError(LiftmeshError, ValueError):
    """A file cannot be read or written; the message gives file, line or byte, and cause."""


class DataWarning(UserWarning):
    """Points are usable, but hardly what their user wants: degrees, or units that differ."""


class UnsupportedTypeError(LiftmeshError, TypeError):
    """No adapter can convert an object to a point cloud."""


class MissingDependencyError(LiftmeshError, ImportError):
    """An optional package, or a system library it needs, is not installed."""


def _rebuild(kind: type[LiftmeshError], args: tuple[Any, ...]) -> LiftmeshError:
    error = kind.__new__(kind)
    error.args = args
    return error
