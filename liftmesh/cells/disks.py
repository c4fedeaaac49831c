"""apollonius_diagram(): cells of disks inside a domain."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats, Progress
from liftmesh.arrays import as_coordinates
from liftmesh.cells.apollonius_cells import ApolloniusCells
from liftmesh.cells.domain import Domain, as_domain
from liftmesh.cells.parts import binary_scale
from liftmesh.cells.sites import sites_of, values_of
from liftmesh.errors import InputError
from liftmesh.planar.apollonius import apollonius, as_disks
from liftmesh.planar.apollonius_graph import as_tolerance
from liftmesh.same_crs import system_of

_FINE = 1e-3  # of the side of a square as large as a cell


def apollonius_diagram(
    centers: ArrayLike,
    radii: ArrayLike | str,
    *,
    domain: Any = None,
    tolerance: float | None = None,
    progress: Progress | None = None,
) -> ApolloniusCells:
    """Compute the cells of disks inside a domain: the additively weighted Voronoi diagram.

    The cell of a disk is what is nearer to it than to any other: by |x - c| - r, the distance from
    its boundary, negative inside. Sides are arcs of hyperbolas, here polylines to a tolerance. With
    equal radii the cells are those of `voronoi`.

    Parameters
    ----------
    centers : array_like of shape (n, 2) or (n, 3)
        The centre of each disk, as the points of `voronoi`. Disks may overlap.
    radii : (n,) array_like or str
        The radius of each disk, not negative, such as the reach of a transmitter; or the name of
        such values of the centres.
    domain : (xmin, ymin, xmax, ymax), shapely geometry or (k, 2) array_like, optional
        As for `voronoi`: by default the box of the centres, widened by a tenth of its longer side.
    tolerance : float, optional
        How far polylines may be from the arcs, in the unit of the coordinates; no more than the
        longer side of the domain's box counts. By default a thousandth of the side of a square that
        has the mean area of a cell.
    progress : callable, optional
        As for `apollonius`, which takes most of the time.

    Returns
    -------
    ApolloniusCells
        Of all rows. Rows in ``hidden`` are within other disks and have no cell.

    Raises
    ------
    InputError
        As for `apollonius`, and of the domain as for `voronoi`; there are no disks; the tolerance
        is not positive or not finite, near the rounding of coordinates, or so small that there are
        too many points to hold; or a cell is thinner than float64 can tell apart there.
    NonFiniteError
        A coordinate or a radius is not finite.
    MissingDependencyError
        The domain is a polygon, and shapely is missing.

    Notes
    -----
    For the graph, see `apollonius`. Seen from a focus, a hyperbola has a simple equation
    (``liftmesh/planar/apollonius_arcs.py``), by which arcs are halved until chords are near enough.
    As every cell is star-shaped about its centre, and stays so for any tolerance, polygons do not
    overlap.

    Examples
    --------
    >>> disks = [[0, 0], [6, 0], [0, 6], [1, 0]]
    >>> cells = apollonius_diagram(disks, [2, 1, 1, 0.5], domain=(-3, -3, 9, 9))
    >>> cells.areas.round(2), cells.hidden
    (array([43.5 , 50.25, 50.25,  0.  ]), array([3], dtype=int32))
    >>> cells.tolerance
    0.006928203230275509
    """
    rows = as_coordinates(sites_of(centers, domain))
    if not len(rows):
        raise InputError("there are no disks: give one at least")
    disks = as_disks(rows[:, :2], values_of(centers, "radii", radii), skippable=False)
    graph = apollonius(disks[:, :2], disks[:, 2], progress=progress)
    area = as_domain(domain, graph.centers, system_of(centers))
    bounds = np.concatenate([area.corners.min(axis=0), area.corners.max(axis=0)])
    if tolerance is None:
        seen = len(graph.radii) - len(graph.hidden) - len(graph.duplicates)
        tolerance = max(_FINE * _side_of_cells(area, seen), _least(bounds))
    return ApolloniusCells(graph, area, as_tolerance(tolerance, bounds))


def _side_of_cells(domain: Domain, count: int) -> float:
    """Return the side of a square that has the mean area of so many cells of a domain."""
    scale = binary_scale(domain.corners)
    corners = np.ldexp(domain.corners, -scale)
    u, v = corners - corners[0], corners[domain.following] - corners[0]
    area = float((u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum() / 2)
    return float(np.ldexp(np.sqrt(area / count), scale))


def _least(bounds: Floats) -> float:
    return float(np.abs(bounds).max()) * 2.0**-45
