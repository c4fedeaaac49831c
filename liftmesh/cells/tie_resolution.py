"""Back from the perturbation: rings of distinct corners that do not touch themselves.

The kernel decides ties by an infinitesimal perturbation. So its rings may have sides without a
length, where an edge of the domain goes through a vertex or a corner lies on a ridge; strips
without a width, where an edge lies along a ridge, and the cell on the other side takes that edge
for the ridge; and places where pieces of a ring, or several rings, meet. The cells in question are
the few in which the kernel has met a tie, and those in which rounded corners coincide. Each of them
is taken apart and put together again by exact coordinates:

1. Corners of the domain that lie within a side become corners of the ring.
2. What of a ridge lies along an edge of the domain is its boundary.
3. Where several corners are at one position, each side that arrives goes on with the next one
   clockwise that leaves: between the two is the inside.
4. A ring that comes back to a position is cut there into two. What has no area is left out.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Rows
from liftmesh.cells.rings import DomainCorners, Exact, Rings, doubled_area, is_within, turn


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


def _by_cell(
    rings: Rings, chosen: NDArray[np.int64]
) -> Iterable[tuple[int, list[list[list[int]]]]]:
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
