"""``liftmesh tile``: a folder of triangles, what it says, and what it refuses."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from commands import liftmesh as command, on_terminal

import liftmesh

POINTS = np.random.default_rng(4).integers(0, 80, (3_000, 2)).astype(np.float64)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    np.save(tmp_path / "a.npy", POINTS[:1_000])
    np.save(tmp_path / "b.npy", POINTS[1_000:])
    return tmp_path


def test_several_files_become_one_folder(folder: Path) -> None:
    done = command("tile", "a.npy", "b.npy", "out", "--tile-rows", 500, cwd=folder)
    assert (done.returncode, done.stderr) == (0, "")
    found = liftmesh.open_tiled(folder / "out")
    assert f"triangles   {found.nsimplex:,}\n" in done.stdout
    assert f"shards      {len(found.shards)} in {folder / 'out'}\n" in done.stdout
    expected = liftmesh.tile([folder / "a.npy", folder / "b.npy"], folder / "b", tile_rows=500)
    assert found.manifest == expected.manifest
    assert found.nsimplex == liftmesh.delaunay(POINTS).nsimplex


def test_counts_as_json(folder: Path) -> None:
    options = ("--memory", "1GB", "--scratch", folder / "scratch", "--threads", 1, "--json")
    done = command("tile", "a.npy", "b.npy", "out", *options, cwd=folder)
    told = json.loads(done.stdout)
    expected = liftmesh.delaunay(POINTS)
    assert told["folder"] == str(folder / "out")
    assert (told["n_rows"], told["n_triangles"]) == (3_000, expected.nsimplex)
    assert told["n_duplicates"] == len(expected.duplicates)
    assert told["merges"]["tiles"] == 1
    assert liftmesh.open_tiled(folder / "out").manifest["tile_rows"] == 2_500_000
    assert list((folder / "scratch").iterdir()) == []


def test_shards_in_other_formats_with_neighbors(folder: Path) -> None:
    for shards in ("ply", "parquet"):
        words = ("tile", "a.npy", shards, "--tile-rows", 500, "--shards", shards, "--neighbors")
        assert command(*words, cwd=folder).returncode == 0
        found = liftmesh.open_tiled(folder / shards)
        assert {path.suffix for path in found.shards} == {f".{shards}"}
        assert found.neighbors_to_array().shape == (found.nsimplex, 3)
        assert command("verify", shards, cwd=folder).returncode == 0


def test_a_run_goes_on_and_begins_anew(folder: Path) -> None:
    words = ("tile", "a.npy", "out", "--tile-rows", 500)
    assert command(*words, cwd=folder).returncode == 0
    before = (folder / "out" / "hull.npy").stat().st_mtime_ns
    assert command(*words, cwd=folder).returncode == 0
    assert (folder / "out" / "hull.npy").stat().st_mtime_ns == before
    np.save(folder / "a.npy", POINTS[:900])
    done = command(*words, cwd=folder)
    assert done.returncode == 3
    assert "holds the triangles of other points" in done.stderr
    assert "or replace them with --restart\n" in done.stderr
    done = command("tile", "b.npy", "out", "--tile-rows", 400, "--neighbors", cwd=folder)
    assert (
        "with --tile-rows 500, not 400: use the same, or begin anew with --restart" in done.stderr
    )
    assert command(*words, "--restart", cwd=folder).returncode == 0
    assert liftmesh.open_tiled(folder / "out").npoints == 900


TABLE = ("--skip-rows", 1, "--delimiter", ";", "--decimal", ",", "--columns", "x=A,y=B,z=H")


def test_a_surface_of_a_table_is_read_as_its_options_say(folder: Path) -> None:
    rows = "".join(f"{x:.0f},5;{y:.0f};{x + y:.0f},0\n" for x, y in POINTS[:200])
    (folder / "survey.csv").write_text(f"Survey 7\nA;B;H\n{rows}")
    done = command("tile", "survey.csv", "out", "--surface", *TABLE, cwd=folder)
    assert done.returncode == 0, done.stderr
    found = liftmesh.open_tiled(folder / "out")
    assert command("verify", "out", cwd=folder).returncode == 0
    cloud = np.column_stack((POINTS[:200, 0] + 0.5, POINTS[:200, 1], POINTS[:200].sum(axis=1)))
    expected = liftmesh.tile_surface(cloud, folder / "expected")
    assert found.to_array().tolist() == expected.to_array().tolist()
    for name, value in (("--skip-rows", "1"), ("--src-crs", "EPSG:25832")):
        done = command("tile", "survey.csv", "other", name, value, cwd=folder)
        assert (done.returncode, f"error: {name} is for surfaces" in done.stderr) == (2, True)
        done = command("contour", "out", "o.gpkg", "--interval", 9, name, value, cwd=folder)
        assert (done.returncode, f"error: {name} is for files" in done.stderr) == (2, True)
    assert not (folder / "other").exists()


@pytest.mark.parametrize("source", ["a.npy", "survey.ply"])
def test_options_of_tables_for_what_is_none(source: str, folder: Path) -> None:
    liftmesh.write(folder / "survey.ply", liftmesh.Cloud(np.eye(3)))
    done = command("tile", source, "out", "--surface", "--skip-rows", 1, cwd=folder)
    assert done.returncode == 3
    assert "--skip-rows cannot be given" in done.stderr
    assert not (folder / "out").exists()


def test_progress_on_a_terminal(folder: Path) -> None:
    shown, code = on_terminal("tile", "a.npy", "out", "--tile-rows", "500", cwd=folder)
    assert code == 0
    assert re.search(r"left: \S+ [\d.]+ [kM]?/s triangulating into out", shown)


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (["a.npy", "out", "--memory", "much"], 2, "--memory is 'much': give a size"),
        (["a.npy", "out", "--tile-rows", "3"], 2, "--tile-rows"),
        (["a.npy", "out", "--shards", "obj"], 2, "--shards"),
        (["a.npy", "out", "--workers", "0"], 2, "--workers"),
        (["a.npy", "out", "--memory", "1G", "--tile-rows", "99"], 2, "exclude each other"),
        (["a.npy", "out", "--scheduler", "xyz"], 2, "--scheduler 'xyz' is no address: give one as"),
        (["a.npy", "out", "--scheduler", ""], 2, "--scheduler '' is no address"),
        (["a.npy", "out", "--scheduler", "foo://x:1"], 2, "--scheduler 'foo://x:1' is no address"),
        (["a.npy", "out", "--scheduler", "tcp://x:99999"], 2, "is no address"),
        (["a.npy", "out", "--scheduler", "inproc://x"], 2, "is no address"),
        (["a.npy", "out", "--workers", "2", "--scheduler", "tcp://x:1"], 2, "exclude each other"),
        (["a.npy", "out", "--workers", "2", "--threads", "2"], 2, "exclude each other"),
        (["a.npy", "out", "--memory", "1MB"], 2, "1 MB of memory do not hold a process"),
        (["a.npy", "out", "--workers", "1", "--memory", "50M"], 2, "50 MB of memory do not hold"),
        (["missing.npy", "out"], 3, "missing.npy"),
        (["a.npy", "b.npy"], 3, "b.npy: cannot write tiles here: this is a file, not a folder"),
        (["a.npy", "b.npy", "a.npy", "out"], 2, "a.npy is given twice"),
        (["one.csv", "out"], 3, "one.csv: 1 row holds 1 distinct planar point: a triangle needs"),
        (["line.csv", "one.csv", "out"], 3, "line.csv, one.csv: all 3 distinct points lie on"),
        (["-", "out"], 3, "-"),
    ],
)
def test_what_is_refused(words: list[str], code: int, said: str, folder: Path) -> None:
    (folder / "one.csv").write_text("x,y,z\n1,1,3\n")
    (folder / "line.csv").write_text("x,y,z\n1,1,3\n2,2,3\n3,3,3\n")
    before = sorted(folder.iterdir())
    done = command("tile", *words, cwd=folder)
    assert (done.returncode, done.stdout) == (code, "")
    assert said in done.stderr
    assert len(done.stderr.splitlines()) <= 3
    assert sorted(folder.iterdir()) == before


@pytest.mark.parametrize(
    "words",
    ["accuracy out --at a.csv", "volume out", "info out", "solid out o.stl --base-height 0",
     "triangulate out o.ply", "profile out o.csv --along 0,0 --along 1,1"],
)  # fmt: skip
def test_commands_say_which_take_a_folder_of_tiles(words: str, folder: Path) -> None:
    assert command("tile", "a.npy", "out", cwd=folder).returncode == 0
    done = command(*words.split(), cwd=folder)
    assert done.returncode == 3
    assert "this is a folder of tiles, not a file: of the commands, raster, contour" in done.stderr


def test_heights_and_parts_of_a_folder_of_tiles_are_those_of_the_file(folder: Path) -> None:
    cloud = np.column_stack((POINTS, POINTS.sum(axis=1)))
    np.save(folder / "c.npy", cloud)
    low, high = np.quantile(POINTS, (0.3, 0.6), axis=0)
    ring = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], low[1]]]
    shape = {"type": "Polygon", "coordinates": [ring]}
    (folder / "part.geojson").write_text(json.dumps(shape))
    done = command("tile", "c.npy", "tiles", "--surface", "--tile-rows", 300, cwd=folder)
    assert done.returncode == 0, done.stderr
    for source, name in (("c.npy", "a"), ("tiles", "b")):
        done = command("sample", source, f"{name}.csv", "--at", "a.npy", cwd=folder)
        assert done.returncode == 0, done.stderr
        words = ("clip", source, f"{name}.ply", "--within", "part.geojson")
        done = command(*words, cwd=folder)
        assert done.returncode == 0, done.stderr
    for kind in ("csv", "ply"):
        assert (folder / f"a.{kind}").read_bytes() == (folder / f"b.{kind}").read_bytes()
    done = command(*words, "--invert", "--overwrite", cwd=folder)
    assert (done.returncode, "--invert and --paste need a file" in done.stderr) == (2, True)
