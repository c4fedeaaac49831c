"""Exact triangulations, terrain and files of liftmesh for PyVista, as ``dataset.liftmesh``.

>>> import numpy as np, pyvista
>>> dataset = pyvista.PolyData(np.random.default_rng(0).random((1000, 3)))
>>> dataset.liftmesh.delaunay_2d().n_points
1000

PyVista (0.48 or newer) finds all of this by itself in an environment that has liftmesh: neither
needs to be imported for the other, and nothing of PyVista is replaced. ``pyvista.read`` and
``dataset.save`` know the formats that PyVista lacks, such as ``.landxml``, ``.las`` and ``.npz``.
PLY is PyVista's own, in single precision and without values: ``force_ext=".liftmesh-ply"`` reads,
and ``dataset.liftmesh.save("mesh.ply")`` writes every bit of both. Who wants that for all PLY says
so: ``pyvista.register_reader(".ply", liftmesh.plugins.pyvista.read, override=True)``.

What differs from PyVista's ``delaunay_2d`` and ``delaunay_3d``:

- Triangles are exact, of cocircular points the same ones on every machine, and each of them faces
  the side that the normal of the plane points to. They fill the convex hull, where PyVista lacks
  flat ones at the rim unless ``offset`` is large.
- ``tol`` is 0 by default: only points at one position are merged, where PyVista leaves out those
  that are near to others.
- Edges of ``edge_source`` are always there. Those that cross, and points on a line or with a
  coordinate that is not finite, are errors that name them; PyVista warns, or returns nothing.
- ``offset`` and ``bound`` change nothing: there is no bounding triangulation.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Array, Floats, Progress, Rows
from liftmesh.base.arrays import as_rows3, check_finite, pair_keys
from liftmesh.base.options import (
    Extrapolation,
    Interpolation,
    as_distance,
    as_switch,
    counted,
    refused,
)
from liftmesh.cells.voronoi import Cells, voronoi
from liftmesh.errors import InputError, Option
from liftmesh.io import read as reading, write as writing
from liftmesh.io.objects.pyvista import (
    corners_of,
    edges_of_lines,
    faces_of,
    library,
    to_cloud,
    to_pyvista,
)
from liftmesh.io.registry import as_cloud
from liftmesh.planar.alpha import in_space, radii_of
from liftmesh.planar.constrained import constrained_delaunay
from liftmesh.planar.constraints import turns
from liftmesh.planar.delaunay import delaunay
from liftmesh.planar.verification import verify
from liftmesh.space.tetrahedra import tetrahedralize
from liftmesh.terrain.frame import resolve_plane
from liftmesh.terrain.thinning import rows_apart
from liftmesh.terrain.triangulate import as_surface, triangulate

if TYPE_CHECKING:
    import pyvista as host

    from liftmesh.io.write import WriteResult
    from liftmesh.planar.certificate import Certificate
    from liftmesh.planar.triangulation import Triangulation
    from liftmesh.terrain.surface import Surface
else:
    host = library()

_PLY = ".liftmesh-ply"  # the suffix by which PyVista asks for PLY from here
_REMEDY = "a PolyData that has the points of the dataset, and lines or polygons between them"


def read(path: str | os.PathLike[str], **options: Any) -> host.PolyData:
    """Read a file by `liftmesh.read`, for ``pyvista.read``.

    Parameters
    ----------
    path : path
        The file.
    **options
        Those of `liftmesh.read`, such as ``format`` or ``classes``; ``pyvista.read`` passes them on
        from PyVista 0.49 on.

    Returns
    -------
    pyvista.PolyData
        Points in float64, faces, lines and values.

    Raises
    ------
    FormatError, InputError
        As by `liftmesh.read`.

    See Also
    --------
    write : The way back.

    Examples
    --------
    >>> from liftmesh.plugins.pyvista import read
    >>> read("data/overhang.ply").points.dtype.name
    'float64'
    """
    if str(path).lower().endswith(_PLY):
        options.setdefault("format", "ply")
    return to_pyvista(reading.read(path, **options))


def write(dataset: host.DataSet, path: str | os.PathLike[str], **options: Any) -> WriteResult:
    """Write a dataset by `liftmesh.write`, for ``dataset.save``.

    Parameters
    ----------
    dataset : pyvista.DataSet
        Points with triangles and lines, if any.
    path : path
        The file, which is replaced.
    **options
        Those of `liftmesh.write`.

    Returns
    -------
    WriteResult
        What was written, and what the format does not hold.

    Raises
    ------
    FormatError, InputError
        As by `liftmesh.write`.

    See Also
    --------
    read : The way back.

    Examples
    --------
    >>> import pyvista, tempfile
    >>> from liftmesh.plugins.pyvista import read, write
    >>> dataset = pyvista.PolyData([[0.1, 0, 0], [1, 0, 0], [0, 1, 0]], faces=[3, 0, 1, 2])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     written = write(dataset, f"{folder}/mesh.landxml")
    ...     print(written.format, read(written.path).n_cells)
    landxml 1
    """
    if str(path).lower().endswith(_PLY):
        options.setdefault("format", "ply")
    return writing.write(path, to_cloud(dataset), **{"overwrite": True, **options})


def wrap(source: object) -> host.PolyData:
    """Make a dataset of a surface, or of whatever else `liftmesh.as_cloud` takes.

    Parameters
    ----------
    source : object
        A `Surface`, a `Cloud`, an array, a table, a mesh of another library.

    Returns
    -------
    pyvista.PolyData
        Points, faces, lines and values.

    Raises
    ------
    InputError
        Values have a type that PyVista does not hold.
    UnsupportedTypeError
        The object is none of points.

    See Also
    --------
    liftmesh.as_cloud : The way back, which functions of liftmesh do by themselves.

    Examples
    --------
    >>> import liftmesh
    >>> from liftmesh.plugins.pyvista import wrap
    >>> wrap(liftmesh.triangulate("data/hill.csv")).n_points
    80
    """
    return to_pyvista(as_cloud(source))


@host.register_dataset_accessor("liftmesh", host.DataSet)
class DatasetAccessor:
    """What liftmesh does with a dataset of PyVista, as ``dataset.liftmesh``.

    Parameters
    ----------
    dataset : pyvista.DataSet
        Points, perhaps with triangles and lines. Its float64 coordinates, or float32, are taken as
        they are. Results have its point data and field data; cell data are of cells that no longer
        exist, and stay behind.

    See Also
    --------
    wrap : Makes datasets of surfaces.

    Examples
    --------
    >>> import pyvista
    >>> points = pyvista.PolyData([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]])
    >>> points.liftmesh.delaunay_2d().n_cells
    2
    """

    def __init__(self, dataset: host.DataSet) -> None:
        self._dataset = dataset

    def delaunay_2d(
        self,
        *,
        tol: float = 0.0,
        alpha: float = 0.0,
        offset: float = 1.0,  # noqa: ARG002 - of PyVista's filter
        bound: bool = False,  # noqa: ARG002 - the same
        inplace: bool = False,
        edge_source: host.PolyData | None = None,
        progress_bar: bool = False,
        plane: Any = "fit",
    ) -> host.PolyData:
        """Triangulate the points, over the plane that fits them best.

        Parameters
        ----------
        tol : float, default 0.0
            Points nearer to each other are in no triangle, but for one of them: a fraction of the
            diagonal of the dataset's box. PyVista's default is 1e-05.
        alpha : float, default 0.0
            If positive, only triangles whose circumcircle has at most this radius.
        offset : float, default 1.0
            Changes nothing; of the bounding triangulation, which there is not.
        bound : bool, default False
            Changes nothing, as in PyVista, which leaves bounding triangles out, too.
        inplace : bool, default False
            Whether the dataset, a `PolyData`, becomes the result.
        edge_source : pyvista.PolyData, optional
            Lines and polygons between the points, by their numbers in the dataset, which become
            edges. A polygon that turns counter-clockwise, seen from above the plane, bounds the
            triangles, one that turns clockwise is a hole, as for PyVista; one of two points is a
            line.
        progress_bar : bool, default False
            Whether to show how far it is.
        plane : {"fit", "xy", "xz", "yz"}, or as for `liftmesh.triangulate`
            The plane; "xy" is the right one of terrain.

        Returns
        -------
        pyvista.PolyData
            All points of the dataset, in its type of numbers, with the triangles as faces.

        Raises
        ------
        InputError
            An option is invalid, the edges are not between points of the dataset, or no triangle is
            left.
        CrossingError
            Edges cross; the message names them.
        DegenerateInputError
            Fewer than three points, or all on a line.
        NonFiniteError
            A coordinate is not finite.

        See Also
        --------
        terrain : Surfaces with breaklines.
        liftmesh.constrained_delaunay : What does it.

        Examples
        --------
        >>> import pyvista
        >>> ring = pyvista.Polygon(n_sides=30)
        >>> pyvista.PolyData(ring.points).liftmesh.delaunay_2d().n_cells
        28
        """
        if as_switch("inplace", inplace) and not isinstance(self._dataset, host.PolyData):
            kind = type(self._dataset).__name__
            raise InputError(f"a {kind} cannot become a PolyData: leave out {Option('inplace')}")
        planar = self._planar(plane)
        tol = as_distance("tol", tol) * self._dataset.length
        radius = as_distance("alpha", alpha)
        kept = rows_apart(planar, tol)
        if edge_source is not None and tol:
            raise InputError(
                f"{Option('tol')} could leave out ends of {Option('edge_source')}: give one of both"
            )
        with _progress(progress_bar, "Computing 2D triangulation") as progress:
            found = _triangulated(planar[kept], self._limits(edge_source), progress)
        faces = kept[found.simplices]
        if radius:
            faces = faces[radii_of(found, is_up=True) <= radius]
        return self._result(faces, inplace)

    def delaunay_3d(
        self,
        *,
        alpha: float = 0.0,
        tol: float = 0.0,
        offset: float = 2.5,  # noqa: ARG002 - of PyVista's filter
        progress_bar: bool = False,
    ) -> host.UnstructuredGrid:
        """Make tetrahedra of the points.

        Parameters
        ----------
        alpha : float, default 0.0
            If positive, only tetrahedra whose sphere has at most this radius, and the triangles and
            lines between them that belong to the alpha complex.
        tol : float, default 0.0
            Only 0: all points count. PyVista's default is 0.001.
        offset : float, default 2.5
            Changes nothing; of the bounding triangulation, which there is not.
        progress_bar : bool, default False
            Whether to show how far it is.

        Returns
        -------
        pyvista.UnstructuredGrid
            All points of the dataset, with the tetrahedra as cells.

        Raises
        ------
        InputError
            An option is invalid.
        DegenerateInputError
            Fewer than four points, or all in a plane.
        NonFiniteError
            A coordinate is not finite.

        See Also
        --------
        liftmesh.tetrahedralize : What does it.

        Examples
        --------
        >>> import pyvista
        >>> round(pyvista.Cube().clean().liftmesh.delaunay_3d().volume, 9)
        1.0
        """
        if tol:
            raise refused("tol", tol, "0 is the only tolerance: points near others count, too")
        radius = as_distance("alpha", alpha)
        with _progress(progress_bar, "Computing 3D triangulation") as progress:
            found = tetrahedralize(self._points, progress=progress)
        kinds = host.CellType
        cells = {kinds.TETRA: found.simplices}
        if radius:
            shape, complex_ = found.alpha_shape(radius), found.alpha_complex(radius)
            cells = {
                kinds.TETRA: shape.simplices,
                kinds.TRIANGLE: shape.singular,
                kinds.LINE: _alone(complex_.edges, complex_.triangles),
            }
        cells = {kind: rows.astype(np.int64) for kind, rows in cells.items() if len(rows)}
        points = np.array(self._dataset.points)
        return self._with_values(host.UnstructuredGrid(cells, points))

    def terrain(
        self, *, max_edge: float | None = None, boundary_only: bool = False, **options: Any
    ) -> host.PolyData:
        """Triangulate the points as terrain: over x and y, with lines and outer boundaries.

        Parameters
        ----------
        max_edge : float, optional
            Leave out faces with a side that is longer in the plane.
        boundary_only : bool, default False
            Leave out only those that such a side connects with the outside.
        **options
            Those of `liftmesh.triangulate`: ``breaklines``, ``boundary``, ``holes``,
            ``on_duplicate``. Lines of PyVista are given as their points.

        Returns
        -------
        pyvista.PolyData
            All points in float64, those of lines last, with faces that turn counter-clockwise seen
            from above.

        Raises
        ------
        InputError
            An option is invalid, or no face is left.
        DegenerateInputError
            Fewer than three points, or all on a line seen from above.

        See Also
        --------
        delaunay_2d : Over any plane.
        liftmesh.triangulate, liftmesh.Surface.trim : What does it.

        Examples
        --------
        >>> import pyvista
        >>> points = pyvista.PolyData([[0.0, 0, 5], [9, 0, 5], [0, 9, 5], [9, 9, 7], [40, 9, 0]])
        >>> points.liftmesh.terrain(max_edge=15).n_cells
        2
        """
        surface = triangulate(to_cloud(self._dataset), **options)
        if max_edge is not None or boundary_only:
            surface = surface.trim(max_edge=max_edge, boundary_only=boundary_only)
        return self._with_fields(to_pyvista(surface.to_cloud()))

    def sample(
        self,
        points: host.DataSet | ArrayLike,
        interpolation: Interpolation = "linear",
        *,
        extrapolate: Extrapolation | None = None,
    ) -> host.PolyData:
        """Interpolate the height of the surface, and its point data, at points seen from above.

        Parameters
        ----------
        points : pyvista.DataSet or (n, 2) or (n, 3) array_like
            Where; z is not used.
        interpolation, extrapolate
            As for `liftmesh.Surface.sample`.

        Returns
        -------
        pyvista.PolyData
            These points with their own point data, and with the point data ``height`` and those
            numbers that the surface has: NaN where there are no faces. PyVista's own ``sample``
            interpolates in space, and marks such points.

        Raises
        ------
        InputError
            The faces overlap seen from above, or an option is invalid.

        See Also
        --------
        liftmesh.Surface.sample : What does it.

        Examples
        --------
        >>> import pyvista
        >>> surface = pyvista.PolyData([[0.0, 0, 5], [9, 0, 5], [0, 9, 14]]).liftmesh.terrain()
        >>> surface.liftmesh.sample([[1, 1], [9, 9]])["height"]
        pyvista_ndarray([ 6., nan])
        """
        surface = self._surface()
        if not isinstance(points, host.DataSet):
            points = host.PolyData(as_rows3(points))
        result = host.PolyData(np.array(points.points))
        result.point_data.update(points.point_data)
        result.field_data.update(points.field_data)
        places = np.array(points.points[:, :2], dtype=np.float64)
        ways: Any = {"extrapolate": extrapolate}
        for name, values in surface.attributes.items():
            if values.dtype.kind in "iuf":
                result.point_data[name] = surface.sample(
                    places, interpolation, values=values, **ways
                )
        result.point_data["height"] = surface.sample(places, interpolation, **ways)
        return result

    def contours(self, levels: ArrayLike | None = None, **options: Any) -> host.PolyData:
        """Compute the lines of equal height of the surface.

        Parameters
        ----------
        levels : array_like of float, optional
            Heights.
        **options
            Those of `liftmesh.Surface.contours`: ``interval`` in place of levels, ``smooth``.

        Returns
        -------
        pyvista.PolyData
            A line for each contour, by ascending level, at its height; the cell data ``level`` and
            ``is_index``. PyVista's ``contour`` has one piece for each triangle and level.

        Raises
        ------
        InputError
            The faces overlap seen from above, or an option is invalid.

        See Also
        --------
        liftmesh.Surface.contours : What does it.

        Examples
        --------
        >>> import pyvista
        >>> surface = pyvista.PolyData([[0.0, 0, 0], [9, 0, 0], [0, 9, 9]]).liftmesh.terrain()
        >>> surface.liftmesh.contours(interval=2)["level"]
        pyvista_ndarray([2., 4., 6., 8.])
        """
        found = self._surface().contours(levels, **options)
        counts = np.diff(found.starts)
        points = np.column_stack([found.points, np.repeat(found.levels, counts)])
        lines = np.insert(np.arange(len(points)), found.starts[:-1], counts)
        mesh = host.PolyData(points, lines=lines) if len(counts) else host.PolyData()
        mesh.cell_data["level"], mesh.cell_data["is_index"] = found.levels, found.is_index
        return self._with_fields(mesh)

    def voronoi(self, domain: Any = None) -> host.PolyData:
        """Compute the Voronoi cells of the points in the plane of x and y.

        Parameters
        ----------
        domain : (xmin, ymin, xmax, ymax), polygon or (k, 2) array_like, optional
            What to clip to, as for `liftmesh.voronoi`: by default a box around the points.

        Returns
        -------
        pyvista.PolyData
            A polygon for each cell, at z = 0, or one for each part, and triangles where the
            domain has a hole in a cell. The cell data are the point data, ``row``, the number of
            the point, and ``height``, its z; of points at one position the first has the cell.

        Raises
        ------
        InputError
            There are no points, or the domain is invalid.
        NonFiniteError
            A coordinate is not finite.

        See Also
        --------
        liftmesh.voronoi : What does it.

        Examples
        --------
        >>> import pyvista
        >>> points = pyvista.PolyData([[0.0, 0, 5], [2, 0, 7]])
        >>> cells = points.liftmesh.voronoi((-1, -1, 3, 1))
        >>> cells.area, cells["height"].tolist()
        (8.0, [5.0, 7.0])
        """
        cells = voronoi(self._points[:, :2], domain=domain)
        polygons, row = _polygons(cells)
        mesh = host.PolyData(in_space(cells.corners), faces=polygons)
        of_points = self._dataset.point_data
        for name in of_points:
            mesh.cell_data[name] = np.asarray(of_points[name])[row]
        mesh.cell_data["row"], mesh.cell_data["height"] = row, self._points[row, 2]
        return self._with_fields(mesh)

    def verify(self, *, edge_source: host.PolyData | None = None, plane: Any = "xy") -> Certificate:
        """Verify exactly that the triangles, or tetrahedra, of the dataset are Delaunay.

        Parameters
        ----------
        edge_source : pyvista.PolyData, optional
            Edges that must be there, as for `delaunay_2d`.
        plane : {"xy", "xz", "yz", "fit"}, or as for `liftmesh.triangulate`, default "xy"
            The plane of the triangles.

        Returns
        -------
        Certificate
            True if they are; it counts and names what is wrong.

        Raises
        ------
        InputError
            The dataset has neither triangles nor tetrahedra.

        See Also
        --------
        liftmesh.verify : What does it.

        Examples
        --------
        >>> import pyvista
        >>> mesh = pyvista.PolyData([[0.0, 0, 5], [9, 0, 5], [0, 9, 14]]).liftmesh.terrain()
        >>> print(mesh.liftmesh.verify())
        valid: 1 triangle is the canonical Delaunay triangulation of 3 rows
        """
        tetrahedra = getattr(self._dataset, "cells_dict", {}).get(host.CellType.TETRA)
        if tetrahedra is not None:
            return verify(self._points, tetrahedra)
        faces = faces_of(self._dataset)
        if faces is None:
            raise InputError("the dataset has no triangles to verify: make some (delaunay_2d)")
        planar = self._planar(plane)
        if edge_source is None:
            return verify(planar, faces)
        limits = self._limits(edge_source)
        return verify(planar, faces, constraints=limits.sides, carved=bool(limits.rings))

    def save(self, path: str | os.PathLike[str], **options: Any) -> WriteResult:
        """Write the dataset by `liftmesh.write`, in any of its formats.

        Parameters
        ----------
        path : path
            The file, which is replaced.
        **options
            Those of `liftmesh.write`.

        Returns
        -------
        WriteResult
            What was written, and what the format does not hold.

        Raises
        ------
        FormatError, InputError
            As by `liftmesh.write`.

        See Also
        --------
        read : The way back.

        Examples
        --------
        >>> import pyvista, tempfile
        >>> points = pyvista.PolyData([[0.1, 0, 5], [9, 0, 5], [0, 9, 5]])
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     written = points.liftmesh.save(f"{folder}/points.ply")
        ...     print(pyvista.read(written.path, force_ext=".liftmesh-ply").points[0, 0])
        0.1
        """
        return write(self._dataset, path, **options)

    @property
    def _points(self) -> Floats:
        return np.array(self._dataset.points, dtype=np.float64)

    def _planar(self, plane: Any) -> Floats:
        points = self._points
        check_finite(points)
        return resolve_plane(plane, points).planar(points)

    def _surface(self) -> Surface:
        """The dataset's own faces as a surface, or those of its points."""
        cloud = to_cloud(self._dataset)
        return triangulate(cloud) if cloud.faces is None else as_surface(cloud)

    def _limits(self, source: host.PolyData | None) -> _Limits:
        if source is None:
            return _NO_LIMITS
        if not isinstance(source, host.PolyData):
            kind = type(source).__name__
            raise InputError(f"{Option('edge_source')} is a {kind}: give {_REMEDY}")
        if source.n_points != self._dataset.n_points:
            raise InputError(
                f"{Option('edge_source')} has {counted(source.n_points, 'point')} for "
                f"{self._dataset.n_points:,} of the dataset: give {_REMEDY}"
            )
        return _limits_of(source)

    def _result(self, faces: Rows, inplace: bool) -> host.PolyData:
        mesh = host.PolyData(np.array(self._dataset.points))
        mesh.verts = np.empty(0, dtype=np.int64)
        mesh.regular_faces = faces.astype(np.int64)
        mesh = self._with_values(mesh)
        if not inplace:
            return mesh
        self._dataset.copy_from(mesh)
        return self._dataset

    def _with_values(self, mesh: Any) -> Any:
        mesh.point_data.update(self._dataset.point_data)
        return self._with_fields(mesh)

    def _with_fields(self, mesh: Any) -> Any:
        mesh.field_data.update(self._dataset.field_data)
        return mesh


class _Limits(NamedTuple):
    """The edges that a triangulation must have, and the polygons that bound it."""

    edges: Rows
    rings: list[Array]

    @property
    def sides(self) -> Rows:
        """All edges, those of polygons last."""
        rings = [np.stack([each, np.roll(each, -1)], axis=1) for each in self.rings]
        return np.concatenate([self.edges, *rings])


_NO_LIMITS = _Limits(np.empty((0, 2), dtype=np.int32), [])


def _limits_of(source: host.PolyData) -> _Limits:
    """Take the lines and polygons of a dataset; a polygon of two points is a line."""
    polygons = [_without_return(each) for each in corners_of(source.faces)]
    sides = [each for each in polygons if len(each) == 2]
    edges = np.concatenate([edges_of_lines(source.lines), np.array(sides).reshape(-1, 2)])
    return _Limits(edges.astype(np.int32), [each for each in polygons if len(each) > 2])


def _without_return(ring: Array) -> Array:
    return ring[:-1] if len(ring) > 1 and ring[0] == ring[-1] else ring


def _triangulated(planar: Floats, limits: _Limits, progress: Progress | None) -> Triangulation:
    """Triangulate with edges, inside of polygons that turn one way and outside of the others."""
    edges, rings = limits
    if not len(edges) and not rings:
        return delaunay(planar, progress=progress)
    if not rings:
        return constrained_delaunay(planar, edges, progress=progress)
    corners = planar[np.concatenate(rings)]
    is_hole = turns(corners, np.cumsum([0, *map(len, rings)])) < 0
    holes = [ring for ring, hides in zip(rings, is_hole, strict=True) if hides]
    outer = [ring for ring, hides in zip(rings, is_hole, strict=True) if not hides]
    if not outer:
        outer = [delaunay(planar).convex_hull]
    polygons = [[outer[0], *holes], *([ring] for ring in outer[1:])]
    return constrained_delaunay(planar, edges, polygons=polygons, carve="holes", progress=progress)


def _polygons(cells: Cells) -> tuple[Array, Array]:
    """Return the cells as VTK's list of polygons, and the row of each; without holes."""
    starts = cells.ring_corners
    row = np.repeat(np.arange(len(cells)), np.diff(cells.parts))
    if len(row) == len(starts) - 1:
        return np.insert(np.arange(starts[-1]), starts[:-1], np.diff(starts)), row
    parts = [_without_holes(cells, part) for part in range(len(row))]
    faces = [np.insert(each, 0, each.shape[1], axis=1).reshape(-1) for each in parts]
    return np.concatenate(faces), np.repeat(row, [*map(len, parts)])


def _without_holes(cells: Cells, part: int) -> Array:
    """Return a part of a cell as one polygon, or as triangles if it has holes."""
    starts = cells.ring_corners[cells.rings[part] : cells.rings[part + 1] + 1]
    first, end = starts[0], starts[-1]
    if len(starts) == 2:
        return np.arange(first, end)[None]
    rings = np.split(np.arange(end - first), starts[1:-1] - first)
    corners = cells.corners[first:end]
    faces: Array = first + constrained_delaunay(corners, polygons=[rings], carve="holes").simplices
    return faces


def _alone(edges: Rows, triangles: Rows) -> Rows:
    """Return the edges of a complex that are sides of none of its triangles."""
    sides = np.concatenate([triangles[:, pair] for pair in ([0, 1], [0, 2], [1, 2])])
    return edges[~np.isin(pair_keys(*edges.T), pair_keys(*sides.T))]


@contextmanager
def _progress(shown: bool, what: str) -> Iterator[Progress | None]:
    """Show how far a function is, if that is asked for."""
    if not as_switch("progress_bar", shown):
        yield None
        return
    from rich.progress import Progress as Bar  # noqa: PLC0415 - rarely shown

    with Bar() as bar:
        task = bar.add_task(what, total=1.0)
        yield lambda done: bar.update(task, completed=done)
