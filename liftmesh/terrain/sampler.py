"""`Sampler`: heights of a surface, or other values, at points; prepared once for many queries.

Beyond the faces there is none, but for what a caller asks to be there: the value of the nearest
vertex, or that of the nearest place on the hull. Both are of vertices of faces only.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Floats, Mask, Rows
from liftmesh.base.arrays import as_numbers, used_rows
from liftmesh.base.options import Extrapolation, Interpolation, as_threads, check_option
from liftmesh.base.weights import Weights, spread, weights_of
from liftmesh.errors import InputError, Option
from liftmesh.planar.constrained_triangulation import ConstrainedTriangulation
from liftmesh.planar.delaunay import delaunay
from liftmesh.terrain.clough_tocher import CloughTocher
from liftmesh.terrain.hull_places import HullPlaces
from liftmesh.terrain.surface_data import SurfaceData, kernel_surface, places_on
from liftmesh.terrain.values import Values, values_of

if TYPE_CHECKING:
    from liftmesh.planar.triangulation import Triangulation

_TOGETHER = 1 << 18  # points whose weights are held at a time


class Sampler:
    """A surface and how it is asked, checked, as the kernel takes it for each column of values."""

    def __init__(
        self,
        surface: SurfaceData,
        values: Values | None,
        interpolation: Interpolation,
        extrapolate: Extrapolation | None,
        gradients: ArrayLike | None = None,
    ) -> None:
        check_option("interpolation", interpolation, Interpolation)
        if extrapolate is not None:
            check_option("extrapolate", extrapolate, Extrapolation)
        if gradients is not None:
            check_gradients(interpolation)
        if interpolation not in ("linear", "c1"):
            _check_delaunay(surface, "interpolation", interpolation)
        if extrapolate == "nearest":
            _check_delaunay(surface, "extrapolate", extrapolate)
        self._surface, self._extrapolate = surface, extrapolate
        self._has_values = values is not None
        self._slopes: Floats | None = None
        self._interpolation: Interpolation = interpolation
        if values is None:
            self._shape: tuple[int, ...] = ()
            columns = surface.frame.heights(surface.vertices)[None]
        else:
            given = values_of(surface, values)
            self._shape = given.shape[1:]
            columns = given.reshape(len(given), -1).T.copy()  # the caller may write to it
        whole = [kernel_surface(surface, each) for each in columns]
        self._smooth = None
        if interpolation == "c1":
            shape = len(columns[0]), *self._shape
            self._slopes = None if gradients is None else _slopes(gradients, shape)
            self._smooth = CloughTocher(surface, columns, self._slopes)
        self._columns, self._whole = columns, _Columns(surface.triangulation, whole)
        is_lined = isinstance(surface.triangulation, ConstrainedTriangulation)
        self._is_walking = is_lined and interpolation == "nearest"

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle what the kernel's objects are made of."""
        shape = len(self._columns[0]), *self._shape
        values = self._columns.T.reshape(shape) if self._has_values else None
        slopes = None if self._slopes is None else self._slopes.swapaxes(0, 1).reshape(*shape, 2)
        asked = self._interpolation, self._extrapolate, slopes
        return Sampler, (self._surface, values, *asked)

    def at(self, points: ArrayLike, threads: int | None) -> Floats:
        """Interpolate at points, (..., 2)."""
        pairs = places_on(self._surface, points)
        places = pairs.reshape(-1, 2)
        found = np.empty((len(self._columns), len(places)))
        asked = self._without_lines if self._is_walking else self._whole
        if self._smooth is None:
            asked.sample(places, found, self._interpolation, threads)
        else:
            for first in range(0, len(places), _TOGETHER):
                some = slice(first, first + _TOGETHER)
                found[:, some] = self._smooth.at(*asked.faces(places[some], threads))
        if self._is_walking:
            found[:, self._are_beyond(places, threads)] = np.nan
        if self._extrapolate is not None:
            self._put_beyond(places, found, threads)
        shaped: Floats = found.T.reshape(pairs.shape[:-1] + self._shape)
        return shaped[()]

    def weights(self, points: ArrayLike, threads: int | None) -> Weights:
        """Weigh the vertices at points, (..., 2), in their order."""
        places = places_on(self._surface, points).reshape(-1, 2)
        if self._smooth is not None:
            raise InputError(
                f"with {Option('interpolation', 'c1')} a value depends on those of all vertices, "
                "so weights would be no sparse matrix: use interpolator() for many points"
            )
        if self._is_walking:
            within = np.flatnonzero(~self._are_beyond(places, threads))
            weights = self._without_lines.weights(places[within], "nearest", threads)
            found = spread([(within, weights)], len(places))
        else:
            found = self._whole.weights(places, self._interpolation, threads)
        if self._extrapolate is None:
            return found
        has_some = np.diff(found.indptr) > 0
        beyond = np.flatnonzero(~has_some & np.isfinite(places).all(axis=1))
        parts = [(np.arange(len(places)), found), (beyond, self._beyond(places[beyond], threads))]
        return spread(parts, len(places))

    def _put_beyond(self, places: Floats, found: Floats, threads: int | None) -> None:
        """Put in what is wanted where no face contains a point."""
        without = np.flatnonzero(np.isnan(found).all(axis=0) & np.isfinite(places).all(axis=1))
        beyond = without[self._are_beyond(places[without], threads)]
        if len(beyond):
            weights = self._beyond(places[beyond], threads)
            found[:, beyond] = (
                (weights @ self._columns.T).T
                if self._smooth is None
                else self._smooth.at(weights, np.empty(0, np.int32))
            )

    def _beyond(self, places: Floats, threads: int | None) -> Weights:
        """Weigh the vertices for points that no face contains."""
        if self._extrapolate == "nearest":
            return self._of_faces.weights(places, "nearest beyond", threads)
        hull, sides = self._hull
        side, share = sides.nearest(places)
        ends = np.column_stack([hull[side], np.roll(hull, -1)[side]])
        counts = np.column_stack([share < 1, share > 0]) & (side >= 0)[:, None]
        starts = np.concatenate([[0], np.cumsum(counts.sum(axis=1))])
        data = np.column_stack([1 - share, share])[counts]
        return weights_of((starts, ends[counts], data), len(self._columns[0]))

    def _are_beyond(self, places: Floats, threads: int | None) -> Mask:
        """Tell which points no face contains, whatever the values of their corners."""
        heights = np.empty((1, len(places)))
        _Columns(self._surface.triangulation, [self._level]).sample(
            places, heights, "linear", threads
        )
        are_beyond: Mask = np.isnan(heights[0])
        return are_beyond

    @cached_property
    def _level(self) -> _kernel.Relief:
        return kernel_surface(self._surface, np.zeros(len(self._surface.vertices)))

    @cached_property
    def _without_lines(self) -> _Columns:
        return self._anew(self._surface.triangulation.simplices)

    @cached_property
    def _of_faces(self) -> _Columns:
        """What walks to the nearest vertex of a face: those of a carved surface have gaps."""
        solved, faces = self._surface.triangulation, self._surface.faces
        is_lined = isinstance(solved, ConstrainedTriangulation)
        used = [len(used_rows(len(self._columns[0]), each)) for each in (faces, solved.simplices)]
        return self._anew(faces) if is_lined or used[0] < used[1] else self._whole

    @cached_property
    def _hull(self) -> tuple[Rows, HullPlaces]:
        """The convex hull of all vertices of faces."""
        hull = self._whole.solved.convex_hull
        if not np.isin(hull, used_rows(len(self._columns[0]), self._surface.faces)).all():
            hull = self._of_faces.solved.convex_hull
        return hull, HullPlaces(self._surface.triangulation.points[hull])

    def _anew(self, triangles: Rows) -> _Columns:
        """Triangulate the corners of triangles, without lines and gaps."""
        points = self._surface.triangulation.points
        places = np.full_like(points, np.nan)
        used = used_rows(len(places), triangles)
        places[used] = points[used]
        solved = delaunay(places, nonfinite="skip")
        arrays = places, solved.simplices, solved.neighbors
        return _Columns(solved, [_kernel.Relief(*arrays, each, None) for each in self._columns])


class _Columns(NamedTuple):
    """A triangulation with one column of values or several over it."""

    solved: Triangulation
    reliefs: list[_kernel.Relief]

    def sample(self, places: Floats, found: Floats, method: str, threads: int | None) -> None:
        """Fill a row for each column."""
        locator, run = self.solved._locator, as_threads(threads, len(places))  # noqa: SLF001
        for relief, row in zip(self.reliefs, found, strict=True):
            relief.sample(locator, places, row, method, *run)

    def weights(self, places: Floats, method: str, threads: int | None) -> Weights:
        """Weigh the vertices, which does not depend on values."""
        locator, run = self.solved._locator, as_threads(threads, len(places))  # noqa: SLF001
        return weights_of(
            self.reliefs[0].weights(locator, places, method, *run), len(self.solved.points)
        )

    def faces(self, places: Floats, threads: int | None) -> tuple[Weights, Rows]:
        """Return the linear weights, and which triangles contain the points."""
        found = np.empty(len(places), np.int32)
        run = as_threads(threads, len(places))
        self.solved._locator.find(places, found, *run)  # noqa: SLF001
        return self.weights(places, "linear", threads), found


def check_gradients(interpolation: Interpolation) -> None:
    """Raise unless an interpolation takes gradients."""
    if interpolation != "c1":
        raise InputError(
            f"{Option('gradients')} are for {Option('interpolation', 'c1')}, not "
            f"{interpolation!r}: leave them out"
        )


def _slopes(gradients: ArrayLike, shape: tuple[int, ...]) -> Floats:
    """Take gradients of values of a shape, as (k, n, 2)."""
    remedy = "give dz/dx and dz/dy of each value of each vertex"
    given = as_numbers("gradients", gradients, remedy, verb="are")
    if given.shape != (*shape, 2):
        raise InputError(
            f"{Option('gradients')} have the shape {given.shape}, not {(*shape, 2)}: {remedy}"
        )
    slopes: Floats = given.reshape(shape[0], -1, 2).swapaxes(0, 1).copy()
    return slopes


def _check_delaunay(surface: SurfaceData, option: str, given: str) -> None:
    """Raise for an interpolation, or extrapolation, that a triangulation does not have."""
    solved = surface.triangulation
    if solved.metric is not None or hasattr(solved, "hidden"):
        remedy = "'linear'" if option == "interpolation" else "'hull'"
        reason = "has weights, radii or a metric"
    elif isinstance(solved, ConstrainedTriangulation) and given != "nearest":
        reason, remedy = "follows lines or has faces of its own", "'linear' or 'nearest'"
    else:
        return
    raise InputError(
        f"{Option(option)} {given!r} needs a Delaunay triangulation, and the "
        f"surface {reason}: give {Option(option)} {remedy}"
    )
