"""Rings, exact corners, and where polylines are in a domain."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from liftmesh.cells.crossings import cell_at, crossings, lies_inside
from liftmesh.cells.domain import as_domain, following_corners, shapes_of
from liftmesh.cells.rings import as_exact, binary_scale, doubled_area, is_within, turn
from liftmesh.disks.sides import Traced

NO_POINTS = np.empty((0, 2))
ORIGIN, RIGHT, UP = as_exact((0, 0)), as_exact((1, 0)), as_exact((0, 1))


def test_each_corner_is_followed_by_the_next_one_of_its_ring() -> None:
    assert following_corners(np.array([0, 3, 3, 7])).tolist() == [1, 2, 0, 4, 5, 6, 3]
    assert following_corners(np.array([0])).tolist() == []


def test_corners_are_rationals() -> None:
    assert as_exact((0.5, 2)) == (Fraction(1, 2), Fraction(2))
    assert turn(ORIGIN, RIGHT, UP) == 1
    assert doubled_area([ORIGIN, RIGHT, as_exact((1, 1)), UP]) == 2
    assert is_within(as_exact((1, 1)), ORIGIN, as_exact((2, 2)))
    assert not is_within(as_exact((2, 2)), ORIGIN, as_exact((2, 2)))


def test_scales_are_powers_of_two_above_the_greatest_number() -> None:
    assert binary_scale(np.array([1.5, -5.0])) == 3
    assert binary_scale(np.array([])) == 0


def test_geometries_of_any_tree() -> None:
    point = {"type": "Point", "coordinates": [1, 2]}
    assert [each.wkt for each in shapes_of(point)] == ["POINT (1 2)"]
    features = [{"type": "Feature", "geometry": each} for each in (point, None)]
    shapes = shapes_of({"type": "FeatureCollection", "features": features})
    assert [each and each.wkt for each in shapes] == ["POINT (1 2)", None]


def test_a_domain_counts_as_moved() -> None:
    box = as_domain((0, 0, 2, 2), NO_POINTS)
    assert lies_inside(np.array([[0.0, 1], [1, 1], [2, 1]]), box).tolist() == [False, True, True]
    crossed = crossings(np.array([[1.0, 1.0]]), np.array([[5.0, 1.0]]), box)
    assert (crossed.points.tolist(), crossed.enters.tolist()) == ([[2, 1]], [False])


def test_a_ring_that_no_polyline_crosses_is_in_one_cell() -> None:
    line = np.array([[0.0, -5.0], [0.0, 5.0]])
    lines = Traced(np.array([[7, 8]]), np.array([[-1, -1]]), np.array([0, 2]), line, (-1, -1, 3, 2))
    assert cell_at(lines, as_domain((1, 0, 2, 1), NO_POINTS), 0, 4, 0) == 8
    assert cell_at(lines, as_domain((-0.75, 0, -0.5, 1), NO_POINTS), 0, 4, 0) == 7
