"""trimesh's convex hull of the lifted points, told in the caller's rows.

The planar coordinates are centred before they are lifted, which gives Qhull the shortest numbers
there are; z is |p - q|^2 of the caller's own coordinates. `trimesh.convex.convex_hull` then drops
what is no vertex, merges vertices that are closer than 1e-8 and numbers the rest anew, but it
never changes a coordinate: so its vertices are found again by exact equality of all three.
Centring rounds, and two rows may become one: such rows are counted, the lowest stands for all.

Which facets are lower ones is decided by Proposition 3.1: with the outward normal n of a facet,
n_z < 0. The sign of n_z is the planar orientation of the facet's three points, and is computed
exactly from the caller's coordinates. A facet whose planar points are collinear is vertical.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from liftmesh._typing import Floats, Indices, Rows
from liftmesh.comparison.background import interruptible
from liftmesh.optional import load
from liftmesh.planar.lifting import lift, resolve_q
from liftmesh.predicates import orient2d

_NO_FACETS = np.empty((0, 3), dtype=np.int32)


@dataclass(frozen=True, slots=True, eq=False)
class HullFacets:
    """The facets of trimesh's hull as rows of the caller.

    Parameters
    ----------
    facets : (h, 3) ndarray of int32
        All facets, wound as trimesh gives them: outward.
    lower : (l, 3) ndarray of int32
        The lower ones, counter-clockwise seen from above like ``Triangulation.simplices``.
    vertical : int
        Facets whose three planar points are collinear.
    coincident : int
        Rows that fall onto another row when they are centred and lifted in float64.
    seconds : float
        Time spent in ``trimesh.convex.convex_hull``.
    error : str, optional
        Why there is no hull, in trimesh's or Qhull's words.
    """

    facets: Rows
    lower: Rows
    vertical: int
    coincident: int
    seconds: float
    error: str | None = None


def trimesh_hull(points: Floats, rows: Rows, q: tuple[float, float]) -> HullFacets:
    """Build trimesh's convex hull of the lifted rows.

    Parameters
    ----------
    points : (n, 2) ndarray of float64
        The caller's planar points.
    rows : (k,) ndarray of int32
        The rows to lift: distinct, finite positions.
    q : (qx, qy)
        Vertex of the paraboloid.

    Returns
    -------
    HullFacets
        The facets, or the reason why there are none.

    Examples
    --------
    >>> points = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 2.0], [3.0, 3.0]])
    >>> hull = trimesh_hull(points, np.arange(4, dtype=np.int32), (0.0, 0.0))
    >>> len(hull.facets), len(hull.lower)
    (4, 2)
    """
    lifted = _lifted(points, rows, q)
    mesh, seconds, error = _convex_hull(lifted)
    if mesh is None:
        return HullFacets(_NO_FACETS, _NO_FACETS, 0, 0, seconds, error)
    match, coincident = _match(lifted, np.asarray(mesh.vertices))
    facets = rows[match[np.asarray(mesh.faces)]].reshape(-1, 3)
    n_z = orient2d(*points[facets.T])
    lower = np.ascontiguousarray(facets[n_z < 0][:, ::-1])
    return HullFacets(facets, lower, int((n_z == 0).sum()), coincident, seconds)


def _lifted(points: Floats, rows: Rows, q: tuple[float, float]) -> Floats:
    """Centred x and y beside z = |p - q|^2, without negative zeros."""
    centre = resolve_q("median", points[rows])
    with np.errstate(over="ignore", invalid="ignore"):
        z = lift(points[rows], q=q)[:, 2]
        lifted = np.column_stack([points[rows] - np.asarray(centre), z])
    return lifted + 0.0


def _convex_hull(lifted: Floats) -> tuple[Any, float, str | None]:
    """Build trimesh's hull (or None); tell the seconds it took and why it failed."""
    if not np.isfinite(lifted).all():
        return None, 0.0, "the lifted coordinates exceed float64"
    # Imported in the other thread too: trimesh swallows a Ctrl-C while it imports its own needs.
    convex, qhull = interruptible(lambda: (load("trimesh.convex"), load("scipy.spatial")))

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
        return (
            None,
            seconds,
            "trimesh keeps none of its facets: they are smaller than its tolerances",
        )
    return mesh, seconds, None


def _first_line(error: Exception) -> str:
    """Qhull's own sentence, without its error number and its pages of advice."""
    line = str(error).strip().splitlines()[0]
    return re.sub(r"^QH\d+ ", "", line).rstrip(". ")


def _match(lifted: Floats, vertices: Floats) -> tuple[Indices, int]:
    """For each vertex the first row of ``lifted`` equal to it, and how many rows repeat another.

    One stable sort of rows and vertices together puts equal triples side by side, rows first.
    """
    both = np.concatenate([lifted, vertices])
    order = np.lexsort((both[:, 2], both[:, 1], both[:, 0]))
    is_new = np.ones(len(both), dtype=bool)
    is_new[1:] = (both[order[1:]] != both[order[:-1]]).any(axis=1)
    first = order[is_new]
    group = np.empty(len(both), dtype=np.intp)
    group[order] = np.cumsum(is_new) - 1
    return first[group[len(lifted) :]], len(lifted) - len(first)
