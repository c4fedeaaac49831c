"""``liftmesh voronoi``: cells as files."""

from __future__ import annotations

import io
import json
from pathlib import Path
from xml.etree import ElementTree as ET

import geopandas
import numpy as np
import pytest
import shapely
import shapely.affinity
from commands import liftmesh as command, process

import liftmesh
from liftmesh import Cloud

RNG = np.random.default_rng(1803)
POINTS = np.c_[RNG.random((60, 2)) * 10, np.zeros(60)]
SIZES = RNG.random(60)
COAST = shapely.Polygon([(0, 0), (9, 1), (10, 9), (4, 4), (1, 9)])


@pytest.fixture
def table(tmp_path: Path) -> Path:
    path = tmp_path / "schools.csv"
    liftmesh.write(path, Cloud(POINTS, attributes={"size": SIZES, "pupils": np.arange(60)}))
    (tmp_path / "city.geojson").write_text(shapely.to_geojson(COAST))
    mixed = geopandas.GeoSeries([COAST, shapely.Point(0, 0)], crs="EPSG:32633")
    mixed.to_file(tmp_path / "points.gpkg")
    return path


def test_cells_carry_the_values_of_their_rows(table: Path) -> None:
    done = command("voronoi", table, "out.geojson", "--domain", "city.geojson", cwd=table.parent)
    assert done.returncode == 0, done.stderr
    expected = liftmesh.voronoi(POINTS, domain=COAST)
    full = 60 - len(expected.empty)
    assert f"out.geojson: {full} cells in a polygon of 5 corners" in " ".join(done.stdout.split())
    found = json.loads((table.parent / "out.geojson").read_text())
    held = [feature["properties"] for feature in found["features"]]
    assert [each["pupils"] for each in held] == [*range(60)]
    assert [each["size"] for each in held] == SIZES.tolist()
    assert [each["area"] for each in held] == expected.areas.tolist()
    shapes = [f["geometry"] and shapely.geometry.shape(f["geometry"]) for f in found["features"]]
    assert [row for row, shape in enumerate(shapes) if shape is None] == expected.empty.tolist()
    areas = [0.0 if shape is None else shape.area for shape in shapes]
    np.testing.assert_allclose(areas, expected.areas, atol=1e-12)


@pytest.mark.parametrize("option", ["weights", "radii"])
def test_power_cells_in_a_geopackage(table: Path, option: str) -> None:
    words = ("--domain", "-1,-1,11,11", f"--{option}", "size", "--json")
    done = command("voronoi", table, "out.gpkg", *words, cwd=table.parent)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    box = (-1, -1, 11, 11)
    expected = liftmesh.power_diagram(POINTS, **{option: SIZES}, domain=box)
    assert told["n_hidden"] == len(expected.hidden)
    assert told["n_cells"] == 60 - len(expected.empty)
    assert told["domain"] == "the box (-1.0, -1.0, 11.0, 11.0)"
    frame = geopandas.read_file(table.parent / "out.gpkg")
    np.testing.assert_array_equal(frame["pupils"], np.arange(60))
    np.testing.assert_allclose(frame.geometry.area.fillna(0), expected.areas)
    assert frame.geometry.isna().to_numpy().nonzero()[0].tolist() == expected.empty.tolist()


def test_the_default_box_is_said_and_pictures_are_drawn(table: Path) -> None:
    done = process("voronoi", table, "-", "--output-format", "svg", cwd=table.parent)
    assert done.returncode == 0, done.stderr
    assert "widened by" in done.stderr
    assert "svg does not keep" in done.stderr
    root = ET.parse(io.StringIO(done.stdout)).getroot()
    assert len(root) == 60
    named = process(
        "voronoi", table, "-", "--output-format", "svg", "--domain", "bounds", cwd=table.parent
    )
    assert named.stdout == done.stdout


ORDINARY = "x;y;area;row;w;name\n" + "".join(
    f"{x};{y};{10 * i};{100 + i};{'' if i == 2 else i};tree {i}\n"
    for i, (x, y, _) in enumerate(POINTS[:9].tolist())
)


def told(folder: Path, *words: str) -> tuple[str, str]:
    done = command("voronoi", "trees.csv", *words, cwd=folder)
    assert done.returncode == 0, done.stderr
    return " ".join(done.stdout.split()), " ".join(done.stderr.split())


def test_an_ordinary_table_keeps_its_columns(tmp_path: Path) -> None:
    (tmp_path / "trees.csv").write_text(ORDINARY)
    expected = liftmesh.voronoi(POINTS[:9])
    columns = ["cell_row", "area", "row", "w", "cell_area"]
    for name in ("out.geojson", "out.gpkg"):
        _, said = told(tmp_path, name)
        assert "area is a column of the points: that of cells is cell_area" in said
        assert "row is a column of the points: that of cells is cell_row" in said
        assert "not read: column name (text" in said
        frame = geopandas.read_file(tmp_path / name)
        assert [*frame.columns] == [*columns, "geometry"]
        assert frame["area"].tolist() == [10 * i for i in range(9)]
        assert frame["row"].tolist() == [100 + i for i in range(9)]
        assert np.isnan(frame["w"][2])
        assert frame["cell_row"].tolist() == [*range(9)]
        np.testing.assert_allclose(frame["cell_area"], expected.areas)


def test_heights_are_values_too(tmp_path: Path) -> None:
    (tmp_path / "trees.csv").write_text("x,y,Depth\n0,0,5\n1,0,6\n0,1,7\n")
    told(tmp_path, "out.geojson")
    assert geopandas.read_file(tmp_path / "out.geojson")["Depth"].tolist() == [5, 6, 7]
    (tmp_path / "trees.csv").write_text("x,y,height\n0,0,5\n1,0,6\n0,1,7\n")
    told(tmp_path, "out.geojson", "--overwrite")
    assert geopandas.read_file(tmp_path / "out.geojson")["z"].tolist() == [5, 6, 7]


def test_json_has_no_infinity(tmp_path: Path) -> None:
    (tmp_path / "trees.csv").write_text("x,y,w\n1,1,inf\n2,5,nan\n")
    said, _ = told(tmp_path, "out.geojson", "--domain", "0,0,1e200,1e200")
    assert "does not keep w (1 infinite), area (1 infinite)" in said
    found = json.loads((tmp_path / "out.geojson").read_text(), parse_constant=pytest.fail)
    held = [each["properties"] for each in found["features"]]
    assert [each["w"] for each in held] == [None, None]
    assert [each["area"] for each in held].count(None) == 1


def test_the_system_of_a_domain(tmp_path: Path) -> None:
    (tmp_path / "trees.csv").write_text(ORDINARY)
    utm = geopandas.GeoSeries([COAST], crs="EPSG:32633")
    utm.to_file(tmp_path / "utm.gpkg")
    told(tmp_path, "out.gpkg", "--domain", "utm.gpkg")
    assert geopandas.read_file(tmp_path / "out.gpkg").crs == "EPSG:32633"
    _, said = told(tmp_path, "out.gpkg", "--overwrite", "--domain", "500000,0,500010,10")
    assert "no row lies in the box of the domain" in said
    far = shapely.affinity.translate(COAST, 500_000, 0)  # no degrees, whatever GeoJSON says
    (tmp_path / "far.geojson").write_text(shapely.to_geojson(far))
    told(tmp_path, "out.gpkg", "--overwrite", "--domain", "far.geojson")
    assert geopandas.read_file(tmp_path / "out.gpkg").crs is None
    cloud = Cloud(POINTS, crs="EPSG:25832")
    liftmesh.write(tmp_path / "cloud.ply", cloud)
    done = command("voronoi", "cloud.ply", "other.gpkg", "--domain", "utm.gpkg", cwd=tmp_path)
    assert done.returncode == 3
    assert "the points are in 'ETRS89 / UTM zone 32N', and the domain in" in " ".join(
        done.stderr.split()
    )
    assert not (tmp_path / "other.gpkg").exists()


def test_what_a_file_of_shapes_leaves_unclear_is_a_note(tmp_path: Path) -> None:
    (tmp_path / "trees.csv").write_text(ORDINARY)
    for layer in ("a", "b"):
        coast = geopandas.GeoSeries([COAST], crs="EPSG:32633")
        coast.to_file(tmp_path / "two.gpkg", layer=layer, mode="a" if layer == "b" else "w")
    _, said = told(tmp_path, "out.svg", "--domain", "two.gpkg")
    assert "liftmesh: note: two.gpkg: layer 'a' is read, and 'b' not: save the layer" in said


WRONG = [
    (["out.obj"], 3, "cells are not written as '.obj': give one of .geojson"),
    (
        ["out", "--output-format", "tiff"],
        3,
        "cells are not written as 'tiff': give one of",
    ),
    (["-"], 2, "stdout has no suffix: give the format with --output-format geojson"),
    (
        ["out.svg", "--domain", "none.geojson"],
        2,
        "'none.geojson' is no file: give a file of",
    ),
    (["out.svg", "--domain", "0,0,1"], 2, "XMIN,YMIN,XMAX,YMAX or bounds"),
    (
        ["out.svg", "--domain", "schools.csv"],
        3,
        "schools.csv: cannot be read as a domain: neither GeoJSON nor a GeoPackage",
    ),
    (["out.svg", "--domain", "points.gpkg"], 3, "geometry 1 is Point"),
    (["out.svg", "--domain", "0,0,0,1"], 3, "which has no area"),
    (["out.svg", "--weights", "weight"], 3, "the points have no values of that name"),
    (["out.svg", "--weights", "size", "--radii", "size"], 3, "both --weights and --radii"),
]


@pytest.mark.parametrize(("words", "code", "said"), WRONG)
def test_errors_are_one_line(table: Path, words: list[str], code: int, said: str) -> None:
    done = command("voronoi", table, *words, cwd=table.parent)
    assert done.returncode == code
    assert said in " ".join(done.stderr.split())
    assert not (table.parent / words[0]).exists()


def test_cells_of_disks(table: Path) -> None:
    box = (0, 0, 10, 10)
    words = ("--domain", "0,0,10,10", "--disks", "size")
    done = command(
        "voronoi", table, "out.gpkg", *words, "--max-deviation", "0.05", cwd=table.parent
    )
    assert done.returncode == 0, done.stderr
    assert "arcs are polylines within 0.05" in " ".join(done.stdout.split())
    expected = liftmesh.apollonius_diagram(POINTS[:, :2], SIZES, domain=box, max_deviation=0.05)
    frame = geopandas.read_file(table.parent / "out.gpkg")
    assert frame["area"].tolist() == expected.areas.tolist()
    full = expected.areas > 0
    np.testing.assert_allclose(frame.geometry.area[full], expected.areas[full], rtol=1e-9)
    told = command("voronoi", table, "out.ply", *words, "--json", cwd=table.parent)
    default = liftmesh.apollonius_diagram(POINTS[:, :2], SIZES, domain=box)
    assert json.loads(told.stdout)["max_deviation"] == default.max_deviation
    assert json.loads(told.stdout)["n_hidden"] == len(default.hidden)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--disks", "size", "--radii", "size"), "other cells than --weights and --radii"),
        (("--max-deviation", "0.1"), "--max-deviation needs --disks"),
        (("--disks", "reach"), "no values of that name: there are 'size', 'pupils'"),
        (
            ("--disks", "size", "--max-deviation", "-1"),
            "--max-deviation is -1.0: give a positive, finite",
        ),
    ],
)
def test_wrong_options_of_disks(table: Path, words: tuple[str, ...], message: str) -> None:
    done = command("voronoi", table, "out.geojson", *words, cwd=table.parent)
    assert done.returncode != 0
    assert message in " ".join(done.stderr.split())
    assert not (table.parent / "out.geojson").exists()
