"""The script that compares simplification with pydelatin."""

from __future__ import annotations

import subprocess
import sys

import bench
import numpy as np
import pytest
from benchmark.tasks import simplify as bench_simplify

import liftmesh


def test_both_keep_the_same_bound_on_the_same_raster() -> None:
    heights = bench_simplify.fractal(65)
    assert (heights.shape, heights.min()) == ((65, 65), 0)
    assert heights.max() == pytest.approx(bench_simplify.RELIEF)
    found = bench_simplify.compared(heights, 30.0, 1)
    counts = {way: count for way, (_, count) in found.items()}
    assert 50 < counts["pydelatin"] < 65 * 65
    assert 0.9 < counts["greedy"] / counts["pydelatin"] < 1.1
    assert counts["all"] == counts["call"] < counts["greedy"]
    row = bench_simplify.cells(dict.fromkeys(found, (0.5, 100)))
    assert row == ["100", "0.500", "1.00", "1.00", "1.00", "1.000", "1.000"]


def test_a_raster_is_found_in_points() -> None:
    heights = np.arange(12.0).reshape(3, 4)
    points = bench_simplify.points_of(heights)
    shuffled = np.random.default_rng(0).permutation(points)
    np.testing.assert_array_equal(bench_simplify.raster(shuffled), heights)
    with pytest.raises(SystemExit, match="no full raster of 3 x 4"):
        bench_simplify.raster(points[1:])


def test_a_table_is_printed(tmp_path: object) -> None:
    path = f"{tmp_path}/bowl.npz"
    x, y = np.meshgrid(np.arange(30.0), np.arange(20.0))
    liftmesh.write(path, liftmesh.Cloud(bench_simplify.points_of(0.05 * (x - 15) ** 2 + y)))
    words = [path, "--fractal", "33", "--max-errors", "1", "--rounds", "1"]
    done = subprocess.run(
        [sys.executable, bench.__file__, "simplify", *words],
        capture_output=True,
        text=True,
        check=True,
    )
    assert "20x30" in done.stdout
    assert "33x33" in done.stdout
