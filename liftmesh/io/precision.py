"""What floating-point numbers hold: the origin of files in single precision, and whole numbers.

A float has 24 bits: at 5,200,000 m its steps are half a metre. If rounding the coordinates along an
axis would move a vertex by more than a millionth of the model's size, an origin near the smallest
coordinate is subtracted first: a round number, a multiple of one unit, or of a power of ten for
models smaller than one unit. x and y get it together: both are of one map, where a small easting
next to a large northing would else be rounded far more than the northing. The file records the
origin, and its reader adds it again.

Whether doubles hold whole numbers exactly is decided in whole numbers: converting there and back
does not tell, since 2**63 - 1 becomes the double 2**63, which is beyond the type, and what that
becomes depends on the machine.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.errors import FormatError
from liftmesh.io.json_text import finite_numbers, shown
from liftmesh.io.metadata import noted

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud


Origin: TypeAlias = tuple[float, float, float]

TOLERANCE = 1e-6  # of the size of a model, by which rounding may move a vertex


def needed_origin(points: Floats, what: str) -> Origin | None:
    """Compute the origin to subtract before coordinates are rounded to single precision."""
    if not len(points):
        return None
    # Column by column: reductions along axis 0 take ten times as long.
    low = np.array([column.min() for column in points.T])
    with np.errstate(over="ignore"):
        size = float((np.array([column.max() for column in points.T]) - low).max())
    needed = _moved(points) > TOLERANCE * size
    if np.isfinite(size) and not needed.any():
        return None
    needed[:2] = needed[:2].any()
    origin = np.where(needed, _round_below(low, size), 0.0)
    fits = np.isfinite(size) and bool(np.all(_moved(points - origin) <= TOLERANCE * size))
    if not fits:
        raise FormatError(
            f"the coordinates do not fit the single precision of {what}: write PLY or OBJ"
        )
    return (float(origin[0]), float(origin[1]), float(origin[2]))


def _moved(points: Floats) -> Floats:
    """Compute for each axis how far rounding to single precision moves coordinates at most."""
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        return np.array([np.abs(each - each.astype(np.float32)).max() for each in points.T])


def _round_below(low: Floats, size: float) -> Floats:
    if size == 0:
        return low
    step = 10.0 ** min(np.floor(np.log10(size)), 0.0)
    rounded: Floats = np.floor(low / step) * step
    return rounded


def without_origin(points: Floats, origin: Origin | None) -> Floats:
    """Subtract an origin, if there is one."""
    return points if origin is None else points - np.array(origin)


def with_origin(cloud: Cloud, origin: Origin | None) -> Cloud:
    """Add the origin that a file states, if it does, and record it in the metadata."""
    if origin is None:
        return cloud
    return replace(
        cloud,
        points=cloud.points + np.array(origin),
        metadata=noted(cloud.metadata, origin=origin),
    )


def fits_single(points: Floats, origin: Origin | None) -> bool:
    """Whether all coordinates, relative to an origin, round-trip through single precision."""
    shift = np.zeros(3) if origin is None else np.array(origin)
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        again = (points - shift).astype(np.float32).astype(np.float64) + shift
    return np.array_equal(again, points, equal_nan=True)


def checked_origin(values: object, name: str) -> Origin:
    """Check an origin that a file states."""
    numbers = finite_numbers(values, 3)
    if numbers is None:
        raise FormatError(f"{name}: the origin is {shown(values)}: expected three finite numbers")
    return (numbers[0], numbers[1], numbers[2])


SINGLE, DOUBLE = 24, 53  # bits of a significand


def fit(values: Array, bits: int) -> bool:
    """Whether significands of so many bits hold all values of an array of integers."""
    if not values.size or max(-int(values.min()), int(values.max())) <= 1 << bits:
        return True
    sizes = np.abs(values.astype(np.int64)) if values.dtype.kind == "i" else values
    sizes = sizes.astype(np.uint64)  # -2**63 has no opposite, but the right bits
    lowest = sizes & (~sizes + np.uint64(1))
    return bool((sizes // np.maximum(lowest, 1) < np.uint64(1 << bits)).all())
