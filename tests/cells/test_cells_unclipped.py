"""`Cells.unclipped`: power diagrams in the whole plane."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import spatial

import liftmesh

RNG = np.random.default_rng(18)


def test_without_weights_it_is_voronoi() -> None:
    points = RNG.random((60, 2))
    ours, theirs = (
        liftmesh.voronoi(points).unclipped,
        liftmesh.scipy.Voronoi(points, qhull_options=""),
    )
    for name in ("vertices", "ridge_points", "ridge_ends", "point_region", "simplices"):
        np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name))
    for name in ("npoints", "ndim", "min_bound", "max_bound", "overflowed", "furthest_site"):
        np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name))
    assert ours.ridge_dict == theirs.ridge_dict
    assert ours.regions == theirs.regions
    assert ours.ridge_vertices == theirs.ridge_vertices
    assert "60 cells of 60 rows" in repr(ours)


@pytest.mark.parametrize("kind", ["weights", "radii"])
def test_far_along_a_ray_its_two_sites_have_the_least_power(kind: str) -> None:
    points, values = RNG.random((50, 2)), RNG.random(50) * 0.2
    values[7] = 0.0 if kind == "radii" else -0.5
    whole = liftmesh.power_diagram(points, **{kind: values}).unclipped
    weights = values**2 if kind == "radii" else values
    ridges, directions = whole.rays
    assert (whole.ridge_ends[ridges, 0] == -1).all()
    for ridge, direction in zip(ridges, directions, strict=True):
        far = whole.vertices[whole.ridge_ends[ridge, 1]] + 1e4 * direction / np.hypot(*direction)
        power = ((points - far) ** 2).sum(axis=1) - weights
        assert {*np.argsort(power)[:2]} == {*whole.ridge_points[ridge]}
    finite = np.flatnonzero(whole.ridge_ends[:, 0] >= 0)
    middle = whole.vertices[whole.ridge_ends[finite]].mean(axis=1)
    power = ((points[:, None] - middle) ** 2).sum(axis=2) - weights[:, None]
    nearest = np.sort(np.argsort(power, axis=0)[:2].T, axis=1)
    np.testing.assert_array_equal(nearest, np.sort(whole.ridge_points[finite], axis=1))
    hidden = liftmesh.power_diagram(points, **{kind: values}).hidden
    assert (whole.point_region[hidden] == -1).all()
    figure = spatial.voronoi_plot_2d(whole)
    assert sum(len(each.get_segments()) for each in figure.axes[0].collections) == len(
        whole.ridge_points
    )


def test_on_a_line_ridges_are_lines() -> None:
    whole = liftmesh.power_diagram([[0, 0], [4, 4], [2, 2], [4, 4]], weights=[0, 1, 0, 1]).unclipped
    assert whole.ridge_points.tolist() == [[0, 2], [2, 1]]
    assert whole.ridge_ends.tolist() == [[-1, -1], [-1, -1]]
    assert whole.point_region.tolist() == [0, 2, 1, 2]
    assert whole.rays[1].tolist() == [[1, -1], [1, -1]]
    assert whole.ridge_dict == {(0, 2): [-1, -1], (2, 1): [-1, -1]}


def test_vertices_beyond_the_doubles_are_counted() -> None:
    points = [[0, 0], [1e300, 1e-300], [2e300, 0]]
    assert liftmesh.voronoi(points, domain=(0, 0, 1, 1)).unclipped.overflowed == 1
