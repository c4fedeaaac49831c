"""Units of surfaces: what coordinate systems say, and what slopes are scaled by."""

from __future__ import annotations

import pytest

import liftmesh
from liftmesh.terrain.measures import check_measured, cubic_metres_of
from liftmesh.terrain.surface_data import metres_of, slope_scale, unit_names

POINTS = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]


def surface_in(crs: str | None) -> liftmesh.Surface:
    return liftmesh.triangulate(POINTS, crs=crs)


@pytest.mark.parametrize(
    ("crs", "metres", "names", "volume"),
    [
        ("EPSG:7415", (1.0, 1.0, 1.0), ("metre", "metre"), 1.0),
        ("EPSG:25832", None, ("metre", None), None),
        (None, None, (None, None), None),
    ],
)
def test_units_are_those_that_the_system_says(crs, metres, names, volume) -> None:
    surface = surface_in(crs)
    assert metres_of(surface) == metres
    assert unit_names(surface) == names
    assert cubic_metres_of(surface) == volume


def test_slopes_are_scaled_by_what_is_given_or_known() -> None:
    assert slope_scale(surface_in(None), 0.5) == (0.5, 0.5)
    assert slope_scale(surface_in(None), None) == (1.0, 1.0)
    with pytest.raises(liftmesh.InputError, match=r"^z_factor is 0: give a positive number$"):
        slope_scale(surface_in(None), 0)


def test_no_total_beyond_the_doubles() -> None:
    check_measured(("volume", 4.0))
    with pytest.raises(liftmesh.InputError, match="the area is beyond the largest double"):
        check_measured(("volume", 4.0), ("area", float("inf")))
