"""Linear interpolation in space: exact at vertices, linear inside, nothing outside."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import Delaunay

import liftmesh

RNG = np.random.default_rng(71)
POINTS = RNG.random((60, 3))
PLACES = RNG.random((300, 3)) * 1.2 - 0.1
TETRA = liftmesh.tetrahedralize(POINTS)


@pytest.mark.parametrize("scale", [1.0, 1e-300, 1.5e308])
def test_planes_and_vertices(scale: float) -> None:
    tetra = liftmesh.tetrahedralize(POINTS * scale)
    values = POINTS @ (1, -2, 3)
    np.testing.assert_array_equal(tetra.interpolate(values, tetra.points), values)
    inside = TETRA.find_simplex(PLACES) >= 0
    found = tetra.interpolate(values, PLACES[inside] * scale)
    np.testing.assert_allclose(found, PLACES[inside] @ (1, -2, 3), atol=1e-12)


def test_it_is_scipys() -> None:
    values = np.sin(5 * POINTS)
    expected = LinearNDInterpolator(Delaunay(POINTS), values, fill_value=-9)(PLACES)
    found = TETRA.interpolate(values, PLACES.reshape(30, 10, 3), fill=-9)
    assert found.shape == (30, 10, 3)
    np.testing.assert_allclose(found.reshape(-1, 3), expected, atol=1e-12)
    assert np.isnan(TETRA.interpolate(values[:, 0], [[9, 9, 9], [np.nan, 0, 0]])).all()
    assert TETRA.interpolate(values, np.empty((0, 3))).shape == (0, 3)


@pytest.mark.parametrize("points", [POINTS, np.indices((3, 4, 3)).reshape(3, -1).T * 0.1])
def test_the_order_of_rows_changes_no_bit(points) -> None:
    values = RNG.normal(size=len(points))
    places = np.vstack([PLACES * np.ptp(points, axis=0), points[:-1] / 2 + points[1:] / 2])
    order = RNG.permutation(len(points))
    first = liftmesh.tetrahedralize(points).interpolate(values, places)
    again = liftmesh.tetrahedralize(points[order]).interpolate(values[order], places)
    assert first.tobytes() == again.tobytes()
    assert np.isfinite(first).sum() > 100


def test_refusals() -> None:
    with pytest.raises(liftmesh.InputError, match=r"values have the shape \(3,\)"):
        TETRA.interpolate([1, 2, 3], PLACES)
    with pytest.raises(liftmesh.InputError, match=r"values are .*: give a number for each row"):
        TETRA.interpolate(["a"] * 60, PLACES)
    with pytest.raises(liftmesh.InputError, match="points in space need"):
        TETRA.interpolate(POINTS[:, 0], [0, 0])
