"""Heights keep their unit where coordinates are transformed to a system of the plane."""

from __future__ import annotations

import io

import numpy as np
import pytest
from lidar import encoded, geo_keys, record, records, with_records

import liftmesh as lm
from liftmesh import Cloud, DataWarning
from liftmesh.crs import described
from liftmesh.transformation import transformed

FEET = np.array([[6_000_000.0, 2_000_000.0, 1000.0], [6_000_100.0, 2_000_000.0, 1001.0]])


def read(points: np.ndarray, to_crs: str, **keys: int) -> Cloud:
    data = encoded(records(points, 6, version="1.4", offset=(0, 0, 0)))
    made = record(b"LASF_Projection", 34735, geo_keys(**keys))
    return lm.read(io.BytesIO(with_records(data, made)), format="las", to_crs=to_crs)


def names(crs: str | None) -> tuple[str | None, ...]:
    system = described(crs)
    assert system is not None
    return tuple(each.name if each else None for each in system.units)


def test_feet_of_height_over_metres_are_said() -> None:
    found = read(FEET, "EPSG:26910", k1024=1, k3072=2225, k4096=6360)
    assert found.crs == "EPSG:26910+6360"
    assert found.points[:, 2].tolist() == [1000.0, 1001.0]
    plane = transformed(FEET, "EPSG:2225", "EPSG:26910")
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
    system = described(found.crs)
    assert system is not None
    assert (system.kind, system.name) == ("projected", "ETRS89 / UTM zone 32N")


def test_a_system_of_heights_that_both_have_needs_no_grid() -> None:
    points = np.array([[155000.0, 463000.0, 5.5]])
    found = transformed(points, "EPSG:28992+5709", "EPSG:25832+5709")
    assert found[0, 2] == 5.5
    assert np.array_equal(found[:, :2], transformed(points, "EPSG:28992", "EPSG:25832")[:, :2])
