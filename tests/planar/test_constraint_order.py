"""The order of rows, edges and polygons, and their directions, change nothing in large inputs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.random import Generator

import liftmesh
from liftmesh import ConstrainedTriangulation, constrained_delaunay

SIDE = 100
Numbers = np.ndarray[Any, Any]


def jittered(rng: Generator) -> Numbers:
    """A point in each cell of a grid."""
    return np.indices((SIDE, SIDE)).reshape(2, -1).T + rng.random((SIDE * SIDE, 2)) * 0.9


def turned_about(edges: Numbers, rng: Generator) -> tuple[Numbers, Numbers]:
    """Edges in another order, some of them reversed, and which each was."""
    order = rng.permutation(len(edges))
    return rng.permuted(edges[order], axis=1), order


def crossings(points: Numbers, edges: Numbers) -> liftmesh.CrossingError:
    with pytest.raises(liftmesh.CrossingError) as caught:
        constrained_delaunay(points, edges)
    return caught.value


def test_all_crossings_are_found_of_sides_that_come_first() -> None:
    """A triangle between two columns, whose points take the edges across them away."""
    n = 700
    along = np.arange(n) / n
    columns = np.column_stack([np.repeat([0.0, 1.0], n), np.tile(along, 2)])
    corners = np.array([[0.1, 0.1013], [0.8, 0.2012], [0.5, 0.9011]])
    across = np.column_stack([np.arange(n), np.arange(n) + n])
    sides = 2 * n + np.array([[0, 1], [1, 2], [0, 2]])
    points, edges = np.concatenate([columns, corners]), np.concatenate([across, sides])
    expected = {
        (k, n + side)
        for side, (tail, head) in enumerate((sides - 2 * n).tolist())
        for k in range(n)
        if (corners[tail, 1] - along[k]) * (corners[head, 1] - along[k]) < 0
    }
    for given in (edges, edges[::-1]):
        found = {tuple(sorted(pair)) for pair in crossings(points, given).crossings.tolist()}
        if given is not edges:
            found = {(len(edges) - 1 - one, len(edges) - 1 - other) for other, one in found}
        assert found == expected


@pytest.mark.slow
def test_crossings_are_the_same_and_in_one_order() -> None:
    rng = np.random.default_rng(61)
    points = jittered(rng)
    cells = np.indices((SIDE, SIDE)).reshape(2, -1)
    to = np.clip(cells + rng.integers(-3, 4, cells.shape), 0, SIDE - 1)
    edges = np.stack([np.arange(SIDE * SIDE), to[0] * SIDE + to[1]], axis=1)
    one = crossings(points, edges)
    assert len(one.crossings) > 10_000
    again, order = turned_about(edges, rng)
    other = crossings(points, again)
    np.testing.assert_array_equal(other.rows, one.rows)
    np.testing.assert_array_equal(other.places, one.places)
    assert {frozenset(pair) for pair in order[other.crossings].tolist()} == {
        frozenset(pair) for pair in one.crossings.tolist()
    }
    rows = rng.permutation(len(points))
    moved = crossings(points[rows], np.argsort(rows)[again])
    pairs = [
        {frozenset(map(frozenset, pair)) for pair in found.reshape(-1, 2, 2).tolist()}
        for found in (one.rows, rows[moved.rows])
    ]
    assert pairs[0] == pairs[1]


def same(one: ConstrainedTriangulation, other: ConstrainedTriangulation) -> None:
    for name in ("neighbors", "is_constrained", "regions"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    np.testing.assert_array_equal(one.points[one.simplices], other.points[other.simplices])


@pytest.mark.slow
@pytest.mark.parametrize("carve", [None, "outside", "holes"])
def test_regions_and_what_is_left_are_the_same_for_edges(carve: Any) -> None:
    rng = np.random.default_rng(62)
    points = jittered(rng)
    plain = liftmesh.delaunay(points)
    x, y = points[plain.simplices].mean(axis=1).T
    kind = np.rint(np.sin(x / 3) + np.cos(y / 4)).astype(int)
    t, k = np.nonzero((plain.neighbors >= 0) & (kind[plain.neighbors] != kind[:, None]))
    edges = np.stack([plain.simplices[t, (k + 1) % 3], plain.simplices[t, (k + 2) % 3]], axis=1)
    options: dict[str, Any] = {"carve": carve, "order": "canonical"}
    one = constrained_delaunay(points, edges, **options, seeds=points[[5050]] + 0.01)
    assert one.regions.max() > 20
    rows = rng.permutation(len(points))
    again, order = turned_about(edges, rng)
    other = constrained_delaunay(
        points[rows], np.argsort(rows)[again], **options, seeds=points[[5050]] + 0.01, threads=2
    )
    same(one, other)
    found = [
        {
            frozenset(ends): frozenset(which[tri.inputs_of(k)].tolist())
            for k, ends in enumerate(names[tri.constraints].tolist())
        }
        for tri, names, which in (
            (one, np.arange(len(rows)), np.arange(len(edges))),
            (other, rows, order),
        )
    ]
    assert found[0] == found[1]


@pytest.mark.slow
@pytest.mark.parametrize("carve", ["outside", "holes"])
def test_what_is_left_is_the_same_for_polygons(carve: Any) -> None:
    """Squares with holes, some of them side by side, their rings turned, begun elsewhere."""
    rng = np.random.default_rng(63)
    points = rng.random((SIDE * SIDE, 2)) * SIDE
    square = np.array([[0, 0], [2, 0], [2, 2], [0, 2]])
    corners = np.argwhere(rng.random((SIDE // 2 - 1, SIDE // 2 - 1)) < 0.6) * 2.0
    polygons = [[square + corner, square / 4 + corner + 0.5] for corner in corners]
    one = constrained_delaunay(points, polygons=polygons, carve=carve, order="canonical")
    turned = [
        [np.roll(ring, int(rng.integers(4)), axis=0)[:: rng.choice([-1, 1])] for ring in rings]
        for rings in (polygons[k] for k in rng.permutation(len(polygons)))
    ]
    other = constrained_delaunay(
        points[rng.permutation(len(points))], polygons=turned, carve=carve, order="canonical"
    )
    same(one, other)
    a, b, c = one.points[one.simplices].transpose(1, 0, 2)
    u, v = b - a, c - a
    left = float((u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum()) / 2
    if carve == "holes":  # else what squares enclose between them is left, too
        assert left == pytest.approx(len(polygons) * 3.75)
