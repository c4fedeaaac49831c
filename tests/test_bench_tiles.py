"""The script that compares tiles with one call, and with tiles that have buffers."""

from __future__ import annotations

from pathlib import Path

import bench_tiles
import numpy as np

POINTS = np.random.default_rng(3).normal(size=(4_000, 2))


def test_tiles_are_equal_and_need_less_memory(tmp_path: Path) -> None:
    np.save(tmp_path / "points.npy", POINTS)
    one, tiled = (bench_tiles.run(way, tmp_path, 500) for way in ("one call", "tile"))
    assert one.mark == tiled.mark
    assert one.triangles == tiled.triangles > 7_000
    assert one.moved == 0 < tiled.moved
    assert min(one.processors, tiled.processors, one.clock, tiled.clock) > 0
    assert bench_tiles.cells(tiled, 4_000)[3] == f"{tiled.moved / 4_000:.2f}"


def test_the_mark_tells_sets_apart() -> None:
    triangles = np.arange(300).reshape(100, 3)
    mark = bench_tiles.mark_of(triangles)
    assert np.array_equal(mark, bench_tiles.mark_of(triangles[::-1].copy()))
    triangles[7, 2] = 5
    assert not (mark == bench_tiles.mark_of(triangles)).any()


def test_buffers_leave_seams() -> None:
    missing = []
    exact = {*map(tuple, bench_tiles.turned_rows(POINTS, np.arange(4_000)).tolist())}
    for margin in (0.5, 8):
        union = bench_tiles.with_margin(POINTS, 400, margin)
        missing.append(len(exact - union))
    assert missing[0] > missing[1] > 0
    table = bench_tiles.table_of_margins(POINTS[:1_000], 100)
    assert table.row_count == len(bench_tiles.MARGINS)
