"""The script that times the way from LAZ to a mesh of the ground."""

from __future__ import annotations

from pathlib import Path

import bench_lidar
import numpy as np

import liftmesh
from liftmesh.io.las.records import Points


def test_the_steps_of_a_small_file(tmp_path: Path) -> None:
    path = tmp_path / "made.laz"
    bench_lidar.make(path, 2000)
    assert bench_lidar.decode(str(path)).keys() == {"seconds", "cpu"}
    before = Points.blocks
    found = bench_lidar.mesh(str(path))
    assert Points.blocks is before
    ground = liftmesh.read(path, classes=2)
    assert found["rows"] == len(ground)
    assert abs(len(ground) / 2000 - bench_lidar.GROUND) < 0.05
    assert found["arrays"] > ground.points.nbytes
    steps = ("selection", "triangulate", "write")
    assert np.isclose(found["own"], sum(found[each] for each in steps))
    assert np.array_equal(liftmesh.read(f"{path}.ply").points, ground.points)
