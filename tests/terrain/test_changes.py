"""Colours, normals and named values that are given apart from the points."""

from __future__ import annotations

import numpy as np
import pytest

from liftmesh import Cloud, InputError
from liftmesh.terrain.changes import as_parts, with_parts


def test_parts_become_arrays() -> None:
    parts = as_parts({"normals": [[0, 0, 1]], "attributes": {"class": [2]}, "crs": None})
    assert parts["normals"].tolist() == [[0, 0, 1]]
    assert parts["attributes"]["class"].tolist() == [2]
    assert parts["crs"] is None


def test_named_values_are_added() -> None:
    cloud = Cloud(np.zeros((1, 3)), attributes={"a": np.array([1])})
    changed = with_parts(cloud, {"crs": "EPSG:25832", "attributes": {"b": [2]}, "colors": None})
    assert (changed.crs, [*changed.attributes]) == ("EPSG:25832", ["a", "b"])
    assert with_parts(cloud, {"crs": None}) is cloud


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"colors": [1, 2, 3]}, r"colors need the shape \(n, 3\) or \(n, 4\) and numbers"),
        ({"attributes": [1]}, "attributes are a list: give a dict"),
        ({"attributes": {"a": 1}}, "attribute 'a' is 1: give an array"),
    ],
)
def test_what_is_no_part_is_refused(given: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        as_parts(given)
