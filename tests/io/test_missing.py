"""Marks of missing values, as the caller gives them."""

from __future__ import annotations

import pytest

from liftmesh.errors import InputError
from liftmesh.io.options import as_missing


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ("-9999.0", (-9999.0,)),
        (-32768, (-32768.0,)),
        (" n/a ", ("n/a",)),
        ("none", ()),
        (None, None),
    ],
)
def test_numbers_in_any_notation_and_texts(value: object, expected: object) -> None:
    assert as_missing(value) == expected


@pytest.mark.parametrize("value", [True, b"1", "", float("nan"), [1]])
def test_what_is_neither_is_refused(value: object) -> None:
    with pytest.raises(InputError, match="nodata is"):
        as_missing(value)
