"""Heights keep their unit where coordinates are transformed to a system of the plane."""

from __future__ import annotations

import io

import numpy as np
import pytest
import rasterio
from affine import Affine
from files.las import encoded, geo_keys, record, records, with_records

import liftmesh as lm
from liftmesh import Cloud, DataWarning, InputError
from liftmesh.crs.description import parse_crs
from liftmesh.crs.transformation import transform

FEET = np.array([[6_000_000.0, 2_000_000.0, 1000.0], [6_000_100.0, 2_000_000.0, 1001.0]])
HEIGHTS = np.arange(12.0).reshape(3, 4) / 7 + 100


def read(points: np.ndarray, dst_crs: str, **keys: int) -> Cloud:
    data = encoded(records(points, 6, version="1.4", offset=(0, 0, 0)))
    made = record(b"LASF_Projection", 34735, geo_keys(**keys))
    return lm.read(io.BytesIO(with_records(data, made)), format="las", dst_crs=dst_crs)


def names(crs: str | None) -> tuple[str | None, ...]:
    system = parse_crs(crs)
    assert system is not None
    return tuple(each.name if each else None for each in system.units)


def test_feet_of_height_over_metres_are_said() -> None:
    found = read(FEET, "EPSG:26910", k1024=1, k3072=2225, k4096=6360)
    assert found.crs == "EPSG:26910+6360"
    assert found.points[:, 2].tolist() == [1000.0, 1001.0]
    plane, _ = transform(FEET, "EPSG:2225", "EPSG:26910")
    assert np.array_equal(found.points[:, :2], plane[:, :2])
    three = Cloud(np.vstack([found.points, found.points[:1] + 1]), crs=found.crs)
    with pytest.warns(DataWarning, match="x is in metre, y in metre, z in US survey foot"):
        lm.triangulate(three)


def test_heights_are_converted_where_the_target_says_how() -> None:
    found = read(FEET, "EPSG:26910+5703", k1024=1, k3072=2225, k4096=6360)
    assert found.crs == "EPSG:26910+5703"
    assert abs(found.points[0, 2] - 304.8006096) < 1e-6


def test_a_unit_without_a_system_is_kept() -> None:
    found = read(FEET, "EPSG:26910", k1024=1, k3072=2225, k4099=9003)
    assert names(found.crs) == ("metre", "metre", "US survey foot")
    assert found.points[:, 2].tolist() == [1000.0, 1001.0]
    assert names(read(FEET, "EPSG:26910", k1024=1, k3072=2225).crs) == ("metre", "metre", None)


@pytest.mark.parametrize(("number", "model"), [(4979, 2), (4326, 3)])
def test_heights_above_the_ellipsoid(number: int, model: int) -> None:
    geocentric = [[4222000.0, 668000.0, 4717000.0]]
    points = np.array([[9.0, 48.0, 5.0]] if model == 2 else geocentric)
    found = read(points, "EPSG:25832", k1024=model, k2048=number)
    assert names(found.crs) == ("metre", "metre", "metre")
    system = parse_crs(found.crs)
    assert system is not None
    assert (system.kind, system.name) == ("projected", "ETRS89 / UTM zone 32N")


def test_a_system_of_heights_that_both_have_needs_no_grid() -> None:
    points = np.array([[155000.0, 463000.0, 5.5]])
    found, _ = transform(points, "EPSG:28992+5709", "EPSG:25832+5709")
    assert found[0, 2] == 5.5
    assert np.array_equal(found[:, :2], transform(points, "EPSG:28992", "EPSG:25832")[0][:, :2])


def band_in(unit: str) -> bytes:
    """A GeoTIFF whose band says a unit, if any."""
    with rasterio.MemoryFile() as memory:
        with memory.open(
            driver="GTiff", count=1, height=3, width=4, dtype=np.float64,
            transform=Affine(2.0, 0.0, 500000.0, 0.0, -2.0, 5400000.0),
        ) as file:  # fmt: skip
            file.write(HEIGHTS, 1)
            file.units = (unit,)
        return bytes(memory.getbuffer())


@pytest.mark.parametrize(
    ("unit", "source", "target", "factor"),
    [
        ("ft", "EPSG:26910", "EPSG:32610", 1),  # neither says what heights are: the band still does
        ("ft", "EPSG:26910", "EPSG:26910+5703", 0.3048),
        ("US survey foot", "EPSG:26910", "EPSG:26910+5703", 1200 / 3937),
        ("US survey foot", "EPSG:26910", "EPSG:26910+6360", 1),
        ("metre", "EPSG:26910", "EPSG:26910+6360", 3937 / 1200),
        ("ft", "EPSG:26910+5703", "EPSG:32610", 0.3048),  # heights keep their system
        ("", "EPSG:26910+6360", "EPSG:26910+5703", 1200 / 3937),
    ],
)
def test_heights_of_a_band_in_another_system(
    unit: str, source: str, target: str, factor: float
) -> None:
    data = band_in(unit)
    found = lm.read(io.BytesIO(data), format="tif", src_crs=source, dst_crs=target)
    np.testing.assert_allclose(found.points[:, 2], HEIGHTS.ravel() * factor, rtol=1e-15)
    states_heights = "+" in source + target
    layout = found.metadata["raster"]
    assert layout.get("unit") == (None if states_heights or not unit else unit)
    assert layout["width"] == 4
    chunks = [*lm.read_chunks(io.BytesIO(data), format="tif", src_crs=source, dst_crs=target)]
    assert np.array_equal(chunks[0].points, found.points)


def test_a_unit_that_is_not_known_is_not_converted() -> None:
    data = band_in("cubits")
    found = lm.read(io.BytesIO(data), format="tif", src_crs="EPSG:26910", dst_crs="EPSG:32610")
    assert found.metadata["raster"]["unit"] == "cubits"
    with pytest.raises(InputError, match=r"heights are in 'cubits', .*: give a system without hei"):
        lm.read(io.BytesIO(data), format="tif", src_crs="EPSG:26910", dst_crs="EPSG:26910+5703")
