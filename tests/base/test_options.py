"""Options with a fixed set of values, switches, counts and callbacks: what is refused, and how."""

from __future__ import annotations

import pytest

from liftmesh import InputError
from liftmesh.base.options import NonFinite, as_count, as_switch, check_option, check_progress


def test_switches_are_truth_values_or_their_numbers() -> None:
    assert as_switch("copy", 1) is True
    assert as_switch("copy", False) is False
    with pytest.raises(InputError, match=r"^copy is 'no': give True or False$"):
        as_switch("copy", "no")


@pytest.mark.parametrize("value", [1.5, "2", True, None, 0, 10**400])
def test_counts_are_whole_numbers_within_their_bounds(value: object) -> None:
    with pytest.raises(InputError, match=r"^rows is .*: give a whole number from 1 to 9$"):
        as_count("rows", value, 1, 9)
    if value != 10**400:
        with pytest.raises(InputError, match=r"^rows is .*: give a whole number from 1$"):
            as_count("rows", value, 1)


def test_other_words_are_refused_with_those_that_are_known() -> None:
    with pytest.raises(InputError, match=r"^nonfinite is 'drop': give one of 'error', 'skip'$"):
        check_option("nonfinite", "drop", NonFinite)


def test_progress_is_a_function() -> None:
    check_progress(print)
    check_progress(None)
    with pytest.raises(InputError, match=r"^progress is True: give a function of the fraction"):
        check_progress(True)
