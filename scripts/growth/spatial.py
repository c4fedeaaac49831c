"""Worst known inputs of what works on points in space.

A lower hull grows where an inserted point hides many facets at once and its own facets are hidden
in turn, where all points share a plane, and where many rows stand at one planar position.
"""

from __future__ import annotations

from math import isqrt

import numpy as np
from distributions import Points, lattice, polar
from growth.families import families_in, random


def lifted_points(n: int) -> Points:
    """On the paraboloid: every row is a vertex of the lower hull."""
    planar = random().random((n, 2))
    return np.column_stack([planar, (planar**2).sum(axis=1)])


def random_heights(n: int) -> Points:
    """The ordinary cloud: few of its rows are on the lower hull."""
    return random().random((n, 3))


def cone(n: int) -> Points:
    """A rim and an apex below it: one vertex has all facets."""
    angles = 2 * np.pi * np.arange(n - 1) / (n - 1)
    rim = np.column_stack([polar(1.0, angles), np.zeros(n - 1)])
    return np.vstack([rim, [[0.0, 0.0, -1.0]]])


def insertion_order(count: int) -> np.ndarray:
    """Rounds of an order that is a function of the row number alone, as it once was."""
    number = np.arange(1, count + 1, dtype=np.uint64)
    scrambled = number * np.uint64(0x9E3779B97F4A7C15)
    for shift, factor in ((30, 0xBF58476D1CE4E5B9), (27, 0x94D049BB133111EB)):
        scrambled = (scrambled ^ scrambled >> np.uint64(shift)) * np.uint64(factor)
    scrambled ^= scrambled >> np.uint64(31)
    lowest = scrambled & (~scrambled + np.uint64(1))
    rounds = np.log2(lowest.astype(np.float64))
    return np.lexsort((np.arange(count), -rounds))


def adversarial_order(n: int) -> Points:
    """Apexes below a thin rim, each below those inserted before it in an order once known."""
    half = n // 2
    turn = (np.arange(half) + 0.5) / half
    y = -np.cos(np.pi * turn)
    side = np.where(np.arange(half) % 2 == 0, 1e-9, -1e-9)
    rim = np.column_stack([side * np.sqrt(np.maximum(0, 1 - y * y)), y])
    apexes = (random().random((half, 2)) - 0.5) * (1e-16, 1e-7)
    planar = np.vstack([rim, apexes])
    by_position = np.lexsort(planar.T)
    is_apex = by_position >= half
    order = insertion_order(len(planar))
    heights = np.zeros(len(planar))
    heights[order[is_apex[order]]] = -(1 + np.arange(half) * 1e-6)
    return np.column_stack([planar[by_position], heights])


def coplanar(n: int) -> Points:
    """A lattice in one plane: every test of four rows is an exact zero."""
    grid = lattice(n, random())
    return np.column_stack([grid, grid @ (3.0, 5.0)])


def towers(n: int) -> Points:
    """Many rows at each planar position, at heights of their own."""
    rng = random()
    side = max(isqrt(isqrt(n)), 2)
    return np.column_stack([rng.integers(0, side, (n, 2)).astype(np.float64), rng.random(n)])


def two_scales_of_height(n: int) -> Points:
    """Heights that only the widest integers tell apart."""
    rng = random()
    heights = np.ldexp(rng.random(n) + 0.5, rng.integers(-1000, 1000, n))
    return np.column_stack([rng.random((n, 2)), heights])


def descending(n: int) -> Points:
    """A staircase: each row below the hull of those before it in the order of the rows."""
    along = np.arange(n, dtype=np.float64)
    return np.column_stack([along, random().random(n), -along])


def thin_valley(n: int) -> Points:
    """Two rims and a chain between them: all facets are slivers."""
    x = np.repeat(np.arange(n // 2, dtype=np.float64), 2)
    y = np.tile([0.0, 1e-9], n // 2)
    return np.column_stack([x, y, np.abs(x - n / 4)])


SPATIAL = families_in(globals(), "Points")

DEEP = ("coplanar", "two scales of height", "thin valley")
"""Exact arithmetic makes these dear: they are counted at an eighth of the rows.

Not so "descending": among fewer than 64 rows little is exact, and what a row costs depends on the
secret order.
"""
