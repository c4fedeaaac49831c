"""``liftmesh accuracy``: errors at checkpoints, and of each vertex by the others."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from commands import failed, liftmesh
from surfaces import meadow

import liftmesh as lm

CHECKPOINTS = "id,x,y,z\n7,30,30,1.5\n8,60,50,2\n9,999,0,3\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    lm.triangulate(meadow()).save(tmp_path / "tin.ply")
    (tmp_path / "checkpoints.csv").write_text(CHECKPOINTS)
    return tmp_path


def test_checkpoints(folder: Path) -> None:
    expected = lm.triangulate(meadow()).accuracy([[30, 30, 1.5], [60, 50, 2], [999, 0, 3]])
    done = liftmesh("accuracy", "tin.ply", "out.csv", "--at", "checkpoints.csv", cwd=folder)
    assert done.returncode == 0, done.stderr
    assert f"{expected.rmse:.10g}" in done.stdout
    names, *rows = (folder / "out.csv").read_text().splitlines()
    assert names == "x,y,z,id,residual"
    assert [row.rpartition(",")[2] for row in rows] == [
        *map(repr, expected.residuals[:2].tolist()), ""
    ]  # fmt: skip
    words = ("--at", "checkpoints.csv", "--json")
    told = json.loads(liftmesh("accuracy", "tin.ply", *words, cwd=folder).stdout)
    assert (told["n_points"], told["n_outside"]) == (3, 1)
    assert (told["rmse"], told["mean"]) == (expected.rmse, expected.mean)


def test_each_vertex_by_the_others(folder: Path) -> None:
    expected = lm.triangulate(meadow()).accuracy(interpolation="sibson")
    words = ("--interpolation", "sibson", "--json")
    told = json.loads(liftmesh("accuracy", "tin.ply", "out.ply", *words, cwd=folder).stdout)
    assert told["rmse"] == expected.rmse
    found = lm.read(folder / "out.ply")
    np.testing.assert_array_equal(found.attributes["residual"], expected.residuals)
    assert len(found.faces)
    done = liftmesh("accuracy", "out.ply", "again.ply", cwd=folder)
    failed(done, 3, "values named 'residual', which this command writes")


def checkpoints(place: list[float], **values: float) -> str:
    geometry = {"type": "Point", "coordinates": place}
    return json.dumps({"type": "Feature", "properties": values, "geometry": geometry})


@pytest.mark.parametrize(
    ("place", "values", "words"),
    [
        ([50, 50, 7], {"id": 3}, ()),
        ([50, 50], {"height": 7}, ()),
        ([50, 50], {"h2": 7}, ("--at-columns", "x=x,y=y,z=h2")),
        ([50, 50, -1], {"h2": -7}, ("--at-columns", "x=x,y=y,z=-h2")),
    ],
)
def test_checkpoints_of_geojson_keep_their_heights(
    folder: Path, place: list[float], values: dict[str, float], words: tuple[str, ...]
) -> None:
    (folder / "at.geojson").write_text(checkpoints(place, **values))
    done = liftmesh("accuracy", "tin.ply", "--at", "at.geojson", *words, "--json", cwd=folder)
    assert done.returncode == 0, done.stderr
    surface = lm.triangulate(lm.read(folder / "tin.ply"))
    assert json.loads(done.stdout)["mean"] == surface.sample([[50, 50]])[0] - 7


@pytest.mark.parametrize(
    ("at", "code", "said"),
    [
        ("none.csv", 3, "none.csv: No such file"),
        ("flat.csv", 3, "flat.csv"),
        ("nan.csv", 3, "row 0 is not finite"),
        ("far.csv", 3, "none of the 1 checkpoint is over a face"),
        ("flat.geojson", 3, "the points have no heights: give them in space, or name the column"),
        ("column.geojson", 3, "no column of 'x', 'y', 'H2' is known as the height z"),
        ("out.csv", 2, "same file"),
    ],
)
def test_checkpoints_that_are_none(folder: Path, at: str, code: int, said: str) -> None:
    (folder / "flat.csv").write_text("x,y\n1,2\n")
    (folder / "nan.csv").write_text("x,y,z\n1,2,nan\n")
    (folder / "far.csv").write_text("x,y,z\n1000,2,3\n")
    (folder / "flat.geojson").write_text('{"type": "Point", "coordinates": [1, 2]}')
    (folder / "column.geojson").write_text(checkpoints([1, 2], H2=3))
    if at == "out.csv":
        (folder / at).write_text(CHECKPOINTS)
    done = liftmesh("accuracy", "tin.ply", "out.csv", "--at", at, cwd=folder)
    failed(done, code, said)
    assert at == "out.csv" or not (folder / "out.csv").exists()
