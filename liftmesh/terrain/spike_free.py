"""The rows of a spike-free surface over canopies and roofs, by a freeze distance.

A pulse that slips between leaves returns from deep inside a crown, and makes a spike in a surface
of first returns. So layers of rows come from above: each is triangulated with what is kept of those
above it. Where all three sides of a triangle are shorter than the freeze distance, it is *frozen*:
rows further down that lie in it, or on its sides, are left out. What a lower row does to the
circles of the triangulation may still turn the side of a frozen triangle; no row comes into it.

The result depends on the set of positions alone: layers count from the highest row, and of rows at
one planar position the highest counts.

Source: A. Khosravipour, A. K. Skidmore and M. Isenburg, Generating spike-free digital surface
models using LiDAR raw point clouds: a new approach for forestry applications, International Journal
of Applied Earth Observation and Geoinformation 52 (2016), 104-114. There rows come one by one, a
triangle is frozen as soon as it appears (or some height later, the insertion buffer), and stays.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Array, Floats, Integers, Mask, Progress
from liftmesh.base.arrays import starts_of_runs
from liftmesh.errors import DegenerateInputError, InputError, Option
from liftmesh.planar.delaunay import delaunay
from liftmesh.predicates import orient2d

if TYPE_CHECKING:
    from liftmesh.planar.triangulation import Triangulation

_MOST_LAYERS = 10_000
_DEEPEST = float(2**52)  # beyond, doubles do not tell layers apart


def spike_free_rows(
    points: Floats, distance: float, buffer: float, progress: Progress | None
) -> Integers:
    """Choose the rows of finite points that are kept, by a freeze distance and a layer's height."""
    plane = points[:, :2] + 0.0
    order = np.lexsort((-points[:, 2], plane[:, 1], plane[:, 0]))
    left = order[starts_of_runs(plane[order])]
    layers = _layers(points[left, 2], buffer)
    order = np.argsort(layers, kind="stable")
    left, layers = left[order], layers[order]
    _check_number(layers)
    kept, count = left[:0], len(left)
    while len(left):
        end = int(np.searchsorted(layers, layers[0], side="right"))
        kept = np.concatenate([kept, left[:end]])
        left, layers = left[end:], layers[end:]
        is_left = ~_are_frozen(plane[kept], plane[left], distance)
        left, layers = left[is_left], layers[is_left]
        if progress is not None:
            progress(1 - len(left) / count)
    return np.sort(kept)


def _layers(heights: Floats, buffer: float) -> Floats:
    """Number the layers of heights, from the highest on."""
    with np.errstate(over="ignore"):
        depths = (heights.max(initial=-np.inf) - heights) / buffer
    layers: Floats = np.minimum(np.floor(depths), _DEEPEST)
    return layers


def _check_number(layers: Floats) -> None:
    count = 1 + np.count_nonzero(np.diff(layers))
    if count > _MOST_LAYERS:
        raise InputError(
            f"rows are in {count:,} layers, each of which is triangulated, and at most "
            f"{_MOST_LAYERS:,} are: give a larger {Option('spike_buffer', ...)}"
        )


def _are_frozen(plane: Floats, places: Floats, distance: float) -> Mask:
    """Tell which places lie in triangles, or on sides of some, whose sides are all shorter."""
    none = np.zeros(len(places), np.bool_)
    if not len(places):
        return none
    try:
        solved = delaunay(plane)
    except DegenerateInputError:
        return none
    corners = plane[solved.simplices]
    sides = corners - np.roll(corners, 1, axis=1)
    is_frozen = np.append((np.hypot(*sides.T) < distance).all(axis=0), False)  # none beyond
    found = solved.find_simplex(places)
    are_frozen: Mask = is_frozen[found]
    _add_sides(solved, is_frozen, places, found, are_frozen)
    return are_frozen


def _add_sides(
    solved: Triangulation, is_frozen: Mask, places: Floats, found: Array, are_frozen: Mask
) -> None:
    """Add the places on sides that the triangle found shares with a frozen one."""
    beyond = is_frozen[solved.neighbors]
    asked = np.flatnonzero((found >= 0) & ~are_frozen & beyond[found].any(axis=1))
    corners = solved.points[solved.simplices[found[asked]]]
    for k in range(3):
        start, end = corners[:, (k + 1) % 3], corners[:, (k + 2) % 3]
        is_on = orient2d(start, end, places[asked]) == 0
        are_frozen[asked] |= is_on & beyond[found[asked], k]
