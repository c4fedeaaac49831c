"""The places of a convex hull that are nearest to points beyond it.

A side of the hull is visible from a point that is beyond its line. The visible sides follow one
another, and along them a point projects first after the beginnings of sides, then before: so the
nearest place is found by bisection. Differences of coordinates are pairs of doubles, and products
of these are added as such; points far away in relation to the hull are fractions.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import TypeAlias

import numpy as np

from liftmesh._typing import Array, Floats, Integers, Mask

_FAR = 2.0**50  # sizes of the hull, beyond which pairs of doubles are not enough
_SHORT = 2.0**-400  # of the hull: a side of whose square little is left
_LARGE = 1e300  # coordinates whose differences may be beyond the doubles
_LEAST = 2.0**-80  # of a turn: pairs may have lost its sign
_UNSURE = -2
_SPLIT = 2.0**27 + 1
_REACH = 0.6 * np.pi  # more than between a visible side and the nearest place, pi / 2; less than pi


# Of a, b and c, the cross and the dot product of b - a and c - a.
_Products: TypeAlias = Callable[[Array, Array, Array], tuple[Array, Array]]
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
        with np.errstate(over="ignore", invalid="ignore"):  # those are far
            scaled = np.ldexp(points, -self._exponent)
            is_near = (np.abs(scaled - self._scaled[0]) < _FAR).all(axis=1) & self._is_fine
        side, share = np.empty(len(points), np.int64), np.empty(len(points))
        side[is_near], share[is_near] = self._found(self._scaled, scaled[is_near], _in_pairs)
        is_near[is_near] = side[is_near] != _UNSURE
        if not is_near.all():
            far, corners = _as_fractions(points[~is_near]), _as_fractions(self._given)
            side[~is_near], share[~is_near] = self._found(corners, far, _in_fractions)
        return side.clip(-1), share

    def _found(self, corners: Array, points: Array, products: _Products) -> tuple[Integers, Floats]:
        count = len(corners)

        def seen(first: Integers, second: Integers, q: Array) -> tuple[Array, Array]:
            return products(corners[first], corners[second % count], q)

        # The first corner sees a point between two others, and so beyond the side between them.
        zero = np.zeros(len(points), np.int64)
        of_first = seen(zero, zero + 1, points)[0]
        of_last = seen(zero, zero + count - 1, points)[0]

        def is_left(k: Integers, row: Integers) -> Mask:
            turn = seen(zero[row], k, points[row])[0]
            return np.where(of_last[row] == 0, turn > 0, turn >= 0)

        start = _last(zero + 1, zero + count - 1, is_left)
        start = np.where(of_first < 0, 0, np.where(of_last > 0, count - 1, start))
        turn = seen(start, start + 1, points)[0]
        least = np.minimum(np.minimum(of_first, -of_last), turn)
        side, share = np.where(least < _LEAST, _UNSURE, -1), np.zeros(len(zero))
        beyond = np.flatnonzero(turn < 0)
        points, start = points[beyond], start[beyond]

        def is_past(k: Integers, row: Integers) -> Mask:
            turn, along = seen(k % count, k % count + 1, points[row])
            is_visible, is_along = turn < 0, along >= 0
            return np.where(k > start[row], is_visible & is_along, ~is_visible | is_along)

        found = _last(self._first[start] - 1, self._end[start], is_past) % count
        ends = corners[(found + 1) % count]
        part = products(corners[found], ends, points)[1] / products(corners[found], ends, ends)[1]
        side[beyond] = found
        share[beyond] = np.minimum(np.maximum(part, 0), 1).astype(np.float64)
        return side, share


def _last(low: Integers, high: Integers, holds: Callable[[Integers, Integers], Mask]) -> Integers:
    """Return the last number below high for which something holds of a row, as it does for low."""
    low, high = low.copy(), high.copy()
    while len(rows := np.flatnonzero(high - low > 1)):
        middle = (low[rows] + high[rows]) // 2
        is_so = holds(middle, rows)
        low[rows[is_so]] = middle[is_so]
        high[rows[~is_so]] = middle[~is_so]
    return low


def _as_fractions(points: Floats) -> Array:
    exact: Array = np.vectorize(Fraction, otypes=[object])(points)
    return exact


def _in_fractions(a: Array, b: Array, c: Array) -> tuple[Array, Array]:
    (x, y), (u, v) = (b - a).T, (c - a).T
    return x * v - y * u, x * u + y * v


def _in_pairs(a: Array, b: Array, c: Array) -> tuple[Array, Array]:
    (x, y), (u, v) = (zip(*_difference(each.T, a.T), strict=True) for each in (b, c))
    return _sum(_product(x, v), _product(_negative(y), u)), _sum(_product(x, u), _product(y, v))


def _difference(a: Floats, b: Floats) -> tuple[Floats, Floats]:
    """Return the difference, rounded, and what that lacks."""
    rounded = a - b
    virtual = a - rounded
    return rounded, (a - (rounded + virtual)) + (virtual - b)


def _negative(pair: _Pair) -> _Pair:
    return -pair[0], -pair[1]


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
