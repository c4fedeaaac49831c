"""Columns of clouds: their types in text, those that belong together, coordinates, selections."""

from __future__ import annotations

import numpy as np
import pytest

from liftmesh.errors import FormatError
from liftmesh.io.columns import taken_points, taken_together, type_in_text
from liftmesh.io.format import checked_origin
from liftmesh.io.metadata import Provenance
from liftmesh.io.selection import class_column


def test_coordinates_of_text_are_doubles() -> None:
    single = np.dtype("f4")
    assert (type_in_text("x", single), type_in_text("red", single)) == (np.float64, single)
    assert type_in_text("x", np.dtype("i4")) == np.int32


def test_columns_that_belong_together_are_taken_if_all_are_there() -> None:
    columns = {each: np.arange(2.0) for each in ("nx", "ny", "nz", "x")}
    assert taken_together(columns, ("nx", "red")) is None
    assert taken_together(columns, ("nx", "ny", "nz")).tolist() == [[0] * 3, [1] * 3]  # type: ignore[union-attr]
    assert taken_points(columns, 2).tolist() == [[0, 0, 0], [1, 0, 0]]
    assert columns == {}


def test_the_origin_of_a_file_is_three_finite_numbers() -> None:
    assert checked_origin([450000, 5200000.5, 0], "a.glb") == (450000.0, 5200000.5, 0.0)
    with pytest.raises(FormatError, match=r"a\.glb: the origin is 'x', 1: expected three finite"):
        checked_origin(["x", 1], "a.glb")


def test_the_column_of_classes_is_one_of_numbers() -> None:
    assert class_column({"Class": np.array([2, 5])}) == "Class"
    assert class_column({"class": np.array(["a", "b"])}) is None


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        ({"rows": 9, "selected": 3, "every": 6}, {"rows": 9, "selected": 3, "every": 6}),
        ({"rows": 9, "selected": "3"}, {}),
        ({"rows": 9}, {}),
        ("of mine", {}),
    ],
)
def test_only_a_readers_counts_are_a_selection(said: object, expected: object) -> None:
    assert Provenance({"selection": said}).selection == expected
