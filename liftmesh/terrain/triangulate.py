"""`triangulate`, from a cloud to a surface, in stages, and `as_surface`, from a mesh.

The input is converted to a `Cloud`; its rows are projected to planar coordinates and heights; the
planar points are triangulated, exactly; if several rows share a planar position, a policy selects
the row that is used as the vertex. The surface's vertices are all of the caller's rows, in their
order: the selection concerns the faces only.
"""

from __future__ import annotations

import time
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypedDict

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Apex, Floats, Progress, Rows
from liftmesh.base.arrays import check_finite, non_finite, of_one_array
from liftmesh.base.options import (
    Algorithm,
    Crossing,
    NonFinite,
    OnDuplicate,
    OwnFaces,
    check_option,
    check_progress,
    counted,
    part_of,
)
from liftmesh.crs.comparison import given_text
from liftmesh.crs.description import parse_crs
from liftmesh.crs.units import coordinate_warnings
from liftmesh.errors import DataWarning, InputError, NonFiniteError, Option
from liftmesh.io.columns import edges_of
from liftmesh.io.metadata import Provenance
from liftmesh.io.read import read_cloud, read_for_surface
from liftmesh.terrain.changes import with_parts
from liftmesh.terrain.equal_positions import Choice, choose_rows
from liftmesh.terrain.frame import Frame, resolve_plane
from liftmesh.terrain.height_field import warn_if_folded
from liftmesh.terrain.lifting import Lifting, lifting_of
from liftmesh.terrain.own_faces import fields_of
from liftmesh.terrain.report import Report, report_on
from liftmesh.terrain.surface import Surface

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from liftmesh.base.cloud import Cloud
    from liftmesh.io.options import ReadOptions
    from liftmesh.planar.delaunay import Solution
    from liftmesh.planar.triangulation import Triangulation
    from liftmesh.terrain.breaklines import Following

# Fraction of the whole work that is done at the end of each stage.
DONE_AFTER = {"read": 0.04, "plane": 0.05, "triangulation": 0.95, "heights": 0.99}


@of_one_array
def triangulate(  # noqa: PLR0913 - options are keywords
    cloud: object,
    *,
    colors: ArrayLike | None = None,
    normals: ArrayLike | None = None,
    attributes: Mapping[str, ArrayLike] | None = None,
    crs: Any = None,
    plane: Literal["xy", "xz", "yz", "fit"] | ArrayLike = "xy",
    on_duplicate: OnDuplicate = "first",
    nonfinite: NonFinite = "error",
    algorithm: Algorithm = "auto",
    apex: Apex = "median",
    threads: int | None = None,
    progress: Progress | None = None,
    weights: ArrayLike | str | None = None,
    radii: ArrayLike | str | None = None,
    metric: ArrayLike | None = None,
    breaklines: Any = None,
    soft_breaklines: Any = None,
    boundary: Any = None,
    holes: Any = None,
    densify: float | None = None,
    crossing: Crossing = "error",
    **options: Unpack[ReadOptions],
) -> Surface:
    """Triangulate a point cloud over a plane.

    Parameters
    ----------
    cloud : object
        An array-like of shape (n, 3), or (n, 2) for z = 0; a table whose columns have names, such
        as a DataFrame; a ``trimesh.PointCloud`` or ``trimesh.Trimesh`` (its vertices); an Open3D
        point cloud, legacy or tensor; a path; a `Cloud`; or an object that an installed adapter
        accepts. Never modified.
    colors : (n, 3) or (n, 4) array_like, optional
        Colours of the rows, in place of those of the cloud: floats from 0 to 1, or integers, of
        which the values decide how many bits they have, as for a `Cloud`.
    normals : (n, 3) array_like, optional
        Normals of the rows, in place of those of the cloud.
    attributes : mapping of str to (n, ...) array_like, optional
        Further named values of the rows, in place of those of the same name.
    crs : str, int or CRS, optional
        The coordinate reference system, in place of that of the cloud: WKT, ``EPSG:n``, or whatever
        ``pyproj.CRS.from_user_input`` takes.
    plane : "xy", "xz", "yz", "fit", (3,), (4,), (2, 3) or (4, 4) array-like
        Projection plane: two of the axes (``"xz"`` is seen against y, with the height -y; ``"yz"``
        has the height x); the least squares plane (its normal has n_z > 0; if zero, n_y > 0, then
        n_x > 0); a normal; (a, b, c, d) of the plane ax + by + cz + d = 0; a point and a normal, as
        ``trimesh.points.plane_fit`` returns them; or the rigid transformation from space to plane
        coordinates, as ``trimesh.geometry.plane_transform`` returns it. "Above" is where a normal
        points; of those that are fitted elsewhere the sign may be either. Unless it is of two axes,
        the planar coordinates are rounded, and the result is exact for the rounded coordinates.
    on_duplicate : {"first", "last", "lowest", "highest", "mean", "error"}
        Policy for rows at one planar position with different heights: use the first or last row as
        the vertex; the lowest or highest one; the first one, moved to the mean of the different
        heights and otherwise unchanged; or raise an error. Rows equal in height too are merged and
        counted.
    nonfinite : {"error", "skip"}
        Policy for rows that hold NaN or infinity: raise an error, or skip them.
    algorithm : {"auto", "divide-and-conquer", "lf", "lfres", "lfres-indexed"}
        The algorithm, as for `delaunay`; all give the same triangles.
    apex : {"median", "origin"} or (2,) array_like, default "median"
        The apex of the paraboloid in plane coordinates; only "lf" and "lfres" use it.
    threads : int, optional
        Number of threads for the triangulation, from 1 to 1024; the surface is bit for bit the
        same for any number. By default the value of the environment variable
        ``LIFTMESH_NUM_THREADS``, or else one per core, shared by concurrent runs.
    progress : callable, optional
        Called with the fraction of the work done, a float from 0 to 1 that never decreases: after
        each stage, at most about twenty times a second during divide and conquer, and with 1.0 at
        the end. It is called in the thread that called `triangulate`. An exception that it raises
        aborts the run and propagates unchanged; the cloud stays as it was, and no result remains.
    weights, radii : (n,) array_like or str, optional
        The faces are those of the regular triangulation, as from `regular`, of the planar points
        with these weights, or radii: numbers, or the name of values of the cloud, such as a column
        of a table. At one planar position the heaviest rows count, and `on_duplicate` chooses among
        these.
    metric : (2, 2) array_like, optional
        The metric of the planar coordinates, as for `delaunay`.
    breaklines : (c, 3) or (c, 2) array_like, list of these, geometries or path, optional
        Hard breaklines, which faces do not cross: polylines whose corners become rows after those
        of the cloud, with their heights. A row of the cloud on a line divides it, and keeps its
        height; at a corner of the line, that of the line holds. A line without heights, or with one
        that is NaN, takes those of the surface without it at its corners. Geometries are those of
        shapely, a GeoDataFrame, GeoJSON as a mapping, or a file of GeoJSON, GeoPackage or
        shapefile; rings of polygons are lines, too. With contour lines, look at the
        "flat_triangles" of the report.
    soft_breaklines : as `breaklines`, optional
        Lines draped over the surface without them: they are edges, with a row wherever they cross
        one, and bring no heights of their own. Parts beyond the faces are left out.
    boundary : (c, 2) or (c, 3) array_like, list of polygons, geometries or path, optional
        The outer boundary: faces outside are left out, cut at its rings, which are edges. Rings
        with heights are hard breaklines; others are draped. A polygon is a ring, or a list of
        rings: the outer one, then its holes. Of several polygons, what is inside of one is inside.
    holes : as `boundary`, optional
        Boundaries that hide: faces inside are left out, as in a lake. Holes of these polygons show
        what is inside of them, as islands do.
    densify : float, optional
        Insert corners into all lines so that they are no farther apart in the plane than this, with
        heights that are linear between those given. Their places are rounded. At most 2^24 corners.
    crossing : {"error", "split"}, default "error"
        What is done where two lines cross whose heights hold, and neither has a corner: raise an
        error that names lines, place and both heights; or insert a row there, with the height of
        the line that comes first, linear between its corners. Of lines of different kinds, one
        whose heights hold gives the height, and nothing is raised.
    **options
        Of a file all options of `read`, such as `bounds`, `src_crs` or `columns`; of an array or a
        table in memory ``columns``, ``flat`` and ``nodata``, as for `as_cloud`. The default of
        `classes` is another than that of `read`: of LAS, LAZ and COPC "ground", which is class 2 if
        any row has it, else all rows, and rows that the file flags as withheld are left out
        whatever the classes. ``classes="all"`` takes all. Of a `Cloud` or another object all rows
        count, as they are. ``Surface.report.classes`` says which classes were taken.

    Returns
    -------
    Surface
        All rows as vertices, in their order; faces, counter-clockwise seen from above; colours,
        normals and named values; and a report on the use of every row. With weights, these are
        among the named values, as ``weights`` or ``radii`` if they had no name, and ``hidden`` is 1
        for rows that they hide and 0 for others, in place of such values of a former run;
        ``metadata["triangulated_by"]`` says what was taken. If the cloud's
        points are float64, the surface shares their memory: do not write to them while it is in
        use, or give a copy. The surface's own arrays are read-only.
        Rows of lines come last, with the colours, normals and named values of the nearest row of
        the cloud; among the named values ``breakline`` is 1 for rows whose line has heights, 2 for
        others of lines, and 0 for rows of the cloud; ``report.lines`` has the counts. The faces
        that a boundary or holes leave out are masked, as `Surface.trim` masks them.

    Raises
    ------
    InputError
        An option is unknown; the cloud, colours, normals, named values, weights, radii or metric
        have the wrong shape, type or values, or do not go together; coordinates are geocentric
        and the plane is one of names; lines are in another system than the cloud, cross, or have
        no heights and leave the faces; they stand together with weights, radii or a metric; or
        they need rows of their own, and the plane is not of two axes.
    NonFiniteError
        A row is not finite and ``nonfinite`` is ``"error"``.
    DuplicateHeightError
        Rows at one planar position have different heights and ``on_duplicate`` is ``"error"``.
    DegenerateInputError
        There are fewer than three distinct planar positions, or all lie on one line.
    UnsupportedTypeError
        No adapter can convert the object to a cloud.
    FormatError
        The format of the file is unknown, or the file is invalid.
    MissingDependencyError
        The format of the file needs a package that is not installed.
    OSError
        The file does not exist or cannot be opened.

    Warns
    -----
    DataWarning
        The coordinate system has degrees, or units that differ; the cloud is no height field, as
        ``liftmesh.terrain.height_field`` decides of a thousand rows or more, or of faces; with
        weights or radii, values named ``hidden`` are replaced; all lines of an option lie beyond
        all points; or the cloud has edges, which are not used.

    See Also
    --------
    delaunay : Planar points, without heights.
    as_surface : Of a mesh.
    simplify : Fewer vertices, within a bound.
    tile_surface : Of clouds larger than memory.

    Examples
    --------
    >>> surface = triangulate([[0, 0, 5], [4, 0, 6], [0, 3, 7], [4, 3, 9], [4, 3, 8]])
    >>> surface.faces.shape
    (2, 3)
    >>> surface.report.n_overhangs, surface.report.left_out
    (1, array([4], dtype=int32))
    >>> corners = [[0, 0, 5], [4, 0, 6], [0, 3, 7]]
    >>> triangulate(corners, attributes={"class": [2, 2, 6]}).attributes["class"]
    array([2, 2, 6])

    A ditch between two banks, and a pond:

    >>> banks = [[0, 0, 5], [8, 0, 5], [0, 8, 5], [8, 8, 5]]
    >>> ditch = [[0, 4, 1], [8, 4, 1]]
    >>> pond = [[1, 5], [3, 5], [3, 7], [1, 7]]
    >>> surface = triangulate(banks, breaklines=ditch, holes=pond)
    >>> surface.sample([[4, 4], [4, 6], [2, 6]])
    array([ 1.,  3., nan])
    >>> surface.attributes["breakline"][:6], surface.report.lines["edges"]
    (array([0, 0, 0, 0, 1, 1], dtype=uint8), 7)
    """
    check_option("on_duplicate", on_duplicate, OnDuplicate)
    check_option("nonfinite", nonfinite, NonFinite)
    check_option("algorithm", algorithm, Algorithm)
    check_progress(progress)
    check_option("crossing", crossing, Crossing)
    stages = _Stages(progress)
    given = {"colors": colors, "normals": normals, "attributes": attributes}
    given["crs"] = given_text(crs)
    source = with_parts(read_for_surface(cloud, **options), given)
    _warn_of_edges(source)
    given_lines = breaklines, soft_breaklines, boundary, holes, densify
    lines = None
    if any(each is not None for each in given_lines):
        from liftmesh.terrain.lines import lines_given  # noqa: PLC0415 - most clouds have none

        lines = lines_given(*given_lines, crossing, source.crs)
    lifting = lifting_of(source, weights, radii, metric, algorithm)
    source = lifting.cloud
    stages.finish("read")
    check_system(source.crs, plane, stacklevel=4)
    if nonfinite == "error" and isinstance(plane, str) and plane == "fit":
        check_finite(source.points)  # a fit ignores such rows, and its errors would hide them
    frame = resolve_plane(plane, source.points)
    engine: _Options = {
        "nonfinite": nonfinite,
        "algorithm": algorithm,
        "apex": apex,
        "threads": threads,
    }
    stages.finish("plane")
    run = _Run(frame, on_duplicate, engine, stages)
    if lines is None:
        surface = run.surface(lifting)
    else:
        from liftmesh.terrain.breaklines import with_lines  # noqa: PLC0415 - as above

        surface = with_lines(lines, lifting, algorithm, frame, run.surface)
    warn_if_folded(surface, source.faces, stacklevel=4)
    stages.end()
    return surface


def check_system(
    crs: str | None,
    plane: object,
    stacklevel: int = 3,  # whose line a warning names
) -> None:
    """Refuse coordinates that have no plane x, y, and warn of those that are no lengths."""
    system = parse_crs(crs)
    if system is not None and system.kind == "geocentric" and isinstance(plane, str | None):
        raise InputError(
            f"the coordinates are geocentric ({system.name}), and x, y is no plane on the ground: "
            f"read the file with {Option('dst_crs', ...)} a projected system, or give the normal "
            "of a plane"
        )
    for each in coordinate_warnings(system):
        warnings.warn(each, DataWarning, stacklevel=stacklevel)


def _warn_of_edges(cloud: Cloud) -> None:
    """Name what takes the edges of a cloud."""
    if count := len(edges_of(cloud)):
        warnings.warn(
            f"the points have {counted(count, 'edge')}, not used here: "
            f"{Option('constrained_delaunay')} takes edges, and triangulate takes lines, as "
            f"{Option('breaklines', ...)}",
            DataWarning,
            stacklevel=4,
        )


class _Options(TypedDict):
    """Options of `delaunay`."""

    nonfinite: NonFinite
    algorithm: Algorithm
    apex: Apex
    threads: int | None


@dataclass(slots=True, eq=False)
class _Run:
    """Makes surfaces of one cloud."""

    frame: Frame
    policy: OnDuplicate
    options: _Options
    stages: _Stages

    def surface(self, lifting: Lifting | Following, *, is_last: bool = True) -> Surface:
        """Make the surface of a cloud, and of rows and edges of lines if there are any."""
        stages = self.stages if is_last else _Stages(None)
        frame = self.frame
        within = stages.within("triangulation")
        solution = _solve(lifting, frame, self.options, within)
        stages.finish("triangulation")
        source, heights = lifting.completed(solution.hidden), frame.heights(lifting.points)
        choice = choose_rows(
            solution.duplicates, heights, solution.points, self.policy, ranks=lifting.ranks
        )
        triangulation = lifting.triangulation(_chosen(solution, choice))
        hidden = solution.hidden
        vertices = _vertices(source.points, heights, frame, choice)
        stages.finish("heights")
        return Surface(
            vertices=vertices,
            faces=triangulation.simplices,
            triangulation=triangulation,
            frame=frame,
            report=_report(triangulation, choice, hidden, self.policy, stages.seconds, source),
            colors=source.colors,
            normals=source.normals,
            attributes=source.attributes,
            metadata=source.metadata,
            crs=source.crs,
        )


class _Stages:
    """Progress of a run: seconds by stage, and the fraction of the work done."""

    def __init__(self, progress: Progress | None) -> None:
        self.seconds: dict[str, float] = {}
        self._progress = progress
        self._done = 0.0
        self._last = time.perf_counter()

    def finish(self, stage: str) -> None:
        """Record the end of a stage."""
        now = time.perf_counter()
        self.seconds[stage] = now - self._last
        self._last = now
        self._report(DONE_AFTER[stage])

    def within(self, stage: str) -> Progress | None:
        """Return a callback that scales a stage's own progress, from 0 to 1, to the whole run."""
        return part_of(self._progress, self._done, DONE_AFTER[stage])

    def end(self) -> None:
        """Report the end of the run."""
        self._report(1.0)

    def _report(self, done: float) -> None:
        self._done = done
        if self._progress is not None:
            self._progress(self._done)


def _solve(
    lifting: Lifting | Following,
    frame: Frame,
    options: _Options,
    progress: Progress | None,
) -> Solution:
    """Triangulate the planar points; a row whose height is not finite counts as not finite."""
    points = lifting.points
    planar, heights = frame.planar(points), frame.heights(points)
    if not np.isfinite(heights).all():
        if options["nonfinite"] == "error":
            raise _nonfinite_error(points, planar, heights)
        planar = planar.copy()
        planar[~np.isfinite(heights)] = np.nan
    try:
        solution = lifting.solve(planar, {**options, "progress": progress})
    except NonFiniteError:
        if np.isfinite(planar).all():
            raise  # not about these points: raised by `progress`
        raise _nonfinite_error(points, planar, heights) from None
    skipped = solution.skipped
    _refuse_overflow(points, skipped[lifting.has_weight(skipped)])
    return solution


def _nonfinite_error(points: Floats, planar: Floats, heights: Floats) -> InputError:
    """Return the error for the first row that is not finite, in the caller's coordinates."""
    finite = np.isfinite(planar).all(axis=1) & np.isfinite(heights)
    row = int(np.argmin(finite))
    if np.isfinite(points[row]).all():
        return _overflow(row, points)
    return non_finite(row, points[row])


def _refuse_overflow(points: Floats, skipped: Rows) -> None:
    """Raise for a finite row that was skipped because its planar coordinates overflow."""
    overflown = skipped[np.isfinite(points[skipped]).all(axis=1)]
    if len(overflown):
        raise _overflow(int(overflown[0]), points)


def _overflow(row: int, points: Floats) -> InputError:
    return InputError(
        f"row {row}, {tuple(points[row].tolist())}, overflows in plane coordinates: "
        "scale the cloud down"
    )


def _chosen(solution: Solution, choice: Choice) -> Solution:
    """Replace kept rows by chosen rows; return the same arrays if there is no change."""
    changed = choice.kept != choice.chosen
    if not changed.any():
        return solution
    vertex_of = np.arange(len(solution.points), dtype=np.int32)
    vertex_of[choice.kept[changed]] = choice.chosen[changed]
    return solution._replace(
        simplices=vertex_of.take(solution.simplices, axis=0),
        hull=vertex_of[solution.hull],
        duplicates=np.stack([choice.left_out, choice.representatives], axis=1),
    )


def _vertices(points: Floats, heights: Floats, frame: Frame, choice: Choice) -> Floats:
    """Return the caller's rows, or a copy if a height changes."""
    moved = choice.moved
    if len(moved) == 0:
        return points
    vertices: Floats = points.copy()
    vertices[moved] = frame.raised(points[moved], heights[moved], choice.new_heights)
    return vertices


def _report(
    triangulation: Triangulation,
    choice: Choice,
    hidden: Rows,
    policy: str,
    seconds: dict[str, float],
    cloud: Cloud,
) -> Report:
    overhangs = int(np.count_nonzero(choice.overhanging))
    skipped = triangulation.skipped
    alone = np.concatenate([skipped, hidden])
    left_out = np.concatenate([choice.left_out, alone])
    representatives = np.concatenate([choice.representatives, np.full_like(alone, -1)])
    order = np.argsort(left_out)
    return report_on(
        cloud,
        n_used=triangulation.npoints - len(left_out),
        n_duplicates=len(choice.left_out) - overhangs,
        n_overhangs=overhangs,
        n_skipped=len(skipped),
        n_triangles=triangulation.nsimplex,
        policy=policy,
        seconds=seconds,
        left_out=left_out[order],
        representatives=representatives[order],
        columns=Provenance(cloud.metadata).columns,
        n_hidden=len(hidden),
    )


def as_surface(
    mesh: object,
    *,
    plane: str | ArrayLike = "xy",
    triangulation: OwnFaces | None = None,
    threads: int | None = None,
) -> Surface:
    """Make a surface of a mesh: of any whose faces do not overlap seen from above.

    The mesh may be one that `triangulate` has written, or have been smoothed, subdivided, trimmed
    or made by any other program, in one piece or several, with holes.

    Parameters
    ----------
    mesh : object
        A file or an object with faces, as for `verify`; a `Surface` is returned as it is.
    plane : str or array_like, default "xy"
        The plane that it was triangulated on, as for `triangulate`.
    triangulation : "own", optional
        With "own" the faces are taken as they are. By default they are first sought where the
        metadata of the mesh say, as in a regular triangulation by its weights.
    threads : int, optional
        As for `delaunay`.

    Returns
    -------
    Surface
        All rows of the mesh are its vertices; rows in no face are skipped by its triangulation. Of
        rows at one position and height the first counts, as in a file whose triangles share no
        vertices. The faces are those of the mesh, turned counter-clockwise, in the order of the
        triangulation. Triangles that the mesh does not have, as one that was trimmed, are masked.
        Sides that are not Delaunay, as along breaklines, become constraints of the triangulation:
        it has none if the mesh is Delaunay.

    Raises
    ------
    InputError
        The mesh has no faces; a face is vertical or its corners are on a line; rows of faces share
        a planar position at different heights; or faces overlap seen from above, or have a vertex
        inside a side: then the first face that conflicts with an earlier one is named, with the
        first of these. Some meshes that a format in single precision (GLB, glTF, STL) has rounded
        are such.
    UnsupportedTypeError
        No adapter can convert the object to a cloud.
    FormatError
        A file cannot be read.
    OSError
        A file does not exist or cannot be opened.

    See Also
    --------
    Surface.to_cloud : The way back.
    triangulate : Makes surfaces of clouds.
    verify : Checks a mesh without making a surface.

    Notes
    -----
    Whether faces overlap is decided exactly, in O(m log m) for m faces: `orient2d` tells that none
    has another orientation or no area, and a sweep over the boundary that they cover no place
    twice (M. I. Shamos and D. Hoey, 1976).

    Examples
    --------
    >>> import liftmesh
    >>> import numpy as np
    >>> points = [[0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1], [9, 2, 1]]
    >>> trimmed = liftmesh.triangulate(points).trim(max_edge=2)
    >>> as_surface(trimmed.to_cloud())
    <Surface of 2 triangles over 5 vertices>

    A mesh that is not Delaunay, and one that folds over:

    >>> kite = [[0, 0, 0], [4, -1, 1], [8, 0, 0], [4, 1, 1]]
    >>> mesh = liftmesh.Cloud(np.array(kite), faces=np.array([[0, 1, 2], [0, 2, 3]]))
    >>> as_surface(mesh).sample([[4, 0], [4, 0.5]])
    array([0. , 0.5])
    >>> as_surface(liftmesh.Cloud(mesh.points, faces=np.array([[0, 1, 2], [0, 1, 3]])))
    Traceback (most recent call last):
        ...
    liftmesh.errors.InputError: face 0, of the rows [0, 1, 2], and face 1, of ... overlap seen ...
    """
    if isinstance(mesh, Surface):
        return mesh
    if triangulation is not None:
        check_option("triangulation", triangulation, OwnFaces)
    return Surface(**fields_of(read_cloud(mesh), plane, triangulation, threads))
