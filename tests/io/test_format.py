"""What formats declare, and functions that are imported at the first call."""

from __future__ import annotations

import inspect
import pickle

import pytest

from liftmesh.io.format import LazyFunction, dropped_values


def test_a_function_is_imported_at_the_first_call() -> None:
    lazy = LazyFunction("fractions", "gcd_of_nothing")
    assert repr(lazy) == "fractions.gcd_of_nothing"
    with pytest.raises(AttributeError):
        lazy(1)
    assert LazyFunction("math", "sqrt")(4.0) == 2.0


def test_a_function_stands_for_itself() -> None:
    lazy = LazyFunction("textwrap", "dedent")
    again = pickle.loads(pickle.dumps(lazy))
    assert again == lazy
    assert hash(again) == hash(lazy)
    assert lazy != LazyFunction("textwrap", "indent")
    assert [*inspect.signature(lazy).parameters] == ["text"]


@pytest.mark.parametrize(("name", "told"), [("size", "size"), ("alpha", "alpha (values)")])
def test_values_with_the_name_of_a_part_are_told_apart(name: str, told: str) -> None:
    assert dropped_values(name) == told
