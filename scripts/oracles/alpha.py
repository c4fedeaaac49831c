"""Alpha complexes in exact rationals, by their definition.

As `planar` and `space`, with nothing of the program: the smallest sphere through some corners has
its centre where the equations of equal distance say, every point is asked whether it is inside, and
a face with a point inside enters with the first simplex that has it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import combinations

Point = tuple[Fraction, ...]
Face = tuple[Point, ...]


def smallest_sphere(corners: Sequence[Point]) -> tuple[Point, Fraction]:
    """The centre of the smallest sphere through corners, and the square of its radius."""
    origin, *others = corners
    steps = [[a - b for a, b in zip(p, origin, strict=True)] for p in others]
    products = [[sum(a * b for a, b in zip(u, v, strict=True)) for v in steps] for u in steps]
    shares = solved(products, [row[i] / 2 for i, row in enumerate(products)])
    offset = [
        sum((s * step[axis] for s, step in zip(shares, steps, strict=True)), Fraction())
        for axis in range(len(origin))
    ]
    centre = tuple(a + b for a, b in zip(origin, offset, strict=True))
    return centre, square_of_distance(centre, origin)


def solved(matrix: Sequence[Sequence[Fraction]], right: Sequence[Fraction]) -> list[Fraction]:
    """Linear equations, by elimination."""
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    for i in range(len(rows)):
        rows[i:] = sorted(rows[i:], key=lambda row: row[i] == 0)
        rows[i] = [value / rows[i][i] for value in rows[i]]
        for j, row in enumerate(rows):
            if j != i:
                rows[j] = [a - row[i] * b for a, b in zip(row, rows[i], strict=True)]
    return [row[-1] for row in rows]


def square_of_distance(p: Point, q: Point) -> Fraction:
    """Of two points."""
    return sum(((a - b) ** 2 for a, b in zip(p, q, strict=True)), Fraction())


def filtration(points: Iterable[Point], simplices: Iterable[Face]) -> dict[Face, Fraction]:
    """The square of the radius at which each face of the simplices enters, but vertices."""
    found = {}
    distinct = set(points)
    largest = [tuple(sorted(simplex)) for simplex in simplices]
    for size in range(len(largest[0]), 1, -1):
        faces = {face for simplex in largest for face in combinations(simplex, size)}
        for face in faces:
            centre, square = smallest_sphere(face)
            inside = any(square_of_distance(p, centre) < square for p in distinct)
            above = [value for other, value in found.items() if set(face) < set(other)]
            found[face] = min(above) if inside else square
    return found
