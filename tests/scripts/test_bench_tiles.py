"""The script that compares tiles with one call, and with tiles that have buffers."""

from __future__ import annotations

from pathlib import Path

import fuzz_tiles
import numpy as np
import pytest
import tiles_out_of_core
from benchmark.tasks import tiles as bench_tiles

import liftmesh

POINTS = np.random.default_rng(3).normal(size=(4_000, 2))


@pytest.mark.campaign
def test_tiles_are_equal_and_need_less_memory(tmp_path: Path) -> None:
    np.save(tmp_path / "points.npy", POINTS)
    one, tiled = (bench_tiles.taken(way, tmp_path, 500) for way in ("one call", "tile"))
    assert one.mark == tiled.mark
    assert one.triangles == tiled.triangles > 7_000
    assert one.moved == 0 < tiled.moved
    assert min(one.processors, tiled.processors, one.clock, tiled.clock) > 0
    assert bench_tiles.cells(tiled, 4_000)[6] == f"{tiled.moved / 4_000:.2f}"


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


def test_formats_and_the_proof_are_ways_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    here = lambda take, *words: vars(take(*words))  # noqa: E731 - not in processes of their own
    monkeypatch.setattr(bench_tiles, "in_process", here)
    np.save(tmp_path / "points.npy", POINTS)
    options = bench_tiles.parsed(["--formats", "--verify", "--tile-rows", "1500"])
    table = bench_tiles.table_of("normal", len(POINTS), tmp_path, options)
    told = dict(zip(("way", *bench_tiles.COLUMNS), (c._cells for c in table.columns), strict=True))
    ways = ["one call", "tile", "verify", "tile parquet", "tile ply", "tile neighbors", "verify"]
    assert told["way"] == ways
    assert told["triangles"] == ["", *["equal"] * 6]
    assert all(share.endswith("%") for share in told["leave tiles"])
    assert len([bench_tiles.parsed(words.split()) for words in bench_tiles.ALL]) > 4


def test_generated_points_have_one_hash_whatever_the_tiles(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tiles_out_of_core, "_CHUNK", 3_000)
        one, other = (tiles_out_of_core.hashed(10_000, rows, str(tmp_path)) for rows in (900, 2500))
        chunks = [tiles_out_of_core.Generated(i, 3_000).points() for i in range(3)]
        points = np.concatenate((*chunks, tiles_out_of_core.Generated(3, 1_000).points()))
    assert one == other
    simplices = liftmesh.delaunay(points).simplices.astype(np.int64)
    mark = bench_tiles.mark_of(bench_tiles.turned(simplices, points))
    assert one == "".join(f"{each:016x}" for each in mark)
    assert "10,000 rows in 12 tiles" in capsys.readouterr().out
    assert list(tmp_path.iterdir()) == []


def test_families_in_any_order_and_tiling_are_compared_with_one_call(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    words = "--rows 120 --families circle --tiles 3 --verify --folder"
    options = fuzz_tiles.parsed([*words.split(), str(tmp_path)])
    fuzz_tiles.compare(options)
    assert capsys.readouterr().out == "circle: 120 rows, 4 cases are one call's\n"
    orders = [each(POINTS, np.random.default_rng(1)) for each in fuzz_tiles.ORDERS.values()]
    assert len({each.tobytes() for each in orders}) == len(orders)
    blocks = liftmesh.Tiled.iter_blocks
    monkeypatch.setattr(liftmesh.Tiled, "iter_blocks", lambda self: (b[1:] for b in blocks(self)))
    with pytest.raises(AssertionError, match="uniform, seed 0: made, 2 tiles, 0 workers"):
        fuzz_tiles.compare(fuzz_tiles.parsed(["--rows", "90", "--families", "uniform"]))
