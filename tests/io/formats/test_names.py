"""Names of attributes in PLY and glTF, and the way back to the old ones."""

from __future__ import annotations

import numpy as np

from liftmesh.io.formats.gltf.reader import restored
from liftmesh.io.formats.ply.header import (
    depth_of_comments,
    depth_statement,
    name_statements,
    old_names,
    property_names,
)


def test_names_of_properties_come_back() -> None:
    names = property_names(["class", "Scan Angle", "x"], ["x", "y", "z"])
    assert names == {"class": "class", "Scan Angle": "Scan_Angle", "x": "x_1"}
    comments = [*name_statements(names), "by hand"]
    back = {"Scan_Angle": "Scan Angle", "x_1": "x"}
    assert old_names(comments, ["x", "class", "Scan_Angle", "x_1"]) == (back, ["by hand"])
    assert old_names(['property a_b "a b"', "by hand"], ["a_b"]) == ({"a_b": "a b"}, ["by hand"])


def test_the_depth_of_dark_colours_is_stated() -> None:
    dark = np.zeros((1, 3), dtype=np.uint16)
    assert depth_statement(dark) == ["color_depth 16"]
    assert depth_statement(dark.astype(np.uint8)) == []
    assert depth_of_comments(["a", "color_depth 16"], dark.dtype) == (16, ["a"])
    assert depth_of_comments(["color_depth 32"], dark.dtype) == (None, ["color_depth 32"])


def test_named_values_of_gltf_get_their_old_names_and_types() -> None:
    values = {"_ID": np.ones(1), "_AGE": np.full(1, 0.5), "_KIND": np.full(1, 0.5)}
    found = restored(values, {"_ID": ["id", "uint16"], "_KIND": ["kind", "uint8"]})
    assert {name: (each.dtype.name, *each) for name, each in found.items()} == {
        "id": ("uint16", 1), "AGE": ("float64", 0.5), "kind": ("float64", 0.5),
    }  # fmt: skip
