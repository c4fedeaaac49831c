"""Whether triangles are a constrained Delaunay triangulation, whole or carved, by trying all pairs.

Everything is in integers, and nothing is shared with the program: `oracles.constrained` decides on
constraints, `oracles.planar` on ties.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

from oracles.constrained import Constrained, Rows, is_between
from oracles.planar import Edge, Point, Triangle, contains, cross, hull_edges, is_delaunay_side

Triple = tuple[int, int, int]


def judged(
    points: Sequence[Point], triples: Sequence[Triple], edges: Sequence[Rows], carved: bool
) -> tuple[bool, bool]:
    """Whether triangles are valid, and whether they are canonical."""
    triangles = [tuple(points[row] for row in triple) for triple in triples]
    given = Constrained(points, edges)
    segments = [given.ends(edge) for edge in range(len(edges))]
    apex = {side: c for t in triangles for side, c in sides_of(t)}
    border = [(a, b) for a, b in apex if (b, a) not in apex]
    fits = (
        bool(triangles)
        and len(apex) == 3 * len(triangles)
        and all(cross(*t) > 0 for t in triangles)
        and not any(are_overlapping(t, u) for t, u in combinations(triangles, 2))
        and not any(contains(t, p) and p not in t for t in triangles for p in points)
        and not given.crossings
        and not any(passes(segment, t) for segment in segments for t in triangles)
    )
    if carved:
        whole = all(is_on(side, segments) or is_on_hull(side, points) for side in border)
    else:
        whole = area_of(triangles) == hull_area(points) and {*points} <= {*sum(triangles, ())}
    inner = [(a, b, apex[a, b], apex[b, a]) for a, b in apex if (b, a) in apex]
    free = [four for four in inner if not is_on(four[:2], segments)]
    valid = fits and whole and all(is_empty(*four) for four in free)
    return valid, valid and all(is_delaunay_side(*four) for four in free)


def sides_of(t: Triangle) -> list[tuple[Edge, Point]]:
    a, b, c = t
    return [((a, b), c), ((b, c), a), ((c, a), b)]


def is_apart(t: Triangle, others: Sequence[Point]) -> bool:
    """Whether a side of a triangle has all these points beyond or on it."""
    return any(all(cross(a, b, p) <= 0 for p in others) for (a, b), _ in sides_of(t))


def are_overlapping(t: Triangle, u: Triangle) -> bool:
    return not (is_apart(t, u) or is_apart(u, t))


def passes(segment: Edge, t: Triangle) -> bool:
    """Whether a segment passes through the inside of a triangle."""
    if segment[0] == segment[1]:
        return False
    signs = [cross(*segment, corner) for corner in t]
    return min(signs) < 0 < max(signs) and not is_apart(t, segment)


def is_on(side: Edge, segments: Sequence[Edge]) -> bool:
    return any(a != b and all(is_between(a, b, end) for end in side) for a, b in segments)


def is_on_hull(side: Edge, points: Sequence[Point]) -> bool:
    return all(cross(*side, p) >= 0 for p in points)


def is_empty(a: Point, b: Point, left: Point, right: Point) -> bool:
    """Whether the circle of a, b and the point on the left does not contain the other one."""
    rows = [(p[0] - right[0], p[1] - right[1]) for p in (a, b, left)]
    (ax, ay), (bx, by), (cx, cy) = rows
    lifts = [x * x + y * y for x, y in rows]
    return (
        lifts[0] * (bx * cy - by * cx)
        - lifts[1] * (ax * cy - ay * cx)
        + lifts[2] * (ax * by - ay * bx)
    ) <= 0


def area_of(triangles: Sequence[Triangle]) -> int:
    return sum(cross(*t) for t in triangles)


def hull_area(points: Sequence[Point]) -> int:
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in hull_edges({*points}))
