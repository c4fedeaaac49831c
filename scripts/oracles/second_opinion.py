"""A second opinion on triangulations: an exact check in NumPy, apart from `liftmesh.verify`.

The tests compare `verify` with it, and the benchmark checks every program's triangles by it. A list
of triangles is a Delaunay triangulation of the points if they all turn counter-clockwise, fit
together edge to edge, use every position, satisfy Euler's relation, have a convex boundary, and if
every interior edge is locally Delaunay. Of cocircular points any triangulation passes. Edges that
are given, as pieces of constraints, must be there, and need not be Delaunay. It is no
oracle of signs: orientation and in-circle are liftmesh's public predicates, so what it shares with
the kernel is these, which other tests check against exact integers; the rest is its own.

The triangles are processed in blocks, so that a hundred million points can be checked in little
memory. Where a program gives no neighbours, they are found by sorting the edges.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from liftmesh import incircle, orient2d

BLOCK = 1 << 19  # triangles that are processed together

Points = NDArray[np.float64]
Triangles = NDArray[np.int32]
Edges = NDArray[np.int32]
Keys = NDArray[np.int64]


def flaw(
    points: Points,
    triangles: Triangles,
    neighbors: Triangles | None = None,
    pieces: Edges | None = None,
) -> str:
    """Describe what is wrong with the triangles; return an empty string if nothing is."""
    found = index_flaw(points, triangles) or orientation_flaw(points, triangles)
    fixed = np.empty(0, dtype=np.int64) if pieces is None else np.unique(keys(*pieces.T))
    if found:
        return found
    if neighbors is None:
        neighbors = find_neighbors(triangles)
    mismatch, wrong = edge_flaws(points, triangles, neighbors, fixed)
    if mismatch:
        return mismatch
    boundary = boundary_of(triangles, neighbors)
    return (
        euler_flaw(points, triangles, boundary)
        or boundary_flaw(points, boundary)
        or piece_flaw(triangles, fixed)
        or wrong
    )


def blocks(count: int) -> Iterator[slice]:
    for first in range(0, count, BLOCK):
        yield slice(first, min(first + BLOCK, count))


def index_flaw(points: Points, triangles: Triangles) -> str:
    """Check that every vertex is a row of the points."""
    if not len(triangles):
        return "no triangles"
    if triangles.min() < 0 or triangles.max() >= len(points):
        return "vertices that are no rows"
    return ""


def orientation_flaw(points: Points, triangles: Triangles) -> str:
    """Check that every triangle turns counter-clockwise."""
    flat = 0
    for block in blocks(len(triangles)):
        corners = np.moveaxis(points[triangles[block]], 1, 0)
        flat += np.count_nonzero(orient2d(*corners) <= 0)
    return f"{flat:,} triangles flat or clockwise" if flat else ""


def find_neighbors(triangles: Triangles) -> Triangles:
    """Find the triangle across the edge opposite to each vertex; -1 if there is none."""
    key = sides(triangles)
    order = np.argsort(key)
    first = np.flatnonzero(key[order[1:]] == key[order[:-1]])
    one, other = order[first], order[first + 1]
    neighbors = np.full(key.shape, -1, dtype=np.int32)
    neighbors[one], neighbors[other] = other // 3, one // 3
    return neighbors.reshape(-1, 3)


def sides(triangles: Triangles) -> Keys:
    """Return the key of the edge opposite to each vertex."""
    return keys(*(np.roll(triangles, -k, axis=1).reshape(-1) for k in (1, 2)))


def keys(start: NDArray[np.int32], end: NDArray[np.int32]) -> Keys:
    """Return a number for each edge, the same in both directions."""
    low, high = np.minimum(start, end).astype(np.int64), np.maximum(start, end)
    return low << 32 | high


def piece_flaw(triangles: Triangles, fixed: Keys) -> str:
    """Check that every piece is an edge."""
    missing = np.count_nonzero(~np.isin(fixed, sides(triangles))) if len(fixed) else 0
    return f"{missing:,} pieces missing" if missing else ""


def edge_flaws(
    points: Points, triangles: Triangles, neighbors: Triangles, fixed: Keys
) -> tuple[str, str]:
    """Count the interior edges that do not match their neighbour's, and those not Delaunay."""
    if neighbors.shape != triangles.shape or neighbors.max(initial=-1) >= len(triangles):
        return "neighbours that are no triangles", ""
    edges = mismatched = wrong = 0
    for own, edge, other in interior_edges(neighbors):
        start, end, apex = across(triangles[other], triangles[own, (edge + 1) % 3])
        back = np.take_along_axis(neighbors[other], apex, axis=1)
        there = np.take_along_axis(triangles[other], np.hstack((start, end, apex)), axis=1)
        here = triangles[own][:, [(edge + 1) % 3, (edge + 2) % 3]]
        edges += len(own)
        mismatched += np.count_nonzero((back[:, 0] != own) | (there[:, :2] != here).any(axis=1))
        corners = np.moveaxis(points[triangles[own]], 1, 0)
        inside = incircle(*corners, points[there[:, 2]]) > 0
        wrong += np.count_nonzero(~np.isin(keys(*here[inside].T), fixed))
    mismatched += abs(np.count_nonzero(neighbors >= 0) - 2 * edges)
    return (
        f"{mismatched:,} edges that do not fit together" if mismatched else "",
        f"{wrong:,} edges not Delaunay" if wrong else "",
    )


def interior_edges(neighbors: Triangles) -> Iterator[tuple[Triangles, int, Triangles]]:
    """Yield each interior edge once: triangles, the edge's index in them, triangles across it."""
    for block in blocks(len(neighbors)):
        rows = np.arange(block.start, block.stop, dtype=np.int32)
        for edge in range(3):
            once = neighbors[block, edge] > rows
            yield rows[once], edge, neighbors[block, edge][once]


def across(triangles: Triangles, start: NDArray[np.int32]) -> list[NDArray[np.int64]]:
    """Return the indices of an edge's start, end and apex in the triangles across it."""
    first = np.argmax(triangles == start[:, None], axis=1)[:, None]
    return [first, (first + 2) % 3, (first + 1) % 3]


def boundary_of(triangles: Triangles, neighbors: Triangles) -> Edges:
    """Return the edges without a neighbour."""
    row, edge = np.nonzero(neighbors < 0)
    return np.column_stack((triangles[row, (edge + 1) % 3], triangles[row, (edge + 2) % 3]))


def euler_flaw(points: Points, triangles: Triangles, boundary: Edges) -> str:
    """Check that every position is a vertex, and the number of triangles by Euler's relation."""
    used = np.zeros(len(points), dtype=bool)
    for block in blocks(len(triangles)):
        used[triangles[block]] = True
    vertices = np.count_nonzero(used)
    missing = positions(points) - vertices
    if missing:
        return f"{missing:,} points missing"
    excess = len(triangles) - (2 * vertices - 2 - len(boundary))
    return f"{excess:+,} triangles against Euler's relation" if excess else ""


def positions(points: Points) -> int:
    """Count the distinct rows, by sorting complex numbers: by x, then by y."""
    ordered = np.sort(np.ascontiguousarray(points).view(complex).reshape(-1))
    return 1 + np.count_nonzero(ordered[1:] != ordered[:-1])


def boundary_flaw(points: Points, boundary: Edges) -> str:
    """Check that the boundary is one cycle that never turns clockwise."""
    if not len(boundary):
        return "no boundary"
    following = dict(boundary.tolist())
    cycle = [start := int(boundary[0, 0])]
    while len(cycle) <= len(boundary) and following.get(cycle[-1], start) != start:
        cycle.append(following[cycle[-1]])
    if len(cycle) != len(boundary):
        return "the boundary is not one cycle"
    corners = points[cycle]
    turns = orient2d(corners, np.roll(corners, -1, axis=0), np.roll(corners, -2, axis=0))
    inward = np.count_nonzero(turns < 0)
    return f"the hull turns inward {inward:,} times" if inward else ""
