"""The kernel's triangles against the exact oracle: thousands of small sets, every coincidence."""

from __future__ import annotations

from itertools import combinations, permutations, product

import numpy as np
import pytest
from clouds import FAMILIES, HARD
from hypothesis import given, settings, strategies as st
from meshes import (
    assert_delaunay,
    assert_oracle_agrees,
    assert_same_triangles,
    oracle_triangles,
    triangle_rows,
)
from numpy.typing import NDArray

import liftmesh

SEEDS = 30
FINITE = st.floats(allow_nan=False, allow_infinity=False)
SMALL = st.integers(-3, 3).map(float)
STEPS = st.integers(-4, 4).map(lambda steps: steps * 2.0**-1074)
ULPS = st.integers(-4, 4).map(lambda steps: 1 + steps * 2.0**-52)
SCALES = st.sampled_from([2.0**-1070, 2.0**-537, 2.0**-200, 1.0, 0.1, 1 / 3, 2.0**300, 2.0**1020])
OFFSETS = st.sampled_from([0.0, 0.1, 450000.0, -1e8, 1e15])


def point_lists(x: st.SearchStrategy[float], y: st.SearchStrategy[float]) -> st.SearchStrategy:
    """Lists of up to thirty rows, equal ones among them."""
    return st.lists(st.tuples(x, y), min_size=1, max_size=30).map(np.array)


def check(points: NDArray[np.float64]) -> None:
    """Triangulate, or refuse, exactly as the oracle says."""
    expected = oracle_triangles(points)
    if expected:
        assert_oracle_agrees(points, liftmesh.delaunay(points).simplices, expected)
    else:
        with pytest.raises(liftmesh.DegenerateInputError):
            liftmesh.delaunay(points)


@pytest.mark.parametrize("family", FAMILIES)
def test_small_sets_of_every_family(family: str) -> None:
    for seed in range(SEEDS):
        rng = np.random.default_rng(seed)
        check(FAMILIES[family](int(rng.integers(3, 28)), rng))


@pytest.mark.slow
@pytest.mark.parametrize("n", [100, 200])
@pytest.mark.parametrize("family", FAMILIES)
def test_larger_sets_of_every_family(family: str, n: int) -> None:
    check(FAMILIES[family](n, np.random.default_rng(n)))


def test_every_subset_of_a_lattice() -> None:
    lattice = np.array(list(product(range(4), range(3))), dtype=np.float64)
    for size in range(1, len(lattice) + 1):
        for chosen in combinations(range(len(lattice)), size):
            check(lattice[list(chosen)])


@pytest.mark.slow
@settings(max_examples=400)
@given(point_lists(SMALL, SMALL))
def test_small_integers(points: NDArray[np.float64]) -> None:
    check(points)


@settings(max_examples=200)
@given(point_lists(FINITE, FINITE))
def test_any_finite_doubles(points: NDArray[np.float64]) -> None:
    check(points)


@pytest.mark.slow
@settings(max_examples=200)
@given(point_lists(st.one_of(SMALL, STEPS, ULPS, FINITE), st.one_of(SMALL, STEPS, ULPS)))
def test_mixed_kinds_of_doubles(points: NDArray[np.float64]) -> None:
    check(points)


@settings(max_examples=300)
@given(point_lists(SMALL, SMALL), SCALES, SCALES, OFFSETS, OFFSETS)
def test_scaled_and_shifted_integers(
    points: NDArray[np.float64], x_scale: float, y_scale: float, x: float, y: float
) -> None:
    check(points * (x_scale, y_scale) + (x, y))


@pytest.mark.parametrize("family", FAMILIES)
def test_a_few_thousand_points_pass_the_exact_check(family: str) -> None:
    n = 400 if family in {"mixed-magnitudes", "mixed-lattices"} else 3000
    points = FAMILIES[family](n, np.random.default_rng(7))
    assert_delaunay(points, liftmesh.delaunay(points).simplices)


@pytest.mark.parametrize("family", FAMILIES)
def test_every_order_of_five_rows(family: str) -> None:
    points = np.vstack((FAMILIES[family](4, np.random.default_rng(1))[:4], [[3.0, 7.0]]))
    expected = triangle_rows(points, liftmesh.delaunay(points).simplices)
    for order in permutations(range(len(points))):
        shuffled = points[list(order)]
        actual = triangle_rows(shuffled, liftmesh.delaunay(shuffled).simplices)
        assert_same_triangles(actual, expected, f"{family} in order {order}")


@pytest.mark.parametrize("family", FAMILIES)
def test_the_set_is_the_same_for_every_order_of_many_rows(family: str) -> None:
    rng = np.random.default_rng(11)
    points = FAMILIES[family](4000, rng)
    expected = triangle_rows(points, liftmesh.delaunay(points).simplices)
    orders = [np.lexsort(points.T), np.lexsort(points.T)[::-1], rng.permutation(len(points))]
    for order in orders:
        actual = triangle_rows(points[order], liftmesh.delaunay(points[order]).simplices)
        assert_same_triangles(actual, expected, family)


@pytest.mark.parametrize("family", HARD)
def test_canonical_order_depends_on_coordinates_alone(family: str) -> None:
    rng = np.random.default_rng(13)
    points = FAMILIES[family](500, rng)
    shuffled = rng.permutation(points)
    first = liftmesh.delaunay(points, order="canonical")
    second = liftmesh.delaunay(shuffled, order="canonical")
    np.testing.assert_array_equal(points[first.simplices], shuffled[second.simplices])
    np.testing.assert_array_equal(first.neighbors, second.neighbors)


def test_canonical_order_is_the_same_set_as_the_engine_order() -> None:
    points = FAMILIES["small-integers"](300, np.random.default_rng(17))
    canonical = liftmesh.delaunay(points, order="canonical")
    assert_oracle_agrees(points, canonical.simplices)


def test_two_runs_give_the_same_rows() -> None:
    points = FAMILIES["circle"](5000, np.random.default_rng(19))
    first, second = liftmesh.delaunay(points), liftmesh.delaunay(points)
    np.testing.assert_array_equal(first.simplices, second.simplices)
    np.testing.assert_array_equal(first.neighbors, second.neighbors)
