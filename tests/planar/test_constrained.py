"""constrained_delaunay: edges, what is told of them, and copies."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

import liftmesh
from liftmesh import ConstrainedTriangulation, constrained_delaunay

SQUARE = [[0, 0], [3, 0], [3, 3], [0, 3]]
HOLE = [[1, 1], [2, 1], [2, 2], [1, 2]]
NAN = float("nan")


def sides(tri: ConstrainedTriangulation) -> set[tuple[int, ...]]:
    """Sides of triangles that are marked, by position."""
    ends = np.stack([tri.simplices[:, [1, 2, 0]], tri.simplices[:, [2, 0, 1]]], axis=2)
    return {tuple(each) for each in np.sort(ends[tri.is_constrained], axis=1).tolist()}


def test_edges_are_there_and_marked() -> None:
    points = [[0, 0], [4, -1], [8, 0], [4, 1]]
    assert [0, 2] not in liftmesh.delaunay(points).edges.tolist()
    tri = constrained_delaunay(points, [[2, 0]])
    assert tri.constraints.tolist() == [[0, 2]]
    assert sides(tri) == {(0, 2)}
    assert tri.regions.tolist() == [0, 1]
    assert repr(tri).endswith("0 skipped, 1 constraint>")
    assert isinstance(tri, liftmesh.Triangulation)


def test_without_constraints_it_is_the_triangulation_of_delaunay() -> None:
    points = np.random.default_rng(1).random((50, 2))
    tri = constrained_delaunay(points)
    plain = liftmesh.delaunay(points, order="canonical")
    again = constrained_delaunay(points, [], order="canonical")
    np.testing.assert_array_equal(again.simplices, plain.simplices)
    assert (len(tri.constraints), tri.is_constrained.any(), tri.regions.max()) == (0, False, 0)
    assert np.shares_memory(tri.points, points)


def test_pieces_tell_their_edges() -> None:
    points = [[0, 0], [1, 0], [2, 0], [3, 0], [1, 1], [1, 0]]
    tri = constrained_delaunay(points, [[0, 3], [2, 5], [1, 5], [3, 0], [5, 2]])
    assert tri.constraints.tolist() == [[0, 1], [1, 2], [2, 3]]
    assert [tri.inputs_of(k).tolist() for k in range(3)] == [[0, 3], [0, 1, 3, 4], [0, 3]]
    indptr, indices = tri.constraint_inputs
    assert (indptr.tolist(), len(indices)) == ([0, 2, 6, 8], 8)
    assert tri.zero_length.tolist() == [2]
    assert tri.repeated.tolist() == [[3, 0], [4, 1]]
    assert tri.inputs_of(-1).tolist() == [0, 3]
    with pytest.raises(IndexError):
        tri.inputs_of(3)


@pytest.mark.parametrize("dtype", [np.int8, np.uint64, np.int32])
def test_edges_of_any_integers(dtype: type) -> None:
    edges = np.array([[0, 2], [2, 1]], dtype=dtype)[:, ::-1]
    assert constrained_delaunay(SQUARE, edges).constraints.tolist() == [[0, 2], [1, 2]]


@pytest.mark.parametrize("points", [np.float32(SQUARE), np.array([[*p, 9.0] for p in SQUARE])])
def test_points_of_other_forms(points: Any) -> None:
    tri = constrained_delaunay(points, [[1, 3]])
    assert tri.constraints.tolist() == [[1, 3]]
    tri = constrained_delaunay(points, polylines=[[[0, 0], [1, 2]]])
    assert (tri.points[4].tolist(), tri.constraints.tolist()) == ([1, 2], [[0, 4]])


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 2**32 - 1))
def test_canonical_order_depends_on_the_sets_alone(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.integers(0, 6, (20, 2)).astype(float)
    edges = rng.integers(0, 20, (5, 2))
    try:
        one = constrained_delaunay(points, edges, order="canonical")
    except (liftmesh.CrossingError, liftmesh.DegenerateInputError):
        return
    rows, turn = rng.permutation(20), rng.permutation(5)
    moved = np.argsort(rows)[edges[turn]][:, ::-1]
    other = constrained_delaunay(points[rows], moved, order="canonical")
    np.testing.assert_array_equal(one.points[one.simplices], other.points[other.simplices])
    np.testing.assert_array_equal(one.neighbors, other.neighbors)
    np.testing.assert_array_equal(one.is_constrained, other.is_constrained)
    assert sides(one) == {tuple(each) for each in one.constraints.tolist()}


@pytest.mark.parametrize(
    ("edges", "said"),
    [
        ([[0, 1], [2, 4], [9, 9]], r"edge 1, \[2, 4\], \(and 1 other\) has the row 4.*leave it"),
        ([[1, -1]], "has the row -1, where 0 to 3 are possible: negative numbers do not count"),
        ([[1, 2], [3, 4]], "has the row 4.*count from 1, subtract 1"),
        ([[0.0, 1.0]], "edges hold float64 values .*whole numbers.*polylines="),
        ([[True, False]], "edges hold bool values"),
        ([[0, 1, 2]], r"the shape \(1, 3\), not \(k, 2\): give two rows for each edge"),
        (np.zeros((2, 7), int), r"the shape \(2, 7\).*give edges.T"),
        ([[0, 1], [2]], "cannot be converted to an array"),
        (np.ma.masked_equal([[0, 1]], 1), "edges hold masked values"),
        ("pairs.txt", r"edges are 'pairs.txt': give an array \(k, 2\) of rows"),
        ({1: 2}, "edges are {1: 2}: give an array"),
        (zip([0], [1], strict=True), "edges are <zip object .*>: give an array"),
    ],
)
def test_wrong_edges_are_named(edges: Any, said: str) -> None:
    with pytest.raises(liftmesh.InputError, match=said):
        constrained_delaunay(SQUARE, edges)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"crossing": "join"}, "crossing is 'join'"),
        ({"carve": "inside"}, "carve is 'inside': give one of 'outside', 'holes'"),
        ({"carve": None, "order": "any"}, "order is 'any'"),
        ({"nonfinite": "drop"}, "nonfinite is 'drop'"),
        ({"threads": 0}, "threads is 0"),
        ({"progress": 1}, "progress is 1"),
    ],
)
def test_wrong_options_are_named(options: dict[str, Any], said: str) -> None:
    with pytest.raises(liftmesh.InputError, match=said):
        constrained_delaunay(SQUARE, [[0, 2]], **options)


def test_points_on_one_line_and_columns() -> None:
    with pytest.raises(liftmesh.DegenerateInputError, match="on one line"):
        constrained_delaunay([[0, 0], [1, 1], [2, 2]], [[0, 1]], crossing="split")
    with pytest.raises(liftmesh.UnsupportedTypeError, match=r"np.column_stack"):
        constrained_delaunay([0.0, 1.0], [1.0, 2.0])


def test_a_cloud_gives_its_edges() -> None:
    rows = np.c_[SQUARE, np.zeros(4)].astype(float)
    cloud = liftmesh.Cloud(rows, edges=np.array([[1, 3]], np.int32))
    assert constrained_delaunay(cloud).constraints.tolist() == [[1, 3]]
    assert constrained_delaunay(cloud, [[0, 2]]).constraints.tolist() == [[0, 2]]
    assert constrained_delaunay(cloud, polylines=[0, 2]).constraints.tolist() == [[0, 2]]


def test_edges_of_skipped_rows_are_errors() -> None:
    points = [*SQUARE, [NAN, 1], [1, NAN]]
    with pytest.raises(liftmesh.NonFiniteError, match="row 4 is not finite"):
        constrained_delaunay(points, [[0, 1]])
    with pytest.raises(
        liftmesh.InputError, match=r"1 edge ends .*edge 1, \[4, 2\], at row 4 \(nan, 1.0\): leave"
    ):
        constrained_delaunay(points, [[0, 1], [4, 2]], nonfinite="skip")
    many = [[0, 4]] * 7 + [[5, 0]] * 8
    with pytest.raises(liftmesh.InputError, match=r"15 edges end .*and 5 more: leave"):
        constrained_delaunay(points, many, nonfinite="skip")
    tri = constrained_delaunay(points, [[0, 2]], nonfinite="skip")
    assert tri.skipped.tolist() == [4, 5]


def test_progress_and_threads() -> None:
    told: list[float] = []
    points = np.random.default_rng(2).random((3000, 2))
    edges = liftmesh.delaunay(points).edges[::5]
    one = constrained_delaunay(points, edges, threads=1, progress=told.append)
    many = constrained_delaunay(points, edges, threads=3)
    np.testing.assert_array_equal(one.simplices, many.simplices)
    assert told[-1] == 1.0


def carved() -> ConstrainedTriangulation:
    return constrained_delaunay(SQUARE, polygons=[[SQUARE, HOLE]], carve="holes")


def arrays(tri: ConstrainedTriangulation) -> list[np.ndarray[Any, Any]]:
    names = (
        "points", "simplices", "neighbors", "convex_hull", "duplicates", "skipped", "constraints",
        "input_edges", "input_polylines", "input_polygons", "zero_length", "added", "repeated",
        "crossing_rows", "is_constrained", "regions", "edges", "vertex_to_simplex",
    )  # fmt: skip
    return [*(getattr(tri, name) for name in names), *tri.constraint_inputs]


@pytest.mark.parametrize(
    "again", [lambda it: it, copy.copy, copy.deepcopy, lambda it: pickle.loads(pickle.dumps(it))]
)
def test_copies(again: Callable[[Any], Any]) -> None:
    tri = carved()
    tri.find_simplex([0.5, 0.5])
    twin = again(tri)
    for own, other in zip(arrays(tri), arrays(twin), strict=True):
        np.testing.assert_array_equal(own, other)
        with pytest.raises(ValueError, match="read-only"):
            other[...] = 0
    assert twin.find_simplex([[0.1, 0.1], [1.5, 1.5]]).tolist()[1] == -1
    assert twin.nsimplex == 8


@pytest.mark.parametrize(
    ("name", "place", "number"),
    [
        ("_whole", 0, 99), ("_whole", 1, 99), ("constraints", None, 99), ("input_edges", None, -1),
        ("constraint_inputs", 0, 9), ("constraint_inputs", 1, 99), ("simplices", None, 99),
        ("simplices", None, -1),
    ],
)  # fmt: skip
def test_damaged_pickles_are_refused(name: str, place: int | None, number: int) -> None:
    tri = carved()
    state = tri.__getstate__()
    value = state[name]
    if isinstance(value, int):
        state[name] = number
    else:
        wrong = (value if place is None else value[place]).copy()
        wrong.flat[-1] = number
        state[name] = (
            wrong
            if place is None
            else tuple(wrong if k == place else each for k, each in enumerate(value))
        )
    twin = object.__new__(ConstrainedTriangulation)
    with pytest.raises(liftmesh.InputError, match="the copy is damaged"):
        twin.__setstate__(state)


def test_what_a_lift_or_scipy_cannot_be() -> None:
    tri = constrained_delaunay(SQUARE, [[0, 2]])
    with pytest.raises(liftmesh.InputError, match="no lower hull"):
        tri.lifted()
    assert tri.equations.shape == (2, 4)
    assert tri.to_scipy().find_simplex([1, 0.5]) == tri.find_simplex([1, 0.5])
    with pytest.raises(liftmesh.InputError, match="regions were removed"):
        carved().to_scipy()
