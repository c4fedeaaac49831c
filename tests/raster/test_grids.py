"""Grids of heights in memory: Raster, DataArrays of xarray, and arrays with a transform."""

from __future__ import annotations

import numpy as np
import pytest
import rasterio
import xarray as xr
from files.geotiff import geotiff

import liftmesh
from liftmesh import InputError

HEIGHTS = np.array([[5.0, 6, 7], [8, np.nan, 9]])
TRANSFORM = (2.0, 0, 100, 0, -4.0, 50)
ROWS = [[101, 48, 5], [103, 48, 6], [105, 48, 7], [101, 44, 8], [105, 44, 9]]


def data_array(heights: np.ndarray = HEIGHTS, **options: object) -> xr.DataArray:
    coords = {"y": [48.0, 44.0], "x": [101.0, 103, 105]}
    return xr.DataArray(heights, coords=coords, dims=("y", "x"), **options)  # type: ignore[arg-type]


def test_arrays_with_a_transform_are_as_the_geotiff(tmp_path) -> None:
    path = tmp_path / "a.tif"
    affine = rasterio.Affine(*TRANSFORM)
    path.write_bytes(geotiff(np.nan_to_num(HEIGHTS, nan=-9999), transform=affine, nodata=-9999))
    expected = liftmesh.read(path).points
    assert expected.tolist() == ROWS
    for transform in (TRANSFORM, affine, np.array(TRANSFORM)):
        found = liftmesh.as_cloud(HEIGHTS, transform=transform)
        assert np.array_equal(found.points, expected)
    assert found.metadata["not_read"] == ("1 sample without a value",)
    marked = np.where(np.isnan(HEIGHTS), -9999, HEIGHTS).astype(np.int16)
    assert np.array_equal(
        liftmesh.as_cloud(marked, transform=TRANSFORM, nodata=-9999).points, expected
    )
    masked = np.ma.masked_invalid(HEIGHTS)
    assert np.array_equal(liftmesh.as_cloud(masked, transform=TRANSFORM).points, expected)


def test_a_raster_is_a_cloud_of_its_centres() -> None:
    surface = liftmesh.triangulate([[0, 0, 0], [9, 0, 3], [0, 9, 6], [5, 9, 1]], crs="EPSG:25832")
    raster = surface.raster(1)
    found = liftmesh.as_cloud(raster)
    known = ~np.isnan(raster.values)
    assert np.array_equal(found.points[:, :2], raster.centers()[known])
    assert np.array_equal(found.points[:, 2], raster.values[known])
    assert found.crs == "EPSG:25832"
    assert len(liftmesh.triangulate(raster).vertices) == known.sum()
    with pytest.raises(InputError, match="a Raster of slope is no grid of heights"):
        liftmesh.as_cloud(surface.raster(1, quantity="slope"))


def test_grids_of_xarray_have_places_units_and_a_system() -> None:
    text = rasterio.crs.CRS.from_epsg(25832).to_wkt()
    grid = data_array(attrs={"units": "feet", "_FillValue": 9.0})
    grid = grid.assign_coords(spatial_ref=xr.DataArray(0, attrs={"crs_wkt": text}))
    found = liftmesh.as_cloud(grid.expand_dims("band"))
    assert found.points.tolist() == ROWS[:-1]
    assert found.crs == text
    assert found.metadata["raster"] == {"unit": "feet"}
    turned = liftmesh.as_cloud(data_array().transpose("x", "y"))
    assert {tuple(row) for row in turned.points.tolist()} == {(y, x, z) for x, y, z in ROWS}


def test_triangulate_and_simplify_take_grids() -> None:
    x, y = np.meshgrid(np.arange(30.0), np.arange(20.0))
    heights = np.sin(x / 5) * 3 + y / 4
    grid = xr.DataArray(heights, coords={"y": y[:, 0], "x": x[0]}, dims=("y", "x"))
    one = liftmesh.triangulate(grid)
    two = liftmesh.triangulate(heights, transform=(1, 0, -0.5, 0, 1, -0.5))
    assert np.array_equal(one.vertices, two.vertices)
    assert np.array_equal(one.faces, two.faces)
    simple = liftmesh.simplify(grid, max_error=0.2)
    assert len(simple.faces) < len(one.faces)
    places = np.column_stack([x.ravel(), y.ravel()])
    assert np.abs(simple.sample(places) - heights.ravel()).max() <= 0.2 + 1e-12


@pytest.mark.parametrize(
    ("source", "options", "cause"),
    [
        (np.zeros(3), {"transform": TRANSFORM}, r"transform is .*, goes with an array|transform"),
        (HEIGHTS, {"transform": (1, 2)}, "transform"),
        (HEIGHTS, {"transform": TRANSFORM, "columns": "x,y"}, "transform= is for a grid, and col"),
        (data_array(), {"transform": TRANSFORM}, "goes with an array, not with a xarray"),
        (xr.DataArray(np.zeros((2, 2, 2))), {}, "the dimensions dim_0, dim_1, dim_2 is no grid"),
        (xr.DataArray(np.zeros((2, 3))), {}, "the dimension 'dim_1' of a DataArray has no coord"),
        (data_array().assign_coords(x=["a", "b", "c"]), {}, "dimension 'x' are no numbers"),
    ],
)
def test_what_is_no_grid_is_refused(source: object, options: dict, cause: str) -> None:
    with pytest.raises(InputError, match=cause):
        liftmesh.as_cloud(source, **options)


def test_a_file_takes_no_transform(tmp_path) -> None:
    (tmp_path / "a.xyz").write_text("1 2 3\n")
    with pytest.raises(liftmesh.LiftmeshError, match="transform"):
        liftmesh.triangulate(tmp_path / "a.xyz", transform=TRANSFORM)
