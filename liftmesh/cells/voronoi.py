"""voronoi() and power_diagram(): cells of planar points inside a domain."""

from __future__ import annotations

from typing import Any

from numpy.typing import ArrayLike

from liftmesh.cells.cells import Cells
from liftmesh.cells.domain import as_domain
from liftmesh.cells.dual import dual_of
from liftmesh.cells.sites import sites_of, values_of
from liftmesh.crs.comparison import system_of
from liftmesh.planar.weights import chosen


def voronoi(points: ArrayLike, *, domain: Any = None) -> Cells:
    """Compute the Voronoi cells of planar points inside a domain.

    The cell of a row is what is nearer to it than to any other row. Which corners and sides it has
    is exact, for every finite double; each coordinate is rounded once.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        Planar points, as for `delaunay`; also one, two, or on a line. Tables need no heights, and
        points of GeoPandas will do.
    domain : (xmin, ymin, xmax, ymax), shapely geometry or (k, 2) array_like, optional
        What to clip to: a box; a polygon or multipolygon with holes, of shapely or anything with a
        ``__geo_interface__``, such as a GeoDataFrame, whose polygons are joined; the corners of a
        polygon, in either direction; or the ``domain`` of other cells. By default the box of the
        points, widened by a tenth of its longer side on each side. For the diagram in the whole
        plane, with rays, see `Cells.unclipped`.

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
    dual = dual_of(sites_of(points, domain))
    return Cells(dual, as_domain(domain, dual.points, system_of(points)))


def power_diagram(
    points: ArrayLike,
    *,
    weights: ArrayLike | str | None = None,
    radii: ArrayLike | str | None = None,
    domain: Any = None,
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
    domain : (xmin, ymin, xmax, ymax), shapely geometry or (k, 2) array_like, optional
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

    Examples
    --------
    >>> disks = [[0, 0], [3, 0], [1, 0]]
    >>> cells = power_diagram(disks, radii=[2, 1, 0], domain=(-2, -2, 4, 2))
    >>> cells.areas, cells.hidden
    (array([16.,  8.,  0.]), array([2], dtype=int32))
    """
    kind, given = chosen(weights, radii)
    dual = dual_of(sites_of(points, domain), kind, values_of(points, kind, given))
    return Cells(dual, as_domain(domain, dual.points, system_of(points)))
