"""Errors at checkpoints, and at vertices that are left out one by one."""

from __future__ import annotations

import math
import statistics
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from surfaces import LATTICE, drawn, meadow, terrain, trimmed

import liftmesh
from liftmesh import InputError, NonFiniteError

WAYS = ["linear", "nearest", "laplace", "sibson"]


def plane(points: np.ndarray) -> np.ndarray:
    return 3 * points[:, 0] - points[:, 1] / 2 + 7


def slope() -> liftmesh.Surface:
    planar = np.random.default_rng(1).integers(0, 65, (200, 2)).astype(float)
    corners = [[0, 0], [64, 0], [64, 64], [0, 64]]
    planar = np.concatenate([planar, corners])
    return liftmesh.triangulate(np.column_stack([planar, plane(planar)]))


def test_measures_are_those_of_the_standards() -> None:
    rng = np.random.default_rng(2)
    planar, errors = rng.random((500, 2)) * 64, rng.normal(0.01, 0.05, 500)
    checkpoints = np.column_stack([planar, plane(planar) - errors])
    found = slope().accuracy(checkpoints)
    np.testing.assert_allclose(found.residuals, errors, atol=1e-12)
    rmse = math.sqrt(statistics.fmean(each * each for each in errors))
    expected = (rmse, statistics.fmean(errors), statistics.stdev(errors), 1.96 * rmse)
    assert (found.rmse, found.mean, found.std, found.confidence_95) == pytest.approx(expected)
    amounts = sorted(map(abs, errors))
    assert found.percentile_95 == pytest.approx(amounts[474] + 0.05 * (amounts[475] - amounts[474]))
    assert (found.min, found.max) == pytest.approx((errors.min(), errors.max()))
    assert (found.n_points, found.n_outside) == (500, 0)


def test_points_outside_are_counted() -> None:
    found = slope().accuracy([[1, 1, 9], [99, 99, 0], [2, 2, 12.5]])
    assert np.isnan(found.residuals).tolist() == [False, True, False]
    assert (found.n_points, found.n_outside, found.rmse) == (3, 1, 0.5)
    assert "outside, not counted                1" in str(found)
    assert repr(found) == "<Accuracy: RMSE 0.5 of 2 errors>"


def test_one_point_has_no_deviation() -> None:
    found = slope().accuracy([[1, 1, 9]])
    assert (found.rmse, found.mean) == (0.5, 0.5)
    assert math.isnan(found.std)


def test_the_order_of_points_changes_no_bit() -> None:
    points = terrain(300, seed=4)
    surface = liftmesh.triangulate(terrain())
    one, other = surface.accuracy(points), surface.accuracy(points[::-1].copy())
    np.testing.assert_array_equal(one.residuals, other.residuals[::-1])
    assert str(one) == str(other)
    assert (one.rmse, one.mean, one.std) == (other.rmse, other.mean, other.std)


@pytest.mark.parametrize("scale", [1e-300, 1e300])
def test_errors_of_any_size(scale: float) -> None:
    surface = liftmesh.triangulate([[0, 0, 0], [9, 0, 0], [0, 9, 0]])
    found = surface.accuracy([[1, 1, 3 * scale], [1, 2, -4 * scale]])
    assert found.rmse == pytest.approx(math.sqrt(12.5) * scale)
    assert found.mean == pytest.approx(0.5 * scale)
    assert found.std == pytest.approx(math.sqrt(24.5) * scale)


def test_the_unit_is_that_of_heights() -> None:
    surface = liftmesh.triangulate(terrain(), crs="EPSG:25832+7837")
    found = surface.accuracy(terrain(seed=3))
    assert found.unit == "metre"
    assert f"{found.rmse:.10g} metre" in str(found)


def test_checkpoints_of_a_file(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("id,z,y,x\n1,9.5,1,1\n2,11.5,2,2\n")
    assert slope().accuracy(tmp_path / "a.csv").residuals.tolist() == [0.0, 0.5]


@pytest.mark.parametrize(
    ("points", "error", "said"),
    [
        ([[1, 1]], InputError, "no z"),
        ([[1, 1, np.nan]], NonFiniteError, "row 0 is not finite"),
        ([[1, 1, 9], [np.inf, 1, 9]], NonFiniteError, "row 1 is not finite"),
        ([[999, 1, 9]], InputError, "none of the 1 checkpoint is over a face: x is from 0 to 64"),
        (np.empty((0, 3)), InputError, "there are no checkpoints: give some"),
        (liftmesh.Cloud(np.ones((1, 3)), crs="EPSG:28992"), InputError, "transform one of them"),
    ],
)
def test_what_cannot_be_compared(points: object, error: type, said: str) -> None:
    surface = slope().replace(crs="EPSG:25832")
    with pytest.raises(error, match=said):
        surface.accuracy(points)


def test_an_error_beyond_the_doubles() -> None:
    surface = liftmesh.triangulate([[0, 0, 1.7e308], [9, 0, 1.7e308], [0, 9, 1.7e308]])
    with pytest.raises(InputError, match="the error of point 0 is beyond the largest double"):
        surface.accuracy([[1, 1, -1.7e308]])


@pytest.mark.parametrize("way", WAYS)
@settings(max_examples=25, deadline=None)
@given(LATTICE, st.none() | st.floats(1.1, 4))
def test_vertices_are_left_out_as_if_never_there(way, points, limit) -> None:
    surface = drawn(points)
    surface = trimmed(surface, max_edge=limit) if surface and limit else surface
    if surface is None:
        return
    rim = {*np.concatenate(surface.boundary()).tolist()}
    inner = {*surface.faces.ravel().tolist()} - rim
    if not inner:
        with pytest.raises(InputError, match="no vertex has faces all around it"):
            surface.accuracy(interpolation=way)
        return
    found = surface.accuracy(interpolation=way).residuals
    assert {*np.flatnonzero(~np.isnan(found)).tolist()} == inner
    used = np.unique(surface.triangulation.simplices)
    for row in inner:
        others = surface.vertices[used[used != row]]
        height = liftmesh.triangulate(others).sample(surface.vertices[row, :2], way)
        assert height - surface.vertices[row, 2] == found[row]


def test_a_plane_is_known_without_any_vertex() -> None:
    found = slope().accuracy()
    assert found.n_outside > 4
    assert max(-found.min, found.max) < 1e-12


def test_the_order_of_rows_changes_no_bit() -> None:
    points = meadow(300)
    order = np.random.default_rng(1).permutation(len(points))
    one, other = (liftmesh.triangulate(each).accuracy() for each in (points, points[order]))
    np.testing.assert_array_equal(one.residuals[order], other.residuals)


def test_vertices_of_surfaces_with_lines_or_weights_stay() -> None:
    points = meadow(50)
    lined = liftmesh.triangulate(points, breaklines=[[[1, 1, 5], [20, 30, 6]]])
    with pytest.raises(InputError, match="follows lines or has faces of its own: give checkpoints"):
        lined.accuracy()
    weighted = liftmesh.triangulate(points, weights=np.arange(float(len(points))))
    with pytest.raises(InputError, match="has weights, radii or a metric"):
        weighted.accuracy()
    assert lined.accuracy([[30, 30, 0]]).n_outside == 0
    with pytest.raises(InputError, match="interpolation is 'c1', which is for checkpoints"):
        liftmesh.triangulate(points).accuracy(interpolation="c1")
