"""Points of GeoJSON and GeoPackage: where they are, what they are called, what is left out."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import geopandas
import numpy as np
import pytest
import shapely
from commands import failed, liftmesh as run
from hypothesis import given, strategies as st

import liftmesh
from liftmesh.errors import FormatError
from liftmesh.vector.clouds import points_of

ROWS = [[0, 0, 1], [10, 0, 5], [0, 10, 3], [10, 10, 9], [4, 6, 7.5]]
PLACES = [[2.0, 3.0], [4.0, 6.0], [8.5, 1.25], [99.0, 5.0]]


def feature(place: Any, kind: str = "Point", **properties: Any) -> dict[str, Any]:
    geometry = {"type": kind, "coordinates": place}
    return {"type": "Feature", "properties": properties, "geometry": geometry}


def saved(path: Path, *features: Any, **more: Any) -> Path:
    tree = {"type": "FeatureCollection", "features": features, **more}
    path.write_text(json.dumps(tree))
    return path


@pytest.fixture
def tin(tmp_path: Path) -> Path:
    surface = liftmesh.triangulate(ROWS, crs="EPSG:25832")
    return surface.save(tmp_path / "tin.ply") and tmp_path / "tin.ply"


def test_points_keep_their_numbers_and_the_rest_is_named(tmp_path: Path) -> None:
    several = feature([[5, 6], [7, 8]], "MultiPoint", id=2, name="B")
    road = feature([[0, 0], [1, 1]], "LineString", id=5, width=3)
    nowhere = {"type": "Feature", "properties": {"id": 6}, "geometry": None}
    held = [feature([1, 2, 30], id=1, name="A", depth=2.5, X=1), several, road, nowhere]
    found = points_of(saved(tmp_path / "a.geojson", *held), None)
    assert found.points[0].tolist() == [1, 2, 30]
    np.testing.assert_array_equal(found.points[1:], [[5, 6, np.nan], [7, 8, np.nan]])
    assert found.attributes["id"].tolist() == [1, 2, 2]
    assert found.attributes["id"].dtype == np.int64
    np.testing.assert_array_equal(found.attributes["depth"], [2.5, np.nan, np.nan])
    assert {*found.attributes} == {"id", "depth"}
    not_read = ("column name (object)", "column X", "1 LineString")
    assert found.metadata["not_read"] == not_read


def test_a_bare_geometry_and_numbers_of_any_size(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text('{"type": "MultiPoint", "coordinates": [[1, 2], [3, 4]]}')
    assert points_of(tmp_path / "a.json", None).points.tolist() == [[1, 2, 0], [3, 4, 0]]
    large = [feature([1, 2], small=True, large=2**62, huge=10**400), feature([3, 4], large=5)]
    found = points_of(saved(tmp_path / "b.geojson", *large), None, flat=True)
    assert found.attributes["large"].tolist() == [2**62, 5]
    np.testing.assert_array_equal(found.attributes["small"], [1, np.nan])
    assert found.metadata["not_read"] == ("column huge (object)",)


@pytest.mark.parametrize("is_one_feature", [True, False])
def test_a_value_for_every_point_and_property_has_a_limit(tmp_path: Path, is_one_feature) -> None:
    """Few bytes can state many points, and many properties that all of them have, or one each."""
    names = [f"a{k}" for k in range(3000)]
    several = feature([[1, 2]] * 3000, "MultiPoint", **dict.fromkeys(names, 1))
    held = [several] if is_one_feature else [feature([1, 2], **{each: 1}) for each in names]
    with pytest.raises(FormatError, match=r"points or more with [\d,]+ properties are far"):
        points_of(saved(tmp_path / "a.geojson", *held), None, flat=True)
    few = feature([[1, 2]] * 3000, "MultiPoint", **dict.fromkeys(names[:100], 1))
    found = points_of(saved(tmp_path / "a.geojson", few), None, flat=True)
    assert len(found.attributes) == 100


@given(
    st.lists(
        st.tuples(
            st.floats(allow_nan=False, allow_infinity=False),
            st.floats(allow_nan=False, allow_infinity=False),
            st.integers(-(2**63), 2**63 - 1),
        ),
        min_size=1,
        max_size=20,
    )
)
def test_every_bit_of_coordinates_and_numbers_is_kept(tmp_path_factory, rows) -> None:
    path = tmp_path_factory.mktemp("points") / "a.geojson"
    held = (feature([x, y], id=number) for x, y, number in rows)
    found = points_of(saved(path, *held), None, flat=True)
    expected = np.array([row[:2] for row in rows])
    assert found.points[:, :2].tobytes() == expected.tobytes()
    assert found.attributes["id"].tolist() == [row[2] for row in rows]


@pytest.mark.parametrize("suffix", ["geojson", "gpkg"])
def test_heights_at_points_of_shapes(tin: Path, tmp_path: Path, suffix: str) -> None:
    shapes = [*map(shapely.Point, PLACES), shapely.LineString([[0, 0], [1, 1]])]
    values = {"id": [7, 8, 9, 10, 11], "owner": [*"abcde"]}
    geopandas.GeoDataFrame(values, geometry=shapes, crs="EPSG:25832").to_file(
        tmp_path / f"at.{suffix}"
    )
    done = run("sample", tin, tmp_path / "h.csv", "--at", tmp_path / f"at.{suffix}")
    assert done.returncode == 0, done.stderr
    assert f"at.{suffix}: not read: column owner (object), 1 LineString" in done.stderr
    assert "3 of 4 points have a height" in done.stderr
    found = liftmesh.read(tmp_path / "h.csv")
    expected = liftmesh.triangulate(ROWS).sample(PLACES)
    np.testing.assert_array_equal(found.points, np.column_stack([PLACES, expected]))
    assert found.attributes["id"].tolist() == [7, 8, 9, 10]


def test_a_layer_of_several(tin: Path, tmp_path: Path) -> None:
    out = [tmp_path / "heights.csv"]
    path = tmp_path / "all.gpkg"
    for name, place in (("wells", [2, 3]), ("springs", [4, 6])):
        points = geopandas.GeoDataFrame(geometry=[shapely.Point(place)], crs="EPSG:25832")
        points.to_file(path, layer=name)
    done = run("sample", tin, *out, "--at", path, "--at-layer", "springs")
    assert done.returncode == 0, done.stderr
    assert out[0].read_text().splitlines()[1:] == ["4.0,6.0,7.5"]
    assert "is read" not in done.stderr
    out.append("--overwrite")
    words = ("sample", tin, *out, "--at", path, "--at-layer")
    failed(run(*words, "lakes"), 3, "layers 'wells', 'springs', but not 'lakes'", "--at-layer")
    other = saved(tmp_path / "a.geojson", feature([1, 2]))
    failed(run("sample", tin, *out, "--at", other, "--at-layer", "a"), 3, "--at-layer a is of Geo")
    other.with_suffix(".csv").write_text("x,y\n1,2\n")
    done = run("sample", tin, *out, "--at", other.with_suffix(".csv"), "--at-layer", "a")
    failed(done, 3, "a.csv: --at-layer cannot be given: text files take")


def test_points_of_a_shapefile(tin: Path, tmp_path: Path) -> None:
    geopandas.GeoDataFrame({"id": [3]}, geometry=[shapely.Point(4, 6)], crs="EPSG:25832").to_file(
        tmp_path / "at.shp"
    )
    done = run("sample", tin, tmp_path / "h.ply", "--at", tmp_path / "at.shp")
    assert done.returncode == 0, done.stderr
    found = liftmesh.read(tmp_path / "h.ply")
    assert found.points.tolist() == [[4, 6, 7.5]]
    assert found.attributes["id"].tolist() == [3]
    assert found.crs == "EPSG:25832"


def test_the_system_of_the_points_is_passed_on(tmp_path: Path) -> None:
    liftmesh.triangulate(ROWS).save(tmp_path / "tin.ply")
    crs = {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::28992"}}
    saved(tmp_path / "at.geojson", *map(feature, PLACES), crs=crs)
    run("sample", "tin.ply", "h.ply", "--at", "at.geojson", cwd=tmp_path)
    assert "28992" in str(liftmesh.read(tmp_path / "h.ply").crs)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("x,y\n1,2\n", "not GeoJSON"),
        ("[1, 2]", "there is no Point or MultiPoint in it"),
        ('{"type": "FeatureCollection"}', "there is no Point or MultiPoint in it"),
        ('{"type": "Point", "coordinates": []}', "there is no Point or MultiPoint in it"),
        ('{"type": "Point", "coordinates": 5}', "point 0 is 5: give two finite numbers"),
        ('{"type": "Point", "coordinates": [1]}', "point 0 is [1]: give two finite numbers"),
        ('{"type": "Point", "coordinates": {"x": 1}}', "point 0 is {'x': 1}: give two"),
        ('{"type": "MultiPoint", "coordinates": [[1, 2], [1, NaN]]}', "point 1 is [1.0, nan]"),
        ('{"type": "MultiPoint", "coordinates": [[1, 2], ["a", 2]]}', "point 1 is ['a', 2]"),
        ('{"type": "MultiPoint", "coordinates": 7}', "no GeoJSON: a point has type and"),
        ('{"type": "FeatureCollection", "features": [3]}', "no GeoJSON: a point has type and"),
    ],
)
def test_files_that_hold_no_points_are_one_line(
    tin: Path, tmp_path: Path, text: str, said: str
) -> None:
    path = tmp_path / "at.geojson"
    path.write_text(text)
    with pytest.raises(FormatError, match=r"at\.geojson: "):
        points_of(path, None)
    before = {each.name: each.read_bytes() for each in tmp_path.iterdir()}
    failed(run("sample", "tin.ply", "h.csv", "--at", "at.geojson", cwd=tmp_path), 3, said)
    assert {each.name: each.read_bytes() for each in tmp_path.iterdir()} == before


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (("--at", "other.geojson"), 3, "other.geojson is in 'EPSG:28992', the surface in"),
        (("--at", "none.geojson"), 3, "none.geojson: No such file"),
        (("--at", "none.gpkg"), 3, "none.gpkg: No such file"),
        (("--at", "tin.what"), 3, "tin.what: cannot be read as points"),
        (("--at", "-"), 2, "stdin has no suffix"),
    ],
)
def test_points_that_do_not_go_with_the_surface(tin: Path, tmp_path, words, code, said) -> None:
    crs = {"type": "name", "properties": {"name": "EPSG:28992"}}
    saved(tmp_path / "other.geojson", *map(feature, PLACES), crs=crs)
    (tmp_path / "tin.what").write_text("what")
    before = {each.name: each.read_bytes() for each in tmp_path.iterdir()}
    failed(run("sample", "tin.ply", "h.csv", *words, cwd=tmp_path), code, said)
    assert {each.name: each.read_bytes() for each in tmp_path.iterdir()} == before
