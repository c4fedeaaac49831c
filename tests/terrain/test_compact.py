"""Surfaces without the vertices that no face has, and files of them."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import pytest
import trimesh
from commands import liftmesh as run
from surfaces import meadow

import liftmesh

ROWS = len(meadow())
WAYS = {
    "delaunay": dict,
    "lines": lambda: {"breaklines": [[[1.0, 1.5, 9.0], [40.0, 20.0, 8.0], [60.0, 62.5, 7.0]]]},
    "weights": lambda: {"weights": np.random.default_rng(1).uniform(0, 4, ROWS + 3)},
    "radii": lambda: {"radii": np.random.default_rng(1).uniform(0, 2, ROWS + 3)},
    "metric": lambda: {"metric": [[2.0, 0.5], [0.5, 1.0]]},
}


def trimmed(way: str) -> liftmesh.Surface:
    points = meadow()
    points = np.vstack([points, points[:3] + np.array([0, 0, 5])])
    values = {"number": np.arange(ROWS + 3)}
    colors = np.arange(3 * (ROWS + 3), dtype=np.uint8).reshape(ROWS + 3, 3)
    given = WAYS[way]()
    surface = liftmesh.triangulate(
        points, attributes=values, colors=colors, on_duplicate="highest", **given
    )
    return surface.trim(max_edge=8).trim(polygon=[[10, 10], [50, 5], [60, 60], [5, 50]])


@pytest.mark.parametrize("way", WAYS)
def test_faces_stay_and_rows_are_named(way: str) -> None:
    surface = trimmed(way)
    few = surface.compact()
    rows = few.attributes["row"]
    assert len(few.vertices) == len(np.unique(surface.faces)) < len(surface.vertices)
    np.testing.assert_array_equal(few.vertices, surface.vertices[rows])
    np.testing.assert_array_equal(few.colors, surface.colors[rows])
    np.testing.assert_array_equal(few.attributes["number"], surface.attributes["number"][rows])
    named = {frozenset(face) for face in rows[few.faces].tolist()}
    assert named == {frozenset(face) for face in surface.faces.tolist()}
    places = np.random.default_rng(2).uniform(0, 64, (500, 2))
    np.testing.assert_array_equal(few.sample(places), surface.sample(places))
    report = few.report
    assert (report.n_rows, report.n_used, len(report.left_out)) == (len(rows), len(rows), 0)
    assert few.compact() is few
    fewer = few.trim(polygon=[[20, 20], [40, 20], [30, 40]]).compact()
    np.testing.assert_array_equal(surface.vertices[fewer.attributes["row"]], fewer.vertices)
    assert type(few.triangulation) is type(surface.triangulation)
    if way == "lines":
        assert len(few.triangulation.constraints)
        assert few.report.lines["rows"] <= surface.report.lines["rows"]


def test_a_surface_with_all_rows_is_itself_and_other_planes_stay() -> None:
    whole = liftmesh.triangulate(meadow())
    assert whole.compact() is whole
    tilted = liftmesh.triangulate(meadow(), plane=(0.1, 0.2, 1)).trim(max_edge=6)
    few = tilted.compact()
    assert few.frame is tilted.frame
    assert few.area() == pytest.approx(tilted.area())


@pytest.mark.parametrize("kind", ["ply", "obj", "glb", "stl", "off", "npz"])
def test_files_without_unused_rows(kind: str, tmp_path: Path) -> None:
    surface = trimmed("delaunay")
    used = len(np.unique(surface.faces))
    path = tmp_path / f"few.{kind}"
    written = surface.save(path, compact=True)
    assert written.dropped[0] == f"{ROWS + 3 - used} rows in no face"
    theirs = liftmesh.read(path)
    assert len(theirs) == used
    assert len(theirs.faces) == len(surface.faces)
    if kind in {"ply", "obj", "stl"}:
        assert len(trimesh.load(path, process=kind == "stl").vertices) == used
    full = surface.save(path)
    assert (f"{ROWS + 3 - used} rows in no face" in full.dropped) is False
    whole = liftmesh.triangulate(meadow())
    assert whole.save(path, compact=True).dropped == whole.save(path).dropped


def test_clouds_without_faces_stay_whole_and_other_values_are_refused() -> None:
    written = liftmesh.write(io.BytesIO(), meadow(), format="ply", compact=True)
    assert written.dropped == ()
    with pytest.raises(liftmesh.InputError, match="compact is 'yes': give True or False"):
        liftmesh.write(io.BytesIO(), meadow(), format="ply", compact="yes")  # type: ignore[arg-type]


def test_the_command_says_how_many(tmp_path: Path) -> None:
    np.save(tmp_path / "cloud.npy", meadow())
    words = ("triangulate", "cloud.npy", "few.glb", "--max-edge", "5", "--compact")
    done = run(*words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    count = len(liftmesh.read(tmp_path / "few.glb"))
    assert f"glb does not keep {ROWS - count} rows in no face" in done.stdout


def test_contours_of_few_faces_among_many_rows() -> None:
    rows = np.zeros((200_000, 3))
    rows[-3:] = [[4, 0, 8], [0, 4, 2], [4, 4, 6]]  # all others are one position
    surface = liftmesh.triangulate(rows)
    (found,) = surface.contours(interval=4)
    assert (found.level, found.points[[0, -1]].tolist()) == (4.0, [[2, 4], [2, 0]])
