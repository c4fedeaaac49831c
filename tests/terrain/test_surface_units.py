"""Heights in another unit than lengths: angles and areas in space are those on the ground."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import rasterio
from files.geotiff import elevation_model

import liftmesh

FEET_HIGH = "EPSG:25832+8228"  # metres in the plane, NAVD88 heights in feet
FACTOR = 0.3048
PLANE = np.array([[0.0, 0, 0], [4, 0, 4], [0, 4, 0], [4, 4, 4]])


@pytest.fixture
def mixed() -> liftmesh.Surface:
    with pytest.warns(liftmesh.DataWarning, match="the units differ"):
        return liftmesh.triangulate(PLANE, crs=FEET_HIGH)


def on_the_ground() -> liftmesh.Surface:
    return liftmesh.triangulate(PLANE * (1, 1, FACTOR))


def test_angles_are_those_on_the_ground(mixed) -> None:
    expected = on_the_ground()
    assert mixed.slope([1, 2]) == pytest.approx(np.degrees(np.arctan(FACTOR)), rel=1e-12)
    assert mixed.aspect([1, 2]) == expected.aspect([1, 2]) == 270
    assert mixed.gradient([1, 2]).tolist() == [1, 0]
    for quantity in ("slope", "aspect", "hillshade"):
        found = mixed.raster(1, quantity=quantity).values
        np.testing.assert_allclose(found, expected.raster(1, quantity=quantity).values, rtol=1e-12)


def test_areas_are_those_on_the_ground(mixed) -> None:
    assert mixed.area() == pytest.approx(on_the_ground().area(), rel=1e-12)
    assert mixed.area(planar=True) == 16
    assert mixed.volume().cubic_metres == pytest.approx(FACTOR)


@pytest.mark.parametrize(
    ("crs", "unit", "factor"),
    [
        ("EPSG:25832", "ft", FACTOR),
        ("EPSG:25832", "US survey foot", 1200 / 3937),
        ("EPSG:25832", "metre", 1),
        (FEET_HIGH, "metre", 1),  # the band is nearer to its samples than the system
        ("EPSG:25832", "cubits", 1),
        (None, "ft", 1),
    ],
)
@pytest.mark.filterwarnings("ignore:the units differ")
def test_the_unit_of_a_band_counts(crs: str | None, unit: str, factor: float) -> None:
    cloud = liftmesh.Cloud(PLANE, crs=crs, metadata={"raster": {"unit": unit}})
    surface = liftmesh.triangulate(cloud)
    expected = liftmesh.triangulate(PLANE * (1, 1, factor))
    assert surface.slope([1, 2]) == pytest.approx(expected.slope([1, 2]), rel=1e-12)
    assert surface.area() == pytest.approx(expected.area(), rel=1e-12)
    slopes = surface.raster(1, quantity="slope").values
    np.testing.assert_allclose(slopes, expected.raster(1, quantity="slope").values, rtol=1e-12)
    assert surface.slope([1, 2], z_factor=1) == pytest.approx(45)


def test_tiles_heed_the_unit_of_a_band(tmp_path: Path) -> None:
    rng = np.random.default_rng(4)
    rows = np.column_stack([rng.random((300, 2)) * 40, rng.random(300) * 9])
    feet = liftmesh.Cloud(rows, crs="EPSG:25832", metadata={"raster": {"unit": "ft"}})
    tiled = liftmesh.tile_surface(feet, tmp_path / "a", tile_rows=60)
    expected = liftmesh.triangulate(feet)
    for quantity in ("slope", "hillshade"):
        found = liftmesh.open_tiled(tiled.folder).raster(1, quantity=quantity).values
        np.testing.assert_array_equal(found, expected.raster(1, quantity=quantity).values)
    assert next(each.metadata for each in tiled.iter_meshes()) == {"raster": {"unit": "foot"}}
    assert tiled.verify(feet).canonical
    for name, unit in (("ft", "ft"), ("m", "metre"), ("none", None)):
        elevation_model(tmp_path / f"{name}.tif", rng.random((20, 20)), 1.0, "EPSG:25832")
        with rasterio.open(tmp_path / f"{name}.tif", "r+") as file:
            if unit is not None:
                file.units = (unit,)
    for other, said in (("m", "'metre', that of"), ("none", "no stated unit")):
        mixed = [tmp_path / "ft.tif", tmp_path / f"{other}.tif"]
        with pytest.raises(liftmesh.InputError, match=said):
            liftmesh.tile_surface(mixed, tmp_path / "b", tile_rows=60)


def test_merging_keeps_the_unit_of_bands_and_refuses_two() -> None:
    feet = liftmesh.Cloud(PLANE, crs="EPSG:25832", metadata={"raster": {"unit": "ft", "rows": 2}})
    also = replace(feet, metadata={"raster": {"unit": "foot", "rows": 3}})
    merged = liftmesh.merge([feet, also])
    assert merged.metadata["raster"] == {"unit": "foot"}
    with pytest.raises(liftmesh.InputError, match=r"cloud 1 .* 'metre', that of cloud 0 in 'foot'"):
        liftmesh.merge([feet, replace(feet, metadata={"raster": {"unit": "metre"}})])
    with pytest.warns(liftmesh.DataWarning, match="cloud 0 says .* 'foot', others say nothing"):
        merged = liftmesh.merge([feet, replace(feet, metadata={})])
    assert "raster" not in merged.metadata


def test_a_factor_replaces_what_the_system_says(mixed) -> None:
    assert mixed.slope([1, 2], z_factor=1) == pytest.approx(45)
    assert mixed.raster(1, quantity="slope", z_factor=1).values[0, 0] == pytest.approx(45)
    assert mixed.area(z_factor=1) == pytest.approx(16 * 2**0.5)
    steep = liftmesh.triangulate(PLANE).slope([1, 2], z_factor=2)
    assert steep == pytest.approx(np.degrees(np.arctan(2)))


@pytest.mark.parametrize("factor", [0, -1, np.nan, np.inf, "much", [1, 2]])
def test_a_factor_is_positive(factor: object) -> None:
    surface = liftmesh.triangulate(PLANE)
    for call in (surface.area, lambda **given: surface.slope([1, 1], **given)):
        with pytest.raises(liftmesh.InputError, match="z_factor is"):
            call(z_factor=factor)
