"""Rings of cells: which bound parts, which are holes, and their corners as exact rationals.

A ring that turns clockwise is a hole. Signs of areas are taken from rounded corners where these
leave no doubt, and from exact ones otherwise. A hole belongs to the innermost outer ring of its
cell around it; boxes of rounded corners say which come into question, as rounding keeps the order
of numbers, and exact coordinates decide between several.

Nearly all corners are known well enough without exact coordinates. These are for the few whose
rounding is in doubt, and for rings in which corners seem to coincide, or sides to overlap.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from liftmesh._typing import Floats, Integers, Mask, Rows
from liftmesh.cells.domain import Domain, following_corners
from liftmesh.io.columns import places
from liftmesh.optional import load

Exact = tuple[Fraction, Fraction]


@dataclass(slots=True, eq=False)
class Rings:
    """Closed chains of corners."""

    # Of each corner: the edge or corner of the domain; the row across the ridge or the triangle;
    # the row beyond the side to the next corner. See `clip.hpp`.
    sources: Rows
    points: Floats
    starts: Integers  # of rings, and the end
    cells: Rows  # the row whose cell each ring bounds
    cut: int  # so many rings have corners of the domain, or on its edges; the others are whole

    def of_the_domain(self) -> Rings:
        """Return the rings that are cut."""
        end = self.starts[self.cut]
        corners = self.sources[:end], self.points[:end]
        return Rings(*corners, self.starts[: self.cut + 1], self.cells[: self.cut], self.cut)

    def taken(self, chosen: Integers) -> Rings:
        """Return some rings, in ascending order."""
        count = np.diff(self.starts)[chosen]
        starts = np.concatenate([[0], np.cumsum(count)])
        corners = places(self.starts[chosen], count)
        cut = int(np.count_nonzero(chosen < self.cut))
        return Rings(self.sources[corners], self.points[corners], starts, self.cells[chosen], cut)

    @staticmethod
    def joined(*several: Rings) -> Rings:
        """Return all of several rings, of which those that are cut come first."""
        counts = np.concatenate([np.diff(rings.starts) for rings in several])
        return Rings(
            np.concatenate([rings.sources for rings in several]),
            np.concatenate([rings.points for rings in several]),
            np.concatenate([[0], np.cumsum(counts)]),
            np.concatenate([rings.cells for rings in several]),
            sum(rings.cut for rings in several),
        )

    @property
    def ring_of(self) -> Integers:
        """The ring of each corner."""
        return np.repeat(np.arange(len(self.cells)), np.diff(self.starts))

    @property
    def following(self) -> Integers:
        """The corner after each, in its ring."""
        return following_corners(self.starts)


def parts_of(rings: Rings, exact: DomainCorners) -> tuple[Integers, Mask]:
    """Find the part that each ring bounds, by cell and outer ring, and which rings are holes."""
    is_hole = np.zeros(len(rings.cells), dtype=np.bool_)
    with np.errstate(over="ignore", invalid="ignore"):  # what is no number is decided exactly
        is_hole[: rings.cut] = _turn_clockwise(rings.of_the_domain(), exact)
    outer = np.flatnonzero(~is_hole)
    outer = outer[np.argsort(rings.cells[outer], kind="stable")]
    part = np.empty(len(rings.cells), dtype=np.int64)
    part[outer] = np.arange(len(outer))
    holes = np.flatnonzero(is_hole)
    if len(holes):
        part[holes] = part[_around(holes, outer, rings, exact)]
    return part, is_hole


def _turn_clockwise(rings: Rings, exact: DomainCorners) -> Mask:
    if not len(rings.cells):
        return np.zeros(0, dtype=np.bool_)
    of_ring, first = rings.ring_of, rings.starts[:-1]
    step = rings.points - rings.points[first][of_ring]
    extent = np.maximum.reduceat(np.abs(step).max(axis=1), first)
    step = np.ldexp(step, -np.frexp(extent)[1][of_ring][:, None])
    ahead = step[rings.following]
    products = step[:, 0] * ahead[:, 1], step[:, 1] * ahead[:, 0]
    area = np.bincount(of_ring, products[0] - products[1])
    size = np.bincount(of_ring, np.abs(products[0]) + np.abs(products[1]))
    length = np.bincount(of_ring, np.abs(ahead - step).sum(axis=1))
    of_corners = np.maximum.reduceat(np.abs(rings.points).max(axis=1), first)
    rounding = np.ldexp(of_corners, -50 - np.frexp(extent)[1])
    doubt = (np.diff(rings.starts) + 8) * 2.0**-52 * size + rounding * (length + rounding)
    for ring in np.flatnonzero(~(np.abs(area) > doubt)).tolist():
        area[ring] = -1.0 if doubled_area(_corners(ring, rings, exact)) < 0 else 1.0
    clockwise: Mask = area < 0
    return clockwise


def _around(holes: Integers, outer: Integers, rings: Rings, exact: DomainCorners) -> list[int]:
    """Return for each hole the innermost ring of its cell around it."""
    shapely = load("shapely", extra="shapes")
    boxes = _boxes(rings)
    tree = shapely.STRtree(shapely.box(*boxes[outer].T))
    hole, place = tree.query(shapely.box(*boxes[holes].T))
    inner, around = boxes[holes[hole]], boxes[outer[place]]
    is_around = (around[:, :2] <= inner[:, :2]).all(axis=1)
    is_around &= (around[:, 2:] >= inner[:, 2:]).all(axis=1)
    is_around &= rings.cells[holes[hole]] == rings.cells[outer[place]]
    by_size = np.lexsort(((around[:, 2:] - around[:, :2]).sum(axis=1), hole))
    by_size = by_size[is_around[by_size]]
    among: list[list[int]] = [[] for _ in holes]
    for i, ring in zip(hole[by_size].tolist(), outer[place[by_size]].tolist(), strict=True):
        among[i].append(ring)
    return [
        _innermost(i, each, rings, exact) for i, each in zip(holes.tolist(), among, strict=True)
    ]


def _boxes(rings: Rings) -> Floats:
    first = rings.starts[:-1]
    low, high = (each.reduceat(rings.points, first) for each in (np.minimum, np.maximum))
    return np.concatenate([low, high], axis=1)


def _innermost(hole: int, among: Sequence[int], rings: Rings, exact: DomainCorners) -> int:
    """Return the first of some rings, in the order of their size, that is around a hole."""
    for ring in among[:-1]:
        first, last = rings.starts[hole : hole + 2].tolist()
        sides = (_side(corner, hole, ring, rings, exact) for corner in range(first, last))
        if next((side for side in sides if side != 0), 0) > 0:
            return ring
    return among[-1]


def _corners(ring: int, rings: Rings, exact: DomainCorners) -> list[Exact]:
    return _at(range(*rings.starts[ring : ring + 2].tolist()), ring, rings, exact)


def _at(corners: Iterable[int], ring: int, rings: Rings, exact: DomainCorners) -> list[Exact]:
    cell = int(rings.cells[ring])
    return [exact.at(cell, *rings.sources[corner, :2].tolist()) for corner in corners]


def _side(corner: int, own: int, ring: int, rings: Rings, exact: DomainCorners) -> int:
    """Say where a corner of one ring is: 1 inside another, -1 outside, 0 on it."""
    (point,) = _at([corner], own, rings, exact)
    starts, ends = _level_sides(rings.points[corner], ring, rings)
    winding = 0
    for a, b in zip(_at(starts, ring, rings, exact), _at(ends, ring, rings, exact), strict=True):
        side = turn(a, b, point)
        if side == 0 and _is_in_box(point, a, b):
            return 0
        if a[1] <= point[1] < b[1] and side > 0:
            winding += 1
        if b[1] <= point[1] < a[1] and side < 0:
            winding -= 1
    return 1 if winding else -1


def _level_sides(point: Floats, ring: int, rings: Rings) -> tuple[list[int], list[int]]:
    """Return the ends of all sides that are at the height of a point, and not to the left of it."""
    first, last = rings.starts[ring : ring + 2].tolist()
    here = rings.points[first:last]
    ahead = np.roll(here, -1, axis=0)
    low, high = np.minimum(here, ahead), np.maximum(here, ahead)
    at = np.flatnonzero(
        (low[:, 1] <= point[1]) & (point[1] <= high[:, 1]) & (point[0] <= high[:, 0])
    )
    return (first + at).tolist(), (first + (at + 1) % (last - first)).tolist()


def _is_in_box(point: Exact, a: Exact, b: Exact) -> bool:
    return all(min(p, q) <= value <= max(p, q) for value, p, q in zip(point, a, b, strict=True))


@dataclass(frozen=True, slots=True, eq=False)
class DomainCorners(ABC):
    """Corners of clipped cells: those of the domain are the same whatever the cells."""

    domain: Domain

    @abstractmethod
    def at(self, cell: int, edge: int, other: int) -> Exact:
        """Compute a corner of a cell, from where it comes: the first two `sources` of `Rings`."""

    def ends(self, edge: int) -> tuple[Exact, Exact]:
        """Return the ends of an edge of the domain."""
        corners, starts = self.domain.corners, self.domain.starts
        after, ring = edge + 1, int(np.searchsorted(starts, edge + 1))
        if starts[ring] == after:
            after = int(starts[ring - 1])
        return as_exact(corners[edge]), as_exact(corners[after])


def as_exact(point: Sequence[float]) -> Exact:
    """The coordinates of a point as rationals."""
    return Fraction(float(point[0])), Fraction(float(point[1]))


def turn(a: Exact, b: Exact, c: Exact) -> Fraction:
    """Twice the signed area of a triangle."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def doubled_area(ring: Sequence[Exact]) -> Fraction:
    """Twice the signed area of a polygon."""
    pairs = zip(ring, (*ring[1:], *ring[:1]), strict=True)
    return sum((a[0] * b[1] - a[1] * b[0] for a, b in pairs), Fraction(0))


def is_within(point: Exact, a: Exact, b: Exact) -> bool:
    """Whether a point on the line through two others is strictly between them."""
    return all(
        (point[i] - p[i]) * (q[i] - p[i]) >= 0 and point != p
        for p, q in ((a, b), (b, a)) for i in (0, 1)
    )  # fmt: skip


def binary_scale(values: Floats) -> int:
    """Return the exponent by which values are divided for products to stay within range."""
    return int(np.frexp(np.abs(values).max(initial=0.0))[1])
