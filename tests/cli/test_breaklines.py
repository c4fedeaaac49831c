"""``liftmesh triangulate`` with lines, as a person runs it."""

from __future__ import annotations

import json
from pathlib import Path

import geopandas
import numpy as np
import pytest
import shapely
from commands import failed, liftmesh as run
from surfaces import meadow

import liftmesh

DITCH = [[10.0, 20, -3], [90, 30, -3]]
POND = shapely.Polygon([(20, 60), (40, 60), (40, 80), (20, 80)])


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    np.savetxt(tmp_path / "meadow.csv", meadow(), delimiter=",", header="x,y,z", comments="")
    write(tmp_path, DITCH)
    geopandas.GeoDataFrame(geometry=[POND], crs="EPSG:25832").to_file(tmp_path / "pond.gpkg")
    return tmp_path


def write(folder: Path, *lines: list[list[float]]) -> None:
    content = {"type": "MultiLineString", "coordinates": lines}
    (folder / "ditch.geojson").write_text(json.dumps(content))


def words(folder: Path) -> list[str | Path]:
    files = ["--breaklines", folder / "ditch.geojson", "--holes", folder / "pond.gpkg"]
    return ["triangulate", folder / "meadow.csv", folder / "tin.ply", *files]


def test_a_ditch_and_a_pond(folder) -> None:
    done = run(*words(folder), "--densify", "5", "--json")
    assert done.returncode == 0, done.stderr
    ring = np.array(POND.exterior.coords)
    surface = liftmesh.triangulate(meadow(), breaklines=DITCH, holes=ring, densify=5)
    found = liftmesh.read(folder / "tin.ply")
    np.testing.assert_array_equal(found.points, surface.vertices)
    np.testing.assert_array_equal(found.faces, surface.faces)
    told = json.loads(done.stdout)
    assert told["lines"] == dict(surface.report.lines)
    assert told["n_trimmed"] == surface.mask.sum()
    printed = run(*words(folder), "--overwrite").stdout.splitlines()
    assert any(line.split()[:2] == ["of", "lines"] for line in printed)
    assert run("verify", folder / "tin.ply").returncode == 0


def test_a_draped_line_and_a_boundary(folder) -> None:
    done = run(
        *words(folder)[:3],
        "--soft-breaklines",
        folder / "ditch.geojson",
        "--boundary",
        folder / "pond.gpkg",
    )
    assert done.returncode == 0, done.stderr
    surface = liftmesh.as_surface(folder / "tin.ply")
    assert surface.bounds == (20, 60, 40, 80)


def test_lines_that_cross(folder) -> None:
    write(folder, [[50.0, 5, 5], [50, 95, 5]], DITCH)
    place = "breakline 0 and breakline 1 at (50.0, 25.0), at the heights 5.0 and -3.0"
    failed(
        run(*words(folder)), 3, place, "or --crossing split", "error: ", "pond.gpkg: lines cross"
    )
    done = run(*words(folder), "--crossing", "split")
    assert done.returncode == 0, done.stderr


def test_lines_far_from_the_points_are_told(folder) -> None:
    write(folder, [[1000.0, 5, 5], [1010, 95, 5]])
    done = run(*words(folder), "--json")
    said = "the lines of --breaklines lie beyond all points, which reach from "
    assert (done.returncode, done.stderr.count(said)) == (0, 1)
    assert any(each.startswith(said) for each in json.loads(done.stdout)["notes"])


def test_what_is_refused(folder) -> None:
    plain = words(folder)[:3]
    failed(run(*plain, "--densify", "3"), 2, "--densify is for lines: give --breaklines")
    failed(run(*plain, "--breaklines", folder / "none.gpkg"), 3, "none.gpkg")
    failed(run(*words(folder), "--metric", "1,0,1"), 3, "--metric and lines are given")
    write(folder, [[10.0, 20], [500, 30]])
    beyond = run(*plain, "--breaklines", folder / "ditch.geojson")
    failed(beyond, 3, f"error: {folder / 'ditch.geojson'}: breakline 0 has no heights")
    failed(run(*plain, "--boundary", folder / "ditch.geojson"), 3, "ditch.geojson", "--boundary")
