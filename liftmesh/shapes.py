"""Messages about what is not an array of points: what was given, and how to make points of it."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping, Set
from functools import wraps
from os import PathLike
from typing import Any, ParamSpec, TypeGuard, TypeVar

import numpy as np

from liftmesh.errors import InputError, UnsupportedTypeError

P = ParamSpec("P")
R = TypeVar("R")

_AXES = ("x", "y", "z")


def wrong_shape(shape: tuple[int, ...]) -> InputError:
    """Return the exception for an array whose shape is neither (n, 2) nor (n, 3)."""
    return InputError(f"points need the shape (n, 2) or (n, 3), not {shape}: {_remedy(shape)}")


def _remedy(shape: tuple[int, ...]) -> str:
    if len(shape) == 1 and shape[0]:
        return "give one row per point; np.column_stack([x, y]) joins columns"
    if len(shape) == 2 and shape[0] in (2, 3) and shape[1] > 0:
        return "these are columns; give points.T"
    if len(shape) == 2 and shape[1] > 3:
        return "give the columns of x, y and z, such as points[:, :3]"
    return "give one row per point, with x, y and optionally z"


def no_array(points: object) -> InputError:
    """Return the exception for an object of which NumPy makes no rows."""
    kind = type(points).__name__
    article = "an" if kind[0] in "aeiouAEIOU" else "a"
    what = "None" if points is None else f"{article} {kind}"
    return InputError(f"points are {what}{_advice(points)}")


def _advice(points: object) -> str:
    """Return what follows the type of an object in a message."""
    if isinstance(points, Mapping):
        return f": give an array, {_joined(points)}"
    if isinstance(points, Iterator):
        return ", which has no length: give list(points)"
    if isinstance(points, Set):
        return ", which has no order: give a list of rows"
    if isinstance(points, str | PathLike):
        return ": give an array; liftmesh.read(path).points are those of a file"
    return ": give an array with one row per point"


def _joined(columns: Mapping[Any, Any]) -> str:
    """Show how the columns of a mapping are joined, by the names it has."""
    named = {str(key).lower(): key for key in columns}
    keys = [named[axis] for axis in _AXES if axis in named] or ["x", "y"]
    return f"np.column_stack([{', '.join(f'points[{key!r}]' for key in keys)}])"


def of_one_array(function: Callable[P, R]) -> Callable[P, R]:
    """Explain a call with a column for each axis, such as ``delaunay(x, y)``."""

    @wraps(function)
    def called(*args: P.args, **options: P.kwargs) -> R:
        if 1 < len(args) < 4 and all(map(_is_column, args)):
            axes = ", ".join(_AXES[: len(args)])
            raise UnsupportedTypeError(
                f"{function.__name__} takes one array with a row per point, not {len(args)} "
                f"columns: give np.column_stack([{axes}])"
            )
        return function(*args, **options)

    return called


def _is_column(value: object) -> bool:
    """Whether a value is a sequence of numbers."""
    try:
        array = np.asarray(value)
    except ValueError:
        return False
    return array.ndim == 1 and array.dtype.kind in "biuf"


def is_masked_array(values: object) -> TypeGuard[np.ma.MaskedArray[Any, Any]]:
    """Whether this is a masked array, without importing ``numpy.ma``, which takes long."""
    return "numpy.ma" in sys.modules and isinstance(values, np.ma.MaskedArray)
