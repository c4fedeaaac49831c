"""The script that times binary STL."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import bench
import numpy as np
import pytest
import trimesh
from benchmark.tasks import stl as bench_stl

import liftmesh


def test_both_programs_do_the_same_work(tmp_path: Path) -> None:
    cloud = bench_stl.terrain(300)
    calls = bench_stl.calls(cloud, tmp_path)
    read = calls["read liftmesh"]()
    assert isinstance(read, liftmesh.Cloud)
    assert read.faces is not None
    assert cloud.faces is not None
    assert np.array_equal(read.points[read.faces], cloud.points[cloud.faces])
    calls["write trimesh"](), calls["write liftmesh"]()
    ours, theirs = (trimesh.load(tmp_path / f"{each}.stl") for each in ("ours", "theirs"))
    assert np.array_equal(ours.triangles, theirs.triangles)


@pytest.mark.campaign
def test_the_table() -> None:
    command = [sys.executable, bench.__file__, "stl", "--n", "300", "--rounds", "1"]
    told = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert len(re.findall(r"(?:read|write) liftmesh .*\d\.\d{3} .*\d\.\d{2}", told)) == 2
    best = {"read trimesh": 1.0, "merge corners": 0.9, "read liftmesh": 1.0, "write trimesh": 2.0}
    table = bench_stl.table_of({**best, "write liftmesh": 3.0}, 300)
    assert [*table.columns[-1].cells] == ["", "", "0.50", "", "1.50"]
