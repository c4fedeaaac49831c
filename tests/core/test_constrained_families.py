"""Constrained triangulations of thousands of rows: canonical, in any order, and beside CGAL's."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import constraints
import numpy as np
import pytest
from CGAL.CGAL_Kernel import Point_2
from CGAL.CGAL_Triangulation_2 import Constrained_Delaunay_triangulation_2
from clouds import FAMILIES as CLOUDS
from constrained.families import FAMILIES, Case
from meshes import assert_same_triangles, exact_triangles, triangle_rows
from oracles.constrained import judge
from oracles.planar import exact
from reference import SIGNIFICANT_DIGITS, read_triangles

from liftmesh import _kernel

TIED = [
    "lattice",
    "integer-circles",
    "collinear-runs",
    "duplicates",
    "small-integers",
    "huge-lattice",
]


def run(points: Any, edges: Any, threads: int = 1) -> tuple[Any, ...]:
    return _kernel.constrained(
        np.ascontiguousarray(points), np.array(edges, dtype=np.int32), False, threads, False, None
    )


def tied(name: str) -> Case:
    """Points with many ties, and long edges between them first."""
    rng = np.random.default_rng(31)
    points = CLOUDS[name](200, rng)
    edges = rng.integers(0, len(points), (120, 2), dtype=np.int32)
    return points, constraints.without_crossings(points, edges)


@pytest.fixture(scope="module", name="case", params=[*FAMILIES, *TIED])
def a_case(request: pytest.FixtureRequest) -> Case:
    name = request.param
    return tied(name) if name in TIED else FAMILIES[name](600, np.random.default_rng(29))


@pytest.mark.slow
def test_triangles_are_canonical(case: Case) -> None:
    points, edges = case
    outcome, marks, pieces, *_, crossings = run(points, edges)
    assert len(crossings) == 0
    positions = exact(points.tolist())
    judge(
        exact_triangles(points, outcome[3]),
        positions,
        [(positions[a], positions[b]) for a, b in pieces.tolist()],
    )
    bits = (marks[:, None] >> np.arange(3) & 1).astype(bool)
    ends = np.sort(np.stack([np.roll(outcome[3], -k, axis=1) for k in (1, 2)], axis=2), axis=2)
    inner = (outcome[4] >= 0)[bits]
    assert len(pieces) == np.count_nonzero(~inner) + np.count_nonzero(inner) / 2
    assert {*map(tuple, ends[bits].tolist())} == {*map(tuple, pieces.tolist())}


def test_the_order_of_rows_and_edges_changes_nothing(case: Case) -> None:
    points, edges = case
    expected = triangle_rows(points, run(points, edges)[0][3])
    rng = np.random.default_rng(37)
    for _ in range(3):
        order = rng.permutation(len(points))
        place = np.argsort(order)
        turned = rng.permuted(place[rng.permutation(edges)], axis=1)
        found = run(points[order], turned)
        assert_same_triangles(triangle_rows(points[order], found[0][3]), expected)


def test_any_number_of_threads_gives_the_same_bits() -> None:
    points, edges = FAMILIES["uniform"](40_000, np.random.default_rng(41))
    once, again = run(points, edges), run(points, edges, threads=3)
    for expected, found in zip((*once[0], *once[1:]), (*again[0], *again[1:]), strict=True):
        np.testing.assert_array_equal(expected, found)


@pytest.mark.slow
@pytest.mark.parametrize(
    "family", ["tiling", "uniform", "star", "nearly parallel", "strip", "zigzag"]
)
def test_same_triangles_as_cgal(family: str, tmp_path: Path) -> None:
    points, edges = FAMILIES[family](5000, np.random.default_rng(43))
    expected = Constrained_Delaunay_triangulation_2()
    handles = [expected.insert(Point_2(*point)) for point in points.tolist()]
    for a, b in edges.tolist():
        expected.insert_constraint(handles[a], handles[b])
    path = tmp_path / "cgal.txt"
    expected.write_to_file(str(path), SIGNIFICANT_DIGITS)
    actual = triangle_rows(points, run(points, edges)[0][3])
    assert_same_triangles(actual, read_triangles(path), family)
