"""Weighted points of every kind that merges and hiding have trouble with.

A family makes the points and the weights that a size takes: from 0, where all weigh the same, to
any. `with_share` finds the size at which the given share of the rows is hidden.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from distributions import DISTRIBUTIONS, Points, polar
from numpy.random import Generator
from numpy.typing import NDArray

import liftmesh

Weights = NDArray[np.float64]
Draw = Callable[[int, Generator], tuple[Points, Weights]]

STEPS = 12
"""Of the bisection, between the powers of two from -60 to 60."""


def drawn(name: str) -> Draw:
    """Points of a distribution, with weights evenly spread from 0 to 1."""

    def draw(n: int, rng: Generator) -> tuple[Points, Weights]:
        points = DISTRIBUTIONS[name](n, rng)
        return points, rng.random(len(points))

    return draw


def circles(n: int, rng: Generator) -> tuple[Points, Weights]:
    """On twenty circles around one centre."""
    radius = rng.integers(1, 21, n).astype(np.float64)
    return polar(radius, rng.uniform(0, 2 * np.pi, n)), rng.random(n)


def lattice(n: int, rng: Generator) -> tuple[Points, Weights]:
    """Integer points, which get integer weights: ties everywhere."""
    points = DISTRIBUTIONS["lattice"](n, rng)
    return points, rng.integers(0, 9, len(points)) / 8


def chains(n: int, rng: Generator) -> tuple[Points, Weights]:
    """On a few lines through one point, and as many rows at positions that are taken."""
    steps = rng.integers(-n, n, n)
    directions = np.array([(1, 0), (0, 1), (1, 1), (2, -1)])[rng.integers(0, 4, n)]
    return (steps[:, None] * directions).astype(np.float64), rng.integers(0, 5, n) / 4


FAMILIES: dict[str, Draw] = {
    **{
        name: drawn(name)
        for name in ("uniform", "clusters", "circle", "two-columns", "utm-lattice")
    },
    "circles": circles,
    "lattice": lattice,
    "collinear chains": chains,
}


def hidden_share(points: Points, weights: Weights) -> float:
    """Return the share of the rows that weights hide."""
    return len(liftmesh.regular(points, weights=weights, threads=1).hidden) / len(points)


def with_share(points: Points, weights: Weights, share: float) -> Weights:
    """Scale weights so that about a share of the rows is hidden, if it can be: zero for none."""
    if share == 0:
        return np.zeros(len(points))
    low, high = -60.0, 60.0
    for _ in range(STEPS):
        middle = (low + high) / 2
        few = hidden_share(points, scaled(points, weights, middle)) < share
        low, high = (middle, high) if few else (low, middle)
    return scaled(points, weights, high)


def scaled(points: Points, weights: Weights, power: float) -> Weights:
    """Scale weights by a power of two relative to the points' extent: to whole ones on lattices."""
    found = weights * np.ptp(points, axis=0).max() ** 2 * 2.0**power
    return np.rint(found) if (points == np.rint(points)).all() else found


def under_the_hull(points: Points) -> Weights:
    """Return weights that hide all rows but those on the hull."""
    weights = np.zeros(len(points))
    extent = np.ptp(points, axis=0).max()
    weights[liftmesh.delaunay(points, threads=1).convex_hull] = 8 * extent * extent
    return weights
