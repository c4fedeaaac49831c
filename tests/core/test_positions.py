"""Distinct positions and their spacing: against exact distances, at every scale, and quickly."""

from __future__ import annotations

import math
import sys
from decimal import Decimal, localcontext
from fractions import Fraction

import numpy as np
import pytest
from clouds import FAMILIES
from counted_calls import CLOUDS, instructions
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from worst_points import SCALES

from liftmesh.planar.points import find_positions

Points = NDArray[np.float64]

LEAST = 2.0**-1074
MOST = Fraction(sys.float_info.max)


def square(p: list[float], q: list[float]) -> Fraction:
    return sum(((Fraction(a) - Fraction(b)) ** 2 for a, b in zip(p, q, strict=True)), Fraction(0))


def root(value: Fraction) -> Fraction:
    with localcontext(prec=60):
        return Fraction((Decimal(value.numerator) / Decimal(value.denominator)).sqrt())


def expected_spacing(points: Points) -> Fraction | None:
    """The median of the distances to the nearest, by comparing all with all."""
    places = np.unique(points + 0.0, axis=0).tolist()
    if len(places) < 2:
        return None
    nearest = sorted(min(square(p, q) for q in places if q is not p) for p in places)
    middle = nearest[(len(nearest) - 1) // 2], nearest[len(nearest) // 2]
    return (root(middle[0]) + root(middle[1])) / 2


def check(points: Points) -> None:
    positions, expected = find_positions(points), expected_spacing(points)
    assert positions.count == len(np.unique(points + 0.0, axis=0))
    assert positions.count + len(positions.duplicates) == len(points)
    assert positions.collinear == is_on_line(points)
    if expected is None:
        assert positions.spacing is None
    elif positions.spacing == math.inf:
        assert expected > MOST * (1 - Fraction(1, 2**50))
    else:
        allowed = expected / 2**50 + 2 * Fraction(LEAST)
        assert abs(Fraction(positions.spacing) - expected) <= allowed, points.tolist()


def is_on_line(points: Points) -> bool:
    (px, py), *rest = [[Fraction(x) for x in row] for row in points.tolist()]
    ways = [(x - px, y - py) for x, y in rest if (x, y) != (px, py)]
    return all(ways[0][0] * y == ways[0][1] * x for x, y in ways)


FINITE = st.floats(allow_nan=False, allow_infinity=False)
SMALL = st.integers(-3, 3).map(float)
SCALED = st.tuples(st.integers(-8, 8), st.sampled_from([LEAST, 1e-300, 1e-20, 0.1, 1e300])).map(
    lambda pair: pair[0] * pair[1]
)


def rows(*axes: st.SearchStrategy[float]) -> st.SearchStrategy[Points]:
    return st.lists(st.tuples(*axes), min_size=1, max_size=14).map(np.array)


@pytest.mark.slow
@settings(max_examples=200)
@given(rows(SCALED, SCALED))
def test_several_scales_at_once(points: Points) -> None:
    check(points)


@settings(max_examples=150)
@given(rows(FINITE, FINITE))
def test_any_finite_doubles(points: Points) -> None:
    check(points)


@settings(max_examples=200)
@given(rows(SMALL, SMALL), st.sampled_from([LEAST, 1.0, 1e300]))
def test_lattices_with_many_duplicates(points: Points, scale: float) -> None:
    check(points * scale)


@settings(max_examples=200)
@given(
    st.lists(SCALED, min_size=1, max_size=14), st.sampled_from([(1, 1), (-1, 1), (0, 1), (1, 0)])
)
def test_lines(along: list[float], way: tuple[int, int]) -> None:
    check(np.outer(along, way).astype(float))


@pytest.mark.parametrize("family", FAMILIES)
def test_families(family: str) -> None:
    check(FAMILIES[family](60, np.random.default_rng(1)))


@pytest.mark.parametrize("family", SCALES)
def test_clouds_of_two_scales(family: str) -> None:
    check(SCALES[family](100, np.random.default_rng(2)))


def test_positions_a_thousand_times_farther_apart_than_their_neighbours() -> None:
    """Regressions: the spacing of these was 0, and 1.04774e-09."""
    assert find_positions([[-1, 0], [-1, 1e-20], [0, 0.5], [1, 0], [1, 1e-20]]).spacing == 1e-20
    far = [[1e6, 0], [1e6, 1e-9], [1000002, 0], [1000002, 1e-9], [1000001, 1e6]]
    assert find_positions(far).spacing == 1e-9


def test_distances_beyond_double() -> None:
    assert find_positions([[-1.7e308, 0], [1.7e308, 0], [0, 1e300]]).spacing == 1.7e308
    assert find_positions([[-1.7e308, 0], [1.7e308, 0]]).spacing == math.inf


def test_rows_that_are_not_finite_are_left_out() -> None:
    positions = find_positions([[0, 0], [np.nan, 0], [3, 0], [0, np.inf], [0, 4], [3, 0]])
    assert (positions.count, positions.spacing) == (3, 3.0)
    assert positions.duplicates.tolist() == [[5, 2]]


def test_pieces_and_merges_agree_with_one_sort() -> None:
    rng = np.random.default_rng(4)
    along = rng.permutation(np.cumsum(rng.integers(1, 9, 1_200_000))).astype(float)
    gaps = np.diff(np.sort(along))
    nearest = np.minimum(np.append(gaps, np.inf), np.insert(gaps, 0, np.inf))
    falling = np.column_stack((along, -along))
    assert find_positions(falling).spacing == pytest.approx(np.sqrt(2) * np.median(nearest))


@pytest.mark.campaign
def test_a_summary_takes_a_small_multiple_of_a_triangulation() -> None:
    jobs = [[call, 10_000, family] for family in CLOUDS for call in ("summary", "triangulation")]
    found = instructions(*jobs)
    for family, whole, triangulation in zip(CLOUDS, found[::2], found[1::2], strict=True):
        assert whole < 4 * triangulation, family
