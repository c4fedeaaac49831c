"""Voronoi and power diagrams as arrays: what is dual to a triangulation.

The Voronoi vertex of a triangle is the centre of its circle; by weights, the point of equal power
to its corners. Triangles whose lifted corners lie in one plane share it, exactly. The arrays come
from the kernel, which rounds each coordinate of a vertex once: to the nearest double.

Power cells may have no area. The cell of a vertex is the set of slopes of the planes that touch the
lower hull at its lifted point, and the slopes of the triangles around it are its corners. Across an
edge the slope changes by a vector perpendicular to the edge, and by nothing if the four lifted
corners lie in one plane. So the cell has an area unless all edges at the vertex with a change lie
on one line: then there are none, or two. Towards the outside slopes grow without bound, so a hull
edge always counts. Each change is the exact sign of four lifted points.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Floats, Mask, Rows
from liftmesh.base.arrays import widened
from liftmesh.base.options import as_threads
from liftmesh.planar.points import edges_around, pieces
from liftmesh.predicates import orient2d

if TYPE_CHECKING:
    from liftmesh.planar.kinds import TriangulationKind

_NO_VALUES = np.empty(0)


@dataclass(frozen=True, slots=True, eq=False)
class Diagram:
    """The vertices that are dual to a triangulation."""

    vertices: Floats  # each coordinate is the double nearest to the exact one, or infinite
    simplex_to_vertex: Rows
    overflowed: int  # how many vertices have an infinite coordinate


@dataclass(frozen=True, slots=True, eq=False)
class Regions:
    """The ridges and regions that are dual to a triangulation."""

    ridge_points: Rows  # both sites; the second of a ray is the next on the hull
    ridge_ends: Rows  # the lesser vertex first; the first of a ray is -1
    region_of: Rows  # of each row, or -1; unbounded regions come first
    starts: Rows  # of regions among the corners, and the end
    corners: Rows  # vertices, counter-clockwise; those of an unbounded region begin with -1


def diagram_of(
    points: Floats,
    simplices: Rows,
    neighbors: Rows,
    values: Floats = _NO_VALUES,
    kind: str = "plain",  # or "weights" or "radii", which the values are
    *,
    threads: int | None = None,
) -> Diagram:
    """Compute the vertices that are dual to a triangulation."""
    used = as_threads(threads, len(points))
    return Diagram(*_kernel.vertices(points, values, kind, simplices, neighbors, *used))


def regions_of(rows: int, simplices: Rows, neighbors: Rows, simplex_to_vertex: Rows) -> Regions:
    """Find what lies between the vertices of a diagram."""
    return Regions(*_kernel.regions(rows, simplices, neighbors, simplex_to_vertex))


def ridges_by_rows(
    ridge_points: Rows, ridge_vertices: list[list[int]]
) -> dict[tuple[int, int], list[int]]:
    """Return the vertices of each ridge by the rows of its two sites: SciPy's ``ridge_dict``."""
    return dict(zip(map(tuple, ridge_points.tolist()), ridge_vertices, strict=True))


class LiftedTriangles(NamedTuple):
    """A regular triangulation: its triangles, and what lowers the rows."""

    points: Floats
    simplices: Rows
    neighbors: Rows
    hull: Rows  # vertices, counter-clockwise
    kind: TriangulationKind  # by weights or radii


def rows_without_area(lifted: LiftedTriangles) -> Rows:
    """Find the vertices whose power cell has area zero."""
    quads = _interior_edges(lifted)
    is_flat = _are_coplanar(lifted, quads)
    flat = quads[is_flat][:, 1:3]
    if not len(flat):
        return np.empty(0, dtype=np.int32)
    hull = edges_around(lifted.hull)
    creased = np.concatenate([quads[~is_flat][:, 1:3], hull])
    count = np.bincount(creased.reshape(-1), minlength=len(lifted.points))
    touched = np.unique(flat)
    on_facets = touched[count[touched] == 0]
    on_edges = _between_two(lifted.points, touched[count[touched] == 2], creased)
    return np.union1d(on_facets, on_edges).astype(np.int32)


def _interior_edges(lifted: LiftedTriangles) -> Rows:
    """Return for each interior edge a triangle (apex, start, end) at it, and the other apex."""
    simplices, neighbors = lifted.simplices, lifted.neighbors
    names = np.arange(len(simplices), dtype=np.int32)
    triangle, corner = np.nonzero(neighbors > names[:, None])
    beyond = neighbors[triangle, corner]
    turns = (corner[:, None] + np.arange(3)) % 3
    opposite = (neighbors[beyond] == triangle[:, None]).argmax(axis=1)
    apex = simplices[beyond, opposite]
    return np.column_stack([np.take_along_axis(simplices[triangle], turns, axis=1), apex])


def _are_coplanar(lifted: LiftedTriangles, quads: Rows) -> Mask:
    """Whether the four lifted corners around each edge lie in one plane, exactly."""
    points, values, kind = lifted.points, widened(lifted.kind.values), lifted.kind.name
    signs = np.empty(len(quads), dtype=np.int8)
    for piece in pieces(len(quads)):
        a, b, c, d = (points[rows] for rows in quads[piece].T)
        _kernel.lifted_side(a, b, c, d, values[quads[piece]], kind, signs[piece], canonical=False)
    flat: Mask = signs == 0
    return flat


def _between_two(points: Floats, rows: Rows, creased: Rows) -> Rows:
    """Return the rows with two creased edges that lie on one line with the row between."""
    is_asked = np.zeros(len(points), dtype=np.bool_)
    is_asked[rows] = True
    ends = np.concatenate([creased, creased[:, ::-1]])
    ends = ends[is_asked[ends[:, 0]]]
    both = ends[np.argsort(ends[:, 0], kind="stable")].reshape(-1, 2, 2)
    at, one, other = both[:, 0, 0], both[:, 0, 1], both[:, 1, 1]
    is_between: Mask = orient2d(points[at], points[one], points[other]) == 0
    between: Rows = at[is_between]
    return between
