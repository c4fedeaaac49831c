"""Cells of rows that others write meanwhile: what was read once is what they are made of."""

from __future__ import annotations

import numpy as np

import liftmesh
from liftmesh import _kernel
from liftmesh.cells.domain import as_domain
from liftmesh.cells.dual import dual_of


def clipped_with(rows: np.ndarray, sound: np.ndarray) -> tuple | None:
    """Clip with other rows than those that were triangulated."""
    dual = dual_of(sound)
    turns = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    star = np.c_[np.cos(turns), np.sin(turns)] * np.tile([[0.3], [0.48]], (20, 1)) + 0.5
    domain = as_domain(star, rows)
    return _kernel.clip(
        rows, dual.values, dual.kind, dual.simplices, dual.neighbors, dual.simplex_to_vertex,
        dual.chain, domain.corners, domain.starts,
    )  # fmt: skip


def test_rows_that_are_not_those_of_the_triangles_are_noticed_or_lead_to_rows() -> None:
    refused = 0
    for seed in range(90):
        rng = np.random.default_rng(seed)
        sound, spoilt = rng.random((2, 3000, 2))
        if seed % 4 == 0:  # few of them
            spoilt = np.where(rng.random((3000, 1)) < 0.01, spoilt, sound)
        found = clipped_with(spoilt, sound)
        refused += found is None
        if found is not None:
            cells = found[4]
            assert cells.min() >= 0
            assert cells.max() < 3000
    assert 0 < refused < 90


def test_cells_are_of_what_the_rows_were() -> None:
    points, weights = np.random.default_rng(18).random((2, 20, 2))
    weights = np.ascontiguousarray(weights[:, 0])
    cells = liftmesh.power_diagram(points, weights=weights, domain=(0, 0, 1, 1))
    start = cells.sides[0]
    points += 5
    weights *= 9
    np.testing.assert_array_equal(cells.sides[0], start)
    assert not np.shares_memory(cells.points, points)
