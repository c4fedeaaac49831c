"""Graphs of near points, against their definitions in rationals, by all points of all pairs."""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import combinations, pairwise

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from scipy.sparse.csgraph import minimum_spanning_tree

import liftmesh

Points = NDArray[np.float64]
Pairs = set[tuple[int, int]]
KINDS = ("minimum_spanning_tree", "relative_neighborhood", "gabriel", "delaunay")
SMALL = st.integers(0, 6).map(float)
ULPS = st.integers(-2, 2).map(lambda steps: 1 + steps * 2.0**-52)
WIDE = st.tuples(st.integers(-3, 3), st.sampled_from([-1074, -600, 0, 500, 1000])).map(
    lambda given: math.ldexp(*given)
)
SCALES = st.sampled_from([1.0, 0.1, 2.0**-1074, 2.0**-540, 2.0**1000])


def clouds(
    axis: st.SearchStrategy[float], scales: st.SearchStrategy[float] = SCALES
) -> st.SearchStrategy[Points]:
    rows = st.lists(st.tuples(axis, axis), min_size=3, max_size=12)
    return st.builds(lambda points, scale: np.array(points) * scale, rows, scales)


def by_definition(points: Points) -> dict[str, Pairs]:
    """Find the edges of each graph of distinct points."""
    p = [tuple(map(Fraction, row)) for row in points.tolist()]
    d = [[(a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 for b in p] for a in p]
    nearest = [min(d[i][:i] + d[i][i + 1 :]) for i in range(len(p))]
    found: dict[str, Pairs] = {kind: set() for kind in ("sphere_of_influence", *KINDS[:3])}
    parts = {i: {i} for i in range(len(p))}
    for i, j in sorted(combinations(range(len(p)), 2), key=lambda e: shortest_first(p, d, *e)):
        others = [(d[i][k], d[j][k]) for k in range(len(p)) if k not in (i, j)]
        if all(sum(pair) > d[i][j] for pair in others):
            found["gabriel"].add((i, j))
        if all(max(pair) >= d[i][j] for pair in others):
            found["relative_neighborhood"].add((i, j))
        rest = d[i][j] - nearest[i] - nearest[j]
        if rest < 0 or rest**2 < 4 * nearest[i] * nearest[j]:
            found["sphere_of_influence"].add((i, j))
        if j not in parts[i]:
            found["minimum_spanning_tree"].add((i, j))
            parts[i] |= parts[j]
            parts.update(dict.fromkeys(parts[i], parts[i]))
    return found


def shortest_first(p: list, d: list, i: int, j: int) -> tuple[object, ...]:  # type: ignore[type-arg]
    return d[i][j], *sorted([p[i], p[j]])


def edges_of(found: liftmesh.Triangulation, kind: str) -> Pairs:
    matrix = found.graph(kind)  # type: ignore[arg-type]
    matrix.check_format()
    assert matrix.has_canonical_format
    assert (matrix != matrix.T).nnz == 0
    rows, columns = matrix.nonzero()
    return {(i, j) for i, j in zip(rows.tolist(), columns.tolist(), strict=True) if i < j}


def check(points: Points) -> None:
    points = np.unique(points, axis=0)
    try:
        found = liftmesh.delaunay(points[::-1])
    except liftmesh.DegenerateInputError:
        return
    last = len(points) - 1
    for kind, expected in by_definition(points).items():
        edges = {(last - j, last - i) for i, j in edges_of(found, kind)}
        assert edges == expected, kind


@pytest.mark.slow
@given(clouds(SMALL))
@settings(max_examples=240)
def test_on_a_lattice(points: Points) -> None:
    check(points)


@given(clouds(ULPS))
@settings(max_examples=90)
def test_where_rounding_decides_otherwise(points: Points) -> None:
    check(points)


@pytest.mark.slow
@given(clouds(WIDE, st.just(1.0)))
@settings(max_examples=60)
def test_of_all_magnitudes_at_once(points: Points) -> None:
    check(points)


@pytest.mark.parametrize("exponent", [-1070, 0, 970])
def test_in_more_general_places(exponent: int) -> None:
    rng = np.random.default_rng(exponent + 1070)
    angle = rng.random(24) * 7
    for points in (
        rng.normal(size=(30, 2)),
        np.stack([np.cos(angle), np.sin(angle)], axis=1) * (1 + rng.random((24, 1)) * 1e-3),
        np.vstack([rng.random((12, 2)) * 2.0**-k for k in (0, 9)]),
    ):
        check(np.ldexp(points, exponent))


def test_each_graph_is_a_part_of_the_next() -> None:
    rng = np.random.default_rng(3)
    for points in (rng.random((3000, 2)), np.floor(rng.random((3000, 2)) * 50)):
        found = liftmesh.delaunay(points)
        for part, whole in pairwise(edges_of(found, kind) for kind in KINDS):
            assert part < whole
        assert len(edges_of(found, KINDS[0])) == len(points) - len(found.duplicates) - 1


def test_the_tree_is_as_long_as_other_programs_find_it() -> None:
    points = np.random.default_rng(4).random((2000, 2))
    found = liftmesh.delaunay(points)
    length = found.graph("minimum_spanning_tree").sum() / 2
    assert math.isclose(minimum_spanning_tree(found.graph()).sum(), length, rel_tol=1e-12)
    whole = nx.from_scipy_sparse_array(found.graph())
    tree = nx.minimum_spanning_tree(whole)
    assert math.isclose(tree.size(weight="weight"), length, rel_tol=1e-12)


def test_order_and_threads_change_nothing() -> None:
    points = np.random.default_rng(5).integers(0, 40, (900, 2)).astype(float)
    points = np.unique(points, axis=0)
    order = np.random.default_rng(6).permutation(len(points))
    one = liftmesh.delaunay(points, threads=1)
    other = liftmesh.delaunay(points[order].astype(np.float32), threads=3)
    for kind in (*KINDS, "sphere_of_influence"):
        matrix = one.graph(kind)[order][:, order].toarray()  # type: ignore[arg-type]
        assert np.array_equal(matrix, other.graph(kind).toarray())  # type: ignore[arg-type]


@given(st.lists(st.tuples(st.integers(-9, 9), st.integers(-9, 9)), min_size=2, max_size=2), SCALES)
@settings(max_examples=90)
def test_lengths_are_rounded_once(ends: list[tuple[int, int]], scale: float) -> None:
    a, b = (np.array(end) * scale for end in ends)
    points = np.array([a, b, [a[0], b[1]], [b[0] + scale, a[1] - scale]])
    try:
        matrix = liftmesh.delaunay(points).graph()
    except liftmesh.DegenerateInputError:
        return
    for i, j, length in zip(*matrix.nonzero(), matrix.data.tolist(), strict=True):
        square = sum((Fraction(u) - Fraction(v)) ** 2 for u, v in zip(*points[[i, j]], strict=True))
        below, above = (Fraction(math.nextafter(length, end)) for end in (0, math.inf))
        assert (below + Fraction(length)) ** 2 <= 4 * square <= (above + Fraction(length)) ** 2


def test_lengths_beyond_all_doubles() -> None:
    big = np.finfo(np.float64).max
    matrix = liftmesh.delaunay([[-big, 0], [big, 0], [0, big]]).graph()
    assert matrix[0, 1] == math.inf
    assert matrix[0, 2] == math.inf  # by the root of 2


SEVERAL = np.array([[0.0, 0], [3, 0], [0, 4], [3, 0], [9, 9], [3, 0], [0, 0], [math.nan, 1]])


def test_rows_at_one_position() -> None:
    found = liftmesh.delaunay(SEVERAL, nonfinite="skip")
    first = found.graph()
    assert first.shape == (8, 8)
    assert np.diff(first.indptr).tolist() == [2, 3, 3, 0, 2, 0, 0, 0]
    every = found.graph(coincident="clique")
    assert every.has_canonical_format
    place = np.array([0, 1, 2, 1, 4, 1, 0, 7])
    stored = np.zeros((8, 8), dtype=np.bool_)
    stored[every.nonzero()] = True
    full = every.toarray()
    is_entry = every.copy()
    is_entry.data[:] = 1
    same = (place[:, None] == place) & ~np.eye(8, dtype=np.bool_)
    assert np.array_equal(full, first.toarray()[place][:, place])
    assert np.array_equal(is_entry.toarray() == 1, (full > 0) | same)


def test_weights() -> None:
    found = liftmesh.delaunay(SEVERAL[:5])
    lengths = found.graph()
    assert set(found.graph(weights="binary").data) == {1.0}
    inverse = found.graph(weights=lambda length: 1 / length)
    assert np.array_equal(inverse.data, 1 / lengths.data)
    with pytest.raises(liftmesh.InputError, match=r"weights returns the shape \(\): return a numb"):
        found.graph(weights=lambda _: 1.0)
    with pytest.raises(liftmesh.InputError, match=r"weights returns .*: return numbers"):
        found.graph(weights=lambda length: length.astype(str))


def test_refusals() -> None:
    found = liftmesh.delaunay(SEVERAL[:5])
    for option in ("kind", "weights", "coincident"):
        with pytest.raises(liftmesh.InputError, match=f"{option} is 'near': give one of '"):
            found.graph(**{option: "near"})
    square = [[0, 0], [1, 0], [1, 1], [0, 1]]
    for other in (
        liftmesh.delaunay(square, metric=[[1, 0], [0, 2]]),
        liftmesh.regular(square, weights=[0, 1, 0, 1]),
        liftmesh.constrained_delaunay(square, [[0, 2]]),
    ):
        assert other.graph().nnz == 10
        with pytest.raises(liftmesh.InputError, match="graphs of near rows need triangles with em"):
            other.graph("gabriel")
