"""Runs that are interrupted, and what has changed when they go on: the same bytes, or an error."""

from __future__ import annotations

import errno
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liftmesh
from liftmesh.errors import DegenerateInputError, InputError
from liftmesh.tiles import build, publish, schedule, shards, sorted_chunks

POINTS = np.random.default_rng(4).integers(0, 30, (600, 2)).astype(np.float64)
TILE_ROWS = 100


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


@pytest.fixture
def source(tmp_path: Path) -> Path:
    np.save(tmp_path / "points.npy", POINTS)
    return tmp_path / "points.npy"


@pytest.fixture
def expected(source: Path, tmp_path: Path) -> dict[str, bytes]:
    liftmesh.tile(source, tmp_path / "expected", tile_rows=TILE_ROWS)
    return contents(tmp_path / "expected")


class DiskFullError(OSError):
    """What writing raises at some point of a run."""


def failing_at(patch: pytest.MonkeyPatch, number: int) -> Callable[[], int]:
    """Let the writing of one file fail; returns what counts the files that were asked for."""
    asked = [0]

    def failing(save: Callable[..., Any]) -> Callable[..., Any]:
        def call(path: Path, *content: object) -> Any:
            asked[0] += 1
            if asked[0] == number:
                raise DiskFullError(errno.ENOSPC, "No space left on device", str(path))
            return save(path, *content)

        return call

    for module in (build, sorted_chunks, schedule, shards, publish):
        for name in ("save_array", "save_blocks", "save_json"):
            if hasattr(module, name):
                patch.setattr(module, name, failing(getattr(module, name)))
    return lambda: asked[0]


def begun(source: Path, out: Path, number: int) -> int:
    """Begin a run that ends when it writes a file; returns how many files it asked for."""
    with pytest.MonkeyPatch.context() as patch:
        asked = failing_at(patch, number)
        try:
            liftmesh.tile(source, out, tile_rows=TILE_ROWS)
        except DiskFullError:
            assert not (out / "manifest.json").exists()
        return asked()


def test_a_full_disk_at_every_file(
    source: Path, expected: dict[str, bytes], tmp_path: Path
) -> None:
    files = begun(source, tmp_path / "whole", 0)
    assert files > 60
    for number in range(1, files + 1, 22):
        out = tmp_path / f"out-{number}"
        assert begun(source, out, number) == number
        with pytest.MonkeyPatch.context() as patch:
            asked = failing_at(patch, 0)
            liftmesh.tile(source, out, tile_rows=TILE_ROWS)
        assert contents(out) == expected
        assert not (out / ".liftmesh-tiles").exists()
        assert asked() <= files - number + 12  # what was done is not done again


def stopped_half_way(source: Path, out: Path, left: int = 12) -> None:
    """Begin a run that ends when it writes the last files but some: at the merges, or at tiles."""
    files = begun(source, out.with_name("counted"), 0)
    begun(source, out, files - left)


DAMAGES: dict[str, Callable[[Path], Any]] = {
    "truncated": lambda path: path.write_bytes(path.read_bytes()[:-5]),
    "removed": lambda path: path.unlink(),
    "changed": lambda path: path.write_bytes(path.read_bytes()[:-1] + b"\xff"),
}


@pytest.mark.parametrize(
    ("name", "damage", "left"),
    [
        ("tile-00001.npy", "truncated", 12),
        ("tile-00001.npy", "removed", 12),
        (".liftmesh-tiles/tile-00001-records.npy", "removed", 12),
        (".liftmesh-tiles/tile-00001-records.npy", "changed", 12),
        (".liftmesh-tiles/run-00001-00.npy", "changed", 34),
    ],
)
def test_damaged_files_are_made_again(
    name: str, damage: str, left: int, source: Path, expected: dict[str, bytes], tmp_path: Path
) -> None:
    out = tmp_path / "out"
    stopped_half_way(source, out, left)
    assert len([*out.glob(".liftmesh-tiles/tile-*.json")]) > 1
    DAMAGES[damage](out / name)
    liftmesh.tile(source, out, tile_rows=TILE_ROWS)
    assert contents(out) == expected


def test_a_finished_run_is_not_repeated_unless_it_is_damaged(
    source: Path, expected: dict[str, bytes], tmp_path: Path
) -> None:
    out = tmp_path / "expected"
    before = {path: path.stat().st_mtime_ns for path in out.iterdir()}
    liftmesh.tile(source, out, tile_rows=TILE_ROWS)
    assert {path: path.stat().st_mtime_ns for path in out.iterdir()} == before
    DAMAGES["changed"](out / "tile-00002.npy")
    liftmesh.tile(source, out, tile_rows=TILE_ROWS)
    assert contents(out) == expected


def test_a_source_that_has_changed_is_noticed(source: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    stopped_half_way(source, out)
    other = POINTS.copy()
    other[250, 0] += 0.5
    np.save(source, other)
    with pytest.raises(InputError, match=r"points.npy: rows 200 to 299 have changed since"):
        liftmesh.tile(source, out, tile_rows=TILE_ROWS)
    np.save(source, other[:400])
    with pytest.raises(InputError, match="rows 200 to 299 have changed"):
        liftmesh.tile(source, out, tile_rows=TILE_ROWS)
    np.save(source, POINTS[:400])
    with pytest.raises(InputError, match=r"the source has lost rows since .* 400 are left"):
        liftmesh.tile(source, out, tile_rows=TILE_ROWS)
    found = liftmesh.tile(source, out, tile_rows=TILE_ROWS, resume=False)
    assert found.nsimplex == liftmesh.delaunay(POINTS[:400]).nsimplex
    assert {path.name for path in out.glob("*-*.npy")} == {path.name for path in found.shards}


def test_a_source_that_changes_during_the_run_is_noticed(source: Path, tmp_path: Path) -> None:
    def spoil(share: float) -> None:
        if share >= 0.1:  # all has been scanned
            np.save(source, POINTS + 1)

    with pytest.raises(InputError, match="rows 0 to 99 have changed since"):
        liftmesh.tile(source, tmp_path / "out", tile_rows=TILE_ROWS, progress=spoil)


def test_other_options_are_noticed(source: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    stopped_half_way(source, out)
    with pytest.raises(InputError, match="holds a run with tile_rows 100, not 64"):
        liftmesh.tile(source, out, tile_rows=64)
    with pytest.raises(InputError, match="holds a run with nonfinite 'error', not 'skip'"):
        liftmesh.tile(source, out, tile_rows=TILE_ROWS, nonfinite="skip")
    liftmesh.tile(source, out, tile_rows=TILE_ROWS)
    with pytest.raises(InputError, match="holds the triangles of other points: choose"):
        liftmesh.tile(POINTS[1:], out, tile_rows=TILE_ROWS)


def test_what_is_not_ours_stays(source: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "notes.txt").write_text("mine")
    liftmesh.tile(source, out, tile_rows=TILE_ROWS)
    liftmesh.tile(source, out, tile_rows=TILE_ROWS, resume=False)
    assert (out / "notes.txt").read_text() == "mine"


def test_points_on_a_line_leave_nothing_to_open(tmp_path: Path) -> None:
    line = np.arange(800.0).repeat(2).reshape(-1, 2)
    for _ in range(2):
        with pytest.raises(DegenerateInputError, match="all 800 distinct points lie on one line"):
            liftmesh.tile(line, tmp_path, tile_rows=100)


KILLED = """
import os, signal, sys
from pathlib import Path
import liftmesh
source, out, what, files = sys.argv[1:]

def end(_):
    if len(list(Path(out).glob(f".liftmesh-tiles/{what}"))) >= int(files):
        os.kill(os.getpid(), signal.SIGKILL)

liftmesh.tile(source, out, tile_rows=1000, threads=1, progress=end)
"""


@pytest.mark.slow
def test_killed_in_every_stage_and_begun_again(tmp_path: Path) -> None:
    source, out = tmp_path / "points.npy", tmp_path / "out"
    np.save(source, np.random.default_rng(3).random((24_000, 2)))
    liftmesh.tile(source, tmp_path / "expected", tile_rows=1000)
    for what, files in (("run-*", 8), ("tile-*.json", 3), ("seam-*.json", 4)):
        words = (str(source), str(out), what, str(files))
        done = subprocess.run([sys.executable, "-c", KILLED, *words], timeout=300, check=False)
        assert done.returncode == -signal.SIGKILL
        assert not (out / "manifest.json").exists()
    liftmesh.tile(source, out, tile_rows=1000)
    assert contents(out) == contents(tmp_path / "expected")
    shutil.rmtree(out)
