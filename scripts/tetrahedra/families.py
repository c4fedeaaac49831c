"""Points in space of every kind that tetrahedra have trouble with."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from distributions import Points, jacksboro
from numpy.random import Generator

Draw = Callable[[int, Generator], Points]
TILT = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])


def uniform(n: int, rng: Generator) -> Points:
    """Evenly spread over the unit cube."""
    return rng.random((n, 3))


def sphere(n: int, rng: Generator) -> Points:
    """On the unit sphere, rounded."""
    direction = rng.standard_normal((n, 3))
    return direction / np.linalg.norm(direction, axis=1)[:, None]


def ball(n: int, rng: Generator) -> Points:
    """Evenly spread over the unit ball."""
    return sphere(n, rng) * rng.random((n, 1)) ** (1 / 3)


def lattice(n: int, rng: Generator) -> Points:
    """The integers of a cube."""
    side = round(n ** (1 / 3))
    return rng.permutation(np.indices((side, side, side)).reshape(3, -1).T.astype(np.float64))


def moment_curve(n: int, _: Generator) -> Points:
    """On (t, t^2, t^3), n^2 tetrahedra: as many as others have of n points."""
    t = np.arange(2 * n**0.5) / n**0.5
    return np.column_stack([t, t * t, t**3])


def helix(n: int, rng: Generator) -> Points:
    """On a helix of many turns."""
    t = rng.uniform(0, 60 * np.pi, n // 8)
    return np.column_stack([np.cos(t), np.sin(t), t / 10])


def clusters(n: int, rng: Generator) -> Points:
    """Of sigma 0.05 in a cube of 1000."""
    centers = rng.uniform(0, 1000, (max(n // 200, 1), 3))
    return rng.normal(centers[rng.integers(0, len(centers), n)], 0.05)


def two_lines(n: int, rng: Generator) -> Points:
    """On two skew lines, n^2 tetrahedra."""
    along = rng.random(max(int(n**0.5), 2))
    zero = np.zeros_like(along)
    lines = [np.column_stack([along, zero, zero]), np.column_stack([zero, along, zero + 1])]
    return np.vstack(lines)


def slabs(n: int, rng: Generator) -> Points:
    """In few parallel planes."""
    return np.column_stack([rng.random((n, 2)), rng.integers(0, 4, n)])


def thin(n: int, rng: Generator) -> Points:
    """Nearly in one plane."""
    return rng.random((n, 3)) * (1, 1, 1e-9)


def ulps(n: int, rng: Generator) -> Points:
    """Few ulps from each other."""
    return 1 + rng.integers(0, 2 + round(n ** (1 / 3)), (n, 3)) * 2.0**-52


def spread(n: int, rng: Generator) -> Points:
    """Of all magnitudes from 2^-40 to 2^40."""
    return np.ldexp(rng.uniform(-1, 1, (n, 3)), rng.integers(-40, 40, (n, 1)))


def spheres(n: int, rng: Generator) -> Points:
    """Integers on concentric spheres, each many times cospherical."""
    reach = np.arange(-21, 22)
    grid = np.stack(np.meshgrid(reach, reach, reach), axis=-1).reshape(-1, 3)
    squares = (grid**2).sum(axis=1)
    chosen = grid[np.isin(squares, (9, 81, 146, 225, 306, 441))]
    return rng.permutation(chosen)[:n].astype(np.float64)


def outlier(n: int, rng: Generator) -> Points:
    """One point so far that all others are at one place of the curve."""
    return np.vstack([rng.random((n - 1, 3)), [[1e9, 2e9, 3e9]]])


def columns(n: int, rng: Generator) -> Points:
    """Many heights over each of few planar positions, every row twice."""
    side = max(int(n**0.25), 2)
    points = np.column_stack([rng.integers(0, side, (n // 2, 2)), rng.random(n // 2)])
    return rng.permutation(np.vstack([points, points]))


def surveyed(n: int, rng: Generator) -> Points:
    """Terrain: planar positions in metres of a grid, heights in centimetres."""
    planar = jacksboro(n, rng)
    heights = np.rint(100 * np.sin(planar[:, 0] / 300) * np.cos(planar[:, 1] / 200)) / 100
    return np.column_stack([planar, heights])


FAMILIES: dict[str, Draw] = {
    "uniform": uniform,
    "ball": ball,
    "sphere": sphere,
    "lattice": lattice,
    "0.1-lattice": lambda n, rng: lattice(n, rng) * 0.1,
    "tilted lattice": lambda n, rng: lattice(n, rng) @ TILT,
    "moment curve": moment_curve,
    "helix": helix,
    "clusters": clusters,
    "two lines": two_lines,
    "slabs": slabs,
    "thin": thin,
    "ulps": ulps,
    "denormal": lambda n, rng: lattice(n, rng) * 2.0**-1074,
    "2^500": lambda n, rng: uniform(n, rng) * 2.0**500,
    "2^-500": lambda n, rng: uniform(n, rng) * 2.0**-500,
    "spread": spread,
    "spheres": spheres,
    "outlier": outlier,
    "columns": columns,
    "survey": surveyed,
}
