"""Options with a fixed set of values, switches, counts and callbacks: what is refused, and how."""

from __future__ import annotations

import copy
import multiprocessing
import pickle
import warnings
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest

from liftmesh import InputError
from liftmesh.base.options import (
    NonFinite,
    as_count,
    as_distance,
    as_positive,
    as_switch,
    check_option,
    check_progress,
    refused,
)
from liftmesh.errors import DataWarning, Message, NonFiniteError, Option


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


def test_numbers_are_refused_with_the_option_the_value_and_the_reason() -> None:
    for value in (0, -1.5, float("nan"), float("inf"), "2", None, True, np.bool_(True), 1j, [1]):
        with pytest.raises(InputError, match=r"^cell is .*: give a positive number$") as raised:
            as_positive("cell", value)
        assert raised.value.option == "cell"
        assert raised.value.value is value
        assert raised.value.reason == "give a positive number"
    assert as_positive("cell", np.float32(0.5)) == 0.5
    assert as_distance("gap", 0) == 0
    with pytest.raises(InputError, match=r"^gap is -1: give 0 or a positive number$"):
        as_distance("gap", -1)


def test_errors_keep_their_fields_in_copies_and_in_other_processes() -> None:
    error = refused("by", "x", f"give {Option('by', 'name')}").within("a.shp")
    error.__notes__ = ["a note"]  # type: ignore[attr-defined]
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
        sent = pool.submit(_same, error).result()
    for each in (copy.copy(error), copy.deepcopy(error), pickle.loads(pickle.dumps(error)), sent):
        assert (type(each), str(each)) == (InputError, "a.shp: by is 'x': give by='name'")
        assert each.message.parts == error.message.parts
        assert (each.option, each.value, each.reason) == ("by", "x", "give by='name'")
        assert each.__notes__ == ["a note"]


def _same(error: InputError) -> InputError:
    return error


def test_a_value_that_cannot_be_sent_is_its_text() -> None:
    error = refused("progress", lambda: 0, "give a function of the fraction done")
    sent = pickle.loads(pickle.dumps(error))
    assert callable(error.value)
    assert sent.value == repr(error.value)
    row = pickle.loads(pickle.dumps(NonFiniteError(f"give {Option('nonfinite', 'skip')}", row=3)))
    assert (row.row, str(row)) == (3, "give nonfinite='skip'")


def test_messages_know_where_they_name_options() -> None:
    message = Message(f"a: {Option('band')} is 3: give {Option('band', ...)} or {Option('x', 2)}")
    assert message == "a: band is 3: give band= or x=2"
    assert [each for each in message.parts if isinstance(each, Option)] == [
        Option("band"), Option("band", ...), Option("x", 2),
    ]  # fmt: skip
    assert Message(message.marked).parts == message.parts
    assert message.renamed({"band": "layer"}) == "a: layer is 3: give layer= or x=2"
    assert Message("\ufdd0what\ufdd1 is in a file") == "what is in a file"
    with pytest.warns(DataWarning, match="^give unit=$"):
        warnings.warn(f"give {Option('unit', ...)}", DataWarning, stacklevel=1)
