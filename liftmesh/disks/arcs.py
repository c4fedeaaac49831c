"""Arcs of hyperbolas between disks, as polylines within a tolerance.

Seen from the centre of the smaller disk p, a side that its cell shares with that of q is the curve

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

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from liftmesh._typing import Floats, Indices, Integers, Mask, Rows
from liftmesh.base.frozen import cached_property

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
