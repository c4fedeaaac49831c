"""Constrained triangulations of the kernel, held against their definition in exact integers."""

from __future__ import annotations

from typing import Any

import constraints
import numpy as np
import pytest
from clouds import FAMILIES
from hypothesis import given, settings, strategies as st
from oracles.constrained import Constrained, check
from strategies import clouds

from liftmesh import _kernel
from liftmesh._typing import Floats, Rows

NO_EDGES = np.empty((0, 2), dtype=np.int32)


def run(points: Any, edges: Any, threads: int = 1, skip: bool = False) -> tuple[Any, ...]:
    rows = np.array(points, dtype=np.float64).reshape(-1, 2)
    pairs = np.array(edges, dtype=np.int32).reshape(-1, 2)
    return _kernel.constrained(rows, pairs, skip, threads, False, None)


def checked(points: Any, edges: Any) -> Constrained:
    """Triangulate, and compare with the definition, which is returned."""
    rows = np.array(points, dtype=np.float64)
    pairs = np.array(edges, dtype=np.int32).reshape(-1, 2)
    return check(run(rows, pairs), rows, pairs)


SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4)]
GRID = [(x, y) for x in range(5) for y in range(5)]
STAR = [(0, 0), *((7, k) for k in range(-6, 7)), *((-5, k) for k in range(-4, 5)), (1, 9), (-1, -9)]
CASES = {
    "the other diagonal of a square": (SQUARE, [(0, 2)]),
    "the diagonal that is there": (SQUARE, [(3, 1)]),
    "the hull": (SQUARE, [(0, 1), (1, 2), (2, 3), (3, 0)]),
    "an edge along a hull with points on it": (GRID, [(0, 4), (24, 20)]),
    "an edge through points": ([*GRID, (0.5, 3.5)], [(0, 24)]),
    "a knight's move, and one backwards": (GRID, [(0, 7), (22, 15), (17, 4)]),
    "a long edge between points": ([*GRID, (-1, -2), (5, 6.5)], [(25, 26)]),
    "collinear overlaps": (GRID, [(0, 18), (6, 24), (12, 6), (0, 24)]),
    "the same edge again and backwards": (SQUARE, [(0, 2), (0, 2), (2, 0)]),
    "an edge without a length": (SQUARE, [(1, 1), (0, 2)]),
    "an edge between equal rows": ([*SQUARE, (4, 4), (4, 4)], [(2, 4), (5, 4), (0, 5)]),
    "edges to the second of equal rows": ([(0, 0), *SQUARE, (0, 4), (4, 0)], [(5, 6), (1, 2)]),
    "a star": (STAR, [(0, k) for k in range(1, len(STAR))]),
    "an edge that ends on another": ([*SQUARE, (2, 2), (3, 0.5)], [(0, 2), (4, 5), (1, 4)]),
    "a row on an edge, which is no end": ([*SQUARE, (1, 1), (3, 3)], [(2, 0)]),
    "edges that meet in a row inside of both": ([*SQUARE, (2, 2)], [(0, 2), (1, 3)]),
    "hanging edges in the cavity of a later one": (
        [(0, 0), (10, 0), (2, 3), (3, 1), (5, 3), (5, 1), (8, 3), (7, 1), (3, -3), (3, -1)],
        [(2, 3), (4, 5), (6, 7), (8, 9), (0, 1)],
    ),
    "a ring in a cavity": (
        [(0, 0), (10, 0), (4, 1), (6, 1), (5, 2), (5, 5), (5, -4)],
        [(2, 3), (3, 4), (4, 2), (0, 1)],
    ),
    "points on a line and one apart": ([*((k, 0) for k in range(6)), (2, 3)], [(0, 5), (3, 1)]),
}  # fmt: skip


@pytest.mark.parametrize(("points", "edges"), CASES.values(), ids=CASES)
def test_fixed_cases_are_the_definitions(points: Any, edges: Any) -> None:
    rng = np.random.default_rng(1)
    for _ in range(4):
        assert checked(points, edges).crossings == []
        edges = rng.permutation(rng.permutation(edges), axis=1)


@pytest.mark.parametrize("scale", [2.0**-1072, 2.0**-500, 1e-3, 1e300, 2.0**1019])
@pytest.mark.parametrize(("points", "edges"), CASES.values(), ids=CASES)
def test_fixed_cases_at_the_ends_of_the_exponents(points: Any, edges: Any, scale: float) -> None:
    checked(np.array(points) * (scale, 1.0), edges)
    checked(np.array(points) * scale, edges)


def test_what_pieces_tell() -> None:
    points = [(0, 0), (2, 2), (4, 4), (0, 4), (4, 0), (2, 2), (6, 6)]
    edges = [(6, 0), (5, 1), (2, 0), (3, 1), (5, 4), (2, 6), (0, 2)]
    _, _, pieces, starts, members, zero_length, unplaced, crossings = run(points, edges)
    assert pieces.tolist() == [[0, 1], [1, 2], [1, 3], [1, 4], [2, 6]]
    assert starts.tolist() == [0, 3, 6, 7, 8, 10]
    assert members.tolist() == [0, 2, 6, 0, 2, 6, 3, 4, 0, 5]
    assert zero_length.tolist() == [1]
    assert unplaced.tolist() == []
    assert crossings.tolist() == []


@pytest.mark.parametrize("family", ["uniform", "lattice", "duplicates", "mixed-lattices"])
@pytest.mark.parametrize("threads", [1, 3])
def test_without_edges_it_is_delaunay_bit_for_bit(family: str, threads: int) -> None:
    points = FAMILIES[family](4000, np.random.default_rng(2))
    plain = _kernel.delaunay(points, False, threads, False, None)
    outcome, marks, *others = run(points, NO_EDGES, threads)
    for expected, found in zip(plain, outcome, strict=True):
        np.testing.assert_array_equal(expected, found)
    assert not marks.any()
    assert len(marks) == len(plain[3])
    assert [len(each) for each in others] == [0, 1, 0, 0, 0, 0]


@pytest.mark.parametrize(
    "points", [[], [(0, 0)], [(0, 0), (1, 1)], [(0, 0), (1, 1), (3, 3), (1, 1)]]
)
def test_nothing_to_triangulate(points: Any) -> None:
    rows = np.array(points, dtype=np.float64).reshape(-1, 2)
    edges = NO_EDGES if len(rows) < 2 else np.array([[0, 1]], dtype=np.int32)
    outcome, *others = run(rows, edges)
    assert outcome[0] == _kernel.delaunay(rows, False, 1, False, None)[0] != "ok"
    assert sum(map(len, others)) <= 1


def test_skipped_rows() -> None:
    points = [*SQUARE, (np.nan, 0), (np.inf, 1)]
    assert run(points, [(0, 2)])[0][0] == "non-finite"
    outcome, marks, pieces, *_ = run(points, [(0, 2)], skip=True)
    assert outcome[7].tolist() == [4, 5]
    assert pieces.tolist() == [[0, 2]]
    assert marks.sum() > 0
    outcome, *_, unplaced, crossings = run(points, [(0, 2), (4, 1), (1, 3), (3, 5)], skip=True)
    assert outcome[0] == "ok"
    assert unplaced.tolist() == [1, 3]
    assert len(crossings) == 0


@pytest.mark.parametrize("edges", [[(0, 4)], [(-1, 2)]])
def test_an_end_that_is_no_row_is_refused(edges: Any) -> None:
    with pytest.raises(ValueError, match="row"):
        run(SQUARE, edges)


def test_all_crossings_are_named_in_any_order() -> None:
    rng = np.random.default_rng(3)
    for number in range(40):
        points = np.vstack([rng.integers(0, 7, (12, 2)), rng.random((6, 2)) * 6])
        edges = rng.integers(0, len(points), (14, 2), dtype=np.int32)
        expected = checked(points, edges).crossings
        assert expected, number
        order = rng.permutation(len(edges))
        again = run(points, rng.permutation(edges[order], axis=1))[-1]
        assert {frozenset(pair) for pair in order[again].tolist()} == {*map(frozenset, expected)}


def test_a_grid_of_edges_crosses_everywhere() -> None:
    at = np.arange(40.0)
    ends = [(k, s) for k in at for s in (-1, 40.5)] + [
        (s, k + 0.25) for k in at for s in (-1, 40.5)
    ]
    edges = np.arange(160, dtype=np.int32).reshape(-1, 2)
    *_, crossings = run(ends, edges)
    assert crossings.tolist() == [[i, j] for i in range(40) for j in range(40, 80)]


@pytest.mark.parametrize("kind", constraints.SETS)
def test_random_sets_are_the_definitions(kind: str) -> None:
    rng = np.random.default_rng(4)
    for _ in range(15):
        constraints.holds(kind, rng)


@st.composite
def with_edges(draw: st.DrawFn, points: st.SearchStrategy[Floats]) -> tuple[Floats, Rows]:
    rows = draw(points)
    row = st.integers(0, len(rows) - 1)
    edges = draw(st.lists(st.tuples(row, row), max_size=10))
    return rows, np.array(edges, dtype=np.int32).reshape(-1, 2)


SMALL = st.integers(0, 4).map(float)
LATTICE = st.lists(st.tuples(SMALL, SMALL), min_size=3, max_size=12).map(np.array)


@pytest.mark.slow
@settings(max_examples=250)
@given(with_edges(LATTICE))
def test_any_edges_on_a_lattice(case: tuple[Floats, Rows]) -> None:
    points, edges = case
    checked(points, edges)
    checked(points, constraints.without_crossings(points, edges))


@pytest.mark.slow
@settings(max_examples=100)
@given(with_edges(clouds(12)))
def test_any_edges_between_any_points(case: tuple[Floats, Rows]) -> None:
    points, edges = case
    checked(points, edges)
    checked(points, constraints.without_crossings(points, edges))
