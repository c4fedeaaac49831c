"""The row used as the vertex where several share a planar position, against plain Python."""

from __future__ import annotations

import sys
from fractions import Fraction
from typing import get_args

import numpy as np
import pytest
from hypothesis import given, strategies as st

from liftmesh.base.options import OnDuplicate
from liftmesh.errors import DuplicateHeightError, InputError
from liftmesh.terrain.equal_positions import choose_rows

CHOOSING = [policy for policy in get_args(OnDuplicate) if policy != "error"]

heights_of_few_values = st.sampled_from([-1.0, -0.0, 0.0, 0.1, 0.2, 2.5, 1e300, -1e308, 1.7e308])
clouds = st.lists(
    st.tuples(st.integers(0, 4), heights_of_few_values | st.floats(-1e6, 1e6)), max_size=24
)


def pairs_of(positions):
    """(row, lowest row of the same position) for every row but the lowest."""
    first = {}
    for row, position in enumerate(positions):
        first.setdefault(position, row)
    found = [(row, first[p]) for row, p in enumerate(positions) if first[p] != row]
    return np.array(found, dtype=np.int32).reshape(-1, 2)


def groups_of(positions):
    groups = {}
    for row, position in enumerate(positions):
        groups.setdefault(position, []).append(row)
    return [rows for rows in groups.values() if len(rows) > 1]


def chosen_of(rows, heights, policy):
    if policy == "last":
        return rows[-1]
    if policy == "lowest":
        return min(rows, key=lambda row: (heights[row], row))
    if policy == "highest":
        return min(rows, key=lambda row: (-heights[row], row))
    return rows[0]


def exact_mean(rows, heights):
    values = {Fraction(heights[row]) for row in rows}
    return sum(values) / len(values)


def choose(positions, heights, policy):
    heights = np.array(heights, dtype=np.float64)
    planar = np.column_stack([positions, np.zeros(len(heights))]).astype(np.float64)
    return choose_rows(pairs_of(positions), heights, planar, policy)


@pytest.mark.parametrize("policy", CHOOSING)
@given(cloud=clouds)
def test_chosen_rows_are_those_of_the_policy(policy, cloud):
    positions, heights = [row[0] for row in cloud], [row[1] for row in cloud]
    choice = choose(positions, heights, policy)
    groups = groups_of(positions)
    expected = {rows[0]: chosen_of(rows, heights, policy) for rows in groups}
    assert choice.kept.tolist() == sorted(expected)
    assert choice.chosen.tolist() == [expected[kept] for kept in sorted(expected)]
    left = {row: expected[rows[0]] for rows in groups for row in rows if row != expected[rows[0]]}
    assert choice.left_out.tolist() == sorted(left)
    assert choice.representatives.tolist() == [left[row] for row in sorted(left)]
    overhanging = [heights[row] != heights[left[row]] for row in sorted(left)]
    assert choice.overhanging.tolist() == overhanging


@given(cloud=clouds)
def test_means_are_those_of_the_different_heights(cloud):
    positions, heights = [row[0] for row in cloud], [row[1] for row in cloud]
    choice = choose(positions, heights, "mean")
    several = [
        rows for rows in groups_of(positions) if len({Fraction(heights[row]) for row in rows}) > 1
    ]
    assert choice.moved.tolist() == sorted(rows[0] for rows in several)
    means = dict(zip(choice.moved.tolist(), choice.new_heights.tolist(), strict=True))
    for rows in several:
        values = [heights[row] for row in rows]
        exact, mean = exact_mean(rows, heights), means[rows[0]]
        assert min(values) <= mean <= max(values)
        tolerance = 1e-15 * max(abs(value) for value in values)
        assert abs(Fraction(mean) - exact) <= Fraction(tolerance)


@pytest.mark.parametrize("policy", [policy for policy in CHOOSING if policy != "mean"])
def test_only_the_mean_moves_a_row(policy):
    choice = choose([0, 0, 1], [1.0, 2.0, 3.0], policy)
    assert len(choice.moved) == len(choice.new_heights) == 0


def test_the_mean_of_two_heights_is_rounded_once():
    rng = np.random.default_rng(1)
    for low, high in rng.normal(0, 1e3, (200, 2)):
        assert choose([0, 0], [low, high], "mean").new_heights.tolist() == [(low + high) / 2]


@pytest.mark.parametrize(
    ("heights", "mean"),
    [
        ([1.0, 1.0, 4.0], 2.5),
        ([1.7e308, 1.6e308], 1.7e308 / 2 + 1.6e308 / 2),
        ([-1.7e308, 1.7e308], 0.0),
        ([1.7e308, 1.7e308, 0.0, -1.7e308], 0.0),
        ([5e-324, 1.5e-323], 1e-323),
        ([0.0, -0.0], None),
    ],
)
def test_means_at_the_ends_of_the_range(heights, mean):
    choice = choose([0] * len(heights), heights, "mean")
    assert choice.new_heights.tolist() == ([] if mean is None else [mean])


def test_huge_heights_leave_the_means_of_others_exact():
    choice = choose([0, 0, 1, 1], [1.7e308, 1e308, 5e-324, 1.5e-323], "mean")
    assert choice.new_heights.tolist() == [1.7e308 / 2 + 1e308 / 2, 1e-323]


def test_the_mean_of_many_heights_keeps_its_digits():
    heights = 5.0e6 + np.random.default_rng(2).random(100_000)
    distinct = np.unique(heights)
    exact = sum(map(Fraction, distinct.tolist())) / len(distinct)
    [mean] = choose([0] * len(heights), heights, "mean").new_heights.tolist()
    assert abs(Fraction(mean) - exact) <= Fraction(np.spacing(5.0e6))


def test_equal_heights_are_no_error_and_no_overhang():
    choice = choose([0, 1, 0, 0], [0.0, 1.0, -0.0, 0.0], "error")
    assert choice.chosen.tolist() == [0]
    assert choice.left_out.tolist() == [2, 3]
    assert not choice.overhanging.any()


def test_the_error_names_rows_position_heights_and_remedy():
    with pytest.raises(DuplicateHeightError) as caught:
        choose([7, 8, 8, 7, 8], [1.0, 0.1, 0.1, 3.0, 9.0], "error")
    assert caught.value.rows == (0, 3)
    message = str(caught.value)
    assert "rows 0 and 3 share the planar position (7.0, 0.0) at the heights 1.0 and 3.0" in message
    assert "on_duplicate='first', 'last', 'lowest', 'highest' or 'mean'" in message


@pytest.mark.parametrize("policy", get_args(OnDuplicate))
def test_no_shared_position(policy):
    choice = choose([0, 1, 2], [1.0, 2.0, 3.0], policy)
    for values in (
        choice.kept,
        choice.chosen,
        choice.left_out,
        choice.representatives,
        choice.moved,
    ):
        assert values.dtype == np.int32
        assert len(values) == 0


@pytest.mark.parametrize("policy", ["", "FIRST", "median", None])
def test_other_policies_are_refused(policy):
    with pytest.raises(InputError, match=r"on_duplicate is .*: give one of 'first', 'last'"):
        choose([0, 1, 2], [1.0, 2.0, 3.0], policy)


@pytest.mark.slow
@pytest.mark.parametrize("policy", CHOOSING)
@pytest.mark.parametrize("groups", [1, 500_000])
def test_a_million_rows_take_no_loop(policy, groups):
    count = 1_000_000
    rows = np.arange(groups, groups + count, dtype=np.int32)
    pairs = np.column_stack([rows, rows % groups]).astype(np.int32)
    heights = np.random.default_rng(3).random(groups + count)
    lines, tracing = 0, sys.gettrace()

    def look(*_):
        nonlocal lines
        lines += 1
        return look

    sys.settrace(look)
    try:
        choice = choose_rows(pairs, heights, np.zeros((groups + count, 2)), policy)
    finally:
        sys.settrace(tracing)
    assert 0 < lines < 1000
    assert len(choice.left_out) == count
