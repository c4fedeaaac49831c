"""Sides of the cells of disks, and where they meet."""

from __future__ import annotations

import numpy as np
import pytest

from liftmesh import InputError, NonFiniteError
from liftmesh.disks.apollonius import as_max_deviation
from liftmesh.disks.graph import are_finite, as_disks
from liftmesh.disks.sides import (
    Sides,
    Traced,
    arcs_of,
    differences_of,
    merge_coinciding,
    pieces_in,
    shares_in,
    sides,
    vertices_of,
)

BOX = (0, 0, 1, 1)
NO_ENDS = np.array([[-1, -1]], dtype=np.int32)


def test_disks_are_rows_of_three_numbers() -> None:
    assert as_disks([[0, 1]], [2]).tolist() == [[0, 1, 2]]
    assert are_finite(np.array([[0, 1, 2], [0, np.inf, 2]])).tolist() == [True, False]
    with pytest.raises(NonFiniteError, match="row 0 has the radius inf: remove such rows first"):
        as_disks([[0, 1]], [np.inf], skippable=False)


def test_what_is_outside_of_a_box_is_cut_off() -> None:
    line = np.array([[-1.0, 0.5], [3.0, 0.5]])
    first, last = shares_in(line[:1], line[1:], BOX)
    assert (first.tolist(), last.tolist()) == ([0.25], [0.5])
    side = Traced(np.array([[1, 0]]), NO_ENDS, np.array([0, 2]), line, BOX)
    assert [(pair, piece.tolist()) for pair, piece in pieces_in(side)] == [
        ((0, 1), [[0.0, 0.5], [1.0, 0.5]])
    ]


def test_vertices_that_only_rounding_keeps_apart_are_one() -> None:
    side = Sides(np.array([[0, 1]]), np.array([[1, 0]]))
    near = np.array([[1.0, 0], [1 + 2**-52, 0]])
    assert merge_coinciding(side, np.zeros((2, 2)), near).tolist() == [[1, 0], [1, 0]]
    apart = np.array([[1.0, 0], [1.001, 0]])
    assert merge_coinciding(side, np.zeros((2, 2)), apart).tolist() == apart.tolist()


def test_arcs_are_seen_from_the_smaller_disk() -> None:
    hull = np.array([[0, 1], [1, 0]], dtype=np.int32)
    none = np.zeros((0, 3), dtype=np.int32)
    both = sides(none, none, hull)
    assert (both.pairs.tolist(), both.ends.tolist()) == ([[0, 1]], [[-1, -1]])
    assert arcs_of(both, np.array([[0, 0, 0.5], [2, 0, 0]]), np.zeros((0, 2))).rows.tolist() == [
        [1, 0]
    ]


def test_cells_meet_in_the_centre_of_a_circle() -> None:
    disks, three = np.array([[0.0, 0, 1], [4, 0, 1], [0, 4, 1]]), np.array([[0, 1, 2]])
    roughly = np.array([[2.1, 1.9, 1.7]])
    np.testing.assert_allclose(vertices_of(disks, three, roughly), [[2, 2]], rtol=1e-15)


def test_powers_of_disks_nearly_inside_others_keep_their_digits() -> None:
    disks = np.array([[0, 0, 1.0], [3, 4, 1.0], [2**-30, 0, 1 - 2**-30 + 2**-52]])
    _, powers = differences_of(disks, np.array([1, 2]), np.array([0, 0]))
    assert powers[0] == 25
    assert abs(powers[1] / (2**-81 - 2**-104) - 1) < 1e-15


def test_tolerances_of_chords() -> None:
    assert as_max_deviation(0.5, BOX) == 0.5
    assert as_max_deviation(1e300, (0, 0, 1, 2)) == 2


@pytest.mark.parametrize(
    ("max_deviation", "message"),
    [
        ("wide", "max_deviation is 'wide': give a positive, finite number"),
        (True, "max_deviation is True: give a positive, finite number"),
        (0, "max_deviation is 0: give a positive, finite number"),
        (1e-20, "max_deviation is 1e-20, near the rounding of coordinates there: give"),
    ],
)
def test_what_is_no_tolerance_is_refused(max_deviation: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        as_max_deviation(max_deviation, BOX)  # type: ignore[arg-type]
