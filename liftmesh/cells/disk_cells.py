"""apollonius_diagram(): cells of disks inside a domain, between polylines."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liftmesh._typing import Floats, Indices, Progress, Rows
from liftmesh.base.arrays import as_coordinates
from liftmesh.base.frozen import cached_property
from liftmesh.base.options import check_progress, part_of
from liftmesh.cells.clipped import rows_of_corners
from liftmesh.cells.domain import Domain, as_domain
from liftmesh.cells.dual import dual_of, sites_of, values_of
from liftmesh.cells.files import SavableCells
from liftmesh.cells.overlay import overlay_cells
from liftmesh.cells.rings import binary_scale
from liftmesh.cells.voronoi import clip
from liftmesh.crs.comparison import crs_of
from liftmesh.disks.apollonius import ApolloniusGraph, apollonius, as_max_deviation
from liftmesh.disks.graph import as_disks
from liftmesh.disks.sides import Traced, trace_sides
from liftmesh.errors import InputError

_MARGIN = 0.125  # of the longer side of the domain's box: how far beyond it sides are followed
_OFF = 2.0**-48  # of the largest number: what rounding may put between two distances
_FINE = 1e-3  # of the side of a square as large as a cell
_LEAST = 2.0**-45  # of the largest coordinate
_GRAPH, _TRACED = 0.1, 0.6  # of the progress: of all, and of what follows the graph


def apollonius_diagram(
    points: object,
    radii: ArrayLike | str,
    *,
    domain: Any = None,
    max_deviation: float | None = None,
    progress: Progress | None = None,
) -> ApolloniusCells:
    """Compute the cells of disks inside a domain: the additively weighted Voronoi diagram.

    The cell of a disk is what is nearer to it than to any other: by |x - c| - r, the distance from
    its boundary, negative inside. Sides are arcs of hyperbolas, here polylines near
    them. With equal radii the cells are those of `voronoi`.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        The centre of each disk, as for `voronoi`. Disks may overlap.
    radii : (n,) array_like or str
        The radius of each disk, not negative, such as the reach of a transmitter; or the name of
        such values of the points.
    domain : (xmin, ymin, xmax, ymax), shapely geometry, (k, 2) array_like or "bounds", optional
        As for `voronoi`: by default the box of the centres, widened by a tenth of its longer side.
    max_deviation : float, optional
        How far polylines may be from the arcs, in the unit of the coordinates; no more than the
        longer side of the domain's box counts. By default a thousandth of the side of a square that
        has the mean area of a cell.
    progress : callable, optional
        As for `voronoi`.

    Returns
    -------
    ApolloniusCells
        Of all rows. Rows in ``hidden`` are within other disks and have no cell.

    Raises
    ------
    InputError
        As for `apollonius`, and of the domain as for `voronoi`; there are no disks;
        `max_deviation` is not positive or not finite, near the rounding of coordinates, or so small
        that there are too many points to hold; or a cell is thinner than float64 can tell apart
        there.
    NonFiniteError
        A coordinate or a radius is not finite.
    MissingDependencyError
        The domain is a polygon, and shapely is missing.

    See Also
    --------
    apollonius : The graph that is dual to the cells.
    power_diagram : Cells by the power of disks, with straight sides.
    ApolloniusGraph.cell_sides : The sides alone, within any bounds.

    Notes
    -----
    For the graph, see `apollonius`. Seen from a focus, a hyperbola has a simple equation
    (``liftmesh/disks/sides.py``), by which arcs are halved until chords are near enough.
    As every cell is star-shaped about its centre, and stays so however coarse polylines are,
    polygons do not overlap.

    Examples
    --------
    >>> disks = [[0, 0], [6, 0], [0, 6], [1, 0]]
    >>> cells = apollonius_diagram(disks, [2, 1, 1, 0.5], domain=(-3, -3, 9, 9))
    >>> cells.areas.round(2), cells.hidden
    (array([43.5 , 50.25, 50.25,  0.  ]), array([3], dtype=int32))
    >>> cells.max_deviation
    0.006928203230275509
    """
    check_progress(progress)
    rows = as_coordinates(sites_of(points, domain))
    if not len(rows):
        raise InputError("there are no disks: give one at least")
    disks = as_disks(rows[:, :2], values_of(points, "radii", radii), skippable=False)
    graph = apollonius(disks[:, :2], disks[:, 2], progress=part_of(progress, 0.0, _GRAPH))
    area = as_domain(domain, graph.centers, crs_of(points))
    if max_deviation is None:
        seen = len(graph.radii) - len(graph.hidden) - len(graph.duplicates)
        least = float(np.abs(area.bounds).max()) * _LEAST
        max_deviation = max(_FINE * _side_of_cells(area, seen), least)
    limit = as_max_deviation(max_deviation, area.bounds)
    return ApolloniusCells(graph, area, limit, part_of(progress, _GRAPH, 1.0))


def _side_of_cells(domain: Domain, count: int) -> float:
    """Return the side of a square that has the mean area of so many cells of a domain."""
    scale = binary_scale(domain.corners)
    corners = np.ldexp(domain.corners, -scale)
    u, v = corners - corners[0], corners[domain.following] - corners[0]
    area = float((u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum() / 2)
    return float(np.ldexp(np.sqrt(area / count), scale))


class ApolloniusCells(SavableCells):
    """Cells of disks inside a domain, as returned by `apollonius_diagram`.

    The arrays are those of `Cells`: row i has the parts from ``parts[i]`` to ``parts[i + 1]``, part
    j the rings from ``rings[j]`` to ``rings[j + 1]``, ring k the corners from ``ring_corners[k]``
    to ``ring_corners[k + 1]``; the first ring of a part turns counter-clockwise, and the others are
    holes. They are read-only.

    Sides of cells are arcs of hyperbolas. Here they are polylines, whose points are on the arcs but
    for rounding, and whose chords are at most `max_deviation` off. Cells that meet have these
    points in common, bit for bit, and which parts cells have inside the domain is exact for the
    polylines; so cells neither overlap nor leave gaps but for rounding. Areas, centroids and
    lengths are those of the polygons.

    Parameters
    ----------
    graph : ApolloniusGraph
        The disks and their triangles.
    domain : Domain
        What the cells are clipped to.
    max_deviation : float
        How far chords may be from the arcs.
    progress : callable, optional
        As for `voronoi`.

    Attributes
    ----------
    graph : ApolloniusGraph
        The graph that is dual to the cells.
    max_deviation : float
        How far chords may be from the arcs, in the unit of the coordinates.
    points : (n, 2) ndarray of float64
        The centres.
    domain, parts, rings, ring_corners, corners, beyond
        As of `Cells`.
    duplicates, hidden : ndarray of int32
        Those of the graph: disks equal to one before, each with that, and disks within others.

    See Also
    --------
    apollonius_diagram : Make cells of disks.
    Cells : Voronoi and power cells.

    Examples
    --------
    >>> import liftmesh
    >>> cells = liftmesh.apollonius_diagram([[-2, 0], [2, 0]], [0, 1], domain=(-4, -3, 4, 3))
    >>> cells
    <ApolloniusCells: 2 of 2 rows have an area in the box (-4.0, -3.0, 4.0, 3.0)>
    >>> cells.areas.round(3), cells.neighbors.tolist()
    (array([20.045, 27.955]), [[0, 1]])
    """

    def __init__(
        self,
        graph: ApolloniusGraph,
        domain: Domain,
        max_deviation: float,
        progress: Progress | None = None,
    ) -> None:
        self.graph = graph
        self.max_deviation: float = max_deviation
        self._lines: Traced | None = None
        if len(graph.radii) and (graph.radii == graph.radii[0]).all():
            dual = dual_of(graph.centers)
            self._simplices = dual.simplices
            super().__init__(graph.centers, domain, *clip(dual, domain))
        else:
            self._simplices = graph.simplices
            self._lines = trace_sides(graph, _box_around(domain, max_deviation), max_deviation)
            if progress is not None:
                progress(_TRACED)
            default = _nearest(graph, domain)
            super().__init__(graph.centers, domain, *overlay_cells(self._lines, domain, default))
        self.duplicates, self.hidden = graph.duplicates, graph.hidden
        if progress is not None:
            progress(1.0)

    @property
    def radii(self) -> NDArray[np.float64]:
        """The radii, (n,) float64."""
        return self.graph.radii

    def _across(self, corner: Indices) -> Rows:
        other = super()._across(corner)
        if self._lines is None:
            return other
        line = np.searchsorted(self._lines.starts, other, side="right") - 1
        across: Rows = self._lines.rows[line].sum(axis=1) - rows_of_corners(self)[corner]
        return across

    @cached_property
    def _vertex(self) -> Rows:
        vertex = super()._vertex
        if self._lines is None:
            return vertex
        edge, other, _ = self._sources.T
        of_point = np.full(len(self._lines.points), -1, dtype=np.int32)
        of_point[self._lines.starts[:-1]] = self._lines.ends[:, 0]
        of_point[self._lines.starts[1:] - 1] = self._lines.ends[:, 1]
        vertex[edge < 0] = of_point[other[edge < 0]]
        return vertex


def _box_around(domain: Domain, max_deviation: float) -> tuple[float, float, float, float]:
    """Return the box of a domain, wider by more than polylines are off."""
    low, high = np.reshape(domain.bounds, (2, 2))
    margin = _MARGIN * float((high / 2 - low / 2).max()) * 2 + 2 * max_deviation
    left, lower, right, upper = np.concatenate([low - margin, high + margin]).tolist()
    return left, lower, right, upper


def _nearest(graph: ApolloniusGraph, domain: Domain) -> int:
    """Return the disk next to a domain: that of all of it if no side comes near."""
    place = domain.corners[0]
    disks = np.column_stack([graph.centers, graph.radii])
    scale = binary_scale(np.append(disks, place))
    disks, at = np.ldexp(disks, -scale), np.ldexp(place, -scale)
    distance = np.hypot(disks[:, 0] - at[0], disks[:, 1] - at[1]) - disks[:, 2]
    distance[graph.hidden] = distance[graph.duplicates[:, 0]] = np.inf
    near = np.flatnonzero(distance <= distance.min() + _OFF).tolist()
    return int(near[0]) if len(near) == 1 else _nearest_exactly(graph, near, place)


def _nearest_exactly(graph: ApolloniusGraph, rows: list[int], place: Floats) -> int:
    """Return the disk next to a place among some, the first of several."""
    x, y = map(Fraction, place.tolist())
    nearest, square, radius = -1, Fraction(0), Fraction(0)
    for row in rows:
        u, v = map(Fraction, graph.centers[row].tolist())
        own, size = (u - x) ** 2 + (v - y) ** 2, Fraction(float(graph.radii[row]))
        if nearest < 0 or _is_less(own, square, size - radius):
            nearest, square, radius = row, own, size
    return nearest


def _is_less(one: Fraction, other: Fraction, more: Fraction) -> bool:
    """Whether the root of one square is less than that of another and so much more."""
    if more >= 0:
        rest = one - other - more**2
        return rest < 0 or rest**2 < 4 * more**2 * other
    rest = other - one - more**2
    return rest > 0 and rest**2 > 4 * more**2 * one
