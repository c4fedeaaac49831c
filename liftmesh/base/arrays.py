"""Arrays and numbers from the caller: checked once, and copied only where necessary.

Float64 and float32 stay as they are. Integers, fractions, decimals and wider floats become float64
if it holds every one of them; else an error names the first that it does not. Messages about what
is not an array of points say what was given, and how to make points of it.
"""

from __future__ import annotations

import decimal
import math
import numbers
import sys
from collections.abc import Callable, Iterator, Mapping, Set
from fractions import Fraction
from functools import wraps
from os import PathLike
from typing import Any, ParamSpec, TypeGuard, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Integers, Mask, Reals, Rows
from liftmesh.base.options import refused
from liftmesh.errors import InputError, NonFiniteError, Option, UnsupportedTypeError

P = ParamSpec("P")
R = TypeVar("R")
MOST_ROWS: int = _kernel.MOST_ROWS
POINTS = "points"
_DOUBLE = np.dtype(np.float64)
_PIECE = 1 << 16
_NO_REALS = (str, bytes, complex, np.complexfloating, np.datetime64, np.timedelta64)
_EXACT_INTEGERS = 2**53
_LARGEST = float(np.finfo(np.float64).max)
_LONGEST_SHOWN = 256  # bits
_ROUNDING = decimal.Context(prec=9, Emax=decimal.MAX_EMAX, Emin=decimal.MIN_EMIN)
_AXES = ("x", "y", "z")


def as_coordinates(points: ArrayLike) -> Reals:
    """Convert points to rows of native float64 or float32, copying only where necessary."""
    if _is_usual(points):
        return points
    array = _as_array(points)
    _check_shape(array.shape)  # before anything is copied
    array = as_floats(unmasked(array))
    return array if is_readable(array) else array.copy()


def _is_usual(points: ArrayLike) -> TypeGuard[Floats]:
    """Whether points are contiguous pairs of float64: small calls need no longer look."""
    if type(points) is not np.ndarray or points.dtype is not _DOUBLE:
        return False
    flags, shape = points.flags, points.shape
    is_plain = flags.c_contiguous and flags.aligned
    return is_plain and len(shape) == 2 and shape[1] == 2 and shape[0] <= MOST_ROWS


def _as_array(points: ArrayLike) -> Array:
    """Convert anything to an array; arrays, masked ones included, stay as they are."""
    if are_geometries(points):
        return coordinates_of(points)
    try:
        array = np.asanyarray(points)
    except ValueError as error:
        raise InputError(_describe_ragged(points, error)) from error
    if array.ndim == 0 and array.dtype.kind in "OSU":
        raise no_array(points)
    first = array[:1].flat if array.ndim and array.dtype.hasobject else ()
    if any(hasattr(each, "geom_type") for each in first):
        raise InputError(
            "points are geometries: give what shapely.get_coordinates(points) returns, with "
            "include_z=True where heights count"
        )
    return array


def are_geometries(points: object) -> bool:
    """Whether this is a GeoSeries, a GeoDataFrame with geometries, or the array of one."""
    return hasattr(type(points), "geom_type") and hasattr(type(points), "union_all")


def coordinates_of(points: Any) -> Floats:
    """Return x and y of points of geopandas, and z if one has it: NaN for those that have none."""
    kinds = np.asarray(points.geom_type)
    if (other := kinds != "Point").any():
        row = int(other.argmax())
        kind = kinds[row] if isinstance(kinds[row], str) else "nothing"
        raise InputError(f"row {row} is {kind}: give points, such as the centroids of polygons")
    shapes = getattr(points, "geometry", points)
    axes = _AXES if np.asarray(shapes.has_z).any() else _AXES[:2]
    return np.stack([np.asarray(getattr(shapes, axis), np.float64) for axis in axes], axis=1)


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


def as_any_columns(points: ArrayLike) -> Floats:
    """Convert points of any number of columns to contiguous rows of float64."""
    array = unmasked(_as_array(points))
    if array.ndim != 2 or array.shape[1] < 2:
        raise wrong_shape(array.shape)
    return np.ascontiguousarray(widened(as_floats(array)))


def as_rows3(points: ArrayLike) -> Floats:
    """Convert points to float64 rows x, y, z; planar rows get z = 0."""
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
    """Convert planar points of any leading shape to a contiguous (..., 2) array of float64."""
    return _as_tuples(points, 2, "planar points")


def as_triples(points: ArrayLike) -> Floats:
    """The same for points in space and (..., 3)."""
    return _as_tuples(points, 3, "points in space")


def _as_tuples(points: ArrayLike, width: int, what: str) -> Floats:
    array = unmasked(_as_array(points))
    array = array[:, :width] if are_geometries(points) else array
    if array.ndim == 0 or array.shape[-1] != width:
        transposed = array.ndim == 2 and array.shape[0] == width and array.size > 0
        hint = ": these are columns; give the transpose" if transposed else ""
        raise InputError(f"{what} need the shape (..., {width}), not {array.shape}{hint}")
    flat = as_floats(array.reshape(-1, width))
    return np.ascontiguousarray(widened(flat)).reshape(array.shape)


def widened(array: Array) -> Floats:
    """Convert floats to float64; those that are float64 stay as they are, in the same memory."""
    with np.errstate(invalid="ignore"):  # NumPy warns of signalling NaNs, which files may hold
        return array.astype(np.float64, copy=False)


def unmasked(array: Array, name: str = POINTS) -> Array:
    """Return an ordinary array, with NaN in the place of masked entries."""
    if not is_masked_array(array):
        return np.asarray(array)
    if not np.ma.is_masked(array):
        return np.asarray(array.data)
    mask = np.ma.getmaskarray(array)
    filled = np.array(as_floats(array.filled(0), name), dtype=np.float64)
    filled[mask] = np.nan
    return filled


def is_masked_array(values: object) -> TypeGuard[np.ma.MaskedArray[Any, Any]]:
    """Whether this is a masked array, without importing ``numpy.ma``, which takes long."""
    return "numpy.ma" in sys.modules and isinstance(values, np.ma.MaskedArray)


def is_readable(array: Array) -> bool:
    """Whether the kernel can read the rows in place: it counts strides in whole items."""
    flags = array.flags
    if not flags.aligned:
        return False
    return flags.c_contiguous or all(stride % array.itemsize == 0 for stride in array.strides)


def as_floats(array: Array, name: str = POINTS) -> Reals:
    """Convert numbers to native float64, or float32 if they are; what is native stays."""
    kind = array.dtype.kind
    if kind == "f":
        return _as_double(array, name)
    if kind in "iu":
        return _from_integers(array, name)
    if kind == "O":
        return _from_objects(array, name)
    raise InputError(
        f"{name} hold {array.dtype} values (row 0: {array[:1].tolist()}): give real numbers, "
        "preferably float64"
    )


def _as_double(array: Reals, name: str) -> Reals:
    if array.itemsize in (4, 8):
        native = array.dtype.isnative
        return array if native else array.astype(array.dtype.newbyteorder("="))
    with np.errstate(all="ignore"):  # what overflows or underflows is refused
        doubles = array.astype(np.float64)
        inexact = (doubles != array) & ~np.isnan(array)
    _refuse_inexact(array, inexact, name)
    return doubles


def _from_integers(array: NDArray[np.integer[Any]], name: str) -> Floats:
    doubles = array.astype(np.float64)
    if array.itemsize == 8 and array.size and _exceeds(array, _EXACT_INTEGERS):
        large = np.nonzero((array > _EXACT_INTEGERS) | (array < -_EXACT_INTEGERS))
        inexact = np.zeros(array.shape, dtype=bool)
        inexact[large] = [int(doubles[at]) != int(array[at]) for at in zip(*large, strict=True)]
        _refuse_inexact(array, inexact, name)
    return doubles


def _exceeds(array: NDArray[np.integer[Any]], bound: int) -> bool:
    return bool(array.max() > bound or array.min() < -bound)


def _from_objects(array: NDArray[np.object_], name: str) -> Floats:
    doubles = np.empty(array.shape, dtype=np.float64)
    for at, value in np.ndenumerate(array):
        doubles[at] = _exact_double(value, at, name)
    return doubles


def _exact_double(value: Any, at: tuple[int, ...], name: str) -> float:
    if not isinstance(value, numbers.Real | decimal.Decimal):
        raise InputError(
            f"row {at[0]} holds {value!r} in {_column(at, name)}, a {type(value).__name__}: "
            "give real numbers"
        )
    if isinstance(value, decimal.Decimal) and value.is_nan():
        return math.nan  # one that signals cannot be converted
    try:
        with np.errstate(all="ignore"):
            double = float(value)
    except OverflowError as error:
        raise _inexact(value, at, name) from error
    if double == value or math.isnan(double):
        return double
    raise _inexact(value, at, name)


def _refuse_inexact(array: Array, inexact: Mask, name: str) -> None:
    if inexact.any():
        at = tuple(np.argwhere(inexact)[0].tolist())
        raise _inexact(array[at], at, name)


def _inexact(value: Any, at: tuple[int, ...], name: str) -> InputError:
    where = f"row {at[0]} holds {_shown(value)} in {_column(at, name)}"
    if not -_LARGEST <= value <= _LARGEST:
        remedy = "scale the coordinates down first" if name == POINTS else "scale all down first"
        return InputError(f"{where}, which is beyond the largest float64, {_LARGEST!r}: {remedy}")
    offset = "subtract an offset from the coordinates first, or " if name == POINTS else ""
    return InputError(
        f"{where}, which float64 does not represent exactly: {offset}round them to float64 "
        "explicitly"
    )


def _column(at: tuple[int, ...], name: str) -> str:
    return f"column {at[1]}" if name == POINTS else name


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


def as_reals(values: ArrayLike) -> Floats:
    """Convert the numbers of an option to float64."""
    # NumPy alone drops imaginary parts, and takes texts, bytes and times for numbers.
    array = np.asarray(values)
    objects = array.ravel() if array.dtype.kind == "O" else ()
    if array.dtype.kind in "cSUmM" or any(isinstance(each, _NO_REALS) for each in objects):
        raise TypeError("no real numbers")
    return np.asarray(array, dtype=np.float64)


def as_numbers(name: str, values: ArrayLike, remedy: str, *, verb: str = "is") -> Floats:
    """Convert an option that is several numbers; masked ones are NaN."""
    try:
        return as_reals(unmasked(values) if is_masked_array(values) else values)
    except (TypeError, ValueError, OverflowError) as error:
        raise refused(name, values, remedy, verb=verb) from error


def as_decimal(value: ArrayLike) -> Fraction:
    """Convert a number to the decimal that it is printed as: then 0.6 is three times 0.2."""
    number = float(as_reals(value))
    if not math.isfinite(number):
        raise ValueError("no finite number")
    return Fraction(repr(number))


def starts_of_runs(rows: Array) -> Mask:
    """Tell which rows, (n, k), differ from the one before; the first does."""
    starts = np.ones(len(rows), np.bool_)
    starts[1:] = (rows[1:] != rows[:-1]).any(axis=1)
    return starts


def distinct(values: Array) -> Array:
    """Return the values, ascending, each once: as np.unique, whose hash table takes far longer."""
    ascending = np.sort(values, axis=None)
    found: Array = ascending[starts_of_runs(ascending[:, None])]
    return found


def lower_to(least: Array, rows: Array, values: Array) -> None:
    """Lower numbers to the values of their rows.

    A process short of memory may end in minimum.at, and where indices of 32 bits are widened.
    """
    rows = np.ascontiguousarray(rows, np.intp)
    for _ in range(3):  # passes, after which few are left
        is_less = values < least[rows]
        rows, values = rows[is_less], values[is_less]
        least[rows] = values  # the last one of a row
    order = np.argsort(values)[::-1]
    rows, values = rows[order], values[order]
    is_less = values < least[rows]
    least[rows[is_less]] = values[is_less]


def read_only(array: Array) -> Array:
    """Return a view that cannot be written to, of an array that remains as it is."""
    view: Array = array.view()
    # Naming the argument, as the stubs of NumPy ask for, takes longer than making the view.
    view.setflags(False)  # type: ignore[call-arg]
    return view


def check_finite(points: Reals, *, skippable: bool = True) -> None:
    """Raise if a row is not finite, naming the first."""
    finite = np.isfinite(points)
    if not finite.all():
        row = int(np.argmin(finite.all(axis=1)))
        raise non_finite(row, points[row], skippable=skippable)


def non_finite(row: int, values: Reals, *, skippable: bool = True) -> NonFiniteError:
    """Return the exception for a row that is not finite."""
    shown = ", ".join(repr(float(value)) for value in values)
    advice = f", or skip them with {Option('nonfinite', 'skip')}"
    return NonFiniteError(
        f"row {row} is not finite: ({shown}); remove such rows{advice if skippable else ' first'}",
        row=row,
    )


def pair_keys(first: Array, second: Array) -> Integers:
    """Pack each pair of rows into one integer; these are ordered as the pairs are."""
    keys: Integers = first.astype(np.int64) << 32 | second
    return keys


def pairs_of_keys(keys: Integers) -> tuple[Integers, Integers]:
    """Return the first and the second rows of such integers."""
    return keys >> 32, keys & 0xFFFFFFFF


def is_after(tails: Reals, heads: Reals) -> Mask:
    """Whether the first ends come after the second ones, by x, then y."""
    (x, y), (u, v) = tails.T[:2], heads.T[:2]
    after: Mask = (x > u) | ((x == u) & (y > v))
    return after


def ends_of(simplices: Rows, face: Integers, k: Integers) -> Rows:
    """Return the ends of sides opposite vertices k, the lesser row first."""
    one, other = (simplices[face, (k + turn) % 3] for turn in (1, 2))
    ends: Rows = np.stack([np.minimum(one, other), np.maximum(one, other)], axis=1)
    return ends


def edges_of_faces(faces: Rows) -> Rows:
    """Return the edges of any faces, each once, in the order in which these have them first."""
    ends = np.sort(faces[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2), axis=1)
    _, first = np.unique(pair_keys(*ends.T), return_index=True)
    return ends[np.sort(first)]


def planar_bounds(points: Reals) -> tuple[float, float, float, float]:
    """Return xmin, ymin, xmax, ymax of the rows that are finite; NaN if there are none."""
    finite = np.isfinite(points)
    rows = points if finite.all() else points[finite.all(axis=1)]
    if not len(rows):
        return math.nan, math.nan, math.nan, math.nan
    x, y = rows.T  # each by itself: across both NumPy takes ten times as long
    return x.min().item(), y.min().item(), x.max().item(), y.max().item()


def used_rows(length: int, triangles: Rows) -> Rows:
    """List the rows that are corners of triangles."""
    used = np.zeros(length, dtype=np.bool_)
    corners = triangles.reshape(-1)
    for start in range(0, len(corners), _PIECE):
        # NumPy does not notice when its own conversion of an index runs out of memory.
        used[corners[start : start + _PIECE].astype(np.intp)] = True
    return np.flatnonzero(used).astype(np.int32)


def triangles_of_faces(simplices: Rows, faces: Rows, rows: int) -> Integers:
    """Return the triangle that each face of the mesh is; -1 if it is none."""
    pairs, lasts = _named_triangles(simplices, rows)
    order = np.lexsort((lasts, pairs))
    pairs, lasts = pairs[order], lasts[order]
    their_pairs, their_lasts = _named_triangles(faces, rows)
    end = len(order) - 1
    place = np.minimum(np.searchsorted(pairs, their_pairs), end)
    place = np.minimum(place + (lasts[place] != their_lasts), end)  # two share a side at most
    is_there = (pairs[place] == their_pairs) & (lasts[place] == their_lasts)
    return np.where(is_there, order[place], -1)


def _named_triangles(triangles: Rows, rows: int) -> tuple[Integers, Integers]:
    """Name triangles by their corners, whatever the first: by the lower two, and by the last."""
    corners = np.sort(triangles, axis=1).astype(np.int64)
    return corners[:, 0] * rows + corners[:, 1], corners[:, 2]


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
