"""The exceptions liftmesh raises: one root, each message naming what is wrong and the remedy."""

from __future__ import annotations

from typing import Any


class LiftmeshError(Exception):
    """Root of every exception that liftmesh raises on purpose."""

    def __reduce__(self) -> tuple[Any, ...]:
        # Some take keywords, which Exception's own way of pickling does not know.
        return _rebuild, (type(self), self.args), self.__dict__


class InputError(LiftmeshError, ValueError):
    """Points, options or arrays that cannot be used as they are."""


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
    """Rows share one planar position at different heights, and the caller asked for an error.

    Attributes
    ----------
    rows : tuple of int
        Two rows that collide.
    """

    def __init__(self, message: str, *, rows: tuple[int, int]) -> None:
        super().__init__(message)
        self.rows = rows


class FormatError(LiftmeshError, ValueError):
    """A file cannot be read or written: the message names the file, the line or byte, the cause."""


class UnsupportedTypeError(LiftmeshError, TypeError):
    """An object that no adapter turns into a point cloud."""


class MissingDependencyError(LiftmeshError, ImportError):
    """An optional package, or a system library it needs, is not installed."""


def _rebuild(kind: type[LiftmeshError], args: tuple[Any, ...]) -> LiftmeshError:
    error = kind.__new__(kind)
    error.args = args
    return error
