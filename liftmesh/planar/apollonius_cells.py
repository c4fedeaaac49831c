"""The sides of the cells of disks: arcs of hyperbolas, as polylines to a tolerance.

Seen from the centre of the smaller disk p, a side that it shares with q is the curve

    R = P / (2 (x cos t + y sin t + r)),   P = x^2 + y^2 - r^2,

with t the direction, R the distance, and (x, y, r) what q has more than p: the polar form of a
hyperbola about its focus. It is convex, so between two points it stays in the triangle of the chord
and the tangents there, whose height bounds what the chord is off.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import acos, atan2, cos, hypot, inf, pi, sin
from typing import TypeAlias

import numpy as np

from liftmesh._typing import Floats, Rows

Place: TypeAlias = tuple[float, float]
Ends: TypeAlias = tuple[int, int, int, int]  # two disks, the triangles on their left and right


def sides(simplices: Rows, neighbors: Rows, hull: Rows) -> Iterator[Ends]:
    """List the sides of all cells.

    Parameters
    ----------
    simplices, neighbors, hull : ndarray
        As of an `ApolloniusGraph`.

    Yields
    ------
    tuple of int
        Two disks, and the triangles to the left and right of the edge from one to the other; -1
        where the side has no end.

    Examples
    --------
    >>> list(sides(np.zeros((0, 3), int), np.zeros((0, 3), int), np.array([[0, 1], [1, 0]])))
    [(0, 1, -1, -1)]
    """
    outer = {(a, b) for a, b in hull.tolist()}
    for left, (corners, beside) in enumerate(
        zip(simplices.tolist(), neighbors.tolist(), strict=True)
    ):
        for k, right in enumerate(beside):
            a, b = corners[k - 2], corners[k - 1]
            if right < 0:
                outer.discard((a, b))
            if right < left:
                yield a, b, left, right
    yield from ((a, b, -1, -1) for a, b in sorted(outer) if a < b)


@dataclass(frozen=True, slots=True)
class Branch:
    """The points that are as far from a disk as from another, which is not smaller.

    Parameters
    ----------
    x, y : float
        The centre of the smaller disk, p.
    dx, dy, dr : float
        What the other has more.

    Examples
    --------
    >>> Branch(0.0, 0.0, 2.0, 0.0, 0.0).at(0.0)
    (1.0, 0.0)
    """

    x: float
    y: float
    dx: float
    dy: float
    dr: float

    @property
    def power(self) -> float:
        """P."""
        return self.dx**2 + self.dy**2 - self.dr**2

    def at(self, turn: float) -> Place:
        """Return the point in a direction, counted from that of the other centre.

        Parameters
        ----------
        turn : float
            In radians.

        Returns
        -------
        tuple of float
            x and y.

        Examples
        --------
        >>> Branch(0.0, 0.0, 2.0, 0.0, 0.0).at(np.pi / 3)[0]
        1.0
        """
        reach = self.power / (2 * (hypot(self.dx, self.dy) * cos(turn) + self.dr))
        angle = atan2(self.dy, self.dx) + turn
        return self.x + reach * cos(angle), self.y + reach * sin(angle)

    def turn_of(self, place: Floats) -> float:
        """Return the direction of a point of the curve.

        Parameters
        ----------
        place : (2,) ndarray of float64
            The point.

        Returns
        -------
        float
            In radians from that of the other centre, between -pi and pi.

        Examples
        --------
        >>> Branch(0.0, 0.0, 2.0, 0.0, 0.0).turn_of(np.array([1.0, 1.0]))
        0.7853981633974483
        """
        turn = atan2(place[1] - self.y, place[0] - self.x) - atan2(self.dy, self.dx)
        return (turn + pi) % (2 * pi) - pi

    def widest(self, reach: float) -> float:
        """Return up to which direction, on either side, the curve is no farther than a distance.

        Parameters
        ----------
        reach : float
            The distance from the centre of the smaller disk.

        Returns
        -------
        float
            In radians; 0 if all of it is farther.

        Examples
        --------
        >>> round(Branch(0.0, 0.0, 2.0, 0.0, 0.0).widest(2.0), 6)
        1.047198
        """
        cosine = (self.power / (2 * reach) - self.dr) / hypot(self.dx, self.dy)
        return acos(min(max(cosine, -1.0), 1.0))

    def polyline(self, first: float, last: float, tolerance: float) -> list[Place]:
        """Return points of the curve whose chords are at most a tolerance off.

        Parameters
        ----------
        first, last : float
            The directions of its ends.
        tolerance : float
            As long as coordinates.

        Returns
        -------
        list of tuple of float
            The points, with both ends.

        Examples
        --------
        >>> len(Branch(0.0, 0.0, 2.0, 0.0, 0.0).polyline(-1.0, 1.0, 0.1))
        2
        """
        found, waiting = [self.at(first)], [(first, last)]
        while waiting:
            low, high = waiting.pop()
            if self.deviation(low, high) <= tolerance or high - low < 1e-9:
                found.append(self.at(high))
                continue
            middle = (low + high) / 2
            waiting += [(middle, high), (low, middle)]
        return found

    def deviation(self, low: float, high: float) -> float:
        """Bound how far the curve between two directions is from its chord.

        Parameters
        ----------
        low, high : float
            The directions.

        Returns
        -------
        float
            The height of the triangle of the chord and both tangents.

        Examples
        --------
        >>> Branch(0.0, 0.0, 2.0, 0.0, 0.0).deviation(-1.0, 1.0) < 1e-12
        True
        """
        (ax, ay), (bx, by) = self.at(low), self.at(high)
        chord = (bx - ax, by - ay)
        slopes = [self._slope(place, chord) for place in ((ax, ay), (bx, by))]
        if min(slopes) == 0:
            return 0.0
        return hypot(*chord) / sum(1 / slope for slope in slopes)

    def _slope(self, place: Place, chord: Place) -> float:
        """Return the tangent of the angle between the tangent at a point and a chord."""
        u, v = place[0] - self.x, place[1] - self.y
        near, far = hypot(u, v), hypot(u - self.dx, v - self.dy)
        normal = (u / near - (u - self.dx) / far, v / near - (v - self.dy) / far)
        along = abs(normal[0] * chord[1] - normal[1] * chord[0])
        across = abs(normal[0] * chord[0] + normal[1] * chord[1])
        return across / along if along > 0 else inf


def branch_between(centers: Floats, radii: Floats, a: int, b: int) -> tuple[Branch, bool]:
    """Make the branch of two disks, and say whether the second is the smaller one.

    Parameters
    ----------
    centers, radii : ndarray of float64
        All disks.
    a, b : int
        Two of them.

    Returns
    -------
    branch : Branch
        Seen from the smaller one.
    is_turned : bool
        Whether that is b.

    Examples
    --------
    >>> branch_between(np.array([[0.0, 0], [2, 0]]), np.array([0.5, 0.0]), 0, 1)[1]
    True
    """
    is_turned = bool(radii[b] < radii[a])
    p, q = (b, a) if is_turned else (a, b)
    (x, y), (dx, dy) = centers[p].tolist(), (centers[q] - centers[p]).tolist()
    return Branch(x, y, dx, dy, float(radii[q] - radii[p])), is_turned


def clipped(places: list[Place], box: tuple[float, float, float, float]) -> list[Floats]:
    """Cut off what of a polyline is outside a box.

    Parameters
    ----------
    places : list of tuple of float
        The polyline.
    box : tuple of float
        The least x and y, and the greatest.

    Returns
    -------
    list of (k, 2) ndarray of float64
        The pieces inside.

    Examples
    --------
    >>> clipped([(-1.0, 0.5), (3.0, 0.5)], (0, 0, 1, 1))[0].tolist()
    [[0.0, 0.5], [1.0, 0.5]]
    """
    pieces: list[list[Place]] = []
    for start, end in pairwise(places):
        inside = _inside(start, end, box)
        if inside is None:
            continue
        if not pieces or pieces[-1][-1] != inside[0]:
            pieces.append([inside[0]])
        pieces[-1].append(inside[1])
    return [np.array(piece) for piece in pieces]


def _inside(start: Place, end: Place, box: tuple[float, ...]) -> tuple[Place, Place] | None:
    """Return the part of a segment in a box (Liang and Barsky)."""
    first, last = 0.0, 1.0
    for axis in range(2):
        step = end[axis] - start[axis]
        low, high = box[axis] - start[axis], box[axis + 2] - start[axis]
        if step == 0:
            if low > 0 or high < 0:
                return None
            continue
        enter, leave = sorted((low / step, high / step))
        first, last = max(first, enter), min(last, leave)
    if first >= last:
        return None
    return _on(start, end, first), _on(start, end, last)


def _on(start: Place, end: Place, share: float) -> Place:
    if share in (0.0, 1.0):
        return end if share else start
    x, y = (a + share * (b - a) for a, b in zip(start, end, strict=True))
    return x, y
