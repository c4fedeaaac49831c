"""Cells that two sets of triangles cover alike, and the rows across edges."""

from __future__ import annotations

import numpy as np

from liftmesh.comparison.differences import opposite_rows, unbalanced_cells

ONE, OTHER = np.array([[0, 1, 2], [0, 2, 3]]), np.array([[0, 1, 3], [1, 2, 3]])


def test_triangulations_of_one_cell_have_the_same_boundary() -> None:
    cells = np.array([0, 0])
    assert not unbalanced_cells(1, (ONE, cells), (OTHER, cells)).any()
    assert unbalanced_cells(1, (ONE, cells), (OTHER[:1], cells[:1])).all()


def test_the_row_across_an_edge_is_no_corner_of_it() -> None:
    assert opposite_rows(ONE, np.array([0]), np.array([1]), np.array([1])).tolist() == [3]
