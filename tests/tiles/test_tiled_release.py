"""Scratch space given back: rows are removed when tiles are done, and made again if needed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st
from tilings import ordered

import liftmesh
from liftmesh import Tiled
from liftmesh.errors import InputError
from liftmesh.tiles import build, options
from liftmesh.tiles.options import Groups, RunContext
from liftmesh.tiles.schedule import release

ROWS, TILE_ROWS = 6_000, 1_000
POINTS = np.random.default_rng(6).random((ROWS, 2))
CLOUD = np.column_stack((POINTS, np.sin(9 * POINTS[:, 0])))
KINDS = ("triangles", "surface")


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def made(kind: str, source: object, out: Path, **options: Any) -> Tiled:
    if kind == "surface":
        return liftmesh.tile_surface(source, out, tile_rows=TILE_ROWS, **options)
    return liftmesh.tile(source, out, tile_rows=TILE_ROWS, neighbors=True, **options)


def rows_in(out: Path) -> set[str]:
    """List the groups that have files of rows."""
    found = out.glob(".liftmesh-tiles/run-?????-[0-9][0-9]*.npy")
    return {path.stem.split("-")[2] for path in found}


def bytes_in(folder: Path, pattern: str = "*.npy") -> int:
    return sum(path.stat().st_size for path in folder.glob(pattern))


@pytest.fixture(autouse=True, scope="module")
def _many_groups() -> Iterator[None]:
    """Of chunks of a thousand rows there are files of two hundred, so there are five groups."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(options, "_ROWS", 200)
        yield


@pytest.fixture
def source(tmp_path: Path) -> Path:
    np.save(tmp_path / "points.npy", CLOUD)
    return tmp_path / "points.npy"


class StopError(Exception):
    """What ends a run."""


def stopped(kind: str, source: object, out: Path, at: float) -> None:
    """Begin a run that ends after some share of the work."""

    def progress(share: float) -> None:
        if share >= at:
            raise StopError

    with pytest.raises(StopError):
        made(kind, source, out, progress=progress)


@given(tiles=st.integers(1, 400), rows=st.integers(0, 3_000))
def test_groups_have_each_tile_once_and_no_file_is_forgotten(tiles: int, rows: int) -> None:
    found = Groups.of_plan(tiles, rows)
    assert [tile for k in range(found.count) for tile in found.tiles_of(k)] == [*range(tiles)]
    sizes = [len(found.tiles_of(group)) for group in range(found.count)]
    assert max(sizes) - min(sizes) <= 1
    assert all(found.of(tile) == k for k in range(found.count) for tile in found.tiles_of(k))
    assert found.count <= Groups.of_plan(tiles + 1, rows).count
    begins = np.sort(np.random.default_rng(tiles).integers(0, rows + 1, tiles + 1))
    begins[[0, -1]] = 0, rows
    beside = dict.fromkeys(("-boxes", "-skipped", "-duplicates", "-apart"), begins[:0])
    arrays = {"": np.arange(rows), "-values": -np.arange(rows), "-begins": begins, **beside}
    parts = found.apart(arrays)
    assert {*parts} == {*found.names(with_values=True)}
    assert {*found.names(with_values=False)} == {
        end for end in parts if end != "-apart" and "-values" not in end
    }
    rows_again = [parts[f"-{group:02d}"] for group in range(found.count)]
    assert np.array_equal(np.concatenate(rows_again), arrays[""])
    assert all(
        np.array_equal(parts[f"-{k:02d}-values"], -each) for k, each in enumerate(rows_again)
    )


@pytest.mark.parametrize("kind", KINDS)
def test_rows_go_as_triangles_come(kind: str, source: Path, tmp_path: Path) -> None:
    """When a share of the tiles is done, no more than the other share of the rows is there."""
    out = tmp_path / "out"
    at_rest: list[int] = []
    whole: list[int] = []

    def watch(share: float) -> None:
        if share > 0.3:
            at_rest.append(bytes_in(out, ".liftmesh-tiles/run-?????-[0-9][0-9]*.npy"))
            whole.append(at_rest[-1] + bytes_in(out))

    found = made(kind, source, out, progress=watch)
    record = 48 if kind == "surface" else 24
    assert at_rest[0] > 0.8 * record * ROWS
    assert at_rest == sorted(at_rest, reverse=True)
    assert at_rest[-1] == 0
    assert len({*at_rest}) == 6  # all rows, then without one group after the other
    assert max(whole) < bytes_in(out) + 0.1 * record * ROWS
    expected = liftmesh.delaunay(POINTS, order="canonical").simplices
    assert np.array_equal(ordered(found.to_array()), ordered(expected))
    assert found.verify().canonical


def test_shards_do_not_depend_on_groups(
    source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made("surface", source, tmp_path / "many")
    monkeypatch.setattr(options, "_MOST", 1)
    made("surface", source, tmp_path / "one")
    many, one = contents(tmp_path / "many"), contents(tmp_path / "one")
    assert many.pop("manifest.json") != one.pop("manifest.json")  # of another plan
    assert many == one


def test_copies_go_when_their_rows_are_sorted(tmp_path: Path) -> None:
    there: list[bool] = []

    def watch(share: float) -> None:
        there.append(bool([*tmp_path.glob(".liftmesh-tiles/points-*.npy")]))

    found = liftmesh.tile(iter(np.split(POINTS, 5)), tmp_path, tile_rows=TILE_ROWS, progress=watch)
    assert there[0] is False  # nothing has been read
    assert there[1:] == sorted(there[1:], reverse=True)
    assert 10 < sum(there) < len(there) - 5
    assert found.is_sound()


def test_copies_are_made_again_for_rows_that_are_missing(tmp_path: Path) -> None:
    """What comes once has to come again for that."""

    def once() -> Iterator[Any]:
        return iter(np.split(CLOUD, 5))

    made("surface", once(), tmp_path / "expected")
    out = tmp_path / "out"
    stopped("surface", once(), out, 0.8)
    assert not [*out.glob(".liftmesh-tiles/points-*.npy")]
    (out / "tile-00000-faces.npy").unlink()
    made("surface", once(), out)
    assert contents(out) == contents(tmp_path / "expected")


def test_a_copy_that_is_no_copy_stays(tmp_path: Path) -> None:
    """Whoever keeps a source among our files finds it there afterwards."""
    scratch = tmp_path / ".liftmesh-tiles"
    stopped("triangles", POINTS, tmp_path, 0.2)
    np.save(scratch / "mine.npy", POINTS)
    made("triangles", scratch / "mine.npy", tmp_path)
    assert np.array_equal(np.load(scratch / "mine.npy"), POINTS)


KILLED = """
import os, signal, sys, liftmesh
from pathlib import Path
from liftmesh.tiles import options
options._ROWS = 200
unlink, left = Path.unlink, int(sys.argv[3])
def killing(path, **options):
    global left
    left -= path.name.startswith("run-")
    if left == 0:
        os.kill(os.getpid(), signal.SIGKILL)
    unlink(path, **options)
Path.unlink = killing
liftmesh.tile_surface(sys.argv[1], sys.argv[2], tile_rows=1000, threads=1)
"""


@pytest.mark.slow
def test_killed_before_and_while_rows_are_removed(source: Path, tmp_path: Path) -> None:
    """There are 12 files in a group, so these are the first, the last, and one between."""
    made("surface", source, tmp_path / "expected")
    out = tmp_path / "out"
    for number, left in ((1, {f"{k:02d}" for k in range(5)}), (24, None), (19, None)):
        command = [sys.executable, "-c", KILLED, str(source), str(out), str(number)]
        assert subprocess.run(command, check=False).returncode == -signal.SIGKILL
        assert left in (None, rows_in(out))
        assert not (out / "manifest.json").exists()
    made("surface", source, out)
    assert contents(out) == contents(tmp_path / "expected")
    assert not (out / ".liftmesh-tiles").exists()


DAMAGES: dict[str, Callable[[Path], Any]] = {
    "truncated": lambda path: path.write_bytes(path.read_bytes()[:-5]),
    "removed": lambda path: path.unlink(),
    "changed": lambda path: path.write_bytes(path.read_bytes()[:-1] + b"\xff"),
}


@pytest.mark.parametrize(
    ("name", "damage", "kind"),
    [
        ("tile-00000.npy", "truncated", "triangles"),
        ("tile-00000-neighbors.npy", "changed", "triangles"),
        ("tile-00000-vertices.npy", "removed", "surface"),
        (".liftmesh-tiles/tile-00000-rim.npy", "changed", "triangles"),
        (".liftmesh-tiles/tile-00000-values.npy", "removed", "surface"),
        (".liftmesh-tiles/tile-00000.json", "truncated", "surface"),
    ],
)
def test_damage_to_a_tile_whose_rows_are_gone(
    name: str, damage: str, kind: str, source: Path, tmp_path: Path
) -> None:
    """The rows of its group are sorted again from the source, and of no other that is done."""
    made(kind, source, tmp_path / "expected")
    out = tmp_path / "out"
    stopped(kind, source, out, 0.7)
    before = rows_in(out)
    assert "00" not in before
    assert 0 < len(before) < 4
    times = {path: path.stat().st_mtime_ns for path in out.glob("tile-*.npy")}
    DAMAGES[damage](out / name)
    seen: list[set[str]] = []
    made(kind, source, out, progress=lambda _: seen.append(rows_in(out)))
    assert set.union(*seen) == before | {"00"}
    assert contents(out) == contents(tmp_path / "expected")
    assert not (out / ".liftmesh-tiles").exists()
    again = {path.name for path, time in times.items() if path.stat().st_mtime_ns != time}
    assert {each[:10] for each in again} == {"tile-00000"}


def test_nothing_is_sorted_again_that_is_not_needed(source: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    stopped("triangles", source, out, 0.7)
    before = rows_in(out)
    seen: list[set[str]] = []
    made("triangles", source, out, progress=lambda _: seen.append(rows_in(out)))
    assert set.union(*seen) == before


def test_the_record_of_a_chunk_is_damaged_and_then_a_tile(source: Path, tmp_path: Path) -> None:
    """A record names the files that were needed when it was written; a later run needs others."""
    made("surface", source, tmp_path / "expected")
    out = tmp_path / "out"
    stopped("surface", source, out, 0.7)
    before = rows_in(out)
    record = out / ".liftmesh-tiles" / "run-00003.json"
    record.write_bytes(record.read_bytes()[:-9])
    stopped("surface", source, out, 0.31)
    assert rows_in(out) == before
    (out / "tile-00000.npy").unlink()
    stopped("surface", source, out, 0.8)
    assert rows_in(out) < before
    (out / "tile-00001.npy").unlink()
    made("surface", source, out)
    assert contents(out) == contents(tmp_path / "expected")


def test_a_source_that_has_changed_cannot_replace_rows(source: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    stopped("triangles", source, out, 0.7)
    (out / "tile-00000.npy").unlink()
    np.save(source, CLOUD + np.array([1e-9, 0, 0]))
    with pytest.raises(InputError, match="a run with other points"):
        made("triangles", source, out)


def test_tiles_that_were_cut_again_and_are_done(
    source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Their rows are gone: no sample of them can be drawn, and none is needed."""
    monkeypatch.setattr(build, "_LARGE", 0.9)  # of what a tile should have: some are cut
    whole = made("triangles", source, tmp_path / "expected")
    assert whole.manifest["merges"]["tiles"] > ROWS // TILE_ROWS + 2
    out = tmp_path / "out"
    stopped("triangles", source, out, 0.8)
    assert len(rows_in(out)) < 4
    kept = {path: path.stat().st_mtime_ns for path in out.rglob("run-*.npy")}
    stopped("triangles", source, out, 0.9)
    assert kept
    left = {path: path.stat().st_mtime_ns for path in out.rglob("run-*.npy")}
    assert left.items() <= kept.items()  # nothing was sorted by the plan before it was cut again
    made("triangles", source, out)
    assert contents(out) == contents(tmp_path / "expected")


def test_rows_go_when_the_names_of_records_are_on_the_disk(
    source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A loss of power must not take both the rows of a group and what its tiles have done."""
    unsure: set[str] = set()  # names in the scratch folder for which nobody has waited
    removed: list[str] = []
    scratch = tmp_path / "out" / ".liftmesh-tiles"
    sync, replace, unlink = os.fsync, os.replace, os.unlink

    def syncing(file: int) -> None:
        sync(file)
        if Path(f"/proc/self/fd/{file}").resolve() == scratch:
            unsure.clear()

    def replacing(old: str, new: str, **folders: int) -> None:
        replace(old, new, **folders)
        if Path(f"/proc/self/fd/{folders['dst_dir_fd']}").resolve() == scratch:
            unsure.add(new)

    def unlinking(path: Any, **folder: int) -> None:
        name = Path(path).name
        if name.startswith("run-") and not (scratch.parent / "manifest.json").exists():
            assert not {each for each in unsure if each.endswith(".json")}, name
            removed.append(name)
        unlink(path, **folder)

    monkeypatch.setattr(os, "fsync", syncing)
    monkeypatch.setattr(os, "replace", replacing)
    monkeypatch.setattr(os, "unlink", unlinking)
    made("triangles", source, tmp_path / "out")
    assert len(removed) == 5 * ROWS // TILE_ROWS


def test_rows_that_are_needed_are_not_removed(tmp_path: Path) -> None:
    run_context = RunContext(tmp_path, tmp_path, chunks=1, groups=Groups(4, 2))
    (tmp_path / "run-00000-01.npy").touch()
    with pytest.raises(RuntimeError, match="rows of group 1 are still needed"):
        release(run_context, 1, [])
    assert (tmp_path / "run-00000-01.npy").exists()
