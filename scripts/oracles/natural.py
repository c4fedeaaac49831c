"""Natural neighbours in rationals: what a new point's Voronoi cell takes, by clipping polygons.

Nothing of liftmesh is used, and no triangulation: a cell is a square, so large that the new point's
cell does not reach its sides, less what is nearer to each of the others.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from fractions import Fraction
from typing import TypeAlias

Exact: TypeAlias = tuple[Fraction, Fraction]
Ring: TypeAlias = list[tuple[Exact, int]]  # corners, each with the row that made the side from it

WALL = -1


def exact(point: Sequence[float]) -> Exact:
    """Convert a point."""
    return Fraction(point[0]), Fraction(point[1])


def turn(p: Exact, q: Exact, r: Exact) -> Fraction:
    """Compute twice the area of a triangle, positive counter-clockwise."""
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])


def area(ring: Ring) -> Fraction:
    """Compute twice the area of a convex polygon."""
    corners = [p for p, _ in ring]
    fan = itertools.pairwise(corners[1:])
    return sum((turn(corners[0], p, q) for p, q in fan), Fraction(0))


def nearer(ring: Ring, other: Exact, row: int) -> Ring:
    """Leave of a convex polygon what is no nearer to another point than to the origin."""
    square = other[0] ** 2 + other[1] ** 2
    sides = [square - 2 * (p[0] * other[0] + p[1] * other[1]) for p, _ in ring]
    left: Ring = []
    for k, (p, maker) in enumerate(ring):
        after = (k + 1) % len(ring)
        here, there, q = sides[k], sides[after], ring[after][0]
        if here > 0 or (here == 0 and there >= 0):
            left.append((p, maker))
        elif here == 0:
            left.append((p, row))
        if here * there < 0:
            share = here / (here - there)
            cut = p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])
            left.append((cut, row if here > 0 else maker))
    return left


def shares(points: Sequence[Exact], query: Exact) -> tuple[dict[int, Fraction], ...]:
    """Compute Sibson's and Laplace's shares at a point strictly inside the hull, at no row.

    Parameters
    ----------
    points : sequence of pair of Fraction
        The rows, no two of them equal.
    query : pair of Fraction
        The point.

    Returns
    -------
    tuple of dict
        Area and length by row, without those of 0; both up to a factor.
    """
    others = [(p[0] - query[0], p[1] - query[1]) for p in points]
    far = 2 * max(abs(each) for p in others for each in p)
    own: Ring = [((Fraction(0), Fraction(0)), WALL)]
    while any(maker == WALL for _, maker in own):
        far *= far if far > 2 else 2**64
        far = max(far, Fraction(2) ** 64)
        own = [((x, y), WALL) for x, y in ((-far, -far), (far, -far), (far, far), (-far, far))]
        for row in sorted(range(len(others)), key=lambda row: sum(v * v for v in others[row])):
            own = nearer(own, others[row], row)
    areas, lengths = {}, {}
    for row, p in enumerate(others):
        taken = own
        for other in others:
            if other != p and taken:
                taken = moved(nearer(moved(taken, p), step(p, other), row), (-p[0], -p[1]))
        if len(taken) > 2 and (part := area(taken)):
            areas[row] = part
        if length := side(own, row, p):
            lengths[row] = length
    return areas, lengths


def step(p: Exact, q: Exact) -> Exact:
    """Subtract a point from another."""
    return q[0] - p[0], q[1] - p[1]


def moved(ring: Ring, origin: Exact) -> Ring:
    """Count a polygon from another origin."""
    return [(step(origin, p), maker) for p, maker in ring]


def side(ring: Ring, row: int, other: Exact) -> Fraction:
    """Compute the length of the sides that a row made, over its distance."""
    length = Fraction(0)
    for k, (p, maker) in enumerate(ring):
        along = step(p, ring[(k + 1) % len(ring)][0])
        if maker == row:
            length += abs(along[0] / other[1]) if other[1] else abs(along[1] / other[0])
    return length
