"""The Voronoi diagram in space as arrays: what is dual to tetrahedra.

The vertex of a tetrahedron is the centre of its sphere. Tetrahedra on one sphere share it: those
that are joined by facets with the neighbour's apex on the sphere.

The ridge between two sites that an edge joins is a polygon, whose corners are the vertices of the
tetrahedra around the edge. An edge of the hull has a ridge without end. Between sites on one sphere
edges may be there whose ridges have no area: those are left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Floats, Integers, Mask, Rows
from liftmesh.optional import load
from liftmesh.planar.points import pieces
from liftmesh.predicates import insphere, orient3d

if TYPE_CHECKING:
    from liftmesh.space.tetrahedralization import Tetrahedralization


class Centers(NamedTuple):
    """The vertices of a diagram."""

    vertices: Floats  # each coordinate is the double nearest to the exact one, or infinite
    simplex_to_vertex: Rows
    overflowed: int  # how many vertices have an infinite coordinate


@dataclass(frozen=True, slots=True, eq=False)
class Solids:
    """The ridges and regions of a diagram."""

    ridge_points: Rows  # both sites, the lesser row first
    ridge_starts: Integers  # of ridges among their corners, and the end
    ridge_corners: Rows  # counter-clockwise seen from the second site; -1 first without end
    region_of: Rows  # of each row, or -1; in the order of the rows
    starts: Rows  # of regions among the corners, and the end
    corners: Rows  # vertices, ascending; -1 first without end


def centers_of(tetra: Tetrahedralization) -> Centers:
    """Compute the vertices that are dual to tetrahedra."""
    first = _on_one_sphere(tetra)
    is_first = first == np.arange(len(first))
    number = np.cumsum(is_first, dtype=np.int32) - np.int32(1)
    vertices = np.empty((np.count_nonzero(is_first), 3))
    _kernel.circumcentres(np.ascontiguousarray(tetra.points), tetra.simplices[is_first], vertices)
    overflowed = int((~np.isfinite(vertices)).any(axis=1).sum())
    return Centers(vertices, number[first], overflowed)


def _on_one_sphere(tetra: Tetrahedralization) -> Rows:
    """Return for each tetrahedron the first that shares its sphere."""
    points, simplices, neighbors = tetra.points, tetra.simplices, tetra.neighbors
    cell, place = np.nonzero(neighbors > np.arange(len(simplices))[:, None])
    beyond = neighbors[cell, place]
    apex = simplices[beyond, (neighbors[beyond] == cell[:, None]).argmax(axis=1)]
    five = np.column_stack([simplices[cell], apex]).T
    tied = np.zeros(len(cell), np.bool_)
    for part in pieces(len(cell)):
        tied[part] = insphere(*points[five[:, part]]) == 0
    sparse = load("scipy.sparse", extra="scipy")
    graphs = load("scipy.sparse.csgraph", extra="scipy")
    ends = cell[tied], beyond[tied]
    graph = sparse.coo_array((np.ones(len(ends[0]), np.bool_), ends), [len(simplices)] * 2)
    _, group = graphs.connected_components(graph, directed=False)
    first = np.empty(group.max() + 1, np.int32)
    first[group[::-1]] = np.arange(len(simplices), dtype=np.int32)[::-1]  # the last one stays
    found: Rows = first[group]
    return found


def solids_of(tetra: Tetrahedralization, centers: Centers) -> Solids:
    """Find what lies between the vertices of a diagram."""
    ring = _Rings.around_edges(tetra)
    corners = centers.simplex_to_vertex[ring.cells]
    before = np.roll(corners, 1)
    before[ring.starts[:-1]] = np.where(ring.is_open, -2, corners[ring.starts[1:] - 1])
    is_kept = corners != before
    group = np.repeat(np.arange(len(ring.ends)), np.diff(ring.starts))
    counts = np.bincount(group[is_kept], minlength=len(ring.ends))
    has_area = np.where(ring.is_open, (counts > 1) | _is_bent(tetra, ring), counts > 2)
    is_kept &= has_area[group]
    sizes = (counts + ring.is_open)[has_area]
    starts = np.concatenate([[0], np.cumsum(sizes)])
    held = np.full(starts[-1], -1, np.int32)
    is_corner = np.ones(len(held), np.bool_)
    is_corner[starts[:-1][ring.is_open[has_area]]] = False
    held[is_corner] = corners[is_kept]
    return Solids(ring.ends[has_area], starts, held, *_regions(tetra, centers))


def _regions(tetra: Tetrahedralization, centers: Centers) -> tuple[Rows, Rows, Rows]:
    """Return the region of each row, and the vertices of each region."""
    rows, hull = tetra.simplices.reshape(-1), np.unique(tetra.convex_hull)
    vertex = np.concatenate([np.repeat(centers.simplex_to_vertex, 4), np.full(len(hull), -1)])
    width = len(centers.vertices) + 1
    keys = np.sort(np.concatenate([rows, hull]).astype(np.int64) * width + vertex + 1)
    keys = keys[np.diff(keys, prepend=-1) > 0]
    site, corners = keys // width, (keys % width - 1).astype(np.int32)
    starts = np.flatnonzero(np.diff(site, prepend=-1))
    region = np.full(len(tetra.points), -1, np.int32)
    region[site[starts]] = np.arange(len(starts))
    return region, np.append(starts, len(site)).astype(np.int32), corners


class _Rings(NamedTuple):
    """The tetrahedra around each edge, in their order."""

    ends: Rows
    starts: Integers  # of rings among the cells, and the end
    cells: Rows
    is_open: Mask  # edges of the hull
    beside: Rows  # on the facets of the hull before the first cell and behind the last

    @classmethod
    def around_edges(cls, tetra: Tetrahedralization) -> _Rings:
        """Order the tetrahedra around all edges."""
        rows, starts, is_open, cells = _kernel.edge_rings(tetra.simplices, tetra.neighbors)
        return cls(rows[:, :2], starts, cells, is_open.view(np.bool_), rows[:, 2:])


def _is_bent(tetra: Tetrahedralization, ring: _Rings) -> Mask:
    """Whether the two facets of the hull at an edge of it are on two planes."""
    found = np.zeros(len(ring.ends), np.bool_)
    rows = np.column_stack([ring.ends, ring.beside])[ring.is_open]
    found[ring.is_open] = orient3d(*tetra.points[rows.T]) != 0
    return found
