"""``liftmesh verify`` as a person runs it, and the checker that does without liftmesh."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from clouds import FAMILIES
from commands import failed, liftmesh as run, process

import liftmesh
from liftmesh import Cloud

ROOT = Path(__file__).resolve().parents[2]
CHECKER = ROOT / "scripts" / "check_certificate.py"


def mesh(path: Path, points: np.ndarray, simplices: np.ndarray) -> Path:
    space = np.column_stack((points, np.zeros(len(points))))
    liftmesh.write(path, Cloud(space, faces=np.asarray(simplices, dtype=np.int32)))
    return path


def check(*arguments: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-E", "-s", str(CHECKER), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("suffix", ["ply", "obj"])
@pytest.mark.parametrize("family", ["uniform", "lattice", "integer-circles", "denormal-lattice"])
def test_a_certificate_holds_without_liftmesh(tmp_path: Path, family: str, suffix: str) -> None:
    points = FAMILIES[family](300, np.random.default_rng(1))
    path = mesh(tmp_path / f"mesh.{suffix}", points, liftmesh.delaunay(points).simplices)
    found = run("verify", path, "--certificate", tmp_path / "mesh.json")
    assert found.returncode == 0, found.stderr
    assert found.stdout.startswith("Valid, and canonical")
    checked = check(tmp_path / "mesh.json", path)
    assert checked.returncode == 0, checked.stdout + checked.stderr
    assert checked.stdout.endswith("triangles, Delaunay, canonical.\n")


def test_other_choices_are_told_by_both(tmp_path: Path) -> None:
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    path = mesh(tmp_path / "mesh.obj", square, [[0, 1, 2], [0, 2, 3]])
    found = run("verify", path, "--certificate", tmp_path / "mesh.json")
    assert found.returncode == 0
    assert found.stdout.startswith("Valid: a Delaunay triangulation, with other choices")
    assert check(tmp_path / "mesh.json", path).stdout.endswith("valid, not canonical.\n")


def test_what_is_wrong_is_named_and_ends_with_1(tmp_path: Path) -> None:
    points = np.random.default_rng(2).random((30, 2))
    path = mesh(tmp_path / "mesh.ply", points, liftmesh.delaunay(points).simplices[1:])
    found = run("verify", path, "--certificate", tmp_path / "mesh.json")
    assert found.returncode == 1
    assert found.stdout.startswith("Not valid")
    assert "- " in found.stdout
    assert "row" in found.stdout
    assert check(tmp_path / "mesh.json", path).returncode == 0  # it says so, and so it is


def test_a_certificate_that_lies_is_found_out(tmp_path: Path) -> None:
    points = np.random.default_rng(2).random((30, 2))
    right = liftmesh.delaunay(points).simplices
    path = mesh(tmp_path / "mesh.ply", points, right[1:])
    run("verify", path, "--certificate", tmp_path / "mesh.json")
    values = json.loads((tmp_path / "mesh.json").read_text())
    for lie in ({"valid": True}, {"canonical": True}):
        (tmp_path / "lie.json").write_text(json.dumps(values | lie))
        found = check(tmp_path / "lie.json", path)
        assert found.returncode == 1
        assert "The certificate is wrong" in found.stdout
    other = mesh(tmp_path / "other.ply", points, right)
    found = check(tmp_path / "mesh.json", other)
    assert found.returncode == 1
    assert "speaks of another mesh: simplices_sha256" in found.stdout


def test_json_is_the_certificate(tmp_path: Path) -> None:
    points = np.random.default_rng(2).random((30, 2))
    triangulation = liftmesh.delaunay(points)
    path = mesh(tmp_path / "mesh.ply", points, triangulation.simplices)
    found = run("verify", path, "--json", "--threads", "2")
    assert json.loads(found.stdout) == json.loads(triangulation.verify().to_json())


def test_a_mesh_in_another_plane(tmp_path: Path) -> None:
    points = np.random.default_rng(2).random((200, 3)) * (1, 0.01, 1)
    cloud = tmp_path / "wall.ply"
    liftmesh.write(cloud, Cloud(points))
    assert run("triangulate", cloud, tmp_path / "mesh.ply", "--plane", "fit").returncode == 0
    assert run("verify", tmp_path / "mesh.ply", "--plane", "fit").returncode == 0
    assert run("verify", tmp_path / "mesh.ply").returncode == 1


def test_what_cannot_be_verified_is_said(tmp_path: Path) -> None:
    cloud = tmp_path / "cloud.xyz"
    cloud.write_text("0 0 0\n1 0 0\n0 1 0\n")
    found = run("verify", cloud)
    assert found.returncode == 3
    assert "cloud.xyz: holds no triangles: make some with liftmesh triangulate" in found.stderr
    cloud.write_text("North;East\n0;0\n")  # options of tables would not make it a mesh
    found = run("verify", cloud)
    assert found.returncode == 3
    assert "cloud.xyz: holds no triangles" in found.stderr
    assert "columns" not in found.stderr
    liftmesh.write(tmp_path / "cloud.ply", np.eye(3))
    found = run("verify", "cloud.ply", cwd=tmp_path)
    assert found.stderr.startswith("liftmesh: error: cloud.ply: holds no triangles: make some")
    lines = Cloud(np.eye(3), edges=np.array([[0, 1]], np.int32))
    for name in ("lines.ply", "lines.poly"):
        liftmesh.write(tmp_path / name, lines)
        found = run("verify", name, cwd=tmp_path)
        assert f"make some with liftmesh constrain {name} OUT" in " ".join(found.stderr.split())
    points = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [np.nan, 0.0]])
    path = mesh(tmp_path / "mesh.ply", points, [[0, 1, 2]])
    found = run("verify", path)
    assert found.returncode == 3
    assert "mesh.ply: row 3 is not finite" in found.stderr
    assert "--nonfinite skip" in found.stderr
    assert run("verify", path, "--nonfinite", "skip").returncode == 0
    before = path.read_bytes()
    assert run("verify", path, "--certificate", path).returncode == 2
    assert path.read_bytes() == before


def test_a_certificate_can_go_to_stdout(tmp_path: Path) -> None:
    points = np.random.default_rng(2).random((30, 2))
    path = mesh(tmp_path / "mesh.ply", points, liftmesh.delaunay(points).simplices)
    found = process("verify", path, "--certificate", "-", cwd=tmp_path)
    assert found.returncode == 0
    assert json.loads(found.stdout)["valid"] is True
    assert found.stderr.startswith("Valid, and canonical")
    assert [each.name for each in tmp_path.iterdir()] == ["mesh.ply"]


@pytest.mark.parametrize(
    ("place", "reason"),
    [
        ("no/such/mesh.json", "no/such: cannot write here: the folder does not exist"),
        ("broken.ply/mesh.json", "broken.ply: cannot write here: this is a file, not a folder"),
        ("folder", "folder: cannot write a file here: it is a folder"),
    ],
)
def test_a_certificate_that_cannot_be_written_is_refused_before_the_work(
    place: str, reason: str, tmp_path: Path
) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "broken.ply").touch()  # had it been read first, its fault would be told
    found = run("verify", "broken.ply", "--certificate", place, cwd=tmp_path)
    failed(found, 3, reason)


def test_json_has_the_form_of_the_certificate(tmp_path: Path) -> None:
    points = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [np.inf, 0.0]])
    path = mesh(tmp_path / "mesh.obj", points, [[0, 1, 2], [1, 3, 2]])
    wanted = ("--nonfinite", "skip", "--certificate", tmp_path / "mesh.json")
    found = run("verify", path, "--json", *wanted)
    assert found.returncode == 1
    assert found.stdout == (tmp_path / "mesh.json").read_text()
    values = json.loads(found.stdout)
    assert values["flaws"][0]["first"][0]["points"][1] == ["inf", 0.0]
    assert values["counts"]["n_edges"] is None
    said = run("verify", path, *wanted, "--overwrite").stdout
    assert re.search("edges +not counted", said)


def test_faces_that_are_cut_or_left_out_are_told(tmp_path: Path) -> None:
    path = tmp_path / "mesh.obj"
    path.write_text("v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 4\nf 4 2 3\n")
    assert run("verify", path).stderr == ""
    path.write_text("v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3 4\nf 1 2\nf 1 4\n")
    found = run("verify", path, "--certificate", tmp_path / "mesh.json")
    assert found.returncode == 0
    assert found.stderr == (
        "liftmesh: note: faces of the file: 1 of more than three corners cut into triangles, "
        "2 of fewer than three corners left out\n"
    )
    checked = check(tmp_path / "mesh.json", path)
    assert checked.returncode == 2
    assert "line 5 is a face of 4 vertices, not three" in checked.stderr


def test_a_trimmed_surface_is_told_from_a_wrong_one(tmp_path: Path) -> None:
    points = np.random.default_rng(5).uniform(0, 10, (60, 3))
    surface = liftmesh.triangulate(points).trim(max_edge=3)
    surface.save(tmp_path / "trimmed.ply")
    done = run("verify", tmp_path / "trimmed.ply")
    assert done.returncode == 1
    left, whole = len(surface.faces), len(surface.triangulation.simplices)
    assert f"all {left} triangles are among the {whole} of" in done.stderr
    assert f"{whole - left} are left out" in done.stderr
    wrong = surface.faces.copy()
    wrong[0] = np.setdiff1d(np.arange(60), wrong[:1])[:3]
    done = run("verify", mesh(tmp_path / "wrong.ply", points[:, :2], wrong))
    assert done.returncode == 1
    assert "are left out" not in done.stderr
