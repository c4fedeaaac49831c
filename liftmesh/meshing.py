"""From a cloud to a surface: the main job, stage by stage.

The cloud becomes rows with what is known of each; the plane turns them into planar coordinates and
heights; the planar points are triangulated, exactly; where several rows share a planar position the
policy says which one carries the surface. The vertices are the caller's rows, all of them, in their
order: only the faces choose among them.
"""

from __future__ import annotations

import os
import time
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liftmesh import formats
from liftmesh.adapters import as_cloud
from liftmesh.arrays import check_finite, non_finite
from liftmesh.errors import InputError, NonFiniteError
from liftmesh.heights import Choice, check_policy, choose_carriers
from liftmesh.hulls import delaunay
from liftmesh.plane import Frame, resolve_plane
from liftmesh.surface import Report, Surface

if TYPE_CHECKING:
    from liftmesh.cloud import Cloud
    from liftmesh.heights import Policy
    from liftmesh.hulls import Method, NonFinite
    from liftmesh.lifting import ParaboloidVertex
    from liftmesh.triangulation import Triangulation

Rows = NDArray[np.int32]
Coordinates = NDArray[np.float64]


def triangulate(
    cloud: object,
    *,
    plane: Literal["xy", "fit"] | ArrayLike = "xy",
    duplicates: Policy = "first",
    nonfinite: NonFinite = "error",
    method: Method = "auto",
    q: ParaboloidVertex = "origin",
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
    check_policy(duplicates)
    _check_nonfinite(nonfinite)
    clock = _Clock()
    source = _read(cloud)
    clock.lap("read")
    if nonfinite == "error" and isinstance(plane, str) and plane == "fit":
        check_finite(source.points)  # a fit passes over such rows: the engine never saw them
    frame = resolve_plane(plane, source.points)
    planar, heights = frame.planar(source.points), frame.heights(source.points)
    clock.lap("plane")
    solution = _solve(source.points, planar, heights, nonfinite, method, q)
    clock.lap("triangulation")
    choice = choose_carriers(solution.duplicates, heights, planar, duplicates)
    faces = _faces(solution, choice)
    vertices = _vertices(source.points, heights, frame, choice)
    clock.lap("heights")
    return Surface(
        vertices=vertices,
        faces=faces,
        triangulation=solution,
        frame=frame,
        report=_report(solution, choice, duplicates, clock.seconds),
        colors=source.colors,
        normals=source.normals,
        attributes=source.attributes,
        metadata=source.metadata,
    )


class _Clock:
    """Seconds since the last lap, by name."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self._last = time.perf_counter()

    def lap(self, stage: str) -> None:
        now = time.perf_counter()
        self.seconds[stage] = now - self._last
        self._last = now


def _check_nonfinite(nonfinite: str) -> None:
    if nonfinite not in ("error", "skip"):
        raise InputError(f"nonfinite is {nonfinite!r}: give one of 'error', 'skip'")


def _read(cloud: object) -> Cloud:
    if isinstance(cloud, str | os.PathLike):
        return formats.read(cloud)
    return as_cloud(cloud)


def _solve(
    points: Coordinates,
    planar: Coordinates,
    heights: Coordinates,
    nonfinite: NonFinite,
    method: Method,
    q: ParaboloidVertex,
) -> Triangulation:
    """Triangulate the planar points; a row whose height is not finite is not finite either.

    The engine looks at planar coordinates itself, so only the heights take a pass here, and only
    where one is not finite is the array of planar coordinates copied, to mark that row.
    """
    if not np.isfinite(heights).all():
        if nonfinite == "error":
            raise _nonfinite_error(points, planar, heights)
        planar = planar.copy()
        planar[~np.isfinite(heights)] = np.nan
    try:
        solution = delaunay(planar, method=method, q=q, nonfinite=nonfinite)
    except NonFiniteError:
        raise _nonfinite_error(points, planar, heights) from None
    _refuse_overflow(points, solution.skipped)
    return solution


def _nonfinite_error(points: Coordinates, planar: Coordinates, heights: Coordinates) -> InputError:
    """Make the error for the first row that is not finite, in the caller's coordinates."""
    finite = np.isfinite(planar).all(axis=1) & np.isfinite(heights)
    row = int(np.argmin(finite))
    if np.isfinite(points[row]).all():
        return _overflow(row, points)
    return non_finite(row, points[row])


def _refuse_overflow(points: Coordinates, skipped: Rows) -> None:
    """Raise for a finite row that was skipped because its planar coordinates overflow."""
    overflown = skipped[np.isfinite(points[skipped]).all(axis=1)]
    if len(overflown):
        raise _overflow(int(overflown[0]), points)


def _overflow(row: int, points: Coordinates) -> InputError:
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


def _vertices(
    points: Coordinates, heights: Coordinates, frame: Frame, choice: Choice
) -> Coordinates:
    """Give the caller's rows, or a copy where the height of one changes."""
    moved = choice.moved
    if len(moved) == 0:
        return points
    vertices: Coordinates = points.copy()
    vertices[moved] = frame.raised(points[moved], heights[moved], choice.new_heights)
    return vertices


def _report(
    solution: Triangulation, choice: Choice, policy: str, seconds: dict[str, float]
) -> Report:
    overhangs = int(np.count_nonzero(choice.overhanging))
    left_out = np.concatenate([choice.left_out, solution.skipped])
    stand_ins = np.concatenate([choice.stand_ins, np.full_like(solution.skipped, -1)])
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
        stand_ins=stand_ins[order],
    )
