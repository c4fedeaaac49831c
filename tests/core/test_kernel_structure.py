"""What surrounds the triangles: neighbours, hull, duplicates, and rows that are no vertex."""

from __future__ import annotations

import numpy as np
import pytest
from clouds import FAMILIES
from numpy.typing import NDArray

import liftmesh


@pytest.fixture(scope="module", params=[pytest.param(name, id=name) for name in FAMILIES])
def triangulation(request: pytest.FixtureRequest) -> liftmesh.Triangulation:
    points = FAMILIES[request.param](1500, np.random.default_rng(3))
    return liftmesh.delaunay(points)


def sides(triangulation: liftmesh.Triangulation) -> NDArray[np.int32]:
    """The side opposite each corner, in its triangle's direction: shape (m, 3, 2)."""
    simplices = triangulation.simplices
    return np.stack((np.roll(simplices, -1, axis=1), np.roll(simplices, -2, axis=1)), axis=2)


def test_types_and_shapes(triangulation: liftmesh.Triangulation) -> None:
    m = len(triangulation.simplices)
    assert triangulation.simplices.shape == triangulation.neighbors.shape == (m, 3)
    for name in ("simplices", "neighbors", "convex_hull", "coplanar", "duplicates"):
        values = getattr(triangulation, name)
        assert values.dtype == np.int32, name
        assert values.flags.c_contiguous, name


def test_neighbors_lie_opposite_their_corner(triangulation: liftmesh.Triangulation) -> None:
    neighbors, side = triangulation.neighbors, sides(triangulation)
    row, corner = np.nonzero(neighbors >= 0)
    there = neighbors[row, corner]
    back = neighbors[there] == row[:, None]
    np.testing.assert_array_equal(back.sum(axis=1), 1)
    np.testing.assert_array_equal(side[there][back], side[row, corner][:, ::-1])


def test_sides_without_neighbor_are_the_hull(triangulation: liftmesh.Triangulation) -> None:
    open_sides = sides(triangulation)[triangulation.neighbors == -1]
    hull = triangulation.convex_hull
    edges = zip(hull.tolist(), np.roll(hull, -1).tolist(), strict=True)
    assert {*map(tuple, open_sides.tolist())} == {*edges}
    assert len(open_sides) == len(triangulation.convex_hull)


def test_the_hull_is_one_counter_clockwise_cycle(triangulation: liftmesh.Triangulation) -> None:
    hull, points = triangulation.convex_hull, triangulation.points
    assert len(np.unique(hull)) == len(hull)
    corners = points[hull]
    turns = liftmesh.orient2d(corners, np.roll(corners, -1, axis=0), np.roll(corners, -2, axis=0))
    assert (turns >= 0).all()
    assert (turns > 0).any()


def test_euler_relation(triangulation: liftmesh.Triangulation) -> None:
    distinct = len(np.unique(triangulation.points + 0.0, axis=0))
    assert len(triangulation.simplices) == 2 * distinct - 2 - len(triangulation.convex_hull)


def test_every_row_is_a_vertex_or_accounted_for(triangulation: liftmesh.Triangulation) -> None:
    used = np.unique(triangulation.simplices)
    rows = np.sort(np.concatenate((used, triangulation.duplicates[:, 0])))
    np.testing.assert_array_equal(rows, np.arange(len(triangulation.points)))


def test_duplicates_name_the_lowest_row(triangulation: liftmesh.Triangulation) -> None:
    points = triangulation.points + 0.0
    _, first, position = np.unique(points, axis=0, return_index=True, return_inverse=True)
    lowest = first[position.reshape(-1)]
    rows = np.flatnonzero(lowest != np.arange(len(points)))
    expected = np.column_stack((rows, lowest[rows]))
    np.testing.assert_array_equal(triangulation.duplicates, expected)


def test_coplanar_points_at_a_triangle_of_the_kept_row(
    triangulation: liftmesh.Triangulation,
) -> None:
    row, simplex, kept = triangulation.coplanar.T
    in_order = np.column_stack((row, kept))[np.argsort(row)]
    np.testing.assert_array_equal(in_order, triangulation.duplicates)
    np.testing.assert_array_equal(np.lexsort((row, simplex)), np.arange(len(row)))
    assert (triangulation.simplices[simplex] == kept[:, None]).any(axis=1).all()


def test_vertex_to_simplex_holds_the_vertex(triangulation: liftmesh.Triangulation) -> None:
    simplex = triangulation.vertex_to_simplex
    used = np.unique(triangulation.simplices)
    assert (triangulation.simplices[simplex[used]] == used[:, None]).any(axis=1).all()
    row, kept = triangulation.duplicates.T
    np.testing.assert_array_equal(simplex[row], simplex[kept])


def test_a_million_rows_of_three_positions() -> None:
    points = np.ones((1_000_000, 2))
    points[[17, 500_000, 999_999]] = [[0, 0], [2, 0], [0, -0.0]]
    triangulation = liftmesh.delaunay(points)
    assert sorted(triangulation.simplices.tolist()[0]) == [0, 17, 500_000]
    assert len(triangulation.simplices) == 1
    assert len(triangulation.duplicates) == 1_000_000 - 3
    assert triangulation.duplicates[-1].tolist() == [999_999, 17]


def test_one_line_of_equal_x_and_one_point_beside_it() -> None:
    n = 200_000
    points = np.column_stack((np.zeros(n), np.random.default_rng(0).permutation(n)))
    points[0, 0] = 1.0
    triangulation = liftmesh.delaunay(points)
    assert len(triangulation.simplices) == n - 2
    assert (triangulation.simplices == 0).any(axis=1).all()
