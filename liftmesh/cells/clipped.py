"""`ClippedCells`: what all kinds of clipped cells share: rings as arrays, with their measures."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Array, Floats, Indices, Integers, Rows
from liftmesh.base.arrays import pair_keys, pairs_of_keys, read_only, starts_of_runs
from liftmesh.base.display import Plotted
from liftmesh.base.frozen import cached_property, check_numbers, check_starts
from liftmesh.cells.domain import Domain, following_corners
from liftmesh.cells.rings import DomainCorners, Rings, parts_of
from liftmesh.io.columns import places
from liftmesh.optional import load

_VERTEX, _CROSSING, _CORNER, _OF_ARC = range(4)
_HALF_LARGEST = 2.0**1022  # differences of more may exceed the doubles


class ClippedCells(Plotted):
    """Cells of rows inside a domain: what `Cells` and `ApolloniusCells` share."""

    duplicates: Rows
    hidden: Rows
    _simplices: Rows
    max_deviation: float | None = None

    def __init__(self, points: Floats, domain: Domain, rings: Rings, exact: DomainCorners) -> None:
        self.points, self.domain = read_only(points), domain
        part, is_hole = parts_of(rings, exact)
        order = np.lexsort((is_hole, part))
        count = np.diff(rings.starts)[order]
        starts = np.concatenate([[0], np.cumsum(count)])
        taken = places(rings.starts[:-1][order], count)
        cell_of_part = rings.cells[order][~is_hole[order]]
        self.parts = _starts(cell_of_part, len(self.points))
        self.rings = _starts(part[order], len(cell_of_part))
        self.ring_corners = read_only(starts)
        self.corners = read_only(rings.points[taken])
        self._sources = rings.sources[taken]
        self.beyond = read_only(self._sources[:, 2])

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        groups = len(self.points)
        ends = len(self.rings) - 1, len(self.ring_corners) - 1, len(self.corners)
        each = self.parts, self.rings, self.ring_corners
        for starts, items in zip(each, ends, strict=True):
            check_starts(starts, groups, items)
            groups = items
        check_starts(self.domain.starts, len(self.domain.is_hole), len(self.domain.corners))
        check_numbers(-1, len(self.points), self.beyond, self._sources[:, 2])
        check_numbers(0, len(self.points), self.duplicates, self.hidden, self._simplices)

    def __repr__(self) -> str:
        full = np.count_nonzero(np.diff(self.parts))
        rows = f"{full:,} of {len(self.points):,} rows have an area in {self.domain.text}"
        return f"<{type(self).__name__}: {rows}>"

    def __len__(self) -> int:
        return len(self.points)

    @property
    def crs(self) -> str | None:
        """The coordinate system of the points or the domain, WKT or ``EPSG:n``, if known."""
        return self.domain.crs

    @cached_property
    def corner_kinds(self) -> NDArray[np.uint8]:
        """Where each corner comes from, (k,) uint8.

        0 is a vertex of the diagram, 1 a crossing of an edge of the domain with a side, 2 a corner
        of the domain, 3 another point of an arc between disks.
        """
        edge, other, _ = self._sources.T
        kinds = np.where(edge < 0, _VERTEX, np.where(other >= 0, _CROSSING, _CORNER))
        kinds[(edge < 0) & (self._vertex < 0)] = _OF_ARC
        return read_only(kinds.astype(np.uint8))

    @cached_property
    def corner_sources(self) -> Rows:
        """What each corner is made of, (k, 3) int32; for points and weights it is exact.

        A vertex: three rows that are equally near. A crossing: the two rows of the side, and the
        edge of the domain, which has the number of the corner it leaves. A corner of the domain:
        its number, and -1 twice. A point of an arc: the two rows, and -1.
        """
        edge, _, beyond = self._sources.T
        own, nothing = rows_of_corners(self).astype(np.int32), np.full_like(edge, -1)
        vertex, crossing, arc = (
            np.flatnonzero(self.corner_kinds == kind) for kind in (_VERTEX, _CROSSING, _OF_ARC)
        )
        sources = np.stack([edge, nothing, nothing], axis=1)
        sources[vertex] = self._simplices[self._vertex[vertex]]
        across = self._across(crossing)
        sources[crossing] = np.stack([own[crossing], across, edge[crossing]], axis=1)
        sources[arc, 0], sources[arc, 1] = own[arc], beyond[arc]
        return read_only(sources)

    @property
    def _vertex(self) -> Rows:
        """The triangle of each corner that is a vertex; -1 for others."""
        edge, other, _ = self._sources.T
        return np.where(edge < 0, other, -1)

    def _across(self, corner: Indices) -> Rows:
        """Return the row across the side on which each of some crossings lies."""
        across: Rows = self._sources[corner, 1]
        return across

    @cached_property
    def _moments(self) -> tuple[Floats, Floats, Floats, Rows]:
        """Area, first moments over it, and first corner of each row's cell, scaled by 2**-last."""
        rows, cell = len(self.points), rows_of_corners(self)
        origin = np.zeros((rows, 2))
        origin[cell[::-1]] = self.corners[::-1]
        halved = int(np.abs(self.corners).max(initial=0) > _HALF_LARGEST)
        offset = np.ldexp(self.corners, -halved) - np.ldexp(origin, -halved)[cell]
        extent = np.zeros(rows)
        begins = np.flatnonzero(starts_of_runs(cell[:, None]))
        extent[cell[begins]] = np.maximum.reduceat(np.abs(offset).max(axis=1), begins)
        scale = np.frexp(extent)[1]
        x, y = np.ldexp(offset, -scale[cell, None]).T
        following = following_corners(self.ring_corners)
        ahead_x, ahead_y = x[following], y[following]
        cross = x * ahead_y - y * ahead_x
        area = np.bincount(cell, cross, minlength=rows) / 2
        moments = (np.bincount(cell, cross * (u + v), minlength=rows) / 6
                   for u, v in ((x, ahead_x), (y, ahead_y)))  # fmt: skip
        return area, np.stack([*moments], axis=1), origin, scale + halved

    @cached_property
    def areas(self) -> Floats:
        """The area of each row's cell, (n,) float64; 0 for rows without one.

        Infinite if it exceeds float64.
        """
        area, _, _, scale = self._moments
        with np.errstate(all="ignore"):
            return read_only(np.ldexp(area, 2 * scale))

    @cached_property
    def centroids(self) -> Floats:
        """The centroid of each row's cell, (n, 2) float64; NaN for rows without one."""
        area, moments, origin, scale = self._moments
        with np.errstate(all="ignore"):
            centre = origin + np.ldexp(moments / area[:, None], scale[:, None])
        return read_only(np.where(area[:, None] > 0, centre, np.nan))

    @property
    def sides(self) -> tuple[Floats, Floats]:
        """Start and end of each side, seen from the row of its cell, each (k, 2) float64.

        In the order of the corners.
        """
        start = self.corners - self.points[rows_of_corners(self)]
        return start, start[following_corners(self.ring_corners)]

    @cached_property
    def empty(self) -> Rows:
        """The rows without an area in the domain, (e,) int32, in ascending order.

        These are the hidden, the duplicates, the degenerate, and those whose cell is elsewhere, or
        touches the domain without an area.
        """
        return read_only(np.flatnonzero(np.diff(self.parts) == 0).astype(np.int32))

    @cached_property
    def _sides(self) -> tuple[Rows, Floats]:
        start = np.flatnonzero(self.beyond >= 0)
        pairs = np.stack([rows_of_corners(self)[start], self.beyond[start]], axis=1)
        is_first = pairs[:, 0] < pairs[:, 1]  # each is there twice, once from either cell
        start, pairs = start[is_first], pairs[is_first]
        with np.errstate(over="ignore"):  # a length beyond the doubles is infinite
            end = following_corners(self.ring_corners)[start]
            length = np.hypot(*(self.corners[end] - self.corners[start]).T)
        return sums_by_pair(pairs, length)

    @property
    def neighbors(self) -> Rows:
        """Rows whose cells share a side of positive length in the domain, (k, 2) int32, sorted."""
        return read_only(self._sides[0])

    @property
    def shared_lengths(self) -> Floats:
        """The length of what each of the `neighbors` share, (k,) float64."""
        return read_only(self._sides[1])

    @cached_property
    def not_simple(self) -> Rows:
        """The rows whose cell is no valid polygon once its corners are rounded, int32.

        Corners closer than the doubles there can tell apart may make sides cross, or meet. This
        needs shapely.
        """
        shapely = load("shapely", extra="shapes")
        return read_only(np.flatnonzero(~shapely.is_valid(self.to_shapely())).astype(np.int32))

    def to_shapely(self) -> Array:
        """Return the cells as polygons of shapely.

        Returns
        -------
        (n,) ndarray of shapely.Geometry
            For each row a Polygon, a MultiPolygon if the cell has several parts, or an empty
            Polygon.

        Raises
        ------
        MissingDependencyError
            shapely is missing.

        See Also
        --------
        Cells.to_geodataframe : The polygons in a table.
        Cells.save : The polygons in a file.

        Examples
        --------
        >>> import liftmesh
        >>> cells = liftmesh.voronoi([[0, 0], [2, 0]], domain=(-1, -1, 3, 1))
        >>> [cell.area for cell in cells.to_shapely()]
        [4.0, 4.0]
        """
        shapely = load("shapely", extra="shapes")
        count, starts = np.diff(self.ring_corners), self.ring_corners
        closed = starts + np.arange(len(starts))
        taken = np.arange(closed[-1]) - np.repeat(np.arange(len(count)), count + 1)
        taken[closed[1:] - 1] = starts[:-1]
        rings = self.corners[taken], (closed, self.rings)
        polygons = shapely.from_ragged_array(shapely.GeometryType.POLYGON, *rings)
        parts = np.diff(self.parts)
        shapes = np.full(len(self.points), shapely.Polygon(), dtype=object)
        shapes[parts == 1] = polygons[self.parts[:-1][parts == 1]]
        for row in np.flatnonzero(parts > 1).tolist():
            shapes[row] = shapely.MultiPolygon(
                polygons[self.parts[row] : self.parts[row + 1]].tolist()
            )
        return shapes


def _starts(names: Array, count: int) -> Integers:
    """Return where the items of each of so many names start, in order, and the end."""
    return read_only(np.concatenate([[0], np.cumsum(np.bincount(names, minlength=count))]))


def rows_of_corners(cells: ClippedCells) -> Integers:
    """Return the row of the cell that has each corner."""
    rings = np.repeat(np.arange(len(cells.points)), np.diff(cells.parts))
    corners = np.repeat(rings, np.diff(cells.rings))
    return np.repeat(corners, np.diff(cells.ring_corners))


def sums_by_pair(pairs: Integers, values: Floats) -> tuple[Rows, Floats]:
    """Add up the values of equal pairs of rows; return each pair once, in ascending order."""
    names, place = np.unique(pair_keys(*pairs.T), return_inverse=True)
    rows = np.stack(pairs_of_keys(names), axis=1).astype(np.int32)
    sums: Floats = np.bincount(place.reshape(-1), values, minlength=len(rows)).astype(np.float64)
    return rows, sums
