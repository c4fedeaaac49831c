"""Voronoi and power diagrams as arrays: what is dual to a triangulation.

The Voronoi vertex of a triangle is the centre of its circle; by weights, the point of equal power
to its corners. Triangles whose lifted corners lie in one plane share it, exactly. The arrays come
from the kernel, which rounds each coordinate of a vertex once: to the nearest double.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Floats, Rows
from liftmesh.base.threads import as_threads

_NO_VALUES = np.empty(0)


@dataclass(frozen=True, slots=True, eq=False)
class Diagram:
    """The vertices that are dual to a triangulation."""

    vertices: Floats
    simplex_to_vertex: Rows
    overflowed: int


@dataclass(frozen=True, slots=True, eq=False)
class Regions:
    """The ridges and regions that are dual to a triangulation."""

    ridge_points: Rows
    ridge_ends: Rows
    region_of: Rows
    starts: Rows
    corners: Rows


def diagram_of(
    points: Floats,
    simplices: Rows,
    neighbors: Rows,
    values: Floats = _NO_VALUES,
    kind: str = "plain",
) -> Diagram:
    """Compute the vertices that are dual to a triangulation."""
    threads = as_threads(None, len(points))
    return Diagram(*_kernel.vertices(points, values, kind, simplices, neighbors, *threads))


def regions_of(rows: int, simplices: Rows, neighbors: Rows, simplex_to_vertex: Rows) -> Regions:
    """Find what lies between the vertices of a diagram."""
    return Regions(*_kernel.regions(rows, simplices, neighbors, simplex_to_vertex))


def ridges_by_rows(
    ridge_points: Rows, ridge_vertices: list[list[int]]
) -> dict[tuple[int, int], list[int]]:
    """Return the vertices of each ridge by the rows of its two sites: SciPy's ``ridge_dict``."""
    return dict(zip(map(tuple, ridge_points.tolist()), ridge_vertices, strict=True))
