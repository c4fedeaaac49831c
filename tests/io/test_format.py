"""What formats declare, and functions that are imported at the first call."""

from __future__ import annotations

import inspect
import io
import pickle
import re
from pathlib import Path

import pytest

import liftmesh
from liftmesh import read
from liftmesh.io.format import LazyFunction, dropped_values
from liftmesh.io.formats import FORMATS


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


def test_page_and_docstring_name_every_format() -> None:
    root = Path(liftmesh.__file__).parents[1]
    page = (root / "docs/guide/formats.md").read_text("utf-8")
    for each in FORMATS:
        words = "|".join({each.name, *(suffix[1:] for suffix in each.suffixes)})
        for text in [page, *([read.__doc__ or ""] if each.read else [])]:
            assert re.search(rf"\b({words})\b", text, re.IGNORECASE), (each.name, text[:30])


@pytest.mark.parametrize(
    ("kind", "taken"), [("ply", "encoding, colors, comments"), ("off", "no options")]
)
def test_an_option_that_a_format_does_not_have(kind: str, taken: str) -> None:
    with pytest.raises(liftmesh.FormatError, match=f"'colour': {kind} takes {taken}$"):
        liftmesh.write(io.BytesIO(), [[0, 0, 0.0]], format=kind, colour=1)
