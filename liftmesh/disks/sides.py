"""The sides of the cells of disks: between which disks each one runs, and from where to where.

A side is an arc of a hyperbola. It ends where three cells meet, in the centre of the
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

*Arcs* become polylines within a tolerance. Seen from the centre of the smaller disk p, a side that
its cell shares with that of q is the curve

    R = P / (2 (d cos t + r)),   P = d^2 - r^2,

with t the direction, counted from that of q, R the distance, d the distance of the centres, and r
the difference of the radii, q's less p's: the polar form of a conic about its focus. Its tangent at
t has, in these axes, the direction (-r sin t, d + r cos t). Two tangents meet in the direction of
the mean m of both t, at the distance P / (2 (d cos m + r cos h)), with h half of what these differ
by. If p is nearly inside q, d - r is P / (d + r), and 1 + cos t is 2 cos^2 (t / 2): so nothing
cancels.

The curve is convex, so between two points it stays in the triangle of the chord and the tangents
there. If the tangent turns by u, and the chord has the length L, that is at most L / 2 tan(u / 2)
high: so far is the chord off the curve at most. An arc is halved, by t, until this is within the
tolerance, or the triangle outside of what is to be seen.

A chord must not pass a centre on the wrong side, however large the tolerance. From q the whole
curve spans less than half a turn; from p an arc is halved until it does. So the points go round
both disks, and a cell is star-shaped about its centre. Hence polygons of cells cannot overlap: each
is counter-clockwise and simple, and they share their sides.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from math import isqrt
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from liftmesh._typing import Floats, Indices, Integers, Mask, Rows
from liftmesh.base.arrays import lower_to, pair_keys, pairs_of_keys
from liftmesh.base.frozen import cached_property
from liftmesh.base.options import shown
from liftmesh.errors import InputError

if TYPE_CHECKING:
    from liftmesh.disks.graph import DiskGraph

Box = tuple[float, float, float, float]

_WIDEST = 0.75 * np.pi  # that a chord may span, seen from p
_NARROWEST = 2.0**-40  # a turn whose half float64 still tells well
_FARTHER = 1.01  # how much farther than a box curves are followed
_NEARLY_STRAIGHT, _OF_ONE_SIZE = 0.9, 2.0  # cosine of the turn, and ratio of distances from p
_POINTS, _POINTS_EACH = 1 << 24, 256  # of all arcs, or of each in the mean: what is still drawn


class TooManyPointsError(Exception):
    """There are more points than are drawn: the limit is the only argument."""


class Polylines(NamedTuple):
    """Points along arcs."""

    starts: Integers  # of arcs, and the end; each has two points at least
    points: Floats


@dataclass(frozen=True, eq=False)
class Arcs:
    """Parts of the curves of points as far from a disk p as from a disk q, not smaller."""

    rows: Rows  # p and q
    ends: Rows  # the vertices at both ends, counter-clockwise about p; -1 if there is none
    focus: Floats  # the centre of p
    axis: Floats  # from there to the centre of q
    radius_difference: Floats  # q's less p's
    power: Floats
    turns: Floats  # the directions of both ends, in radians from that of q

    @cached_property
    def centre_distance(self) -> Floats:
        """The distance d of the centres."""
        distance: Floats = np.hypot(self.axis[:, 0], self.axis[:, 1])
        return distance

    @cached_property
    def direction(self) -> Floats:
        """The axis, one long."""
        unit: Floats = self.axis / self.centre_distance[:, None]
        return unit

    @cached_property
    def clearance(self) -> Floats:
        """The difference d - r; half of it is the distance from p to the vertex of the curve."""
        clearance: Floats = self.power / (self.centre_distance + self.radius_difference)
        return clearance

    def select(self, chosen: Mask) -> Arcs:
        """Return some arcs."""
        rows, ends, focus, axis = (
            self.rows[chosen], self.ends[chosen], self.focus[chosen], self.axis[chosen]
        )  # fmt: skip
        difference, power = self.radius_difference[chosen], self.power[chosen]
        return Arcs(rows, ends, focus, axis, difference, power, self.turns[chosen])

    def near(self, box: Box) -> Arcs:
        """Cut off what is farther from p than all of a box."""
        corners = np.array([[box[i], box[j]] for i in (0, 2) for j in (1, 3)])
        step = corners - self.focus[:, None]
        reach = _FARTHER * np.hypot(step[..., 0], step[..., 1]).max(axis=1)
        share = (self.power / (2 * reach) + self.clearance) / (2 * self.centre_distance)
        widest = 2 * np.arccos(np.sqrt(np.clip(share, 0, 1)))
        first, last = self.turns.T
        is_cut = np.stack([first < -widest, last > widest], axis=1)
        ends = np.where(is_cut, -1, self.ends)
        turns = np.stack([np.maximum(first, -widest), np.minimum(last, widest)], axis=1)
        left = (turns[:, 0] < turns[:, 1]) | (ends >= 0).all(axis=1)
        limited = replace(self, ends=ends.astype(np.int32), turns=turns)
        return limited.select(left)

    def at(self, arc: Indices, turn: Floats) -> Floats:
        """Return points of curves."""
        return self.focus[arc] + self._seen(arc, turn, turn, 0)

    def _seen(self, arc: Indices, turn: Floats, mean: Floats, half: Floats | int) -> Floats:
        """Return where tangents meet in a direction, from p: on the curve, if half is 0."""
        tangent = self._meets(arc, mean, half)
        x, y = self.direction[arc].T
        with np.errstate(all="ignore"):  # in the direction of an asymptote
            reach = self.power[arc] / (2 * tangent)
            cosine, sine = reach * np.cos(turn), reach * np.sin(turn)
            return np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=1)

    def _meets(self, arc: Indices, mean: Floats, half: Floats | int) -> Floats:
        """Return d cos m + r cos h."""
        near: Floats = 2 * self.centre_distance[arc] * np.cos(mean / 2) ** 2 - self.clearance[arc]
        meets: Floats = near - 2 * self.radius_difference[arc] * np.sin(np.divide(half, 2)) ** 2
        return meets

    def polylines(self, vertices: Floats, box: Box, max_deviation: float) -> Polylines:
        """Return polylines whose chords are at most a tolerance off, wherever a box sees them."""
        arc, turn = self._halved(box, max_deviation)
        every = np.arange(len(self.rows))
        arc = np.concatenate([every, arc, every])
        place = self.at(arc, np.concatenate([self.turns[:, 0], turn, self.turns[:, 1]]))
        for k, at in ((0, every), (1, every - len(every))):
            has_end = self.ends[:, k] >= 0
            place[at[has_end]] = vertices[self.ends[has_end, k]]
        is_inner = np.zeros(len(arc), dtype=np.int8)
        is_inner[len(every) :], is_inner[len(arc) - len(every) :] = 1, 2
        order = np.lexsort((np.concatenate([every, turn, every]), is_inner, arc))
        starts = np.concatenate([[0], np.cumsum(np.bincount(arc, minlength=len(every)))])
        return Polylines(starts.astype(np.int64), place[order])

    def _halved(self, box: Box, max_deviation: float) -> tuple[Indices, Floats]:
        """Return the directions at which arcs are divided."""
        arc = np.flatnonzero(self.turns[:, 0] < self.turns[:, 1])
        low, high = self.turns[arc].T
        divisions = [(arc[:0], low[:0])]
        points, most = 0, max(_POINTS, _POINTS_EACH * len(arc))
        while len(arc):
            divided, ahead = self._coarse(arc, low, high, box, max_deviation)
            arc, low, high = arc[divided], low[divided], high[divided]
            points += len(arc)
            if points + ahead > most:
                raise TooManyPointsError(most)
            middle = (low + high) / 2
            divisions.append((arc, middle))
            arc = np.concatenate([arc, arc])
            low, high = np.concatenate([low, middle]), np.concatenate([middle, high])
        arcs, turns = zip(*divisions, strict=True)
        return np.concatenate(arcs), np.concatenate(turns)

    def _coarse(
        self, arc: Indices, low: Floats, high: Floats, box: Box, max_deviation: float
    ) -> tuple[Mask, float]:
        """Return which chords are too far off, or pass p on the wrong side, and what is to come."""
        # The second is about how many more points there will be after these are halved, counted
        # where that is known: all of the arc is in the box, and each half is a quarter as high.
        mean, half = (low + high) / 2, (high - low) / 2
        difference = self.radius_difference[arc]
        meets, clearance = self._meets(arc, mean, half), self.clearance[arc]
        start, end = self._seen(arc, low, low, 0), self._seen(arc, high, high, 0)
        apex = self._seen(arc, mean, mean, half)
        (ax, ay), (bx, by) = (
            (-difference * np.sin(t), clearance + 2 * difference * np.cos(t / 2) ** 2)
            for t in (low, high)
        )
        sine, cosine = 2 * difference * np.sin(half) * meets, ax * bx + ay * by
        length = np.hypot(*(end - start).T)
        with np.errstate(all="ignore"):
            both = np.hypot(ax, ay) * np.hypot(bx, by)
            height = length / 2 * sine / (both + cosine)
        around = np.stack([start, end, apex]) + self.focus[arc]
        is_seen = (around.max(axis=0) >= box[:2]).all(axis=1)
        is_seen &= (around.min(axis=0) <= box[2:]).all(axis=1)
        is_wide = (half > _WIDEST / 2) & (difference > 0)
        is_off = ~(height <= max_deviation) & is_seen & (half > _NARROWEST)
        coarse: Mask = is_wide | is_off | ~(meets > 0)
        coarse &= half > _NARROWEST
        is_inside = (around.min(axis=0) >= box[:2]).all(axis=1)
        is_inside &= (around.max(axis=0) <= box[2:]).all(axis=1)
        near, far = np.sort(np.hypot(*np.stack([start, end]).transpose(2, 0, 1)), axis=0)
        is_even = (cosine > _NEARLY_STRAIGHT * both) & (far < _OF_ONE_SIZE * near)
        known = height[coarse & is_off & is_inside & is_even]
        return coarse, float(np.maximum(np.sqrt(known / max_deviation) - 2, 0).sum())


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
