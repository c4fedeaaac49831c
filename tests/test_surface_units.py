"""Heights in another unit than lengths: angles and areas in space are those on the ground."""

from __future__ import annotations

import numpy as np
import pytest

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
