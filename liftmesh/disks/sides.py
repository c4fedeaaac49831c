"""The sides of the cells of disks: between which disks each one runs, and from where to where.

A side is an arc of a hyperbola (`arcs.py`). It ends where three cells meet, in the centre of the
circle that touches their disks, or not at all.

Relative to the smallest of the three disks, p, this vertex v is at the distance R from p if, for
both others, x vx + y vy + r R = P / 2, with (x, y, r) what the disk has more, and P its power.
Newton's method solves these with vx^2 + vy^2 = R^2, from the rounded circle on. Where a disk is
nearly inside another, terms cancel. There v is computed from the minors of the two equations (see
`apollonius/polynomials.hpp`), in rationals and with a root of many digits.

With x, y, r the differences of centres and radii, the power P = x^2 + y^2 - r^2 is positive unless
one disk contains the other. Where it nearly does, the terms cancel. So differences and products are
kept with what rounding takes off them (T. J. Dekker, "A floating-point technique for extending the
available precision", Numer. Math. 18, 1971), and P has twice the digits of a double but for what
cancels.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import isqrt
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from liftmesh._typing import Floats, Indices, Integers, Rows
from liftmesh.base.arrays import lower_to, pair_keys, pairs_of_keys
from liftmesh.base.options import shown
from liftmesh.disks.arcs import Arcs, Box, TooManyPointsError
from liftmesh.errors import InputError

if TYPE_CHECKING:
    from liftmesh.disks.graph import DiskGraph

_COINCIDENT = 2.0**-44  # of the numbers involved: what rounding may put between equal vertices
_STEPS = 3  # of Newton's method: from half of the digits, one would do
_OFF = 2.0**-44  # of the terms: what equations may be off
_CANCELLED = 2.0**-20  # of d R: powers that are less are too small for the equations
_DIGITS = 1024  # binary ones of a root
_SPLIT = 2.0**27 + 1


class Traced(NamedTuple):
    """The sides of all cells that come near a box, as polylines."""

    rows: Rows  # the disks on the left and on the right of each
    ends: Rows  # the vertices where it starts and ends; -1 without end, or cut off beyond the box
    starts: Integers  # of sides among the points, and the end
    points: Floats
    box: Box  # outside of it sides are coarse, and some are left out

    @property
    def segments(self) -> Indices:
        """The points from which a segment leads to the next one, (s,) intp."""
        is_start = np.ones(len(self.points), dtype=np.bool_)
        is_start[self.starts[1:] - 1] = False
        return np.flatnonzero(is_start)


def trace_sides(graph: DiskGraph, box: Box, max_deviation: float) -> Traced:
    """Follow the sides of all cells as far as a box sees them."""
    largest = max(np.abs(graph.centers).max(initial=0), graph.radii.max(initial=0), *map(abs, box))
    scale = int(np.frexp(largest)[1])  # no square overflows, and no product of such underflows

    def scaled(values: Floats) -> Floats:
        return np.ldexp(values, -scale)

    disks = scaled(np.column_stack([graph.centers, graph.radii]))
    all_sides = sides(graph.simplices, graph.neighbors, graph.hull_pairs)
    vertices = vertices_of(disks, graph.simplices, scaled(graph.circles))
    vertices = merge_coinciding(all_sides, disks[:, :2], vertices)
    left, low, right, high = scaled(np.array(box)).tolist()
    limits = left, low, right, high
    arcs = arcs_of(all_sides, disks, vertices).near(limits)
    try:
        starts, points = arcs.polylines(vertices, limits, float(np.ldexp(max_deviation, -scale)))
    except TooManyPointsError as error:
        (most,) = error.args
        raise InputError(
            f"max_deviation is {shown(max_deviation)}, by which arcs have more than {most:,} "
            "points: give a larger one"
        ) from error
    return Traced(arcs.rows, arcs.ends, starts, np.ldexp(points, scale), box)


def pieces_in(lines: Traced) -> Iterator[tuple[tuple[int, int], Floats]]:
    """Cut off what of polylines is outside of their box."""
    first = lines.segments
    start, end = lines.points[first], lines.points[first + 1]
    low, high = shares_in(start, end, lines.box)
    left = np.flatnonzero(low < high)
    if not len(left):
        return
    first, low, high = first[left], low[left], high[left]
    start, end = start[left], end[left]
    step = end - start
    start, end = (
        np.where(share[:, None] == whole, at, start + share[:, None] * step)
        for share, whole, at in ((low, 0.0, start), (high, 1.0, end))
    )
    side = (np.searchsorted(lines.starts, first, side="right") - 1).tolist()
    goes_on = (np.diff(first) == 1) & (np.diff(side) == 0) & (high[:-1] == 1) & (low[1:] == 0)
    bounds = np.flatnonzero(np.concatenate([[True], ~goes_on, [True]]))
    pairs = np.sort(lines.rows, axis=1).tolist()
    for one, next_one in zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True):
        a, b = pairs[side[one]]
        yield (a, b), np.concatenate([start[one:next_one], end[next_one - 1 : next_one]])


def shares_in(start: Floats, end: Floats, box: Box) -> tuple[Floats, Floats]:
    """Return from which to which share of each segment it is in a box (Liang and Barsky)."""
    first, last = np.zeros(len(start)), np.ones(len(start))
    step = end - start
    for axis in range(2):
        low, high = box[axis] - start[:, axis], box[axis + 2] - start[:, axis]
        with np.errstate(all="ignore"):
            enter, leave = np.sort([low / step[:, axis], high / step[:, axis]], axis=0)
        is_level = step[:, axis] == 0
        is_apart = is_level & ((low > 0) | (high < 0))
        first = np.where(is_level, first, np.maximum(first, enter))
        last = np.where(is_level, np.where(is_apart, -1, last), np.minimum(last, leave))
    return first, last


class Sides(NamedTuple):
    """The sides of all cells."""

    pairs: Rows  # the two disks of each
    # The triangles to the left and to the right of the edge from one disk to the other, whose
    # circles have their centres at the ends; -1 where the side has no end.
    ends: Rows


def sides(simplices: Rows, neighbors: Rows, hull: Rows) -> Sides:
    """List the sides of all cells."""
    left = np.repeat(np.arange(len(simplices)), 3)
    right = neighbors.reshape(-1)
    edges = simplices[:, [1, 2, 2, 0, 0, 1]].reshape(-1, 2)
    once = right < left
    rim = pair_keys(*hull.T)
    bare = rim[~np.isin(rim, pair_keys(*edges[right < 0].T))]
    lines = np.stack(pairs_of_keys(bare), axis=1)
    lines = lines[lines[:, 0] < lines[:, 1]]
    ends = np.stack([left, right], axis=1)[once]
    return Sides(
        np.concatenate([edges[once], lines]).astype(np.int32),
        np.concatenate([ends, np.full((len(lines), 2), -1)]).astype(np.int32),
    )


def merge_coinciding(all_sides: Sides, centers: Floats, vertices: Floats) -> Floats:
    """Give one position to vertices that only rounding keeps apart."""
    bounded = (all_sides.ends >= 0).all(axis=1)
    one, other = all_sides.ends[bounded].T
    near = centers[all_sides.pairs[bounded, 0]]
    size = np.abs(near).max(axis=1) + np.abs(vertices[one] - near).max(axis=1)
    apart = np.abs(vertices[one] - vertices[other]).max(axis=1)
    equal = apart <= _COINCIDENT * size
    place = _first_of(len(vertices), one[equal], other[equal])
    merged: Floats = vertices[place]
    return merged


def _first_of(count: int, one: Rows, other: Rows) -> Indices:
    """Name each of so many things after the first of those that pairs connect it with."""
    first = np.arange(count)
    while True:
        least = np.minimum(first[one], first[other])
        named = first.copy()
        lower_to(named, one, least)
        lower_to(named, other, least)
        named = named[named]
        if np.array_equal(named, first):
            return first
        first = named


def arcs_of(all_sides: Sides, disks: Floats, vertices: Floats) -> Arcs:
    """Describe sides as arcs."""
    is_turned = disks[all_sides.pairs[:, 1], 2] < disks[all_sides.pairs[:, 0], 2]
    rows = np.where(is_turned[:, None], all_sides.pairs[:, ::-1], all_sides.pairs)
    # Counter-clockwise about the first disk, a side starts at the triangle on its right.
    ends = np.where(is_turned[:, None], all_sides.ends, all_sides.ends[:, ::-1])
    near, far = rows.T
    relative, power = differences_of(disks, far, near)
    focus, axis, difference = disks[near, :2], relative[:, :2], relative[:, 2]
    turns = np.full((len(near), 2), (-np.pi, np.pi))
    for k in range(2):
        has_end = ends[:, k] >= 0
        step = vertices[ends[has_end, k]] - focus[has_end]
        along = axis[has_end]
        cross, dot = along[:, 0] * step[:, 1] - along[:, 1] * step[:, 0], (along * step).sum(1)
        turns[has_end, k] = np.arctan2(cross, dot)
    return Arcs(rows, ends, focus, axis, difference, power, turns)


def vertices_of(disks: Floats, simplices: Rows, circles: Floats) -> Floats:
    """Compute where cells meet."""
    turn = disks[simplices, 2].argmin(axis=1)[:, None] + np.arange(3)
    p, q, r = np.take_along_axis(simplices, turn % 3, axis=1).T
    (first, power), (second, other) = (differences_of(disks, k, p) for k in (q, r))
    rows, half = np.stack([first, second], axis=1), np.stack([power, other], axis=1) / 2
    solution = np.c_[circles[:, :2] - disks[p, :2], circles[:, 2]]
    solution[:, 2] = np.hypot(solution[:, 0], solution[:, 1])
    with np.errstate(all="ignore"):
        error = _refine(solution, rows, half)
        terms = np.abs(rows * solution[:, None]).sum(axis=2)
        is_poor = ~((np.abs(error) <= _OFF * terms) & (half > _CANCELLED * terms)).all(axis=1)
    places: Floats = disks[p, :2] + solution[:, :2]
    for k in np.flatnonzero(is_poor).tolist():
        places[k] = _exactly(*(disks[row].tolist() for row in (p[k], q[k], r[k])))
    return places


def _refine(solution: Floats, rows: Floats, half: Floats) -> Floats:
    """Improve (vx, vy, R) in place, and return what the equations are off."""
    error = _residuals(solution, rows, half)
    for _ in range(_STEPS):
        tried = solution - _step(solution, rows, error)
        tried[:, 2] = np.hypot(tried[:, 0], tried[:, 1])
        off = _residuals(tried, rows, half)
        is_better = np.abs(off).sum(axis=1) < np.abs(error).sum(axis=1)
        solution[is_better], error[is_better] = tried[is_better], off[is_better]
    return error


def _residuals(solution: Floats, rows: Floats, half: Floats) -> Floats:
    off: Floats = np.einsum("mij,mj->mi", rows, solution) - half
    return off


def _step(solution: Floats, rows: Floats, error: Floats) -> Floats:
    """Solve for a step that changes nothing of vx^2 + vy^2 - R^2."""
    first, second = rows[:, 0], rows[:, 1]
    cone = solution * (1.0, 1.0, -1.0)
    determinant = (first * np.cross(second, cone)).sum(axis=1)[:, None]
    step: Floats = (
        error[:, :1] * np.cross(second, cone) + error[:, 1:] * np.cross(cone, first)
    ) / determinant
    return step


def _exactly(*disks: list[float]) -> tuple[float, float]:
    """Compute the vertex of three disks, counter-clockwise about it, and round it."""
    p, q, r = ([Fraction(value) for value in disk] for disk in disks)
    (x, y, more, power), (u, v, other, second) = _relative(p, q), _relative(p, r)
    xp, yp, rp = x * second - u * power, y * second - v * power, more * second - other * power
    xy, xr, yr = x * v - u * y, x * other - u * more, y * other - v * more
    root = _root(power * second * _relative(q, r)[3])
    twice = 2 * (xp * xr + yp * yr + xy * root)
    along = -xp * rp - yp * root, -yp * rp + xp * root
    return float(p[0] + along[0] / twice), float(p[1] + along[1] / twice)


def _relative(p: list[Fraction], q: list[Fraction]) -> tuple[Fraction, ...]:
    x, y, r = (b - a for a, b in zip(p, q, strict=True))
    return x, y, r, x * x + y * y - r * r


def _root(square: Fraction) -> Fraction:
    """Return the root, with so many digits."""
    product = square.numerator * square.denominator
    shift = max(0, 2 * _DIGITS - product.bit_length()) // 2
    return Fraction(isqrt(product << 2 * shift), square.denominator << shift)


def differences_of(disks: Floats, of: Rows, than: Rows) -> tuple[Floats, Floats]:
    """Subtract disks, less than 2^300, from others, and compute the powers of the pairs."""
    a, b = disks[of], disks[than]
    difference = a - b
    rounded = difference - a
    rest = (a - (difference - rounded)) - (b + rounded)
    square = difference * difference
    high = difference * _SPLIT
    high -= high - difference
    low = difference - high
    lost = ((high * high - square) + 2 * high * low) + low * low + 2 * difference * rest
    x, y, r = square.T
    total = x + y
    other = total - x
    lost_of_sum = (x - (total - other)) + (y - other)
    power = total - r
    other = power - total
    lost_of_power = (total - (power - other)) - (r + other)
    least = lost_of_sum + lost_of_power + (lost[:, 0] + lost[:, 1] - lost[:, 2])
    return difference, power + least
