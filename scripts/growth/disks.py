"""Worst known inputs of what works on disks, and what is watched on them.

One disk may be a neighbour of all others, or contain them; and on lattices every circle touches
more than three.
"""

from __future__ import annotations

import copy
import io
from collections.abc import Callable, Iterator
from math import isqrt
from typing import Any

import numpy as np
from growth.cells import CELLS
from growth.counting import Work
from growth.families import FEW, named, random

import liftmesh

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


def beside_a_large_one(n: int) -> Disks:
    """A large disk on the circle of the others hides some: its star is not searched for these."""
    disks = around_a_large_one(n)
    disks[0] = 1, 0, 0.4
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


def tiny_and_far(n: int) -> Disks:
    """Disks that are tiny beside their distances, far from the origin, and a large one apart."""
    rng = random()
    disks = np.c_[1e5 + rng.random((n, 2)), rng.random(n) * 1e-6]
    disks[0] = 1e6, 1e6, 1e3
    return disks


def nearly_hidden(n: int) -> Disks:
    """Disks that hardly come out of a large one: their cells are narrow, and terms cancel."""
    rng = random()
    angles, radii = rng.random(n) * 2 * np.pi, rng.random(n) / 2
    out = radii * (1 + 10.0 ** -rng.integers(3, 12, n))
    disks = np.c_[(1 - radii) * np.cos(angles), (1 - radii) * np.sin(angles), out]
    disks[0] = 0, 0, 1
    return disks


DISKS = named(
    disjoint, overlapping, around_a_large_one, beside_a_large_one, lattice_of_two_radii,
    growing_in_a_row, tiny_and_far, nearly_hidden,
)  # fmt: skip


def prepare(disks: Disks) -> Work:
    """Prepare a graph."""
    centers, radii = disks[:, :2].copy(), disks[:, 2].copy()
    return Work(lambda: liftmesh.apollonius(centers, radii), len(disks))


def find_neighbors(disks: Disks) -> Work:
    """Prepare a look at one disk."""
    graph = liftmesh.apollonius(disks[:, :2], disks[:, 2])
    return Work(lambda: graph.neighbors_of(0), len(disks))


def find_sides(disks: Disks) -> Work:
    """Prepare the sides of all cells; a unit is a disk or a point of a side."""
    graph = liftmesh.apollonius(disks[:, :2], disks[:, 2])
    box = boxed(disks)
    tolerance = 1e-3 * float(np.sqrt((box[2] - box[0]) * (box[3] - box[1]) / len(disks)))
    points = sum(len(line) for _, line in graph.cell_sides(box, tolerance))
    return Work(lambda: graph.cell_sides(box, tolerance), len(disks) + points)


def boxed(disks: Disks) -> tuple[float, float, float, float]:
    """A box that most centres are in."""
    low, high = np.quantile(disks[:, :2], (0.01, 0.99), axis=0)
    return (*low.tolist(), *high.tolist())


def clipped(disks: Disks) -> liftmesh.ApolloniusCells:
    """Clip cells to such a box."""
    return liftmesh.apollonius_diagram(disks[:, :2], disks[:, 2], domain=boxed(disks))


def find_cells(disks: Disks) -> Work:
    """Prepare the cells in a box; a unit is a disk or a corner."""
    return Work(lambda: clipped(disks), len(disks) + len(clipped(disks).corners))


def on_cells(call: Callable[[liftmesh.ApolloniusCells], object]) -> Callable[[Disks], Work]:
    """Prepare a call on fresh cells."""

    def prepared(disks: Disks) -> Work:
        found = clipped(disks)
        return Work(lambda: call(copy.copy(found)), len(disks) + len(found.corners))

    return prepared


def verify(disks: Disks) -> Work:
    """Prepare the verification of a graph."""
    graph = liftmesh.apollonius(disks[:, :2], disks[:, 2])
    return Work(lambda: graph.verify(threads=1), len(disks))


def disk_functions() -> Iterator[tuple[Any, ...]]:
    """Name, families, preparation and counted families of what takes disks."""
    yield "apollonius", DISKS, prepare, tuple(DISKS)
    yield "ApolloniusGraph.cell_sides", DISKS, find_sides, ("disjoint",), FEW
    yield "apollonius_diagram", DISKS, find_cells, ("disjoint", "tiny and far"), FEW
    for name in CELLS:
        yield f"ApolloniusCells.{name}", DISKS, on_cells(lambda c, n=name: getattr(c, n)), ()
    kind = liftmesh.ApolloniusCells
    for method in (kind.to_shapely, kind.to_geodataframe):
        yield f"ApolloniusCells.{method.__name__}", DISKS, on_cells(method), ()
    saved = on_cells(lambda c: c.save(io.BytesIO(), format="geojson"))
    yield "ApolloniusCells.save", DISKS, saved, ()
    yield "ApolloniusGraph.verify", DISKS, verify, tuple(DISKS)
    yield "ApolloniusGraph.neighbors_of", DISKS, find_neighbors, ("disjoint",)


FUNCTIONS = tuple(disk_functions())
