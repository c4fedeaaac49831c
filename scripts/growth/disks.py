"""Worst known inputs of what works on disks, and what is watched on them.

One disk may be a neighbour of all others, or contain them; and on lattices every circle touches
more than three.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import isqrt
from typing import Any

import numpy as np

import liftmesh
from growth.counting import Work
from growth.families import named, random

Disks = np.ndarray


def disjoint(n: int) -> Disks:
    """Small disks apart from each other."""
    rng = random()
    return np.c_[rng.random((n, 2)), rng.random(n) * 0.3 / np.sqrt(n)]


def overlapping(n: int) -> Disks:
    """Each disk meets many others, and most are hidden."""
    rng = random()
    return np.c_[rng.random((n, 2)), rng.random(n) * 5 / np.sqrt(n)]


def around_a_large_one(n: int) -> Disks:
    """A disk with all others for neighbours: its star must not be searched from end to end."""
    angles = random().random(n) * 2 * np.pi
    disks = np.c_[np.cos(angles), np.sin(angles), np.full(n, 0.1 / n)]
    disks[0] = 0, 0, 0.9
    return disks


def lattice_of_two_radii(n: int) -> Disks:
    """Many disks touch each circle: exact signs, and the rule for ties."""
    side = isqrt(n)
    centers = np.stack(np.meshgrid(np.arange(side), np.arange(side)), -1).reshape(-1, 2)
    return np.c_[centers, centers.sum(1) % 2 * 0.25].astype(float)


def growing_in_a_row(n: int) -> Disks:
    """Disks of one common tangent, each of which sees only those beside it."""
    along = np.arange(1.0, n + 1)
    return np.c_[along, along / 4, along / 4]


DISKS = named(disjoint, overlapping, around_a_large_one, lattice_of_two_radii, growing_in_a_row)


def prepare(disks: Disks) -> Work:
    """Prepare a graph."""
    centers, radii = disks[:, :2].copy(), disks[:, 2].copy()
    return Work(lambda: liftmesh.apollonius(centers, radii), len(disks))


def find_neighbors(disks: Disks) -> Work:
    """Prepare a look at one disk."""
    graph = liftmesh.apollonius(disks[:, :2], disks[:, 2])
    return Work(lambda: graph.neighbors_of(0), len(disks))


def find_sides(disks: Disks) -> Work:
    """Prepare the sides of all cells."""
    graph = liftmesh.apollonius(disks[:, :2], disks[:, 2])
    return Work(lambda: graph.cell_sides((0, 0, 1, 1), 0.01), len(disks))


def verify(disks: Disks) -> Work:
    """Prepare the verification of a graph."""
    graph = liftmesh.apollonius(disks[:, :2], disks[:, 2])
    return Work(lambda: graph.verify(threads=1), len(disks))


def disk_functions() -> Iterator[tuple[Any, ...]]:
    """Name, families, preparation and counted families of what takes disks."""
    yield "apollonius", DISKS, prepare, tuple(DISKS)
    yield "ApolloniusGraph.cell_sides", DISKS, find_sides, ("disjoint",)
    yield "ApolloniusGraph.verify", DISKS, verify, tuple(DISKS)
    yield "ApolloniusGraph.neighbors_of", DISKS, find_neighbors, ("disjoint",)


FUNCTIONS = tuple(disk_functions())
