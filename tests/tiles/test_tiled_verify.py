"""`Tiled.verify`: the certificate of one call, from parts; and whatever is wrong is found."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from children import output
from commands import liftmesh as command
from distributions import DISTRIBUTIONS
from tilings import Points

import liftmesh
from liftmesh import Tiled
from liftmesh.errors import FormatError, InputError
from liftmesh.tiles.proof import Findings

LATTICE = np.random.default_rng(5).permutation(np.indices((25, 28)).reshape(2, -1).T) * 1.0
POINTS = np.random.default_rng(8).random((900, 2))
POINTS[10:20] = POINTS[30:40]


@pytest.mark.parametrize("name", [*DISTRIBUTIONS][::2])
def test_the_certificate_is_that_of_one_call(name: str, tmp_path: Path) -> None:
    rng = np.random.default_rng(22)
    points = DISTRIBUTIONS[name](3_000, rng)
    points[rng.integers(0, len(points), 30)] = points[rng.integers(0, len(points), 30)]
    points[[5, 70]] = np.nan
    tiled = liftmesh.tile(points, tmp_path, tile_rows=400, nonfinite="skip")
    expected = liftmesh.verify(points, tiled.to_array(), nonfinite="skip")
    assert tiled.verify(points) == expected
    assert expected.canonical
    assert tiled.verify(iter(np.split(points, [1_000, 1_003])), threads=2) == expected


def kinds(tiled: Tiled, points: Points) -> set[str]:
    found = tiled.verify(points)
    assert not found
    counts = {flaw.kind: flaw.count for flaw in found.flaws}
    assert counts.pop("damaged_files") == 1
    assert counts  # something is wrong
    return {*counts}


def changed(tiled: Tiled, shard: int, triangles: np.ndarray) -> None:
    np.save(tiled.shards[shard], np.ascontiguousarray(triangles))


def flipped(triangles: np.ndarray, points: Points, *, tied: bool = False) -> np.ndarray:
    """Flip an edge of a convex quadrilateral, whose corners may have to be on one circle."""
    for i, (a, b, c) in enumerate(triangles.tolist()):
        for k, other in enumerate(triangles.tolist()):
            beyond = [row for row in other if row not in (a, b)]
            if k != i and len(beyond) == 1:
                (d,) = beyond
                pair = np.array([[c, a, d], [d, b, c]])
                is_tied = liftmesh.incircle(*points[[a, b, c, d]]) == 0
                is_convex = (liftmesh.orient2d(*points[pair].transpose(1, 0, 2)) > 0).all()
                if is_convex and is_tied == tied:
                    copied = triangles.copy()
                    copied[[i, k]] = pair
                    return copied
    raise AssertionError("there is no such edge")


def without_first(triangles: np.ndarray, _: Points) -> np.ndarray:
    return triangles[1:]


def reversed_first(triangles: np.ndarray, _: Points) -> np.ndarray:
    return np.concatenate((triangles[:1, ::-1], triangles[1:]))


def repeated_first(triangles: np.ndarray, _: Points) -> np.ndarray:
    return np.concatenate((triangles, triangles[:1]))


def with_a_far_row(triangles: np.ndarray, points: Points) -> np.ndarray:
    copied = triangles.copy()
    copied[0, 0] = np.abs(points - points[copied[0, 0]]).sum(axis=1).argmax()
    return copied


def with_no_row(triangles: np.ndarray, _: Points) -> np.ndarray:
    return np.where(triangles == triangles[0, 0], 10**12, triangles)


CHANGES: dict[str, tuple[Callable[[np.ndarray, Points], np.ndarray], set[str]]] = {
    "an edge is flipped": (flipped, {"not_delaunay", "not_canonical"}),
    "a triangle is missing": (without_first, {"other_hull"}),
    "a triangle is clockwise": (reversed_first, {"clockwise"}),
    "a triangle is there twice": (repeated_first, {"other_hull"}),
    "a corner is far away": (with_a_far_row, {"other_hull"}),
    "a corner is no row": (with_no_row, {"invalid_index"}),
}


@pytest.mark.parametrize("shard", [0, -1])
@pytest.mark.parametrize("change", CHANGES)
def test_wrong_triangles_are_found(change: str, shard: int, tmp_path: Path) -> None:
    tiled = liftmesh.tile(POINTS, tmp_path, tile_rows=450)
    make, expected = CHANGES[change]
    changed(tiled, shard, make(np.load(tiled.shards[shard]), POINTS))
    assert kinds(tiled, POINTS) >= expected


def test_triangles_in_the_wrong_shard_are_found(tmp_path: Path) -> None:
    """Also where all triangles together are right."""
    tiled = liftmesh.tile(POINTS, tmp_path, tile_rows=450)
    one, other = np.load(tiled.shards[0]), np.load(tiled.shards[1])
    changed(tiled, 0, one[1:])
    changed(tiled, 1, np.concatenate((other, one[:1])))
    assert liftmesh.verify(POINTS, np.concatenate([np.load(path) for path in tiled.shards]))
    assert kinds(tiled, POINTS) >= {"invalid_index"}


def test_another_choice_among_ties_is_not_canonical(tmp_path: Path) -> None:
    tiled = liftmesh.tile(LATTICE, tmp_path, tile_rows=400)
    changed(tiled, 0, flipped(np.load(tiled.shards[0]), LATTICE, tied=True))
    assert kinds(tiled, LATTICE) == {"not_canonical"}


def test_the_flaw_of_ties_is_the_last() -> None:
    findings = Findings()
    for kind in ("not_canonical", "other_hull", "clockwise"):
        findings.add(kind, 1)
    assert [flaw.kind for flaw in findings.flaws()] == ["other_hull", "clockwise", "not_canonical"]


@pytest.mark.parametrize("name", ["hull", "duplicates", "skipped"])
def test_wrong_lists_are_found(name: str, tmp_path: Path) -> None:
    points = np.concatenate((POINTS, [[np.nan, 0], [0, np.inf]]))
    tiled = liftmesh.tile(points, tmp_path, tile_rows=450, nonfinite="skip")
    stated = np.load(tmp_path / f"{name}.npy")
    for wrong in (stated[1:], np.roll(stated + (name == "duplicates"), 1), stated + 1):
        np.save(tmp_path / f"{name}.npy", wrong)
        if name != "hull" or sorted(wrong) != sorted(stated):
            assert kinds(tiled, points) == {f"other_{name}"}


KILLED = """
import os, signal, sys
import liftmesh

def points():
    yield [[0.0, 0.0], [1.0, 0.0]]
    os.kill(os.getpid(), signal.SIGKILL)

liftmesh.open_tiled(sys.argv[1]).verify(points())
"""


def test_what_a_killed_process_leaves_is_removed(tmp_path: Path) -> None:
    tiled = liftmesh.tile(POINTS, tmp_path)
    before = {path.name for path in tmp_path.iterdir()}
    ended = subprocess.run([sys.executable, "-c", KILLED, str(tmp_path)], check=False)
    assert ended.returncode == -signal.SIGKILL
    assert len({path.name for path in tmp_path.iterdir()} - before) == 1
    assert tiled.verify(POINTS).canonical
    assert {path.name for path in tmp_path.iterdir()} == before


def test_the_source_is_found_and_has_to_be_the_same(tmp_path: Path) -> None:
    np.save(tmp_path / "a.npy", POINTS[:500])
    np.save(tmp_path / "b.npy", POINTS[500:])
    sources = [tmp_path / "a.npy", tmp_path / "b.npy"]
    tiled = liftmesh.tile(sources, tmp_path / "out", tile_rows=450)
    assert tiled.verify() == liftmesh.verify(POINTS, tiled.to_array())
    assert tiled.verify(scratch=tmp_path).canonical
    for wrong, message in (
        (sources[::-1], "rows 0 to 449 are not the points that were tiled"),
        (POINTS[:-1], "rows 500 to 898 are not the points"),
        (POINTS[:450], "there are 450 rows, fewer than were tiled"),
        (np.concatenate((POINTS, POINTS[:1])), "rows 900 to 900 are not the points"),
    ):
        with pytest.raises(InputError, match=message):
            tiled.verify(wrong)
    sources[1].unlink()
    with pytest.raises(InputError, match=r"b.npy is missing, whose points were tiled"):
        tiled.verify()
    with pytest.raises(InputError, match="does not name the files of its points: give them"):
        liftmesh.tile(POINTS, tmp_path / "of-array").verify()
    assert not list(tmp_path.rglob(".*"))


def test_progress_and_a_damaged_plan(tmp_path: Path) -> None:
    tiled = liftmesh.tile(POINTS, tmp_path, tile_rows=450)
    shown: list[float] = []
    tiled.verify(POINTS, progress=shown.append)
    assert shown == sorted(shown)
    assert len(shown) > 4
    stated = np.load(tiled.shards[0])
    changed(tiled, 0, stated.astype(np.float64))
    with pytest.raises(FormatError, match=r"tile-00000.npy: damaged \(not rows"):
        tiled.verify(POINTS)
    tiled.shards[0].write_bytes(b"")
    with pytest.raises(FormatError, match=r"tile-00000.npy: damaged \("):
        tiled.verify(POINTS)
    changed(tiled, 0, stated)
    (tmp_path / "plan.json").write_text('{"axes": [0]}')
    with pytest.raises(FormatError, match=r"plan.json: damaged: tile the source again"):
        tiled.verify(POINTS)


@pytest.mark.slow
def test_memory_is_that_of_a_tile(tmp_path: Path) -> None:
    np.save(tmp_path / "points.npy", np.random.default_rng(2).random((400_000, 2)))
    liftmesh.tile(tmp_path / "points.npy", tmp_path / "out", tile_rows=40_000)
    program = """
    import sys, liftmesh
    tiled = liftmesh.open_tiled(sys.argv[1])
    liftmesh.tile([[0, 0], [1, 0], [0, 1]], sys.argv[1] + "/first").verify([[0, 0], [1, 0], [0, 1]])
    before = status("VmHWM")
    assert tiled.verify(threads=1).canonical
    print(status("VmHWM") - before)
    """
    assert int(output(program, tmp_path / "out")) < 30_000_000


def test_the_command_proves_a_folder(tmp_path: Path) -> None:
    np.save(tmp_path / "points.npy", POINTS)
    tiled = liftmesh.tile(tmp_path / "points.npy", tmp_path / "out", tile_rows=450)
    done = command("verify", "out", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert "Valid, and canonical" in done.stdout
    done = command("verify", "out", "--certificate", "out.json", "--json", cwd=tmp_path)
    expected = liftmesh.verify(POINTS, tiled.to_array()).to_json()
    assert (tmp_path / "out.json").read_text() == done.stdout == expected
    (tmp_path / "points.npy").rename(tmp_path / "moved.npy")
    assert command("verify", "out", cwd=tmp_path).returncode == 3
    assert command("verify", "out", "--points", "moved.npy", cwd=tmp_path).returncode == 0
    changed(tiled, 0, reversed_first(np.load(tiled.shards[0]), POINTS))
    done = command("verify", "out", "--points", "moved.npy", cwd=tmp_path)
    assert done.returncode == 1
    assert "such as: tile-00000.npy: triangle 0 of rows" in done.stdout
