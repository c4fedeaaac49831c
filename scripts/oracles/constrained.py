"""The canonical constrained Delaunay triangulation in exact integers, by its definition.

A triangle belongs to it if no constraint passes through its inside, and no point that its inside
can see conflicts with it. Constraints block sight, and a point conflicts if it is in the
circumcircle, or on it and the rule for ties of `oracles.planar` prefers another triangle. Seen from
its centre is enough: from there one sees a conflicting point if one sees any from elsewhere in the
triangle, as what hides a point in a circle has an end in this circle.

Everything is found by trying all there are: triples of points, pairs of edges, points on an edge.
Nothing here is shared with the program. Points are pairs of integers, as in `oracles.planar`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, pairwise
from typing import Any

from numpy.typing import NDArray
from oracles.planar import (
    Edge,
    Point,
    Triangle,
    contains,
    counter_clockwise,
    cross,
    dot,
    exact,
    hull_edges,
    is_delaunay_side,
)

Rows = tuple[int, int]

MOST_FOR_TRIPLES = 14  # points


def is_between(a: Point, b: Point, p: Point) -> bool:
    """Whether a point is on a segment, its ends among it."""
    return cross(a, b, p) == 0 and dot(p, a, b) <= 0


def do_cross(a: Point, b: Point, p: Point, q: Point) -> bool:
    """Whether two segments have one point inside of both in common."""
    return _are_apart(a, b, p, q) and _are_apart(p, q, a, b)


def _are_apart(a: Point, b: Point, p: Point, q: Point) -> bool:
    """Whether two points are on the two sides of a line."""
    one, other = cross(a, b, p), cross(a, b, q)
    return (one > 0 > other) or (one < 0 < other)


@dataclass(frozen=True)
class Constrained:
    """Points and edges, of which each is a pair of rows, and what there is to find of them."""

    points: Sequence[Point]
    edges: Sequence[Rows]

    @cached_property
    def first_rows(self) -> dict[Point, int]:
        """The least row of each position, in the order by x, then y."""
        least: dict[Point, int] = {}
        for row, point in enumerate(self.points):
            least.setdefault(point, row)
        return dict(sorted(least.items()))

    def ends(self, edge: int) -> Edge:
        a, b = self.edges[edge]
        return self.points[a], self.points[b]

    @cached_property
    def zero_length(self) -> list[int]:
        """The edges whose ends are one position."""
        return [edge for edge in range(len(self.edges)) if len({*self.ends(edge)}) == 1]

    @cached_property
    def members(self) -> dict[Rows, list[int]]:
        """The pieces, sorted, as pairs of first rows, and the edges that each belongs to."""
        found: dict[Rows, list[int]] = {}
        for edge in range(len(self.edges)):
            on_it = [p for p in self.first_rows if is_between(*self.ends(edge), p)]
            for a, b in pairwise(on_it):  # sorted: along the edge
                low, high = sorted((self.first_rows[a], self.first_rows[b]))
                found.setdefault((low, high), []).append(edge)
        return dict(sorted(found.items()))

    @cached_property
    def crossings(self) -> list[Rows]:
        """All pairs of edges that cross, other than in a point."""
        return [
            (first, second)
            for first, second in combinations(range(len(self.edges)), 2)
            if self._cross_outside_points(self.ends(first), self.ends(second))
        ]

    def _cross_outside_points(self, one: Edge, other: Edge) -> bool:
        return do_cross(*one, *other) and not any(
            is_between(*one, p) and is_between(*other, p) for p in self.first_rows
        )

    @cached_property
    def pieces(self) -> list[Edge]:
        """The pieces as pairs of positions."""
        return [(self.points[a], self.points[b]) for a, b in self.members]

    @cached_property
    def triangles(self) -> set[Triangle]:
        """All triangles, if no edges cross."""
        sides = {side for side in combinations(self.first_rows, 2) if self._is_free(*side)}
        return {
            counter_clockwise(a, b, c)
            for a, b, c in combinations(self.first_rows, 3)
            if {(a, b), (b, c), (a, c)} <= sides and cross(a, b, c) != 0 and self._belongs(a, b, c)
        }

    def _is_free(self, a: Point, b: Point) -> bool:
        """Whether a side meets no point but its ends and no piece."""
        on_it = sum(is_between(a, b, p) for p in self.first_rows)
        return on_it == 2 and not any(do_cross(a, b, *piece) for piece in self.pieces)

    def _belongs(self, a: Point, b: Point, c: Point) -> bool:
        triangle = counter_clockwise(a, b, c)
        others = [p for p in self.first_rows if p not in triangle]
        centre = (a[0] + b[0] + c[0], a[1] + b[1] + c[1])
        return not any(
            contains(triangle, p) or (conflicts(triangle, p) and self._sees(centre, p))
            for p in others
        )

    def _sees(self, tripled: Point, p: Point) -> bool:
        """Whether no piece is between two points; the first one's coordinates are times three."""
        seen = _tripled(p)
        return not any(do_cross(tripled, seen, *map(_tripled, piece)) for piece in self.pieces)


def conflicts(triangle: Triangle, p: Point) -> bool:
    """Whether a point beyond a side of the triangle does not allow this side."""
    a, b, c = triangle
    return any(
        cross(start, end, p) < 0 and not is_delaunay_side(start, end, apex, p)
        for start, end, apex in ((a, b, c), (b, c, a), (c, a, b))
    )


def _tripled(p: Point) -> Point:
    return 3 * p[0], 3 * p[1]


def check(found: tuple[Any, ...], points: NDArray[Any], edges: NDArray[Any]) -> Constrained:
    """Assert that what the kernel has found is what there is to find; return it."""
    outcome, marks, pieces, starts, members, zero_length, unplaced, crossings = found
    status, _, _, simplices, *_ = outcome
    expected = Constrained(exact(points.tolist()), [(a, b) for a, b in edges.tolist()])
    assert unplaced.tolist() == []
    if status != "ok":
        assert not expected.triangles, status
        return expected
    assert zero_length.tolist() == expected.zero_length
    assert [*map(tuple, crossings.tolist())] == expected.crossings
    if expected.crossings:
        return expected
    assert [*map(tuple, pieces.tolist())] == [*expected.members]
    parts = [members[i:j].tolist() for i, j in pairwise(starts)]
    assert parts == [*expected.members.values()]
    corners = [tuple(expected.points[row] for row in t) for t in simplices.tolist()]
    if len(points) > MOST_FOR_TRIPLES:
        judge(corners, expected.first_rows, expected.pieces)
    else:
        assert sorted(turned(t) for t in corners) == sorted(expected.triangles)
    sides = {frozenset(piece) for piece in expected.pieces}
    marked = [[k for k in range(3) if frozenset({*t} - {t[k]}) in sides] for t in corners]
    assert [[k for k in range(3) if bits >> k & 1] for bits in marks.tolist()] == marked
    return expected


def judge(triangles: list[Triangle], points: Iterable[Point], pieces: Iterable[Edge]) -> None:
    """Assert in linear time that triangles are the canonical ones of points and pieces.

    All are counter-clockwise, every side is used once in its direction, the sides without a partner
    are the hull, every position is a corner, every piece a side, and across each other inner side
    the two triangles are those that two cocircular or empty circles demand. This holds for one set
    of triangles only.
    """
    assert all(cross(*corners) > 0 for corners in triangles), "a row is not ccw"
    apex: dict[Edge, Point] = {}
    for a, b, c in triangles:
        for side, opposite in (((a, b), c), ((b, c), a), ((c, a), b)):
            assert side not in apex, f"two triangles on one side of {side}"
            apex[side] = opposite
    positions, fixed = {*points}, {frozenset(piece) for piece in pieces}
    border = {(a, b) for a, b in apex if (b, a) not in apex}
    assert border == {*hull_edges(positions)}, "the border is not the hull"
    assert {corner for side in apex for corner in side} == positions, "positions are missing"
    assert fixed <= {frozenset(side) for side in apex}, "pieces are missing"
    wrong = [
        (a, b)
        for (a, b), left in apex.items()
        if (b, a) in apex
        and frozenset((a, b)) not in fixed
        and not is_delaunay_side(a, b, left, apex[b, a])
    ]
    assert not wrong, f"{len(wrong)} sides are not Delaunay, such as {wrong[:2]}"


def turned(triangle: tuple[Point, ...]) -> tuple[Point, ...]:
    """A triangle from its least corner on, in its order."""
    first = triangle.index(min(triangle))
    return triangle[first:] + triangle[:first]
