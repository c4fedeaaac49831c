"""Arrays of points from the caller: checked once, and copied only where necessary."""

from __future__ import annotations

import decimal
import math
import numbers
from typing import Any, TypeGuard

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Mask, Reals, Rows
from liftmesh.errors import InputError, NonFiniteError
from liftmesh.shapes import is_masked_array, no_array, wrong_shape

MOST_ROWS: int = _kernel.MOST_ROWS

_DOUBLE = np.dtype(np.float64)
_EXACT_INTEGERS = 2**53
_LARGEST = float(np.finfo(np.float64).max)
_LONGEST_SHOWN = 256  # bits
_PIECE = 1 << 16
_ROUNDING = decimal.Context(prec=9, Emax=decimal.MAX_EMAX, Emin=decimal.MIN_EMIN)


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
    array = _as_floating(_plain(array))
    return array if _is_readable(array) else array.copy()


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
    array = _plain(_as_array(points))
    if array.ndim == 0 or array.shape[-1] != 2:
        transposed = array.ndim == 2 and array.shape[0] == 2 and array.size > 0
        hint = ": these are columns; give the transpose" if transposed else ""
        raise InputError(f"planar points need the shape (..., 2), not {array.shape}{hint}")
    flat = _as_floating(array.reshape(-1, 2))
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
        They are no real numbers: `numpy.asarray` alone drops the imaginary part of complex ones.

    Examples
    --------
    >>> as_reals((1, 2))
    array([1., 2.])
    """
    if np.iscomplexobj(values):
        raise TypeError("complex numbers")
    return np.asarray(values, dtype=np.float64)


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
    return array


def _plain(array: Array) -> Array:
    if is_masked_array(array):
        return _fill_masked(array)
    return np.asarray(array)


def _is_readable(array: Array) -> bool:
    """Whether the kernel can read the rows in place: it counts strides in whole items."""
    flags = array.flags
    if not flags.aligned:
        return False
    return flags.c_contiguous or all(stride % array.itemsize == 0 for stride in array.strides)


def _fill_masked(points: np.ma.MaskedArray[Any, Any]) -> Array:
    if not np.ma.is_masked(points):
        return np.asarray(points.data)
    mask = np.ma.getmaskarray(points)
    filled = np.array(_as_floating(points.filled(0)), dtype=np.float64)
    filled[mask] = np.nan
    return filled


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


def _as_floating(array: Array) -> Reals:
    kind = array.dtype.kind
    if kind == "f":
        return _as_double(array)
    if kind in "iu":
        return _from_integers(array)
    if kind == "O":
        return _from_objects(array)
    raise InputError(
        f"points hold {array.dtype} values (row 0: {array[:1].tolist()}): give real numbers, "
        "preferably float64"
    )


def _as_double(array: Reals) -> Reals:
    if array.itemsize in (4, 8):
        native = array.dtype.isnative
        return array if native else array.astype(array.dtype.newbyteorder("="))
    with np.errstate(all="ignore"):  # what overflows or underflows is refused
        doubles = array.astype(np.float64)
        inexact = (doubles != array) & ~np.isnan(array)
    _refuse_inexact(array, inexact)
    return doubles


def _from_integers(array: NDArray[np.integer[Any]]) -> Floats:
    doubles = array.astype(np.float64)
    if array.itemsize == 8 and array.size and _exceeds(array, _EXACT_INTEGERS):
        large = np.nonzero((array > _EXACT_INTEGERS) | (array < -_EXACT_INTEGERS))
        inexact = np.zeros(array.shape, dtype=bool)
        inexact[large] = [int(doubles[at]) != int(array[at]) for at in zip(*large, strict=True)]
        _refuse_inexact(array, inexact)
    return doubles


def _exceeds(array: NDArray[np.integer[Any]], bound: int) -> bool:
    return bool(array.max() > bound or array.min() < -bound)


def _from_objects(array: NDArray[np.object_]) -> Floats:
    doubles = np.empty(array.shape, dtype=np.float64)
    for at, value in np.ndenumerate(array):
        doubles[at] = _exact_double(value, *at)
    return doubles


def _exact_double(value: Any, row: int, column: int) -> float:
    if not isinstance(value, numbers.Real | decimal.Decimal):
        raise InputError(
            f"row {row} holds {value!r} in column {column}, a {type(value).__name__}: "
            "give real numbers"
        )
    if isinstance(value, decimal.Decimal) and value.is_nan():
        return math.nan  # one that signals cannot be converted
    try:
        with np.errstate(all="ignore"):
            double = float(value)
    except OverflowError as error:
        raise _inexact(value, row, column) from error
    if double == value or math.isnan(double):
        return double
    raise _inexact(value, row, column)


def _refuse_inexact(array: Array, inexact: Mask) -> None:
    if inexact.any():
        row, column = np.argwhere(inexact)[0].tolist()
        raise _inexact(array[row, column], row, column)


def _inexact(value: Any, row: int, column: int) -> InputError:
    where = f"row {row} holds {_shown(value)} in column {column}"
    if not -_LARGEST <= value <= _LARGEST:
        return InputError(
            f"{where}, which is beyond the largest float64, {_LARGEST!r}: scale the coordinates "
            "down first"
        )
    return InputError(
        f"{where}, which float64 does not represent exactly: subtract an offset "
        "from the coordinates first, or round them to float64 explicitly"
    )


def _shown(value: Any) -> str:
    """Return a number as it was given, or rounded if it has too many digits for a message."""
    if isinstance(value, numbers.Rational):
        over, under = int(value.numerator), int(value.denominator)
        if max(over.bit_length(), under.bit_length()) > _LONGEST_SHOWN:
            quotient = _ROUNDING.divide(decimal.Decimal(over), decimal.Decimal(under))
            return f"about {quotient.normalize(_ROUNDING)}"
    if isinstance(value, decimal.Decimal) and len(value.as_tuple().digits) > _LONGEST_SHOWN // 3:
        return f"about {value.normalize(_ROUNDING)}"
    return str(value)  # an f-string would round a longdouble to a double
