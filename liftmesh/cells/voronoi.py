"""voronoi() and power_diagram(): cells of planar points inside a domain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liftmesh import _kernel
from liftmesh._typing import Floats, Progress, Rows
from liftmesh.base.arrays import read_only
from liftmesh.base.display import Plotted
from liftmesh.base.frozen import cached_property, check_adjacent, check_copied, check_numbers
from liftmesh.base.options import check_progress, counted, part_of
from liftmesh.cells.domain import Domain, as_domain
from liftmesh.cells.dual import Dual, dual_of, sites_of, values_of
from liftmesh.cells.files import SavableCells
from liftmesh.cells.rings import DomainCorners, Exact, Rings, as_exact, between, resolve_ties
from liftmesh.crs.comparison import crs_of
from liftmesh.errors import InputError
from liftmesh.planar.diagram import regions_of, ridges_by_rows
from liftmesh.planar.kinds import weights_or_radii

_DUAL, _CLIPPED = 0.2, 0.5  # of the progress: of all, and of what follows the triangulation


def voronoi(
    points: object,
    *,
    domain: Any = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Cells:
    """Compute the Voronoi cells of planar points inside a domain.

    The cell of a row is what is nearer to it than to any other row. Which corners and sides it has
    is exact, for every finite double; each coordinate is rounded once.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        Planar points, as for `delaunay`; also one, two, or on a line. Tables need no heights, and
        points of GeoPandas will do.
    domain : (xmin, ymin, xmax, ymax), shapely geometry, (k, 2) array_like or "bounds", optional
        What to clip to: a box; a polygon or multipolygon with holes, of shapely or anything with a
        ``__geo_interface__``, such as a GeoDataFrame, whose polygons are joined; the corners of a
        polygon, in either direction; or the ``domain`` of other cells. By default, and with
        "bounds", the box of the points, widened by a tenth of its longer side on each side. For the
        diagram in the whole plane, with rays, see `Cells.unclipped`.
    threads : int, optional
        Number of threads for the triangulation, as for `delaunay`; the cells are the same for any
        number.
    progress : callable, optional
        As for `delaunay`: it is told the fraction of the work done, and 1.0 at the end.

    Returns
    -------
    Cells
        Of all rows. Of rows at one position the first has the cell.

    Raises
    ------
    InputError
        As for `delaunay`; there are no points; or the domain is invalid: empty, not simple (the
        message names the place), or not finite; or points and domain are in different coordinate
        systems, as far as they say.
    NonFiniteError
        A row is not finite.
    MissingDependencyError
        The domain is a polygon, and shapely is missing.

    See Also
    --------
    power_diagram : Cells of weighted points.
    apollonius_diagram : Cells of disks.
    delaunay : The triangulation that is dual to the cells.
    liftmesh.scipy.Voronoi : Diagrams for code that expects SciPy's.

    Notes
    -----
    The boundary of the domain is followed from cell to cell; all other cells are dual to the
    triangles of `delaunay`. So this takes time in proportion to the points, the edges of the domain
    and the cells that they cross.

    Examples
    --------
    >>> cells = voronoi([[0, 0], [4, 0], [0, 4]], domain=[[0, 0], [4, 0], [4, 4], [0, 4]])
    >>> cells.areas
    array([4., 6., 6.])
    >>> cells.corners[cells.ring_corners[0] : cells.ring_corners[1]]
    array([[0., 2.],
           [0., 0.],
           [2., 0.],
           [2., 2.]])
    """
    return cells_of(points, domain, threads=threads, progress=progress)


def power_diagram(
    points: object,
    *,
    weights: ArrayLike | str | None = None,
    radii: ArrayLike | str | None = None,
    domain: Any = None,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Cells:
    """Compute the power cells of weighted points inside a domain.

    The cell of a row p of weight w is where the power |x - p|^2 - w is less than that of any other
    row. A cell may be empty, and need not hold its own point.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        Planar points, as for `voronoi`.
    weights : (n,) array_like or str, optional
        The weight of each row, positive or not; or the name of such values of the points.
    radii : (n,) array_like or str, optional
        Instead of weights, the radius of a circle around each row: its weight is the square, which
        is never rounded.
    domain : (xmin, ymin, xmax, ymax), shapely geometry, (k, 2) array_like or "bounds", optional
        As for `voronoi`.
    threads, progress
        As for `voronoi`.

    Returns
    -------
    Cells
        Of all rows. Rows in ``hidden`` have no cell anywhere.

    Raises
    ------
    InputError
        As for `voronoi` and `regular`.
    NonFiniteError
        A row, a weight or a radius is not finite.
    MissingDependencyError
        The domain is a polygon, and shapely is missing.

    See Also
    --------
    voronoi : Cells of points without weights.
    apollonius_diagram : Cells of disks, by the distance from their boundary.
    regular : The triangulation that is dual to the cells.
    transport : The weights by which cells have given areas.

    Examples
    --------
    >>> disks = [[0, 0], [3, 0], [1, 0]]
    >>> cells = power_diagram(disks, radii=[2, 1, 0], domain=(-2, -2, 4, 2))
    >>> cells.areas, cells.hidden
    (array([16.,  8.,  0.]), array([2], dtype=int32))
    """
    kind, given = weights_or_radii(weights, radii)
    return cells_of(points, domain, kind, given, threads=threads, progress=progress)


def cells_of(
    points: Any,
    domain: Any,
    kind: str = "plain",
    given: Any = None,
    *,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Cells:
    """Triangulate points and clip their cells."""
    check_progress(progress)
    rows, values = sites_of(points, domain), values_of(points, kind, given)
    dual = dual_of(rows, kind, values, threads, part_of(progress, 0.0, _DUAL))
    inside = as_domain(domain, dual.points, crs_of(points))
    return Cells(dual, inside, part_of(progress, _DUAL, 1.0))


class Cells(SavableCells):
    """Voronoi or power cells inside a domain, as returned by `voronoi` and `power_diagram`.

    Row i has the parts from ``parts[i]`` to ``parts[i + 1]``: none if its cell lies outside the
    domain, and several if the domain cuts it apart. Part j has the rings from ``rings[j]`` to
    ``rings[j + 1]``, of which the first turns counter-clockwise, and the others are holes and turn
    clockwise. Ring k has the corners from ``ring_corners[k]`` to ``ring_corners[k + 1]``. The
    arrays are read-only.

    Which corners there are is exact, and each coordinate is the double nearest to the exact one.

    Parameters
    ----------
    dual : Dual
        The sites.
    domain : Domain
        What the cells are clipped to.
    progress : callable, optional
        As for `voronoi`.

    Attributes
    ----------
    points : (n, 2) ndarray of float64
        The sites.
    domain : Domain
        The domain: its ``corners``, the ``starts`` of its rings, its ``bounds``, and what it is as
        ``text``.
    parts, rings, ring_corners : ndarray of int64
        Where the parts of rows, the rings of parts and the corners of rings start, and the end.
    corners : (k, 2) ndarray of float64
        The corners of all rings.
    beyond : (k,) ndarray of int32
        The row on the other side of the side from each corner to the next; -1 at the boundary of
        the domain.
    duplicates : (d, 2) ndarray of int32
        Rows of the same position and weight as another, each with the first of these, which has
        the cell.
    hidden : (h,) ndarray of int32
        Rows that have no cell anywhere, because others are heavier.
    degenerate : (d,) ndarray of int32
        Rows whose cell has no area anywhere, but is a segment, a ray, a line or a point: what is as
        near to them is as near to others.

    See Also
    --------
    voronoi : Make Voronoi cells.
    power_diagram : Make power cells.
    ApolloniusCells : Cells of disks.

    Examples
    --------
    >>> import liftmesh
    >>> cells = liftmesh.voronoi([[0, 0], [2, 0], [1, 2]], domain=(-1, -1, 3, 3))
    >>> cells
    <Cells: 3 of 3 rows have an area in the box (-1.0, -1.0, 3.0, 3.0)>
    >>> cells.areas
    array([4.5, 4.5, 7. ])
    >>> cells.neighbors
    array([[0, 1],
           [0, 2],
           [1, 2]], dtype=int32)
    """

    def __init__(self, dual: Dual, domain: Domain, progress: Progress | None = None) -> None:
        clipped = clip(dual, domain)
        if progress is not None:
            progress(_CLIPPED)
        super().__init__(dual.points, domain, *clipped)
        self.duplicates, self.hidden = read_only(dual.duplicates), read_only(dual.hidden)
        self.degenerate = read_only(dual.degenerate)
        self._dual, self._simplices = dual, dual.simplices
        if progress is not None:
            progress(1.0)

    def __setstate__(self, state: dict[str, Any]) -> None:
        super().__setstate__(state)
        dual = self._dual
        check_copied(len(self.points), dual.simplices, dual.neighbors, dual.chain)
        check_adjacent(dual.simplices, dual.neighbors)
        check_numbers(0, len(dual.vertices), dual.simplex_to_vertex)

    @cached_property
    def unclipped(self) -> Unclipped:
        """The diagram in the whole plane, with rays, whatever the domain; made at first use."""
        return Unclipped(self._dual)


def clip(dual: Dual, domain: Domain) -> tuple[Rings, ExactCorners]:
    """Clip all cells to a domain."""
    clipped = _kernel.clip(
        dual.points, dual.values, dual.kind, dual.simplices, dual.neighbors,
        dual.simplex_to_vertex, dual.chain, domain.corners, domain.starts,
    )  # fmt: skip
    if clipped is None:
        raise InputError("the rings of the domain cross or overlap: give a valid polygon")
    sources, points, certain, starts, cells, cut, ties = clipped
    vertex_of, k = dual.simplex_to_vertex, len(points)  # corners from k on are vertices
    points = np.concatenate([points, dual.vertices[vertex_of[sources[k:, 1]]]])
    is_vertex = np.flatnonzero(sources[:k, 0] < 0)
    points[is_vertex] = dual.vertices[vertex_of[sources[is_vertex, 1]]]
    rings = Rings(sources, points, starts, cells, cut)
    exact = ExactCorners(domain, dual)
    for i in np.flatnonzero(~certain).tolist():
        ring = int(np.searchsorted(starts, i, side="right")) - 1
        x, y = exact.at(int(cells[ring]), *sources[i, :2].tolist())
        points[i] = float(x), float(y)
    return resolve_ties(rings, exact, ties), exact


@dataclass(frozen=True, slots=True, eq=False)
class ExactCorners(DomainCorners):
    """Corners of clipped Voronoi or power cells."""

    dual: Dual

    def at(self, cell: int, edge: int, other: int) -> Exact:
        """Compute a corner."""
        if edge < 0:
            return self._centre(self.dual.simplices[other].tolist())
        start, end = self.ends(edge)
        return start if other < 0 else self._crossing(start, end, cell, other)

    def _crossing(self, start: Exact, end: Exact, cell: int, other: int) -> Exact:
        a, b, c = self._axis(cell, other)
        first, last = a * start[0] + b * start[1] - c, a * end[0] + b * end[1] - c
        return between(start, end, first / (first - last))

    def _centre(self, rows: Sequence[int]) -> Exact:
        a, b, p = self._axis(rows[0], rows[1])
        c, d, q = self._axis(rows[0], rows[2])
        determinant = a * d - b * c
        return (p * d - b * q) / determinant, (a * q - p * c) / determinant

    def _axis(self, row: int, other: int) -> tuple[Fraction, Fraction, Fraction]:
        """Coefficients a, b, c of the line a x + b y = c of equal power to two rows."""
        (x, y), (u, v) = as_exact(self.dual.points[row]), as_exact(self.dual.points[other])
        height = u * u + v * v - x * x - y * y - self._lowering(other) + self._lowering(row)
        return 2 * (u - x), 2 * (v - y), height

    def _lowering(self, row: int) -> Fraction:
        if self.dual.kind == "plain":
            return Fraction(0)
        value = Fraction(float(self.dual.values[row]))
        return value * value if self.dual.kind == "radii" else value


class Unclipped(Plotted):
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
        As for `scipy.Voronoi`.

    See Also
    --------
    Cells.unclipped : The diagram of cells.
    liftmesh.scipy.Voronoi : Diagrams for code that expects SciPy's.

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
            regions = regions_of(
                len(dual.points), dual.simplices, dual.neighbors, dual.simplex_to_vertex
            )
            self.ridge_points = read_only(regions.ridge_points)
            self.ridge_ends = read_only(regions.ridge_ends)
            region_of, starts, corners = regions.region_of, regions.starts, regions.corners
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
