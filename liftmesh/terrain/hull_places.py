"""For points outside a convex hull, the nearest points on it.

A side of the hull is visible from a point that is beyond its line. The visible sides follow one
another, and along them a point projects first after the beginnings of sides, then before: so the
nearest place is found by bisection. What is visible is decided exactly; for what projects where,
differences of coordinates are pairs of doubles, and products of these are added as such; points far
away in relation to the hull are fractions.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import TypeAlias

import numpy as np

from liftmesh._typing import Array, Floats, Integers, Mask
from liftmesh.predicates import orient2d

_FAR = 2.0**50  # sizes of the hull, beyond which pairs of doubles are not enough
_SHORT = 2.0**-400  # of the hull: a side of whose square little is left
_LARGE = 1e300  # coordinates whose differences may be beyond the doubles
_SPLIT = 2.0**27 + 1
_REACH = 0.6 * np.pi  # more than between a visible side and the nearest place, pi / 2; less than pi


_Dot: TypeAlias = Callable[[Floats, Floats, Floats], Array]  # of b - a and c - a
_Pair: TypeAlias = tuple[Floats, Floats]


class HullPlaces:
    """A convex hull, prepared: its corners counter-clockwise, (h, 2)."""

    def __init__(self, corners: Floats) -> None:
        spare = 2 if np.abs(corners).max() > _LARGE else 0
        safe = np.ldexp(corners, -spare)
        self._exponent = int(np.frexp(np.ptp(safe, axis=0).max())[1]) + spare
        self._given, self._scaled = corners, np.ldexp(corners, -self._exponent)
        sides = np.roll(self._scaled, -1, axis=0) - self._scaled
        self._is_fine = bool((np.abs(sides).max(axis=1) > _SHORT).all())
        sides = np.roll(safe, -1, axis=0) - safe
        turns = np.diff(np.arctan2(sides[:, 1], sides[:, 0])) % (2 * np.pi)
        turns[turns > 1.5 * np.pi] = 0  # by rounding: none is more than pi
        angles = np.concatenate([[0], np.cumsum(turns)])
        around = np.concatenate([angles - 2 * np.pi, angles, angles + 2 * np.pi])
        self._first = np.searchsorted(around, angles - _REACH) - len(corners)
        self._end = np.searchsorted(around, angles + _REACH) - len(corners)

    def nearest(self, points: Floats) -> tuple[Integers, Floats]:
        """Return the side of each point's nearest place, -1 of points inside, and where on it."""
        side, share = np.full(len(points), -1), np.zeros(len(points))
        start = self._visible_side(points)
        beyond = np.flatnonzero(start >= 0)
        with np.errstate(over="ignore", invalid="ignore"):  # those are far
            scaled = np.ldexp(points, -self._exponent)
            is_near = (np.abs(scaled - self._scaled[0]) < _FAR).all(axis=1) & self._is_fine
        near, far = beyond[is_near[beyond]], beyond[~is_near[beyond]]
        for some, dot, corners, found in (
            (near, _dot_of_pairs, self._scaled, scaled),
            (far, _dot_of_fractions, self._given, points),
        ):
            if len(some):
                place = self._along(points[some], start[some], corners, found[some], dot)
                side[some], share[some] = place
        return side, share

    def _turn(self, side: Integers, points: Floats) -> Array:
        start, end = (self._given[each % len(self._given)] for each in (side, side + 1))
        return orient2d(start, end, points)

    def _visible_side(self, points: Floats) -> Integers:
        """Find a side that is visible from each point; -1 if none is, as from inside."""
        count, first = len(self._given), self._given[0]
        # The first corner sees a point between two others, and so beyond the side between them.
        zero = np.zeros(len(points), np.int64)
        of_last = orient2d(first, self._given[-1], points)

        def is_left(k: Integers, row: Integers) -> Mask:
            turn = orient2d(first, self._given[k], points[row])
            return np.where(of_last[row] == 0, turn > 0, turn >= 0)

        start = _last(zero + 1, zero + count - 1, is_left)
        start = np.where(self._turn(zero, points) < 0, 0, np.where(of_last > 0, count - 1, start))
        return np.where(self._turn(start, points) < 0, start, -1)

    def _along(
        self, points: Floats, start: Integers, corners: Floats, scaled: Floats, dot: _Dot
    ) -> tuple[Integers, Floats]:
        """Find the side, from a visible one on, and the place on it."""
        count = len(corners)

        def along(k: Integers, q: Floats) -> Array:
            return dot(corners[k % count], corners[(k + 1) % count], q)

        def is_past(k: Integers, row: Integers) -> Mask:
            is_visible, is_along = self._turn(k, points[row]) < 0, along(k, scaled[row]) >= 0
            return np.where(k > start[row], is_visible & is_along, ~is_visible | is_along)

        found = _last(self._first[start] - 1, self._end[start], is_past) % count
        part = along(found, scaled) / along(found, corners[(found + 1) % count])
        return found, np.minimum(np.maximum(part, 0), 1).astype(np.float64)


def _last(low: Integers, high: Integers, holds: Callable[[Integers, Integers], Mask]) -> Integers:
    """Return the last number below high for which something holds of a row, as it does for low."""
    low, high = low.copy(), high.copy()
    while len(rows := np.flatnonzero(high - low > 1)):
        middle = (low[rows] + high[rows]) // 2
        is_so = holds(middle, rows)
        low[rows[is_so]] = middle[is_so]
        high[rows[~is_so]] = middle[~is_so]
    return low


def _dot_of_fractions(a: Floats, b: Floats, c: Floats) -> Array:
    """Compute the dot products of b - a and c - a."""
    p, q, r = (np.vectorize(Fraction, otypes=[object])(each) for each in (a, b, c))
    dots: Array = ((q - p) * (r - p)).sum(axis=1)
    return dots


def _dot_of_pairs(a: Floats, b: Floats, c: Floats) -> Array:
    (x, y), (u, v) = (zip(*_difference(each.T, a.T), strict=True) for each in (b, c))
    return _sum(_product(x, u), _product(y, v))


def _difference(a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """Return the difference, rounded, and what that lacks."""
    rounded = a - b
    virtual = a - rounded
    return rounded, (a - (rounded + virtual)) + (virtual - b)


def _product(p: _Pair, q: _Pair) -> _Pair:
    """Multiply pairs of doubles."""
    high = p[0] * q[0]
    (a, b), (c, d) = _halves(p[0]), _halves(q[0])
    return high, (((a * c - high) + a * d + b * c) + b * d) + (p[0] * q[1] + p[1] * q[0])


def _halves(a: Floats) -> _Pair:
    scaled = _SPLIT * a
    upper = scaled - (scaled - a)
    return upper, a - upper


def _sum(p: _Pair, q: _Pair) -> Floats:
    high, low = _difference(p[0], -q[0])
    total: Floats = high + (low + p[1] + q[1])
    return total
