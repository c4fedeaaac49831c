"""`Surface`: the caller's rows as vertices, with faces and a report on the use of every row.

Vertices are the rows as given, in their order; faces index them. A surface also holds the solved
planar problem as a `Triangulation`, and the frame of the projection. Its methods convert it to
objects of other libraries and write it to files.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, BinaryIO

from numpy.typing import ArrayLike

from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.cloud import Cloud
from liftmesh.base.colors import kept_depth
from liftmesh.base.frozen import constructed_from, freeze
from liftmesh.base.options import counted
from liftmesh.io import write
from liftmesh.io.objects import open3d, triangulations, trimesh
from liftmesh.terrain import changes
from liftmesh.terrain.changes import as_parts
from liftmesh.terrain.contours import Contouring
from liftmesh.terrain.measures import Comparing, Measuring
from liftmesh.terrain.profile import Profiling
from liftmesh.terrain.raster import Rasterizing
from liftmesh.terrain.sampling import Sampling
from liftmesh.terrain.solid import Closing
from liftmesh.terrain.trimming import Trimming

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping
    from types import EllipsisType

    import matplotlib.tri as matplotlib_tri
    import open3d as o3d
    import trimesh as trimesh_package

    from liftmesh.io.write import Written
    from liftmesh.planar.triangulation import Triangulation
    from liftmesh.terrain.frame import Frame
    from liftmesh.terrain.report import Report


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Surface(
    Sampling, Profiling, Rasterizing, Trimming, Contouring, Measuring, Comparing, Closing
):
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

    vertices: Floats
    faces: Rows
    triangulation: Triangulation
    frame: Frame
    report: Report
    colors: Array | None = None
    normals: Array | None = None
    attributes: Mapping[str, Array] = field(default_factory=dict)
    metadata: Mapping[str, Any] = field(default_factory=dict)
    crs: str | None = None
    mask: Array | None = None

    def __post_init__(self) -> None:
        freeze(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return constructed_from(self)

    def __repr__(self) -> str:
        triangles = counted(len(self.faces), "triangle")
        return f"<Surface of {triangles} over {len(self.vertices):,} vertices>"

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
        given = {
            "vertices": vertices,
            "colors": colors,
            "normals": normals,
            "attributes": attributes,
            "metadata": metadata,
            "crs": crs,
            "color_depth": ... if color_depth is None else color_depth,
        }
        return changes.replaced(self, {key: v for key, v in given.items() if v is not ...})

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
        added = as_parts({"attributes": {} if attributes is None else attributes})["attributes"]
        return self.replace(attributes={**self.attributes, **added, **named})

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
        return Cloud(
            points=self.vertices,
            colors=self.colors,
            normals=self.normals,
            attributes=self.attributes,
            faces=self.faces,
            metadata=self.metadata,
            crs=self.crs,
            color_depth=kept_depth(self.colors),
        )

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

    def save(self, path: str | os.PathLike[str] | BinaryIO, **options: Any) -> Written:
        """Write the surface to a file.

        Parameters
        ----------
        path : path or binary file
            Where to write; the suffix determines the format.
        **options
            As for `liftmesh.write`.

        Returns
        -------
        Written
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
