"""Points made to be slow: they are what their families promise."""

from __future__ import annotations

import numpy as np
import pytest
from worst_points import FANS, SCALES, beside_the_sample

import liftmesh


@pytest.mark.parametrize("family", FANS)
def test_all_triangles_of_a_fan_meet_at_one_vertex(family: str) -> None:
    points = FANS[family](2000, np.random.default_rng(1))
    tri = liftmesh.delaunay(points)
    assert points.shape == (2000, 2)
    assert (tri.simplices == 1999).any(axis=1).mean() > 0.9


@pytest.mark.parametrize("family", SCALES)
def test_scales_differ(family: str) -> None:
    points = SCALES[family](2000, np.random.default_rng(1))
    distinct = np.unique(points, axis=0)
    moved = np.unique(points + 1.0, axis=0)
    assert len(distinct) > 1.5 * len(moved)


def test_few_points_lie_beside_those_that_the_sample_misses() -> None:
    points = beside_the_sample(100_000, np.random.default_rng(1))
    assert (points > 999).all(axis=1).mean() > 0.9
    assert liftmesh.delaunay(points).verify().canonical
