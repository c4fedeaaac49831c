"""The script that times numbers as text."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import bench
import numpy as np
import pytest
from benchmark.tasks import text as bench_text

import liftmesh

ROWS = 300


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("text")
    bench_text.prepare(path, ROWS)
    return path


def test_all_files_hold_the_same_points(folder: Path) -> None:
    points = np.load(folder / "points.npy")
    assert points.shape == (ROWS, 3)
    for file in bench_text.FILES.values():
        assert np.array_equal(liftmesh.read(folder / file).points, points)


@pytest.mark.parametrize("call", bench_text.CALLS)
def test_every_call_reads_or_writes_them(call: str, folder: Path) -> None:
    assert min(bench_text.job(call, folder)) > 0


def test_other_values_are_noticed(folder: Path) -> None:
    (folder / "points.xyz").write_bytes((folder / "points.csv").read_bytes()[7:])
    with pytest.raises(SystemExit, match="read XYZ: other values"):
        bench_text.job("read XYZ", folder)


@pytest.mark.campaign
def test_the_table() -> None:
    words = ["--n", str(ROWS), "--rounds", "1", "--alone"]
    command = [sys.executable, bench.__file__, "text", *words]
    told = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert len(re.findall(r"(?:read|write) (?:CSV|XYZ|OBJ|PLY) .*\d\.\d{3}", told)) == 8
    best = {"polars read_csv": (0.1, 0.2), "read OBJ": (0.3, 0.5)}
    table = bench_text.table_of(best, {"CSV": 50, "OBJ": 100}, ROWS)
    assert [[*column.cells] for column in table.columns[-2:]] == [["", "1.50"], ["", "1.25"]]
