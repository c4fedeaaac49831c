"""``liftmesh profile``: heights along lines, and lines draped over a surface."""

from __future__ import annotations

import json
from pathlib import Path

import geopandas
import numpy as np
import pytest
import shapely
from commands import failed, liftmesh as run, process
from surfaces import meadow

import liftmesh
from liftmesh.terrain.profile import drape

LINE = [[-5.0, 40.0], [105.0, 45.0], [50.0, 80.0]]
SECOND = [[10.0, 10.0], [20.0, 30.0]]


@pytest.fixture
def tin(tmp_path: Path) -> Path:
    return surface().save(tmp_path / "tin.ply") and tmp_path / "tin.ply"


def surface() -> liftmesh.Surface:
    return liftmesh.triangulate(meadow(), crs="EPSG:25832").trim(max_edge=9)


def features(*lines: list[list[float]], **more: object) -> str:
    held = [
        {"type": "Feature", "geometry": {"type": "LineString", "coordinates": x}} for x in lines
    ]
    return json.dumps({"type": "FeatureCollection", "features": held, **more})


def corners(line: list[list[float]]) -> list[str]:
    return [word for x, y in line for word in ("--along", f"{x},{y}")]


def test_a_line_by_its_corners(tin: Path, tmp_path: Path) -> None:
    done = run("profile", tin, tmp_path / "p.csv", *corners(LINE))
    assert done.returncode == 0, done.stderr
    expected = surface().profile(LINE)
    found = liftmesh.read(tmp_path / "p.csv")
    np.testing.assert_array_equal(found.points, expected.points)
    np.testing.assert_array_equal(found.attributes["distance"], expected.distances)
    sizes = np.diff(expected.starts)
    assert len(sizes) > 2
    np.testing.assert_array_equal(found.attributes["part"], np.repeat(np.arange(len(sizes)), sizes))
    assert not found.attributes["line"].any()
    assert f"{len(expected.points):,} points in {len(sizes)} parts of 1 line" in done.stdout
    assert " metre long" in done.stdout
    assert done.stdout.endswith("(unit unknown)\n")  # the system says nothing of heights


def test_lines_of_a_file_and_what_is_said_as_json(tin: Path, tmp_path: Path) -> None:
    (tmp_path / "lines.geojson").write_text(features(LINE, SECOND))
    words = ("--along", tmp_path / "lines.geojson", "--json")
    done = run("profile", tin, tmp_path / "p.csv", *words)
    told = json.loads(done.stdout)
    expected = drape(surface(), [LINE, SECOND])
    assert (told["n_lines"], told["n_parts"]) == (2, len(expected.lines))
    assert told["n_points"] == len(expected.points)
    assert told["length"] == pytest.approx(expected.lengths.sum())
    assert told["lowest"] == expected.points[:, 2].min()
    assert (told["unit"], told["height_unit"]) == ("metre", None)
    lines = liftmesh.read(tmp_path / "p.csv").attributes["line"]
    assert sorted({*lines.tolist()}) == [0, 1]


@pytest.mark.parametrize("suffix", ["geojson", "gpkg"])
def test_draped_lines_are_written_as_shapes(tin: Path, tmp_path: Path, suffix: str) -> None:
    source, target = tmp_path / f"in.{suffix}", tmp_path / f"out.{suffix}"
    lines = [shapely.MultiLineString([LINE, SECOND]), shapely.Point(1, 1)]
    geopandas.GeoDataFrame(geometry=lines, crs="EPSG:25832").to_file(source)
    done = run("profile", tin, target, "--along", source)
    assert done.returncode == 0, done.stderr
    expected = drape(surface(), [LINE, SECOND])
    found = geopandas.read_file(target)
    assert found.crs.to_epsg() == 25832
    assert found["line"].tolist() == expected.lines.tolist()
    np.testing.assert_allclose(found["length"], expected.lengths)
    parts = np.split(expected.points, expected.starts[1:-1])
    for shape, part in zip(found.geometry, parts, strict=True):
        np.testing.assert_array_equal(shapely.get_coordinates(shape, include_z=True), part)
    np.testing.assert_allclose(found.geometry.length, found["length"])


def test_lines_of_a_shapefile(tin: Path, tmp_path: Path) -> None:
    lines = geopandas.GeoDataFrame(geometry=[shapely.LineString(LINE)], crs="EPSG:25832")
    lines.to_file(tmp_path / "line.shp")
    done = run("profile", tin, tmp_path / "p.ply", "--along", tmp_path / "line.shp")
    assert done.returncode == 0, done.stderr
    expected = surface().profile(LINE).points
    np.testing.assert_array_equal(liftmesh.read(tmp_path / "p.ply").points, expected)


def test_corners_of_a_table_and_a_cloud(tin: Path, tmp_path: Path) -> None:
    (tmp_path / "line.csv").write_text("x,y\n10,10\n20,30\n")
    liftmesh.write(tmp_path / "line.ply", np.column_stack([SECOND, [7, 9]]))
    expected = surface().profile(SECOND).points
    done = process("profile", tin, "-", "--output-format", "csv", "--along", tmp_path / "line.csv")
    assert done.returncode == 0, done.stderr
    assert "of 1 line" in done.stderr
    lines = done.stdout.splitlines()
    assert len(lines) == len(expected) + 1
    assert lines[0].split(",")[:4] == ["x", "y", "z", "distance"]
    assert run("profile", tin, tmp_path / "p.npz", "--along", tmp_path / "line.ply").returncode == 0
    np.testing.assert_array_equal(liftmesh.read(tmp_path / "p.npz").points, expected)


@pytest.mark.parametrize(
    ("along", "code", "said"),
    [
        (["0,0"], 2, "'0,0' is one corner: give another --along X,Y"),
        (["0,0", "1,x"], 2, "'1,x' is not a corner x,y"),
        (["0,0", "1"], 2, "'1' is not a corner x,y"),
        (["0,0", "1,nan"], 2, "'1,nan' is not a corner x,y"),
        (["0,0", "1,2,3"], 2, "'1,2,3' is not a corner x,y"),
        (["a.geojson", "b.geojson"], 2, "'a.geojson' is not a corner x,y"),
        (["500,500", "600,600"], 3, "no part of a line is over faces"),
        (["none.geojson"], 3, "none.geojson: No such file"),
        (["none.csv"], 3, "none.csv: No such file"),
        (["none.gpkg"], 3, "none.gpkg: No such file"),
        (["point.geojson"], 3, "there is no LineString or MultiLineString in it"),
        (["short.geojson"], 3, "short.geojson: a line needs two corners"),
        (["wrong.geojson"], 3, "wrong.geojson: a line cannot be read"),
        (["text.geojson"], 3, "text.geojson: not GeoJSON"),
        (["other.geojson"], 3, "other.geojson is in 'EPSG:28992', the surface in"),
        (["one.csv"], 3, "one.csv holds 1 of the two corners"),
        (["dutch.ply"], 3, "dutch.ply is in 'EPSG:28992'"),
        (["out.csv"], 2, "same file"),
    ],
)
def test_lines_that_are_none(tin: Path, tmp_path: Path, along, code: int, said: str) -> None:
    crs = {"type": "name", "properties": {"name": "EPSG:28992"}}
    (tmp_path / "point.geojson").write_text('{"type": "Point", "coordinates": [1, 2]}')
    (tmp_path / "short.geojson").write_text(features([[0, 0]]))
    (tmp_path / "wrong.geojson").write_text(features([["a", "b"], [0, 0]]))
    (tmp_path / "text.geojson").write_text("x,y\n1,2\n")
    (tmp_path / "other.geojson").write_text(features(LINE, crs=crs))
    (tmp_path / "one.csv").write_text("x,y\n1,2\n")
    liftmesh.triangulate(meadow(), crs="EPSG:28992").save(tmp_path / "dutch.ply")
    before = {each.name: each.read_bytes() for each in tmp_path.iterdir()}
    words = [word for each in along for word in ("--along", each)]
    failed(run("profile", "tin.ply", "out.csv", *words, cwd=tmp_path), code, said)
    assert {each.name: each.read_bytes() for each in tmp_path.iterdir()} == before


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (("tin.ply", "p.csv"), 2, "--along"),
        (("tin.ply", "p.what", *corners(SECOND)), 3, "p.what"),
        (("tin.ply", "no/p.csv", *corners(SECOND)), 3, "does not exist"),
        (("tin.ply", "no/p.geojson", *corners(SECOND)), 3, "does not exist"),
        (("tin.ply", "tin.ply", *corners(SECOND)), 2, "same file"),
        (("tin.ply", "line.csv", "--along", "line.csv"), 2, "same file"),
        (("tin.ply", "p.csv", *corners([[10, 10], [10, 10]])), 3, "it has no length"),
        (("none.ply", "p.csv", *corners(SECOND)), 3, "none.ply: No such file"),
        (("tin.ply", "p.csv", *corners(SECOND), "--max-edge", "1e-9"), 3, "left"),
    ],
)
def test_other_bad_input(tin: Path, tmp_path: Path, words, code: int, said: str) -> None:
    (tmp_path / "line.csv").write_text("x,y\n10,10\n20,30\n")
    before = {each.name: each.read_bytes() for each in tmp_path.iterdir()}
    failed(run("profile", *words, cwd=tmp_path), code, said)
    assert {each.name: each.read_bytes() for each in tmp_path.iterdir()} == before


def test_planes_that_are_turned_have_no_system(tmp_path: Path) -> None:
    wall = [[0, 0, 0], [4, 1, 0], [0, 2, 5], [4, 1, 5]]
    surface = liftmesh.triangulate(wall, plane="xz", crs="EPSG:25832")
    assert drape(surface, [[[0, 3], [4, 4]]]).crs is None
    np.savetxt(tmp_path / "wall.csv", wall, "%g", ",", header="x,y,z", comments="")
    words = ["--plane", "xz", "--src-crs", "EPSG:25832", "--along", "0,3", "--along", "4,4"]
    done = run("profile", "wall.csv", "out.geojson", *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "crs" not in json.loads((tmp_path / "out.geojson").read_text())


def test_what_lies_on_no_face_is_said(tin: Path, tmp_path: Path) -> None:
    done = run("profile", tin, tmp_path / "p.csv", *corners(LINE), "--json")
    found = json.loads(done.stdout)
    whole = float(np.hypot(*np.diff(LINE, axis=0).T).sum())
    assert found["length_of_lines"] == pytest.approx(whole)
    assert found["length"] < whole - 5
    done = run("profile", tin, tmp_path / "p.csv", *corners(LINE), "--overwrite")
    outside = f"{whole - found['length']:.6g} of {whole:.6g} that the lines are long lie on no face"
    assert outside in done.stderr
    whole_tin = liftmesh.triangulate(meadow()).save(tmp_path / "whole.ply").path
    done = run("profile", whole_tin, tmp_path / "q.csv", *corners(SECOND))
    assert "on no face" not in done.stderr


@pytest.mark.parametrize("suffix", ["csv", "gpkg"])
def test_cross_sections(tin: Path, tmp_path: Path, suffix: str) -> None:
    (tmp_path / "lines.geojson").write_text(features(LINE, SECOND))
    target = tmp_path / f"out.{suffix}"
    words = (
        "--along",
        tmp_path / "lines.geojson",
        "--spacing",
        "20",
        "--half-width",
        "7.5",
        "--json",
    )
    done = run("profile", tin, target, *words)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    each = [surface().cross_sections(line, spacing=20, half_width=7.5) for line in (LINE, SECOND)]
    stations = np.concatenate([found.stations for found in each])
    assert told["n_sections"] == 9 + 2
    assert told["length_of_sections"] == pytest.approx(11 * 15)
    assert told["n_parts"] == len(stations)
    if suffix == "gpkg":
        found = geopandas.read_file(target)
        assert found["line"].tolist() == np.repeat([0, 1], [len(x.lines) for x in each]).tolist()
        np.testing.assert_array_equal(found["station"], stations)
        np.testing.assert_allclose(found["start"].min(), -7.5)
    else:
        values = liftmesh.read(target).attributes
        offsets = np.concatenate([found.distances for found in each])
        np.testing.assert_array_equal(values["offset"], offsets)
        assert {*values["station"].tolist()} == {*stations.tolist()}


def test_cross_sections_need_both(tin: Path, tmp_path: Path) -> None:
    done = run("profile", tin, tmp_path / "p.csv", *corners(LINE), "--spacing", "20")
    failed(done, 2, "--spacing and --half-width go together")
    many = ("--spacing", "1e-9", "--half-width", "1")
    done = run("profile", tin, tmp_path / "p.csv", *corners(LINE), *many)
    failed(done, 2, "cross sections: give a larger one")
