"""Contours: lines of equal height over the faces of a surface, with their levels.

The kernel follows each line from face to face (`_core/surface/contours.hpp`). A corner is above a
level if its height is at least the level: with that one rule a line is closed, or ends where the
faces end, wherever corners are at the level themselves.
"""

from __future__ import annotations

import math
import os
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Array, Floats
from liftmesh.base.arrays import as_decimal, as_reals
from liftmesh.base.display import Plotted
from liftmesh.base.frozen import FrozenResult
from liftmesh.base.options import (
    as_count,
    as_number,
    as_thousands,
    as_threads,
    counted,
    refused,
    shown,
)
from liftmesh.crs.units import stated_unit
from liftmesh.errors import DataWarning, InputError, Option
from liftmesh.io.streams import at_home
from liftmesh.terrain.crossings import LevelLines, check_tolerance, smoothed
from liftmesh.terrain.surface_data import SurfaceData, kernel_surface, plane_system
from liftmesh.terrain.values import Values, over_known
from liftmesh.vector.files import check_written, line_shapes, write_lines
from liftmesh.vector.geopackage import frame_of_shapes

if TYPE_CHECKING:
    from liftmesh import _kernel
    from liftmesh.io.write import WriteResult

_MOST_LEVELS = 1_000_000


@dataclass(frozen=True, slots=True, eq=False)
class Contour:
    """One line of `Contours`.

    Attributes
    ----------
    level : float
        Its height.
    points : (k, 2) ndarray of float64
        Its points; what is above is on the left.
    closed : bool
        Whether it is closed: then the last point is the first.
    is_index : bool
        Whether it is an index contour.

    See Also
    --------
    Contours : All lines.
    Surface.contours : Computes them.

    Examples
    --------
    >>> import liftmesh
    >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 8], [0, 4, 0]])
    >>> slope.contours([2])[0].closed
    False
    """

    level: float
    points: Floats
    closed: bool
    is_index: bool


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Contours(FrozenResult, Plotted):
    """Contours of a surface, as `Surface.contours` returns them: a sequence of lines; read-only.

    A slice of them is `Contours`, too.

    Parameters
    ----------
    points : (n, 2) ndarray of float64
        The points of all lines, one after the other, in the plane of the surface. What is above is
        on the left. A closed line has its first point at its end, too.
    starts : (k + 1,) ndarray of int64
        Where each line begins in ``points``, and where the last ends.
    levels : (k,) ndarray of float64
        The level of each line.
    closed : (k,) ndarray of bool
        Whether it is closed.
    is_index : (k,) ndarray of bool
        Whether it is an index contour, which maps draw thicker.
    crs : str, optional
        The coordinate reference system.

    See Also
    --------
    Surface.contours : Computes them.
    Profile : Heights along a line.

    Examples
    --------
    >>> import liftmesh
    >>> hill = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0], [2, 2, 8]])
    >>> lines = hill.contours(interval=4)
    >>> len(lines), lines[0].level, lines[0].points.tolist()
    (1, 4.0, [[1.0, 1.0], [3.0, 1.0], [3.0, 3.0], [1.0, 3.0], [1.0, 1.0]])
    >>> hill.contours(interval=2)[1:].levels
    array([4., 6.])
    """

    points: Floats
    starts: Array
    levels: Floats
    closed: Array
    is_index: Array
    crs: str | None = None

    def __repr__(self) -> str:
        levels = counted(len(np.unique(self.levels)), "level")
        return f"<Contours: {counted(len(self), 'line')} at {levels}{stated_unit(self.crs)}>"

    def __len__(self) -> int:
        return len(self.levels)

    @overload
    def __getitem__(self, number: int) -> Contour: ...
    @overload
    def __getitem__(self, number: slice) -> Contours: ...
    def __getitem__(self, number: int | slice) -> Contour | Contours:
        if isinstance(number, slice):
            return self._selected(np.arange(len(self))[number])
        number = range(len(self))[number]
        points = self.points[self.starts[number] : self.starts[number + 1]]
        level, closed, is_index = self.levels[number], self.closed[number], self.is_index[number]
        return Contour(float(level), points, bool(closed), bool(is_index))

    def __iter__(self) -> Iterator[Contour]:
        return (self[number] for number in range(len(self)))

    @property
    def lengths(self) -> Floats:
        """The length of each line in the plane, (k,) float64."""
        steps = np.zeros(len(self.points))
        if len(steps):
            across = np.diff(self.points, axis=0)
            steps[1:] = np.sqrt(across[:, 0] ** 2 + across[:, 1] ** 2)
            steps[self.starts[:-1]] = 0  # from the line before
            return np.add.reduceat(steps, self.starts[:-1])
        return np.zeros(0)

    def longer_than(self, length: float) -> Contours:
        """Select the lines of at least a length.

        Parameters
        ----------
        length : float
            In the plane.

        Returns
        -------
        Contours
            Those lines, in the same order.

        Raises
        ------
        InputError
            The length is no number, or negative.

        See Also
        --------
        Contours.lengths : The length of each line.

        Examples
        --------
        >>> import liftmesh
        >>> hill = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0], [2, 2, 8]])
        >>> hill.contours(interval=2).longer_than(5).levels
        array([2., 4.])
        """
        return self._selected(np.flatnonzero(self.lengths >= length_of(length)))

    def _selected(self, lines: Array) -> Contours:
        """Return some of the lines, in the order given."""
        counts = np.diff(self.starts)[lines]
        starts = np.concatenate([[0], np.cumsum(counts)])
        places = np.arange(starts[-1]) + np.repeat(self.starts[lines] - starts[:-1], counts)
        return replace(
            self,
            points=self.points[places],
            starts=starts,
            levels=self.levels[lines],
            closed=self.closed[lines],
            is_index=self.is_index[lines],
        )

    def save(self, path: str | os.PathLike[str]) -> WriteResult:
        """Write the lines with height, index and closed as properties.

        Parameters
        ----------
        path : path
            Where to write, as GeoJSON, GeoPackage, shapefile or DXF; written whole or not at all.

        Returns
        -------
        WriteResult
            The file, its format and its size.

        Raises
        ------
        FormatError
            The name does not end in .geojson, .json, .gpkg, .shp or .dxf.
        InputError
            The coordinate system is unknown to GeoPackage or shapefiles.
        MissingDependencyError
            GeoPackage and shapefiles need geopandas: ``pip install 'liftmesh[shapes]'``.
        OSError
            The file cannot be written.

        See Also
        --------
        Profile.save : The same for profiles.

        Notes
        -----
        In GeoJSON the coordinate system stands in the member ``crs``, as GDAL writes and reads it:
        as its number, or as WKT if that does not name one. GeoPackage has a layer "contours". DXF
        has polylines at their heights, in the layers "contours" and "contours-index", and no
        system.

        Examples
        --------
        >>> import liftmesh, tempfile
        >>> hill = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 8]])
        >>> hill.contours(interval=4).save(Path(tempfile.mkdtemp()) / "lines.geojson").format
        'geojson'
        """
        target = Path(at_home(path))
        check_written(target, "contours", may_be_drawing=True)
        return write_lines(target, self.points, self.starts, self._columns(), self.crs, "contours")

    def _columns(self) -> dict[str, Array]:
        return {"height": self.levels, "index": self.is_index, "closed": self.closed}

    def to_geodataframe(self) -> Any:
        """Convert the lines to a table of geopandas, a row each.

        Returns
        -------
        geopandas.GeoDataFrame
            With the columns ``height``, ``index``, ``closed`` and ``geometry``, and the coordinate
            system.

        Raises
        ------
        InputError
            The coordinate system is unknown.
        MissingDependencyError
            geopandas is not installed: ``pip install 'liftmesh[shapes]'``.

        See Also
        --------
        Contours.save : The same in a file.

        Examples
        --------
        >>> import liftmesh
        >>> hill = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 8]])
        >>> hill.contours(interval=4).to_geodataframe().geometry.length.tolist()
        [2.0]
        """
        shapes = line_shapes(self.points, self.starts)
        return frame_of_shapes(shapes, self._columns(), self.crs)


def length_of(length: Any) -> float:
    """Convert the least length that lines are to have."""
    return as_number("length", length, "a number, not below zero", lambda least: least >= 0)


def contour_lines(
    surface: SurfaceData,
    levels: ArrayLike | None = None,
    *,
    values: Values | None = None,
    interval: float | None = None,
    contour_base: float = 0.0,
    index_every: int = 5,
    smooth: float | None = None,
    threads: int | None = None,
) -> Contours:
    """Compute lines of equal height, or of another value.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud.
    levels : array_like of float, optional
        The heights.
    values : str or array_like of shape (n,), optional
        Values of the vertices in place of heights, or the name of attributes. There are no lines
        in faces with a corner whose value is NaN or infinite.
    interval : float, optional
        In place of levels: all multiples of it that the surface has, counted from
        `contour_base`. They are decimal: those of 0.1 are 0.1, 0.2, 0.3.
    contour_base : float, default 0
        Where the interval is counted from.
    index_every : int, default 5
        Every so many multiples of the interval are index contours.
    smooth : float, optional
        By how much heights along a line may differ from its level, so that bends are less sharp:
        less than half of the distance of levels. Lines still do not cross. Their ends stay, and
        points at vertices.
    threads : int, optional
        As for `delaunay`. Threads share the levels.

    Returns
    -------
    Contours
        The lines, by ascending level. They do not depend on the order of the rows.

    Raises
    ------
    InputError
        Neither levels nor interval are given, or both; a number is not finite, or the interval
        or the tolerance not positive, or this too large; there are more than a million levels.

    Warns
    -----
    DataWarning
        One level is given, not in a list, and has no line: an interval may have been meant.

    See Also
    --------
    Surface.profile : Heights along a line.
    Contours.save : Write them to a file.

    Notes
    -----
    A corner at a level is above it. So a plateau at the level has a line around it, a ridge one
    there and back, and a summit none; no line has a point twice in succession.

    Examples
    --------
    >>> import liftmesh
    >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 8], [0, 4, 0]])
    >>> slope.contours([2])[0].points.tolist()
    [[1.0, 3.0], [1.0, 0.0]]
    """
    if values is not None:
        surface = over_known(surface, values)
    limit, relief = as_threads(threads, len(surface.faces)), kernel_surface(surface)
    wanted, is_index = wanted_levels(
        levels, interval, contour_base, index_every, lambda: _heights_of(relief, *limit)
    )
    points, starts, places, closed = relief.contours(wanted, *limit)
    crs = plane_system(surface)
    is_closed = closed.view(np.bool_)
    is_number = levels is not None and np.ndim(levels) == 0
    if is_number and not len(places) and len(surface.faces):
        low, high = relief.height_range(*limit)
        message = (
            f"no face has the height {wanted[0]:g}, they have {low:.6g} to {high:.6g}: for lines"
        )
        message = f"{message} at all multiples, give {Option('interval', ...)}"
        warnings.warn(message, DataWarning, stacklevel=3)
    if smooth is not None:
        check_tolerance(smooth, wanted)
        lines = LevelLines(points, starts, is_closed, places.astype(np.int64))
        points = smoothed(lines, _sides_of(surface), wanted, smooth)
    return Contours(points, starts, wanted[places], is_closed, is_index[places], crs)


def _sides_of(surface: SurfaceData) -> Floats:
    """Return the ends of all sides with their heights, (m, 2, 3)."""
    edges, planar = surface.triangulation.edges, surface.triangulation.points
    heights = surface.frame.heights(surface.vertices)
    ends, rises = planar.take(edges, axis=0), heights.take(edges, axis=0)
    return np.concatenate([ends, rises[..., None]], axis=2) + 0.0


def wanted_levels(
    levels: ArrayLike | None,
    interval: float | None,
    contour_base: float,
    index_every: int,
    heights: Callable[[], tuple[Fraction, Fraction]],  # the least and the greatest
) -> tuple[Floats, Array]:
    """Decide which levels have lines, and which of these are index contours."""
    if (levels is None) == (interval is None):
        raise InputError(f"give either {Option('levels')} or {Option('interval')}")
    if interval is None:
        wanted = _levels("levels", levels)
        return wanted, np.zeros(len(wanted), dtype=np.bool_)
    every = as_count("index_every", index_every, 1)
    return _multiples(heights, interval, contour_base, every)


def _levels(name: str, values: Any) -> Floats:
    """Convert levels to finite numbers, ascending, each once."""
    try:
        heights = np.unique(as_reals(values))
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"{Option(name)} cannot be read as numbers: {shown(values)}") from error
    if heights.ndim != 1 or not np.isfinite(heights).all():
        raise refused(name, values, "give finite heights", verb="are")
    return heights


def _multiples(
    heights: Callable[[], tuple[Fraction, Fraction]],
    interval: float,
    contour_base: float,
    index_every: int,
) -> tuple[Floats, Array]:
    """Return the levels within the heights of a surface, and which of them are index contours."""
    step, start = (
        _decimal(*each) for each in (("interval", interval), ("contour_base", contour_base))
    )
    if step <= 0:
        raise refused("interval", interval, "give a positive height")
    low, high = heights()
    first, last = math.floor((low - start) / step), math.ceil((high - start) / step)
    if last - first > _MOST_LEVELS:
        reason = f"which makes {as_thousands(last - first)} levels: give a larger one"
        raise refused("interval", interval, reason, mark=", ")
    numbers = range(first, last + 1)
    levels = np.array([float(start + step * number) for number in numbers])
    return levels, np.array([number % index_every == 0 for number in numbers])


def _heights_of(relief: _kernel.Relief, threads: int, shared: bool) -> tuple[Fraction, Fraction]:
    """Return the least and the greatest height of a face."""
    low, high = relief.height_range(threads, shared)
    if not (math.isfinite(low) and math.isfinite(high)):
        raise InputError(
            "a height of a face is not finite: the array of the vertices was written since"
        )
    return Fraction(low), Fraction(high)


def _decimal(name: str, value: Any) -> Fraction:
    """Convert a height to the decimal that it is printed as."""
    try:
        return as_decimal(value)
    except (TypeError, ValueError, OverflowError) as error:
        raise refused(name, value, "give a finite height") from error
