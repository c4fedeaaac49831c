"""The rings of cells, with exact corners: ties removed, outer boundaries told from holes.

*Back from the perturbation.* The kernel decides ties by an infinitesimal perturbation. So its rings
may have sides without a length, where an edge of the domain goes through a vertex or a corner lies
on a ridge; strips without a width, where an edge lies along a ridge, and the cell on the other side
takes that edge for the ridge; and places where pieces of a ring, or several rings, meet. The cells
in question are the few in which the kernel has met a tie, and those in which rounded corners
coincide. Each of them is taken apart and put together again by exact coordinates:

1. Corners of the domain that lie within a side become corners of the ring.
2. What of a ridge lies along an edge of the domain is its boundary.
3. Where several corners are at one position, each side that arrives goes on with the next one
   clockwise that leaves: between the two is the inside.
4. A ring that comes back to a position is cut there into two. What has no area is left out.

*Parts and holes.* A ring that turns clockwise is a hole. Signs of areas are taken from rounded
corners where these leave no doubt, and from exact ones otherwise. A hole belongs to the innermost
outer ring of its cell around it; boxes of rounded corners say which come into question, as rounding
keeps the order of numbers, and exact coordinates decide between several.

Nearly all corners are known well enough without exact coordinates.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

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


def between(a: Exact, b: Exact, share: Fraction) -> Exact:
    """The point that is before such a share of the way from one to another."""
    return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])


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


class _Corner(NamedTuple):
    edge: int
    other: int
    beyond: int
    at: Exact
    is_added: bool = False


_Ring = list[_Corner]


def resolve_ties(rings: Rings, exact: DomainCorners, ties: Rows) -> Rings:
    """Return rings without what only the perturbation made."""
    suspects = _suspects(rings, exact, ties)
    if not len(suspects):
        return rings
    is_suspect = np.isin(rings.cells, suspects)
    known = _Ties(exact, ties)
    repaired: list[tuple[int, _Ring]] = []
    for cell, own in _by_cell(rings, np.flatnonzero(is_suspect)):
        corners = [known.corners(cell, source) for source in own]
        repaired += [(cell, ring) for ring in known.resolved(cell, corners)]
    cut = np.arange(len(rings.cells)) < rings.cut
    return Rings.joined(
        rings.taken(np.flatnonzero(~is_suspect & cut)),
        _rings_of(repaired),
        rings.taken(np.flatnonzero(~is_suspect & ~cut)),
    )


def _suspects(rings: Rings, exact: DomainCorners, ties: Rows) -> Rows:
    """Cells with a tie, or with two corners that coincide once rounded, or where rings touch."""
    of_domain = rings.of_the_domain()
    cells = of_domain.cells[of_domain.ring_of]
    order = np.lexsort((*of_domain.points.T, cells))
    one, next_one = of_domain.points[order[:-1]], of_domain.points[order[1:]]
    coincide = (one == next_one).all(axis=1) & (cells[order[:-1]] == cells[order[1:]])
    edge, _, beyond = of_domain.sources.T
    touched = (beyond < 0) & np.isin(edge, exact.domain.touches[:, 1])
    return np.unique(
        np.concatenate([cells[order[:-1][coincide]], cells[touched], ties[:, 2], ties[:, 3]])
    )


def _by_cell(rings: Rings, chosen: Integers) -> Iterable[tuple[int, list[list[list[int]]]]]:
    """Yield cells and the sources of the corners of each of their rings."""
    own: dict[int, list[list[list[int]]]] = defaultdict(list)
    for ring in chosen.tolist():
        first, last = rings.starts[ring : ring + 2].tolist()
        own[int(rings.cells[ring])].append(rings.sources[first:last].tolist())
    return own.items()


def _rings_of(repaired: Sequence[tuple[int, _Ring]]) -> Rings:
    corners = [corner for _, ring in repaired for corner in ring]
    return Rings(
        np.array([corner[:3] for corner in corners], dtype=np.int32).reshape(-1, 3),
        np.array([[*map(float, corner.at)] for corner in corners]).reshape(-1, 2),
        np.cumsum([0, *(len(ring) for _, ring in repaired)], dtype=np.int64),
        np.array([cell for cell, _ in repaired], dtype=np.int32),
        len(repaired),
    )


class _Ties:
    """What is known of ties, by pairs of rows, and of places where the domain touches itself."""

    def __init__(self, exact: DomainCorners, ties: Rows) -> None:
        self._exact = exact
        self._corners: dict[tuple[int, int], set[int]] = defaultdict(set)
        self._edges: dict[tuple[int, int], set[int]] = defaultdict(set)
        self._touching: dict[int, set[int]] = defaultdict(set)
        for corner, edge, cell, row in ties.tolist():
            for pair in ((cell, row), (row, cell)):
                if corner >= 0:
                    self._corners[pair].add(corner)
                else:
                    self._edges[pair].add(edge)
        for corner, edge in exact.domain.touches.tolist():
            self._touching[edge].add(corner)

    def corners(self, cell: int, sources: Iterable[Sequence[int]]) -> _Ring:
        """Compute the corners of a ring; of several at one position in a row, the last is kept."""
        ring = [
            _Corner(edge, other, beyond, self._exact.at(cell, edge, other))
            for edge, other, beyond in sources
        ]
        return [a for a, b in _sides(ring) if a.at != b.at]

    def resolved(self, cell: int, rings: Iterable[_Ring]) -> Iterable[_Ring]:
        """Yield what the rings of a cell are without the perturbation."""
        split = [[piece for side in _sides(ring) for piece in self._pieces(cell, *side)]
                 for ring in rings]  # fmt: skip
        for ring in _linked(split):
            for loop in map(_without_straight, _loops(ring)):
                if doubled_area([corner.at for corner in loop]) != 0:
                    yield loop

    def _pieces(self, cell: int, start: _Corner, end: _Corner) -> Iterable[_Corner]:
        """Yield the corners along a side, but for its end."""
        pair = cell, start.beyond
        inside = self._corners.get(pair) if start.beyond >= 0 else self._touching.get(start.edge)
        at = [self._exact.at(cell, corner, -1) for corner in inside or ()]
        within = {p: corner for p, corner in zip(at, inside or (), strict=True)
                  if turn(start.at, end.at, p) == 0 and is_within(p, start.at, end.at)}  # fmt: skip
        along = sorted(within, key=lambda p: abs(p[0] - start.at[0]) + abs(p[1] - start.at[1]))
        for p, q in zip([start.at, *along], [*along, end.at], strict=True):
            beyond = -1 if self._is_boundary(pair, p, q) else start.beyond
            if p == start.at:
                yield start._replace(beyond=beyond)
            else:
                yield _Corner(within[p], -1, beyond, p, is_added=True)

    def _is_boundary(self, pair: tuple[int, int], p: Exact, q: Exact) -> bool:
        middle = (p[0] + q[0]) / 2, (p[1] + q[1]) / 2
        ends = (self._exact.ends(edge) for edge in self._edges.get(pair, ()))
        return any(
            turn(*each, p) == turn(*each, q) == 0 and is_within(middle, *each) for each in ends
        )


def _sides(ring: _Ring) -> Iterable[tuple[_Corner, _Corner]]:
    return zip(ring, ring[1:] + ring[:1], strict=True)


def _linked(rings: Iterable[_Ring]) -> Iterable[_Ring]:
    """Yield rings of the same sides, in which each is followed by the next one clockwise."""
    corners = [corner for ring in rings for corner in ring]
    following: list[int] = []
    for ring in rings:
        first, count = len(following), len(ring)
        following += [first + (i + 1) % count for i in range(count)]
    visits: dict[Exact, list[tuple[int, int]]] = defaultdict(list)
    for before, after in enumerate(following):
        visits[corners[after].at].append((before, after))
    for at, pairs in visits.items():
        if len(pairs) > 1:
            for before, after in _matched(at, pairs, corners, following):
                following[before] = after
    unseen = dict.fromkeys(range(len(corners)))
    while unseen:
        i, ring = next(iter(unseen)), []
        while i in unseen:
            del unseen[i]
            ring.append(corners[i])
            i = following[i]
        yield ring


def _matched(
    at: Exact, visits: Sequence[tuple[int, int]], corners: _Ring, following: Sequence[int]
) -> Iterable[tuple[int, int]]:
    """Pair the sides that arrive with those that leave, as brackets of a circle are paired."""
    rays = [(-_bearing(at, corners[before].at), False, before) for before, _ in visits]
    rays += [(-_bearing(at, corners[following[i]].at), True, i) for _, i in visits]
    rays.sort()
    open_ones: list[int] = []
    for _, leaves, corner in rays + rays:
        if not leaves:
            open_ones.append(corner)
        elif open_ones:
            yield open_ones.pop(), corner


def _bearing(a: Exact, b: Exact) -> Fraction:
    """A number from 0 to 4 that grows with the angle, counter-clockwise."""
    x, y = b[0] - a[0], b[1] - a[1]
    share = x / (abs(x) + abs(y))
    return 1 - share if y >= 0 else 3 + share


def _loops(ring: _Ring) -> Iterable[_Ring]:
    """Cut a ring wherever it comes back to a position."""
    path: _Ring = []
    place: dict[Exact, int] = {}
    for corner in ring:
        if corner.at in place:
            first = place[corner.at]
            yield path[first:]
            for each in path[first:]:
                del place[each.at]
            del path[first:]
        place[corner.at] = len(path)
        path.append(corner)
    yield path


def _without_straight(ring: _Ring) -> _Ring:
    """Leave out added corners within edges of the domain; on ridges, the cell beyond has them."""
    return [
        b for a, (b, c) in zip(ring[-1:] + ring[:-1], _sides(ring), strict=True)
        if not (b.is_added and a.beyond == b.beyond < 0 and turn(a.at, b.at, c.at) == 0
                and is_within(b.at, a.at, c.at))
    ]  # fmt: skip
