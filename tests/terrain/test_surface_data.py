"""What several functions ask of the data of a surface first."""

from __future__ import annotations

import numpy as np

import liftmesh
from liftmesh.terrain.surface_data import (
    corner_order,
    ordered_corners,
    plane_system,
    positions_of,
)

POINTS = [[0, 0, 0], [1, 0, 1], [0, 1, 2], [1, 2, 0]]


def test_positions_are_those_of_rows_in_use() -> None:
    used, points, hull = positions_of(
        liftmesh.triangulate([[-0.0, 0, 5], [0, 0, 5], [1, 0, 6], [0, 1, 7]])
    )
    assert used.tolist() == [0, 2, 3]
    assert points.tolist() == [[0, 0], [1, 0], [0, 1]]
    assert not np.signbit(points).any()
    assert hull.tolist() == [0, 1, 2]


def test_corners_are_ordered_by_x_then_y() -> None:
    corners = np.array([[[1.0, 0.0], [0.0, 2.0], [0.0, 1.0]]])
    assert corner_order(corners).tolist() == [[2, 1, 0]]
    assert ordered_corners(corners).tolist() == [[[0, 1], [0, 2], [1, 0]]]


def test_a_turned_plane_has_no_system() -> None:
    for plane, expected in (("xy", "EPSG:25832"), ("xz", None)):
        surface = liftmesh.triangulate(POINTS, plane=plane, crs="EPSG:25832")
        assert plane_system(surface) == expected
