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
    """Return the exception for an array whose shape is neither (n, 2) nor (n, 3).

    Parameters
    ----------
    shape : tuple of int
        The shape.

    Returns
    -------
    InputError
        The exception, not yet raised.

    Examples
    --------
    >>> print(wrong_shape((2, 50)))
    points need the shape (n, 2) or (n, 3), not (2, 50): these are columns; give points.T
    """
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
    """Return the exception for an object of which NumPy makes no rows.

    Parameters
    ----------
    points : object
        Anything.

    Returns
    -------
    InputError
        The exception, not yet raised.

    Examples
    --------
    >>> print(no_array({"X": [0, 1], "Y": [2, 3]}))
    points are a dict: give an array, np.column_stack([points['X'], points['Y']])
    >>> print(no_array(iter([[0, 1]])))
    points are a list_iterator, which has no length: give list(points)
    """
    kind = type(points).__name__
    article = "an" if kind[0] in "aeiouAEIOU" else "a"
    what = "None" if points is None else f"{article} {kind}"
    return InputError(f"points are {what}{_advice(points)}")


def no_numbers(points: object) -> InputError:
    """Return the exception for geometries of shapely, of which NumPy makes objects.

    Parameters
    ----------
    points : object
        Anything with such rows.

    Returns
    -------
    InputError
        The exception, not yet raised.

    Examples
    --------
    >>> print(no_numbers([]))
    points are geometries: give what shapely.get_coordinates(points) returns, with ...
    """
    has_own = hasattr(type(points), "get_coordinates")  # of geopandas
    call = "its get_coordinates()" if has_own else "shapely.get_coordinates(points)"
    return InputError(
        f"points are geometries: give what {call} returns, with include_z=True where heights count"
    )


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
    """Explain a call with a column for each axis, such as ``delaunay(x, y)``.

    Parameters
    ----------
    function : callable
        Takes one array of points, and everything else by keyword.

    Returns
    -------
    callable
        The function, with the same signature. Python's own errors about other calls stay.

    Examples
    --------
    >>> of_one_array(lambda points: points)([0, 1], [2, 3])
    Traceback (most recent call last):
    liftmesh.errors.UnsupportedTypeError: ...: give np.column_stack([x, y])
    """

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
    """Whether this is a masked array, without importing ``numpy.ma``, which takes long.

    Parameters
    ----------
    values : object
        Anything.

    Returns
    -------
    bool
        Whether it is one.

    Examples
    --------
    >>> import numpy as np
    >>> is_masked_array(np.ma.masked_invalid([0.0, np.nan])), is_masked_array([0.0])
    (True, False)
    """
    return "numpy.ma" in sys.modules and isinstance(values, np.ma.MaskedArray)
