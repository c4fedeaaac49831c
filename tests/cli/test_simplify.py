"""``liftmesh simplify``: the stories of a raster and of a cloud, and what is asked wrongly."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from commands import TERRAIN, liftmesh

import liftmesh as lm


def test_a_terrain_within_a_distance(tmp_path: Path) -> None:
    done = liftmesh("simplify", TERRAIN, "few.ply", "--max-error", "40", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    mesh = lm.read(tmp_path / "few.ply")
    assert (told["n_kept"], told["n_triangles"]) == (len(mesh), len(mesh.faces))
    assert told["error"] <= 40
    assert told["n_kept"] < told["n_positions"] / 10
    assert lm.verify(tmp_path / "few.ply").canonical


def test_a_report_for_people(tmp_path: Path) -> None:
    points = np.random.default_rng(0).random((300, 3))
    np.savetxt(tmp_path / "a.xyz", np.concatenate([points, points[:1] + (0, 0, 9)]))  # noqa: RUF005
    words = ("a.xyz", "b.ply", "--max-error", "0.01", "--max-points", "60", "--no-prune")
    words += ("--threads", "2")
    done = liftmesh("simplify", *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "b.ply: 60 of 300 positions" in done.stdout
    assert "asked for" in done.stdout
    assert "of merged rows    9" in done.stdout


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "give --max-error or --max-points"),
        (("--max-error", "x"), "--max-error is 'x': give 0 or"),
        (("--max-error", "-1"), "give 0 or a positive number"),
        (("--max-error", "nan"), "--max-error is nan: give 0 or"),
        (("--max-points", "2"), "--max-points"),
        (("--max-error", "1", "--threads", "0"), "--threads is 0: give a whole number from 1"),
        (
            ("--max-error", "1", "--copc-resolution", "2,5"),
            "--copc-resolution is '2,5': give a positive",
        ),
    ],
)
def test_what_is_asked_wrongly(words: tuple[str, ...], message: str, tmp_path: Path) -> None:
    done = liftmesh("simplify", TERRAIN, tmp_path / "few.ply", *words)
    assert done.returncode != 0
    assert message in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not any(tmp_path.iterdir())


def test_points_on_a_line(tmp_path: Path) -> None:
    (tmp_path / "a.xyz").write_text("0 0 1\n1 1 2\n2 2 3\n")
    done = liftmesh("simplify", "a.xyz", "b.ply", "--max-error", "1", cwd=tmp_path)
    assert done.returncode == 3
    assert "a.xyz" in done.stderr
    assert [each.name for each in tmp_path.iterdir()] == ["a.xyz"]


def test_what_is_left_of_a_trimmed_mesh(tmp_path: Path) -> None:
    points = np.random.default_rng(1).random((60, 3)) * (9, 9, 1)
    lm.write(tmp_path / "part.ply", lm.triangulate(points).trim(max_edge=2))
    done = liftmesh("simplify", "part.ply", "b.ply", "--max-error", "1", cwd=tmp_path)
    assert done.returncode == 3
    assert "simplify first, then trim" in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert [each.name for each in tmp_path.iterdir()] == ["part.ply"]
