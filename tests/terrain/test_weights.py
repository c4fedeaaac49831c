"""`Surface.weights`: the bits of `sample`, for any values."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse
from clouds import FAMILIES
from hypothesis import given, strategies as st
from surfaces import family_surface

import liftmesh
from liftmesh import InputError

WAYS = ["linear", "nearest", "laplace", "sibson"]


def surface_of(count: int = 300, seed: int = 1) -> liftmesh.Surface:
    return liftmesh.triangulate(np.random.default_rng(seed).random((count, 3)))


@pytest.mark.parametrize("interpolation", WAYS)
@pytest.mark.parametrize("family", FAMILIES)
def test_products_have_the_bits_of_sample(family: str, interpolation: str) -> None:
    surface, queries = family_surface(family)
    values = np.random.default_rng(3).normal(size=(len(surface.vertices), 2))
    values[0] = [1e308, -0.0]
    weights = surface.weights(queries, interpolation)
    assert weights.shape == (len(queries), len(surface.vertices))
    for given_ones in (values, surface.vertices[:, 2]):
        expected = surface.sample(queries, interpolation, values=given_ones)
        np.testing.assert_array_equal(weights @ given_ones, expected)
    np.testing.assert_array_equal(weights @ values[:, 0], weights.interpolate(values)[:, 0])


@pytest.mark.parametrize("extrapolate", ["nearest", "hull"])
@pytest.mark.parametrize("interpolation", WAYS)
def test_beyond_the_faces(interpolation: str, extrapolate: str) -> None:
    surface = surface_of().trim(max_edge=0.2)
    queries = np.random.default_rng(2).uniform(-1, 2, (3000, 2))
    weights = surface.weights(queries, interpolation, extrapolate=extrapolate)
    values = np.random.default_rng(4).random((300, 3, 2))
    expected = surface.sample(queries, interpolation, values=values, extrapolate=extrapolate)
    np.testing.assert_array_equal(weights @ values, expected)
    empty = np.diff(weights.indptr) == 0
    np.testing.assert_array_equal(np.isnan(expected[:, 0, 0]), empty)
    assert empty.any() == (extrapolate == "hull")


def test_surfaces_that_follow_lines() -> None:
    points = np.random.default_rng(5).random((200, 3))
    surface = liftmesh.triangulate(points, breaklines=[[[0.1, 0.1, 0], [0.9, 0.8, 1]]])
    queries = np.random.default_rng(6).uniform(-0.1, 1.1, (500, 2))
    for interpolation in ("linear", "nearest"):
        weights = surface.weights(queries, interpolation)
        expected = surface.sample(queries, interpolation)
        np.testing.assert_array_equal(weights @ surface.vertices[:, 2], expected)
    with pytest.raises(InputError, match="follows lines"):
        surface.weights(queries, "sibson")


def test_constants_and_infinite_values_are_as_in_samples() -> None:
    surface = surface_of()
    queries = np.random.default_rng(7).random((400, 2))
    values = surface.vertices[:, 2].copy()
    values[:4] = [np.nan, np.inf, -np.inf, 1.7e308]
    values[4:20] = -1.7e308
    for interpolation in WAYS:
        weights = surface.weights(queries, interpolation)
        inside = np.diff(weights.indptr) > 0
        assert set((weights @ np.full(300, 0.1))[inside]) == {0.1}
        expected = surface.sample(queries, interpolation, values=values)
        np.testing.assert_array_equal(weights @ values, expected)
        assert np.isnan(expected[inside]).any()


@given(st.integers(0, 2**32 - 1))
def test_the_order_of_rows_changes_no_bit(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = np.round(rng.random((20, 3)) * 8)
    points = points[np.unique(points[:, :2], axis=0, return_index=True)[1]]
    if np.linalg.matrix_rank(points[:, :2] - points[0, :2]) < 2:
        return
    order, queries = rng.permutation(len(points)), rng.uniform(0, 8, (20, 2))
    for interpolation in ("linear", "sibson"):
        one = liftmesh.triangulate(points).weights(queries, interpolation)
        other = liftmesh.triangulate(points[order]).weights(queries, interpolation)
        assert one.data.tobytes() == other.data.tobytes()
        np.testing.assert_array_equal(one.indices, order[other.indices])


def test_a_matrix_of_scipy() -> None:
    surface = surface_of()
    queries = np.random.default_rng(8).random((50, 2))
    weights = surface.weights(queries, "sibson")
    matrix = weights.to_scipy()
    assert isinstance(matrix, scipy.sparse.csr_array)
    assert matrix.shape == weights.shape == (50, 300)
    for held, own in ((matrix.indices, weights.indices), (matrix.indptr, weights.indptr)):
        np.testing.assert_array_equal(held, own)
    values = surface.vertices[:, 2]
    inside = np.diff(weights.indptr) > 0
    np.testing.assert_allclose((matrix @ values)[inside], (weights @ values)[inside], rtol=1e-14)
    np.testing.assert_array_equal((matrix @ values)[~inside], 0)
    matrix.sort_indices()  # of its own arrays
    assert repr(weights) == f"<Weights: {len(weights.data)} of 300 rows at 50 points>"


def test_weights_are_those_of_natural_neighbors() -> None:
    surface = surface_of()
    queries = np.random.default_rng(9).random((60, 2))
    weights, found = (
        surface.weights(queries, "sibson"),
        liftmesh.natural_neighbors(surface.vertices[:, :2], queries),
    )
    assert isinstance(found, liftmesh.Weights)
    assert (weights.data.tobytes(), weights.indices.tobytes()) == (
        found.data.tobytes(),
        found.indices.tobytes(),
    )


def test_what_is_no_weight() -> None:
    surface = surface_of()
    weights = surface.weights([[[0.5, 0.5], [9, 9]], [[np.nan, 0], [np.inf, 1]]])
    assert np.diff(weights.indptr).tolist() == [3, 0, 0, 0]
    assert surface.weights(np.empty((0, 2)), extrapolate="hull").shape == (0, 300)
    assert (surface.weights(np.empty((0, 2))) @ np.ones((300, 2))).shape == (0, 2)
    assert (weights @ np.ones((300, 0))).shape == (4, 0)
    for values in (1.0, np.ones(299), np.ones((2, 300))):
        with pytest.raises(InputError, match="give one for each of the 300 rows"):
            weights @ values
    with pytest.raises(InputError, match="no sparse matrix: use interpolator"):
        surface.weights([0.5, 0.5], "c1")
    with pytest.raises(InputError, match="interpolation is 'cubic'"):
        surface.weights([0.5, 0.5], "cubic")


def test_masked_values_are_none() -> None:
    surface = surface_of(20)
    masked = np.ma.masked_equal(np.arange(20), 7)
    queries = surface.vertices[surface.faces, :2].mean(axis=1)
    found = surface.sample(queries, values=masked)
    np.testing.assert_array_equal(np.isnan(found), (surface.faces == 7).any(axis=1))
    assert (
        np.isnan(surface.sample(surface.vertices[:, :2], values=masked)).tolist().count(True) == 1
    )
    weights = surface.weights(queries)
    np.testing.assert_array_equal(weights @ masked, found)
