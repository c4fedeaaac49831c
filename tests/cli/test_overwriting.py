"""Commands replace nothing that was not named for it, and never what they read."""

from __future__ import annotations

import base64
import json
import os
import struct
import subprocess
from pathlib import Path

import numpy as np
import pytest
from commands import COMMAND, failed, liftmesh as run

import liftmesh
from liftmesh.cli.application import COMMANDS, Command

POINTS = np.random.default_rng(0).random((40, 3)) * 9
LINE = ("--along", "98,98", "--along", "105,105")
WRITING = [
    ("triangulate", "a.las", "old.las"),
    ("triangulate", "a.las", "b.las", "old.las"),
    ("thin", "a.las", "b.las", "old.las", "--cell", "5"),
    ("simplify", "a.las", "b.las", "old.ply", "--max-error", "1"),
    ("sample", "a.las", "old.csv", "--at", "b.las"),
    ("height", "a.las", "old.csv", "--ground", "b.las"),
    ("profile", "a.las", "old.csv", *LINE),
    ("profile", "a.las", "old.geojson", *LINE),
    ("raster", "a.las", "old.tif", "--resolution", "1"),
    ("contour", "a.las", "old.geojson", "--interval", "1"),
    ("difference", "a.las", "b.las", "old.ply"),
    ("clip", "a.las", "old.ply", "--within", "box.geojson", "--invert"),
    ("solid", "a.las", "old.stl", "--base-height", "-1"),
    ("voronoi", "a.las", "old.svg"),
    ("constrain", "mesh.ply", "old.ply", "--edges", "pairs.txt"),
    ("refine", "box.geojson", "old.ply"),
    ("tetrahedralize", "a.las", "old.vtu"),
    ("hull", "a.las", "old.ply"),
    ("alpha-shape", "a.las", "old.ply"),
    ("verify", "mesh.ply", "--certificate", "old.json"),
    ("compare", "a.las", "--lower", "old.ply"),
    ("compare", "a.las", "--hull", "old.ply"),
]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("a.las", "b.las"):
        liftmesh.write(tmp_path / name, POINTS + ord(name[0]))
    liftmesh.triangulate(POINTS).save(tmp_path / "mesh.ply")
    np.savetxt(tmp_path / "plane.txt", np.eye(4))
    (tmp_path / "pairs.txt").write_text("0 1\n")
    box = [[[0, 0], [99, 0], [99, 99], [0, 99], [0, 0]]]
    (tmp_path / "box.geojson").write_text(json.dumps({"type": "Polygon", "coordinates": box}))
    liftmesh.tile(tmp_path / "b.las", tmp_path / "tiles")
    return tmp_path


def contents(folder: Path) -> dict[Path, bytes]:
    return {each: each.read_bytes() for each in folder.rglob("*") if each.is_file()}


@pytest.mark.parametrize("words", WRITING, ids=" ".join)
def test_a_file_that_exists_is_replaced_if_asked_only(words: tuple[str, ...], folder: Path) -> None:
    (old,) = (folder / each for each in words if each.startswith("old."))
    old.write_bytes(b"precious")
    before = contents(folder)
    failed(run(*words, cwd=folder), 2, f"{old.name} exists", "--overwrite")
    assert contents(folder) == before
    assert run(*words, "--overwrite", cwd=folder).returncode == 0
    after = contents(folder)
    assert after.pop(old) != before.pop(old) == b"precious"
    assert after == before


def test_every_command_that_writes_a_file_has_the_option() -> None:
    options = {name: {each.name for each in Command(name).params} for name in COMMANDS}
    assert {name for name in COMMANDS if "overwrite" not in options[name]} == {
        *("tile", "paper"),  # to folders, which have their own rules
        *("info", "volume", "doctor"),  # nothing
    }


@pytest.mark.parametrize(
    "words",
    [
        ("thin", "a.las", "b.las", "--cell", "5", "b.las"),
        ("triangulate", "a.las", "link.las"),
        ("triangulate", "a.las", "hard.las"),
        ("triangulate", "a.las", "tiles/../a.las"),
        ("triangulate", "a.las", "plane.txt", "--plane", "plane.txt", "--output-format", "xyz"),
        (
            "triangulate",
            "a.las",
            "box.geojson",
            "--trim-polygon",
            "box.geojson",
            "--output-format",
            "ply",
        ),
        (
            "triangulate",
            "a.las",
            "lots.dbf",
            "--trim-polygon",
            "lots.shp",
            "--output-format",
            "ply",
        ),
        ("voronoi", "a.las", "lots.prj", "--domain", "lots.shp", "--output-format", "ply"),
        ("voronoi", "a.las", "box.geojson", "--domain", "box.geojson"),
        ("sample", "a.las", "b.las", "--at", "b.las"),
        ("height", "a.las", "b.las", "--ground", "b.las"),
        ("profile", "a.las", "mesh.ply", "--along", "mesh.ply"),
        ("verify", "mesh.ply", "--certificate", "mesh.ply"),
        ("verify", "tiles", "--certificate", "tiles/manifest.json"),
        ("verify", "tiles", "--certificate", "b.las"),
        ("verify", "tiles", "--certificate", "a.las", "--points", "a.las"),
        ("raster", "tiles", "tiles/old.tif", "--resolution", "1"),
        ("compare", "a.las", "--lower", "new.ply", "--hull", "tiles/../new.ply"),
        ("compare", "a.las", "--hull", "a.las"),
    ],
    ids=" ".join,
)
def test_an_input_is_never_replaced(words: tuple[str, ...], folder: Path) -> None:
    (folder / "tiles" / "old.tif").write_bytes(b"old")
    (folder / "link.las").symlink_to("a.las")
    os.link(folder / "a.las", folder / "hard.las")
    for suffix in ("shp", "dbf", "prj"):
        (folder / f"lots.{suffix}").write_bytes(b"lots")
    before = contents(folder)
    failed(run(*words, "--overwrite", cwd=folder), 2, "give another name")
    failed(run(*words, cwd=folder), 2, "give another name")
    assert contents(folder) == before


@pytest.mark.parametrize("name", ["my part.bin", "wall.png"])
@pytest.mark.parametrize("kind", ["gltf", "glb"])
def test_the_parts_of_a_model_are_never_replaced(kind: str, name: str, tmp_path: Path) -> None:
    liftmesh.write(tmp_path / "a.gltf", liftmesh.Cloud(POINTS[:3], faces=np.array([[0, 1, 2]])))
    tree = json.loads((tmp_path / "a.gltf").read_text())
    data = base64.b64decode(tree["buffers"][0]["uri"].partition(",")[2])
    tree["buffers"][0]["uri"] = "my%20part.bin"
    tree["images"] = [{"uri": "wall.png"}]
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    if kind == "glb":
        head = struct.pack("<4sIIII", b"glTF", 2, 20 + len(text), len(text), 0x4E4F534A)
        text = head + text
    (tmp_path / f"a.{kind}").write_bytes(text)
    (tmp_path / "my part.bin").write_bytes(data)
    (tmp_path / "wall.png").write_bytes(b"wall")
    (tmp_path / "other.ply").write_bytes(b"other")
    before = contents(tmp_path)
    words = ("triangulate", f"a.{kind}", name, "--output-format", "ply", "--overwrite")
    failed(run(*words, cwd=tmp_path), 2, f"{name} is a part of a.{kind}", "give another name")
    assert contents(tmp_path) == before
    done = run("triangulate", f"a.{kind}", "other.ply", "--overwrite", cwd=tmp_path)
    assert done.returncode == 0, done.stderr


def test_what_stdin_reads_is_an_input(folder: Path) -> None:
    words = [*COMMAND, "triangulate", "-", "mesh.ply", "--input-format", "ply", "--overwrite"]
    with (folder / "mesh.ply").open("rb") as stream:
        done = subprocess.run(words, cwd=folder, stdin=stream, stderr=subprocess.PIPE, check=False)
    assert (done.returncode, b"mesh.ply is read as -" in done.stderr) == (2, True)


def test_what_holds_nothing_is_replaced(folder: Path) -> None:
    (folder / "empty.ply").touch()
    for target in ("empty.ply", "new.ply"):
        assert run("triangulate", "a.las", target, cwd=folder).returncode == 0
    words = ("triangulate", "a.las", "/dev/null", "--output-format", "ply")
    assert run(*words, cwd=folder).returncode == 0


def test_the_library_replaces_las_if_asked_only(folder: Path) -> None:
    before = (folder / "a.las").read_bytes()
    for options in ({}, {"overwrite": False}):
        with pytest.raises(FileExistsError, match=r"overwrite=True"):
            liftmesh.write(folder / "a.las", POINTS, **options)
    for name in ("a.las", "mesh.ply"):
        with pytest.raises(FileExistsError, match=r"this file exists"):
            liftmesh.write(folder / name, POINTS, overwrite=False)
    assert (folder / "a.las").read_bytes() == before
    liftmesh.write(folder / "a.las", POINTS, overwrite=True)
    liftmesh.write(folder / "mesh.ply", POINTS)
    assert len(liftmesh.read(folder / "mesh.ply")) == len(liftmesh.read(folder / "a.las")) == 40
