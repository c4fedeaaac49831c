"""Arrays of callers: rows that are used, what the kernel reads in place, and messages."""

from __future__ import annotations

import numpy as np
import pytest

from liftmesh import InputError, UnsupportedTypeError
from liftmesh.base.arrays import (
    as_floats,
    is_readable,
    lower_to,
    no_array,
    of_one_array,
    unmasked,
    used_rows,
)
from liftmesh.base.cloud import is_crs


def test_used_rows_are_corners_of_triangles() -> None:
    assert used_rows(5, np.array([[4, 0, 1], [4, 1, 0]])).tolist() == [0, 1, 4]


@pytest.mark.parametrize("values", [np.arange(50.0), np.arange(50.0)[::-1], np.arange(50) % 7])
def test_numbers_are_lowered_to_the_least_of_their_values(values: np.ndarray) -> None:
    rows, least, expected = np.arange(50) % 3, np.full(4, 5.0), np.full(4, 5.0)
    np.minimum.at(expected, rows, values)
    lower_to(least, rows, values)
    np.testing.assert_array_equal(least, expected)


def test_rows_with_strides_in_whole_items_are_read_in_place() -> None:
    assert is_readable(np.zeros((4, 2))[::-1])
    assert not is_readable(np.zeros((4, 20), np.uint8)[:, :16].view(np.float64))


def test_masked_entries_are_nan() -> None:
    np.testing.assert_array_equal(unmasked(np.ma.masked_equal([1, 2], 2)), [1.0, np.nan])
    assert unmasked(np.ma.masked_equal([1, 2], 3)).dtype.kind == "i"


def test_what_float64_does_not_hold_is_named_with_its_values() -> None:
    with pytest.raises(InputError, match=r"^row 1 holds 1152921504606846977 in weights, which"):
        as_floats(np.array([1, 2**60 + 1]), "weights")


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (
            {"X": [0], "Y": [2]},
            "are a dict: give an array, np.column_stack([points['X'], points['Y']])",
        ),
        (iter([[0, 1]]), "are a list_iterator, which has no length: give list(points)"),
        ({(0, 1)}, "are a set, which has no order: give a list of rows"),
        (None, "are None: give an array with one row per point"),
    ],
)
def test_messages_say_how_to_make_points(points: object, message: str) -> None:
    assert str(no_array(points)).startswith(f"points {message}")


def test_columns_are_not_taken_for_options() -> None:
    with pytest.raises(UnsupportedTypeError, match=r"give np\.column_stack\(\[x, y\]\)$"):
        of_one_array(lambda *points: points)([0, 1], [2, 3])


def test_a_system_is_a_text_that_is_not_empty() -> None:
    assert [is_crs(each) for each in ("EPSG:25832", 25832, "", "a\0")] == [
        True,
        False,
        False,
        False,
    ]
