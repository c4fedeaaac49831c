"""Grids of xarray as surfaces, and rasters as grids."""

from __future__ import annotations

import numpy as np
import pytest
import xarray

import liftmesh
import liftmesh.plugins.xarray

HEIGHTS = np.random.default_rng(5).random((6, 9))
X, Y = np.arange(9) * 2.0 + 4e5, 5e6 - np.arange(6) * 3.0


def grid_of(values: np.ndarray, **options: object) -> xarray.DataArray:
    return xarray.DataArray(values, {"y": Y, "x": X}, ("y", "x"), **options)


def test_every_height_is_a_vertex() -> None:
    surface = grid_of(HEIGHTS, attrs={"units": "m"}).liftmesh.tin()
    expected = np.stack([*np.meshgrid(X, Y), HEIGHTS], axis=-1).reshape(-1, 3)
    assert np.array_equal(surface.vertices, expected)


def test_few_triangles_within_the_error() -> None:
    grid = grid_of(HEIGHTS)
    surface = grid.liftmesh.tin(max_error=0.3)
    assert len(surface.vertices) < HEIGHTS.size
    places = np.stack(np.meshgrid(X, Y), axis=-1)
    assert np.abs(surface.sample(places) - HEIGHTS).max() <= 0.3
    assert len(grid.liftmesh.tin(max_points=10).vertices) == 10


def test_gaps() -> None:
    plane = 2 * (X - X[0]) + (Y[:, None] - Y[-1])
    values = plane.astype(np.float32)[None]
    values[0, 2, 3:6] = np.nan
    values[0, 4, 4] = -9999
    grid = xarray.DataArray(
        values, {"band": [1], "y": Y, "x": X}, ("band", "y", "x"),
        attrs={"units": "m", "_FillValue": -9999},
    )  # fmt: skip
    filled = grid.liftmesh.fill_gaps()
    assert np.allclose(filled.values[0], plane, rtol=0, atol=1e-9)
    assert (filled.dims, filled.attrs, filled.dtype) == (grid.dims, grid.attrs, np.float64)
    assert np.isnan(grid.values[0, 2, 3:6]).all()
    other = grid.liftmesh.fill_gaps("sibson")
    assert np.allclose(other.values[0], plane, rtol=0, atol=1e-9)
    values[0, :, 8] = np.nan
    assert np.isnan(grid_of(values[0]).liftmesh.fill_gaps().values[:, 8]).all()


def test_round_trip() -> None:
    cloud = liftmesh.Cloud(np.random.default_rng(1).random((50, 3)) * 90, crs="EPSG:25832")
    raster = liftmesh.triangulate(cloud).raster(10)
    grid = raster.to_xarray()
    assert (grid.name, grid.dims) == ("height", ("y", "x"))
    assert np.array_equal(grid.values, raster.values, equal_nan=True)
    assert np.array_equal(np.stack(np.meshgrid(grid.x, grid.y), axis=-1), raster.centers())
    again = liftmesh.triangulate(grid)
    assert "25832" in again.crs
    assert np.array_equal(again.vertices[:, 2], raster.values[~np.isnan(raster.values)])
    assert raster.to_xarray() is not grid
    grid.values[:] = 0  # a copy
    assert np.nanmax(raster.values) > 0
    slopes = liftmesh.triangulate(cloud).raster(10, quantity="slope").to_xarray()
    assert slopes.attrs == {"units": "degree"}


def test_errors() -> None:
    with pytest.raises(liftmesh.InputError, match="turned"):
        liftmesh.Raster(HEIGHTS, (1.0, 0.5, 0.0, 0.5, -1.0, 0.0)).to_xarray()
    with pytest.raises(liftmesh.InputError, match="no grid of heights: choose one"):
        grid_of(HEIGHTS).expand_dims(band=2).liftmesh.tin()
    with pytest.raises(liftmesh.DegenerateInputError):
        grid_of(np.full_like(HEIGHTS, np.nan)).liftmesh.fill_gaps()
