"""Named planar point distributions for benchmarks and tests.

Each takes a size and a random generator and returns an (n, 2) float64 array. The lattices round the
size to a whole number of lattice rows. Points come in random order, because sorted input favours
some programs.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from importlib import import_module
from math import isqrt
from pathlib import Path

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Points = NDArray[np.float64]
Distribution = Callable[[int, Generator], Points]

UTM_ORIGIN = (450_000.0, 5_200_000.0)
SMALLEST_STEP = 2.0**-1074
TERRAIN = Path(__file__).resolve().parent.parent / "data" / "jacksboro.ply"


def polar(radius: NDArray[np.float64] | float, angle: NDArray[np.float64]) -> Points:
    """Points by radius and angle."""
    return np.column_stack((radius * np.cos(angle), radius * np.sin(angle)))


def uniform(n: int, rng: Generator) -> Points:
    """Evenly spread over the unit square."""
    return rng.random((n, 2))


def gaussian(n: int, rng: Generator) -> Points:
    """Standard normal in both coordinates."""
    return rng.standard_normal((n, 2))


def kuzmin(n: int, rng: Generator) -> Points:
    """The Kuzmin disc, a model of galaxies: dense in the middle, unbounded."""
    radius = np.sqrt((1 - rng.random(n)) ** -2 - 1)
    return polar(radius, rng.uniform(0, 2 * np.pi, n))


def clusters(n: int, rng: Generator) -> Points:
    """One hundred normal clusters of sigma 0.05 in a square of 1000 x 1000."""
    centers = rng.uniform(0, 1000, (100, 2))
    return rng.normal(centers[rng.integers(0, 100, n)], 0.05)


def lattice(n: int, rng: Generator) -> Points:
    """The integers of a square."""
    side = isqrt(n)
    return rng.permutation(np.indices((side, side)).reshape(2, -1).T.astype(np.float64))


def tenth_lattice(n: int, rng: Generator) -> Points:
    """A lattice with spacing 0.1, which no double holds exactly."""
    return lattice(n, rng) * 0.1


def utm_lattice(n: int, rng: Generator) -> Points:
    """The lattice with spacing 0.1 at coordinates as large as a map's."""
    return tenth_lattice(n, rng) + UTM_ORIGIN


def centimetres(n: int, rng: Generator) -> Points:
    """Ten random points a square metre in whole centimetres, as files of laser scans hold them."""
    side = 100 * max(1, isqrt(n // 10))
    return rng.integers(0, side, (n, 2)) * 0.01 + UTM_ORIGIN


def tilted_lattice(n: int, rng: Generator) -> Points:
    """A unit lattice turned by an angle: rows that are only nearly straight."""
    return lattice(n, rng) @ np.array([[np.cos(0.3), np.sin(0.3)], [-np.sin(0.3), np.cos(0.3)]])


def hexagonal(n: int, rng: Generator) -> Points:
    """Equilateral triangles, nearly: six rounded points around every circle."""
    column, row = lattice(n, rng).T
    return np.column_stack((column + 0.5 * (row % 2), row * np.sqrt(0.75)))


def circle(n: int, rng: Generator) -> Points:
    """On the unit circle, up to rounding."""
    return polar(1.0, rng.uniform(0, 2 * np.pi, n))


def line_singularity(n: int, rng: Generator) -> Points:
    """Dense along one side of the unit square."""
    b = 0.001
    u, v = rng.random((2, n))
    return np.column_stack((b / (u - b * u + b), v))


def two_columns(n: int, rng: Generator) -> Points:
    """On two vertical lines: half of the points share each x."""
    return np.column_stack((rng.integers(0, 2, n).astype(np.float64), rng.random(n)))


def parabola(n: int, rng: Generator) -> Points:
    """On the parabola (t, t^2)."""
    t = rng.uniform(-1, 1, n)
    return np.column_stack((t, t * t))


def spiral(n: int, rng: Generator) -> Points:
    """On a spiral of fifty turns, evenly along its length."""
    t = np.sqrt(rng.random(n))
    return polar(t, 100 * np.pi * t)


def denormal(n: int, rng: Generator) -> Points:
    """All coordinates below the smallest normal double: a quarter of a million steps of it."""
    return rng.integers(0, 1 << 18, (n, 2)) * SMALLEST_STEP


@cache
def jacksboro_posts() -> Points:
    """Read the positions of the shipped terrain: 344 rows from north to south, 403 columns."""
    return import_module("liftmesh").read(TERRAIN).points[:, :2].reshape(344, 403, 2)


def jacksboro(n: int, rng: Generator) -> Points:
    """The posts of a real elevation model, tiled with copies of it until there are enough.

    A small size takes the posts of one corner. The tiles are one lattice step apart, so that no
    position occurs twice.
    """
    posts = jacksboro_posts()
    columns = min(posts.shape[1], isqrt(max(n - 1, 0)) + 1)
    tile = posts[:, :columns].reshape(-1, 2)
    steps = posts[0, 1, 0] - posts[0, 0, 0], posts[0, 0, 1] - posts[1, 0, 1]
    copies = -(-n // len(tile))
    across = isqrt(max(copies - 1, 0)) + 1
    width, height = np.ptp(tile, axis=0) + steps
    shifts = [(copy % across * width, -(copy // across) * height) for copy in range(copies)]
    return rng.permutation(np.concatenate([tile + shift for shift in shifts])[:n])


DISTRIBUTIONS: dict[str, Distribution] = {
    generate.__name__.replace("_", "-"): generate
    for generate in (
        uniform,
        gaussian,
        kuzmin,
        clusters,
        lattice,
        tenth_lattice,
        utm_lattice,
        centimetres,
        tilted_lattice,
        hexagonal,
        circle,
        line_singularity,
        two_columns,
        parabola,
        spiral,
        denormal,
        jacksboro,
    )
}
