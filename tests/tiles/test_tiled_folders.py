"""Folders of triangles in tiles: what a run did not make stays, and two runs do not mix."""

from __future__ import annotations

import itertools
import json
import os
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import liftmesh
from liftmesh.errors import DegenerateInputError, FormatError, InputError, NonFiniteError
from liftmesh.tiles import build, lock, plan

POINTS = np.random.default_rng(4).integers(0, 30, (600, 2)).astype(np.float64)
ROWS = 100


def contents(folder: Path) -> dict[str, bytes]:
    places = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in places}


class StopError(Exception):
    """What ends a run."""


def stopped(source: object, out: Path, *, at: float = 0.5, **options: Any) -> None:
    """Begin a run that ends after some share of the work."""

    def progress(share: float) -> None:
        if share >= at:
            raise StopError

    with pytest.raises(StopError):
        liftmesh.tile(source, out, tile_rows=ROWS, progress=progress, **options)


def test_a_scratch_folder_with_the_name_of_the_result_is_left_alone(tmp_path: Path) -> None:
    survey = tmp_path / "data" / "survey"
    survey.mkdir(parents=True)
    np.save(survey / "cloud.npy", POINTS)
    (survey / "notes.txt").write_text("mine")
    before = contents(tmp_path / "data")
    out, scratch = tmp_path / "results" / "survey", tmp_path / "data"
    for resume in (True, False):
        liftmesh.tile(survey / "cloud.npy", out, tile_rows=ROWS, scratch=scratch, resume=resume)
        assert contents(tmp_path / "data") == before
    assert [path.name for path in scratch.iterdir()] == ["survey"]


@pytest.mark.parametrize("name", [".liftmesh-tiles", "scratch"])
def test_folders_in_the_result_that_no_run_has_made(name: str, tmp_path: Path) -> None:
    (tmp_path / "out" / name).mkdir(parents=True)
    (tmp_path / "out" / name / "job.json").write_text("mine")
    before = contents(tmp_path)
    for resume in (True, False):
        if name == "scratch":
            liftmesh.tile(POINTS, tmp_path / "out", tile_rows=ROWS, resume=resume)
        else:
            with pytest.raises(InputError, match=r"\.liftmesh-tiles was not made by liftmesh"):
                liftmesh.tile(POINTS, tmp_path / "out", tile_rows=ROWS, resume=resume)
            assert contents(tmp_path) == before
    assert (tmp_path / "out" / name / "job.json").read_text() == "mine"


@pytest.mark.parametrize(
    ("name", "resume"),
    [
        ("tile-00000.npy", False),
        ("seam-00007.npy", True),
        ("hull.npy", True),
        ("tile-00000.ply", False),
        ("tile-00003.parquet", True),
        ("seam-00007-links.npy", False),
        ("tile-00003-neighbors.npy", True),
        ("manifest.json", False),
    ],
)
def test_files_with_our_names_that_no_run_has_made(name: str, resume: bool, tmp_path: Path) -> None:
    with (tmp_path / name).open("wb") as stream:
        np.save(stream, POINTS)
    before = contents(tmp_path)
    for source in (POINTS, [tmp_path / name]):
        with pytest.raises((InputError, FormatError), match=rf"{name} was not made by a run"):
            liftmesh.tile(source, tmp_path, tile_rows=ROWS, resume=resume)
        assert contents(tmp_path) == before


def test_the_source_may_lie_beside_its_triangles(tmp_path: Path) -> None:
    np.save(tmp_path / "tile-a.npy", POINTS)
    for resume in (True, False):
        liftmesh.tile(tmp_path / "tile-a.npy", tmp_path, tile_rows=ROWS, resume=resume)
    assert np.array_equal(np.load(tmp_path / "tile-a.npy"), POINTS)


def test_triangles_are_no_source_for_their_own_folder(tmp_path: Path) -> None:
    found = liftmesh.tile(POINTS, tmp_path, tile_rows=ROWS)
    before = contents(tmp_path)
    with pytest.raises(InputError, match=r"tile-00000.npy would be overwritten"):
        liftmesh.tile(found.shards[0], tmp_path, tile_rows=ROWS, resume=False)
    with pytest.raises(FileNotFoundError):
        liftmesh.tile("missing.npy", tmp_path, tile_rows=ROWS, resume=False)
    assert contents(tmp_path) == before


def test_one_scratch_folder_for_two_results_of_one_name(tmp_path: Path) -> None:
    scratch = tmp_path / "scratch"
    stopped(POINTS, tmp_path / "a" / "tiles", scratch=scratch)
    found = liftmesh.tile(POINTS[:500], tmp_path / "b" / "tiles", tile_rows=90, scratch=scratch)
    assert found.nsimplex == liftmesh.delaunay(POINTS[:500]).nsimplex
    again = liftmesh.tile(POINTS, tmp_path / "a" / "tiles", tile_rows=ROWS, scratch=scratch)
    assert again.nsimplex == liftmesh.delaunay(POINTS).nsimplex
    assert list(scratch.iterdir()) == []


def test_another_scratch_folder_than_before(tmp_path: Path) -> None:
    stopped(POINTS, tmp_path / "out", scratch=tmp_path / "first")
    with pytest.raises(InputError, match=r"holds a run that works in .*first"):
        liftmesh.tile(POINTS, tmp_path / "out", tile_rows=ROWS)
    liftmesh.tile(POINTS, tmp_path / "out", tile_rows=ROWS, resume=False)
    assert list((tmp_path / "first").iterdir()) == []
    assert not [path for path in (tmp_path / "out").iterdir() if path.name.startswith(".")]


WORKING = """
import sys, liftmesh
def wait(share):
    print("at work", flush=True)
    sys.stdin.readline()
liftmesh.tile(sys.argv[1], sys.argv[2], tile_rows=100, progress=wait)
"""


def test_two_runs_in_one_folder(tmp_path: Path) -> None:
    np.save(tmp_path / "points.npy", POINTS)
    command = [sys.executable, "-c", WORKING, tmp_path / "points.npy", tmp_path / "out"]
    with subprocess.Popen(command, stdin=-1, stdout=-1, text=True) as child:
        assert child.stdout is not None
        assert child.stdout.readline() == "at work\n"
        said = f"out is being written by process {child.pid} on "
        for options in ({}, {"resume": False}, {"scratch": tmp_path / "other"}):
            with pytest.raises(InputError, match=said):
                liftmesh.tile(POINTS, tmp_path / "out", tile_rows=ROWS, **options)  # type: ignore[arg-type]
        child.communicate("\n" * 1000)
    assert child.returncode == 0
    assert liftmesh.open_tiled(tmp_path / "out").is_sound()


class Paused(threading.Thread):
    """A run that stops before a step of claiming its folders, or at work, until it may go on."""

    def __init__(self, step: str, out: Path) -> None:
        super().__init__(daemon=True)
        self.step, self.out = step, out
        self.is_there, self.may_go = threading.Event(), threading.Event()
        self.error: BaseException | None = None
        self.start()
        self.is_there.wait()

    def run(self) -> None:
        try:
            liftmesh.tile(POINTS[:40], self.out, tile_rows=16, progress=lambda _: self.at("work"))
        except BaseException as error:  # noqa: BLE001 - looked at by the test
            self.error = error
        self.is_there.set()

    def at(self, step: str) -> None:
        if step == self.step and not self.is_there.is_set():
            self.is_there.set()
            self.may_go.wait()

    def finish(self) -> None:
        self.may_go.set()
        self.join()


STEPS = ("_make_folders", "_lock", "_take", "_make", "save_json", "work")


@pytest.mark.parametrize("first", STEPS)
def test_two_runs_begun_together_in_a_new_folder(
    first: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One waits before any step, the other begins and gets to any step: whoever goes on first."""

    def watched(name: str, call: Callable[..., Any]) -> Callable[..., Any]:
        def watching(*arguments: Any, **options: Any) -> Any:
            run = threading.current_thread()
            if isinstance(run, Paused):
                run.at(name)
            return call(*arguments, **options)

        return watching

    monkeypatch.setattr(os, "fsync", lambda _: None)  # it takes most of the time
    for name in STEPS[:-1]:
        monkeypatch.setattr(lock, name, watched(name, getattr(lock, name)))
    for turn, second in itertools.product((1, -1), STEPS):
        out = tmp_path / f"{second}{turn}" / "out"
        runs = [Paused(first, out), Paused(second, out)]
        for each in runs[::turn]:
            each.finish()
        refused = [each.error for each in runs if each.error is not None]
        assert len(refused) < 2
        for error in refused:
            assert isinstance(error, InputError)
            assert "out is being written by" in str(error)
        assert liftmesh.open_tiled(out).is_sound()
        assert not [*out.glob(".*")]


def test_links_that_others_have_planted_are_not_followed(tmp_path: Path) -> None:
    """Not in the folder of the result, nor in that for scratch."""
    mine = tmp_path / "mine.txt"
    mine.write_text("forty pages")
    for number, (link, name) in enumerate(
        itertools.product((Path.symlink_to, Path.hardlink_to), (mine.name, "missing.txt"))
    ):
        out = tmp_path / f"out{number}"
        out.mkdir()
        if name == mine.name or link is Path.symlink_to:
            link(out / ".liftmesh-run", tmp_path / name)
            with pytest.raises(InputError, match=r"\.liftmesh-run was not made by a run"):
                liftmesh.tile(POINTS, out, tile_rows=ROWS)
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "out" / "scratch").mkdir(parents=True)
    (tmp_path / "out" / ".liftmesh-tiles").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(InputError, match=r"\.liftmesh-tiles is a link: remove it"):
        liftmesh.tile(POINTS, tmp_path / "out", tile_rows=ROWS)
    assert [path.name for path in tmp_path.glob("*.txt")] == ["mine.txt"]
    assert mine.read_text() == "forty pages"
    assert [*(tmp_path / "elsewhere").iterdir()] == []


@pytest.mark.parametrize("name", ["hull.npy", "tile-00000.npy", "manifest.json", "plan.json"])
def test_links_in_the_place_of_our_files_are_replaced(name: str, tmp_path: Path) -> None:
    """A claim that is all right lets a run go on among them."""
    out, mine = tmp_path / "out", tmp_path / "mine.txt"
    stopped(POINTS, out)
    mine.write_text("forty pages")
    for place in (mine, tmp_path / "missing.txt"):
        (out / name).unlink(missing_ok=True)
        (out / name).symlink_to(place)
        if name == "manifest.json" and place == mine:
            with pytest.raises(FormatError, match="not valid JSON"):
                liftmesh.tile(POINTS, out, tile_rows=ROWS)
            (out / name).unlink()
            continue
        liftmesh.tile(POINTS, out, tile_rows=ROWS)
        assert not (out / name).is_symlink()
        stopped(POINTS, out, resume=False)
    assert mine.read_text() == "forty pages"
    assert not (tmp_path / "missing.txt").exists()


@pytest.mark.parametrize(
    "text", ["forty pages", "[]", "{}", '{"holder": "me"}', '{"holder": "me", "scratch": 5}']
)
def test_a_claim_that_no_run_has_made(text: str, tmp_path: Path) -> None:
    (tmp_path / ".liftmesh-run").write_text(text)
    for resume in (True, False):
        with pytest.raises(InputError, match=r"\.liftmesh-run was not made by a run"):
            liftmesh.tile(POINTS, tmp_path, tile_rows=ROWS, resume=resume)
    assert (tmp_path / ".liftmesh-run").read_text() == text


def test_a_claim_that_names_the_scratch_folder_of_another_run(tmp_path: Path) -> None:
    """Nothing is removed there, though it is one of ours."""
    stopped(POINTS, tmp_path / "other", scratch=tmp_path / "scratch")
    before = contents(tmp_path / "scratch")
    (tmp_path / "out").mkdir()
    (named,) = (tmp_path / "scratch").iterdir()
    claimed = {"holder": "me", "scratch": str(named)}
    (tmp_path / "out" / ".liftmesh-run").write_text(json.dumps(claimed))
    with pytest.raises(InputError, match="holds a run that works in"):
        liftmesh.tile(POINTS, tmp_path / "out", tile_rows=ROWS)
    liftmesh.tile(POINTS, tmp_path / "out", tile_rows=ROWS, resume=False)
    assert contents(tmp_path / "scratch") == before


def test_what_cannot_be_resumed_leaves_no_scratch(tmp_path: Path) -> None:
    line = np.arange(800.0).repeat(2).reshape(-1, 2)
    bad = np.concatenate((POINTS, [[np.nan, 0]]))
    for source, error in ((line, DegenerateInputError), (iter([bad]), NonFiniteError)):
        with pytest.raises(error):
            liftmesh.tile(source, tmp_path / "out", tile_rows=ROWS)
        assert list(tmp_path.iterdir()) == []
    liftmesh.tile(POINTS, tmp_path / "out", tile_rows=ROWS)  # the source was repaired
    before = contents(tmp_path)
    with pytest.raises(InputError, match="holds the triangles of other points"):
        liftmesh.tile(iter([POINTS[:300]]), tmp_path / "out", tile_rows=ROWS)
    assert contents(tmp_path) == before


COLUMN = np.column_stack((np.zeros(50), np.arange(50.0)))
REFUSED = {
    "missing": FileNotFoundError,
    "empty": DegenerateInputError,
    "garbage": FormatError,
    "nan": NonFiniteError,
    "line": DegenerateInputError,
}


@pytest.mark.parametrize("make", [liftmesh.tile, liftmesh.tile_surface])
@pytest.mark.parametrize("kind", REFUSED)
def test_folders_that_were_made_for_nothing_are_removed(
    make: Callable[..., Any], kind: str, tmp_path: Path
) -> None:
    heights = np.column_stack((COLUMN, COLUMN[:, 1]))
    arrays = {"empty": heights[:0], "nan": heights * np.nan, "line": heights}
    if kind == "garbage":
        (tmp_path / "cloud.npy").write_bytes(b"garbage")
    elif kind in arrays:
        np.save(tmp_path / "cloud.npy", arrays[kind])
    (tmp_path / "there").mkdir()
    before = sorted(tmp_path.rglob("*"))
    for out in (tmp_path / "a" / "b" / "out", tmp_path / "there" / "out", tmp_path / "there"):
        for scratch in (None, tmp_path / "a" / "scratch", tmp_path / "there"):
            with pytest.raises(REFUSED[kind]):
                make(tmp_path / "cloud.npy", out, tile_rows=30, scratch=scratch)
            assert sorted(tmp_path.rglob("*")) == before


def test_folders_that_were_made_for_a_scratch_that_is_a_file_are_removed(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(NotADirectoryError):
        liftmesh.tile(POINTS, tmp_path / "a" / "out", scratch=tmp_path / "file")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_a_run_that_can_go_on_keeps_the_folders_that_it_made(tmp_path: Path) -> None:
    out, scratch = tmp_path / "a" / "out", tmp_path / "b" / "scratch"
    stopped(POINTS, out, scratch=scratch)
    assert any(scratch.iterdir())
    liftmesh.tile(POINTS, out, tile_rows=ROWS, scratch=scratch)
    assert list(scratch.iterdir()) == []


def test_files_that_a_kill_left_without_names_are_removed(tmp_path: Path) -> None:
    points = np.random.default_rng(4).random((400, 2))
    stopped(points, tmp_path)
    left, foreign = tmp_path / ".liftmesh-0123456789abcdef", tmp_path / ".liftmesh-notes"
    for path in (left, foreign):
        path.write_text("a")
        os.utime(path, (1e9, 1e9))
    written_now = tmp_path / ".liftmesh-fedcba9876543210"

    def also_write(share: float) -> None:
        if share < 0.5:  # not in the end, when what was left has been removed
            written_now.touch()

    liftmesh.tile(points, tmp_path, tile_rows=100, progress=also_write)
    assert not left.exists()
    assert foreign.exists()
    assert written_now.exists()  # perhaps by another process


def test_a_plan_of_another_program_is_not_mixed_with_this_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    liftmesh.tile(POINTS, tmp_path / "expected", tile_rows=ROWS)
    with monkeypatch.context() as patch:
        patch.setattr(plan, "_axis", lambda part, wanted: len(part) % 2)
        stopped(POINTS, tmp_path / "out", at=0.6)
    liftmesh.tile(POINTS, tmp_path / "out", tile_rows=ROWS)
    assert contents(tmp_path / "out") == contents(tmp_path / "expected")


def test_the_size_of_tiles_is_that_of_the_run_that_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stopped(POINTS, tmp_path)
    assert liftmesh.tile(POINTS, tmp_path).manifest["tile_rows"] == ROWS
    monkeypatch.setattr(build, "TILE_ROWS", 70)
    assert liftmesh.tile(POINTS, tmp_path).manifest["tile_rows"] == ROWS


RECORDS: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda _: b"{}",
    "cut off": lambda text: text[: len(text) // 2],
    "a count changed": lambda text: text.replace(b'"rows": ', b'"rows": 1'),
}


@pytest.mark.parametrize("change", RECORDS)
def test_damaged_records_count_as_none(change: str, tmp_path: Path) -> None:
    liftmesh.tile(POINTS, tmp_path / "expected", tile_rows=ROWS)
    stopped(POINTS, tmp_path / "out", at=0.9)
    scratch = tmp_path / "out" / ".liftmesh-tiles"
    for path in [*scratch.glob("run-*.json"), *scratch.glob("tile-*.json"), scratch / "plan.json"]:
        path.write_bytes(RECORDS[change](path.read_bytes()))
    job = (scratch / "job.json").read_bytes()
    (scratch / "job.json").write_bytes(job[:-9])
    with pytest.raises(InputError, match=r"job.json: damaged: begin anew with resume=False"):
        liftmesh.tile(POINTS, tmp_path / "out", tile_rows=ROWS)
    (scratch / "job.json").write_bytes(job)
    liftmesh.tile(POINTS, tmp_path / "out", tile_rows=ROWS)
    assert contents(tmp_path / "out") == contents(tmp_path / "expected")


def test_manifests_that_are_damaged(tmp_path: Path) -> None:
    liftmesh.tile(POINTS, tmp_path, tile_rows=ROWS)
    place = tmp_path / "manifest.json"
    whole = json.loads(place.read_text())
    del whole["shards"]
    place.write_text(json.dumps(whole))
    for call in (liftmesh.open_tiled, lambda out: liftmesh.tile(POINTS, out, tile_rows=ROWS)):
        with pytest.raises((FormatError, InputError), match=r"manifest.json"):
            call(tmp_path)


def test_a_hull_that_is_missing_is_named(tmp_path: Path) -> None:
    liftmesh.tile(POINTS, tmp_path, tile_rows=ROWS)
    (tmp_path / "hull.npy").unlink()
    with pytest.raises(FormatError, match=r"hull.npy: 0 bytes of .*the file is damaged"):
        liftmesh.open_tiled(tmp_path)
    assert liftmesh.tile(POINTS, tmp_path, tile_rows=ROWS).is_sound()
