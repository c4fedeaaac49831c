"""``liftmesh triangulate`` and ``verify`` with weights, radii or a metric."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from commands import liftmesh as command

import liftmesh
from liftmesh import Cloud

RNG = np.random.default_rng(3)
POINTS = np.c_[RNG.random((200, 2)), RNG.random(200) * 9]
SIZES = np.sqrt(RNG.random(200) * 0.02)
CLOUD = Cloud(POINTS, attributes={"size": SIZES, "class": np.arange(200)})
FORM = [[2.0, 0.5], [0.5, 1.25]]


@pytest.fixture
def table(tmp_path: Path) -> Path:
    path = tmp_path / "trees.csv"
    liftmesh.write(path, CLOUD)
    return path


def test_the_command_takes_columns(table: Path) -> None:
    done = command("triangulate", table, "mesh.ply", "--radii", "size", cwd=table.parent)
    assert done.returncode == 0, done.stderr
    expected = liftmesh.triangulate(CLOUD, radii="size")
    assert f"\nhidden      {expected.report.n_hidden}\n" in done.stdout
    mesh = liftmesh.read(table.parent / "mesh.ply")
    np.testing.assert_array_equal(mesh.faces, expected.faces)
    np.testing.assert_array_equal(mesh.attributes["hidden"], expected.attributes["hidden"])
    words = ("triangulate", table, "mesh.ply", "--weights", "size", "--json", "--overwrite")
    done = command(*words, cwd=table.parent)
    told = json.loads(done.stdout)
    assert told["triangulated_by"] == {"weights": "size"}
    assert told["n_hidden"] == len(told["left_out"]) > 20
    done = command("triangulate", table, "mesh.obj", "--weights", "size", cwd=table.parent)
    assert "obj does not keep class, hidden, size" in done.stdout
    done = command("verify", "mesh.ply", cwd=table.parent)
    assert done.returncode == 0, done.stderr
    assert "Valid, and canonical" in done.stdout
    assert "regular triangulation by weights" in " ".join(done.stdout.split())


def test_the_command_takes_a_metric(table: Path) -> None:
    done = command("triangulate", table, "mesh.ply", "--metric", "2,0.5,1.25", cwd=table.parent)
    assert done.returncode == 0, done.stderr
    assert "hidden" not in done.stdout
    mesh = liftmesh.read(table.parent / "mesh.ply")
    np.testing.assert_array_equal(mesh.faces, liftmesh.triangulate(CLOUD, metric=FORM).faces)


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (["--weights", "w"], 3, "--weights w, and the points have no values of that name"),
        (["--weights", "size", "--radii", "size"], 2, "--weights and --radii are given: give one"),
        (["--weights", "size", "--metric", "1,0,1"], 2, "--weights and --metric are given: give"),
        (["--radii", "z"], 3, "--radii z, and the points have no values of that name"),
        (["--metric", "1,0"], 2, "--metric is '1,0': give three numbers A,B,C"),
        (
            ["--metric", "1,2,1"],
            2,
            "--metric is [[1.0, 2.0], [2.0, 1.0]], which is not positive definite",
        ),
        (["--metric", "1,nan,1"], 2, "is not finite"),
        (["--metric", "1,0,1", "--algorithm", "lf"], 3, "--algorithm 'lf' has no --metric"),
    ],
)
def test_what_the_command_refuses(table: Path, words: list[str], code: int, said: str) -> None:
    done = command("triangulate", table, "mesh.ply", *words, cwd=table.parent)
    assert done.returncode == code
    assert said in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not (table.parent / "mesh.ply").exists()


def test_rows_of_the_file_are_named_with_it(tmp_path: Path) -> None:
    text = "x,y,z,r\n0,0,1,1\n4,0,1,-2\n0,4,1,1\n"
    (tmp_path / "a.csv").write_text(text)
    done = command("triangulate", "a.csv", "mesh.ply", "--radii", "r", cwd=tmp_path)
    assert done.returncode == 3
    assert "a.csv: row 1 has the radius -2.0: radii are not negative" in done.stderr
    (tmp_path / "a.csv").write_text(text.replace("-2", ""))
    done = command("triangulate", "a.csv", "mesh.ply", "--radii", "r", cwd=tmp_path)
    assert (
        "a.csv: row 1 has the radius nan: remove such rows, or skip them with --nonfinite skip"
        in (done.stderr)
    )


def test_values_that_a_file_lacks_are_named_with_it(table: Path) -> None:
    done = command("triangulate", table, "mesh.obj", "--radii", "size", cwd=table.parent)
    assert done.returncode == 0, done.stderr
    done = command("verify", "mesh.obj", cwd=table.parent)
    assert done.returncode == 3
    assert "mesh.obj: the mesh says that it was triangulated by the radii 'size'" in done.stderr
    done = command("triangulate", table, "mesh.ply", "--radii", "length", cwd=table.parent)
    assert f"{table.name}: --radii length, and the points have no values" in done.stderr


def test_verify_takes_what_a_mesh_does_not_say(tmp_path: Path) -> None:
    surface = liftmesh.triangulate(CLOUD, radii="size")
    bare = liftmesh.Cloud(POINTS, attributes={"size": SIZES}, faces=surface.faces)
    liftmesh.write(tmp_path / "mesh.ply", bare)
    for words, code, said in (
        ([], 1, "Not valid"),
        (["--radii", "size"], 0, "the regular triangulation by radii"),
        (["--weights", "size"], 1, "Not valid"),
        (["--metric", "2,0.5,1.25"], 1, "Not valid"),
        (["--metric", "2,0.5,1.25", "--radii", "size"], 2, "--radii and --metric are given"),
        (["--weights", "height"], 3, "mesh.ply: --weights height, and the points have no"),
    ):
        done = command("verify", "mesh.ply", *words, cwd=tmp_path)
        assert done.returncode == code, (words, done.stderr)
        assert said in " ".join((done.stdout + done.stderr).split())


def test_a_table_that_a_run_wrote_is_taken_again(table: Path) -> None:
    for source, target in (("trees.csv", "made.csv"), ("made.csv", "again.csv")):
        done = command("triangulate", source, target, "--radii", "size", cwd=table.parent)
        assert done.returncode == 0, done.stderr
    assert "the values 'hidden' of the points, 1 in " in " ".join(done.stderr.split())
    made = (table.parent / "made.csv").read_bytes()
    assert (table.parent / "again.csv").read_bytes() == made
    (table.parent / "made.csv").write_bytes(made.replace(b",1\n", b",7\n"))
    done = command("triangulate", "made.csv", "last.csv", "--radii", "size", cwd=table.parent)
    assert done.returncode == 3
    assert "made.csv: the points have values named 'hidden'" in done.stderr
