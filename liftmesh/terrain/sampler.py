"""What the heights of a surface, or values in their place, are at points: prepared once.

Beyond the faces there is none, but for what a caller asks to be there: the value of the nearest
vertex, or that of the nearest place on the hull. Both are of vertices of faces only.
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Floats, Mask, Rows
from liftmesh.base.arrays import as_pairs, used_rows
from liftmesh.base.options import Extrapolation, Interpolation, as_threads, check_option
from liftmesh.errors import InputError, Option
from liftmesh.planar.constrained_triangulation import ConstrainedTriangulation
from liftmesh.planar.delaunay import delaunay
from liftmesh.terrain.hull_places import HullPlaces
from liftmesh.terrain.surface_data import SurfaceData, kernel_surface
from liftmesh.terrain.values import Values, values_of

if TYPE_CHECKING:
    from liftmesh.planar.triangulation import Triangulation


class Sampler:
    """A surface and how it is asked, checked, as the kernel takes it for each column of values."""

    def __init__(
        self,
        surface: SurfaceData,
        values: Values | None,
        interpolation: Interpolation,
        extrapolate: Extrapolation | None,
    ) -> None:
        check_option("interpolation", interpolation, Interpolation)
        if extrapolate is not None:
            check_option("extrapolate", extrapolate, Extrapolation)
        if interpolation != "linear":
            _check_delaunay(surface, "interpolation", interpolation)
        if extrapolate == "nearest":
            _check_delaunay(surface, "extrapolate", extrapolate)
        self._surface, self._extrapolate = surface, extrapolate
        self._interpolation: Interpolation = interpolation
        if values is None:
            self._shape: tuple[int, ...] = ()
            columns = surface.frame.heights(surface.vertices)[None]
        else:
            given = values_of(surface, values)
            self._shape = given.shape[1:]
            columns = given.reshape(len(given), -1).T.copy()  # the caller may write to it
        whole = [kernel_surface(surface, each) for each in columns]
        self._columns, self._whole = columns, _Columns(surface.triangulation, whole)
        is_lined = isinstance(surface.triangulation, ConstrainedTriangulation)
        self._is_walking = is_lined and interpolation == "nearest"

    def at(self, points: ArrayLike, threads: int | None) -> Floats:
        """Interpolate at points, (..., 2)."""
        pairs = as_pairs(points)
        places = pairs.reshape(-1, 2)
        found = np.empty((len(self._columns), len(places)))
        asked = self._without_lines if self._is_walking else self._whole
        asked.sample(places, found, self._interpolation, threads)
        if self._is_walking:
            found[:, self._are_beyond(places, threads)] = np.nan
        if self._extrapolate is not None:
            self._put_beyond(places, found, threads)
        shaped: Floats = found.T.reshape(pairs.shape[:-1] + self._shape)
        return shaped[()]

    def _put_beyond(self, places: Floats, found: Floats, threads: int | None) -> None:
        """Put in what is wanted where no face contains a point."""
        without = np.flatnonzero(np.isnan(found).all(axis=0) & np.isfinite(places).all(axis=1))
        beyond = without[self._are_beyond(places[without], threads)]
        if not len(beyond):
            return
        if self._extrapolate == "nearest":
            others = np.empty((len(found), len(beyond)))
            self._of_faces.sample(places[beyond], others, "nearest beyond", threads)
            found[:, beyond] = others
            return
        hull, sides = self._hull
        side, share = sides.nearest(places[beyond])
        first, second = (self._columns[:, each[side]] for each in (hull, np.roll(hull, -1)))
        with np.errstate(invalid="ignore"):  # infinite ones of both signs have no mean
            between = np.where(share == 1, second, first * (1 - share) + second * share)
        found[:, beyond] = np.where(side < 0, np.nan, np.where(share == 0, first, between))

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
