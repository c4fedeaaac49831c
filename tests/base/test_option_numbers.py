"""Numbers as options: checked, as decimals, and in messages."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from liftmesh import InputError
from liftmesh.base.arrays import as_decimal, starts_of_runs
from liftmesh.base.options import as_number, as_positive, as_thousands


def test_a_number_is_the_decimal_it_is_printed_as() -> None:
    assert as_decimal(0.1) == Fraction(1, 10)
    assert as_decimal(np.float64(0.6)) / as_decimal(0.2) == 3
    for value in (float("inf"), float("nan")):
        with pytest.raises(ValueError, match="no finite number"):
            as_decimal(value)


@pytest.mark.parametrize(
    "value", [0, -1, float("inf"), float("nan"), "4", None, [1, 2], 10**400, True]
)
def test_what_is_no_positive_number_is_refused(value: object) -> None:
    with pytest.raises(InputError, match=r"^length is .*: give a positive length$"):
        as_positive("length", value, "a positive length")


def test_numbers_of_any_type_are_floats() -> None:
    assert as_number("level", np.int8(-3), "a finite height") == -3.0
    assert as_number("level", Fraction(1, 2), "a finite height") == 0.5
    assert as_number("length", float("inf"), "a length", lambda length: length > 0) == float("inf")


def test_large_counts_are_short() -> None:
    assert [as_thousands(12345), as_thousands(3 * 10**40)] == ["12,345", "3e+40"]


def test_runs_begin_where_a_row_differs() -> None:
    rows = np.array([[0, 1], [0, 1], [0, 2], [0, 1]])
    assert starts_of_runs(rows).tolist() == [True, False, True, True]
    assert starts_of_runs(rows[:0]).tolist() == []
