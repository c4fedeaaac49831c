"""Is it the Delaunay triangulation? Exact answers about any program's triangles.

Orientation and in-circle signs are liftmesh's own, which the tests hold against exact integers.
Where points are cocircular any choice passes.
"""

from __future__ import annotations

import numpy as np
from bench_peers import Triangles
from distributions import Points
from numpy.typing import NDArray

from liftmesh import incircle, orient2d

Sides = NDArray[np.int64]


def flaw(points: Points, triangles: Triangles) -> str:
    """Say what is wrong with the triangles; an empty string if nothing is."""
    flat = np.count_nonzero(orient2d(*np.moveaxis(points[triangles], 1, 0)) <= 0)
    if flat:
        return f"{flat:,} triangles flat or clockwise"
    inner, apexes, border = split_sides(triangles)
    return (
        euler_flaw(points, triangles, border)
        or border_flaw(points, border)
        or circle_flaw(points, inner, apexes)
    )


def split_sides(triangles: Triangles) -> tuple[Sides, Sides, Sides]:
    """Pair the sides of all triangles: inner sides, their two apexes, sides without a partner."""
    start, end, apex = (np.roll(triangles, -k, axis=1).reshape(-1) for k in range(3))
    order = np.lexsort((np.minimum(start, end), np.maximum(start, end)))
    start, end, apex = start[order], end[order], apex[order]
    paired = (start[1:] == end[:-1]) & (end[1:] == start[:-1])
    first = np.flatnonzero(paired)
    alone = np.ones(len(start), dtype=bool)
    alone[first] = alone[first + 1] = False
    inner = np.column_stack((start[first], end[first]))
    apexes = np.column_stack((apex[first], apex[first + 1]))
    return inner, apexes, np.column_stack((start[alone], end[alone]))


def euler_flaw(points: Points, triangles: Triangles, border: Sides) -> str:
    """Every position is a vertex, and the number of triangles is what Euler's relation asks."""
    missing = len(np.unique(points, axis=0)) - len(np.unique(triangles))
    if missing:
        return f"{missing:,} points missing"
    excess = len(triangles) - (2 * len(np.unique(triangles)) - 2 - len(border))
    return f"{excess:+,} triangles against Euler's relation" if excess else ""


def border_flaw(points: Points, border: Sides) -> str:
    """The border is one cycle that never turns clockwise."""
    following = dict(border.tolist())
    cycle = [start := int(border[0, 0])]
    while len(cycle) <= len(border) and following.get(cycle[-1], start) != start:
        cycle.append(following[cycle[-1]])
    if len(cycle) != len(border):
        return "the border is not one cycle"
    corners = points[cycle]
    turns = orient2d(corners, np.roll(corners, -1, axis=0), np.roll(corners, -2, axis=0))
    inward = np.count_nonzero(turns < 0)
    return f"the hull turns inward {inward:,} times" if inward else ""


def circle_flaw(points: Points, inner: Sides, apexes: Sides) -> str:
    """No apex lies inside the circle of the triangle across an inner side."""
    a, b = np.moveaxis(points[inner], 1, 0)
    c, d = np.moveaxis(points[apexes], 1, 0)
    wrong = np.count_nonzero(incircle(a, b, c, d) > 0)
    return f"{wrong:,} sides not Delaunay" if wrong else ""
