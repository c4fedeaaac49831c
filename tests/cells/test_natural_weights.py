"""`natural_neighbors`: Sibson's weights."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import hypothesis.strategies as st
import neighbors as campaign
import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from oracles.cells import cell_area, exact_point

import liftmesh

RNG = np.random.default_rng(1808)
FEW = st.integers(0, 8)
SITES = st.lists(st.tuples(FEW, FEW), min_size=4, max_size=14, unique=True)
HALVES = st.tuples(*[st.integers(0, 16).map(lambda each: each / 2)] * 2)


@given(SITES, HALVES)
@settings(max_examples=40)
def test_weights_are_what_a_cell_takes_from_others(sites, query) -> None:
    points = np.array(sites, dtype=float)
    hull = shapely.MultiPoint(points).convex_hull
    if hull.geom_type != "Polygon":
        return
    found = liftmesh.natural_neighbors(points, [query])
    assert found.indptr.tolist() == [0, len(found.indices)]
    at = shapely.Point(query)
    assert bool(len(found.indices)) == hull.covers(at)
    if not len(found.indices):
        return
    np.testing.assert_allclose(found.data @ points[found.indices], query, atol=1e-12)
    if hull.boundary.covers(at) or query in sites:
        assert len(found.indices) == 1 + (query not in sites)
        return
    far = 10**6
    square = [
        [exact_point(np.array(c)) for c in ((-far, -far), (far, -far), (far, far), (-far, far))]
    ]
    rows = [exact_point(point) for point in points]
    more = [*rows, exact_point(np.array(query))]
    zero = [0] * len(more)
    before = [cell_area(row, rows, zero[:-1], square) for row in range(len(rows))]
    after = [cell_area(row, more, zero, square) for row in range(len(more))]
    taken = [a - b for a, b in zip(before, after, strict=False)]
    assert sorted(found.indices) == [row for row, area in enumerate(taken) if area]
    weights = [float(taken[row] / after[-1]) for row in found.indices]
    np.testing.assert_allclose(found.data, weights, rtol=1e-9)


@pytest.mark.parametrize("offset", [0.0, 1e6, 1e8])
def test_linear_functions_are_reproduced(offset: float) -> None:
    points = np.round(RNG.random((500, 2)) * 1024) / 64
    queries = points[:300] * 0.5 + points[200:] * 0.5
    found = liftmesh.natural_neighbors(points + offset, queries + offset)
    near = liftmesh.natural_neighbors(points, queries)
    np.testing.assert_array_equal(found.indices, near.indices)
    np.testing.assert_allclose(found.data, near.data, atol=1e-12)
    np.testing.assert_allclose(near.interpolate(points), queries, atol=1e-9)
    tri = liftmesh.delaunay(points)
    np.testing.assert_array_equal(liftmesh.natural_neighbors(tri, queries).data, near.data)


def test_at_rows_on_the_hull_and_outside() -> None:
    points = [[0, 0], [4, 0], [0, 4], [4, 0], [1, 1]]
    found = liftmesh.natural_neighbors(points, [[4, 0], [1, 0], [9, 9], [2, 2]])
    assert found.indices.tolist() == [1, 0, 1, 2, 1]
    assert found.data.tolist() == [1, 0.75, 0.25, 0.5, 0.5]
    assert found.indptr.tolist() == [0, 1, 3, 3, 5]
    values = found.interpolate([[0, 1], [4, 5], [8, 9], [0, 0], [0, 0]])
    np.testing.assert_array_equal(values, [[4, 5], [1, 2], [np.nan, np.nan], [6, 7]])
    none = liftmesh.natural_neighbors(points, np.empty((0, 2)))
    assert (none.indptr.tolist(), len(none.indices), none.interpolate(np.ones(5)).shape) == (
        [0],
        0,
        (0,),
    )


@pytest.mark.parametrize("scale", [1e-300, 1e-150, 1e150, 1e300])
def test_every_magnitude(scale: float) -> None:
    points = np.round(RNG.random((30, 2)) * 64) / 64
    near = liftmesh.natural_neighbors(points, [[0.4, 0.5]])
    found = liftmesh.natural_neighbors(
        points * 2.0 ** np.log2(scale).round(),
        np.array([[0.4, 0.5]]) * 2.0 ** np.log2(scale).round(),
    )
    np.testing.assert_array_equal(found.indices, near.indices)
    np.testing.assert_allclose(found.data, near.data)


def test_near_the_hull_weights_become_linear() -> None:
    points = np.array([[0, 0], [1, 0], [0, 1], [1, 1]])
    found = liftmesh.natural_neighbors(points, [[0.25, 1e-310], [0.25, 1e-100]])
    np.testing.assert_allclose(found.interpolate(points), [[0.25, 0], [0.25, 0]], atol=1e-15)


def test_bad_input_is_named() -> None:
    points = RNG.random((9, 2))
    with pytest.raises(liftmesh.NonFiniteError, match="row 1 is not finite"):
        liftmesh.natural_neighbors(points, [[0, 0], [np.nan, 0]])
    with pytest.raises(liftmesh.InputError, match="points are triangulated by radii"):
        liftmesh.natural_neighbors(liftmesh.regular(points, radii=np.ones(9)), points)
    with pytest.raises(liftmesh.InputError, match="points are triangulated by metric"):
        liftmesh.natural_neighbors(liftmesh.delaunay(points, metric=[[1, 0], [0, 2]]), points)
    with pytest.raises(liftmesh.DegenerateInputError):
        liftmesh.natural_neighbors([[0, 0], [1, 1], [2, 2]], [[1, 1]])
    near = liftmesh.natural_neighbors(points, points[:2])  # whose neighbours are rows 0 and 1
    for count in (2, 8, 10):
        message = rf"values have the shape \({count},\): give one for each of the 9 rows"
        with pytest.raises(liftmesh.InputError, match=message):
            near.interpolate(np.arange(count))


def test_points_that_changed_since_are_refused() -> None:
    rng = np.random.default_rng(0)
    points, queries = rng.random((2000, 2)), rng.random((200, 2))
    tri = liftmesh.delaunay(points)
    before = liftmesh.natural_neighbors(tri, queries).data
    points[:] = np.random.default_rng(5).permutation(points)
    with pytest.raises(liftmesh.InputError, match="changed since; triangulate them again"):
        liftmesh.natural_neighbors(tri, queries)
    assert len(before) > 500


def test_any_threads_and_any_order_give_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    points, queries = RNG.random((3000, 2)), RNG.random((9000, 2))
    tri = liftmesh.delaunay(points)
    found = liftmesh.natural_neighbors(tri, queries)
    order = RNG.permutation(len(queries))
    for threads in ("1", "5"):
        monkeypatch.setenv("LIFTMESH_NUM_THREADS", threads)
        again = liftmesh.natural_neighbors(tri, queries[order])
        counts = np.diff(again.indptr)
        assert counts.tolist() == np.diff(found.indptr)[order].tolist()
        for place, query in enumerate(order[:500].tolist()):
            own, other = (slice(*each) for each in (again.indptr[place : place + 2],
                                                    found.indptr[query : query + 2]))  # fmt: skip
            assert again.indices[own].tolist() == found.indices[other].tolist()
            assert again.data[own].tolist() == found.data[other].tolist()


def test_slivers_whose_area_is_no_double() -> None:
    tiny = 2.0**-1040
    points = [[0, 0], [tiny, 0], [0.5, tiny], [1, 0]]
    found = liftmesh.natural_neighbors(points, [[0.25, tiny / 4], [tiny / 2, 0], [0.75, 0]])
    np.testing.assert_allclose(found.interpolate([0, 0, 2, 4]), [0.5 + 0.25 * 2, 0, 3])
    np.testing.assert_allclose(np.add.reduceat(found.data, found.indptr[:-1]), 1)


@pytest.mark.slow
@pytest.mark.parametrize("kind", campaign.KINDS)
def test_weights_are_right_in_hard_places(kind: str) -> None:
    rng = np.random.default_rng(33)
    for _ in range(15):
        campaign.holds(kind, rng)


def test_other_weights_are_noticed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    right = liftmesh.natural_neighbors

    def wrong(*given: object) -> liftmesh.NaturalNeighbors:
        found = right(*given)
        weights = found.data + 1e-10 * (np.arange(len(found.data)) % 2)
        return liftmesh.NaturalNeighbors(found.indptr, found.indices, weights, found.shape)

    monkeypatch.setattr(campaign.liftmesh, "natural_neighbors", wrong)
    with pytest.raises(SystemExit):
        test_weights_are_right_in_hard_places("lattices")
    assert "is off by 1" in capsys.readouterr().err


def test_an_ulp_from_the_hull_and_between_two_rows() -> None:
    points = np.array([[0.3, 0.1], [0.4, 0.2], [0.3, 0.2], [0.3, 0.3]])
    inside = [0.35, 0.15000000000000002]  # the middle of a side, rounded
    found = liftmesh.natural_neighbors(points, [inside])
    np.testing.assert_allclose(found.interpolate(points), [inside], rtol=0, atol=1e-15)
    twins = np.array([[0.5, 0.5], [0.5 + 2.0**-45, 0.5], [0, 0], [1, 0], [0, 1], [1, 1]])
    found = liftmesh.natural_neighbors(twins, [[0.5 + 2.0**-46, 0.5]])
    twin = found.indices < 2
    np.testing.assert_allclose(found.data[twin], [0.5, 0.5], rtol=0, atol=1e-12)


def of_points(points: np.ndarray, asked: np.ndarray) -> list[list[tuple[tuple[float, ...], float]]]:
    """Weights by coordinates."""
    found = liftmesh.natural_neighbors(points, asked)
    rows = map(tuple, points[found.indices].tolist())
    weights = list(zip(rows, found.data.tolist(), strict=True))
    return [sorted(weights[i:j]) for i, j in itertools.pairwise(found.indptr.tolist())]


def drawn(kind: str) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    rng = np.random.default_rng(34)
    for _ in range(10):
        points, asked = campaign.KINDS[kind](rng)
        points = np.unique(points, axis=0)
        if np.linalg.matrix_rank(points - points[0]) == 2:
            yield points, asked


@pytest.mark.parametrize("kind", campaign.KINDS)
def test_the_order_of_rows_changes_no_bit_of_a_weight(kind: str) -> None:
    for points, asked in drawn(kind):
        assert of_points(RNG.permutation(points), asked) == of_points(points, asked)


@pytest.mark.parametrize("kind", ["rims", "pairs", "lattices", "circles"])
def test_powers_of_two_and_moves_without_rounding_change_no_bit(kind: str) -> None:
    for points, asked in drawn(kind):
        found = liftmesh.natural_neighbors(points, asked).data.tobytes()
        for size in (2.0**-300, 2.0**200):
            scaled = liftmesh.natural_neighbors(points * size, asked * size)
            assert scaled.data.tobytes() == found
        whole, between = (points * 1024).round(), (asked * 1024).round()
        near = liftmesh.natural_neighbors(whole, between)
        far = liftmesh.natural_neighbors(whole + 2.0**40, between + 2.0**40)
        assert far.data.tobytes() == near.data.tobytes()
