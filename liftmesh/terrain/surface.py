"""`Surface`: the caller's rows as vertices, with faces and a report on the use of every row.

Vertices are the rows as given, in their order; faces index them. A surface also holds the solved
planar problem as a `Triangulation`, and the frame of the projection. Its methods convert it to
objects of other libraries and write it to files.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, BinaryIO

from numpy.typing import ArrayLike

from liftmesh._typing import Floats, Rows
from liftmesh.base.options import Interpolation, Pinched, counted
from liftmesh.io import write
from liftmesh.io.objects import open3d, triangulations, trimesh
from liftmesh.terrain import boundary, changes, contours, measures, profile, sampling
from liftmesh.terrain.surface_data import SurfaceData, as_cloud

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping, Sequence
    from types import EllipsisType

    import matplotlib.tri as matplotlib_tri
    import open3d as o3d
    import trimesh as trimesh_package
    from typing_extensions import Unpack

    from liftmesh.base.cloud import Cloud
    from liftmesh.io.write import WriteResult
    from liftmesh.planar.certificate import Certificate
    from liftmesh.raster.raster import Raster
    from liftmesh.terrain.contours import Contours
    from liftmesh.terrain.measures import CutFillResult, VolumeResult
    from liftmesh.terrain.profile import Profile
    from liftmesh.terrain.sampling import RasterOptions


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Surface(SurfaceData):
    """A triangulated cloud, whose arrays are read-only: `replace` makes a changed copy.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float64
        All rows of the input in their order: a view of the caller's array if that is float64, which
        writes to that array change.
    faces : (m, 3) ndarray of int32
        Triangles as rows of ``vertices``, counter-clockwise seen from above the plane.
    triangulation : Triangulation
        The planar problem and its solution. Its ``simplices`` are the faces, unless some are left
        out: at a shared planar position it has the row that ``report`` names, whose height is the
        surface's.
    frame : Frame
        The projection plane and its axes.
    report : Report
        Summary of the use of every row.
    colors : (n, 3) or (n, 4) ndarray, optional
        Colours of the vertices.
    normals : (n, 3) ndarray, optional
        Normals of the input's rows, unchanged.
    attributes : mapping of str to (n, ...) ndarray
        Further named values of the vertices.
    metadata : mapping
        Information about the input as a whole.
    crs : str, optional
        The coordinate reference system of the input: WKT or ``EPSG:n``.
    mask : (t,) ndarray of bool, optional
        True for the triangles of ``triangulation`` that are no faces, as `trim` leaves them out;
        None if all are.

    Examples
    --------
    >>> import liftmesh
    >>> liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7], [1, 1, 8]])
    <Surface of 2 triangles over 4 vertices>
    """

    def __repr__(self) -> str:
        triangles = counted(len(self.faces), "triangle")
        return f"<Surface of {triangles} over {len(self.vertices):,} vertices>"

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """The smallest rectangle of all faces in the plane: xmin, ymin, xmax, ymax."""
        return sampling.bounds_of_faces(self)

    def replace(
        self,
        *,
        vertices: ArrayLike | EllipsisType = ...,
        colors: ArrayLike | EllipsisType | None = ...,
        normals: ArrayLike | EllipsisType | None = ...,
        attributes: Mapping[str, ArrayLike] | EllipsisType = ...,
        metadata: Mapping[str, Any] | EllipsisType = ...,
        crs: str | EllipsisType | None = ...,
        color_depth: int | None = None,
    ) -> Surface:
        """Make a changed copy; what is not given stays.

        Parameters
        ----------
        vertices : (n, 3) array_like, optional
            Moved vertices, one for each row. Faces, frame and report stay; if the planar
            coordinates change, as those of shifted or scaled points do, the triangles must be
            the canonical ones of the new coordinates too, which is verified exactly. Weights,
            radii and a metric stay as they are.
        colors : (n, 3) or (n, 4) array_like, or None, optional
            New colours; None removes them.
        normals : (n, 3) array_like or None, optional
            New normals; None removes them.
        attributes : mapping of str to (n, ...) array_like, optional
            The named values, in place of the present ones; `with_attributes` adds to them. Those
            by which the surface was triangulated may be left out, but not changed: a file without
            them can be verified only if they are given to `verify`. What says which rows are
            ``hidden`` is not changed either.
        metadata : mapping, optional
            Information about the surface as a whole.
        crs : str or None, optional
            The coordinate reference system.
        color_depth : int, optional
            Bits per channel that integer colours mean; by default new values decide, see `Cloud`.

        Returns
        -------
        Surface
            Shares the arrays that stay with this surface, and those given with the caller.

        Raises
        ------
        InputError
            An array does not have one row per vertex, the moved vertices have another
            triangulation: triangulate them; or weights or radii are other ones.

        Examples
        --------
        >>> import liftmesh
        >>> surface = liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]])
        >>> raised = surface.vertices * (1, 1, 10)
        >>> surface.replace(vertices=raised).vertices[:, 2], surface.vertices[:, 2]
        (array([50., 60., 70.]), array([5., 6., 7.]))
        """
        return changes.replaced(
            self,
            color_depth,
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
        """Make a copy with further named values, or with others of the same names.

        Parameters
        ----------
        attributes : mapping of str to (n, ...) array_like, optional
            Values by name, for names that are no keywords.
        **named : (n, ...) array_like
            Values by name, one for each vertex.

        Returns
        -------
        Surface
            As from `replace`.

        Raises
        ------
        InputError
            An array does not have one row per vertex.

        Examples
        --------
        >>> import liftmesh
        >>> surface = liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]])
        >>> surface.with_attributes(depth=-surface.vertices[:, 2]).attributes["depth"]
        array([-5., -6., -7.])
        """
        return changes.with_attributes(self, attributes, named)

    def sample(
        self,
        points: ArrayLike,
        interpolation: Interpolation = "linear",
        *,
        threads: int | None = None,
    ) -> Floats:
        """Interpolate heights at points of the plane.

        Parameters
        ----------
        points : array_like of shape (..., 2)
            Coordinates in the plane of the surface: x and y, unless it was triangulated on another.
        interpolation : {"linear", "nearest", "laplace", "sibson"}, default "linear"
            Linear in each face; the height of the nearest vertex, of several the lexicographically
            least; or, smooth but for the vertices, from natural neighbours: by the lengths of the
            sides that Voronoi cells would share ("laplace"), or by the areas that a cell would take
            from others ("sibson"). At a vertex the height is the vertex's own; on an edge, linear,
            and on the hull by all but the nearest, it comes from the two ends.
        threads : int, optional
            As for `delaunay`.

        Returns
        -------
        (...) ndarray of float64
            Heights above the plane; NaN where no face contains the point, and for points that are
            not finite. The same bits for any order of the rows and of the points.

        Raises
        ------
        InputError
            The last axis is not of length two, an option is unknown, or another interpolation
            than "linear" is asked of a surface with weights, radii or a metric.

        Notes
        -----
        A linear height is never beyond those of the corners of its face. In faces that fill less
        than a thousandth of their bounding box the weights come from exact determinants.

        Which vertices are natural neighbours is decided exactly; vertices of faces that are left
        out are among them. Weights are right to 1e-12 of the largest. By them a point takes time
        for each of its neighbours: many, near the centre of a circle of vertices. The nearest
        vertex takes longer where many vertices are about as near, as in the middle of a circle.
        Slopes and aspects are those of faces, whatever the interpolation.

        Examples
        --------
        >>> import liftmesh
        >>> surface = liftmesh.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 1]])
        >>> surface.sample([[1, 1], [2, 2], [0, 4], [3, 3]])
        array([ 5.,  5.,  1., nan])
        """
        return sampling.heights_at(self, points, interpolation, threads=threads)

    def gradient(self, points: ArrayLike, *, threads: int | None = None) -> Floats:
        """Compute the gradient of the face at points of the plane.

        Parameters
        ----------
        points : array_like of shape (..., 2)
            As for `sample`.
        threads : int, optional
            As for `delaunay`.

        Returns
        -------
        (..., 2) ndarray of float64
            dz/dx and dz/dy, in heights per length; NaN where no face contains the point. On an edge
            or at a vertex they are those of one face: the first counter-clockwise, from the
            direction just above that of x on.

        Raises
        ------
        InputError
            As for `sample`.

        Examples
        --------
        >>> import liftmesh
        >>> surface = liftmesh.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 1]])
        >>> surface.gradient([1, 1])
        array([ 1., -1.])
        """
        return sampling.gradients_at(self, points, threads=threads)

    def slope(
        self, points: ArrayLike, *, z_factor: float | None = None, threads: int | None = None
    ) -> Floats:
        """Compute how steep the face is at points of the plane.

        Parameters
        ----------
        points : array_like of shape (..., 2)
            As for `sample`.
        z_factor : float, optional
            What heights are multiplied by; by default what gives them the unit of x and y, if the
            coordinate system says the units of all three.
        threads : int, optional
            As for `delaunay`.

        Returns
        -------
        (...) ndarray of float64
            Degrees from the plane, 0 to 90; NaN where no face contains the point. On edges as
            `gradient`.

        Raises
        ------
        InputError
            As for `sample`, the factor is not positive, or x and y are degrees and it is not given.

        Examples
        --------
        >>> import liftmesh
        >>> surface = liftmesh.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 5]])
        >>> surface.slope([1, 1]).round(9)
        np.float64(45.0)
        """
        return sampling.slopes_at(self, points, z_factor=z_factor, threads=threads)

    def aspect(self, points: ArrayLike, *, threads: int | None = None) -> Floats:
        """Compute which way the face descends at points of the plane.

        Parameters
        ----------
        points : array_like of shape (..., 2)
            As for `sample`.
        threads : int, optional
            As for `delaunay`.

        Returns
        -------
        (...) ndarray of float64
            Degrees clockwise from the direction of y, which is north on maps, from 0 up to 360; NaN
            on level faces and where no face contains the point. On edges as `gradient`.

        Raises
        ------
        InputError
            As for `sample`, or x and y are degrees.

        Examples
        --------
        >>> import liftmesh
        >>> surface = liftmesh.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 5]])
        >>> surface.aspect([1, 1])  # down to the west
        np.float64(270.0)
        """
        return sampling.aspects_at(self, points, threads=threads)

    def profile(self, line: ArrayLike) -> Profile:
        """Drape a line over the faces.

        Parameters
        ----------
        line : (k, 2) array_like
            Its corners in the plane, two at least.

        Returns
        -------
        Profile
            Linear between its points, as the faces are.

        Raises
        ------
        InputError
            There are fewer than two corners, or one is not finite; or the line is longer than the
            largest double.

        Notes
        -----
        The line is halved, again and again, and each half looks only at the faces that are near the
        one that it is of. So a piece takes time for the faces near it; one piece across the whole
        surface, for all of them. Corners are draped by `sample`. No bit depends on the order of the
        rows.

        Examples
        --------
        >>> import liftmesh
        >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 8], [0, 4, 0]])
        >>> slope.profile([[-1, 1], [2, 1], [2, 9]]).points.tolist()
        [[0.0, 1.0, 0.0], [2.0, 1.0, 4.0], [2.0, 2.0, 4.0]]
        """
        return profile.profile_along(self, line)

    def raster(
        self,
        resolution: float | Sequence[float] | None = None,
        **options: Unpack[RasterOptions],
    ) -> Raster:
        """Compute heights, or what follows from them, at the centres of pixels.

        Parameters
        ----------
        resolution : float or pair of float, optional
            Width and height of a pixel. The edges of pixels are multiples of it, so that rasters of
            neighbouring surfaces fit together; row 0 is the one with the largest y.
        **options
            What else is asked for:

            - ``bounds``: xmin, ymin, xmax and ymax to cover; by default those of the faces.
            - ``transform`` and ``shape``, in place of the resolution: a, b, c, d, e and f of a
              `Raster`, any affine transform, as that of another raster; rows and columns.
            - ``quantity``: "height", above the plane; or what the face that owns the centre has:
              "slope" or "aspect", in degrees as of `Surface.slope` and `Surface.aspect`, or
              "hillshade", brightness from 0 to 255.
            - ``interpolation``: of heights, as for `Surface.sample`.
            - ``light``, default (315, 45): azimuth of the light, in degrees clockwise from the
              direction of y, and altitude above the plane, for "hillshade".
            - ``z_factor``: as for `Surface.slope`; other than 1, it exaggerates shades.
            - ``dtype``: "float64", or "float32"; heights are rounded once.
            - ``threads``: as for `delaunay`.

        Returns
        -------
        Raster
            The values; NaN where no face contains the centre of a pixel.

        Raises
        ------
        InputError
            An option is unknown, or what is given does not determine a raster.

        Notes
        -----
        Pixels near the distance of doubles (0.1 at 1e15) may end one too early: subtract an offset.

        Examples
        --------
        >>> import liftmesh
        >>> surface = liftmesh.triangulate([[0, 0, 0], [4, 0, 8], [0, 4, 0], [4, 4, 8]])
        >>> surface.raster(2).values
        array([[2., 6.],
               [2., 6.]])
        >>> surface.raster((4, 2), quantity="aspect").values.ravel()
        array([270., 270.])
        """
        return sampling.rasterize(self, resolution, **options)

    def contours(
        self,
        levels: ArrayLike | None = None,
        *,
        interval: float | None = None,
        contour_base: float = 0.0,
        index_every: int = 5,
        threads: int | None = None,
    ) -> Contours:
        """Compute lines of equal height.

        Parameters
        ----------
        levels : array_like of float, optional
            The heights.
        interval : float, optional
            In place of levels: all multiples of it that the surface has, counted from
            `contour_base`. They are decimal: those of 0.1 are 0.1, 0.2, 0.3.
        contour_base : float, default 0
            Where the interval is counted from.
        index_every : int, default 5
            Every so many multiples of the interval are index contours.
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
            not positive; there are more than a million levels.

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
        return contours.contour_lines(
            self,
            levels,
            interval=interval,
            contour_base=contour_base,
            index_every=index_every,
            threads=threads,
        )

    def area(self, *, planar: bool = False, z_factor: float | None = None) -> float:
        """Compute the area of the faces.

        Parameters
        ----------
        planar : bool, default False
            Measure their projections to the plane instead.
        z_factor : float, optional
            As for `slope`.

        Returns
        -------
        float
            In square units of x, which y shares.

        Raises
        ------
        InputError
            The area is beyond the largest double, the factor is not positive, or `planar` is
            neither True nor False.

        Examples
        --------
        >>> import liftmesh
        >>> roof = liftmesh.triangulate([[0, 0, 0], [3, 0, 4], [0, 2, 0], [3, 2, 4]])
        >>> roof.area(), roof.area(planar=True)
        (10.0, 6.0)
        """
        return measures.area_of(self, planar=planar, z_factor=z_factor)

    def volume(self, level: float = 0.0, *, within: object = None) -> VolumeResult:
        """Compute the volumes between the faces and a level.

        Parameters
        ----------
        level : float, default 0
            A height above the plane.
        within : object, optional
            As for `cut_and_fill`.

        Returns
        -------
        VolumeResult
            What is above the level, and what is below; only where there are faces.

        Raises
        ------
        InputError
            The level is no finite number, or a volume is beyond the largest double; or the polygon
            is invalid, or has no area in common with the faces.
        FormatError
            A file of a polygon is invalid.
        MissingDependencyError
            shapely is not installed.
        OSError
            A file of a polygon cannot be opened.

        Examples
        --------
        >>> import liftmesh
        >>> hill = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0], [2, 2, 6]])
        >>> hill.volume().above, hill.volume(3).above
        (32.0, 4.0)
        """
        return measures.volume_of(self, level, within=within)

    def volume_by_polygon(
        self, within: object, level: float = 0.0, *, by: str = "name"
    ) -> dict[str | int, VolumeResult]:
        """Compute the volumes between the faces and a level in each of several polygons.

        Parameters
        ----------
        within : object
            As for `cut_and_fill_by_polygon`.
        level : float, default 0
            A height above the plane.
        by : str, default "name"
            As for `cut_and_fill_by_polygon`.

        Returns
        -------
        dict of str or int to VolumeResult
            As from `volume`, for each polygon; zeros where it has no area in common with the faces.

        Raises
        ------
        InputError
            As for `volume`, or two polygons have one name, or none has the property.
        FormatError, MissingDependencyError, OSError
            As for `volume`.

        Examples
        --------
        >>> import liftmesh
        >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 4], [0, 4, 0], [4, 4, 4]])
        >>> found = slope.volume_by_polygon([[1, 1], [3, 1], [3, 3], [1, 3]])
        >>> round(found[0].above, 9)
        8.0
        """
        return measures.volumes_by_polygon(self, within, level, by=by)

    def cut_and_fill(self, other: Surface, *, within: object = None) -> CutFillResult:
        """Compute the volumes between this surface and another one.

        Parameters
        ----------
        other : Surface
            What this one becomes, over the same plane. The surfaces need not have the same points,
            nor cover the same area.
        within : object, optional
            Measure inside of it alone, cut at its border: as for `trim`, and valid. Of several,
            what they cover together; it needs ``pip install 'liftmesh[shapes]'``.

        Returns
        -------
        CutFillResult
            What is to be cut, and to be filled; only where both have faces.

        Raises
        ------
        InputError
            The surfaces are over different planes or in different coordinate systems, have no area
            in common, or are one of ground and one of a file without any, of which all rows were
            read; the polygon is invalid; or a volume is beyond the largest double.
        FormatError
            A file of a polygon is invalid.
        MissingDependencyError
            shapely is not installed.
        OSError
            A file of a polygon cannot be opened.

        Notes
        -----
        Which faces overlap, and how, is decided exactly. Volumes have an error of at most 1e-12 of
        the area times the largest distance of the surfaces; only where all that they have in common
        is below 1e-16 of the squares of the sides of its faces may it be larger.
        Where both surfaces are exchanged, so are cut and fill, to the bit; neither the order of the
        points changes a bit, nor a shift or a power of two that rounds no coordinate.

        A polygon that reaches beyond the hull of either surface is cut there, and its new corners
        are rounded to doubles. That error comes on top, and a shift changes bits: at an offset of
        4.5e5 it is about 1e-10 of an area of some units. Subtract the offset where this matters.

        Examples
        --------
        >>> import liftmesh
        >>> flat = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0]])
        >>> hill = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0], [2, 2, 6]])
        >>> round(flat.cut_and_fill(hill).fill, 9), round(hill.cut_and_fill(flat).cut, 9)
        (32.0, 32.0)
        """
        return measures.cut_and_fill(self, other, within=within)

    def cut_and_fill_by_polygon(
        self, other: Surface, within: object, *, by: str = "name"
    ) -> dict[str | int, CutFillResult]:
        """Compute the volumes between this surface and another one in each of several polygons.

        Parameters
        ----------
        other : Surface
            As for `cut_and_fill`.
        within : object
            As for `cut_and_fill`. Each feature of GeoJSON and each row of a table is measured by
            itself, whatever others cover.
        by : str, default "name"
            The property or column that has the names of polygons.

        Returns
        -------
        dict of str or int to CutFillResult
            By the property or column `by` where it is a text, or any number if it is not ``name``,
            as text; else by the number of the polygon, from 0; zeros for a polygon that has no area
            in common with the faces.

        Raises
        ------
        InputError
            The surfaces are over different planes or in different coordinate systems, a polygon is
            invalid, two have one name, none has the property, or a volume is beyond the largest
            double.
        FormatError, MissingDependencyError, OSError
            As for `cut_and_fill`.

        Examples
        --------
        >>> import liftmesh
        >>> flat = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0]])
        >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 4], [0, 4, 0], [4, 4, 4]])
        >>> lot = {"type": "Polygon", "coordinates": [[[0, 0], [2, 0], [2, 2], [0, 2]]]}
        >>> lots = [{"type": "Feature", "properties": {"name": "A 7"}, "geometry": lot}]
        >>> found = flat.cut_and_fill_by_polygon(
        ...     slope, {"type": "FeatureCollection", "features": lots}
        ... )
        >>> round(found["A 7"].fill, 9)
        4.0
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
    ) -> Cloud:
        """Close the faces by walls and a base.

        Parameters
        ----------
        base_height : float, optional
            The height of a flat base, below all faces; they may touch it in single corners.
        thickness : float, optional
            In place of it: the base is the surface itself, lower by so much.
        pinched : {"error", "trim"}, default "error"
            Where faces touch in a vertex only, which no solid can: refuse, or leave out all faces
            at such vertices.
        longest : float, optional
            Scale the solid to this length in x or y, whichever is longer, in millimetres to print
            it, and move it: it begins at 0 in all directions. Without it, it stays in its place.
        z_factor : float, optional
            With ``longest``: what heights are multiplied by before, as for `slope`.

        Returns
        -------
        Cloud
            A closed mesh: the rows of the faces, then those of the base. Faces are
            counter-clockwise from outside. Colours and named values are not part of it.

        Raises
        ------
        InputError
            There is not either `base_height` or `thickness`, a number is none that it can be, the
            surface reaches its base, or faces touch in a vertex only.

        Examples
        --------
        >>> import liftmesh
        >>> hill = liftmesh.triangulate([[0, 0, 1], [4, 0, 1], [0, 4, 1], [4, 4, 1], [2, 2, 4]])
        >>> block = hill.solid(base_height=0)
        >>> block.points.shape, block.faces.shape
        ((9, 3), (14, 3))
        """
        return boundary.closed_solid(
            self,
            base_height,
            thickness=thickness,
            pinched=pinched,
            longest=longest,
            z_factor=z_factor,
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

        Parameters
        ----------
        max_edge : float, optional
            Leave out faces with a side that is longer in the plane.
        boundary_only : bool, default False
            Leave out only those that such a side connects with the outside: faces whose long side
            is on the boundary, then those whose long side has become part of it, and so on. Gaps
            inside stay closed.
        max_radius : float, optional
            Leave out faces whose circumcircle has a larger radius: what is left is the alpha shape
            of the points for this alpha.
        polygon : object, optional
            Leave out faces whose centroid is outside: a polygon with holes, or several, which may
            overlap, as GeoJSON (a dict or a file), a GeoPackage or a shapefile, any object with
            ``__geo_interface__`` as those of shapely, or an array of shape (k, 2). Coordinates are
            those of the plane.

        Returns
        -------
        Surface
            Shares everything with this one but ``faces`` and ``mask``. Faces that were left out
            before stay so.

        Raises
        ------
        InputError
            A length is not positive, the polygon is none or known to be in another coordinate
            system, nothing is asked for, or no face is left.
        FormatError
            A file of a polygon is invalid.
        MissingDependencyError
            Polygons of a shapefile that have several rings need shapely.
        OSError
            It cannot be opened.

        Examples
        --------
        >>> import liftmesh
        >>> points = [[0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1], [9, 2, 1]]
        >>> surface = liftmesh.triangulate(points)
        >>> surface.trim(max_edge=2), surface.trim(max_radius=1).mask.tolist()
        (<Surface of 2 triangles over 5 vertices>, [False, False, True, True])
        """
        return boundary.trim(
            self,
            max_edge=max_edge,
            boundary_only=boundary_only,
            max_radius=max_radius,
            polygon=polygon,
        )

    def boundary(self) -> list[Rows]:
        """Return the boundary of the faces as closed rings.

        Returns
        -------
        list of (k,) ndarray of int32
            Rows of the vertices, the first not repeated. Faces are to the left: outer rings turn
            counter-clockwise, those around gaps clockwise. No ring visits a vertex twice; two may
            share some. Each begins at its lexicographically least vertex, and they are in the order
            of these.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.triangulate([[0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1]]).boundary()
        [array([0, 1, 3, 2], dtype=int32)]
        """
        return boundary.boundary(self)

    def verify(self, *, threads: int | None = None) -> Certificate:
        """Verify the triangulation from scratch, as `Triangulation.verify`.

        Parameters
        ----------
        threads : int, optional
            As for `delaunay`.

        Returns
        -------
        Certificate
            Of all triangles, those that `trim` leaves out among them.

        Raises
        ------
        InputError
            `threads` is not a valid number.

        Examples
        --------
        >>> import liftmesh
        >>> bool(liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]]).verify())
        True
        """
        return self.triangulation.verify(threads=threads)

    def to_cloud(self) -> Cloud:
        """Convert the surface to a cloud with faces.

        Returns
        -------
        Cloud
            The same arrays, without the triangulation and the report.

        Examples
        --------
        >>> import liftmesh
        >>> surface = liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]])
        >>> surface.to_cloud().faces.shape
        (1, 3)
        """
        return as_cloud(self)

    def to_trimesh(self) -> trimesh_package.Trimesh:
        """Convert the surface to a trimesh mesh.

        Returns
        -------
        trimesh.Trimesh
            Unprocessed: every vertex in its place, used or not, with 8-bit RGBA colours, normals
            and vertex attributes. Coordinates are copied: edits do not affect the surface.

        Raises
        ------
        InputError
            A colour is outside its range.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]]).to_trimesh().faces.shape
        (1, 3)
        """
        return trimesh.to_mesh(self.to_cloud())

    def to_open3d(self) -> o3d.geometry.TriangleMesh:
        """Convert the surface to a legacy Open3D mesh.

        Returns
        -------
        open3d.geometry.TriangleMesh
            Every vertex in its place, with RGB colours from 0 to 1 and normals. Legacy meshes have
            no named values: `to_open3d_t` keeps them.

        Raises
        ------
        InputError
            A colour is outside its range.
        MissingDependencyError
            Open3D, or a system library it needs, is not installed.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]]).to_open3d()
        TriangleMesh with 3 points and 1 triangles.
        """
        return open3d.to_legacy(self.to_cloud())

    def to_open3d_t(
        self, *, dtype: object = "float64", origin: ArrayLike | None = None
    ) -> o3d.t.geometry.TriangleMesh:
        """Convert the surface to a tensor Open3D mesh.

        Parameters
        ----------
        dtype : {"float64", "float32"}, or a type of NumPy or Open3D
            Of positions and normals. ``RaycastingScene`` needs Float32.
        origin : (3,) array_like, optional
            Subtracted from the positions before they are rounded; add it to what Open3D returns.

        Returns
        -------
        open3d.t.geometry.TriangleMesh
            Every vertex in its place, indices Int64, with RGB colours from 0 to 1, normals and
            named values as vertex attributes.

        Raises
        ------
        InputError
            A colour is outside its range, an attribute has a type that tensors do not support, or
            Float32 would move a vertex by more than a millionth of the surface's size: the message
            gives the origin to subtract.
        MissingDependencyError
            Open3D, or a system library it needs, is not installed.

        Examples
        --------
        >>> import liftmesh
        >>> mesh = liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]]).to_open3d_t()
        >>> mesh.triangle["indices"].shape
        SizeVector[1, 3]
        """
        return open3d.to_tensor(self.to_cloud(), dtype, origin)

    def to_matplotlib(self) -> matplotlib_tri.Triangulation:
        """Convert the planar triangles to a matplotlib triangulation.

        Returns
        -------
        matplotlib.tri.Triangulation
            Planar coordinates and faces, for plots of ``surface.vertices[:, 2]`` or of any array
            of one value per vertex. Give matplotlib's cubic interpolator a copy of the values: it
            writes to them if there are rows in no face.

        Raises
        ------
        MissingDependencyError
            matplotlib is not installed.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]]).to_matplotlib().x
        array([0., 1., 0.])
        """
        x, y = self.triangulation.points.T
        return triangulations.to_triangulation(x, y, self.faces)

    def save(self, path: str | os.PathLike[str] | BinaryIO, **options: Any) -> WriteResult:
        """Write the surface to a file.

        Parameters
        ----------
        path : path or binary file
            Where to write; the suffix determines the format.
        **options
            As for `liftmesh.write`.

        Returns
        -------
        WriteResult
            Summary of what was written, as returned by `liftmesh.write`.

        Raises
        ------
        FormatError
            The format or an option is unknown, or the format cannot hold the surface.
        OSError
            The file cannot be written.

        Examples
        --------
        >>> import io, liftmesh
        >>> file = io.BytesIO()
        >>> surface = liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]])
        >>> written = surface.save(file, format="ply")
        >>> file.getvalue()[:3]
        b'ply'
        """
        return write.write(path, self, **options)
