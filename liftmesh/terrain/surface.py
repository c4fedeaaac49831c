"""`Surface`: the caller's rows as vertices, with faces and a report on the use of every row.

Vertices are the rows as given, in their order; faces index them. A surface also holds the solved
planar problem as a `Triangulation`, and the frame of the projection. Its methods convert it to
objects of other libraries and write it to files.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, BinaryIO

from numpy.typing import ArrayLike

import liftmesh
from liftmesh._typing import Floats, Progress, Rows
from liftmesh.base.display import Plotted
from liftmesh.base.options import Extrapolation, Interpolation, Pinched, counted
from liftmesh.io import write
from liftmesh.io.objects import open3d, triangulations, trimesh
from liftmesh.terrain import (
    accuracy,
    boundary,
    changes,
    clipping,
    contours,
    filled,
    measures,
    profile,
    rasters,
    refinement,
    sampling,
    stages,
)
from liftmesh.terrain.surface_data import SurfaceData, as_cloud, bounds_of_faces, unit_names

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Mapping, Sequence
    from types import EllipsisType

    import matplotlib.tri as matplotlib_tri
    import open3d as o3d
    import trimesh as trimesh_package
    from typing_extensions import Unpack

    from liftmesh.base.cloud import Cloud
    from liftmesh.base.weights import Weights
    from liftmesh.io.write import WriteResult
    from liftmesh.pages.page import Page
    from liftmesh.planar.certificate import Certificate
    from liftmesh.planar.refined import RefineResult
    from liftmesh.raster.raster import Raster
    from liftmesh.terrain.accuracy import Accuracy
    from liftmesh.terrain.contours import Contours
    from liftmesh.terrain.filled import FilledContours
    from liftmesh.terrain.measures import CutFillResult, VolumeResult
    from liftmesh.terrain.profile import Profile
    from liftmesh.terrain.rasters import RasterOptions
    from liftmesh.terrain.sampling import Interpolator
    from liftmesh.terrain.stages import StageStorage
    from liftmesh.terrain.values import Values


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Surface(SurfaceData, Plotted):
    """A triangulated cloud: one height at each position of a plane. Its arrays are read-only.

    In full: `liftmesh.terrain.surface_data.SurfaceData`.
    """

    def __repr__(self) -> str:
        triangles = counted(len(self.faces), "triangle")
        units = zip(("x and y", "heights"), unit_names(self), strict=True)
        said = "".join(f", {what} in {unit}" for what, unit in units if unit)
        return f"<Surface of {triangles} over {len(self.vertices):,} vertices{said}>"

    def _refined(self, refine: Callable[[Any], RefineResult]) -> RefineResult:
        """Refine the faces, for `liftmesh.refine`."""
        return refinement.refined(self, refine)

    def _deviation(self, before: Surface) -> float:
        """The largest difference of heights from those before, for `RefineResult`."""
        return refinement.deviation(before, self)

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """The smallest rectangle of all faces in the plane: xmin, ymin, xmax, ymax."""
        return bounds_of_faces(self)

    def view(self, path: str | os.PathLike[str] | None = None, **options: Any) -> Page:
        """Make a `Page` that shows the surface, in one file; save it if there is a path.

        In full: `liftmesh.view`.

        Parameters
        ----------
        path, **options : where to save it; as for `liftmesh.view`
        """
        page = liftmesh.view(self, **options)
        if path is not None:
            page.save(path)
        return page

    def replace(
        self,
        *,
        vertices: ArrayLike | EllipsisType = ...,
        colors: ArrayLike | EllipsisType | None = ...,
        normals: ArrayLike | EllipsisType | None = ...,
        attributes: Mapping[str, ArrayLike] | EllipsisType = ...,
        metadata: Mapping[str, Any] | EllipsisType = ...,
        crs: Any = ...,
        color_depth: int | None = None,
    ) -> Surface:
        """Make a changed copy; what is not given stays.

        Returns a Surface that shares with this one what stays.
        In full: `liftmesh.terrain.changes.replaced`.

        Parameters
        ----------
        vertices, colors, normals, attributes, metadata, crs, color_depth : as for `Cloud`
        """
        return changes.replaced(
            self,
            color_depth=color_depth,
            vertices=vertices,
            colors=colors,
            normals=normals,
            attributes=attributes,
            metadata=metadata,
            crs=crs,
        )

    def with_attributes(
        self, attributes: Mapping[str, ArrayLike] | None = None, /, **named: ArrayLike
    ) -> Surface:
        """Make a copy with further named values, or with others of the same names, as `replace`.

        In full: `liftmesh.terrain.changes.with_attributes`.

        Parameters
        ----------
        attributes, **named : (n, ...) array_like, by names; as a mapping if these are no keywords
        """
        return changes.with_attributes(self, attributes, named)

    def sample(
        self,
        points: ArrayLike,
        interpolation: Interpolation = "linear",
        *,
        values: Values | None = None,
        gradients: ArrayLike | None = None,
        extrapolate: Extrapolation | None = None,
        threads: int | None = None,
    ) -> Floats:
        """Interpolate heights, or other values, at points of the plane.

        Returns (...) float64: heights above the plane, NaN where no face contains the point.
        In full: `liftmesh.terrain.sampling.heights_at`.

        Parameters
        ----------
        points, interpolation : (..., 2); {"linear", "nearest", "laplace", "sibson", "c1"}
        values, gradients, extrapolate, threads : array_like or name; of "c1"; {"nearest", "hull"}
        """
        ways: Any = {"values": values, "extrapolate": extrapolate, "threads": threads}
        return sampling.heights_at(self, points, interpolation, gradients=gradients, **ways)

    def weights(
        self,
        points: ArrayLike,
        interpolation: Interpolation = "linear",
        *,
        extrapolate: Extrapolation | None = None,
        threads: int | None = None,
    ) -> Weights:
        """Weigh the vertices at points, for many values: ``weights @ values`` samples them.

        In full: `liftmesh.terrain.sampling.weights_at`.

        Parameters
        ----------
        points, interpolation, extrapolate, threads : as for `sample`
        """
        ways: Any = {"extrapolate": extrapolate, "threads": threads}
        return sampling.weights_at(self, points, interpolation, **ways)

    def interpolator(
        self,
        values: Values | None = None,
        interpolation: Interpolation = "linear",
        *,
        gradients: ArrayLike | None = None,
        extrapolate: Extrapolation | None = None,
    ) -> Interpolator:
        """Make a function of points, with the calls of SciPy's ``LinearNDInterpolator``.

        Returns an Interpolator: call it with points, or with x and y.
        In full: `liftmesh.terrain.sampling.interpolator_of`.

        Parameters
        ----------
        values, interpolation, gradients, extrapolate : as for `sample`
        """
        ways: Any = {"gradients": gradients, "extrapolate": extrapolate}
        return sampling.interpolator_of(self, values, interpolation, **ways)

    def height_above(
        self,
        cloud: object,
        *,
        interpolation: Interpolation = "linear",
        extrapolate: Extrapolation | None = None,
        threads: int | None = None,
    ) -> Floats:
        """Compute how high the points of a cloud are above the faces: NaN where there is none.

        In full: `liftmesh.terrain.sampling.heights_above`.

        Parameters
        ----------
        cloud, interpolation, extrapolate, threads : (n, 3) array_like or path; as for `sample`
        """
        ways: Any = {"extrapolate": extrapolate, "threads": threads}
        return sampling.heights_above(self, cloud, interpolation=interpolation, **ways)

    def accuracy(
        self,
        checkpoints: object = None,
        *,
        interpolation: Interpolation = "linear",
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> Accuracy:
        """Compare heights with checkpoints, or each vertex with the surface of the others.

        Returns an Accuracy: an error for each point, RMSE and what else standards ask for.
        In full: `liftmesh.terrain.accuracy.accuracy_of`.

        Parameters
        ----------
        checkpoints, interpolation, threads, progress : as for `height_above`; None: leave rows out
        """
        ways: Any = {"interpolation": interpolation, "threads": threads, "progress": progress}
        return accuracy.accuracy_of(self, checkpoints, **ways)

    def gradient(self, points: ArrayLike, *, threads: int | None = None) -> Floats:
        """Compute the gradient of the face at points: (..., 2), NaN where no face is.

        In full: `liftmesh.terrain.sampling.gradients_at`.

        Parameters
        ----------
        points, threads : as for `sample`
        """
        return sampling.gradients_at(self, points, threads=threads)

    def slope(
        self, points: ArrayLike, *, z_factor: float | None = None, threads: int | None = None
    ) -> Floats:
        """Compute how steep the face is at points, in degrees: (...), NaN where no face is.

        In full: `liftmesh.terrain.sampling.slopes_at`.

        Parameters
        ----------
        points, z_factor, threads : as for `sample` and `area`
        """
        return sampling.slopes_at(self, points, z_factor=z_factor, threads=threads)

    def aspect(self, points: ArrayLike, *, threads: int | None = None) -> Floats:
        """Compute which way the face descends, in degrees clockwise from y: NaN if it is level.

        In full: `liftmesh.terrain.sampling.aspects_at`.

        Parameters
        ----------
        points, threads : as for `sample`
        """
        return sampling.aspects_at(self, points, threads=threads)

    def profile(self, line: ArrayLike, *, values: Values | None = None) -> Profile:
        """Drape a line over the faces: a Profile, in parts where there are faces.

        In full: `liftmesh.terrain.profile.profile_along`.

        Parameters
        ----------
        line, values : (k, 2) array_like, its corners, two at least; as for `contours`
        """
        return profile.profile_along(self, line, values=values)

    def cross_sections(
        self, line: ArrayLike, *, spacing: float, half_width: float, values: Values | None = None
    ) -> Profile:
        """Drape lines across a line over the faces.

        Returns a Profile with stations; its distances are offsets, negative on the left.
        In full: `liftmesh.terrain.profile.cross_sections`.

        Parameters
        ----------
        line, spacing, half_width, values : as for `profile`; between stations, and to both sides
        """
        ways: Any = {"spacing": spacing, "half_width": half_width, "values": values}
        return profile.cross_sections(self, line, **ways)

    def raster(
        self,
        resolution: float | Sequence[float] | None = None,
        *,
        values: Values | None = None,
        gradients: ArrayLike | None = None,
        **options: Unpack[RasterOptions],
    ) -> Raster:
        """Compute heights, or what follows from them, at the centres of pixels.

        Returns a Raster: values, NaN where no face contains the centre.
        In full: `liftmesh.terrain.rasters.rasterize`.

        Parameters
        ----------
        resolution, values, gradients, **options : size of a pixel; ``bounds``, ``quantity``, ...
        """
        ways: Any = {"values": values, "gradients": gradients}
        return rasters.rasterize(self, resolution, **ways, **options)

    def contours(
        self,
        levels: ArrayLike | None = None,
        *,
        values: Values | None = None,
        interval: float | None = None,
        contour_base: float = 0.0,
        index_every: int = 5,
        smooth: float | None = None,
        threads: int | None = None,
    ) -> Contours:
        """Compute lines of equal height: Contours, by ascending level, what is above on their left.

        In full: `liftmesh.terrain.contours.contour_lines`.

        Parameters
        ----------
        levels, values, interval, contour_base, index_every, smooth, threads : heights or multiples
        """
        return contours.contour_lines(
            self,
            levels,
            values=values,
            interval=interval,
            contour_base=contour_base,
            index_every=index_every,
            smooth=smooth,
            threads=threads,
        )

    def filled_contours(
        self,
        levels: ArrayLike | None = None,
        *,
        values: Values | None = None,
        interval: float | None = None,
        contour_base: float = 0.0,
        threads: int | None = None,
        progress: Progress | None = None,
    ) -> FilledContours:
        """Compute the parts of the plane between levels, as polygons with holes.

        Returns FilledContours: bands by ascending level, valid and without gaps.
        In full: `liftmesh.terrain.filled.filled_contours`.

        Parameters
        ----------
        levels, values, interval, contour_base, threads, progress : as for `contours`, `triangulate`
        """
        ways: Any = {"interval": interval, "contour_base": contour_base, "threads": threads}
        return filled.filled_contours(self, levels, values=values, progress=progress, **ways)

    def area(self, *, planar: bool = False, z_factor: float | None = None) -> float:
        """Compute the area of the faces, in square units of x.

        In full: `liftmesh.terrain.measures.area_of`.

        Parameters
        ----------
        planar, z_factor : measure in the plane; what heights are multiplied by: units decide
        """
        return measures.area_of(self, planar=planar, z_factor=z_factor)

    def volume(self, level: float = 0.0, *, within: object = None) -> VolumeResult:
        """Compute the volumes between the faces and a level: what is above, and what is below.

        In full: `liftmesh.terrain.measures.volume_of`.

        Parameters
        ----------
        level, within : a height above the plane, and polygons to measure in, as for `trim`
        """
        return measures.volume_of(self, level, within=within)

    def volume_by_polygon(
        self, within: object, level: float = 0.0, *, by: str = "name"
    ) -> dict[str | int, VolumeResult]:
        """Compute the volumes between the faces and a level in each of several polygons.

        Returns a dict of name, or number from 0, to VolumeResult.
        In full: `liftmesh.terrain.measures.volumes_by_polygon`.

        Parameters
        ----------
        within, level, by : as for `volume`, and the property or column with names of polygons
        """
        return measures.volumes_by_polygon(self, within, level, by=by)

    def stage_storage(
        self,
        levels: ArrayLike | None = None,
        *,
        interval: float | None = None,
        above: bool = False,
    ) -> StageStorage:
        """Compute the areas and volumes below many levels: a StageStorage, by ascending level.

        In full: `liftmesh.terrain.stages.stage_storage`.

        Parameters
        ----------
        levels, interval, above : as for `contours`; whether to measure above the levels instead
        """
        return stages.stage_storage(self, levels, interval=interval, above=above)

    def cut_and_fill(self, other: Surface, *, within: object = None) -> CutFillResult:
        """Compute the volumes to be cut and filled, where this surface and another have faces.

        In full: `liftmesh.terrain.measures.cut_and_fill`.

        Parameters
        ----------
        other, within : Surface, what this one becomes; polygons to measure in, as for `trim`
        """
        return measures.cut_and_fill(self, other, within=within)

    def cut_and_fill_by_polygon(
        self, other: Surface, within: object, *, by: str = "name"
    ) -> dict[str | int, CutFillResult]:
        """Compute the volumes between this surface and another one in each of several polygons.

        Returns a dict of name, or number from 0, to CutFillResult.
        In full: `liftmesh.terrain.measures.cut_and_fill_by_polygon`.

        Parameters
        ----------
        other, within, by : as for `cut_and_fill` and `volume_by_polygon`
        """
        return measures.cut_and_fill_by_polygon(self, other, within, by=by)

    def solid(
        self,
        base_height: float | None = None,
        *,
        thickness: float | None = None,
        pinched: Pinched = "error",
        longest: float | None = None,
        z_factor: float | None = None,
        base_mm: float | None = None,
        thickness_mm: float | None = None,
    ) -> Cloud:
        """Close the faces by walls and a base: a Cloud, its faces counter-clockwise from outside.

        In full: `liftmesh.terrain.boundary.closed_solid`.

        Parameters
        ----------
        base_height, thickness, pinched, longest, z_factor, base_mm, thickness_mm : float, for print
        """
        return boundary.closed_solid(
            self,
            base_height,
            thickness=thickness,
            pinched=pinched,
            longest=longest,
            z_factor=z_factor,
            base_mm=base_mm,
            thickness_mm=thickness_mm,
        )

    def trim(
        self,
        *,
        max_edge: float | None = None,
        boundary_only: bool = False,
        max_radius: float | None = None,
        polygon: object = None,
    ) -> Surface:
        """Make a copy without some of the faces; vertices and triangulation stay as they are.

        Returns a Surface that shares with this one all but ``faces`` and ``mask``.
        In full: `liftmesh.terrain.boundary.trim`.

        Parameters
        ----------
        max_edge, boundary_only, max_radius, polygon : leave out long sides, large circles, outsides
        """
        return boundary.trim(
            self,
            max_edge=max_edge,
            boundary_only=boundary_only,
            max_radius=max_radius,
            polygon=polygon,
        )

    def compact(self) -> Surface:
        """Make a copy without the vertices that are in no face; the values ``row`` name the others.

        In full: `liftmesh.terrain.changes.compacted`.
        """
        return changes.compacted(self)

    def clip(
        self, polygon: object, *, invert: bool = False, progress: Progress | None = None
    ) -> Surface:
        """Cut the faces along a polygon, and keep what is inside, with the rows in use.

        In full: `liftmesh.terrain.clipping.clip`.

        Parameters
        ----------
        polygon, invert, progress : as for `trim`; whether to keep what is outside instead
        """
        return clipping.clip(self, polygon, invert=invert, progress=progress)

    def boundary(self) -> list[Rows]:
        """Return the boundary of the faces as closed rings of rows, with the faces to the left.

        In full: `liftmesh.terrain.boundary.boundary`.
        """
        return boundary.boundary(self)

    def verify(self, *, threads: int | None = None) -> Certificate:
        """Verify all triangles from scratch, those that `trim` leaves out among them.

        In full: `liftmesh.verify`.

        Parameters
        ----------
        threads : int, optional, as for `delaunay`
        """
        return self.triangulation.verify(threads=threads)

    def to_cloud(self) -> Cloud:
        """Convert the surface to a Cloud: the same arrays, without triangulation and report.

        In full: `liftmesh.terrain.surface_data.as_cloud`.
        """
        return as_cloud(self)

    def to_trimesh(self) -> trimesh_package.Trimesh:
        """Convert the surface to a trimesh.Trimesh, unprocessed, with a copy of the coordinates.

        In full: `liftmesh.io.objects.trimesh.to_mesh`.
        """
        return trimesh.to_mesh(self.to_cloud())

    def to_open3d(self) -> o3d.geometry.TriangleMesh:
        """Convert the surface to an open3d.geometry.TriangleMesh, which has no named values.

        In full: `liftmesh.io.objects.open3d.to_legacy`.
        """
        return open3d.to_legacy(self.to_cloud())

    def to_open3d_t(
        self, *, dtype: object = "float64", origin: ArrayLike | None = None
    ) -> o3d.t.geometry.TriangleMesh:
        """Convert the surface to an open3d.t.geometry.TriangleMesh with the named values.

        In full: `liftmesh.io.objects.open3d.to_tensor`.

        Parameters
        ----------
        dtype, origin : type of positions, and (3,) array_like to subtract before they are rounded
        """
        return open3d.to_tensor(self.to_cloud(), dtype, origin)

    def to_matplotlib(self) -> matplotlib_tri.Triangulation:
        """Convert the planar coordinates and faces to a matplotlib.tri.Triangulation.

        In full: `liftmesh.io.objects.triangulations.to_triangulation`.
        """
        x, y = self.triangulation.points.T
        return triangulations.to_triangulation(x, y, self.faces)

    def save(self, path: str | os.PathLike[str] | BinaryIO, **options: Any) -> WriteResult:
        """Write the surface to a file, and return a WriteResult.

        In full: `liftmesh.write`.

        Parameters
        ----------
        path, **options : where to write, and options of the format, as for `liftmesh.write`
        """
        return write.write(path, self, **options)
