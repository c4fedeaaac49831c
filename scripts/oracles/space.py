"""The canonical tetrahedra of points in space in exact integers, by their definition.

As `planar` does in the plane, and with nothing of the program: points, triples of integers
(`planar.exact` makes them of doubles), are lifted by the sum of their squares. Each is raised by a
concrete tiny amount, far more for a later point than for an earlier one, and the tetrahedra with
nothing below them are kept.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import combinations

Point = tuple[int, int, int]
Tetrahedron = tuple[Point, Point, Point, Point]


def volume(a: Point, b: Point, c: Point, d: Point) -> int:
    """Six times the signed volume: positive if a, b, c turn counter-clockwise seen from d."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (
        (p[0] - a[0], p[1] - a[1], p[2] - a[2]) for p in (b, c, d)
    )
    return ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)


def delaunay_by_definition(points: Iterable[Point]) -> set[Tetrahedron]:
    """All tetrahedra, as sorted corners: every four points, and every fifth."""
    distinct = sorted(set(points))
    lifted = raised_lift(distinct)
    return {
        four
        for four in combinations(distinct, 4)
        if (whole := volume(*four)) and is_lower_facet(four, whole, lifted)
    }


def raised_lift(points: Sequence[Point]) -> dict[Point, int]:
    """Heights in units so small that every rise, a power of one base, stays below one.

    The base exceeds every sum of the volumes that multiply the rises in a determinant.
    """
    width = max((abs(value) for p in points for value in p), default=0) * 2 + 1
    base = 1 << (64 * width**3).bit_length()
    unit = base ** (len(points) + 1)
    return {p: sum(v * v for v in p) * unit + base**rank for rank, p in enumerate(points)}


def is_lower_facet(four: Tetrahedron, whole: int, lifted: dict[Point, int]) -> bool:
    """Whether no lifted point lies below the hyperplane through the four lifted corners."""
    a, b, c, d = four
    turn = 1 if whole > 0 else -1
    return all(
        turn
        * (
            lifted[p] * whole
            - lifted[a] * volume(p, b, c, d)
            - lifted[b] * volume(a, p, c, d)
            - lifted[c] * volume(a, b, p, d)
            - lifted[d] * volume(a, b, c, p)
        )
        >= 0
        for p in lifted
    )
