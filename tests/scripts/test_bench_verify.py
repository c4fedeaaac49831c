"""The script that times `verify` beside the build."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import bench
import numpy as np
import pytest
from benchmark.tasks import verify as bench_verify

import liftmesh

POINTS = np.random.default_rng(8).random((2000, 2))


@pytest.mark.campaign
def test_both_are_timed_and_the_answer_is_told(tmp_path: Path) -> None:
    triangles = liftmesh.delaunay(POINTS).simplices
    judged = bench_verify.judge(POINTS, triangles, 2, 2, tmp_path)
    assert judged.answer == "canonical"
    assert judged.verify.seconds > 0 < judged.build.seconds
    assert bench_verify.judge(POINTS, triangles[1:], 1, 1, tmp_path).answer == "not valid"


def test_peers_triangles_are_listed_counter_clockwise() -> None:
    found = [*bench_verify.lists_of(POINTS, ["scipy", "matplotlib"])]
    assert [name for name, *_ in found] == ["liftmesh", "shuffled", "apart", "scipy", "matplotlib"]
    assert all(liftmesh.verify(*mesh) for _, *mesh in found)
    assert found[2][2].size == len(found[2][1]) == found[0][2].size


def test_flawed_lists_are_flawed() -> None:
    found = {name: liftmesh.verify(*mesh) for name, *mesh in bench_verify.flawed_lists(POINTS)}
    assert len(found) == 4
    assert not any(found.values())
    wrong = {
        name: sum(f.count for f in c.flaws if f.kind == "clockwise") for name, c in found.items()
    }
    assert wrong["one clockwise"] == 1
    assert wrong["all clockwise"] == 2 * wrong["half clockwise"] - wrong["all clockwise"] % 2
    assert wrong["all twice"] == 0


@pytest.mark.campaign
def test_a_table_is_printed() -> None:
    words = [
        "--n",
        "300",
        "--distributions",
        "circle",
        "--threads",
        "2",
        "--rounds",
        "1",
        "--flawed",
    ]
    done = subprocess.run(
        [sys.executable, bench.__file__, "verify", *words],
        capture_output=True,
        text=True,
        check=True,
    )
    assert "circle, 300 rows" in done.stdout
    assert done.stdout.count("canonical") == 3
    assert done.stdout.count("not valid") == 4
