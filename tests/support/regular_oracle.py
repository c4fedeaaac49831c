"""The canonical regular triangulation in exact integers, by its definition.

Sites are lifted by rationals, made integers, and raised by concrete tiny amounts, far more for a
later site (by x, then y) than for an earlier one. The triangles are those with no lifted site
below them: every triple is tried. Nothing here is shared with the program.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import combinations
from math import lcm

Site = tuple[Fraction, Fraction, Fraction]  # x, y and height


def sites(
    points: Sequence[Sequence[float]], values: Sequence[float], lift: str = "weights"
) -> list[Site]:
    """Lift points by weights or radii, exactly."""
    power = {"weights": 1, "radii": 2}[lift]
    rows = [
        (Fraction(x), Fraction(y), Fraction(v)) for (x, y), v in zip(points, values, strict=True)
    ]
    return [(x, y, x * x + y * y - v**power) for x, y, v in rows]


def regular(lifted: Sequence[Site]) -> tuple[set[frozenset[int]], set[int]]:
    """Triangles, as sets of rows, and the rows that are no vertices; of equal sites the first."""
    lowest: dict[tuple[Fraction, Fraction], int] = {}
    for row, (x, y, z) in enumerate(lifted):
        best = lowest.setdefault((x, y), row)
        if z < lifted[best][2]:
            lowest[x, y] = row
    rows = [lowest[position] for position in sorted(lowest)]
    raised = raise_by_order([lifted[row] for row in rows])
    found = {
        frozenset(rows[i] for i in triple)
        for triple in combinations(range(len(rows)), 3)
        if is_lower_facet(triple, raised)
    }
    vertices = {row for triangle in found for row in triangle}
    return found, set(range(len(lifted))) - vertices


def raise_by_order(lifted: Sequence[Site]) -> list[tuple[int, int, int]]:
    """Integers in the same positions, sorted already, the later the higher."""
    scale = lcm(*(value.denominator for site in lifted for value in site[:2]))
    rows = [(int(x * scale), int(y * scale), z * scale * scale) for x, y, z in lifted]
    heights = lcm(*(z.denominator for _, _, z in rows))
    largest = max(max(abs(x), abs(y)) for x, y, _ in rows) + 1
    step = 64 * largest * largest * len(rows)
    return [
        (x, y, int(z * heights) * step ** (len(rows) + 1) + step**place)
        for place, (x, y, z) in enumerate(rows)
    ]


def is_lower_facet(triple: tuple[int, ...], raised: Sequence[tuple[int, int, int]]) -> bool:
    """Whether the triple turns and every other site is above its plane."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (raised[i] for i in triple)
    turn = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    if turn == 0:
        return False
    normal_x = (by - ay) * (cz - az) - (bz - az) * (cy - ay)
    normal_y = (bz - az) * (cx - ax) - (bx - ax) * (cz - az)
    above = (
        (normal_x * (x - ax) + normal_y * (y - ay) + turn * (z - az)) * turn > 0
        for i, (x, y, z) in enumerate(raised)
        if i not in triple
    )
    return all(above)
