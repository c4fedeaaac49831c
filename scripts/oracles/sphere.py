"""The canonical triangles of rays on the sphere, by their definition.

Each direction is a vector of integers with its length, a square root of very many digits. Ties are
broken by concrete tiny amounts: the lengths of later rays grow by far more than those of earlier
ones, which moves their directions inwards, and all are moved by far less along z, then y, then x.
Every three rays are tried, and every fourth.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from itertools import permutations
from math import gcd, isqrt

Ray = tuple[int, int, int]
BITS = 8000  # of fractions; errors of roots are as small
RISE, SHIFTS = 400, (3200, 4400, 5600)


def direction(ray: Ray) -> Ray:
    """The shortest vector of integers in the direction."""
    divisor = gcd(*ray)
    return ray[0] // divisor, ray[1] // divisor, ray[2] // divisor


def triangles(rays: Iterable[Ray]) -> set[tuple[Ray, ...]]:
    """The facets of the hull of the directions, each from its least ray on."""
    ordered = sorted(set(rays), key=unit_vector)
    lines = [perturbed(ray, len(ordered) - 1 - rank) for rank, ray in enumerate(ordered)]
    return {
        from_least((ordered[i], ordered[j], ordered[k]))
        for i, j, k in permutations(range(len(ordered)), 3)
        if i < min(j, k)
        and all(
            determinant(lines[i], lines[j], lines[k], line) < 0
            for m, line in enumerate(lines)
            if m not in (i, j, k)
        )
    }


def unit_vector(ray: Ray) -> list[Fraction]:
    """What is ordered as the unit vector is: squares of coordinates, with their signs."""
    length = sum(v * v for v in ray)
    return [Fraction(v * abs(v), length) for v in ray]


def from_least(corners: tuple[Ray, ...]) -> tuple[Ray, ...]:
    """Turn a triangle so that it begins with its least ray."""
    k = corners.index(min(corners))
    return corners[k:] + corners[:k]


def perturbed(ray: Ray, rank: int) -> tuple[int, ...]:
    """Coordinates and length, in units of 2^-BITS; `rank` counts from the largest ray."""
    length = isqrt(sum(v * v for v in ray) << (2 * BITS)) + (1 << (BITS - RISE * (rank + 1)))
    x, y, z = (v << BITS for v in ray)
    moves = [1 << (BITS - shift - 100 * rank) for shift in SHIFTS]
    return x + moves[2], y + moves[1], z + moves[0], length


def determinant(
    a: tuple[int, ...], b: tuple[int, ...], c: tuple[int, ...], d: tuple[int, ...]
) -> int:
    """Positive if the direction of d is above the plane of the other three."""

    def volume(p: tuple[int, ...], q: tuple[int, ...], r: tuple[int, ...]) -> int:
        return (
            p[0] * (q[1] * r[2] - q[2] * r[1])
            + p[1] * (q[2] * r[0] - q[0] * r[2])
            + p[2] * (q[0] * r[1] - q[1] * r[0])
        )

    return (
        a[3] * volume(b, c, d)
        - b[3] * volume(a, c, d)
        + c[3] * volume(a, b, d)
        - d[3] * volume(a, b, c)
    )
