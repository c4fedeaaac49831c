"""``liftmesh refine``: polygons, points and edges of files become good triangles."""

from __future__ import annotations

import json
import re
from pathlib import Path

import meshio
import numpy as np
import pytest
from commands import failed, liftmesh as command

import liftmesh
from liftmesh import Cloud

SQUARE = np.array([[0, 0], [8, 0], [8, 8], [0, 8]], np.float64)
HOLE = np.array([[3, 2], [5, 2], [5, 5]], np.float64)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    rings = [[*ring.tolist(), ring[0].tolist()] for ring in (SQUARE, HOLE)]
    tree = {"type": "Polygon", "coordinates": rings}
    (tmp_path / "land.geojson").write_text(json.dumps(tree))
    rows = np.concatenate([SQUARE, HOLE])
    (tmp_path / "points.csv").write_text("x,y\n" + "".join(f"{x},{y}\n" for x, y in rows))
    (tmp_path / "pairs.txt").write_text("0 1\n1 2\n2 3\n3 0\n4 5\n5 6\n6 4\n")
    return tmp_path


def test_polygons(folder: Path) -> None:
    words = ("refine", "land.geojson", "a.ply", "--max-area", "0.5", "--json")
    done = command(*words, cwd=folder)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    expected = liftmesh.refine([[SQUARE, HOLE]], max_area=0.5)
    assert told["n_triangles"] == expected.triangulation.nsimplex
    assert (told["n_added"], told["n_below"]) == (len(expected.steiner), 0)
    assert told["n_too_large"] == 0
    assert (told["min_angle"], told["capped"]) == (expected.min_angle, False)
    mesh = liftmesh.read(folder / "a.ply")
    assert np.array_equal(mesh.edges, expected.triangulation.constraints)
    assert mesh.metadata["carved"]
    assert liftmesh.verify(mesh).valid
    assert command("verify", "a.ply", cwd=folder).returncode == 0
    finer = command("refine", "a.ply", "b.ply", "--size", "0.3", "--json", cwd=folder)
    assert finer.returncode == 0, finer.stderr
    assert json.loads(finer.stdout)["n_triangles"] > 2 * told["n_triangles"]
    assert liftmesh.verify(liftmesh.read(folder / "b.ply")).valid


def test_smoothing(folder: Path) -> None:
    words = ("--max-area", "0.5", "--smooth", "3", "--json")
    done = command("refine", "land.geojson", "a.ply", *words, cwd=folder)
    assert done.returncode == 0, done.stderr
    expected = liftmesh.refine([[SQUARE, HOLE]], max_area=0.5, smooth=3)
    mesh = liftmesh.read(folder / "a.ply")
    assert np.array_equal(mesh.points[:, :2], expected.triangulation.points)
    assert liftmesh.verify(mesh).valid


def test_points_with_edges_and_without(folder: Path) -> None:
    words = ("--edges", "pairs.txt", "--carve", "holes", "--min-angle", "20", "--conforming")
    done = command("refine", "points.csv", "a.obj", *words, cwd=folder)
    assert done.returncode == 0, done.stderr
    assert "smallest angle" in done.stdout
    done = command("refine", "points.csv", "b.ply", "--json", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert liftmesh.verify(liftmesh.read(folder / "b.ply")).valid
    points = np.concatenate([SQUARE, HOLE])
    plain = liftmesh.refine(liftmesh.delaunay(points)).triangulation
    assert json.loads(done.stdout)["n_triangles"] == plain.nsimplex


def test_markers_of_segments_reach_the_solver(folder: Path) -> None:
    nodes = "".join(f"{k} {x} {y}\n" for k, (x, y) in enumerate([*SQUARE, *HOLE]))
    pairs = ((0, 1, 5), (1, 2, 6), (2, 3, 5), (3, 0, 0), (4, 5, 9), (5, 6, 9), (6, 4, 9))
    edges = "".join(f"{k} {a} {b} {tag}\n" for k, (a, b, tag) in enumerate(pairs))
    (folder / "plate.poly").write_text(f"7 2 0 0\n{nodes}7 1\n{edges}1\n0 4.5 3\n")
    for kind in ("su2", "poly", "msh", "2dm"):
        done = command("refine", "plate.poly", f"a.{kind}", "--max-area", "1", cwd=folder)
        assert done.returncode == 0, done.stderr
    back = liftmesh.read(folder / "a.poly")
    x, y = back.points[back.edges].transpose(2, 0, 1)[:2]
    sides = [(y == 0), (x == 8), (y == 8), (x == 0)]
    expected = np.select([each.all(axis=1) for each in sides], [5, 6, 5, 0], 9)
    assert np.array_equal(back.metadata["markers"], expected)
    strings = liftmesh.read(folder / "a.2dm")
    assert {*strings.metadata["markers"].tolist()} == {5, 6, 9, 10}
    mesh = meshio.read(folder / "a.su2")
    ends = mesh.points[mesh.cells_dict["line"]].mean(axis=1)
    numbers = mesh.cell_data_dict["su2:tag"]["line"]
    assert {*numbers[ends[:, 0] == 0]} == {10}
    assert {*numbers[ends[:, 0] == 8]} == {6}
    words = ("--edges", "pairs.txt", "--carve", "holes")
    done = command("refine", "plate.poly", "b.poly", *words, cwd=folder)
    assert "7 edges and holes and markers of its own not taken" in done.stderr
    assert "markers" not in liftmesh.read(folder / "b.poly").metadata


def test_what_stays_below_is_counted(folder: Path) -> None:
    (folder / "wedge.csv").write_text("x,y\n0,0\n9,0\n9,1\n")
    done = command("refine", "wedge.csv", "a.ply", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert "below by input angle" in done.stdout
    done = command(
        "refine", "wedge.csv", "b.ply", "--size", "0.01", "--max-points", "9", cwd=folder
    )
    assert done.returncode == 0, done.stderr
    assert "--max-points" in done.stderr
    assert re.search(r"too large +[1-9]", done.stdout)
    (folder / "far.csv").write_text("x,y\n" + "".join(f"{x},{y}\n" for x, y in SQUARE / 2 + 1e15))
    done = command("refine", "far.csv", "d.ply", "--size", "0.01", "--json", cwd=folder)
    assert "triangles stay too large" in done.stderr
    assert json.loads(done.stdout)["n_too_large"] == 4
    done = command("refine", "wedge.csv", "c.ply", "--min-angle", "0", "--json", cwd=folder)
    assert json.loads(done.stdout)["n_added"] == 0


def test_what_is_refused(folder: Path) -> None:
    words = ("refine", "land.geojson", "a.ply")
    failed(command(*words, "--min-angle", "50", cwd=folder), 3, "--min-angle is 50.0: give degrees")
    failed(command(*words, "--size", "0", cwd=folder), 2, "--size is 0")
    failed(command(*words, "--smooth", "-1", cwd=folder), 2, "--smooth is -1: give a whole number")
    failed(command(*words, "--smooth", "2000", cwd=folder), 3, "--smooth is 2000: give a whole")
    failed(command(*words, "--flat", cwd=folder), 2, "holds polygons alone")
    failed(command("refine", "none.geojson", "a.ply", cwd=folder), 3, "none.geojson")
    lines = Cloud(np.eye(3), edges=np.array([[0, 1]]))
    liftmesh.write(folder / "high.ply", lines)
    done = command("refine", "high.ply", "a.ply", "--size", "0.1", cwd=folder)
    failed(done, 3, "high.ply has heights, so that", "give points without heights")
    liftmesh.write(folder / "rows.ply", Cloud(np.eye(3)))
    done = command("refine", "rows.ply", "a.ply", "--carve", "holes", cwd=folder)
    failed(done, 3, "--carve", "triangulate --breaklines")


@pytest.mark.parametrize("is_mesh", [True, False])
def test_surfaces_keep_their_heights(is_mesh: bool, folder: Path) -> None:
    rows = np.random.default_rng(8).random((60, 3))
    surface = liftmesh.triangulate(rows)
    liftmesh.write(folder / "tin.ply", surface if is_mesh else Cloud(rows))
    words = ("refine", "tin.ply", "a.ply", "--max-area", "0.01")
    done = command(*words, "--json", cwd=folder)
    assert done.returncode == 0, done.stderr
    expected = liftmesh.refine(surface, max_area=0.01)
    told, mesh = json.loads(done.stdout), liftmesh.read(folder / "a.ply")
    assert told["max_deviation"] == pytest.approx(expected.max_deviation)
    assert told["n_added"] == mesh.attributes["steiner"].sum() == len(expected.steiner)
    np.testing.assert_allclose(mesh.points, expected.surface.vertices, atol=1e-9)
    assert liftmesh.verify(mesh).valid
    done = command("refine", "a.ply", "b.vtu", "--max-area", "0.005", cwd=folder)
    assert "deviation of heights" in done.stdout, done.stderr
    assert "carved" not in done.stdout
    edges = np.array([[0, 1]])
    faces = np.array([[0, 1, 2]])
    numbered = Cloud(np.eye(3), faces=faces, edges=edges, metadata={"markers": [4]})
    liftmesh.write(folder / "c.ply", numbered)
    done = command("refine", "c.ply", "c.vtu", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert "markers of edges are left out" in done.stderr


def test_the_ground_of_lidar_is_refined(folder: Path) -> None:
    rows = np.random.default_rng(8).random((60, 3))
    classes = np.repeat(np.array([2, 5], np.uint8), 30)
    liftmesh.write(folder / "a.las", Cloud(rows, attributes={"classification": classes}))
    done = command("refine", "a.las", "a.ply", "--json", cwd=folder)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["n_rows"] - told["n_added"] == 30
