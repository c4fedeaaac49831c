"""The script that times the job from file to file."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import bench
import numpy as np
import pytest
from benchmark.tasks import pipeline as bench_pipeline

import liftmesh

ROWS = 300


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("pipeline") / "cloud.ply"
    bench_pipeline.write_cloud(path, ROWS)
    return path


@pytest.mark.campaign
@pytest.mark.parametrize("name", bench_pipeline.JOBS)
def test_every_program_does_the_whole_job(name: str, source: Path, tmp_path: Path) -> None:
    if name == bench_pipeline.LEAST:  # it writes the bytes of a mesh that is there
        bench_pipeline.stages_of(bench_pipeline.OURS, source, tmp_path / "mesh.ply")
    stages = bench_pipeline.stages_of(name, source, tmp_path / "mesh.ply")
    assert [stage.name for stage in stages] == ["import", "read", "triangulate", "write"]
    assert all(0 < stage.held <= stage.peak for stage in stages)
    assert all(stage.seconds > 0 and stage.cpu >= 0 for stage in stages)
    cloud, mesh = liftmesh.read(source), liftmesh.read(tmp_path / "mesh.ply")
    expected = liftmesh.triangulate(cloud).faces
    assert mesh.faces is not None
    assert {frozenset(face) for face in mesh.faces.tolist()} == {
        frozenset(face) for face in expected.tolist()
    }
    assert mesh.colors is not None
    np.testing.assert_array_equal(mesh.colors[:, :3], cloud.colors)
    np.testing.assert_allclose(mesh.points, cloud.points, atol=1e-4)  # trimesh writes floats


def test_the_cloud_is_the_same_in_every_run(source: Path, tmp_path: Path) -> None:
    bench_pipeline.write_cloud(tmp_path / "again.ply", ROWS)
    assert (tmp_path / "again.ply").read_bytes() == source.read_bytes()


@pytest.mark.campaign
def test_the_command_prints_each_stage() -> None:
    command = [sys.executable, bench.__file__, "pipeline", "--n", "1000"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "liftmesh: 1,000 rows" in done.stdout
    for stage in ("import", "read", "triangulate", "write", "whole"):
        assert re.search(rf"{stage}(\W+\d+\.\d{{3}}){{2}}\W+\d+", done.stdout), stage
    assert re.search(r"without imports, in times of bytes and the kernel: .* \d", done.stdout)
    assert re.search(r"the whole command: processors' time \d", done.stdout)
