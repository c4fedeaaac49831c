"""Points and edges of every kind that constrained triangulations have trouble with.

A family takes about how many edges there are to be, and a generator. Edges cross in none, and there
are no equal rows. Both come in random order, but for the rings of `coast`.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import accumulate, pairwise
from math import isqrt

import contourpy
import numpy as np
from distributions import Points, polar
from numpy.random import Generator
from numpy.typing import NDArray
from oracles.second_opinion import find_neighbors

import liftmesh

Edges = NDArray[np.int32]
Case = tuple[Points, Edges]
Family = Callable[[int, Generator], Case]

SPECTRAL_EXPONENT = 2.9
POSTS = 1600  # of a side, for the 105,000 points of the coast
COAST = 105_000
SEA_LEVEL = 0.27  # in deviations: it and the least ring give 105,000 points in 2,900 rings
LEAST_RING = 6  # points
CLOSE = 1.001  # radii of rings and turns: twice as far apart as their chords are deep


def shuffled(points: Points, edges: Edges, rng: Generator) -> Case:
    """Rows, edges and the ends of each in random order."""
    order = rng.permutation(len(points))
    rank = np.empty(len(points), dtype=np.int32)
    rank[order] = np.arange(len(points), dtype=np.int32)
    return points[order], rng.permuted(rank[rng.permutation(edges)], axis=1)


def tiling(n: int, rng: Generator) -> Case:
    """A grid jittered by 0.45, and as many of its row and column edges as it has points."""
    side = isqrt(n)
    rows = np.arange(side * side, dtype=np.int32).reshape(side, side)
    points = np.indices((side, side)).reshape(2, -1).T + rng.uniform(-0.45, 0.45, (side * side, 2))
    pairs = [(rows[:-1], rows[1:]), (rows[:, :-1], rows[:, 1:])]
    edges = np.concatenate([np.column_stack([a.ravel(), b.ravel()]) for a, b in pairs])
    return shuffled(points, rng.permutation(edges)[:n], rng)


def flipped(n: int, rng: Generator) -> Case:
    """Uniform points, and a third of the edges of a triangulation that was Delaunay once."""
    return flips(rng.random((n, 2)), n, 9 * n // 5, rng)


def flips(points: Points, count: int, flips: int, rng: Generator) -> Case:
    """Draw among the edges of a triangulation that was Delaunay before random flips.

    In a round flip random sides, one in five at most, whose triangles no side drawn before has, and
    whose triangles form a strictly convex quadrilateral.
    """
    corners = liftmesh.delaunay(points).simplices.copy()
    while flips > 0:
        t = rng.permutation(len(corners))[: len(corners) // 5 + 1]
        k = rng.integers(0, 3, len(t))
        beyond = find_neighbors(corners)
        t, k = _alone(t, k, beyond)
        other = beyond[t, k]
        apex = (beyond[other] == t[:, None]).argmax(axis=1)
        p, a, b = (corners[t, (k + i) % 3] for i in range(3))
        q = corners[other, apex]
        convex = (liftmesh.orient2d(*points[[p, a, q]]) > 0) & (
            liftmesh.orient2d(*points[[q, b, p]]) > 0
        )
        chosen = np.flatnonzero(convex)[:flips]
        corners[t[chosen]] = np.column_stack([p, a, q])[chosen]
        corners[other[chosen]] = np.column_stack([q, b, p])[chosen]
        flips -= len(chosen)
    inner = find_neighbors(corners) < np.arange(len(corners))[:, None]  # each side once
    t, k = np.nonzero(inner)
    edges = np.column_stack([corners[t, k - 1], corners[t, k - 2]])
    return shuffled(points, rng.permutation(edges)[:count], rng)


def _alone(t: Edges, k: Edges, beyond: Edges) -> tuple[Edges, Edges]:
    """Keep the inner sides whose triangles no side before them has."""
    inner = beyond[t, k] >= 0
    t, k = t[inner], k[inner]
    numbers = np.arange(len(t))
    first = np.full(len(beyond), len(t))
    for each in (t, beyond[t, k]):
        np.minimum.at(first, each, numbers)
    alone = (first[t] == numbers) & (first[beyond[t, k]] == numbers)
    return t[alone], k[alone]


def coast(n: int, rng: Generator) -> Case:
    """Rings of the contour of fractal noise, in their order: land, lakes, islands in lakes."""
    rings = coastline(round(POSTS * (n / COAST) ** 0.6), rng)
    starts = [0, *accumulate(map(len, rings))]
    edges = [np.column_stack([np.arange(i, j), [*range(i + 1, j), i]]) for i, j in pairwise(starts)]
    return np.concatenate(rings), np.concatenate(edges).astype(np.int32)


def coastline(posts: int, rng: Generator) -> list[Points]:
    """Rings at the sea level of a square of land in the sea, without the first point again."""
    frequency = np.hypot(np.fft.fftfreq(posts)[:, None], np.fft.rfftfreq(posts))
    frequency[0, 0] = np.inf
    noise = np.fft.rfft2(rng.standard_normal((posts, posts))) * frequency ** (
        -SPECTRAL_EXPONENT / 2
    )
    heights = np.fft.irfft2(noise, (posts, posts))
    heights = np.pad(heights / heights.std(), 1, constant_values=-9.0)
    lines = contourpy.contour_generator(z=heights).lines(SEA_LEVEL)
    return [line[:-1] for line in lines if len(line) > LEAST_RING]


def shuffled_coast(n: int, rng: Generator) -> Case:
    """The same coast in random order."""
    return shuffled(*coast(n, rng), rng)


def star(n: int, rng: Generator) -> Case:
    """Spokes of a wheel without a rim."""
    ends = polar(rng.uniform(0.1, 1, n), rng.uniform(0, 2 * np.pi, n))
    spokes = np.column_stack([np.zeros(n, dtype=np.int32), np.arange(1, n + 1, dtype=np.int32)])
    return shuffled(np.vstack([[[0.0, 0.0]], ends]), spokes, rng)


def path(points: Points, rng: Generator) -> Case:
    """One polyline through points."""
    along = np.arange(len(points), dtype=np.int32)
    return shuffled(points, np.column_stack([along[:-1], along[1:]]), rng)


def comb(n: int, rng: Generator) -> Case:
    """A polyline up and down, its teeth a thousand times as long as they are apart."""
    up = np.arange(n + 1) % 2
    return path(np.column_stack([np.arange(n + 1.0), 1000 * (up + 0.2 * rng.random(n + 1))]), rng)


def spiral(n: int, rng: Generator) -> Case:
    """A polyline of a hundred points a turn, whose turns are much closer than its points."""
    turns = np.arange(n + 1) / 100.38
    return path(polar(CLOSE**turns, 2 * np.pi * turns), rng)


def rings(n: int, rng: Generator) -> Case:
    """Rings of a hundred points around each other, each turned at random."""
    rows = np.arange(100 * max(n // 100, 1), dtype=np.int32).reshape(-1, 100)
    ring = np.arange(len(rows))[:, None]
    turned = rng.random((len(rows), 1)) + np.arange(100) / 100
    points = polar((CLOSE**ring + 0 * turned).ravel(), 2 * np.pi * turned.ravel())
    return shuffled(points, np.column_stack([rows.ravel(), np.roll(rows, -1, axis=1).ravel()]), rng)


def parallels(n: int, rng: Generator) -> Case:
    """Edges from one side of a square to the other that nearly are parallel."""
    left, right = np.sort(rng.random((2, n)), axis=1)
    at = rng.random((2, n)) * 0.1 + [[0.0], [0.9]]
    points = [np.column_stack([x, left + x * (right - left)]) for x in at]
    rows = np.arange(n, dtype=np.int32)
    return shuffled(np.concatenate(points), np.column_stack([rows, rows + n]), rng)


def strip(n: int, rng: Generator) -> Case:
    """One edge along a strip of points that is as narrow as they are close."""
    points = np.column_stack([rng.random(n), rng.uniform(-1, 1, n) / n])
    ends = [[-0.1, 0.0], [1.1, 0.0]]
    return shuffled(np.vstack([points, ends]), np.array([[n, n + 1]], dtype=np.int32), rng)


def zigzag(n: int, rng: Generator) -> Case:
    """A polyline from left to right, between points on two sides of a square."""
    x = np.sort(rng.random(n + 1))
    return path(np.column_stack([x, np.arange(n + 1) % 2 + 0.01 * x * (1 - x)]), rng)


FAMILIES: dict[str, Family] = {
    "tiling": tiling,
    "uniform": flipped,
    "coast": coast,
    "shuffled coast": shuffled_coast,
    "star": star,
    "comb": comb,
    "spiral": spiral,
    "nested rings": rings,
    "nearly parallel": parallels,
    "strip": strip,
    "zigzag": zigzag,
}
