"""Triangulations of two versions are compared as sets, and a difference is noticed."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from versions.worker import in_order, triangulated

import liftmesh

SCRIPTS = Path(__file__).resolve().parents[2] / "scripts"


def test_the_order_of_rows_and_corners_does_not_matter() -> None:
    rng = np.random.default_rng(5)
    found = liftmesh.delaunay(rng.random((200, 2)))
    order = rng.permutation(found.nsimplex)
    turn = (rng.integers(0, 3, found.nsimplex)[:, None] + np.arange(3)) % 3
    simplices = np.take_along_axis(found.simplices[order], turn, axis=1)
    name = np.append(np.argsort(order), -1)
    neighbors = np.take_along_axis(name[found.neighbors[order]], turn, axis=1)
    _, *expected = in_order(found.simplices, found.neighbors)
    _, *actual = in_order(simplices, neighbors)
    for one, other in zip(expected, actual, strict=True):
        np.testing.assert_array_equal(one, other)
    neighbors[0, 0] = neighbors[0, 1]
    assert not np.array_equal(in_order(simplices, neighbors)[2], expected[1])


def test_sets_that_follow_one_another_are_kept_apart() -> None:
    square = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1], [0, 0]])
    line = np.array([[0.0, 0], [1, 1], [2, 2]])
    points = np.concatenate([square, line, square])
    found = triangulated(points, np.array([0, 5, 8, 13]), threads=1)
    assert found["set_of_triangle"].tolist() == [0, 0, 2, 2]
    assert found["simplices"].tolist() == [[0, 1, 3], [1, 2, 3], [8, 9, 11], [9, 10, 11]]
    assert found["neighbors"].tolist() == [[1, -1, -1], [-1, 0, -1], [3, -1, -1], [-1, 2, -1]]
    assert found["duplicates"].tolist() == [[4, 0], [12, 8]]
    assert found["errors"].tolist() == ["", "all 3 distinct points lie on one line", ""]


@pytest.mark.slow
def test_a_version_is_as_itself() -> None:
    command = [sys.executable, "versions", sys.executable, "--sets", "120", "--rows", "300"]
    done = subprocess.run(command, cwd=SCRIPTS, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "120 small sets and 51 runs of 300 rows: equal" in done.stdout
