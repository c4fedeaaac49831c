"""The script that times the way from LAZ to a mesh of the ground."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from benchmark.tasks import lidar as bench_lidar

import liftmesh
from liftmesh.io.formats.las.reader import Points


def test_the_steps_of_a_small_file(tmp_path: Path) -> None:
    path = tmp_path / "made.laz"
    bench_lidar.make(path, 2000)
    assert bench_lidar.run_twice("decode", str(path)).keys() == {"seconds", "cpu"}
    before = Points.blocks
    found = bench_lidar.run_twice("mesh", str(path))
    assert Points.blocks is before
    steps = ("selection", "triangulate", "write")
    assert np.isclose(found["own"], sum(found[each] for each in steps))
    assert found["first"] > 0
    ground = liftmesh.read(path, classes=2)
    assert abs(len(ground) / 2000 - bench_lidar.GROUND) < 0.05
    assert np.array_equal(liftmesh.read(f"{path}.ply").points, ground.points)
    memory = bench_lidar.run_twice("memory", str(path))
    faces = liftmesh.read(f"{path}.ply").faces
    values = sum(each.nbytes for each in ground.attributes.values())
    assert memory["rows"] == len(ground)
    assert memory["arrays"] == ground.points.nbytes + values + 2 * faces.nbytes
