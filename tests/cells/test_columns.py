"""Values that go with cells, in tables and files."""

from __future__ import annotations

import io
import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import liftmesh
from liftmesh import FormatError, InputError
from liftmesh.cells.files import (
    columns_of,
    common_crs,
    format_of,
    frame_of,
    free_name,
    plain_columns,
)


def test_our_columns_take_no_name_of_the_callers() -> None:
    assert free_name("area", ["height"]) == "area"
    assert free_name("area", ["Area", "cell_area"]) == "cell_cell_area"


def test_files_hold_one_number_or_text_each() -> None:
    kept, dropped = plain_columns({"pair": np.zeros((3, 2)), "wave": np.zeros(3, complex)})
    assert [*kept] == ["pair_0", "pair_1"]
    assert dropped == ("wave (complex128)",)
    with pytest.raises(InputError, match="two columns are named 'pair_0': rename one"):
        plain_columns({"pair_0": np.zeros(3), "pair": np.zeros((3, 2))})


def test_values_become_a_table() -> None:
    assert frame_of({"height": [1.5, 2.5]}, 2)["height"].tolist() == [1.5, 2.5]
    with pytest.raises(InputError, match="column 'height' has 1 value for 2 rows"):
        frame_of({"height": [1.5]}, 2)
    with pytest.raises(InputError, match="data is 'height': give a mapping"):
        frame_of("height", 2)


def test_one_coordinate_system() -> None:
    assert common_crs({}, "EPSG:25832") == "EPSG:25832"
    assert common_crs({}, None, "EPSG:25832") == "EPSG:25832"
    with pytest.raises(InputError):
        common_crs({}, "EPSG:25832", "EPSG:25833")


def test_columns_of_one_type_are_arrays() -> None:
    table = pd.DataFrame({"name": ["a", "b"], "mixed": [1, "b"], 3: [1.5, 2.5], "some": [1, None]})
    found = columns_of(table, 2)
    assert {name: values.dtype.kind for name, values in found.items()} == {
        "name": "U", "mixed": "O", "3": "f", "some": "f",
    }  # fmt: skip
    assert columns_of(None, 2) == {}
    with pytest.raises(InputError, match="column 'name' has 2 values for 3 rows"):
        columns_of(table, 3)


def test_formats_by_suffix_and_by_name() -> None:
    assert (format_of(Path("schools.GeoJSON")), format_of("", ".SVG")) == ("geojson", "svg")
    with pytest.raises(FormatError, match=r"cells.stl: cells are not written as '\.stl': give one"):
        format_of(Path("cells.stl"))
    with pytest.raises(FormatError, match=r"^cells are not written as 'stl'"):
        format_of("cells.ply", "stl")
    with pytest.raises(FormatError, match="<stream>: cells are not written as ''"):
        format_of(io.BytesIO())


def test_geojson_has_closed_rings_and_nulls() -> None:
    stream = io.BytesIO()
    cells = liftmesh.voronoi([[3, 4]], domain=(2, 3, 4, 5))
    written = cells.save(stream, {"height": [np.inf]}, format="geojson")
    assert written.dropped == ("height (1 infinite)",)
    (feature,) = json.loads(stream.getvalue())["features"]
    assert feature["properties"] == {"row": 0, "height": None, "area": 4.0}
    assert feature["geometry"]["coordinates"] == [
        [[2.0, 3.0], [4.0, 3.0], [4.0, 5.0], [2.0, 5.0], [2.0, 3.0]]
    ]


def test_svg_has_a_path_for_each_row_with_an_area() -> None:
    stream = io.BytesIO()
    cells = liftmesh.voronoi([[0, 0], [2, 0], [2, 0]])
    written = cells.save(stream, {"height": np.ones(3)}, format="svg", crs="EPSG:25832")
    assert (written.dropped, written.renamed) == (("height", "crs"), ())
    assert stream.getvalue().count(b"<path") == 2


def test_ply_holds_no_texts() -> None:
    cells = liftmesh.voronoi([[0, 0], [2, 0]], domain=(-1, -1, 3, 1))
    written = cells.save(io.BytesIO(), {"name": ["a", "b"]}, format="ply")
    assert written.dropped == ("name (not numbers)",)
