"""Worst known inputs of what works on points in the plane, beside the benchmark's distributions.

Three causes make work in the plane grow: vertices of many triangles, which a walk or a seam goes
around; coordinates of wide exponents, which the exact predicates take more limbs for; and rows that
fall into one cell of the kd order.
"""

from __future__ import annotations

from math import isqrt

import numpy as np
from collisions import colliding_column
from distributions import Points, lattice, polar
from growth.families import BENCHMARK, families_in, random


def circle_and_centre(n: int) -> Points:
    """One vertex has all triangles: a walk through its fan takes as long as the fan is."""
    angles = 2 * np.pi * np.arange(n - 1) / (n - 1)
    return np.vstack([polar(1.0, angles), [[0.0, 0.0]]])


def polar_scan(n: int) -> Points:
    """Rings of a scanner around its own place, where hundreds of thin triangles meet."""
    beams = max(n // 8, 3)
    angles = 2 * np.pi * np.arange(beams) / beams
    rings = [polar(radius, angles + 0.01 * radius) for radius in 1.5 ** np.arange(8)]
    return np.vstack([*rings, [[0.0, 0.0]]])[:n]


def column_and_apex(n: int) -> Points:
    """A fan whose triangles are long: the kd tree of samples sends queries to its far end."""
    column = np.column_stack([np.zeros(n - 1), np.linspace(0, 1, n - 1)])
    return np.vstack([column, [[1000.0, 0.5]]])


def facing_arcs(n: int) -> Points:
    """Slivers between two flat arcs: each crosses the whole middle, far from every vertex."""
    along = np.linspace(-1, 1, n // 2)
    rise = 1 + 1e-3 * (1 - along * along)
    return np.vstack([np.column_stack([along, rise]), np.column_stack([along + 1e-9, -rise])])


def nested_clusters(n: int) -> Points:
    """Clusters of clusters, five levels deep: no grid fits them all."""
    rng = random()
    centres = sum(1e-2**level * rng.random((10, 2))[rng.integers(0, 10, n)] for level in range(5))
    return centres + 1e-10 * rng.random((n, 2))


def two_scales(n: int) -> Points:
    """Half of the rows within 1e-20 of each other: one cell, one place for careless arithmetic."""
    rng = random()
    wide, narrow = rng.random((n // 2, 2)), rng.random((n - n // 2, 2)) * 1e-20
    return rng.permutation(np.vstack([wide, narrow]))


def tiny_and_far(n: int) -> Points:
    """A tiny cluster, and one row at the other end of the exponents."""
    return np.vstack([random().random((n - 1, 2)) * 1e-300, [[1e300, 1e300]]])


def mixed_exponents(n: int) -> Points:
    """Exponents over the whole range: every predicate needs the widest integers."""
    rng = random()
    size = np.ldexp(rng.random((n, 2)) + 0.5, rng.integers(-1000, 1000, (n, 2)))
    return size * rng.choice([-1.0, 1.0], (n, 2))


def wide_line(n: int) -> Points:
    """On the line y = x over all exponents, two rows off it: exact zeros of the widest integers."""
    rng = random()
    along = np.ldexp(rng.random(n - 2) + 0.5, rng.integers(-1000, 1000, n - 2))
    off = [[1e300, -1e300], [-1e300, 1e300]]
    return np.vstack([np.column_stack([along, along]), off])


def huge_by_denormal(n: int) -> Points:
    """A hexagonal lattice of huge x and denormal y: cocircular fours, no filter in range."""
    column, row = lattice(n, random()).T
    return np.column_stack([(2 * column + row % 2) * 2.0**990, row * 2.0**-1074])


def powers_of_two(n: int) -> Points:
    """Powers of two in both axes: axis-parallel rectangles of wide exponents."""
    rng = random()
    return np.ldexp(1.0, rng.integers(-1074, 1023, (n, 2)).astype(np.int32))


def one_position_but_three(n: int) -> Points:
    """All rows but three are one position: no cut separates them."""
    return np.vstack([np.full((n - 3, 2), 0.25), [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]])


def few_positions(n: int) -> Points:
    """Every position many times over, in random order."""
    rng = random()
    return rng.random((isqrt(n) + 3, 2))[rng.integers(0, isqrt(n) + 3, n)]


def colliding_hashes(n: int) -> Points:
    """Rows made to fall into one place of the table that finds duplicates."""
    return np.vstack([colliding_column(n - 2), [[2.0, 0.0], [2.0, 1.0]]])


def off_the_sample(n: int) -> Points:
    """All rows in a clump, but for those that the sample of the cuts takes."""
    depth = min(max(n // 96, 1).bit_length() - 1, 13)
    numbers = np.arange(4 << depth, dtype=np.uint64) + np.uint64(1)
    turned = numbers * np.uint64(0x9E3779B97F4A7C15) >> np.uint64(32)
    sampled = (turned * np.uint64(n) >> np.uint64(32)).astype(np.int64)
    points = random().random((n, 2)) * 1e-9 + 5
    points[sampled] = random().random((len(sampled), 2))
    return points


def collinear_but_one(n: int) -> Points:
    """One row off a line: a fan, found after a merge of empty parts."""
    along = random().permutation(n - 1).astype(np.float64)
    return np.vstack([np.column_stack([along, along]), [[0.0, 1.0]]])


def sorted_rows(n: int) -> Points:
    """Uniform rows in lexicographic order: pivots that take the first row are the worst."""
    points = random().random((n, 2))
    return points[np.lexsort(points.T)]


def organ_pipe(n: int) -> Points:
    """Rising, then falling x: the order that spoils a median of a few rows."""
    rising = np.arange(n // 2, dtype=np.float64)
    x = np.concatenate([rising, np.arange(n - n // 2, dtype=np.float64)[::-1]])
    return np.column_stack([x, random().random(n)])


def cross(n: int) -> Points:
    """On both axes: every cut leaves one half on a line."""
    along = random().random(n) - 0.5
    nothing = np.zeros(n)
    even = np.arange(n)[:, None] % 2 == 0
    return np.where(even, np.column_stack([along, nothing]), np.column_stack([nothing, along]))


def oblique_line(n: int) -> Points:
    """A line along no axis: its triangles are what rounding made, thinner than any arithmetic."""
    along = random().random(n)
    return np.column_stack([along, 0.1 * along])


def line_and_two(n: int) -> Points:
    """An oblique line and a row on either side: two fans, with triangles of rounding between."""
    along = random().random(n - 2)
    return np.vstack([np.column_stack([along, 0.3 * along]), [[0.9, -0.8], [0.1, 0.9]]])


def hexagon_sides(n: int) -> Points:
    """Rows on the sides of a hexagon: thin triangles along each, and long ones across."""
    rng = random()
    corners = polar(1.0, np.pi / 3 * np.arange(7))
    side, along = rng.integers(0, 6, n), rng.random((n, 1))
    return corners[side] * (1 - along) + corners[side + 1] * along


def noisy_cross(n: int) -> Points:
    """Two noisy lines that nearly cross: thin triangles along both, long ones between."""
    rng = random()
    along = rng.uniform(-1, 1, n)
    slope = np.where(np.arange(n) % 2 == 0, 0.3, -0.3)
    return np.column_stack([along, slope * along + 1e-12 * rng.standard_normal(n)])


def wide_spiral(n: int) -> Points:
    """A spiral over all exponents: neighbours differ by orders of magnitude."""
    t = random().uniform(-700, 700, n)
    return polar(np.exp(t), t)


PLANAR = {**BENCHMARK, **families_in(globals(), "Points")}

FANS = ("uniform", "circle and centre", "polar scan", "column and apex")
THIN = ("oblique line", "line and two", "hexagon sides", "noisy cross")
HARD_TO_WALK = (*FANS, *THIN, "facing arcs", "nested clusters", "parabola")
DEAR = (
    "mixed exponents", "wide line", "huge by denormal", "powers of two", "wide spiral",
    "tiny and far", "colliding hashes",
)  # fmt: skip
"""Exact arithmetic makes these dear: they are counted at an eighth of the rows."""
