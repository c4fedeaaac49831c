"""trimesh's convex hull of the lifted points, expressed in the caller's rows.

The planar coordinates passed to Qhull are centred, which makes them as small as possible; z is
|p - a|^2 of the caller's own coordinates. `trimesh.convex.convex_hull` then drops points that are
not a vertex, merges vertices closer than 1e-8 and renumbers the rest, but never changes a
coordinate: so its vertices are identified by exact equality of all three coordinates. Centring
rounds, and rows may coincide: such rows are counted, and the first represents them all.

Lower facets are identified by Proposition 3.1: n_z < 0 for the outward normal n of the facet. The
sign of n_z is the planar orientation of the facet's three points, and is computed exactly from the
caller's coordinates. A facet whose planar points are collinear is vertical.

Qhull lets other threads run but never checks for Ctrl-C, and takes minutes for a million points. It
runs in its own thread; an interrupted caller continues at once, and the thread, a daemon, ends with
Qhull or with the process. A process that goes down in order while the thread runs compiled code may
end by SIGABRT: the command line ends at once instead (`cli.signals`).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from threading import Thread
from time import perf_counter
from typing import Any, TypeVar

import numpy as np

from liftmesh._typing import Floats, Indices, Rows
from liftmesh.base.arrays import starts_of_runs
from liftmesh.optional import load
from liftmesh.planar.lifting import lift, resolve_apex
from liftmesh.predicates import orient2d

Result = TypeVar("Result")
_NO_FACETS = np.empty((0, 3), dtype=np.int32)


@dataclass(frozen=True, slots=True, eq=False)
class HullFacets:
    """The facets of trimesh's hull in the caller's rows."""

    facets: Rows  # outward
    lower: Rows  # counter-clockwise seen from above
    vertical: int
    coincident: int  # rows equal to another once centred and lifted
    seconds: float
    error: str | None = None  # why there is no hull


def trimesh_hull(points: Floats, rows: Rows, apex: tuple[float, float]) -> HullFacets:
    """Build trimesh's convex hull of the lifted rows."""
    lifted = _lifted(points, rows, apex)
    mesh, seconds, error = _convex_hull(lifted)
    if mesh is None:
        return HullFacets(_NO_FACETS, _NO_FACETS, 0, 0, seconds, error)
    match, coincident = _match(lifted, np.asarray(mesh.vertices))
    facets = rows[match[np.asarray(mesh.faces)]].reshape(-1, 3)
    n_z = orient2d(*points[facets.T])
    lower = np.ascontiguousarray(facets[n_z < 0][:, ::-1])
    return HullFacets(facets, lower, int((n_z == 0).sum()), coincident, seconds)


def convex_facets(points: Floats, rows: Rows) -> tuple[Rows, bool, float, str | None]:
    """Return the facets of trimesh's hull of rows in space, and whether they are watertight."""
    own = points[rows] + 0.0
    mesh, seconds, error = _convex_hull(own)
    if mesh is None:
        return _NO_FACETS, False, seconds, error
    match, _ = _match(own, np.asarray(mesh.vertices))
    return (
        rows[match[np.asarray(mesh.faces)]].reshape(-1, 3),
        bool(mesh.is_watertight),
        seconds,
        error,
    )


def _lifted(points: Floats, rows: Rows, apex: tuple[float, float]) -> Floats:
    """Return centred x and y with z = |p - a|^2, without negative zeros."""
    centre = resolve_apex("median", points[rows])
    with np.errstate(over="ignore", invalid="ignore"):
        z = lift(points[rows], apex=apex)[:, 2]
        lifted = np.column_stack([points[rows] - np.asarray(centre), z])
    return lifted + 0.0


def _convex_hull(lifted: Floats) -> tuple[Any, float, str | None]:
    """Build trimesh's hull; return it (or None), the seconds it took, and the error if any."""
    if not np.isfinite(lifted).all():
        return None, 0.0, "the lifted coordinates exceed float64"
    convex, qhull = load("trimesh.convex", extra="trimesh"), load("scipy.spatial", extra="scipy")

    def build() -> Any:
        with np.errstate(all="ignore"):
            return convex.convex_hull(lifted)

    start = perf_counter()
    try:
        mesh = interruptible(build)
    except qhull.QhullError as error:
        return None, perf_counter() - start, _first_line(error)
    seconds = perf_counter() - start
    if len(mesh.faces) == 0:
        return None, seconds, "trimesh drops all its facets: they are smaller than its tolerances"
    return mesh, seconds, None


def interruptible(work: Callable[[], Result]) -> Result:
    """Run a function in another thread and wait for it."""
    future: Future[Result] = Future()
    Thread(target=_run, args=(work, future), daemon=True).start()
    return future.result()


def _run(work: Callable[[], Result], future: Future[Result]) -> None:
    try:
        future.set_result(work())
    except BaseException as error:  # noqa: BLE001 - the waiting thread raises it
        future.set_exception(error)


def _first_line(error: Exception) -> str:
    """Return Qhull's message without the error number and the long explanation."""
    line = str(error).strip().splitlines()[0]
    return re.sub(r"^QH\d+ ", "", line).rstrip(". ")


def _match(lifted: Floats, vertices: Floats) -> tuple[Indices, int]:
    """Return the first row of ``lifted`` equal to each vertex, and the number of repeated rows."""
    # A stable sort of both together makes equal triples adjacent, rows first.
    both = np.concatenate([lifted, vertices])
    order = np.lexsort((both[:, 2], both[:, 1], both[:, 0]))
    is_new = starts_of_runs(both[order])
    first = order[is_new]
    group = np.empty(len(both), dtype=np.intp)
    group[order] = np.cumsum(is_new) - 1
    return first[group[len(lifted) :]], len(lifted) - len(first)
