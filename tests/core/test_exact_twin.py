"""The predicates against their twin in rational numbers, over the whole range of exponents.

`test_predicates.py` compares with integers, and with the rule for ties as it is printed. Here no
formula and no rule is shared: areas and planes in `fractions.Fraction`, and ties decided by what a
perturbation is, a small number (`twin`).
"""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations, permutations

import hypothesis.strategies as st
import numpy as np
import pytest
import twin
from hypothesis import given, settings
from numpy.typing import NDArray
from strategies import ANY_MAGNITUDE, COCIRCULAR_CLOUDS, FINITE, POWERS_OF_TWO, Points, clouds

import liftmesh

Questions = NDArray[np.float64]

ASKED = 12  # questions that are drawn of one cloud


@st.composite
def questions(draw: st.DrawFn) -> Questions:
    """Quadruples of rows of one cloud: (k, 4, 2), equal rows among them."""
    points = draw(st.one_of(COCIRCULAR_CLOUDS, clouds()))
    row = st.integers(0, len(points) - 1)
    quadruples = draw(st.lists(st.tuples(row, row, row, row), min_size=1, max_size=ASKED))
    return points[np.array(quadruples)]


def apart(coordinate: st.SearchStrategy[float]) -> st.SearchStrategy[Questions]:
    """Questions of independent coordinates."""
    point = st.tuples(coordinate, coordinate)
    return st.lists(st.tuples(point, point, point, point), min_size=1, max_size=4).map(np.array)


@st.composite
def cocircular_questions(draw: st.DrawFn) -> Questions:
    """Four points of one circle, in any order, at any exponent: a tie, every time.

    A point that is mirrored at an axis or at a diagonal stays on its circle around the origin.
    """
    x, y = draw(st.tuples(st.integers(0, 9), st.integers(0, 9)))
    images = [(i * u, j * v) for u, v in ((x, y), (y, x)) for i in (1, -1) for j in (1, -1)]
    shift = draw(st.tuples(st.integers(-20, 20), st.integers(-20, 20)))
    four = st.lists(st.sampled_from(images), min_size=4, max_size=4)
    chosen = np.array(draw(st.lists(four, min_size=1, max_size=ASKED)), dtype=np.float64)
    return (chosen + shift) * draw(POWERS_OF_TWO)


def assert_twins(asked: Questions) -> None:
    """Compare all answers to some questions, each array at once."""
    a, b, c, d = np.moveaxis(asked, 1, 0)
    exact = twin.rational(asked)
    np.testing.assert_array_equal(liftmesh.orient2d(a, b, c), twin.turns(exact))
    np.testing.assert_array_equal(liftmesh.incircle(a, b, c, d), twin.sides(exact))
    np.testing.assert_array_equal(
        liftmesh.incircle(a, b, c, d, canonical=True), twin.canonical_sides(exact)
    )


@pytest.mark.slow
@settings(max_examples=200)
@given(questions())
def test_questions_of_every_cloud(asked: Questions) -> None:
    assert_twins(asked)


@pytest.mark.slow
@pytest.mark.parametrize("coordinate", [FINITE, ANY_MAGNITUDE], ids=["floats", "magnitudes"])
def test_questions_over_the_whole_range_of_exponents(coordinate) -> None:
    @settings(max_examples=100)
    @given(apart(coordinate))
    def check(asked: Questions) -> None:
        assert_twins(asked)

    check()


@settings(max_examples=100)
@given(cocircular_questions())
def test_ties(asked: Questions) -> None:
    np.testing.assert_array_equal(liftmesh.incircle(*np.moveaxis(asked, 1, 0)), 0)
    assert_twins(asked)


@settings(max_examples=40)
@given(cocircular_questions())
def test_a_smaller_epsilon_decides_no_tie_otherwise(asked: Questions) -> None:
    """So the sign is the limit's: what the perturbation says as epsilon goes to zero."""
    found = liftmesh.incircle(*np.moveaxis(asked, 1, 0), canonical=True)
    for share in (Fraction(1, 3), Fraction(1, 10**9)):
        np.testing.assert_array_equal(found, twin.canonical_sides(twin.rational(asked), share))


@pytest.mark.slow
def test_every_order_of_every_four_points_of_a_lattice() -> None:
    lattice = np.indices((3, 3)).reshape(2, -1).T.astype(np.float64)
    orders = [order for rows in combinations(range(9), 4) for order in permutations(rows)]
    assert_twins(lattice[np.array(orders)])


@settings(max_examples=60)
@given(clouds(most=12))
def test_one_answer_for_a_query_beside_many_corners(points: Points) -> None:
    """Broadcast: every row against the first three."""
    a, b, c = np.resize(points, (3, 2))
    asked = np.array([[a, b, c, d] for d in points])
    expected = twin.canonical_sides(twin.rational(asked))
    np.testing.assert_array_equal(liftmesh.incircle(a, b, c, points, canonical=True), expected)
    turns = twin.turns(twin.rational(np.array([[a, b, d] for d in points])))
    np.testing.assert_array_equal(liftmesh.orient2d(a, b, points), turns)


def test_the_twin_sees_a_single_ulp() -> None:
    """It rounds nothing: it tells points apart that doubles cannot compute with."""
    square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    inside, outside = ([*square[:3], [5e-324 * k, 1.0]] for k in (1, -1))
    exact = twin.rational(np.array([square, inside, outside]))
    assert twin.sides(exact).tolist() == [0, 1, -1]
    assert twin.turns(exact).tolist() == [1, 1, 1]
