"""Rows of tiles: what one call would see, named as the caller knows them, and no tile too large."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pytest

import liftmesh
from liftmesh.errors import FormatError, InputError, NonFiniteError
from liftmesh.tiles import build, node, publish, schedule, source_chunks, sources
from liftmesh.tiles.options import rows_within
from liftmesh.tiles.schema import Reading, planar_of
from liftmesh.tiles.source_chunks import Origin, SourceChunk

TIES = np.random.default_rng(4).integers(0, 30, (600, 2)).astype(np.float64)


def test_masked_rows_are_not_finite_as_in_one_call(tmp_path: Path) -> None:
    points = np.ma.array(TIES.copy())
    points[333, 0] = np.ma.masked
    for source in (points, iter([points])):
        with pytest.raises(NonFiniteError, match="row 333 is not finite"):
            liftmesh.tile(source, tmp_path, tile_rows=100)
    found = liftmesh.tile(points, tmp_path, tile_rows=100, nonfinite="skip")
    assert found.skipped.tolist() == [333]
    assert found.nsimplex == liftmesh.delaunay(points, nonfinite="skip").nsimplex


def parquet(path: Path, x: Any, y: Any) -> Path:
    pyarrow.parquet.write_table(pa.table({"x": x, "y": y}), path)
    return path


def test_columns_of_parquet_are_not_rounded(tmp_path: Path) -> None:
    large, ys = [2**53 + 1, 0, 5], [0.0, 1.0, 2.5]
    with pytest.raises(InputError, match=r"a.parquet: .*9007199254740993"):
        liftmesh.tile(parquet(tmp_path / "a.parquet", large, ys), tmp_path / "out")
    large.append(None)  # type: ignore[arg-type]
    place = parquet(tmp_path / "b.parquet", large, [*ys, 4.0])
    with pytest.raises(InputError, match=r"b.parquet: .*9007199254740993"):
        liftmesh.tile(place, tmp_path / "out", nonfinite="skip")
    place = parquet(tmp_path / "c.parquet", [2**53 + 2, 0, 5, None], [*ys, 4.0])
    found = liftmesh.tile(place, tmp_path / "out", nonfinite="skip")
    assert (found.nsimplex, found.skipped.tolist()) == (1, [3])


def planar_chunks(place: Path, rows: int, scratch: Path) -> list[SourceChunk]:
    reading = Reading(is_planar=True)
    return sources.file_chunks(Origin("a"), str(place), rows, scratch, reading)


def test_a_large_row_group_is_read_in_batches(tmp_path: Path, monkeypatch) -> None:
    """It is copied to the scratch folder in parts, and the triangles are the same."""
    monkeypatch.setattr(sources, "_GROUP", 100)
    x = [None if row == 450 else int(value) for row, value in enumerate(TIES[:, 0] * 8)]
    place = parquet(tmp_path / "a.parquet", x, TIES[:, 1])
    parts = planar_chunks(place, 100, tmp_path)
    assert [part.rows for part in parts] == [100] * 6
    assert [part.origin.row for part in parts] == [*range(0, 600, 100)]
    found = liftmesh.tile(place, tmp_path / "out", tile_rows=100, nonfinite="skip")
    assert found.skipped.tolist() == [450]
    assert found.verify().canonical
    large = parquet(tmp_path / "b.parquet", [*range(299), 2**53 + 1], [0.5] * 300)
    with pytest.raises(InputError, match=r"b.parquet: .*9007199254740993"):
        liftmesh.tile(large, tmp_path / "b", tile_rows=100)


def test_rows_in_groups_of_one_are_put_together_one_by_one(tmp_path: Path) -> None:
    table = pa.table({"x": TIES[:, 0], "y": TIES[:, 1]})
    pyarrow.parquet.write_table(table, tmp_path / "a.parquet", row_group_size=1)
    parts = planar_chunks(tmp_path / "a.parquet", 250, tmp_path)
    assert [part.rows for part in parts] == [250, 250, 100]
    assert np.array_equal(np.concatenate([planar_of(part.records()) for part in parts]), TIES)
    sizes = Counted(1 for _ in range(5000))
    assert len([*source_chunks._grouped(sizes, 5000)]) == 1
    assert sizes.looks == 0  # each size comes once, and none is looked up again


class Counted(list[int]):
    """Sizes, of which it is counted how often one is looked up."""

    looks = 0

    def __getitem__(self, key: Any) -> Any:
        self.looks += 1
        return super().__getitem__(key)


def test_a_folder_of_parquet_is_read_in_the_order_of_its_parts(tmp_path: Path) -> None:
    folder = tmp_path / "points.parquet"
    folder.mkdir()
    for number, rows in enumerate(np.split(TIES, 12)):
        parquet(folder / f"part.{number}.parquet", rows[:, 0], rows[:, 1])
    found = liftmesh.tile(folder, tmp_path / "out", tile_rows=100)
    place = {"file": "part.10.parquet", "path": "../points.parquet/part.10.parquet"}
    assert found.manifest["source"][10] == {**place, "first": 500, "rows": 50}
    assert np.array_equal(found.duplicates, liftmesh.delaunay(TIES).duplicates)


def test_two_files_of_one_name_and_text_are_named_as_they_are(tmp_path: Path) -> None:
    for folder, rows in (("a", TIES[:300]), ("b", TIES[300:])):
        (tmp_path / folder).mkdir()
        np.save(tmp_path / folder / "cloud.npy", rows)
    np.savetxt(tmp_path / "c.xyz", np.column_stack((TIES, TIES))[:, :3] + 50)
    paths = [tmp_path / "a" / "cloud.npy", tmp_path / "b" / "cloud.npy", tmp_path / "c.xyz"]
    found = liftmesh.tile(paths, tmp_path / "out", tile_rows=100)
    assert found.manifest["source"] == [
        {"file": "cloud.npy", "path": "../a/cloud.npy", "first": 0, "rows": 300},
        {"file": "cloud.npy", "path": "../b/cloud.npy", "first": 300, "rows": 300},
        {"file": "c.xyz", "path": "../c.xyz", "first": 600, "rows": 600},
    ]


def test_rows_are_named_by_their_file_and_their_number_there(tmp_path: Path) -> None:
    bad = TIES.copy()
    bad[7, 1] = np.inf
    np.save(tmp_path / "a.npy", TIES)
    np.save(tmp_path / "b.npy", bad)
    with pytest.raises(NonFiniteError, match=r"b.npy, its row 7: row 607 is not finite") as caught:
        liftmesh.tile([tmp_path / "a.npy", tmp_path / "b.npy"], tmp_path / "out", tile_rows=100)
    assert caught.value.row == 607


def test_a_large_file_among_many_small_ones(tmp_path: Path) -> None:
    rng = np.random.default_rng(6)
    chunks = [rng.random((100, 2)) + 3 for _ in range(40)]
    paths = []
    for number, rows in enumerate([*chunks, rng.random((40_000, 2))]):
        paths.append(tmp_path / f"{number}.npy")
        np.save(paths[-1], rows)
    sizes: list[int] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(schedule, "merge", counted(sizes))
        liftmesh.tile(paths, tmp_path / "out", tile_rows=4_000)
    assert max(sizes) < 5_000


def counted(sizes: list[int]) -> Any:
    """Merge as ever, and tell how many points were merged."""

    def merge(part: node.Frontier, *arguments: Any, **options: Any) -> node.Merged:
        sizes.append(len(part))
        return node.merge(part, *arguments, **options)

    return merge


def test_survey_lines_are_merged_level_by_level(tmp_path: Path) -> None:
    """Points a metre apart on lines that are 200 metres apart: most rows of a tile go up."""
    rng = np.random.default_rng(1)
    along, lines = np.meshgrid(np.arange(2_000.0), np.arange(10) * 200.0)
    points = np.column_stack((along.ravel(), lines.ravel())) + rng.normal(0, 0.3, (20_000, 2))
    sizes: list[int] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(schedule, "merge", counted(sizes))
        found = liftmesh.tile(points, tmp_path, tile_rows=500)
    assert found.nsimplex == liftmesh.delaunay(points).nsimplex
    assert max(sizes) < 3_500


def test_too_many_points_for_one_merge(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(node, "MOST_ROWS", 500)
    angles = np.linspace(0, 6, 600)
    circle = np.column_stack((np.cos(angles), np.sin(angles)))
    with pytest.raises(InputError, match="600 points come together in one merge, more than 500"):
        liftmesh.tile(circle, tmp_path, tile_rows=100)


def test_memory_that_holds_no_tile_is_refused() -> None:
    assert rows_within(1_000_000_000, threads=5) == 500_000
    for memory, threads in ((50_000_000, 1), (200_000_000, 4)):
        with pytest.raises(InputError, match="do not hold a process with a tile for each"):
            rows_within(memory, threads)


def test_what_waits_for_a_merge_is_named(tmp_path: Path) -> None:
    """No level is passed twice in a row, whatever goes up."""
    angles = np.linspace(0, 6, 3_000)
    points = np.column_stack((np.cos(angles), np.sin(angles)))
    passed: dict[int, int] = {}

    class Watched(schedule.Serial):
        def tree(self, *arguments: Any) -> list[schedule.Done]:
            done = super().tree(*arguments)
            passed.update({each.name: len(each.frontier) for each in done})
            return done

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("liftmesh.tiles.build.Serial", Watched)
        liftmesh.tile(points, tmp_path, tile_rows=200)
    assert max(passed.values()) == 2


def test_tiles_that_are_too_large_are_cut_again(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """A sample of a point for each tile says little about clusters of very different sizes."""
    rng = np.random.default_rng(3)
    centers = rng.random((40, 2)) ** 4
    points = centers[rng.integers(0, 40, 20_000)] + rng.normal(0, 1e-3, (20_000, 2))
    monkeypatch.setattr(build, "_SAMPLED", 1)
    sizes: list[int] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(schedule, "merge", counted(sizes))
        found = liftmesh.tile(points, tmp_path, tile_rows=1_000)
    assert max(sizes) <= 2_000
    assert found.verify(points).canonical


def test_points_of_lidar_are_those_that_are_read(tmp_path: Path) -> None:
    points = np.random.default_rng(3).integers(0, 400_000, (3_000, 3)) / 100 + 500_000.25
    liftmesh.write(tmp_path / "a.las", liftmesh.Cloud(points))
    liftmesh.write(tmp_path / "b.laz", liftmesh.Cloud(points[::-1] + 0.5))
    paths = [tmp_path / "a.las", tmp_path / "b.laz"]
    (tmp_path / "scratch").mkdir()
    spooled: list[str] = []
    found = liftmesh.tile(
        paths,
        tmp_path / "out",
        tile_rows=1_000,
        scratch=tmp_path / "scratch",
        progress=lambda _: spooled.extend(p.name for p in tmp_path.glob("scratch/*/points-*.npy")),
    )
    whole = np.concatenate([liftmesh.read(path).points for path in paths])
    assert found.verify(whole).canonical
    assert found.verify().canonical
    assert {name[:-4] for name in spooled} == {f"points-00001-{i:05d}" for i in range(3)}
    (tmp_path / "a.las").write_bytes((tmp_path / "a.las").read_bytes()[:-9])
    with pytest.raises(FormatError, match=r"a.las: "):
        found.verify()


@pytest.mark.slow
def test_one_position_repeated_very_often_takes_no_room(tmp_path: Path) -> None:
    rng = np.random.default_rng(9)
    often = np.repeat([[0.5, 0.5], [0.0, 0.25], [-0.0, 0.75], [0.125, 0.0]], 12_000, axis=0)
    points = rng.permutation(np.concatenate((often, rng.random((3_000, 2)), -often[::2])))
    points[rng.integers(0, len(points), 50)] = np.nan
    points[[7, 8]] = 0.5
    sizes: list[int] = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(schedule, "merge", counted(sizes))
        found = liftmesh.tile(points, tmp_path, tile_rows=4_000, nonfinite="skip")
    expected = liftmesh.delaunay(points, nonfinite="skip")
    assert max(sizes) < 4_500
    assert np.array_equal(found.duplicates, expected.duplicates)
    assert np.array_equal(found.skipped, expected.skipped)
    assert found.nsimplex == expected.nsimplex
    assert found.verify(points).canonical
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(publish, "_STRETCH", 500)
        assert liftmesh.tile(points, tmp_path / "b", tile_rows=4_000, nonfinite="skip").verify(
            points
        )
