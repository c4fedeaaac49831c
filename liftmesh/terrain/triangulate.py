"""From a cloud to a surface: the main job, stage by stage.

The cloud becomes rows with what is known of each; the plane turns them into planar coordinates and
heights; the planar points are triangulated, exactly; where several rows share a planar position the
policy says which one carries the surface. The vertices are the caller's rows, all of them, in their
order: only the faces choose among them.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Literal, TypedDict

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats, ParaboloidVertex, Progress, Rows
from liftmesh.arrays import check_finite, non_finite
from liftmesh.errors import InputError, NonFiniteError
from liftmesh.io.files import read_cloud
from liftmesh.options import Duplicates, Method, NonFinite, check_option
from liftmesh.planar.delaunay import delaunay
from liftmesh.terrain.equal_positions import Choice, choose_carriers
from liftmesh.terrain.frame import Frame, resolve_plane
from liftmesh.terrain.surface import Report, Surface

if TYPE_CHECKING:
    from liftmesh.planar.triangulation import Triangulation


# The share of the whole work that is done when a stage is: the triangulation is the bulk of it.
DONE_AFTER = {"read": 0.04, "plane": 0.05, "triangulation": 0.95, "heights": 0.99}


def triangulate(
    cloud: object,
    *,
    plane: Literal["xy", "fit"] | ArrayLike = "xy",
    duplicates: Duplicates = "first",
    nonfinite: NonFinite = "error",
    method: Method = "auto",
    q: ParaboloidVertex = "origin",
    threads: int | None = None,
    progress: Progress | None = None,
) -> Surface:
    """Triangulate a point cloud over a plane.

    Parameters
    ----------
    cloud : object
        An array-like of shape (n, 3), or (n, 2) for z = 0; a ``trimesh.PointCloud`` or
        ``trimesh.Trimesh`` (its vertices); an Open3D point cloud, legacy or tensor; a path; a
        `Cloud`; or what an installed adapter accepts. Never modified.
    plane : "xy", "fit", (3,) or (4, 4) array-like
        What the cloud is seen from above of: the xy plane; the plane that fits it best (its normal
        has n_z > 0; then n_y, then n_x); a normal; or the rigid transformation from space to the
        plane, as ``trimesh.geometry.plane_transform`` returns it. For all but ``"xy"`` the planar
        coordinates are rounded, and the result is exact relative to them.
    duplicates : {"first", "last", "lowest", "highest", "mean", "error"}
        Which of several rows of one planar position, at different heights, carries the surface:
        the first or last row; the lowest or highest one; the first one, raised to the mean of the
        different heights, nothing else of it changed; or none, as an error. Rows equal in height
        too are merged and counted.
    nonfinite : {"error", "skip"}
        What to do with rows that hold NaN or infinity: refuse them, or leave them unused.
    method : {"auto", "divide-and-conquer", "lf", "lfres", "lfres-indexed"}
        The engine, as `delaunay` names it: the same triangles by any.
    q : {"origin", "median"} or (2,) array_like
        The vertex of the paraboloid, in the coordinates of the plane; only "lf" and "lfres" use it.
    threads : int, optional
        How many threads the triangulation may take, from 1 to 1024; the surface is bit for bit the
        same for any number. By default the environment variable ``LIFTMESH_NUM_THREADS`` says it,
        or else one for each core is taken, and runs from several Python threads share them.
    progress : callable, optional
        Called with the share of the whole work that is done, a float from 0 to 1 that never falls:
        after each stage, some twenty times a second at most while divide and conquer is at work,
        and with 1.0 when all is done. It is called from the thread that called `triangulate`. What
        it raises ends the run and comes out of `triangulate` as it is; the cloud stays as it was,
        and nothing of the run remains.

    Returns
    -------
    Surface
        All rows as vertices, in their order; faces counter-clockwise seen from above; colours,
        normals and named values; and a report on what became of every row.

    Raises
    ------
    InputError
        An option is unknown, or the cloud has the wrong shape or type.
    NonFiniteError
        A row is not finite and ``nonfinite`` is ``"error"``.
    DuplicateHeightError
        Rows collide and ``duplicates`` is ``"error"``.
    DegenerateInputError
        Fewer than three distinct planar positions, or all on one line.
    UnsupportedTypeError
        No adapter turns the object into a cloud.
    FormatError
        The file is of an unknown format or broken.
    OSError
        The file is not there or cannot be opened.

    Examples
    --------
    >>> surface = triangulate([[0, 0, 5], [4, 0, 6], [0, 3, 7], [4, 3, 9], [4, 3, 8]])
    >>> surface.faces.shape
    (2, 3)
    >>> surface.report.overhangs, surface.report.left_out
    (1, array([4], dtype=int32))
    """
    check_option("duplicates", duplicates, Duplicates)
    check_option("nonfinite", nonfinite, NonFinite)
    check_option("method", method, Method)
    course = _Course(progress)
    source = read_cloud(cloud)
    course.lap("read")
    if nonfinite == "error" and isinstance(plane, str) and plane == "fit":
        check_finite(source.points)  # a fit passes over such rows: the engine never saw them
    frame = resolve_plane(plane, source.points)
    planar, heights = frame.planar(source.points), frame.heights(source.points)
    course.lap("plane")
    options: _Options = {"nonfinite": nonfinite, "method": method, "q": q, "threads": threads}
    solution = _solve(source.points, planar, heights, options, course.within("triangulation"))
    course.lap("triangulation")
    choice = choose_carriers(solution.duplicates, heights, planar, duplicates)
    faces = _faces(solution, choice)
    vertices = _vertices(source.points, heights, frame, choice)
    course.lap("heights")
    surface = Surface(
        vertices=vertices,
        faces=faces,
        triangulation=solution,
        frame=frame,
        report=_report(solution, choice, duplicates, course.seconds),
        colors=source.colors,
        normals=source.normals,
        attributes=source.attributes,
        metadata=source.metadata,
        crs=source.crs,
    )
    course.end()
    return surface


class _Options(TypedDict):
    """What the engine is told."""

    nonfinite: NonFinite
    method: Method
    q: ParaboloidVertex
    threads: int | None


class _Course:
    """How a run goes: seconds by stage, and the share of the whole work that is done."""

    def __init__(self, progress: Progress | None) -> None:
        self.seconds: dict[str, float] = {}
        self._progress = progress
        self._done = 0.0
        self._last = time.perf_counter()

    def lap(self, stage: str) -> None:
        """End a stage."""
        now = time.perf_counter()
        self.seconds[stage] = now - self._last
        self._last = now
        self._tell(DONE_AFTER[stage])

    def within(self, stage: str) -> Progress | None:
        """Make what a stage tells of itself, from 0 to 1, a share of the whole."""
        if self._progress is None:
            return None
        start, size = self._done, DONE_AFTER[stage] - self._done
        return lambda share: self._tell(start + share * size)

    def end(self) -> None:
        """Tell that all is done."""
        self._tell(1.0)

    def _tell(self, done: float) -> None:
        # Rounding may put the end of a stage, told from within it, an ulp beyond.
        self._done = max(self._done, done)
        if self._progress is not None:
            self._progress(self._done)


def _solve(
    points: Floats,
    planar: Floats,
    heights: Floats,
    options: _Options,
    progress: Progress | None,
) -> Triangulation:
    """Triangulate the planar points; a row whose height is not finite is not finite either.

    The engine looks at planar coordinates itself, so only the heights take a pass here, and only
    where one is not finite is the array of planar coordinates copied, to mark that row.
    """
    if not np.isfinite(heights).all():
        if options["nonfinite"] == "error":
            raise _nonfinite_error(points, planar, heights)
        planar = planar.copy()
        planar[~np.isfinite(heights)] = np.nan
    try:
        solution = delaunay(planar, **options, progress=progress)
    except NonFiniteError:
        if np.isfinite(planar).all():
            raise  # it is not about these points, but what `progress` raised
        raise _nonfinite_error(points, planar, heights) from None
    _refuse_overflow(points, solution.skipped)
    return solution


def _nonfinite_error(points: Floats, planar: Floats, heights: Floats) -> InputError:
    """Make the error for the first row that is not finite, in the caller's coordinates."""
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
        f"row {row}, {tuple(points[row].tolist())}, overflows in the coordinates of the plane: "
        "scale the cloud down"
    )


def _faces(solution: Triangulation, choice: Choice) -> Rows:
    """Put the triangles over the carriers; the engine's own array where that changes nothing."""
    changed = choice.kept != choice.carriers
    if not changed.any():
        return solution.simplices
    carrier_of = np.arange(solution.npoints, dtype=np.int32)
    carrier_of[choice.kept[changed]] = choice.carriers[changed]
    return carrier_of[solution.simplices]


def _vertices(points: Floats, heights: Floats, frame: Frame, choice: Choice) -> Floats:
    """Give the caller's rows, or a copy where the height of one changes."""
    moved = choice.moved
    if len(moved) == 0:
        return points
    vertices: Floats = points.copy()
    vertices[moved] = frame.raised(points[moved], heights[moved], choice.new_heights)
    return vertices


def _report(
    solution: Triangulation, choice: Choice, policy: str, seconds: dict[str, float]
) -> Report:
    overhangs = int(np.count_nonzero(choice.overhanging))
    left_out = np.concatenate([choice.left_out, solution.skipped])
    representatives = np.concatenate([choice.representatives, np.full_like(solution.skipped, -1)])
    order = np.argsort(left_out)
    return Report(
        rows=solution.npoints,
        used=solution.npoints - len(left_out),
        duplicates=len(choice.left_out) - overhangs,
        overhangs=overhangs,
        skipped=len(solution.skipped),
        triangles=len(solution.simplices),
        policy=policy,
        seconds=seconds,
        left_out=left_out[order],
        representatives=representatives[order],
    )
