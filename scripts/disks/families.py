"""Disks of every kind that a graph of them has trouble with.

`TIED` names the families where more than three disks touch one circle. There a program has a choice
of triangles, but not of the circles.
"""

from __future__ import annotations

from collections.abc import Callable
from math import isqrt

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Disks = NDArray[np.float64]


def uniform_radii(n: int, rng: Generator) -> Disks:
    """Disks of any radius up to the distance of neighbours."""
    return np.c_[rng.random((n, 2)), rng.random(n) / np.sqrt(n)]


def disjoint(n: int, rng: Generator) -> Disks:
    """A lattice, moved by less than the gap between its disks."""
    side = isqrt(n)
    cells = np.stack(np.meshgrid(np.arange(side), np.arange(side)), -1).reshape(-1, 2)
    moved = cells + 0.2 * rng.random((len(cells), 2))
    return np.c_[moved, 0.05 + 0.3 * rng.random(len(cells))]


def heavy_overlap(n: int, rng: Generator) -> Disks:
    """Disks that each meet a hundred others; most are hidden."""
    return np.c_[rng.random((n, 2)), 10 * rng.random(n) / np.sqrt(n)]


def one_large_disk(n: int, rng: Generator) -> Disks:
    """Small disks around one that covers half of the square, and on it."""
    disks = uniform_radii(n, rng)
    disks[:, 2] *= 0.3
    disks[0] = 0.5, 0.5, 0.4
    return disks


def around_a_large_disk(n: int, rng: Generator) -> Disks:
    """A disk that all others are neighbours of."""
    angles = 2 * np.pi * rng.random(n)
    disks = np.c_[np.cos(angles), np.sin(angles), 0.3 * rng.random(n) / n]
    disks[0] = 0, 0, 0.9
    return disks


def many_sizes(n: int, rng: Generator) -> Disks:
    """Radii over four orders of magnitude."""
    return np.c_[rng.random((n, 2)), 0.3 * 1e4 ** -rng.random(n)]


def lattice(n: int, _: Generator) -> Disks:
    """A lattice of equal disks."""
    side = isqrt(n)
    cells = np.stack(np.meshgrid(np.arange(side), np.arange(side)), -1).reshape(-1, 2)
    return np.c_[cells, np.full(len(cells), 0.25)]


def lattice_of_integers(n: int, rng: Generator) -> Disks:
    """A lattice of integers with integer radii."""
    disks = lattice(n, rng)
    disks[:, 2] = rng.integers(0, 4, len(disks))
    return disks


def tangent_chains(n: int, rng: Generator) -> Disks:
    """Rows of disks that touch each other and a common line."""
    rows = isqrt(n)
    across = np.repeat(np.arange(rows), rows) * 8.0
    along = np.tile(np.arange(rows), rows) * 2.0
    radii = np.where(rng.random(len(along)) < 0.5, 1.0, 0.25)
    return np.c_[along, across + radii, radii]


FAMILIES: dict[str, Callable[[int, Generator], Disks]] = {
    family.__name__.replace("_", " "): family
    for family in (
        uniform_radii,
        disjoint,
        heavy_overlap,
        one_large_disk,
        around_a_large_disk,
        many_sizes,
        lattice,
        lattice_of_integers,
        tangent_chains,
    )
}
TIED = ("lattice", "lattice of integers", "tangent chains")
