"""Names of coordinate systems: as numbers, as other programs know them, and as WKT."""

from __future__ import annotations

import pytest

from liftmesh import FormatError
from liftmesh.crs.description import FOOT, as_wkt, is_number, urn_of
from liftmesh.crs.units import length_unit


@pytest.mark.parametrize("crs", ["epsg:25832", 'PROJCS["ETRS89",AUTHORITY["EPSG","25832"]]'])
def test_other_programs_know_urns(crs: str) -> None:
    assert urn_of(crs) == "urn:ogc:def:crs:EPSG::25832"


def test_numbers_are_written_as_wkt_of_version_1() -> None:
    assert is_number("EPSG:25832")
    assert not is_number('PROJCS["a"]')
    assert str(as_wkt("EPSG:25832")).startswith('PROJCS["ETRS89 / UTM zone 32N",GEOGCS["E')
    assert as_wkt("EPSG:999999") is None


def test_a_format_with_one_unit_for_all_needs_one() -> None:
    assert length_unit("EPSG:25832", "LandXML") == "metre"
    assert length_unit(None, "LandXML") is None
    with pytest.raises(FormatError, match="z is in foot, and the unit of x and y is not known"):
        length_unit(None, "LandXML", FOOT)
    with pytest.raises(FormatError, match="the units of x, y and z are metre and foot"):
        length_unit("EPSG:25832", "LandXML", FOOT)
    with pytest.raises(FormatError, match="the coordinates are geographic"):
        length_unit("EPSG:4326", "LandXML")
