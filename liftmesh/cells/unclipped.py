"""`Unclipped`: a Voronoi or power diagram in the whole plane, with the names of SciPy."""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Floats, Rows
from liftmesh.base.arrays import read_only
from liftmesh.base.options import counted
from liftmesh.planar.diagram import regions_of, ridges_by_rows

if TYPE_CHECKING:
    from liftmesh.cells.dual import Dual


class Unclipped:
    """A Voronoi or power diagram in the whole plane: the `Cells.unclipped` of cells.

    Vertices, ridges and regions are those of ``scipy.spatial.Voronoi``, and its
    ``voronoi_plot_2d`` draws them; rays begin with -1. If all cells are of sites on one line,
    ridges are lines, of which both ends are -1, and SciPy, which has no such diagrams, cannot draw
    them. The arrays are read-only.

    Parameters
    ----------
    dual : Dual
        The sites.

    Attributes
    ----------
    points : (n, 2) ndarray of float64
        The sites.
    vertices : (v, 2) ndarray of float64
        Where cells meet. Each coordinate is the double nearest to the exact one, or infinite.
    overflowed : int
        How many vertices have a coordinate that is infinite.
    ridge_points : (r, 2) ndarray of int32
        The rows of the two sites between which each ridge lies.
    ridge_ends : (r, 2) ndarray of int32
        The vertices at both ends of each ridge, the lesser first; -1 is at infinity.
    point_region : (n,) ndarray of intp
        The region of each row: duplicates share one, and rows without a cell have -1, which is no
        index of `regions`.
    region_vertices : tuple of ndarray of int32
        The vertices of region i are ``indices[indptr[i]:indptr[i + 1]]``, counter-clockwise; those
        of an unbounded region begin with -1.
    simplices : (m, 3) ndarray of int32
        The triangles that are dual to the vertices.
    simplex_to_vertex : (m,) ndarray of int32
        The vertex of each.
    npoints, ndim, min_bound, max_bound, furthest_site
        As for `Voronoi`.

    Examples
    --------
    >>> import liftmesh
    >>> disks = [[0, 0], [4, 0], [2, 3]]
    >>> whole = liftmesh.power_diagram(disks, radii=[2, 1, 1]).unclipped
    >>> whole.vertices
    array([[2.375     , 1.08333333]])
    >>> whole.ridge_vertices
    [[-1, 0], [-1, 0], [-1, 0]]
    """

    furthest_site = False

    def __init__(self, dual: Dual) -> None:
        self.points, self.vertices = read_only(dual.points), read_only(dual.vertices)
        self.npoints, self.ndim = self.points.shape
        self.min_bound, self.max_bound = self.points.min(axis=0), self.points.max(axis=0)
        self.overflowed = int((~np.isfinite(self.vertices).all(axis=1)).sum())
        self.simplices = read_only(dual.simplices)
        self.simplex_to_vertex = read_only(dual.simplex_to_vertex)
        if len(dual.simplices):
            found = regions_of(
                len(dual.points), dual.simplices, dual.neighbors, dual.simplex_to_vertex
            )
            self.ridge_points = read_only(found.ridge_points)
            self.ridge_ends = read_only(found.ridge_ends)
            region_of, starts, corners = found.region_of, found.starts, found.corners
        else:
            self.ridge_points = read_only(np.stack([dual.chain[:-1], dual.chain[1:]], axis=1))
            self.ridge_ends = read_only(np.full_like(self.ridge_points, -1))
            region_of, starts, corners = _regions_on_line(dual)
        self.region_vertices = read_only(starts), read_only(corners)
        region = region_of.astype(np.intp)
        row, kept = dual.duplicates.T
        region[row] = region[kept]
        self.point_region = read_only(region)

    def __repr__(self) -> str:
        cells = counted(len(self.region_vertices[0]) - 1, "cell")
        return f"<Unclipped: {cells} of {counted(len(self.points), 'row')} in the whole plane>"

    @cached_property
    def ridge_vertices(self) -> list[list[int]]:
        """The vertices at both ends of each ridge as lists; -1 is at infinity."""
        ends: list[list[int]] = self.ridge_ends.tolist()
        return ends

    @cached_property
    def ridge_dict(self) -> dict[tuple[int, int], list[int]]:
        """`ridge_vertices` by the two rows of `ridge_points`."""
        return ridges_by_rows(self.ridge_points, self.ridge_vertices)

    @cached_property
    def regions(self) -> list[list[int]]:
        """The vertices around each region as lists."""
        starts, corners = (part.tolist() for part in self.region_vertices)
        return [corners[start:end] for start, end in pairwise(starts)]

    @cached_property
    def rays(self) -> tuple[NDArray[np.intp], Floats]:
        """The ridges that are rays, (k,) intp, and where these run, (k, 2) float64: not unit.

        A line runs there and in the opposite direction.
        """
        ridges = np.flatnonzero(self.ridge_ends[:, 0] < 0)
        start, end = self.points[self.ridge_points[ridges]].transpose(1, 0, 2) / 2
        x, y = (end - start).T
        return read_only(ridges), read_only(np.stack([y, -x], axis=1))


def _regions_on_line(dual: Dual) -> tuple[Rows, Rows, Rows]:
    """Give each row of a chain a region of one corner at infinity."""
    count = len(dual.chain)
    region_of = np.full(len(dual.points), -1, dtype=np.int32)
    region_of[dual.chain] = np.arange(count, dtype=np.int32)
    return region_of, np.arange(count + 1, dtype=np.int32), np.full(count, -1, dtype=np.int32)
