"""The script that times the location of points."""

from __future__ import annotations

import subprocess
import sys

import bench
import numpy as np
import pytest
from benchmark.tasks import locate as bench_locate

import liftmesh

POINTS = np.random.default_rng(3).random((400, 2))


def test_all_programs_find_the_same_triangles() -> None:
    triangulation = liftmesh.delaunay(POINTS)
    asked = bench_locate.queries(POINTS, "box")
    expected = triangulation.find_simplex(asked)
    assert (expected >= 0).sum() > 300
    for peer in bench_locate.PEERS.values():
        assert np.array_equal(peer(triangulation)(asked), expected)


def test_points_are_made_inside_and_put_in_order() -> None:
    inside = bench_locate.queries(POINTS, "triangles")
    assert (liftmesh.delaunay(POINTS).find_simplex(inside) >= 0).all()
    curve = bench_locate.ordered(inside, "along a curve")
    assert np.array_equal(np.sort(curve, axis=0), np.sort(inside, axis=0))
    steps, jumps = (np.hypot(*np.diff(each, axis=0).T).mean() for each in (curve, inside))
    assert steps < 0.2 * jumps
    assert bench_locate.ordered(inside, "random") is inside


def test_what_is_timed() -> None:
    found = bench_locate.time(sys.executable, "scipy", POINTS, POINTS[:50], 2)
    assert found.points == 50
    assert min(found.build, found.first, found.again) > 0
    taken = bench_locate.Taken(build=0.5, first=2.0, again=1.0, points=4)
    assert bench_locate.cells(taken, 8) == ["500000.000", "250000.000", "4.00"]


@pytest.mark.campaign
def test_a_table_is_printed() -> None:
    words = ["--n", "300", "--distributions", "circle", "--rounds", "1", "--before", sys.executable]
    done = subprocess.run(
        [sys.executable, bench.__file__, "locate", *words],
        capture_output=True,
        text=True,
        check=True,
    )
    assert "circle, 300 rows" in done.stdout
    assert done.stdout.count("liftmesh before") == done.stdout.count("scipy") == 2
