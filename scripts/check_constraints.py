"""What `check_certificate.py` checks of constraints, and of triangles whose regions were carved.

It uses the standard library only. Coordinates are fractions, so each sign is exact.
"""

from __future__ import annotations

from bisect import bisect_left
from fractions import Fraction
from functools import cmp_to_key
from itertools import pairwise

Point = tuple[Fraction, Fraction]
HalfEdge = tuple[Point, Point]  # its triangle lies on its left
Crossed = tuple[Point, Point, int]  # covered ground begins (1) or ends (-1) above; 0: a constraint


def turn(a: Point, b: Point, c: Point) -> Fraction:
    """Positive if a, b, c are counter-clockwise."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def follow(
    segments: list[HalfEdge], apex: dict[HalfEdge, Point]
) -> tuple[set[HalfEdge], set[HalfEdge]]:
    """Follow segments along edges, from their lesser ends on.

    Return these edges, and what is left of segments that no edge continues.
    """
    star: dict[Point, set[Point]] = {}
    for a, b in apex:
        star.setdefault(min(a, b), set()).add(max(a, b))
    along, left = set(), set()
    for p, q in segments:
        while p != q:
            ends = star.get(p, set())
            ahead = (r for r in ends if r < q and turn(p, q, r) == 0)
            step = q if q in ends else next(ahead, None)
            if step is None:
                left.add((p, q))
                break
            along.add((p, step))
            p = step  # noqa: PLW2901 - the rest of the segment
    return along, left


def problem_of_carved(
    apex: dict[HalfEdge, Point],
    boundary: list[HalfEdge],
    points: set[Point],
    others: set[Point],
    along: set[HalfEdge],
    left: set[HalfEdge],
) -> str:
    """Check the boundary of triangles that need not cover the convex hull, and what is outside.

    What is left of constraints is cut at all points on it; pieces that are edges join the others.
    """
    if not boundary:
        return "there is no boundary"
    pieces = set()
    for p, q in left:
        pieces |= {*pairwise(sorted(r for r in points if p <= r <= q and turn(p, q, r) == 0))}
    edges = {(min(edge), max(edge)) for edge in apex}
    along |= pieces & edges
    crossed = [(a, b, 1) if a < b else (b, a, -1) for a, b in boundary]
    crossed += [(p, q, 0) for p, q in pieces - edges]
    on_hull = hull_of(points)
    if any((min(edge), max(edge)) not in along and edge not in on_hull for edge in boundary):
        return "an edge of the boundary is on no constraint, and not on the convex hull"
    return problem_of_order(crossed, others)


def hull_of(points: set[Point]) -> set[HalfEdge]:
    """Return the edges between neighbours on the convex hull, counter-clockwise."""
    edges: set[HalfEdge] = set()
    for order in (1, -1):
        chain_of: list[Point] = []
        for p in sorted(points)[::order]:
            while len(chain_of) > 1 and turn(chain_of[-2], chain_of[-1], p) < 0:
                chain_of.pop()
            chain_of.append(p)
        edges |= {*pairwise(chain_of)}
    return edges


def problem_of_order(crossed: list[Crossed], others: set[Point]) -> str:
    """Sweep a line over the plane: the ground is covered once or not at all.

    Pieces of constraints, and points that are no vertices, are to be where it is not covered.
    """
    starting: dict[Point, list[Crossed]] = {}
    for each in crossed:
        starting.setdefault(each[0], []).append(each)
    line: list[Crossed] = []  # from below to above
    for p in sorted({*others, *(end for a, b, _ in crossed for end in (a, b))}):
        wrong = advance(line, p, starting.get(p, []), p in others)
        if wrong:
            return wrong
    return ""


def advance(line: list[Crossed], p: Point, begun: list[Crossed], is_other: bool) -> str:
    """Move the line to a point; return what is wrong there."""
    first = bisect_left(line, True, key=lambda each: turn(*each[:2], p) <= 0)
    last = bisect_left(line, True, key=lambda each: turn(*each[:2], p) < 0)
    begun = sorted(begun, key=cmp_to_key(lambda s, t: turn(p, t[1], s[1])))
    if any(q != p for _, q, _ in line[first:last]):
        return "a point is on an edge of the boundary, or on a piece of a constraint"
    if any(turn(p, s[1], t[1]) == 0 for s, t in pairwise(begun)):
        return "edges of the boundary overlap"
    covered = first > 0 and line[first - 1][2] == 1
    if covered and is_other:
        return "a point is not a vertex"
    for *_, kind in begun:
        if covered and kind >= 0:
            return "triangles overlap" if kind else "a constraint is no union of edges"
        covered = kind == 1
    line[first:last] = begun
    neighbors = pairwise(line[max(first - 1, 0) : first + len(begun) + 1])
    crosses = any(do_cross(*two) for two in neighbors)
    return "edges of the boundary, or constraints, cross" if crosses else ""


def do_cross(low: Crossed, high: Crossed) -> bool:
    """Whether the lower of two is above the other where the first of them ends."""
    if low[1] < high[1]:
        return turn(high[0], high[1], low[1]) > 0
    return turn(low[0], low[1], high[1]) < 0
