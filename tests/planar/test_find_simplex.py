"""Point location: exact, vectorised, and on a border the smallest row."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.spatial
from clouds import FAMILIES
from hypothesis import given, settings, strategies as st
from meshes import hard_queries
from numpy.typing import NDArray
from oracles import planar as oracle

import liftmesh

SMALL = st.integers(0, 6).map(float)


def exact_location(
    triangulation: liftmesh.Triangulation, queries: NDArray[np.float64]
) -> list[int]:
    """Rows by trying every triangle in order, in integers."""
    n = len(triangulation.points)
    lattice = oracle.exact(np.vstack((triangulation.points, queries)).tolist())
    triangles = [tuple(lattice[i] for i in row) for row in triangulation.simplices.tolist()]
    return [oracle.locate(triangles, query) for query in lattice[n:]]


@pytest.mark.parametrize("bruteforce", [False, True])
@pytest.mark.parametrize("family", FAMILIES)
def test_location_is_exact_on_every_family(family: str, bruteforce: bool) -> None:
    rng = np.random.default_rng(43)
    triangulation = liftmesh.delaunay(FAMILIES[family](36, rng))
    queries = hard_queries(triangulation, rng)
    found = triangulation.find_simplex(queries, bruteforce=bruteforce)
    expected = exact_location(triangulation, queries)
    wrong = np.flatnonzero(found != expected)
    assert not len(wrong), (
        f"{len(wrong)} of {len(queries)}: {queries[wrong[0]]} is in row {expected[wrong[0]]}, "
        f"not {found[wrong[0]]}"
    )


@settings(max_examples=150)
@given(
    st.lists(st.tuples(SMALL, SMALL), min_size=3, max_size=20),
    st.lists(st.tuples(SMALL, SMALL), min_size=1, max_size=20),
)
def test_location_is_exact_among_coincidences(points, queries) -> None:
    try:
        triangulation = liftmesh.delaunay(points)
    except liftmesh.DegenerateInputError:
        return
    queries = np.array(queries)
    expected = exact_location(triangulation, queries)
    np.testing.assert_array_equal(triangulation.find_simplex(queries), expected)


def test_a_vertex_is_in_its_smallest_row() -> None:
    points = FAMILIES["hexagonal"](10_000, np.random.default_rng(47))
    triangulation = liftmesh.delaunay(points)
    smallest = np.full(len(points), np.iinfo(np.int32).max)
    rows = np.repeat(np.arange(len(triangulation.simplices)), 3)
    np.minimum.at(smallest, triangulation.simplices.ravel(), rows)
    np.testing.assert_array_equal(triangulation.find_simplex(points), smallest)


def test_the_middle_of_a_side_is_in_the_smaller_of_its_two_rows() -> None:
    points = FAMILIES["lattice"](10_000, np.random.default_rng(53))
    triangulation = liftmesh.delaunay(points)
    row, corner = np.nonzero(triangulation.neighbors >= 0)
    sides = np.delete(np.tile(np.arange(3), (3, 1)), [0, 4, 8]).reshape(3, 2)[corner]
    middles = points[triangulation.simplices[row[:, None], sides]].mean(axis=1)
    expected = np.minimum(row, triangulation.neighbors[row, corner])
    np.testing.assert_array_equal(triangulation.find_simplex(middles), expected)


@pytest.mark.parametrize("family", ["uniform", "clusters", "circle", "utm-lattice", "two-columns"])
def test_many_queries_lie_in_what_is_found(family: str) -> None:
    rng = np.random.default_rng(59)
    points = FAMILIES[family](50_000, rng)
    triangulation = liftmesh.delaunay(points)
    low, high = points.min(axis=0), points.max(axis=0)
    queries = rng.uniform(low - 0.05 * (high - low), high + 0.05 * (high - low), (50_000, 2))
    rows = triangulation.find_simplex(queries)
    inside = rows >= 0
    a, b, c = np.moveaxis(points[triangulation.simplices[rows[inside]]], 1, 0)
    for first, second in ((a, b), (b, c), (c, a)):
        assert (liftmesh.orient2d(first, second, queries[inside]) >= 0).all()
    for query in queries[~inside][:40]:
        start = points[triangulation.convex_hull]
        end = np.roll(start, -1, axis=0)
        assert (liftmesh.orient2d(start, end, query) < 0).any()


def test_generic_points_are_where_scipy_finds_them() -> None:
    rng = np.random.default_rng(61)
    points, queries = rng.random((2000, 2)), rng.uniform(-0.1, 1.1, (5000, 2))
    ours, theirs = liftmesh.delaunay(points), scipy.spatial.Delaunay(points)
    our_rows, their_rows = ours.find_simplex(queries), theirs.find_simplex(queries)
    np.testing.assert_array_equal(our_rows == -1, their_rows == -1)
    found = our_rows >= 0
    np.testing.assert_array_equal(
        np.sort(ours.simplices[our_rows[found]]), np.sort(theirs.simplices[their_rows[found]])
    )


class TestForms:
    @pytest.fixture
    def square(self) -> liftmesh.Triangulation:
        return liftmesh.delaunay([[0, 0], [2, 0], [0, 2], [2, 2]])

    @pytest.mark.parametrize("shape", [(), (0,), (5,), (3, 4), (2, 0, 3), (2, 3, 4)])
    def test_rows_have_the_shape_of_the_queries(self, square, shape: tuple[int, ...]) -> None:
        queries = np.random.default_rng(0).uniform(-1, 3, (*shape, 2))
        rows = square.find_simplex(queries)
        assert np.shape(rows) == shape
        assert np.asarray(rows).dtype == np.int32
        flat = [int(square.find_simplex(query)) for query in queries.reshape(-1, 2)]
        assert np.ravel(rows).tolist() == flat

    @pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
    def test_what_is_not_finite_is_nowhere(self, square, value: float) -> None:
        queries = [[value, 1], [1, value], [value, value], [0.5, 0.5]]
        rows = square.find_simplex(queries)
        assert rows[:3].tolist() == [-1, -1, -1]
        assert rows[3] >= 0

    def test_the_hull_is_closed(self, square) -> None:
        border = [[0, 0], [2, 2], [1, 0], [0, 1], [2, 1], [1, 2]]
        assert (square.find_simplex(border) >= 0).all()
        beyond = [[np.nextafter(2, 3), 1], [1, -(2.0**-1074)], [-(2.0**-1074), -(2.0**-1074)]]
        assert square.find_simplex(beyond).tolist() == [-1, -1, -1]

    def test_the_tolerance_of_scipy_is_accepted(self, square) -> None:
        assert square.find_simplex([1.0, 0.5], tol=1e-9) >= 0
        assert square.find_simplex([1.0, 0.5], True, None) >= 0

    @pytest.mark.parametrize("queries", [5.0, [1.0], [[1.0, 2.0, 3.0]], np.zeros((3, 0))])
    def test_queries_of_another_dimension_are_refused(self, square, queries) -> None:
        with pytest.raises(liftmesh.InputError, match="shape"):
            square.find_simplex(queries)

    @pytest.mark.parametrize("queries", [[["a", "b"]], [[1j, 0]], [[None, 1.0]]])
    def test_queries_that_are_no_numbers_are_refused(self, square, queries) -> None:
        with pytest.raises(liftmesh.LiftmeshError):
            square.find_simplex(queries)

    def test_other_dtypes_and_strides(self, square) -> None:
        queries = np.array([[1, 0], [0, 1], [3, 3]])
        expected = square.find_simplex(queries.astype(float)).tolist()
        for form in (queries, queries.astype(np.float32), np.asfortranarray(queries.astype(float))):
            assert square.find_simplex(form).tolist() == expected
