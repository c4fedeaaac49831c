"""Is it the Delaunay triangulation? Exact answers about any program's triangles.

Orientation and in-circle signs are liftmesh's own, which the tests hold against exact integers.
Where points are cocircular any choice passes. The triangles are looked at in pieces, so that a
hundred million points can be checked where they fit; a program that names no neighbours has its
sides paired by a sort first.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from liftmesh import incircle, orient2d

PIECE = 1 << 19  # triangles that are looked at together
Points = NDArray[np.float64]
Triangles = NDArray[np.int32]
Sides = NDArray[np.int32]


def flaw(points: Points, triangles: Triangles, neighbors: Triangles | None = None) -> str:
    """Say what is wrong with the triangles; an empty string if nothing is."""
    found = row_flaw(points, triangles) or corner_flaw(points, triangles)
    if found:
        return found
    if neighbors is None:
        neighbors = pair_sides(triangles)
    loose, wrong = side_flaws(points, triangles, neighbors)
    if loose:
        return loose
    border = border_of(triangles, neighbors)
    return euler_flaw(points, triangles, border) or border_flaw(points, border) or wrong


def pieces(count: int) -> Iterator[slice]:
    for first in range(0, count, PIECE):
        yield slice(first, min(first + PIECE, count))


def row_flaw(points: Points, triangles: Triangles) -> str:
    """Every corner is a row of the points."""
    if not len(triangles):
        return "no triangles"
    if triangles.min() < 0 or triangles.max() >= len(points):
        return "corners that are no rows"
    return ""


def corner_flaw(points: Points, triangles: Triangles) -> str:
    """Every triangle turns counter-clockwise."""
    flat = 0
    for piece in pieces(len(triangles)):
        corners = np.moveaxis(points[triangles[piece]], 1, 0)
        flat += np.count_nonzero(orient2d(*corners) <= 0)
    return f"{flat:,} triangles flat or clockwise" if flat else ""


def pair_sides(triangles: Triangles) -> Triangles:
    """Find the triangle across each side, that is opposite each corner; -1 where there is none."""
    start, end = (np.roll(triangles, -k, axis=1).reshape(-1).astype(np.int64) for k in (1, 2))
    key = np.minimum(start, end) << 32 | np.maximum(start, end)
    order = np.argsort(key)
    first = np.flatnonzero(key[order[1:]] == key[order[:-1]])
    one, other = order[first], order[first + 1]
    neighbors = np.full(key.shape, -1, dtype=np.int32)
    neighbors[one], neighbors[other] = other // 3, one // 3
    return neighbors.reshape(-1, 3)


def side_flaws(points: Points, triangles: Triangles, neighbors: Triangles) -> tuple[str, str]:
    """Say which inner sides do not fit together, and which are not Delaunay."""
    if neighbors.shape != triangles.shape or neighbors.max(initial=-1) >= len(triangles):
        return "neighbours that are no triangles", ""
    sides = loose = wrong = 0
    for own, side, other in inner_sides(neighbors):
        start, end, apex = across(triangles[other], triangles[own, (side + 1) % 3])
        back = np.take_along_axis(neighbors[other], apex, axis=1)
        there = np.take_along_axis(triangles[other], np.hstack((start, end, apex)), axis=1)
        here = triangles[own][:, [(side + 1) % 3, (side + 2) % 3]]
        sides += len(own)
        loose += np.count_nonzero((back[:, 0] != own) | (there[:, :2] != here).any(axis=1))
        corners = np.moveaxis(points[triangles[own]], 1, 0)
        wrong += np.count_nonzero(incircle(*corners, points[there[:, 2]]) > 0)
    loose += abs(np.count_nonzero(neighbors >= 0) - 2 * sides)
    return (
        f"{loose:,} sides that do not fit together" if loose else "",
        f"{wrong:,} sides not Delaunay" if wrong else "",
    )


def inner_sides(neighbors: Triangles) -> Iterator[tuple[Triangles, int, Triangles]]:
    """Go through the inner sides, each once: a triangle, the side's place, the one across."""
    for piece in pieces(len(neighbors)):
        rows = np.arange(piece.start, piece.stop, dtype=np.int32)
        for side in range(3):
            once = neighbors[piece, side] > rows
            yield rows[once], side, neighbors[piece, side][once]


def across(triangles: Triangles, start: NDArray[np.int32]) -> list[NDArray[np.int64]]:
    """Give the places of a side's start, end and apex in the triangles that run along it back."""
    first = np.argmax(triangles == start[:, None], axis=1)[:, None]
    return [first, (first + 2) % 3, (first + 1) % 3]


def border_of(triangles: Triangles, neighbors: Triangles) -> Sides:
    """Collect the sides without a neighbour."""
    row, side = np.nonzero(neighbors < 0)
    return np.column_stack((triangles[row, (side + 1) % 3], triangles[row, (side + 2) % 3]))


def euler_flaw(points: Points, triangles: Triangles, border: Sides) -> str:
    """Every position is a vertex, and the number of triangles is what Euler's relation asks."""
    used = np.zeros(len(points), dtype=bool)
    for piece in pieces(len(triangles)):
        used[triangles[piece]] = True
    vertices = np.count_nonzero(used)
    missing = positions(points) - vertices
    if missing:
        return f"{missing:,} points missing"
    excess = len(triangles) - (2 * vertices - 2 - len(border))
    return f"{excess:+,} triangles against Euler's relation" if excess else ""


def positions(points: Points) -> int:
    """Count the distinct rows; complex numbers are sorted by x, then by y."""
    ordered = np.sort(np.ascontiguousarray(points).view(complex).reshape(-1))
    return 1 + np.count_nonzero(ordered[1:] != ordered[:-1])


def border_flaw(points: Points, border: Sides) -> str:
    """The border is one cycle that never turns clockwise."""
    if not len(border):
        return "no border"
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
