"""Random points as in the paper's Section 5, and the orders in which a program may store them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from liftmesh.paper.experiments import Trial
from liftmesh.paper.printed import SQUARE, TABLES, TableName
from liftmesh.planar.lifting import resolve_apex

TABLE_OF_CASE: dict[int, TableName] = {1: "5.1", 2: "5.2"}
BITS = 10
Points = NDArray[np.float64]
Vertex = tuple[float, float]


def uniform(n: int, seed: int) -> Points:
    """Draw n points in the paper's square; both tables have the same ones."""
    return Trial("5.1", n, seed).points()


def vertex(case: int, points: Points) -> Vertex:
    """Return q: the origin in case 1, the median point in case 2."""
    return resolve_apex(TABLES[TABLE_OF_CASE[case]].q, points)


def generated(points: Points, _q: Vertex) -> Points:
    """Keep the order in which the points were drawn."""
    return points


def by_x(points: Points, _q: Vertex) -> Points:
    """Sort by x."""
    return points[np.argsort(points[:, 0])]


def by_y(points: Points, _q: Vertex) -> Points:
    """Sort by y, as a search for the first edge in Oyz may leave them."""
    return points[np.argsort(points[:, 1])]


def by_z(points: Points, q: Vertex) -> Points:
    """Sort by z, the squared distance from q."""
    return points[np.argsort(((points - q) ** 2).sum(axis=1))]


def by_cells(points: Points, _q: Vertex) -> Points:
    """Sort along the Z-shaped curve through the cells of a fine grid."""
    column, row = (points / SQUARE * (1 << BITS)).astype(np.int64).T
    bits = np.arange(BITS)
    key = (column[:, None] >> bits & 1) << 2 * bits | (row[:, None] >> bits & 1) << 2 * bits + 1
    return points[np.argsort(key.sum(axis=1))]


ORDERS: dict[str, Callable[[Points, Vertex], Points]] = {
    "as generated": generated,
    "sorted by x": by_x,
    "sorted by y": by_y,
    "sorted by z": by_z,
    "by cells": by_cells,
}


def write(points: Points, file: Path) -> None:
    """Write the rows as the C program reads them."""
    np.ascontiguousarray(points, np.float64).tofile(file)
