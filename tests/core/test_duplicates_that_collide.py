"""Points made to collide in the table of positions: still right, and still quick."""

from __future__ import annotations

import numpy as np
from collisions import colliding_column, hashed

import liftmesh


def test_the_hash_is_undone() -> None:
    assert {hashed(x, y) >> 16 for x, y in colliding_column(100).tolist()} == {0x123456789ABC}


def test_colliding_positions_are_told_apart_and_merged() -> None:
    column = colliding_column(1200)
    twice = np.concatenate([column, column[::-1]])
    points = np.concatenate([twice, [[2.0, 0.0], [2.0, 1.0]]])
    tri = liftmesh.delaunay(points)
    rows = np.arange(1200, 2400)
    np.testing.assert_array_equal(tri.duplicates, np.column_stack([rows, 2399 - rows]))
    assert tri.nsimplex == 2 * 1202 - 2 - len(tri.convex_hull)
    assert set(np.unique(tri.simplices)) == {*range(1200), 2400, 2401}
