"""Values of JSON in files: numbers that are none, and texts that must be escaped."""

from __future__ import annotations

import pytest

from liftmesh.io.markup import (
    ascii_string,
    finite_numbers,
    parsed_or_none,
    shown_json,
    without_buffers,
)


@pytest.mark.parametrize(
    ("values", "count", "expected"),
    [
        ([1, 2.5], 2, [1.0, 2.5]),
        ([1, 2.5], 3, None),
        ([1, True], 2, None),
        ([1, "2"], 2, None),
        ([10**400], 1, None),
        ([float("inf")], 1, None),
        (7, 1, None),
    ],
)
def test_finite_numbers_are_no_texts_or_truth_values(
    values: object, count: int, expected: list[float] | None
) -> None:
    assert finite_numbers(values, count) == expected


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('{"a": 1}', {"a": 1}),
        (b'"\xc3\xa9"', "é"),
        (b'"\xe9"', None),
        ("{", None),
        ("[" * 9**5, None),
    ],
)
def test_text_that_is_no_json_is_nothing(text: str | bytes, expected: object) -> None:
    assert parsed_or_none(text) == expected


def test_a_string_is_written_in_printable_ascii() -> None:
    assert ascii_string("H\u00f6he\x7f") == '"H\\u00f6he\\u007f"'


def test_only_long_buffers_are_left_out() -> None:
    assert without_buffers(b'["data:' + b"A" * 10**6 + b'"]') == b'["]'
    short = b'["data:AAAA", 1]'
    assert without_buffers(short) is short


def test_values_of_messages_are_short() -> None:
    assert shown_json([[1, 2], "b", 3, 4, 5]) == "list, 'b', 3, 4"
    assert len(shown_json("a" * 1000)) <= 40
