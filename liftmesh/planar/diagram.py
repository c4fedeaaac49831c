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
from liftmesh.threads import as_threads

_NO_VALUES = np.empty(0)


@dataclass(frozen=True, slots=True, eq=False)
class Diagram:
    """The vertices that are dual to a triangulation.

    Parameters
    ----------
    vertices : (v, 2) ndarray of float64
        Each coordinate is the double nearest to the exact one, or infinite.
    simplex_to_vertex : (m,) ndarray of int32
        The vertex of each triangle.
    overflowed : int
        How many vertices have a coordinate that is infinite.

    Examples
    --------
    >>> import liftmesh
    >>> tri = liftmesh.delaunay([[0, 0], [2, 0], [2, 2], [0, 2]])
    >>> found = diagram_of(tri.points, tri.simplices, tri.neighbors)
    >>> found.vertices, found.simplex_to_vertex
    (array([[1., 1.]]), array([0, 0], dtype=int32))
    """

    vertices: Floats
    simplex_to_vertex: Rows
    overflowed: int


@dataclass(frozen=True, slots=True, eq=False)
class Regions:
    """The ridges and regions that are dual to a triangulation.

    Parameters
    ----------
    ridge_points : (r, 2) ndarray of int32
        The rows of both sites of each ridge. The second of a ray is the next on the hull, which
        runs counter-clockwise.
    ridge_ends : (r, 2) ndarray of int32
        The vertices at its ends, the lesser first; the first of a ray is -1.
    region_of : (n,) ndarray of int32
        The region of each row, or -1. Unbounded regions come first.
    starts, corners : ndarray of int32
        The vertices around region i are ``corners[starts[i]:starts[i + 1]]``, counter-clockwise.
        Those of an unbounded region begin with -1.

    Examples
    --------
    >>> import liftmesh
    >>> tri = liftmesh.delaunay([[0, 0], [2, 0], [2, 2], [0, 2]])
    >>> vertex = diagram_of(tri.points, tri.simplices, tri.neighbors).simplex_to_vertex
    >>> regions_of(4, tri.simplices, tri.neighbors, vertex).ridge_ends.tolist()
    [[-1, 0], [-1, 0], [-1, 0], [-1, 0]]
    """

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
    """Compute the vertices that are dual to a triangulation.

    Parameters
    ----------
    points : (n, 2) ndarray of float64
        Contiguous rows.
    simplices, neighbors : (m, 3) ndarray of int32
        The triangles, counter-clockwise, as `Triangulation` has them.
    values : (n,) ndarray of float64
        The weights or radii, if there are any.
    kind : {"plain", "weights", "radii"}
        What they are.

    Returns
    -------
    Diagram
        The arrays.
    """
    threads = as_threads(None, len(points))
    return Diagram(*_kernel.vertices(points, values, kind, simplices, neighbors, *threads))


def regions_of(rows: int, simplices: Rows, neighbors: Rows, simplex_to_vertex: Rows) -> Regions:
    """Find what lies between the vertices of a diagram.

    Parameters
    ----------
    rows : int
        How many there are.
    simplices, neighbors : (m, 3) ndarray of int32
        The triangles, as for `diagram_of`.
    simplex_to_vertex : (m,) ndarray of int32
        The vertex of each.

    Returns
    -------
    Regions
        The arrays.
    """
    return Regions(*_kernel.regions(rows, simplices, neighbors, simplex_to_vertex))


def ridges_by_rows(
    ridge_points: Rows, ridge_vertices: list[list[int]]
) -> dict[tuple[int, int], list[int]]:
    """Return the vertices of each ridge by the rows of its two sites: SciPy's ``ridge_dict``.

    Parameters
    ----------
    ridge_points : (r, 2) ndarray of int32
        The rows.
    ridge_vertices : list of list of int
        The vertices at both ends.

    Returns
    -------
    dict
        As SciPy has it.

    Examples
    --------
    >>> ridges_by_rows(np.array([[0, 2]]), [[-1, 5]])
    {(0, 2): [-1, 5]}
    """
    return dict(zip(map(tuple, ridge_points.tolist()), ridge_vertices, strict=True))
