"""In which coordinate system the shapes of files are, and what is read of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from liftmesh import InputError
from liftmesh.vector.files import check_system, own_system, read_shapes, stated_system
from liftmesh.vector.geojson import coordinates_of, crs_member
from liftmesh.vector.polygons import as_regions, regions_in

UTM = {"crs": {"type": "name", "properties": {"name": "EPSG:25832"}}}
CRS84 = {"crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:OGC:1.3:CRS84"}}}
TRIANGLE = {"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [0, 1]]]}


@pytest.mark.parametrize(
    ("tree", "bounds", "stated", "own"),
    [
        (UTM, (4e5, 5e6, 5e5, 6e6), "EPSG:25832", "EPSG:25832"),
        (CRS84, (7, 51, 8, 52), "EPSG:4326", "EPSG:4326"),
        (CRS84, (4e5, 5e6, 5e5, 6e6), "EPSG:4326", None),
        ({}, (7, 51, 8, 52), None, "EPSG:4326"),
        ({}, (4e5, 5e6, 5e5, 6e6), None, None),
        ({"crs": None}, (7, 51, 8, 52), None, None),
        ({"crs": {"type": "link"}}, (7, 51, 8, 52), None, None),
    ],
)
def test_shapes_are_in_the_system_they_name(
    tree: dict[str, Any], bounds: tuple[float, ...], stated: str | None, own: str | None
) -> None:
    assert stated_system(tree) == stated
    assert own_system(tree, bounds) == own


def test_only_another_system_is_refused() -> None:
    check_system("EPSG:25832", UTM, "the polygon")
    check_system("EPSG:25832", {}, "the polygon")
    check_system(None, UTM, "the polygon")
    with pytest.raises(InputError, match=r"^the polygon is in 'EPSG:25832', the surface in 'EPSG"):
        check_system("EPSG:25833", UTM, "the polygon")


def test_a_file_is_read_as_a_tree(tmp_path: Path) -> None:
    path = tmp_path / "point.geojson"
    path.write_text('{"type": "Point", "coordinates": [1, 2]}')
    assert read_shapes(path, "a place", None)["coordinates"] == [1, 2]


def test_regions_are_named_by_property_or_number() -> None:
    field = {"type": "Feature", "properties": {"name": "A 7"}, "geometry": TRIANGLE}
    empty = {"type": "Feature", "properties": {}, "geometry": None}
    other = {"type": "Feature", "properties": {}, "geometry": TRIANGLE}
    regions = as_regions({"type": "FeatureCollection", "features": [field, empty, other]})
    assert [each.name for each in regions] == ["A 7", 2]
    assert regions_in(None, [[0, 0], [1, 0], [1, 1]])[0].name == 0


def test_coordinates_of_several_come_one_by_one() -> None:
    roads = {"type": "MultiLineString", "coordinates": [[[0, 1], [2, 3]], []]}
    assert [*coordinates_of(roads, "LineString")] == [[[0, 1], [2, 3]]]
    assert [*coordinates_of(TRIANGLE, "LineString")] == []


def test_without_a_system_there_is_no_member() -> None:
    assert crs_member(None) == ""
    assert '"crs": {"type": "name"' in crs_member("EPSG:25832")
