"""Triangulations in tiles: every source, every count, and what is refused."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pytest
from children import output
from tilings import Points, ordered

import liftmesh
from liftmesh import Tiled
from liftmesh.errors import (
    DegenerateInputError,
    FormatError,
    InputError,
    NonFiniteError,
    UnsupportedTypeError,
)

ROWS = 700


def lattice_with_ties() -> Points:
    """A lattice, in which nearly every circle has four points; some rows are there twice."""
    rng = np.random.default_rng(5)
    points = rng.permutation(np.indices((25, 28)).reshape(2, -1).T).astype(np.float64)
    points[rng.integers(0, ROWS, 40)] = points[rng.integers(0, ROWS, 40)]
    return points


POINTS = lattice_with_ties()


def check(tiled: Tiled, points: Points = POINTS) -> None:
    expected = liftmesh.delaunay(points, nonfinite="skip", order="canonical")
    assert np.array_equal(ordered(tiled.to_array()), ordered(expected.simplices))
    assert np.array_equal(tiled.duplicates, expected.duplicates)
    assert np.array_equal(tiled.skipped, expected.skipped)
    assert np.array_equal(tiled.convex_hull, expected.convex_hull)
    assert (tiled.npoints, tiled.nsimplex) == (len(points), expected.nsimplex)
    assert tiled.to_array().dtype == tiled.duplicates.dtype == np.int64
    assert tiled.is_sound()
    check_report(tiled)


def check_report(tiled: Tiled) -> None:
    """Every row is a vertex, a duplicate of one, or skipped."""
    report, used = tiled.report, np.unique(tiled.to_array())
    assert report.n_rows == report.n_used + report.n_duplicates + report.n_skipped
    assert (report.n_used, report.n_triangles, report.n_overhangs) == (len(used), tiled.nsimplex, 0)
    assert np.array_equal(np.sort(np.r_[used, report.left_out]), np.arange(tiled.npoints))
    assert np.array_equal(report.left_out, np.sort(report.left_out))
    is_skipped = report.representatives < 0
    assert np.array_equal(report.left_out[is_skipped], tiled.skipped)
    pairs = np.column_stack((report.left_out, report.representatives))[~is_skipped]
    assert np.array_equal(pairs, tiled.duplicates)
    assert report.left_out.dtype == report.representatives.dtype == np.int64


def npy(folder: Path, array: np.ndarray) -> Path:
    np.save(folder / "points.npy", array)
    return folder / "points.npy"


def parquet(folder: Path, names: tuple[str, ...] = ("x", "z", "y")) -> Path:
    columns = POINTS[:, 0], POINTS[:, 0], POINTS[:, 1]
    table = pa.table(dict(zip(names, columns, strict=True)))
    pyarrow.parquet.write_table(table, folder / "points.parquet", row_group_size=90)
    return folder / "points.parquet"


def written(folder: Path, name: str) -> Path:
    liftmesh.write(folder / name, np.column_stack((POINTS, np.zeros(ROWS))))
    return folder / name


def two_files(folder: Path) -> list[Path]:
    np.save(folder / "first.npy", POINTS[:300])
    np.save(folder / "second.npy", np.column_stack((POINTS[300:], POINTS[300:, 0])))
    return [folder / "first.npy", folder / "second.npy"]


SOURCES: dict[str, Callable[[Path], object]] = {
    "array": lambda _: POINTS,
    "lists": lambda _: POINTS.tolist(),
    "cloud": lambda _: liftmesh.Cloud(np.column_stack((POINTS, np.ones(ROWS)))),
    "NPY": lambda folder: npy(folder, POINTS),
    "NPY by columns": lambda folder: npy(folder, np.asfortranarray(POINTS)),
    "NPY of three columns": lambda folder: npy(folder, np.column_stack((POINTS, POINTS))[:, :3]),
    "NPY in single precision": lambda folder: npy(folder, POINTS.astype(np.float32)),
    "NPY of big-endian integers": lambda folder: npy(folder, POINTS.astype(">i4")),
    "name of a file": lambda folder: str(npy(folder, POINTS)),
    "mapped array": lambda folder: np.load(npy(folder, POINTS), mmap_mode="r"),
    "part of a mapped array": lambda folder: np.load(
        npy(folder, np.concatenate((POINTS[:9], POINTS))), mmap_mode="r"
    )[9:],
    "Parquet": parquet,
    "text": lambda folder: written(folder, "points.xyz"),
    "PLY": lambda folder: written(folder, "points.ply"),
    "several files": two_files,
    "arrays that come once": lambda _: iter(np.split(POINTS, [3, 3, 250, 650])),
}


@pytest.mark.parametrize(
    ("kind", "tile_rows"), [*((kind, 200) for kind in SOURCES), ("NPY", 1_000), ("array", 64)]
)
def test_every_source_is_that_of_one_call(kind: str, tile_rows: int, tmp_path: Path) -> None:
    found = liftmesh.tile(SOURCES[kind](tmp_path), tmp_path / "out", tile_rows=tile_rows)
    check(found)
    check(liftmesh.open_tiled(tmp_path / "out"))
    names = sorted(path.name for path in (tmp_path / "out").iterdir())
    shards = [path.name for path in found.shards]
    lists = ["duplicates.npy", "skipped.npy", "hull.npy"]
    assert names == sorted([*shards, *lists, "plan.json", "manifest.json"])


def test_a_source_of_many_parts_has_rows_of_64_bits(tmp_path: Path) -> None:
    points = np.random.default_rng(1).normal(size=(24_000, 2))
    points[::50] = points[7]
    points[[5, 23_999]] = np.nan
    found = liftmesh.tile(points, tmp_path, tile_rows=2_000, nonfinite="skip")
    check(found, points)
    merges = found.manifest["merges"]
    assert merges["tiles"] == 12
    assert merges["rows_up_from_tiles"] < 0.15 * len(points)
    assert merges["rows_at_root"] < merges["rows_up_from_tiles"] / 3


def test_points_on_a_circle_go_straight_to_the_root(tmp_path: Path) -> None:
    angles = np.linspace(0, 6, 3_000)
    points = np.column_stack((np.cos(angles), np.sin(angles)))
    found = liftmesh.tile(points, tmp_path, tile_rows=200)
    check(found, points)
    assert found.manifest["merges"]["rows_at_root"] == 3_000
    assert len(found.shards) == 1


def test_the_manifest_names_files_and_their_rows(tmp_path: Path) -> None:
    found = liftmesh.tile(two_files(tmp_path), tmp_path / "out", tile_rows=100)
    first, second = found.manifest["source"]
    assert first == {"file": "first.npy", "path": "../first.npy", "first": 0, "rows": 300}
    assert second == {"file": "second.npy", "path": "../second.npy", "first": 300, "rows": 400}
    assert [chunk["rows"] for chunk in found.manifest["chunks"]] == [100] * 7
    assert sum(shard["triangles"] for shard in found.manifest["shards"]) == found.nsimplex
    assert found.manifest["neighbors"] is False
    assert found.manifest["shard_format"] == "npy"
    assert repr(found).startswith(f"<Tiled: {found.nsimplex} triangles over 700 rows in ")


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def test_bytes_depend_on_points_and_options_alone(tmp_path: Path) -> None:
    liftmesh.tile(POINTS, tmp_path / "a", tile_rows=90, threads=1)
    (tmp_path / "scratch").mkdir()
    again = iter(np.split(POINTS, [600]))
    liftmesh.tile(again, tmp_path / "b", tile_rows=90, threads=2, scratch=tmp_path / "scratch")
    one, other = contents(tmp_path / "a"), contents(tmp_path / "b")
    assert one.pop("manifest.json") != other.pop("manifest.json")  # the source has another name
    assert one == other
    assert list((tmp_path / "scratch").iterdir()) == []


def test_dask_reads_the_shards(tmp_path: Path) -> None:
    found = liftmesh.tile(POINTS, tmp_path, tile_rows=64)
    assert found.simplices.dtype == np.int64
    assert found.simplices.shape == (found.nsimplex, 3)
    assert len(found.simplices.chunks[0]) == len(found.shards)
    assert np.array_equal(found.simplices.compute(), found.to_array())
    frame = found.to_dask_dataframe().compute()
    assert list(frame.columns) == ["a", "b", "c"]
    assert np.array_equal(frame.to_numpy(), found.to_array())
    assert sum(len(block) for block in found.iter_blocks()) == found.nsimplex


@pytest.mark.parametrize(
    ("source", "error", "message"),
    [
        (np.zeros((0, 2)), DegenerateInputError, "the source has no rows"),
        (np.zeros((1, 2)), DegenerateInputError, "1 row holds 1 distinct planar point: a tri"),
        (np.zeros((9, 2)), DegenerateInputError, "9 rows hold 1 distinct planar point:"),
        (
            np.arange(400.0).repeat(2).reshape(-1, 2),
            DegenerateInputError,
            "all 400 distinct points",
        ),
        (np.zeros((4, 4)), InputError, r"points need the shape \(n, 2\) or \(n, 3\), not \(4, 4\)"),
        (np.array([[2**53 + 1, 0]]), InputError, "array: .*9007199254740993"),
        ("missing.npy", FileNotFoundError, "missing.npy"),
        (7, UnsupportedTypeError, "int"),
    ],
)
def test_sources_that_are_refused(
    source: object, error: type[Exception], message: str, tmp_path: Path
) -> None:
    with pytest.raises(error, match=message):
        liftmesh.tile(source, tmp_path / "out", tile_rows=64)
    assert not (tmp_path / "out" / "manifest.json").exists()


def test_a_row_that_is_not_finite_is_named_by_its_number(tmp_path: Path) -> None:
    points = POINTS.copy()
    points[333, 1] = np.inf
    with pytest.raises(NonFiniteError, match="row 333 is not finite") as caught:
        liftmesh.tile(points, tmp_path, tile_rows=100)
    assert caught.value.row == 333


def test_files_that_are_refused(tmp_path: Path) -> None:
    with pytest.raises(
        FormatError, match=r"points.parquet: columns x and y are needed, not a, b, c"
    ):
        liftmesh.tile(parquet(tmp_path, ("a", "b", "c")), tmp_path / "out")
    with pytest.raises(FormatError, match=r"points.npy: .*points need the shape"):
        liftmesh.tile(npy(tmp_path, POINTS.reshape(-1)), tmp_path / "out")
    path = npy(tmp_path, POINTS)
    path.write_bytes(path.read_bytes()[:-1])
    with pytest.raises(FormatError, match="truncated, or its header is wrong"):
        liftmesh.tile(path, tmp_path / "out")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"tile_rows": 3}, "tile_rows"),
        ({"tile_rows": "many"}, "tile_rows"),
        ({"nonfinite": "drop"}, "nonfinite"),
        ({"resume": "yes"}, "resume"),
        ({"threads": 0}, "threads"),
        ({"progress": 3}, "progress"),
    ],
)
def test_options_that_are_refused(options: dict[str, object], message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        liftmesh.tile(POINTS, tmp_path / "out", **options)
    assert list(tmp_path.iterdir()) == []


def test_progress_grows_to_one(tmp_path: Path) -> None:
    shown: list[float] = []
    liftmesh.tile(POINTS, tmp_path, tile_rows=64, progress=shown.append)
    assert shown == sorted(shown)
    assert shown[-1] == 1.0
    assert len(shown) > 20


class Heard:
    """What is heard of a run, before its rows are counted and after."""

    def __init__(self) -> None:
        self.before: list[float] = []
        self.after: list[float] = []
        self.rows: int | None = None

    def begin(self, rows: int) -> None:
        self.rows = rows

    def __call__(self, share: float) -> None:
        (self.before if self.rows is None else self.after).append(share)


@pytest.mark.parametrize("surface", [False, True])
@pytest.mark.parametrize("kinds", [["xyz"], ["ply"], ["laz"], ["ply", "xyz"], []])
def test_copies_have_a_share_of_the_progress(
    kinds: list[str], surface: bool, tmp_path: Path
) -> None:
    """Files are read in blocks of up to a million bytes; a list is as good as a file."""
    heard, points = Heard(), np.random.default_rng(3).random((40_000, 3))
    source: object = iter(np.split(points, 5))
    if kinds:
        source = [tmp_path / f"points.{kind}" for kind in kinds]
        for path in source:
            liftmesh.write(path, liftmesh.Cloud(points))
    make = liftmesh.tile_surface if surface else liftmesh.tile
    found = make(source, tmp_path / "out", tile_rows=10_000, progress=heard)
    assert heard.rows == found.npoints
    assert heard.before == sorted(heard.before)
    assert heard.before[0] == 0
    assert 5 / 15 in heard.before
    assert len({*heard.before}) > 2
    assert 5 / 15 <= heard.after[0] < 7 / 15
    assert heard.after == sorted(heard.after)
    assert heard.after[-1] == 1


def test_what_is_read_in_place_takes_no_share_for_copies(tmp_path: Path) -> None:
    heard = Heard()
    liftmesh.tile(SOURCES["NPY"](tmp_path), tmp_path / "out", tile_rows=70, progress=heard)
    assert heard.before == []
    assert heard.after[0] == 0.01  # a tenth of the first reading


def test_of_what_does_not_say_how_long_it_is_the_end_is_heard(tmp_path: Path) -> None:
    heard = Heard()
    parts = (part for part in np.split(POINTS, 10))
    liftmesh.tile(parts, tmp_path, tile_rows=70, progress=heard)
    assert heard.before == [0, 5 / 15]


def test_folders_that_hold_no_triangles(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match=r"no finished triangulation is here: manifest.json is"):
        liftmesh.open_tiled(tmp_path)
    place = tmp_path / "manifest.json"
    for text in ("{", "[]", "{}", '{"kind": "liftmesh tiles", "version": 1}', "[" * 100_000):
        place.write_text(text)
        with pytest.raises(FormatError, match=r"manifest.json: "):
            liftmesh.open_tiled(tmp_path)


def test_a_shard_that_was_cut_off_is_named(tmp_path: Path) -> None:
    found = liftmesh.tile(POINTS, tmp_path, tile_rows=64)
    path = found.shards[1]
    path.write_bytes(path.read_bytes()[:-8])
    with pytest.raises(FormatError, match=rf"{path.name}: .* the file is damaged"):
        liftmesh.open_tiled(tmp_path)


@pytest.mark.slow
def test_memory_is_that_of_a_tile(tmp_path: Path) -> None:
    """400,000 rows take 6.4 MB to read, and 27 more to triangulate at once."""
    np.save(tmp_path / "points.npy", np.random.default_rng(2).random((400_000, 2)))
    program = """
    import sys, liftmesh
    liftmesh.tile([[0, 0], [1, 0], [0, 1]], sys.argv[2] + "/first")
    before = status("VmHWM")
    liftmesh.tile(sys.argv[1], sys.argv[2] + "/out", tile_rows=24_000, threads=1)
    print(status("VmHWM") - before)
    """
    assert int(output(program, tmp_path / "points.npy", tmp_path)) < 15_000_000
