"""`ApolloniusCells`: cells of disks inside a domain, between polylines."""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Floats, Rows
from liftmesh.arrays import read_only
from liftmesh.cells.clipped import ClippedCells
from liftmesh.cells.clipping import clip
from liftmesh.cells.dual import dual_of
from liftmesh.cells.overlay import overlaid
from liftmesh.cells.parts import binary_scale
from liftmesh.planar.apollonius_cells import Traced, traced

if TYPE_CHECKING:
    from liftmesh.cells.domain import Domain
    from liftmesh.planar.apollonius_graph import ApolloniusGraph

_MARGIN = 0.125  # of the longer side of the domain's box: how far beyond it sides are followed
_OFF = 2.0**-48  # of the largest number: what rounding may put between two distances
_VERTEX, _CROSSING, _CORNER, _OF_ARC = range(4)


class ApolloniusCells(ClippedCells):
    """Cells of disks inside a domain, as returned by `apollonius_diagram`.

    The arrays are those of `Cells`: row i has the parts from ``parts[i]`` to ``parts[i + 1]``, part
    j the rings from ``rings[j]`` to ``rings[j + 1]``, ring k the corners from ``ring_corners[k]``
    to ``ring_corners[k + 1]``; the first ring of a part turns counter-clockwise, and the others are
    holes. They are read-only.

    Sides of cells are arcs of hyperbolas. Here they are polylines, whose points are on the arcs but
    for rounding, and whose chords are at most `tolerance` off. Cells that meet have these points in
    common, bit for bit, and which parts cells have inside the domain is exact for the polylines; so
    cells neither overlap nor leave gaps but for rounding. Areas, centroids and lengths are those of
    the polygons.

    Parameters
    ----------
    graph : ApolloniusGraph
        The disks and their triangles.
    domain : Domain
        What the cells are clipped to.
    tolerance : float
        How far chords may be from the arcs.

    Attributes
    ----------
    graph : ApolloniusGraph
        The graph that is dual to the cells.
    tolerance : float
        How far chords may be from the arcs, in the unit of the coordinates.
    points : (n, 2) ndarray of float64
        The centres.
    domain, parts, rings, ring_corners, corners, beyond
        As of `Cells`.
    duplicates, hidden : ndarray of int32
        Those of the graph: disks equal to one before, each with that, and disks within others.

    Examples
    --------
    >>> import liftmesh
    >>> cells = liftmesh.apollonius_diagram([[-2, 0], [2, 0]], [0, 1], domain=(-4, -3, 4, 3))
    >>> cells
    <ApolloniusCells: 2 of 2 rows have an area in the box (-4.0, -3.0, 4.0, 3.0)>
    >>> cells.areas.round(3), cells.neighbors.tolist()
    (array([20.045, 27.955]), [[0, 1]])
    """

    def __init__(self, graph: ApolloniusGraph, domain: Domain, tolerance: float) -> None:
        self.graph = graph
        self.tolerance: float = tolerance
        self._lines: Traced | None = None
        if len(graph.radii) and (graph.radii == graph.radii[0]).all():
            dual = dual_of(graph.centers)
            self._simplices = dual.simplices
            super().__init__(graph.centers, domain, *clip(dual, domain))
        else:
            self._simplices = graph.simplices
            self._lines = traced(graph, _box_around(domain, tolerance), tolerance)
            default = _nearest(graph, domain)
            super().__init__(graph.centers, domain, *overlaid(self._lines, domain, default))
        self.duplicates, self.hidden = graph.duplicates, graph.hidden

    @property
    def radii(self) -> NDArray[np.float64]:
        """The radii, (n,) float64."""
        return self.graph.radii

    @cached_property
    def corner_kinds(self) -> NDArray[np.uint8]:
        """Where each corner comes from, (k,) uint8.

        0 is a vertex of the diagram, 1 a crossing of an edge of the domain with a side, 2 a corner
        of the domain, 3 another point of an arc.
        """
        edge, other, _ = self._sources.T
        found = np.where(edge < 0, _VERTEX, np.where(other >= 0, _CROSSING, _CORNER))
        found[(edge < 0) & (self._vertex < 0)] = _OF_ARC
        return read_only(found.astype(np.uint8))

    @cached_property
    def corner_sources(self) -> Rows:
        """What each corner is made of, (k, 3) int32.

        A vertex: three disks that are equally near. A crossing: the two disks of the side, and the
        edge of the domain, which has the number of the corner it leaves. A corner of the domain:
        its number, and -1 twice. A point of an arc: the two disks, and -1.
        """
        edge, other, beyond = self._sources.T
        own, kinds = self._cell_of_corner.astype(np.int32), self.corner_kinds
        found = np.stack([edge, other, np.full_like(edge, -1)], axis=1)
        is_vertex, is_crossing, is_arc = (kinds == k for k in (_VERTEX, _CROSSING, _OF_ARC))
        found[is_vertex] = self._simplices[self._vertex[is_vertex]]
        across = other
        if self._lines is not None:
            lines = self._lines
            line = np.searchsorted(lines.starts, other[is_crossing], side="right") - 1
            across = other.copy()
            across[is_crossing] = lines.rows[line].sum(axis=1) - own[is_crossing]
        crossing = own[is_crossing], across[is_crossing], edge[is_crossing]
        found[is_crossing] = np.stack(crossing, axis=1)
        found[is_arc, 0], found[is_arc, 1] = own[is_arc], beyond[is_arc]
        return read_only(found)

    @cached_property
    def _vertex(self) -> Rows:
        """The triangle of each corner that is a vertex; -1 for others."""
        edge, other, _ = self._sources.T
        vertex = np.where(edge < 0, other, -1)
        if self._lines is None:
            return vertex
        of_point = np.full(len(self._lines.points), -1, dtype=np.int32)
        of_point[self._lines.starts[:-1]] = self._lines.ends[:, 0]
        of_point[self._lines.starts[1:] - 1] = self._lines.ends[:, 1]
        vertex[edge < 0] = of_point[other[edge < 0]]
        return vertex


def _box_around(domain: Domain, tolerance: float) -> tuple[float, float, float, float]:
    """Return the box of a domain, wider by more than polylines are off."""
    low, high = domain.corners.min(axis=0), domain.corners.max(axis=0)
    margin = _MARGIN * float((high / 2 - low / 2).max()) * 2 + 2 * tolerance
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
