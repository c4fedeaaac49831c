"""The oracle against itself: cells cut into ears are the lower hull of the raised lift."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from clouds import FAMILIES
from hypothesis import given, strategies as st
from oracles import planar as oracle

COORDINATE = st.integers(0, 4)


@given(st.lists(st.tuples(COORDINATE, COORDINATE), max_size=8))
def test_cells_and_lower_hull_agree_on_coincidences(points: list[oracle.Point]) -> None:
    assert oracle.delaunay(points) == oracle.delaunay_by_definition(points)


@pytest.mark.parametrize("family", FAMILIES)
def test_cells_and_lower_hull_agree_on_families(family: str) -> None:
    points = oracle.exact(FAMILIES[family](9, np.random.default_rng(2)).tolist())
    assert oracle.delaunay(points) == oracle.delaunay_by_definition(points)


@pytest.mark.parametrize("corners", [[0, 1, 2, 3], [3, 1, 0, 2]])
def test_the_diagonal_of_a_square_avoids_the_largest_corner(corners: list[int]) -> None:
    square = [(0, 0), (1, 0), (0, 1), (1, 1)]
    triangles = oracle.delaunay([square[corner] for corner in corners])
    assert triangles == {((0, 0), (1, 0), (0, 1)), ((0, 1), (1, 0), (1, 1))}


@given(st.lists(st.tuples(COORDINATE, COORDINATE), max_size=12))
def test_the_hull_is_where_a_triangle_has_no_partner(points: list[oracle.Point]) -> None:
    sides = {side for a, b, c in oracle.delaunay(points) for side in ((a, b), (b, c), (c, a))}
    hull = oracle.hull_edges(points)
    assert set(hull) == {(a, b) for a, b in sides if (b, a) not in sides}
    assert all(edge[1] == after[0] for edge, after in zip(hull, hull[1:] + hull[:1], strict=True))


def test_points_on_one_line_have_no_triangle() -> None:
    assert oracle.delaunay([(0, 0), (1, 2), (2, 4), (5, 10)]) == set()


def test_location_is_exact_on_a_shared_side() -> None:
    square = [((0, 0), (2, 0), (0, 2)), ((0, 2), (2, 0), (2, 2))]
    inside = {(1, 1): 0, (2, 2): 1, (0, 0): 0, (3, 3): -1}
    assert {p: oracle.locate(square, p) for p in inside} == inside


def test_floats_land_on_one_lattice() -> None:
    assert oracle.exact([(0.5, -0.0), (2.0**-1074, 1.5)]) == [
        (2**1073, 0),
        (1, 3 * 2**1073),
    ]


def test_a_side_is_delaunay_in_just_one_of_both_diagonals() -> None:
    for a, b, c, d in combinations([(0, 0), (4, 1), (1, 3), (3, 4), (0, 2)], 4):
        cells = oracle.hull_edges([a, b, c, d])
        if len(cells) == 4:
            first, second, third, fourth = (edge[0] for edge in cells)
            across = oracle.is_delaunay_side(first, third, fourth, second)
            assert across != oracle.is_delaunay_side(second, fourth, first, third)
