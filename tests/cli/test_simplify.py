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


def test_a_mesh_keeps_its_edges_and_holes(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    np.savetxt(tmp_path / "a.xyz", rng.random((300, 3)) * (9, 9, 0.5))
    pond = [[[2, 2], [4, 2], [4, 4], [2, 4], [2, 2]]]
    lines = {
        "road.json": {"type": "LineString", "coordinates": [[1, 6, 3], [5, 7, 3], [8, 6, 3]]},
        "pond.json": {"type": "Polygon", "coordinates": pond},
    }
    for name, shape in lines.items():
        (tmp_path / name).write_text(json.dumps(shape))
    words = "triangulate a.xyz tin.ply --breaklines road.json --holes pond.json"
    assert liftmesh(*words.split(), cwd=tmp_path).returncode == 0
    done = liftmesh("simplify", "tin.ply", "few.ply", "--max-error", "0.5", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    few, whole = (lm.as_surface(tmp_path / name) for name in ("few.ply", "tin.ply"))
    assert told["n_kept"] == len(few.vertices) < told["n_positions"] / 2
    assert told["n_triangles"] == len(few.faces)
    ends = {(1.0, 6.0), (5.0, 7.0), (8.0, 6.0)}
    assert {*map(tuple, few.vertices[few.triangulation.constraints].reshape(-1, 3)[:, :2])} >= ends
    assert few.area(planar=True) == pytest.approx(whole.area(planar=True))
    assert whole.mask is not None
    assert lm.verify(tmp_path / "few.ply").canonical
