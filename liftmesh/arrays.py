"""Arrays of points from the caller: checked once, and copied only where necessary."""

from __future__ import annotations

from typing import Any, TypeGuard

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Reals, Rows
from liftmesh.errors import InputError, NonFiniteError
from liftmesh.floats import as_floats, is_readable, unmasked
from liftmesh.shapes import no_array, no_numbers, wrong_shape

MOST_ROWS: int = _kernel.MOST_ROWS

_DOUBLE = np.dtype(np.float64)
_PIECE = 1 << 16
_NO_REALS = (str, bytes, complex, np.complexfloating, np.datetime64, np.timedelta64)


def as_coordinates(points: ArrayLike) -> Reals:
    """Convert points to rows of native float64 or float32, copying only where necessary.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        Real numbers. Float64 and float32 arrays of any strides are used as they are; float16,
        integers and lists become float64 if every value is exactly representable. Masked entries
        become NaN.

    Returns
    -------
    (n, 2) or (n, 3) ndarray of float64 or float32
        A view of the caller's memory where possible.

    Raises
    ------
    InputError
        The shape or the type of the values is wrong, a number is not exactly representable as
        float64, or there are more than 357,913,941 rows.

    Examples
    --------
    >>> as_coordinates([[0, 1], [2, 3]]).dtype
    dtype('float64')
    """
    if _is_usual(points):
        return points
    array = _as_array(points)
    _check_shape(array.shape)  # before anything is copied
    array = as_floats(unmasked(array))
    return array if is_readable(array) else array.copy()


def as_rows3(points: ArrayLike) -> Floats:
    """Convert points to float64 rows x, y, z; planar rows get z = 0.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        As for `as_coordinates`.

    Returns
    -------
    (n, 3) ndarray of float64
        The caller's array itself if it has this type and layout already.

    Raises
    ------
    InputError
        As `as_coordinates`.

    Examples
    --------
    >>> as_rows3([[1, 2]])
    array([[1., 2., 0.]])
    """
    array = _as_array(points)
    _check_shape(array.shape)
    narrow = type(array) is np.ndarray and array.dtype.kind in "iuf" and array.itemsize < 8
    if array.shape[1] == 3 or not narrow:  # as float64, narrow ones would need room of their own
        array = as_coordinates(array)
    if array.shape[1] == 3:
        return widened(array)
    lifted = np.zeros((len(array), 3))
    lifted[:, :2] = array
    return lifted


def as_pairs(points: ArrayLike) -> Floats:
    """Convert planar points of any leading shape to a contiguous (..., 2) array of float64.

    Parameters
    ----------
    points : array_like of shape (..., 2)
        Real numbers.

    Returns
    -------
    (..., 2) ndarray of float64
        The caller's array itself if it has this type and layout already.

    Raises
    ------
    InputError
        The last axis is not of length two, or a value is not a real number that float64 represents
        exactly.

    Examples
    --------
    >>> as_pairs((1, 2)).shape
    (2,)
    """
    array = unmasked(_as_array(points))
    if array.ndim == 0 or array.shape[-1] != 2:
        transposed = array.ndim == 2 and array.shape[0] == 2 and array.size > 0
        hint = ": these are columns; give the transpose" if transposed else ""
        raise InputError(f"planar points need the shape (..., 2), not {array.shape}{hint}")
    flat = as_floats(array.reshape(-1, 2))
    return np.ascontiguousarray(widened(flat)).reshape(array.shape)


def widened(array: Array) -> Floats:
    """Convert floats to float64; those that are float64 stay as they are, in the same memory.

    Parameters
    ----------
    array : ndarray of float
        Of any shape.

    Returns
    -------
    ndarray of float64
        The same values, and NaN where there is one of any kind.

    Examples
    --------
    >>> widened(np.array([0.5], dtype=np.float32))
    array([0.5])
    """
    with np.errstate(invalid="ignore"):  # NumPy warns of signalling NaNs, which files may hold
        return array.astype(np.float64, copy=False)


def as_reals(values: ArrayLike) -> Floats:
    """Convert the numbers of an option to float64.

    Parameters
    ----------
    values : array_like
        Real numbers of any shape.

    Returns
    -------
    ndarray of float64
        The numbers, rounded if necessary.

    Raises
    ------
    TypeError, ValueError, OverflowError
        They are no real numbers: `numpy.asarray` alone drops the imaginary part of complex ones,
        and takes texts, bytes and times for numbers.

    Examples
    --------
    >>> as_reals((1, 2))
    array([1., 2.])
    """
    array = np.asarray(values)
    objects = array.ravel() if array.dtype.kind == "O" else ()
    if array.dtype.kind in "cSUmM" or any(isinstance(each, _NO_REALS) for each in objects):
        raise TypeError("no real numbers")
    return np.asarray(array, dtype=np.float64)


def read_only(array: Array) -> Array:
    """Return a view that cannot be written to, of an array that remains as it is.

    Parameters
    ----------
    array : ndarray
        Any array.

    Returns
    -------
    ndarray
        Shares the memory: it protects from writing through the view alone.

    Examples
    --------
    >>> values = np.zeros(2)
    >>> read_only(values).flags.writeable, values.flags.writeable
    (False, True)
    """
    view: Array = array.view()
    # Naming the argument, as the stubs of NumPy ask for, takes longer than making the view.
    view.setflags(False)  # type: ignore[call-arg]
    return view


def check_finite(points: Reals, *, skippable: bool = True) -> None:
    """Raise if a row is not finite, naming the first.

    Parameters
    ----------
    points : (n, k) ndarray of float
        Rows of coordinates.
    skippable : bool, default True
        Whether the caller can skip such rows; the message then says how.

    Raises
    ------
    NonFiniteError
        A coordinate is NaN or infinite.

    Examples
    --------
    >>> check_finite(np.array([[0.0, 1.0], [2.0, np.inf]]))
    Traceback (most recent call last):
    liftmesh.errors.NonFiniteError: row 1 is not finite: (2.0, inf); ...
    """
    finite = np.isfinite(points)
    if not finite.all():
        row = int(np.argmin(finite.all(axis=1)))
        raise non_finite(row, points[row], skippable=skippable)


def non_finite(row: int, values: Reals, *, skippable: bool = True) -> NonFiniteError:
    """Return the exception for a row that is not finite.

    Parameters
    ----------
    row : int
        The row.
    values : (k,) ndarray of float
        Its coordinates.
    skippable : bool, default True
        As for `check_finite`.

    Returns
    -------
    NonFiniteError
        The exception, not yet raised.

    Examples
    --------
    >>> non_finite(3, np.array([np.nan, 0.0])).row
    3
    """
    shown = ", ".join(repr(float(value)) for value in values)
    advice = ", or skip them with nonfinite='skip'"
    return NonFiniteError(
        f"row {row} is not finite: ({shown}); remove such rows{advice if skippable else ' first'}",
        row=row,
    )


def used_rows(length: int, triangles: Rows) -> Rows:
    """List the rows that are corners of triangles.

    Parameters
    ----------
    length : int
        Number of all rows.
    triangles : (m, 3) ndarray of int
        Triangles.

    Returns
    -------
    (k,) ndarray of int32
        Ascending, each row once.

    Examples
    --------
    >>> used_rows(5, np.array([[4, 0, 1], [4, 1, 0]])).tolist()
    [0, 1, 4]
    """
    used = np.zeros(length, dtype=np.bool_)
    corners = triangles.reshape(-1)
    for start in range(0, len(corners), _PIECE):
        # NumPy does not notice when its own conversion of an index runs out of memory.
        used[corners[start : start + _PIECE].astype(np.intp)] = True
    return np.flatnonzero(used).astype(np.int32)


def _is_usual(points: ArrayLike) -> TypeGuard[Floats]:
    """Whether points are contiguous pairs of float64: small calls need no longer look."""
    if type(points) is not np.ndarray or points.dtype is not _DOUBLE:
        return False
    flags, shape = points.flags, points.shape
    is_plain = flags.c_contiguous and flags.aligned
    return is_plain and len(shape) == 2 and shape[1] == 2 and shape[0] <= MOST_ROWS


def _as_array(points: ArrayLike) -> Array:
    """Convert anything to an array; arrays, masked ones included, stay as they are."""
    try:
        array = np.asanyarray(points)
    except ValueError as error:
        raise InputError(_describe_ragged(points, error)) from error
    if array.ndim == 0 and array.dtype.kind in "OSU":
        raise no_array(points)
    first = array[:1].flat if array.ndim and array.dtype.hasobject else ()
    if any(hasattr(each, "geom_type") for each in first):
        raise no_numbers(points)
    return array


def _describe_ragged(points: Any, error: ValueError) -> str:
    try:
        lengths = [len(row) for row in points]
    except TypeError:
        return f"points cannot be converted to an array: {error}"
    odd = next((row for row, length in enumerate(lengths) if length != lengths[0]), None)
    if odd is None:
        return f"points cannot be converted to an array: {error}"
    return (
        f"row {odd} has {lengths[odd]} values where row 0 has {lengths[0]}: "
        "give every row the same two or three coordinates"
    )


def _check_shape(shape: tuple[int, ...]) -> None:
    if len(shape) != 2 or shape[1] not in (2, 3):
        raise wrong_shape(shape)
    if shape[0] > MOST_ROWS:
        raise InputError(
            f"{shape[0]:,} rows are more than the {MOST_ROWS:,} that 32-bit edge numbers "
            "allow: triangulate tiles, or thin the points"
        )
