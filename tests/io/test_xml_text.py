"""Texts in XML: which it can hold, and how they are written."""

from __future__ import annotations

import pytest

from liftmesh.io.markup import attribute, is_possible


@pytest.mark.parametrize(
    ("text", "is_there"),
    [("a < b", True), ("tab\t", True), ("bell \x07", False), ("\ud800", False)],
)
def test_characters_that_xml_holds(text: str, is_there: bool) -> None:
    assert is_possible(text) == is_there


def test_attributes_of_xml_are_in_quotation_marks() -> None:
    assert attribute('say "a"\n') == '"say &quot;a&quot;&#10;"'
