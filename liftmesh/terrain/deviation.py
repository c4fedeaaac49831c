"""How far points are from a surface along its normal, checked by arithmetic of its own.

The height of the surface at a point is that of the plane of the triangle that contains it, found
exactly. The distance is computed in doubles by barycentric coordinates, with a bound on its error.
Where that leaves open whether it exceeds the bound that is asked for, integers of 64 bits decide,
and where these do not suffice rational numbers. None of it is shared with the engine that
simplifies.

With e = 2^-53, and d the doubled area of the triangle, which is a sum of two products of
differences: it is off by at most 4 e D, where D is the sum of the magnitudes. The doubled areas a
and b of the parts opposite two corners are off by 4 e A and 4 e B. So a / d is off by
(4 e A + |a / d| 4 e D) / (|d| - 4 e D) and two roundings. The distance
(z - z_c) - ((z_a - z_c) a / d + (z_b - z_c) b / d) has the errors of the two quotients times the
differences of heights, and six roundings. A factor of 2 covers terms of higher order, 1e-300
underflow.

As integers: differences from the corner c whose rounding error is 0, and the bound, are multiples
of a power of two. Let those along x and y be less than 2^p of one such step, heights and the bound
less than 2^h of another. Then a, b and d are less than 2^(2p+1), and each of the three products in
|(z - z_c) d - (z_a - z_c) a - (z_b - z_c) b| <= bound |d| is less than 2^(2p+h+1), so none of the
sums overflows if 2p + h <= 60. Rasters are such: neighbours are few steps apart, and often just as
far from the surface as permitted.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Array, Floats, Progress, Rows
from liftmesh.planar.positions import pieces

if TYPE_CHECKING:
    from liftmesh.planar.triangulation import Triangulation

_E = 2.0**-53
_PIECE = 2**17  # points that are located in one call: their order makes the way to each short
_CACHED = 2**13  # points whose numbers fit the cache
_MOST_BITS = 60  # of a product of three differences
_LARGE = 2**12  # more than exponents


@dataclass(frozen=True, slots=True)
class Deviation:
    """The largest distance of points from a surface."""

    largest: float
    beyond: int


def deviation(
    triangulation: Triangulation,
    heights: Floats,
    points: Floats,
    z: Floats,
    bound: float,
    progress: Progress | None = None,
) -> Deviation:
    """Compare points with a surface."""
    largest, beyond = 0.0, 0
    corners = np.column_stack([triangulation.points, heights])
    for part in pieces(len(points), _PIECE):
        rows = triangulation.simplices[triangulation.find_simplex(points[part])]
        sample = np.column_stack([points[part], z[part]])
        for few in pieces(len(sample), _CACHED):
            found = _compared(corners[rows[few]], sample[few], bound)
            largest, beyond = max(largest, found.largest), beyond + found.beyond
        if progress is not None:
            progress(min(part.stop / len(points), 1.0))
    return Deviation(float(largest), beyond)


def _compared(corners: Array, sample: Floats, bound: float) -> Deviation:
    """Compare samples with the planes of their triangles."""
    with np.errstate(all="ignore"):
        distance, error = _distances(corners, sample)
        upper = distance + error
        is_beyond = distance - error > bound
        is_open = ~((upper <= bound) | is_beyond)
        if not is_open.any():
            return Deviation(float(upper.max(initial=0.0)), int(np.count_nonzero(is_beyond)))
        opened = np.flatnonzero(is_open)
        is_corner = _is_corner(corners[opened], sample[opened])
        upper[opened[is_corner]] = 0
        # Those whose error is unknown are left to rationals: `bound` would say nothing of them.
        is_known = np.isfinite(upper[opened])
        is_within = is_corner | (is_known & _within(corners[opened], sample[opened], bound))
    upper[opened[is_within]] = np.minimum(upper[opened[is_within]], bound)
    left = opened[~is_within]
    exact = list(_exactly(corners[left], sample[left]))
    upper[left] = [_upwards(each) for each in exact]
    beyond = np.count_nonzero(is_beyond) + sum(each > Fraction(bound) for each in exact)
    return Deviation(float(upper.max()), int(beyond))


def _is_corner(corners: Array, sample: Floats) -> Array:
    found: Array = (corners == sample[:, None]).all(axis=2).any(axis=1)
    return found


def _within(corners: Array, sample: Floats, bound: float) -> Array:
    """Whether samples are within the bound, by integers; False where these do not suffice."""
    a, b, c = np.moveaxis(corners, 1, 0)
    numbers = np.stack([a, b, sample]).transpose(0, 2, 1)
    apart, is_exact = _difference(numbers, c.T)
    given = np.full_like(apart[0, :1], bound)
    x_y, planar_bits = _in_steps(apart[:, :2].reshape(6, -1))
    heights, height_bits = _in_steps(np.concatenate([apart[:, 2], given]))
    is_exact &= 2 * planar_bits + height_bits <= _MOST_BITS
    (ax, ay), (bx, by), (x, y) = np.where(is_exact, x_y, 0).astype(np.int64).reshape(3, 2, -1)
    to_a, to_b, rise, most = np.where(is_exact, heights, 0).astype(np.int64)
    whole = ax * by - ay * bx
    excess = rise * whole - to_a * (x * by - y * bx) - to_b * (ax * y - ay * x)
    found: Array = is_exact & (np.abs(excess) <= most * np.abs(whole))
    return found


def _difference(numbers: Floats, less: Floats) -> tuple[Floats, Array]:
    """Subtract; and whether no difference of a sample is rounded (D. E. Knuth's TwoSum)."""
    found = numbers - less
    back = found - numbers
    error = (numbers - (found - back)) + (-less - back)
    return found, (error == 0).all(axis=(0, 1))


def _in_steps(values: Floats) -> tuple[Floats, Array]:
    """Divide columns by the largest power of two of which all values are multiples."""
    mantissa, exponent = np.frexp(values)
    digits = np.ldexp(mantissa, 53).astype(np.int64)
    lowest = np.frexp((digits & -digits).astype(np.float64))[1] - 54 + exponent
    is_zero = values == 0
    step = np.where(is_zero, _LARGE, lowest).min(axis=0)
    bits = np.where(is_zero, -_LARGE, exponent).max(axis=0) - step
    return np.ldexp(values, -step), bits


def _distances(corners: Array, sample: Floats) -> tuple[Floats, Floats]:
    """Compute distances, and a bound on the error of each."""
    a, b, c = np.moveaxis(corners, 1, 0)
    whole, of_whole = _doubled_area(a - c, b - c)
    first, of_first = _doubled_area(sample - c, b - c)
    second, of_second = _doubled_area(a - c, sample - c)
    u, v = first / whole, second / whole
    rise = sample[:, 2] - c[:, 2]
    to_a, to_b = a[:, 2] - c[:, 2], b[:, 2] - c[:, 2]
    distance = np.abs(rise - (to_a * u + to_b * v))
    sure = np.abs(whole) - of_whole
    of_u = (of_first + np.abs(u) * of_whole) / sure + 4 * _E * np.abs(u)
    of_v = (of_second + np.abs(v) * of_whole) / sure + 4 * _E * np.abs(v)
    rounding = 8 * _E * (np.abs(rise) + np.abs(to_a * u) + np.abs(to_b * v))
    error = 2 * (np.abs(to_a) * of_u + np.abs(to_b) * of_v + rounding) + 1e-300
    return distance, np.where(sure > of_whole, error, np.inf)


def _doubled_area(one: Floats, other: Floats) -> tuple[Floats, Floats]:
    left, right = one[:, 0] * other[:, 1], one[:, 1] * other[:, 0]
    return left - right, 4 * _E * (np.abs(left) + np.abs(right)) + 1e-300


def _exactly(corners: Array, sample: Floats) -> Iterator[Fraction]:
    """Yield distances as rational numbers."""
    for triangle, point in zip(corners.tolist(), sample.tolist(), strict=True):
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (map(Fraction, each) for each in triangle)
        x, y, z = map(Fraction, point)
        whole = (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)
        u = ((x - cx) * (by - cy) - (y - cy) * (bx - cx)) / whole
        v = ((ax - cx) * (y - cy) - (ay - cy) * (x - cx)) / whole
        yield abs(z - cz - u * (az - cz) - v * (bz - cz))


def _upwards(value: Fraction) -> float:
    """Round to a double that is not less."""
    try:
        found = float(value)
    except OverflowError:
        return math.inf
    return found if Fraction(found) >= value else math.nextafter(found, math.inf)


def of_rows(heights: Floats, left_out: Rows, representatives: Rows) -> float:
    """Return the largest distance of merged rows from the row that stands for them."""
    merged = representatives >= 0
    apart = heights[left_out[merged]] - heights[representatives[merged]]
    return float(np.abs(apart).max(initial=0.0))
