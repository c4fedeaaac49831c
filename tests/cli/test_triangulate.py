"""``liftmesh triangulate``: files in, files out, and an account of every row."""

from __future__ import annotations

import io
import json
import re
from typing import get_args

import numpy as np
import pytest
import trimesh
from commands import ROOT, TERRAIN, failed, liftmesh, on_terminal, process, without_escapes

import liftmesh as lm
from liftmesh.base.options import Algorithm
from liftmesh.cli import exit_codes

HILL = ROOT / "data" / "hill.csv"
OVERHANG = ROOT / "data" / "overhang.ply"


def succeeded(done):
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


@pytest.mark.parametrize("name", ["mesh.ply", "mesh.obj", "mesh.npz", "mesh.off"])
def test_a_file_becomes_a_mesh(name, tmp_path):
    out = succeeded(liftmesh("triangulate", HILL, name, cwd=tmp_path))
    expected = lm.triangulate(HILL)
    mesh = lm.read(tmp_path / name)
    assert np.array_equal(mesh.points, expected.vertices)
    assert np.array_equal(mesh.faces, expected.faces)
    size = (tmp_path / name).stat().st_size
    dropped = "; off does not keep colors" if name.endswith(".off") else ""
    assert out.startswith(f"{name}: 80 vertices, 147 triangles, {size / 1000:.3g} kB{dropped}\n")
    assert [path.name for path in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize("algorithm", get_args(Algorithm))
def test_every_method_of_the_library_is_one_of_the_command(algorithm, tmp_path):
    succeeded(liftmesh("triangulate", HILL, "mesh.ply", "--algorithm", algorithm, cwd=tmp_path))
    faces = lm.read(tmp_path / "mesh.ply").faces
    expected = lm.triangulate(HILL).faces
    assert set(map(frozenset, faces.tolist())) == set(map(frozenset, expected.tolist()))


def test_the_terrain(tmp_path):
    out = succeeded(process("triangulate", TERRAIN, tmp_path / "mesh.ply"))
    assert "138,632 vertices, 275,772 triangles" in out
    assert len(trimesh.load(tmp_path / "mesh.ply", process=False).faces) == 275_772


def test_every_row_is_accounted_for(tmp_path):
    out = succeeded(
        liftmesh("triangulate", OVERHANG, "mesh.ply", "--on-duplicate", "highest", cwd=tmp_path)
    )
    told = dict(re.findall(r"^(\S.*?)  +(.*)$", out, flags=re.MULTILINE))
    report = lm.triangulate(OVERHANG, on_duplicate="highest").report
    for name in ("rows", "used", "duplicates", "overhangs", "triangles"):
        assert told[name] == str(getattr(report, f"n_{name}"))
    assert told["skipped"] == "0"
    assert re.fullmatch(r"read \d+\.\d\d  triangulate \d+\.\d\d  write \d+\.\d\d", told["seconds"])


@pytest.mark.parametrize("policy", ["first", "last", "lowest", "highest", "mean"])
def test_policies(policy, tmp_path):
    succeeded(liftmesh("triangulate", OVERHANG, tmp_path / "m.ply", "--on-duplicate", policy))
    expected = lm.triangulate(OVERHANG, on_duplicate=policy)
    mesh = lm.read(tmp_path / "m.ply")
    assert np.array_equal(mesh.faces, expected.faces)
    assert np.array_equal(mesh.points, expected.vertices)


def test_colliding_rows_can_be_an_error(tmp_path):
    done = liftmesh("triangulate", OVERHANG, tmp_path / "m.ply", "--on-duplicate", "error")
    failed(done, exit_codes.BAD_INPUT, "row")
    assert list(tmp_path.iterdir()) == []


def test_rows_that_are_not_finite_can_be_skipped(tmp_path):
    (tmp_path / "cloud.xyz").write_text("0 0 0\n1 0 0\nnan 1 0\n0 1 0\n1 1 inf\n")
    words = ("triangulate", tmp_path / "cloud.xyz", tmp_path / "mesh.ply")
    failed(liftmesh(*words), exit_codes.BAD_INPUT, "row 2", "--nonfinite skip")
    assert "skipped     2" in succeeded(liftmesh(*words, "--nonfinite", "skip"))
    assert lm.read(tmp_path / "mesh.ply").faces.tolist() == [[0, 1, 3]]


@pytest.mark.parametrize(
    "plane", ["0,-1,0", "xz", "0,-2,0,1", "fit", "frame.txt", "frame.npy", "-0.1,-1,0"]
)
def test_planes(plane, tmp_path):
    rng = np.random.default_rng(0)
    wall = np.column_stack([rng.random(60), rng.random(60) * 0.01, rng.random(60)])
    frame = trimesh.geometry.plane_transform((0.5, 0.0, 0.5), (0.0, -1.0, 0.0))
    np.savetxt(tmp_path / "frame.txt", frame)
    np.save(tmp_path / "frame.npy", frame)
    np.save(tmp_path / "wall.npy", wall)
    succeeded(liftmesh("triangulate", "wall.npy", "m.ply", "--plane", plane, cwd=tmp_path))
    mesh = lm.read(tmp_path / "m.ply")
    assert np.array_equal(mesh.points, wall)
    a, b, c = wall[mesh.faces.T]
    up = -1 if plane != "fit" else 1
    assert (np.cross(b - a, c - a)[:, 1] * up > 0).all()


@pytest.mark.parametrize(
    ("content", "parts"),
    [
        ("1 0 0\n0 1 0\n0 0 1\n", ["(3, 3)", "not 4x4"]),
        ("one two\n", ["cannot read a matrix"]),
        ("2 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", ["not rigid"]),
    ],
)
def test_a_bad_matrix_is_refused(content, parts, tmp_path):
    (tmp_path / "frame.txt").write_text(content)
    done = liftmesh("triangulate", HILL, "m.ply", "--plane", "frame.txt", cwd=tmp_path)
    failed(done, exit_codes.USAGE if "rigid" not in parts[0] else exit_codes.BAD_INPUT, *parts)


@pytest.mark.parametrize(
    ("target", "code", "parts"),
    [
        ("mesh.xyzzy", exit_codes.BAD_INPUT, ["mesh.xyzzy", "'xyzzy'", ".ply"]),
        ("mesh", exit_codes.USAGE, ["no suffix", "--output-format"]),
        ("-", exit_codes.USAGE, ["--output-format"]),
        ("no/such/mesh.ply", exit_codes.BAD_INPUT, ["no/such: ", "the folder does not exist"]),
        ("folder.ply", exit_codes.BAD_INPUT, ["folder.ply", "is a folder"]),
    ],
)
def test_a_target_that_cannot_be_written_fails_before_the_work(target, code, parts, tmp_path):
    (tmp_path / "folder.ply").mkdir()
    # The input is broken: had it been read first, its fault would be told.
    (tmp_path / "broken.ply").write_bytes(b"")
    failed(liftmesh("triangulate", "broken.ply", target, cwd=tmp_path), code, *parts)


@pytest.mark.parametrize(
    ("name", "content", "parts"),
    [
        ("empty.ply", b"", ["empty.ply", "empty (0 bytes)"]),
        ("cut.ply", TERRAIN.read_bytes()[:5000], ["cut.ply", "byte", "138632"]),
        ("noise.ply", bytes(range(256)) * 9, ["noise.ply", "not a PLY file"]),
        ("noise.npy", bytes(range(256)) * 9, ["noise.npy"]),
        ("words.csv", b"x,y,z\n1,2,3\n4,five,6\n", ["words.csv", "line 3", "five"]),
        ("line.xyz", b"0 0 0\n1 1 1\n2 2 2\n", ["3 distinct points lie on one line"]),
        ("two.xyz", b"0 0 0\n1 1 1\n", ["2 distinct"]),
    ],
)
def test_a_broken_file_is_told_in_one_line(name, content, parts, tmp_path):
    (tmp_path / name).write_bytes(content)
    (tmp_path / "mesh.ply").write_text("precious")
    words = ("triangulate", name, "mesh.ply", "--overwrite")
    failed(liftmesh(*words, cwd=tmp_path), exit_codes.BAD_INPUT, *parts)
    assert (tmp_path / "mesh.ply").read_text() == "precious"
    assert {path.name for path in tmp_path.iterdir()} == {name, "mesh.ply"}


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_streams(unbuffered):
    done = process(
        *("triangulate", "-", "-", "--input-format", "csv", "--output-format", "ply"),
        stdin=HILL.read_bytes(),
        text=False,
        env={"PYTHONUNBUFFERED": unbuffered},
    )
    assert done.returncode == 0
    assert done.stderr.startswith(b"-: 80 vertices, 147 triangles, ")
    mesh = lm.read(io.BytesIO(done.stdout), format="ply")
    assert np.array_equal(mesh.faces, lm.triangulate(HILL).faces)


def test_streams_with_json():
    done = process(
        *("triangulate", str(HILL), "-", "--json", "--output-format", "stl"), stdin=b"", text=False
    )
    assert done.returncode == 0
    told = json.loads(done.stderr)
    assert (told["path"], told["dropped"]) == ("-", ["colors", "double precision"])
    assert len(done.stdout) == told["bytes"]


def test_a_format_in_place_of_the_suffix(tmp_path):
    succeeded(liftmesh("triangulate", HILL, "mesh.dat", "--output-format", "obj", cwd=tmp_path))
    assert (tmp_path / "mesh.dat").read_bytes().startswith(b"# liftmesh\nv ")


def test_the_origin_of_single_precision_is_told(tmp_path):
    rows = np.array([450_000, 5_200_000, 100]) + np.random.default_rng(0).random((50, 3))
    np.save(tmp_path / "cloud.npy", rows)
    out = succeeded(liftmesh("triangulate", "cloud.npy", "mesh.stl", cwd=tmp_path))
    assert re.search(
        r"float32, so the origin \(4\d{5}[.\d]*, 5[.\d]+, [.\d]+\) was subtracted", out
    )


def test_json(tmp_path):
    done = liftmesh("triangulate", OVERHANG, "mesh.ply", "--json", cwd=tmp_path)
    told = json.loads(succeeded(done))
    report = lm.triangulate(OVERHANG).report
    assert told["path"] == "mesh.ply"
    assert told["bytes"] == (tmp_path / "mesh.ply").stat().st_size
    assert (told["n_rows"], told["n_used"], told["n_overhangs"]) == (
        25,
        report.n_used,
        report.n_overhangs,
    )
    assert told["left_out"] == report.left_out.tolist()
    assert set(told["seconds"]) == {"read", "triangulate", "write"}


@pytest.mark.parametrize("words", [("--threads", 1), ("--threads", 3), ()])
def test_threads_change_no_byte(words, tmp_path):
    succeeded(liftmesh("triangulate", TERRAIN, tmp_path / "mesh.ply", *words))
    mesh = lm.read(tmp_path / "mesh.ply")
    assert np.array_equal(mesh.faces, lm.triangulate(TERRAIN, threads=1).faces)


def test_the_variable_for_threads_is_checked_before_the_work(tmp_path, monkeypatch):
    (tmp_path / "broken.ply").write_bytes(b"")
    monkeypatch.setenv("LIFTMESH_NUM_THREADS", "abc")
    words = ("triangulate", tmp_path / "broken.ply", tmp_path / "mesh.ply")
    failed(liftmesh(*words), exit_codes.USAGE, "LIFTMESH_NUM_THREADS is 'abc': give a whole number")
    # Who says a number does not ask the environment.
    failed(liftmesh(*words, "--threads", 2), exit_codes.BAD_INPUT, "empty (0 bytes)")


def test_a_terminal_shows_progress_and_the_result(tmp_path):
    shown, code = on_terminal("triangulate", TERRAIN, "mesh.ply", cwd=tmp_path)
    assert code == 0
    told = without_escapes(shown)
    for stage in ("reading jacksboro.ply", "triangulating 138,632 rows", "writing mesh.ply"):
        assert stage in told
    assert "mesh.ply: 138,632 vertices, 275,772 triangles" in told


@pytest.mark.slow
def test_a_bar_moves_while_a_large_cloud_is_triangulated(tmp_path):
    np.save(tmp_path / "cloud.npy", np.random.default_rng(0).random((2_000_000, 3)))
    shown, code = on_terminal(
        *("triangulate", "cloud.npy", "mesh.ply", "--threads", 1),
        cwd=tmp_path,
        # Colour alone tells the bar from what it has to fill.
        env={"NO_COLOR": "1", "COLUMNS": "110"},
    )
    assert code == 0
    line = r"([━╸ ]{40}) \d:\d\d:\d\d left: \S+ (?:[\d.]+ [kM]/s)? *triangulating 2,000,000 rows"
    frames = re.findall(line, shown)
    filled = [frame.count("━") for frame in frames]
    assert filled == sorted(filled)
    assert len(set(filled)) >= 4
    assert filled[-1] == 40
    assert re.search(r"left: \S+ [\d.]+ [kM]/s triangulating", shown)
    size = r"[\d.]+ (?:bytes|kB|MB) (?:\?|[\d.]+ [kM]?B/s)"
    assert re.search(rf"writing mesh.ply \S+ {size} \d:\d\d:\d\d", shown)
    assert "mesh.ply: 2,000,000 vertices" in shown


@pytest.mark.slow
def test_a_bar_shows_how_far_and_how_fast_a_file_is_read(tmp_path):
    points = np.round(np.random.default_rng(0).random((4_000_000, 3)) * 1000, 2)
    lm.write(tmp_path / "cloud.laz", lm.Cloud(points))
    words = ("info", "cloud.laz", "--every", 1000)
    shown, code = on_terminal(*words, cwd=tmp_path, env={"NO_COLOR": "1"})
    assert code == 0
    frames = re.findall(r"reading cloud.laz ([━╸ ]{40}) [\d.]+ [kM]B/s left: \d:\d\d:\d\d", shown)
    filled = [frame.count("━") for frame in frames]
    assert filled == sorted(filled)
    assert len(set(filled)) >= 2


def test_one_triangle_is_said_as_one(tmp_path):
    (tmp_path / "corners.xyz").write_text("0 0 1\n1 0 2\n0 1 3\n")
    done = liftmesh("triangulate", tmp_path / "corners.xyz", tmp_path / "mesh.ply")
    assert "mesh.ply: 3 vertices, 1 triangle, " in done.stdout.replace("\n", "")
