"""The canonical lower hull in exact integers, by its definition, and what every hull must be.

Nothing here is shared with the program: every triple of points is held against every other point.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from oracles import planar as oracle

import liftmesh

Points = NDArray[np.float64]
Facets = set[tuple[int, ...]]


def expected_facets(points: ArrayLike) -> Facets:
    """The canonical facets as sorted triples of rows: every triple, every other point, in integers.

    Each axis has its own unit, which changes no side. Of the rows at one planar position the lowest
    counts, the first of several. Each point is raised by a concrete tiny amount, far more for one
    that is later by x, then y.
    """
    columns = np.asarray(points, dtype=np.float64).T
    x, y, z = ([value for (value,) in oracle.exact([[v] for v in axis])] for axis in columns)
    lowest: dict[oracle.Point, tuple[int, int]] = {}
    for row, (xy, height) in enumerate(zip(zip(x, y, strict=True), z, strict=True)):
        lowest[xy] = min(lowest.get(xy, (height, row)), (height, row))
    raised = raise_apart({xy: height for xy, (height, _) in lowest.items()})
    return {
        tuple(sorted(lowest[xy][1] for xy in triple))
        for triple in combinations(sorted(lowest), 3)
        if oracle.cross(*triple) != 0
        and oracle.is_lower_facet(oracle.counter_clockwise(*triple), raised)
    }


def raise_apart(heights: dict[oracle.Point, int]) -> dict[oracle.Point, int]:
    """Heights in units so small that all rises, the powers of a large base, stay below one."""
    width = max(abs(value) for xy in heights for value in xy) * 2 + 1
    base = 1 << (8 * width * width).bit_length()
    unit = base ** (len(heights) + 1)
    return {xy: heights[xy] * unit + base**rank for rank, xy in enumerate(sorted(heights))}


def facets(hull: liftmesh.LowerHull) -> Facets:
    """Facets as sorted triples of rows; none may come twice."""
    found = [tuple(sorted(face)) for face in hull.faces.tolist()]
    assert len(set(found)) == len(found)
    return set(found)


def assert_whole(hull: liftmesh.LowerHull) -> None:
    """Counter-clockwise facets with mutual neighbours tile the planar hull once."""
    xy, faces, neighbors = hull.vertices[:, :2], hull.faces, hull.neighbors
    assert neighbors is not None
    assert faces.dtype == neighbors.dtype == np.int32
    assert faces.shape == neighbors.shape == (len(faces), 3)
    assert (liftmesh.orient2d(*(xy[faces[:, k]] for k in range(3))) > 0).all()
    side = np.stack((np.roll(faces, -1, axis=1), np.roll(faces, -2, axis=1)), axis=2)
    row, corner = np.nonzero(neighbors >= 0)
    there = neighbors[row, corner]
    back = neighbors[there] == row[:, None]
    np.testing.assert_array_equal(back.sum(axis=1), 1)
    np.testing.assert_array_equal(side[there][back], side[row, corner][:, ::-1])
    rim = side[neighbors == -1]
    assert len(faces) == 2 * len(np.unique(faces)) - 2 - len(rim)
    assert_rim(xy, rim)


def assert_rim(xy: Points, rim: NDArray[np.int32]) -> None:
    """One cycle that never turns clockwise, with no point to its right."""
    following = dict(rim.tolist())
    cycle = [int(rim[0, 0])]
    while (after := following[cycle[-1]]) != cycle[0]:
        cycle.append(after)
    assert len(cycle) == len(rim) == len(following)
    corners = xy[cycle]
    turns = liftmesh.orient2d(corners, np.roll(corners, -1, axis=0), np.roll(corners, -2, axis=0))
    assert (turns >= 0).all()
    assert (turns > 0).any()
    for p in (xy[axis.argmin()] for axis in (*xy.T, *-xy.T)):
        assert (liftmesh.orient2d(corners, np.roll(corners, -1, axis=0), p) >= 0).all()


def coordinate_facets(points: Points, triples: ArrayLike) -> list[list[float]]:
    """Facets as sorted rows of coordinates, each point of a facet in order too."""
    distinct, rank = np.unique(points + 0.0, axis=0, return_inverse=True)
    ordered = np.sort(rank.reshape(-1)[np.asarray(triples)], axis=1)
    ordered = ordered[np.lexsort(ordered.T[::-1])]
    return distinct[ordered].reshape(-1, 9).tolist()
