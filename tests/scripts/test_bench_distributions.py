"""The inputs of the benchmark that come from measured ground: exact steps, no position twice."""

from __future__ import annotations

import numpy as np
import pytest
from distributions import DISTRIBUTIONS, UTM_ORIGIN, jacksboro_posts


def sample(name: str, n: int) -> np.ndarray:
    return DISTRIBUTIONS[name](n, np.random.default_rng(3))


@pytest.mark.parametrize("n", [1, 2, 9, 400, 100_000, 138_632, 138_633, 400_000])
def test_the_terrain_is_tiled_to_any_size_without_a_position_twice(n: int) -> None:
    points = sample("jacksboro", n)
    assert points.shape == (n, 2)
    assert len(np.unique(points, axis=0)) == n


def test_copies_of_the_terrain_stand_one_step_apart() -> None:
    posts, points = jacksboro_posts(), sample("jacksboro", 4 * 138_632)
    across, down = np.unique(points[:, 0]), np.unique(points[:, 1])
    assert (len(across), len(down)) == (2 * 403, 2 * 344)
    assert np.diff(across) == pytest.approx(posts[0, 1, 0] - posts[0, 0, 0], abs=0.002)
    assert np.diff(down) == pytest.approx(posts[0, 0, 1] - posts[1, 0, 1], abs=0.002)


def test_few_posts_are_a_corner_of_the_terrain() -> None:
    assert np.ptp(sample("jacksboro", 100), axis=0) == pytest.approx([9 * 74.4, 9 * 92.67], 1e-3)


def test_laser_scans_are_whole_centimetres_at_a_maps_coordinates() -> None:
    points = sample("centimetres", 10_000)
    steps = np.rint((points - UTM_ORIGIN) / 0.01)
    assert (points == steps * 0.01 + UTM_ORIGIN).all()
    assert np.ptp(steps, axis=0) == pytest.approx([3100, 3100], rel=0.01)
