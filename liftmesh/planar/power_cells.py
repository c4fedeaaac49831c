"""Vertices of a regular triangulation whose power cells have no area.

The cell of a vertex is the set of slopes of the planes that touch the lower hull at its lifted
point. The slopes of the triangles around it are the corners of the cell. Across an edge the slope
changes by a vector perpendicular to the edge, and by nothing if the four lifted corners lie in one
plane. So the cell has an area unless all edges at the vertex with a change lie on one line: then
there are none, or two. Towards the outside slopes grow without bound, so a hull edge always counts.

Each change is the exact sign of four lifted points.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Mask, Rows
from liftmesh.planar.positions import pieces
from liftmesh.predicates import orient2d

if TYPE_CHECKING:
    from liftmesh.planar.regular_triangulation import RegularTriangulation


def rows_without_area(triangulation: RegularTriangulation) -> Rows:
    """Find the vertices whose power cell has area zero."""
    quads = _interior_edges(triangulation)
    is_flat = _are_coplanar(triangulation, quads)
    flat = quads[is_flat][:, 1:3]
    if not len(flat):
        return np.empty(0, dtype=np.int32)
    creased = np.concatenate([quads[~is_flat][:, 1:3], triangulation.convex_hull])
    count = np.bincount(creased.reshape(-1), minlength=triangulation.npoints)
    touched = np.unique(flat)
    on_facets = touched[count[touched] == 0]
    on_edges = _between_two(triangulation, touched[count[touched] == 2], creased)
    return np.union1d(on_facets, on_edges).astype(np.int32)


def _interior_edges(triangulation: RegularTriangulation) -> Rows:
    """Return for each interior edge a triangle (apex, start, end) at it, and the other apex."""
    simplices, neighbors = triangulation.simplices, triangulation.neighbors
    names = np.arange(len(simplices), dtype=np.int32)
    triangle, corner = np.nonzero(neighbors > names[:, None])
    beyond = neighbors[triangle, corner]
    turns = (corner[:, None] + np.arange(3)) % 3
    opposite = (neighbors[beyond] == triangle[:, None]).argmax(axis=1)
    apex = simplices[beyond, opposite]
    return np.column_stack([np.take_along_axis(simplices[triangle], turns, axis=1), apex])


def _are_coplanar(triangulation: RegularTriangulation, quads: Rows) -> Mask:
    """Whether the four lifted corners around each edge lie in one plane, exactly."""
    points = triangulation.points
    kind = "weights" if triangulation.radii is None else "radii"
    values = getattr(triangulation, kind)
    signs = np.empty(len(quads), dtype=np.int8)
    for piece in pieces(len(quads)):
        a, b, c, d = (points[rows] for rows in quads[piece].T)
        _kernel.lifted_side(a, b, c, d, values[quads[piece]], kind, signs[piece], canonical=False)
    flat: Mask = signs == 0
    return flat


def _between_two(triangulation: RegularTriangulation, rows: Rows, creased: Rows) -> Rows:
    """Return the rows with two creased edges that lie on one line with the row between."""
    is_asked = np.zeros(triangulation.npoints, dtype=np.bool_)
    is_asked[rows] = True
    ends = np.concatenate([creased, creased[:, ::-1]])
    ends = ends[is_asked[ends[:, 0]]]
    both = ends[np.argsort(ends[:, 0], kind="stable")].reshape(-1, 2, 2)
    points = triangulation.points
    at, one, other = both[:, 0, 0], both[:, 0, 1], both[:, 1, 1]
    is_between: Mask = orient2d(points[at], points[one], points[other]) == 0
    found: Rows = at[is_between]
    return found
