"""A surface: all of the caller's rows as vertices, the triangles over them, and an account of both.

Vertices are the rows as they were given, in their order; faces index them. The planar problem that
was solved stands beside them as a `Triangulation`, with the frame that led to it. The methods hand
a surface to other libraries and to files.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, BinaryIO

from liftmesh._typing import Array, Floats, Rows
from liftmesh.cloud import Cloud, constructed_from
from liftmesh.io import files
from liftmesh.io.objects import matplotlib, open3d, trimesh

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    import matplotlib.tri as matplotlib_tri
    import open3d as o3d
    import trimesh as trimesh_package

    from liftmesh.io.files import Written
    from liftmesh.planar.triangulation import Triangulation
    from liftmesh.terrain.frame import Frame


@dataclass(frozen=True, slots=True, eq=False)
class Report:
    """What became of every row of the input: ``rows`` is the sum of the next four counts.

    Parameters
    ----------
    rows : int
        Rows of the input.
    used : int
        Rows that are vertices of faces.
    duplicates : int
        Rows left out because a used row equals them in position and height, as they were given.
    overhangs : int
        Rows left out because a used row has their planar position, at another height.
    skipped : int
        Rows left out because they are not finite.
    triangles : int
        Faces.
    policy : str
        Which row of a shared planar position is used: the option ``duplicates``.
    seconds : mapping of str to float
        Time that each stage took.
    left_out : (k,) ndarray of int32
        The rows in no face, increasing: duplicates, overhangs and skipped ones.
    representatives : (k,) ndarray of int32
        For each row left out, the used row of the same planar position; -1 for skipped ones.

    Examples
    --------
    >>> import liftmesh
    >>> cloud = [[0, 0, 5], [1, 0, 6], [0, 1, 7], [1, 0, 9], [1, 0, 6]]
    >>> report = liftmesh.triangulate(cloud, duplicates="highest").report
    >>> report.rows, report.used, report.duplicates, report.overhangs, report.skipped
    (5, 3, 0, 2, 0)
    >>> report.left_out, report.representatives
    (array([1, 4], dtype=int32), array([3, 3], dtype=int32))
    """

    rows: int
    used: int
    duplicates: int
    overhangs: int
    skipped: int
    triangles: int
    policy: str
    seconds: Mapping[str, float] = field(repr=False)
    left_out: Rows = field(repr=False)
    representatives: Rows = field(repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "seconds", MappingProxyType(dict(self.seconds)))

    def __reduce__(self) -> tuple[Any, ...]:
        return constructed_from(self)

    def __str__(self) -> str:
        stages = ", ".join(f"{stage} {seconds:.3f}" for stage, seconds in self.seconds.items())
        return (
            f"{_count(self.rows, 'row')}, {self.used:,} of them used in "
            f"{_count(self.triangles, 'triangle')}. "
            f"Left out: {self._omissions()}. {sum(self.seconds.values()):.3f} s: {stages}."
        )

    def _omissions(self) -> str:
        parts = []
        if self.duplicates:
            parts.append(_count(self.duplicates, "duplicate"))
        if self.overhangs:
            parts.append(f"{_count(self.overhangs, 'overhang')} (policy {self.policy!r})")
        if self.skipped:
            parts.append(f"{_count(self.skipped, 'row')} not finite")
        return ", ".join(parts) or "none"


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Surface:
    """A triangulated cloud.

    Parameters
    ----------
    vertices : (n, 3) ndarray of float64
        All rows of the input in their order; shared with the caller's array where it was float64.
    faces : (m, 3) ndarray of int32
        Triangles as rows of ``vertices``, counter-clockwise seen from above the plane.
    triangulation : Triangulation
        The planar problem and its solution. Of a shared planar position it keeps the lowest row,
        where ``faces`` may name another: see ``report``.
    frame : Frame
        The plane and its axes.
    report : Report
        What became of every row.
    colors : (n, 3) or (n, 4) ndarray, optional
        Colours of the vertices.
    normals : (n, 3) ndarray, optional
        Normals of the input's rows, as they were given.
    attributes : mapping of str to (n, ...) ndarray
        Further named values of the vertices.
    metadata : mapping
        What belongs to the whole input.
    crs : str, optional
        The coordinate reference system of the input: WKT or ``EPSG:n``.

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

    def __reduce__(self) -> tuple[Any, ...]:
        return constructed_from(self)

    def __repr__(self) -> str:
        triangles = _count(len(self.faces), "triangle")
        return f"<Surface of {triangles} over {len(self.vertices):,} vertices>"

    def to_cloud(self) -> Cloud:
        """Make a cloud with faces.

        Returns
        -------
        Cloud
            The same arrays, without the planar problem and the report.

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
        )

    def to_trimesh(self) -> trimesh_package.Trimesh:
        """Make a trimesh mesh.

        Returns
        -------
        trimesh.Trimesh
            Unprocessed: every vertex in its place, used or not, with 8-bit RGBA colours, normals
            and vertex attributes. Coordinates are copied: edits do not reach the surface.

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
        """Make a legacy Open3D mesh.

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

    def to_open3d_t(self) -> o3d.t.geometry.TriangleMesh:
        """Make a tensor Open3D mesh.

        Returns
        -------
        open3d.t.geometry.TriangleMesh
            Every vertex in its place, positions Float64, indices Int64, with RGB colours from 0 to
            1, normals and named values as vertex attributes.

        Raises
        ------
        InputError
            A colour is outside its range, or an attribute has a type that tensors do not know.
        MissingDependencyError
            Open3D, or a system library it needs, is not installed.

        Examples
        --------
        >>> import liftmesh
        >>> mesh = liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]]).to_open3d_t()
        >>> mesh.triangle["indices"].shape
        SizeVector[1, 3]
        """
        return open3d.to_tensor(self.to_cloud())

    def to_matplotlib(self) -> matplotlib_tri.Triangulation:
        """Make a matplotlib triangulation of the triangles in the plane.

        Returns
        -------
        matplotlib.tri.Triangulation
            Planar coordinates and faces: plot with ``surface.vertices[:, 2]`` or any other values
            of one a vertex.

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
        return matplotlib.to_triangulation(x, y, self.faces)

    def save(self, path: str | os.PathLike[str] | BinaryIO, **options: Any) -> Written:
        """Write the surface to a file.

        Parameters
        ----------
        path : path or binary file
            Where to; the suffix says which format.
        **options
            What `liftmesh.write` takes.

        Returns
        -------
        Written
            What was written, as `liftmesh.write` returns it.

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
        return files.write(path, self, **options)


def _count(number: int, noun: str) -> str:
    return f"{number:,} {noun}" if number == 1 else f"{number:,} {noun}s"
