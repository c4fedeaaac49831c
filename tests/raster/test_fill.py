"""Voids of rasters, filled from the nearest pixels."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, strategies as st

import liftmesh
from liftmesh import InputError, Raster
from liftmesh.raster import fill

AS_SQUARES = (1.0, 0.0, 0.0, 0.0, -1.0, 0.0)
SHAPES = st.tuples(st.integers(1, 12), st.integers(1, 12))


def searched(raster: Raster, distance: float) -> np.ndarray:
    """All pixels with a value, compared in fractions."""
    a, b, _, d, e, _ = (Fraction(repr(each)) for each in raster.transform)
    known = np.argwhere(~np.isnan(raster.values)).tolist()
    found = raster.values.copy()
    for row, column in np.argwhere(np.isnan(raster.values)).tolist():
        near = []
        for i, j in known:
            x, y = (p * (j - column) + q * (i - row) for p, q in ((a, b), (d, e)))
            if x * x + y * y <= Fraction(repr(distance)) ** 2:
                near.append((x * x + y * y, raster.values[i, j]))
        found[row, column] = min(near)[1] if near else np.nan
    return found


@given(SHAPES, st.integers(0, 2**32 - 1), st.sampled_from([0.3, 0.5, 1.0, 1.5, 2.0, 3.7, 40.0]))
def test_each_void_has_the_nearest_value(
    shape: tuple[int, int], seed: int, distance: float
) -> None:
    rng = np.random.default_rng(seed)
    values = rng.integers(0, 5, shape).astype(float)
    values[rng.random(shape) < rng.random()] = np.nan
    sides = [(0.5, -0.5), (0.1, 0.1), (0.5, -1.5), (3.0, 1.0)][rng.integers(4)]
    raster = Raster(values, (sides[0], 0.0, 7.0, 0.0, sides[1], 5.0))
    np.testing.assert_array_equal(raster.filled(distance).values, searched(raster, distance))
    turned = Raster(values, (0.3, -0.4, 7.0, 0.4, 0.3, 5.0))
    np.testing.assert_array_equal(turned.filled(distance).values, searched(turned, distance))


def test_blocks_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(1)
    values = rng.random((200, 150)).astype(np.float32)
    values[rng.random(values.shape) < 0.97] = np.nan
    raster = Raster(values, AS_SQUARES)
    expected = raster.filled(9)
    assert expected.values.dtype == np.float32
    monkeypatch.setattr(fill, "_TOGETHER", 150 * 11)
    np.testing.assert_array_equal(raster.filled(9).values, expected.values)
    for flip in (np.s_[::-1], np.s_[:, ::-1]):
        flipped = replace(raster, values=values[flip]).filled(9).values
        np.testing.assert_array_equal(flipped[flip], expected.values)


def test_decimal_distances_reach_whole_pixels() -> None:
    values = np.array([[1.0, *[np.nan] * 5]])
    raster = Raster(values, (0.1, 0.0, 0.0, 0.0, -0.1, 0.0))
    assert np.isnan(raster.filled(0.3).values).tolist() == [[False] * 4 + [True] * 2]
    assert np.isnan(raster.filled(0.29).values).sum() == 3
    assert np.isnan(raster.filled(1e-9).values).sum() == 5
    assert np.isnan(raster.filled(1e300).values).sum() == 0


def test_rasters_of_surfaces() -> None:
    points = np.random.default_rng(1).random((200, 3)) * [100, 80, 10]
    surface = liftmesh.triangulate(points).trim(max_edge=12)
    for options in ({}, {"quantity": "aspect"}, {"interpolation": "sibson", "dtype": "float32"}):
        plain = surface.raster(1, **options)
        assert np.isnan(plain.values).any()
        np.testing.assert_array_equal(
            surface.raster(1, fill=2.5, **options).values, plain.filled(2.5).values
        )
    named = surface.raster(1, values=points[:, 0], fill=1)
    assert np.isnan(named.values).sum() < np.isnan(plain.values).sum()


def test_tiles_fill_as_one_surface(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    points = np.random.default_rng(2).random((300, 3)) * [100, 80, 10]
    tiled = liftmesh.tile_surface(points, tmp_path / "tiles", tile_rows=100)
    surface = liftmesh.triangulate(points)
    monkeypatch.setattr("liftmesh.tiles.surface_raster._SIDE", 16)
    wide = {"bounds": (-10, -10, 110, 90), "fill": 6}
    expected = surface.raster(1, **wide)
    assert (
        0
        < np.isnan(expected.values).sum()
        < np.isnan(surface.raster(1, **wide | {"fill": None}).values).sum()
    )
    np.testing.assert_array_equal(tiled.raster(1, **wide).values, expected.values)
    tiled.save_raster(tmp_path / "dtm.tif", 1, dtype="float64", **wide)
    rasterio = pytest.importorskip("rasterio")
    with rasterio.open(tmp_path / "dtm.tif") as file:
        np.testing.assert_array_equal(file.read(1), expected.values)


@pytest.mark.parametrize("distance", [0, -1, np.nan, np.inf, "far", None, True])
def test_distances_that_are_none(distance: object) -> None:
    raster = Raster(np.ones((2, 2)), AS_SQUARES)
    with pytest.raises(InputError, match="distance"):
        raster.filled(distance)  # type: ignore[arg-type]


def test_pixels_that_are_no_rectangles() -> None:
    with pytest.raises(InputError, match="not at right angles"):
        Raster(np.ones((2, 2)), (1.0, 0.5, 0.0, 0.0, -1.0, 0.0)).filled(1)
    surface = liftmesh.triangulate(np.random.default_rng(1).random((9, 3)))
    with pytest.raises(InputError, match="fill is -1"):
        surface.raster(0.1, fill=-1)
    empty = Raster(np.full((3, 3), np.nan), AS_SQUARES)
    assert np.isnan(empty.filled(9).values).all()
