"""Tables of ``--at`` and ``--along`` have options of their own, which errors recommend."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from commands import failed, liftmesh as run, process

import liftmesh

PLANE = np.array([[0.0, 0, 0], [8, 0, 8], [0, 8, 0], [8, 8, 8]])
MARKS = "P1;4,5;2;4,4\nP2;5,25;3;5,5\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    liftmesh.triangulate(PLANE).save(tmp_path / "tin.ply")
    (tmp_path / "marks.csv").write_text(MARKS)
    return tmp_path


def test_what_the_error_recommends_reads_the_points(folder: Path) -> None:
    words = ("sample", "tin.ply", "out.csv", "--at", "marks.csv")
    failed(run(*words, cwd=folder), 3, "read it with --at-columns id,x,y,z")
    done = run(*words, "--at-columns", "id,x,y,z", cwd=folder)
    assert done.returncode == 0, done.stderr
    found = liftmesh.read(folder / "out.csv")
    assert found.points.tolist() == [[4.5, 2, 4.5], [5.25, 3, 5.25]]
    assert found.attributes["given_z"].tolist() == [4.4, 5.5]
    words = ("profile", "tin.ply", "line.csv", "--along", "marks.csv")
    failed(run(*words, cwd=folder), 3, "read it with --along-columns id,x,y,z")
    assert run(*words, "--along-columns", "id,x,y,-", cwd=folder).returncode == 0
    assert liftmesh.read(folder / "line.csv").points[0].tolist() == [4.5, 2, 4.5]


@pytest.mark.slow
def test_points_of_stdin_have_a_format_of_their_own(folder: Path) -> None:
    words = ("sample", "tin.ply", "-", "--output-format", "csv", "--at", "-")
    done = process(*words, cwd=folder, stdin=MARKS)
    assert done.returncode == 2
    assert "stdin has no suffix: give its format with --at-input-format" in done.stderr
    words = (*words, "--at-input-format", "csv", "--at-columns", "id,x,y,z")
    done = process(*words, cwd=folder, stdin=MARKS)
    assert done.stdout == "x,y,z,given_z\n4.5,2.0,4.5,4.4\n5.25,3.0,5.25,5.5\n"


def test_options_of_both_tables_are_told_apart(folder: Path) -> None:
    (folder / "cloud.csv").write_text("P1;0;0;0\nP2;0;9;9\nP3;9;0;0\nP4;9;9;9\n")
    (folder / "places").write_text("a line\n1 2\n")
    words = ("sample", "cloud.csv", "out.xyz", "--columns", "id,y,x,z", "--at", "places")
    words = (*words, "--overwrite")
    own = ("--at-input-format", "xyz", "--at-skip-rows", "1")
    assert run(*words, *own, cwd=folder).returncode == 0
    assert (folder / "out.xyz").read_text() == "1.0 2.0 1.0\n"
    for option, value in (("--at-skip-rows", "-1"), ("--at-decimal", "x"), ("--at-nodata", "")):
        failed(run(*words, option, value, cwd=folder), 2, option)


@pytest.mark.parametrize("kind", ["csv", "ply"])
def test_heights_that_points_have_are_kept(kind: str, folder: Path) -> None:
    points = liftmesh.Cloud(np.array([[1.0, 2, 8]]), attributes={"id": np.array([7])})
    liftmesh.write(folder / f"at.{kind}", points)
    run("sample", "tin.ply", f"out.{kind}", "--at", f"at.{kind}", cwd=folder)
    found = liftmesh.read(folder / f"out.{kind}")
    assert found.points.tolist() == [[1, 2, 1]]
    assert (found.attributes["given_z"].tolist(), found.attributes["id"].tolist()) == ([8], [7])
