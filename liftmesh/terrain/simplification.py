"""`simplify`: a surface of few triangles that keeps within a distance of every point.

The kernel chooses the vertices. The surface is triangulated of these alone, so it is the canonical
one of its points, and `deviation` checks it against every position, by arithmetic of its own.
"""

from __future__ import annotations

import sys
import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Progress, Rows
from liftmesh.base.options import Duplicates, NonFinite, as_count, as_switch, check_progress, shown
from liftmesh.crs.transformation import told_of
from liftmesh.errors import InputError
from liftmesh.io.metadata import lifted_by
from liftmesh.io.surface_rows import classes_of, read_rows
from liftmesh.planar.delaunay import solve
from liftmesh.planar.triangulation import Triangulation
from liftmesh.terrain.deviation import Deviation, deviation, of_rows
from liftmesh.terrain.meshes import as_surface
from liftmesh.terrain.positions import positions_of
from liftmesh.terrain.report import Report
from liftmesh.terrain.surface import Surface
from liftmesh.terrain.triangulate import triangulate

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.io.selection import ClassChoice

_WHOLE = "and a simplified surface covers their hull: simplify first, then trim"
_DONE_AFTER = {"triangulate": 0.1, "choose": 0.75, "check": 1.0}


def simplify(  # noqa: PLR0913 - options are keywords
    cloud: object,
    *,
    max_error: float | None = None,
    max_points: int | None = None,
    prune: bool = True,
    plane: Literal["xy", "xz", "yz", "fit"] | ArrayLike = "xy",
    duplicates: Duplicates = "first",
    nonfinite: NonFinite = "error",
    classes: ClassChoice = None,
    progress: Progress | None = None,
) -> Surface:
    """Approximate a terrain by few triangles, within a vertical distance of every point.

    Parameters
    ----------
    cloud : path, Cloud, Surface or object
        Anything that `triangulate` takes, as a raster of heights; or a `Surface`. Neither may be
        trimmed, since the triangles of a simplified surface fill its hull: simplify first, then
        trim.
    max_error : float, optional
        The vertical distance, in the units of the heights, that no position exceeds: exactly, not
        within rounding. 0 leaves out what lies on the planes of the others.
    max_points : int, optional
        The most vertices. Without `max_error`, as many are taken, or as few as lose nothing.
    prune : bool, default True
        Whether vertices are removed again that the distance does not need. On rasters this takes
        7 to 25 times as long as the choice of vertices. Few go where nearly every position counts.
    plane, duplicates, nonfinite, classes
        As for `triangulate`; not for a `Surface`, which has them already.
    progress : callable, optional
        As for `triangulate`.

    Returns
    -------
    Surface
        The rows that are left, in their order, with their colours, normals and named values, and
        the canonical Delaunay triangles of these. ``metadata["simplification"]`` has "rows" of the
        cloud, their distinct "positions", how many of these are "kept", "max_error" as asked for,
        "error", which no distance of a position exceeds, whether it is "within" `max_error`, and
        "merged": the largest distance of a row from the one that stands for its position.

    Raises
    ------
    InputError
        Neither `max_error` nor `max_points` is given, or one is invalid; there are fewer
        `max_points` than corners of the hull; the surface has weights, radii or a metric; or its
        faces, or those of a mesh, are only a part of the triangulation.
    NonFiniteError, DuplicateHeightError, DegenerateInputError, UnsupportedTypeError, FormatError
        As for `triangulate`.

    Notes
    -----
    Greedy insertion: M. Garland and P. S. Heckbert, "Fast polygonal approximation of terrains and
    height fields", 1995. From the corners of the hull on, the position with the largest distance,
    of several the lexicographically least, becomes a vertex, until none is beyond `max_error`. Then
    vertices are removed, one after the other the one without which distances grow least, as long as
    none is beyond it. What is left is exchanged, vertex by vertex, for the worst of the other
    positions that the removal of the vertex leaves, if none is beyond it then, and neighbours are
    removed that are not needed any longer. The worst position of each triangle becomes a vertex if
    then others can go, one by one or two at once; all this again, as long as it removes one in
    twenty. The result depends on the positions alone, not on the order of rows.

    Where heights and `max_error` are multiples of one step, as whole numbers, many positions of a
    raster may be at the bound exactly but for the rounding of the centres of its pixels to
    coordinates of the map, which puts them beyond it by as little as 1e-10. They count as beyond
    it. A bound that is greater by a millionth leaves up to a tenth of the triangles out.

    Examples
    --------
    >>> import numpy as np
    >>> x, y = (each.ravel() for each in np.meshgrid(np.arange(9.0), np.arange(9.0)))
    >>> ridge = simplify(np.column_stack([x, y, -abs(x - 4)]), max_error=0.0)
    >>> len(ridge.vertices), ridge.metadata["simplification"]["error"]
    (6, 0.0)
    """
    bound, most = _limits(max_error, max_points)
    prunes = as_switch("prune", prune)
    check_progress(progress)
    start = time.perf_counter()
    stages = _scaled(progress)
    given: Any = {"plane": plane, "duplicates": duplicates, "nonfinite": nonfinite}
    whole = _whole(cloud, classes, given, stages(0.0, _DONE_AFTER["triangulate"]))
    _check_member(whole)
    heights = whole.frame.heights(whole.vertices)
    used, positions, hull = positions_of(whole)
    between = stages(_DONE_AFTER["triangulate"], _DONE_AFTER["choose"])
    altitudes = np.ascontiguousarray(heights[used], np.float64) + 0.0
    chosen = _kernel.simplify(positions, altitudes, hull, bound, most, prunes, between)
    kept, is_within = np.sort(used[chosen[0]]), chosen[1]
    _check_count(len(kept), most)
    found = _surface(whole, kept, start)
    rest = stages(_DONE_AFTER["choose"], _DONE_AFTER["check"])
    checked = deviation(found.triangulation, heights[kept], positions, altitudes, bound, rest)
    _check_bound(checked, bound, is_within)
    told = {
        "rows": len(whole.vertices),
        "positions": len(used),
        "kept": len(kept),
        "max_error": max_error,
        "error": checked.largest,
        "within": is_within,
        "merged": of_rows(heights, whole.report.left_out, whole.report.representatives),
    }
    return replace(found, metadata={**whole.metadata, "simplification": told})


def _limits(max_error: object, max_points: object) -> tuple[float, int]:
    if max_error is None and max_points is None:
        raise InputError("neither max_error nor max_points is given: give one of them, or both")
    bound = 0.0
    if max_error is not None:
        is_number = isinstance(max_error, int | float | np.number)
        if not is_number or isinstance(max_error, bool) or not 0 <= max_error <= sys.float_info.max:  # type: ignore[operator]
            message = f"max_error is {shown(max_error)}: give a distance, in the units of heights"
            raise InputError(message)
        bound = float(max_error)  # type: ignore[arg-type]
    most = 0 if max_points is None else as_count("max_points", max_points, 3)
    return bound, min(most, _kernel.MOST_ROWS)


def _whole(
    cloud: object, classes: ClassChoice, given: dict[str, Any], progress: Progress | None
) -> Surface:
    """Return the surface that is to be simplified; raise if it does not cover its hull."""
    if isinstance(cloud, Surface) and classes is None:
        if cloud.mask is not None:
            raise InputError(f"the faces are only a part of the triangulation, {_WHOLE}")
        return cloud
    source = read_rows(cloud, classes)
    whole = triangulate(source, **given, progress=progress)
    if source.faces is not None and 0 < len(source.faces) < len(whole.faces):
        _check_faces(source, given["plane"])
    return whole


def _check_faces(mesh: Cloud, plane: Any) -> None:
    """Raise for a mesh of fewer faces than its points have, if it may have been trimmed."""
    try:
        as_surface(mesh, plane=plane)
    except InputError:  # the faces are others: the points count alone, as those of a cloud
        return
    if not lifted_by(mesh.metadata):
        raise InputError(
            f"the faces of the mesh are not the whole triangulation of its points, {_WHOLE}"
        )


def _check_member(surface: Surface) -> None:
    tri = surface.triangulation
    if hasattr(tri, "hidden") or tri.metric is not None:
        raise InputError(
            "the surface has weights, radii or a metric: a simplified one is a Delaunay "
            "triangulation; triangulate its vertices without them"
        )


def _check_bound(checked: Deviation, bound: float, is_within: bool) -> None:
    if is_within and checked.beyond:
        raise AssertionError(f"{checked.beyond} positions are beyond {bound}: a bug of liftmesh")


def _scaled(progress: Progress | None) -> Any:
    """Make callbacks that scale a stage's progress to the whole run."""

    def stage(first: float, last: float) -> Progress | None:
        if progress is None:
            return None
        return lambda done: progress(first + done * (last - first))

    return stage


def _check_count(found: int, most: int) -> None:
    if most and found > most:
        raise InputError(f"max_points is {most}, and the hull has {found} corners: give more")


def _surface(whole: Surface, kept: Rows, start: float) -> Surface:
    """Triangulate the rows that stay; their order and their coordinates are those of the whole."""
    cloud = whole.to_cloud().select(kept)
    triangulation = Triangulation(**solve(whole.triangulation.points[kept], nonfinite="error"))
    nothing = np.empty(0, np.int32)
    report = Report(
        rows=len(kept),
        used=len(kept),
        duplicates=0,
        overhangs=0,
        skipped=0,
        triangles=triangulation.nsimplex,
        policy=whole.report.policy,
        seconds={**whole.report.seconds, "simplify": time.perf_counter() - start},
        left_out=nothing,
        representatives=nothing,
        columns=whole.report.columns,
        color_depth=whole.report.color_depth,
        classes=classes_of(cloud.attributes),
        transformation=told_of(cloud.metadata),
    )
    return Surface(
        vertices=cloud.points,
        faces=triangulation.simplices,
        triangulation=triangulation,
        frame=whole.frame,
        report=report,
        colors=cloud.colors,
        normals=cloud.normals,
        attributes=cloud.attributes,
        metadata=whole.metadata,
        crs=whole.crs,
    )
