"""Delaunay triangulations in a constant metric: exact, canonical, and what is lifted how."""

from __future__ import annotations

import copy
import pickle
from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
import regular_oracle
from array_forms import in_a_table
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray

import liftmesh
from liftmesh import InputError

Points = NDArray[np.float64]
RNG = np.random.default_rng(5)
POINTS = np.r_[RNG.random((400, 2)), RNG.integers(0, 20, (400, 2)) / 16]
FORM = [[2.0, 0.5], [0.5, 1.25]]
STEPS = st.integers(-4, 4)
NUMBERS = st.one_of(STEPS.map(float), st.floats(-1e3, 1e3), st.sampled_from([0.1, 1e-3, 1e8]))


@st.composite
def metrics(draw: st.DrawFn) -> list[list[float]]:
    """Positive definite matrices, many of them nearly singular."""
    a, c = (draw(st.floats(1e-6, 1e6)) for _ in range(2))
    b = draw(st.floats(-1, 1)) * float(np.sqrt(a) * np.sqrt(c)) * (1 - 2.0**-40)
    return [[a, b], [b, c]]


SIMPLE = st.sampled_from([[[1, 0], [0, 1]], [[2, 1], [1, 2]], [[1, 0], [0, 4]], [[5, -2], [-2, 1]]])


def triangles(found: liftmesh.Triangulation) -> set[frozenset[int]]:
    return {frozenset(rows) for rows in found.simplices.tolist()}


def expected(points: Any, metric: Any) -> set[frozenset[int]]:
    (a, b), (_, c) = ((Fraction(value) for value in row) for row in metric)
    rows = [(Fraction(x), Fraction(y)) for x, y in points]
    lifted = [(x, y, a * x * x + 2 * b * x * y + c * y * y) for x, y in rows]
    return regular_oracle.regular(lifted)[0]


@settings(max_examples=150)
@given(st.lists(st.tuples(NUMBERS, NUMBERS), min_size=3, max_size=9), st.one_of(SIMPLE, metrics()))
def test_small_sets_are_the_oracles(points: list[tuple[float, float]], metric: Any) -> None:
    wanted = expected(points, metric)
    if wanted:
        found = liftmesh.delaunay(points, metric=metric)
        assert triangles(found) == wanted
        assert found.nsimplex == len(wanted)
    else:
        with pytest.raises(liftmesh.DegenerateInputError):
            liftmesh.delaunay(points, metric=metric)


@pytest.mark.parametrize("form", [[[1, 0], [0, 1]], [[0.5, 0], [0, 0.5]], 2.0**-90 * np.eye(2)])
def test_the_identity_and_its_multiples_give_todays_arrays(form: Any) -> None:
    plain, found = liftmesh.delaunay(POINTS), liftmesh.delaunay(POINTS, metric=form)
    for name in ("simplices", "neighbors", "duplicates", "convex_hull"):
        np.testing.assert_array_equal(getattr(plain, name), getattr(found, name))
    assert plain.metric is None


def test_a_metric_is_that_of_mapped_points() -> None:
    points = RNG.integers(0, 2**20, (2000, 2)).astype(float)
    stretch = np.array([[3.0, 1.0], [0.0, 2.0]])
    mapped = liftmesh.delaunay(points @ stretch.T)
    assert triangles(liftmesh.delaunay(points, metric=stretch.T @ stretch)) == triangles(mapped)


def test_the_triangles_do_not_depend_on_the_order_of_rows_or_the_number_of_threads() -> None:
    points = np.tile(POINTS, (60, 1)) + np.repeat(np.arange(60) * 3, 800)[:, None]
    once = liftmesh.delaunay(points, metric=FORM, threads=1)
    for threads in (2, 3):
        again = liftmesh.delaunay(points, metric=FORM, threads=threads)
        np.testing.assert_array_equal(again.simplices, once.simplices)
    order = np.random.default_rng(1).permutation(len(points))
    turned = liftmesh.delaunay(points[order], metric=FORM, order="canonical").simplices
    there = liftmesh.delaunay(points, metric=FORM, order="canonical").simplices
    np.testing.assert_array_equal(points[order][turned], points[there])


@pytest.mark.parametrize("form", [np.float32, np.int32, ">f8"])
def test_any_form_of_points_and_metric_is_the_same(form: Any) -> None:
    points = np.round(POINTS * 64)
    wanted = triangles(liftmesh.delaunay(points, metric=FORM))
    assert triangles(liftmesh.delaunay(points.astype(form), metric=np.float32(FORM))) == wanted
    assert triangles(liftmesh.delaunay(in_a_table(points), metric=np.array(FORM).T)) == wanted
    exact = [[Fraction(2), Decimal("0.5")], [0.5, Fraction(5, 4)]]
    assert triangles(liftmesh.delaunay(points, metric=exact)) == wanted


def test_rows_that_are_not_finite_and_progress_are_as_ever() -> None:
    told: list[float] = []
    points = np.r_[[[np.nan, 0]], POINTS]
    found = liftmesh.delaunay(points, metric=FORM, nonfinite="skip", progress=told.append)
    assert found.skipped.tolist() == [0]
    assert told[-1] == 1.0
    with pytest.raises(liftmesh.NonFiniteError, match="row 0"):
        liftmesh.delaunay(points, metric=FORM)


def test_what_is_lifted_is_lifted_to_the_form_of_the_metric() -> None:
    found = liftmesh.delaunay(POINTS, metric=FORM)
    heights = np.einsum("ni,ij,nj->n", POINTS, np.array(FORM), POINTS)
    np.testing.assert_allclose(found.lifted("origin").vertices[:, 2], heights, rtol=1e-12)
    np.testing.assert_allclose(found.lift_points(POINTS)[:, 2], heights, rtol=1e-12)
    distances = found.plane_distance(POINTS)
    assert distances.max() < 1e-12
    corners = distances[found.simplices.T, np.arange(found.nsimplex)]
    np.testing.assert_allclose(corners, 0, atol=1e-12)
    away = found.lifted(apex=(1, 2)).vertices[:, 2]
    moved = POINTS - (1, 2)
    np.testing.assert_allclose(away, np.einsum("ni,ij,nj->n", moved, np.array(FORM), moved))


@pytest.mark.parametrize(
    "again", [copy.copy, copy.deepcopy, lambda t: pickle.loads(pickle.dumps(t))]
)
def test_copies_have_the_metric(again: Any) -> None:
    given_form = np.array(FORM)
    found = again(liftmesh.delaunay(POINTS, metric=given_form))
    given_form[0, 0] = 9
    assert found.metric.tolist() == FORM
    with pytest.raises(ValueError, match="read-only"):
        found.metric[0, 0] = 1
    assert (found.find_simplex(POINTS[:50]) >= 0).all()


@pytest.mark.parametrize(
    ("metric", "said"),
    [
        ([[1, 2], [2, 1]], r"metric is \[\[1.0, 2.0\], .*\], which is not positive definite: give"),
        ([[1, 1], [1, 1]], "is not positive definite"),
        ([[0.1, 0.1], [0.1, np.nextafter(0.1, 0)]], "is not positive definite"),
        ([[1, 1e300], [1e300, 1]], "is not positive definite"),
        ([[-1, 0], [0, -1]], "is not positive definite"),
        ([[1, 0], [0, 0]], "is not positive definite"),
        ([[1, 0], [0.5, 1]], "is not symmetric"),
        ([[1, 0], [0, np.nan]], "is not finite"),
        ([[np.inf, 0], [0, 1]], "is not finite"),
        ([1, 0, 1], r"has the shape \(3,\), not \(2, 2\): give \[\[a, b\], \[b, c\]\]"),
        (np.eye(3), r"has the shape \(3, 3\)"),
        ([[1, 0], [1]], "cannot be read as numbers"),
        ([["a", "b"], ["b", "c"]], "the metric hold"),
        ([[1 + 1j, 0], [0, 1]], "give real numbers"),
        ([[2**60 + 1, 0], [0, 1]], "row 0 holds 1152921504606846977 in the metric"),
    ],
)
def test_what_is_no_metric_is_refused(metric: Any, said: str) -> None:
    with pytest.raises(InputError, match=said):
        liftmesh.delaunay(POINTS, metric=metric)


def test_a_determinant_that_rounds_to_zero_is_positive() -> None:
    tiny = 2.0**-600
    found = liftmesh.delaunay(POINTS, metric=[[tiny, 0], [0, tiny]])
    assert triangles(found) == triangles(liftmesh.delaunay(POINTS))
    near = [[1.0, 1 - 2.0**-53], [1 - 2.0**-53, 1.0]]
    assert liftmesh.delaunay(POINTS[:9], metric=near).nsimplex > 0


@pytest.mark.parametrize("algorithm", ["lf", "lfres", "lfres-indexed"])
def test_gift_wrapping_has_no_metric(algorithm: Any) -> None:
    with pytest.raises(InputError, match=f"algorithm '{algorithm}' has no metric"):
        liftmesh.delaunay(POINTS, algorithm=algorithm, metric=FORM)
