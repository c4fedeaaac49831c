"""``liftmesh tileset``, as a person runs it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from commands import failed, liftmesh as run

import liftmesh
from liftmesh.cli import exit_codes


@pytest.fixture
def field(tmp_path: Path) -> Path:
    """A grid of points, as a table."""
    x, y = (each.ravel() for each in np.meshgrid(np.arange(0.0, 41), np.arange(0.0, 41)))
    rows = np.column_stack([x, y, 3 * np.sin(x / 4) * np.cos(y / 5)])
    np.savetxt(tmp_path / "field.csv", rows, delimiter=",", header="x,y,z", comments="")
    return tmp_path / "field.csv"


def test_it_says_the_error_of_each_level(field: Path, tmp_path: Path) -> None:
    words = ("--max-error", "0.1", "--levels", "2")
    done = run("tileset", field, tmp_path / "out", *words)
    assert done.returncode == 0, done.stderr
    found = liftmesh.write_tileset(
        liftmesh.triangulate(field), tmp_path / "lib", max_error=0.1, levels=2
    )
    for level, tiles in ((0, "1 tile"), (1, "4 tiles")):
        count, error = found.n_triangles[level], found.errors[level]
        assert f"{tiles}, {count:,} triangles, error {error:.4g}\n" in done.stdout
    for path in (tmp_path / "lib").rglob("*.*"):
        assert (tmp_path / "out" / path.relative_to(tmp_path / "lib")).read_bytes() == (
            path.read_bytes()
        )
    told = run("tileset", field, tmp_path / "out", *words, "--json", "--overwrite").stdout
    said = json.loads(told)
    assert said["path"] == str(tmp_path / "out" / "tileset.json")
    assert said["errors"] == list(found.errors)


def test_a_folder_of_tiles_gives_the_same_files(field: Path, tmp_path: Path) -> None:
    done = run("tile", field, tmp_path / "shards", "--surface", "--tile-rows", "400")
    assert done.returncode == 0, done.stderr
    words = ("--max-error", "0.1", "--levels", "2", "--skirts", "2", "--extent", "1,1,39,39")
    for source, name in ((field, "a"), (tmp_path / "shards", "b")):
        done = run("tileset", source, tmp_path / name, *words)
        assert done.returncode == 0, done.stderr
    for path in (tmp_path / "a").rglob("*.*"):
        assert (tmp_path / "b" / path.relative_to(tmp_path / "a")).read_bytes() == path.read_bytes()


def test_what_is_wrong_is_said_in_words_of_the_command(field: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    words = ("--max-error", "1", "--levels", "2")
    done = run("tileset", field, out, *words, "--extent", "0,0,50,50")
    failed(done, exit_codes.BAD_INPUT, "no face at", "--extent inside, or --extrapolate hull")
    assert not out.exists()
    failed(run("tileset", field, out), exit_codes.USAGE, "--max-error is missing")
    failed(run("tileset", field, out, *words, "--extent", "0,0"), exit_codes.USAGE, "--extent")
    out.mkdir()
    (out / "tileset.json").write_text("{}")
    failed(run("tileset", field, out, *words), exit_codes.USAGE, "exists", "--overwrite")


def test_tiles_of_the_globe(field: Path, tmp_path: Path) -> None:
    words = ("--quantized-mesh", "--max-error", "0.5", "--zoom", "12")
    done = run("tileset", field, tmp_path / "out", *words)
    failed(done, exit_codes.BAD_INPUT, "states no coordinate system")
    rows = liftmesh.read(field).points + np.array([500_000, 5_400_000, 0])
    liftmesh.write(tmp_path / "field.ply", rows)
    done = run(
        "tileset", tmp_path / "field.ply", tmp_path / "out", *words, "--src-crs", "EPSG:25832"
    )
    assert done.returncode == 0, done.stderr
    surface = liftmesh.triangulate(rows, crs="EPSG:25832")
    found = liftmesh.write_quantized_mesh(surface, tmp_path / "lib", max_error=0.5, zoom=12)
    assert f"level 0   2 tiles, {found.n_triangles[0]:,} triangles" in done.stdout
    of_tiles = ("--surface", "--tile-rows", "400", "--src-crs", "EPSG:25832")
    done = run("tile", tmp_path / "field.ply", tmp_path / "shards", *of_tiles)
    assert done.returncode == 0, done.stderr
    done = run("tileset", tmp_path / "shards", tmp_path / "tiled", *words)
    assert done.returncode == 0, done.stderr
    for path in (tmp_path / "lib").rglob("*.*"):
        for twin in (tmp_path / "out", tmp_path / "tiled"):
            assert (twin / path.relative_to(tmp_path / "lib")).read_bytes() == path.read_bytes()
    for wrong, part in (
        (("--levels", "2"), "--levels is without --quantized-mesh only"),
        (("--extent", "0,0,1,1"), "--extent is without --quantized-mesh only"),
    ):
        failed(run("tileset", field, tmp_path / "b", *words, *wrong), exit_codes.USAGE, part)
    done = run("tileset", field, tmp_path / "b", "--max-error", "1", "--zoom", "3")
    failed(done, exit_codes.USAGE, "--zoom is with --quantized-mesh only")
