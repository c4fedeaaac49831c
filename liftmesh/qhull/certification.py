"""Whether simplices in any dimension are a Delaunay triangulation of points, in exact integers.

Coordinates are scaled to integers by one power of two, and every determinant is expanded in minors,
so that nothing is rounded, filtered or scaled otherwise. What is checked:

- no simplex is flat;
- every facet has a simplex on either side, or one only, and then no point is beyond its plane: so
  these are facets of the convex hull;
- the middle of the first simplex is in no other: as the number of simplices over a point changes at
  no facet inside the hull, they cover it once;
- no sphere of a simplex contains the apex of a neighbour: so the lifted simplices are a convex
  surface, and no sphere contains any point;
- every row is a corner, or at the position of one.

Each is also necessary, but for ties, where all choices count as right.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from liftmesh._typing import Array, Floats, Mask
from liftmesh.base.arrays import starts_of_runs
from liftmesh.base.options import counted

MOST_PRODUCTS = 10**8  # of integers: some ten seconds
_AT_ONCE = 1 << 20


class _Facets(NamedTuple):
    """Where the facets of simplices are, whose corners ascend: sorted by their corners."""

    simplex: Array
    apex: Array  # the place of the corner that is none of the facet
    is_first: Mask  # of those with the same corners


def faults_of(points: Floats, simplices: Array) -> list[str]:
    """Say what is wrong with simplices, each kind with its count; nothing of a triangulation."""
    _, first, same = np.unique(points + 0.0, axis=0, return_index=True, return_inverse=True)
    corners = np.sort(first[same.reshape(-1)][simplices], axis=1)
    facets = _facets_of(corners)
    products = _products(corners, facets, len(first))
    if products > MOST_PRODUCTS:
        limit = f"more than the {MOST_PRODUCTS:.0e} that are made"
        return [f"none is checked: this would take {products:.1e} products of integers, {limit}"]
    exact, _ = integers_of(points)
    side = _signs(determinants(_edges(exact, corners)))
    missing = len(first) - len(np.unique(corners))
    counts = {
        f"{counted(missing, 'point')} at no corner": missing,
        f"{counted(flat := int((side == 0).sum()), 'flat cell')}": flat,
    }
    if not flat:
        counts |= _faults_of_facets(exact, corners, side, facets, first)
    return [text for text, count in counts.items() if count]


def _products(corners: Array, facets: _Facets, points: int) -> int:
    """How many products the checks take, about."""
    m, width = corners.shape
    outer = 2 * int(facets.is_first.sum()) - m * width
    return int(m * width // 2 * width * 2**width + max(outer, 0) * points * (width - 1))


def integers_of(points: Floats) -> tuple[Array, int]:
    """Return coordinates as integers, and the power of two that scales them."""
    ratios = [value.as_integer_ratio() for value in points.reshape(-1).tolist()]
    scale = max(below for _, below in ratios)
    exact = np.array([above * (scale // below) for above, below in ratios], object)
    return exact.reshape(points.shape), scale


def rank_of(points: Floats) -> int:
    """Return the dimension of the least flat that holds all points."""
    exact, _ = integers_of(points)
    rows, rank, last = exact[1:] - exact[0], 0, 1
    while len(places := np.argwhere(rows != 0)):
        i, j = places[0]
        pivot = rows[i, j]
        rows = (rows * pivot - rows[:, [j]] * rows[i]) // last  # exact: Bareiss, 1968
        rank, last = rank + 1, pivot
    return rank


def determinants(rows: list[Any]) -> Any:
    """Return the determinants of matrices of integers, by the minors of the first rows."""
    minors: dict[tuple[int, ...], Any] = {(): 1}
    for size, row in enumerate(rows, 1):
        minors = {
            columns: sum(
                (-1) ** (size - 1 - k) * row[column] * minors[columns[:k] + columns[k + 1 :]]
                for k, column in enumerate(columns)
            )
            for columns in combinations(range(len(rows)), size)
        }
    return minors[tuple(range(len(rows)))]


def _signs(values: Array) -> Array:
    signs: Array = (values > 0).astype(np.int8) - (values < 0).astype(np.int8)
    return signs


def _edges(exact: Array, corners: Array) -> list[Any]:
    """Return the vectors from the first corner to the others, one row of columns each."""
    origin = exact[corners[:, 0]]
    return [(exact[corner] - origin).T for corner in corners.T[1:]]


def _facets_of(corners: Array) -> _Facets:
    m, width = corners.shape
    rows = np.concatenate([np.delete(corners, k, axis=1) for k in range(width)])
    order = np.lexsort(rows.T[::-1])
    return _Facets(order % m, order // m, starts_of_runs(rows[order]))


def _faults_of_facets(
    exact: Array, corners: Array, side: Array, facets: _Facets, points: Array
) -> dict[str, int]:
    starts = np.flatnonzero(facets.is_first)
    sizes = np.diff(starts, append=len(facets.is_first))
    # The orientation of a simplex if the corner opposite a facet, whose corners ascend, comes last.
    turned = side[facets.simplex] * (-1) ** (corners.shape[1] - 1 - facets.apex)
    pairs = starts[sizes == 2]
    is_between = turned[pairs] != turned[pairs + 1]
    wrong = int((sizes > 2).sum() + (~is_between).sum())
    pairs = pairs[is_between]
    apexes = corners[facets.simplex[pairs + 1], facets.apex[pairs + 1]]
    inside = _contained(exact, corners[facets.simplex[pairs]], side[facets.simplex[pairs]], apexes)
    beyond = _with_points_beyond(exact, corners, side, facets, starts[sizes == 1], points)
    over = _over_the_first(exact, corners, side)
    return {
        f"{counted(wrong, 'facet')} without one cell on either side": wrong,
        f"{counted(beyond, 'outer facet')} with points beyond": beyond,
        f"{counted(over, 'cell')} over the first": over,
        f"{counted(inside, 'sphere')} with the apex of a neighbour inside": inside,
    }


def _contained(exact: Array, corners: Array, side: Array, apexes: Array) -> int:
    """Count simplices whose sphere contains an apex."""
    if not len(corners):
        return 0
    rows = _edges(exact, np.column_stack([corners, apexes]))
    lifted = [[*row, sum(value * value for value in row)] for row in rows]
    return int((_signs(determinants(lifted)) * side < 0).sum())


def _with_points_beyond(
    exact: Array, corners: Array, side: Array, facets: _Facets, outer: Array, points: Array
) -> int:
    """Count facets of one simplex with points on their other side."""
    dimension = corners.shape[1] - 1
    count = 0
    for part in _parts(outer, max(_AT_ONCE // len(points), 1)):
        simplices = corners[facets.simplex[part]]
        apex = facets.apex[part][:, None]
        rows = simplices[np.arange(dimension + 1) != apex].reshape(-1, dimension)
        normal = _normals(_edges(exact, rows))
        heights = normal @ exact[points].T - (normal * exact[rows[:, 0]]).sum(axis=1)[:, None]
        own = side[facets.simplex[part]] * (-1) ** (dimension - facets.apex[part])
        count += int((_signs(heights) * own[:, None] < 0).any(axis=1).sum())
    return count


def _parts(values: Array, size: int) -> Iterator[Array]:
    for start in range(0, len(values), size):
        yield values[start : start + size]


def _normals(edges: list[Any]) -> Array:
    """Return the normals of facets: the cofactors of a last row."""
    dimension = len(edges) + 1
    return np.stack(
        [
            (-1) ** (dimension - 1 - k) * determinants([np.delete(row, k, axis=0) for row in edges])
            for k in range(dimension)
        ],
        axis=1,
    )


def _over_the_first(exact: Array, corners: Array, side: Array) -> int:
    """Count other simplices that contain the middle of the first, or have it on their border."""
    width = corners.shape[1]
    scaled = exact * width
    middle = exact[corners[0]].sum(axis=0)
    boxes = scaled[corners]
    near = ((boxes.min(axis=1) <= middle) & (boxes.max(axis=1) >= middle)).all(axis=1)
    near[0] = False
    some, is_over = corners[near], np.ones(int(near.sum()), np.bool_)
    with_middle = np.vstack([scaled, middle])
    for k in range(width):
        moved = some.copy()
        moved[:, k] = len(scaled)
        is_over &= _signs(determinants(_edges(with_middle, moved))) * side[near] >= 0
    return int(is_over.sum())
