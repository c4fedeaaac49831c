"""Surfaces, and points in the middle of them, where natural neighbours are compared.

Near the hull, faces are slivers: their circles are large, and CGAL's coordinates of the centres,
which count from the origin, have few digits for areas. So points there are left out.
"""

from __future__ import annotations

from collections.abc import Callable
from math import isqrt

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Planar = NDArray[np.float64]
RIM = 0.1  # of the square, at each side


def uniform(n: int, rng: Generator) -> Planar:
    """Points anywhere."""
    return rng.random((n, 2))


def clusters(n: int, rng: Generator) -> Planar:
    """Half of the points in a hundred heaps."""
    heaps = rng.random((100, 2))[rng.integers(0, 100, n // 2)]
    near = heaps + 0.01 * rng.standard_normal((n // 2, 2))
    return np.concatenate([rng.random((n - n // 2, 2)), np.clip(near, 0, 1)])


def lattice(n: int, _: Generator) -> Planar:
    """Four points on each smallest circle."""
    side = isqrt(n)
    return np.stack(np.meshgrid(np.arange(side), np.arange(side)), -1).reshape(-1, 2) / (side - 1)


def nearly_lattice(n: int, rng: Generator) -> Planar:
    """Four points nearly on each smallest circle."""
    whole = lattice(n, rng)
    return np.clip(whole + 1e-9 * rng.standard_normal(whole.shape), 0, 1)


def scan_lines(n: int, rng: Generator) -> Planar:
    """Points ten times denser along lines than across, as a scanner leaves them."""
    lines = np.arange(isqrt(n // 10)) / (isqrt(n // 10) - 1)
    along = rng.random((len(lines), n // len(lines)))
    jitter = 1e-3 * rng.standard_normal(along.shape) / len(lines)
    return np.column_stack([along.ravel(), np.clip(lines[:, None] + jitter, 0, 1).ravel()])


FAMILIES: dict[str, Callable[[int, Generator], Planar]] = {
    "uniform": uniform,
    "clusters": clusters,
    "lattice": lattice,
    "nearly a lattice": nearly_lattice,
    "scan lines": scan_lines,
}


def terrain(planar: Planar) -> Planar:
    """Give points of the unit square the heights of a wave."""
    x, y = planar.T
    return np.column_stack([planar, 60 * np.sin(11 * x) + 40 * np.cos(18 * y)])


def inside(n: int, rng: Generator) -> Planar:
    """Points of the unit square that are not near its border."""
    return rng.uniform(RIM, 1 - RIM, (n, 2))
