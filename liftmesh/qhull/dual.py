"""The Voronoi diagram in space as arrays: what is dual to tetrahedra.

The vertex of a tetrahedron is the centre of its sphere. Tetrahedra on one sphere share it: those
that are joined by facets with the neighbour's apex on the sphere. Centres are computed in integers,
and each coordinate is rounded once.

The ridge between two sites that an edge joins is a polygon, whose corners are the vertices of the
tetrahedra around the edge. An edge of the hull has a ridge without end. Between sites on one sphere
edges may be there whose ridges have no area: those are left out.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from liftmesh._typing import Array, Floats, Integers, Mask, Rows
from liftmesh.optional import load
from liftmesh.planar.points import pieces
from liftmesh.predicates import insphere, orient3d
from liftmesh.qhull.certification import determinants, integers_of

if TYPE_CHECKING:
    from liftmesh.space.tetrahedralization import Tetrahedralization

# The places of the ends of an edge, and of the others, in positive order.
_EDGES = [(0, 1, 2, 3), (0, 2, 3, 1), (0, 3, 1, 2), (1, 2, 0, 3), (1, 3, 2, 0), (2, 3, 0, 1)]


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
    first, simplex_to_vertex = np.unique(_on_one_sphere(tetra), return_inverse=True)
    corners = tetra.points.take(tetra.simplices[first], axis=0)
    vertices = np.concatenate([_centers(corners[part]) for part in pieces(len(corners))])
    overflowed = int((~np.isfinite(vertices)).any(axis=1).sum())
    return Centers(vertices, simplex_to_vertex.reshape(-1).astype(np.int32), overflowed)


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
    sparse, graphs = load("scipy.sparse"), load("scipy.sparse.csgraph")
    ends = cell[tied], beyond[tied]
    graph = sparse.coo_array((np.ones(len(ends[0]), np.bool_), ends), [len(simplices)] * 2)
    _, group = graphs.connected_components(graph, directed=False)
    first = np.empty(group.max() + 1, np.int32)
    first[group[::-1]] = np.arange(len(simplices), dtype=np.int32)[::-1]  # the last one stays
    found: Rows = first[group]
    return found


def _centers(corners: Floats) -> Floats:
    """Return the centres of spheres through four points, rounded to the nearest doubles."""
    exact, scale = integers_of(corners.reshape(-1, 3))
    exact = exact.reshape(corners.shape)
    origin = exact[:, 0]
    u, v, w = edges = [(exact[:, k] - origin).T for k in (1, 2, 3)]
    below = 2 * determinants(edges)
    squares = [sum(value * value for value in edge) for edge in edges]
    parts = [
        square * np.array(_cross(one, other))
        for square, one, other in zip(squares, (v, w, u), (w, u, v), strict=True)
    ]
    above = sum(parts) + origin.T * below
    rounded = [_quotient(a, b) for row in above for a, b in zip(row, below * scale, strict=True)]
    centers: Floats = np.array(rounded).reshape(3, -1).T + 0.0  # no -0.0
    return centers


def _cross(u: Array, v: Array) -> list[Array]:
    return [u[k - 2] * v[k - 1] - u[k - 1] * v[k - 2] for k in range(3)]


def _quotient(above: int, below: int) -> float:
    try:
        return above / below  # which Python rounds once
    except OverflowError:
        return math.inf if (above > 0) == (below > 0) else -math.inf


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
    return Solids(ring.ends[has_area].astype(np.int32), starts, held, *_regions(tetra, centers))


def _regions(tetra: Tetrahedralization, centers: Centers) -> tuple[Rows, Rows, Rows]:
    """Return the region of each row, and the vertices of each region."""
    rows, hull = tetra.simplices.reshape(-1), np.unique(tetra.convex_hull)
    vertex = np.concatenate([np.repeat(centers.simplex_to_vertex, 4), np.full(len(hull), -1)])
    width = len(centers.vertices) + 1
    keys = np.unique(np.concatenate([rows, hull]).astype(np.int64) * width + vertex + 1)
    site, corners = keys // width, (keys % width - 1).astype(np.int32)
    starts = np.flatnonzero(np.diff(site, prepend=-1))
    region = np.full(len(tetra.points), -1, np.int32)
    region[site[starts]] = np.arange(len(starts))
    return region, np.append(starts, len(site)).astype(np.int32), corners


class _Rings(NamedTuple):
    """The tetrahedra around each edge, in their order."""

    ends: Integers
    starts: Integers  # of rings among the cells, and the end
    cells: Integers
    is_open: Mask  # edges of the hull
    first: Rows  # the row beside the edge on the facet of the hull before the first cell
    last: Rows  # and behind the last one

    @classmethod
    def around_edges(cls, tetra: Tetrahedralization) -> _Rings:
        """Order the tetrahedra around all edges."""
        simplices, neighbors = tetra.simplices, tetra.neighbors
        sides = [_directed(simplices, places) for places in _EDGES]
        ends, beside, across = (np.concatenate(each) for each in zip(*sides, strict=True))
        cell = np.tile(np.arange(len(simplices), dtype=np.int64), len(_EDGES))
        step = neighbors[cell, across]  # the cell across the facet opposite the first beside
        order = np.lexsort([cell, ends[:, 1], ends[:, 0]])
        ends, beside, cell, step = ends[order], beside[order], cell[order], step[order]
        is_first = np.ones(len(ends), np.bool_)
        is_first[1:] = (ends[1:] != ends[:-1]).any(axis=1)
        edge = np.cumsum(is_first) - 1
        keys = edge * len(simplices) + cell
        follows = np.searchsorted(keys, edge * len(simplices) + step)
        follows[step < 0] = -1
        starts = np.append(np.flatnonzero(is_first), len(ends))
        has_before = np.zeros(len(ends), np.bool_)
        has_before[follows[step >= 0]] = True
        is_open = np.zeros(len(starts) - 1, np.bool_)
        begin = starts[:-1].copy()
        at_hull = np.flatnonzero(~has_before)
        is_open[edge[at_hull]] = True
        begin[edge[at_hull]] = at_hull
        ordered = _followed(begin, follows, starts)
        first, last = beside[ordered[starts[:-1]], 0], beside[ordered[starts[1:] - 1], 1]
        return cls(ends[starts[:-1]], starts, cell[ordered], is_open, first, last)


def _directed(simplices: Rows, places: tuple[int, ...]) -> tuple[Array, Array, Array]:
    """Return edges from the lesser row on, the others in positive order, and which is first."""
    one, other, k, n = places
    tail, head = simplices[:, one], simplices[:, other]
    is_turned = (tail > head)[:, None]
    ends = np.where(is_turned, np.stack([head, tail], 1), np.stack([tail, head], 1))
    beside = np.where(is_turned, simplices[:, [n, k]], simplices[:, [k, n]])
    return ends.astype(np.int64), beside, np.where(is_turned[:, 0], n, k)


def _followed(begin: Integers, follows: Integers, starts: Integers) -> Integers:
    """Return all records ring by ring, each from its beginning on."""
    ordered = np.empty(starts[-1], np.int64)
    ring, at, place = np.arange(len(begin)), begin, 0
    while len(ring):
        ordered[starts[ring] + place] = at
        place += 1
        goes_on = starts[ring + 1] - starts[ring] > place
        ring, at = ring[goes_on], follows[at[goes_on]]
    return ordered


def _is_bent(tetra: Tetrahedralization, ring: _Rings) -> Mask:
    """Whether the two facets of the hull at an edge of it are on two planes."""
    found = np.zeros(len(ring.ends), np.bool_)
    rows = np.column_stack([ring.ends, ring.first, ring.last])[ring.is_open]
    found[ring.is_open] = orient3d(*tetra.points[rows.T]) != 0
    return found
