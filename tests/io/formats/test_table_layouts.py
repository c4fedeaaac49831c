"""Tables in any layout: no order, name, mark, quote, encoding or line end changes a value."""

from __future__ import annotations

import io
from typing import Any, NamedTuple

import numpy as np
from file_samples import assert_same_bits
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays

import liftmesh

FINITE = st.floats(allow_nan=False, allow_infinity=False)
HEADERS = [
    ("x", "y", "z"),
    ("POINT_X", "POINT_Y", "Elev."),
    ("E", "N", "Höhe"),
    ("X [m]", "Y [m]", "Z [m]"),
    ("Rechtswert", "Hochwert", "Altitude"),
]
WORDS = ["oak", "a b", "2019-05-01", ""]


class Table(NamedTuple):
    """The values of x, y, z and another column, and a file that holds them in some layout."""

    values: np.ndarray
    data: bytes
    options: dict[str, Any]


@st.composite
def tables(draw: st.DrawFn) -> Table:
    """Draw values, and how a program might write them, with a column of text among them."""
    values = draw(arrays(np.float64, st.tuples(st.integers(1, 5), st.just(4)), elements=FINITE))
    order = draw(st.permutations(range(5)))
    mark, decimal = draw(st.sampled_from([",.", ";.", ";,", "\t.", "\t,", "|,", "|."]))
    quote = draw(st.sampled_from(["", '"']))
    rows: list[list[str]] = [[*draw(st.sampled_from(HEADERS)), "class", "name"]]
    for row in values.tolist():
        word = draw(st.sampled_from(WORDS)) if len(rows) > 1 else "first"
        rows.append([*(repr(value).replace(".", decimal) for value in row), word])
    lines = [mark.join(f"{quote}{row[k]}{quote}" for k in order) for row in rows]
    text = draw(st.sampled_from(["\n", "\r\n", "\r"])).join(lines)
    # Without it, commas that may separate thousands are refused.
    options = {"decimal": ","} if decimal == "," else {}
    return Table(values, text.encode(draw(st.sampled_from(["utf-8", "utf-16"]))), options)


@given(tables())
def test_no_layout_changes_a_value(table: Table) -> None:
    cloud = liftmesh.read(io.BytesIO(table.data), format="csv", nodata="none", **table.options)
    assert_same_bits(cloud.points, np.ascontiguousarray(table.values[:, :3]))
    assert_same_bits(cloud.attributes["class"], np.ascontiguousarray(table.values[:, 3]))
    assert cloud.metadata["not_read"] == ("column name (text, line 2: 'first')",)
