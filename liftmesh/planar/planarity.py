"""Whether triangles are a planar triangulation, and if not, which two conflict first.

Two triangles *conflict* if their interiors meet, or if a corner of one lies inside a side of the
other. Triangles of which no two conflict are a planar straight-line triangulation: of a domain of
any shape, with holes, in one piece or several.

The kernel tells in O(m log m) whether any two of m triangles conflict (`_core/verify`). All are
counter-clockwise. If no half-edge occurs twice, the number of triangles that cover a point changes
only where the point crosses the boundary, and nothing covers a point far away. So the triangles
overlap nowhere if a line that sweeps over the boundary meets no crossing, no vertex inside an edge,
and enters and leaves covered ground in turns.

What conflicts still does when more triangles come along. So the shortest beginning of the list that
has a conflict is found by bisection: its last triangle is the first that conflicts with an earlier
one, and is compared with each of these. Predicates decide, and no order but that of the list.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from liftmesh import _kernel
from liftmesh._typing import Floats, Mask, Reals, Rows
from liftmesh.base.options import as_threads
from liftmesh.planar.violations import MEANINGS
from liftmesh.predicates import orient2d

_KINDS = ("non_manifold_edges", "overlaps")
_PIECE = 1 << 18


class Conflict(NamedTuple):
    """The first triangle that conflicts with an earlier one, and the first of those."""

    earlier: int
    later: int
    row: int | None = None  # a corner of one that is inside a side of the other; None: they overlap


def turned(points: Reals, triangles: Rows) -> tuple[Rows, Mask]:
    """Make triangles counter-clockwise; and tell which have no area."""
    signs = np.empty(len(triangles), np.int8)
    for start in range(0, len(triangles), _PIECE):
        piece = slice(start, start + _PIECE)
        signs[piece] = orient2d(*np.moveaxis(points.take(triangles[piece], axis=0), 1, 0))
    is_clockwise = signs < 0
    if is_clockwise.any():
        triangles = np.where(is_clockwise[:, None], triangles[:, [0, 2, 1]], triangles)
    return triangles, signs == 0


def are_planar(points: Reals, triangles: Rows, threads: int | None = None) -> bool:
    """Tell whether no two triangles conflict; all are counter-clockwise."""
    found = _flaws(points, triangles, threads)
    return not (found["non_manifold_edges"] or found["overlaps"])


def is_triangulation(points: Reals, triangles: Rows, threads: int | None = None) -> bool:
    """Tell whether triangles have an area and do not conflict, whatever their orientation."""
    corners, is_flat = turned(points[:, :2], triangles)
    return not is_flat.any() and are_planar(points, corners, threads)


def is_locally_delaunay(points: Reals, triangles: Rows, threads: int | None = None) -> bool:
    """Tell whether no apex of a neighbour is inside the circle of a triangle."""
    return not _flaws(points, triangles, threads)["not_delaunay"]


def _flaws(points: Reals, triangles: Rows, threads: int | None) -> dict[str, int]:
    """Count what is wrong with triangles that are a part of a triangulation."""
    run = as_threads(threads, max(len(points), len(triangles)))
    nothing = np.empty(0), np.empty((0, 2), np.int32)
    corners = np.ascontiguousarray(triangles, np.int32)
    verdict = _kernel.verify(points, corners, True, *run, None, "delaunay", *nothing, True)
    return {kind: count for kind, (count, _) in zip(MEANINGS, verdict[8], strict=True)}


def first_conflict(points: Floats, triangles: Rows, threads: int | None = None) -> Conflict | None:
    """Find the first conflict of counter-clockwise triangles; None if they are planar."""
    fits, fails = 1, len(triangles)
    if fails < 2 or are_planar(points, triangles, threads):
        return None
    while fails - fits > 1:
        middle = (fits + fails) // 2
        if are_planar(points, triangles[:middle], threads):
            fits = middle
        else:
            fails = middle
    return _with_earlier(points, triangles, fits)


def _with_earlier(points: Floats, triangles: Rows, later: int) -> Conflict:
    """Find the first triangle that conflicts with a later one."""
    own = points.take(triangles[later], axis=0)
    low, high = own.min(axis=0), own.max(axis=0)
    for start in range(0, later, _PIECE):
        corners = points.take(triangles[start : min(start + _PIECE, later)], axis=0)
        is_near = (corners.min(axis=1) <= high).all(1) & (corners.max(axis=1) >= low).all(1)
        near = np.flatnonzero(is_near)
        others, itself = corners[near], np.broadcast_to(own, (len(near), 3, 2))
        is_over = ~(_are_beside(others, itself) | _are_beside(itself, others))
        inside, outer = _amid(itself, others), _amid(others, itself)
        if len(bad := np.flatnonzero(is_over | inside.any(1) | outer.any(1))):
            first = int(bad[0])
            earlier = start + int(near[first])
            if is_over[first]:
                return Conflict(earlier, later)
            of_other = inside[first].any()
            rows, which = (later, inside) if of_other else (earlier, outer)
            return Conflict(earlier, later, int(triangles[rows][which[first].argmax()]))
    raise AssertionError("triangles conflict, but no two of them: a bug of liftmesh")


def _sides(corners: Floats) -> tuple[Floats, Floats]:
    return corners, np.roll(corners, -1, axis=1)


def _signs(corners: Floats, others: Floats) -> NDArray[np.int8]:
    """On which side of each side of triangles the corners of others are, (k, 3, 3)."""
    tails, heads = _sides(corners)
    return orient2d(tails[:, :, None], heads[:, :, None], others[:, None])


def _are_beside(corners: Floats, others: Floats) -> Mask:
    """Whether a side of a triangle has all of the other one on its right, or on its line."""
    is_right = _signs(corners, others) <= 0
    are_beside: Mask = np.logical_or.reduce(np.logical_and.reduce(is_right, axis=2), axis=1)
    return are_beside


def _amid(corners: Floats, others: Floats) -> Mask:
    """Which corners of triangles are inside a side of others, (k, 3)."""
    tails, heads = (each[:, :, None] for each in _sides(others))
    places = corners[:, None]
    is_between = (places >= np.minimum(tails, heads)) & (places <= np.maximum(tails, heads))
    is_end = (places == tails).all(-1) | (places == heads).all(-1)
    is_amid = (_signs(others, corners) == 0) & is_between.all(-1) & ~is_end
    are_amid: Mask = np.logical_or.reduce(is_amid, axis=1)
    return are_amid
