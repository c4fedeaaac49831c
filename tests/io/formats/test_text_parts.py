"""Parts of tables as text: lines, values, headers, and what messages tell."""

from __future__ import annotations

import io

import pytest

from liftmesh.errors import FormatError, Message
from liftmesh.io.formats.text.column_ambiguity import _names, check_count, named_points
from liftmesh.io.formats.text.columns import known_header
from liftmesh.io.formats.text.layout import (
    Layout,
    as_utf8,
    before_remark,
    may_be_grouped,
    skip_lines,
    sniff,
    stated_separator,
    with_point,
    without_remark,
)
from liftmesh.io.options import TableOptions, spelled


def test_lines_are_skipped_whatever_ends_them() -> None:
    stream = io.BytesIO(b"one\r\ntwo\rthree\nfour")
    skip_lines(stream, 3, "points.txt")
    assert stream.read() == b"four"
    with pytest.raises(FormatError, match="has 4 lines, and skip_rows=5 skips more"):
        skip_lines(io.BytesIO(b"\n\n\n\n"), 5, "points.txt")


def test_utf_16_becomes_utf_8() -> None:
    assert as_utf8(io.BytesIO("x;y".encode("utf-16")), "points.csv").read() == b"x;y"
    assert as_utf8(io.BytesIO(b"\xef\xbb\xbfx;y"), "points.csv").read() == b"x;y"


def test_the_layout_of_a_header() -> None:
    layout = sniff("X [m];Y [m]", "", "a.csv: line 1", TableOptions())
    assert layout == Layout(";", 2, ("X [m]", "Y [m]"), in_first_line=True)


@pytest.mark.parametrize(("line", "mark"), [("sep=;", ";"), ('"sep=,"', ","), ("x;y", None)])
def test_the_separator_that_a_spreadsheet_states(line: str, mark: str | None) -> None:
    assert stated_separator(line) == mark


def test_comments_behind_rows() -> None:
    assert (before_remark("1 2 3 # a, b"), before_remark("Pt #,X,Y,Z")) == (True, False)
    texts = ["1,2 # a, b", "1,2,No #3", '1,"a # b"']
    assert [*map(without_remark, texts)] == ["1,2", "1,2,No #3", '1,"a # b"']


def test_decimal_commas() -> None:
    texts = ["-1,5", "1.5", "1,234,567", "1,5e3"]
    assert [*map(with_point, texts)] == ["-1.5", "", "", "1.5e3"]
    assert [*map(may_be_grouped, ["1,234", "4512345,123", "1,5"])] == [True, False, False]


def test_known_headers() -> None:
    assert (known_header(["E", "N", "2019"]), known_header(["P1", "4.5", "7"])) == (True, False)


def test_options_as_messages_spell_them() -> None:
    assert Message(spelled(["X", "Y", "Scalar field"])) == "columns='X,Y,Scalar field'"
    assert spelled(["X", "Depth, m"]) == ""
    assert _names(["id", "x", "y", "z"], 5) == "id,x,y,z,column_5"
    assert _names(["id", "x", "y", "z"], 50) == "x=2,y=3,z=4"
    usual = "read it with columns='id,x,y,z' (or 'id,y,x,z' if northing comes first)"
    assert Message(named_points(4)) == usual


def test_a_number_by_itself_may_be_a_count() -> None:
    check_count("2", "3", "a.xyz: line 1")
    cause = r"line 1 is the number 2 by itself, .*: if it is no row, read it with skip_rows=1$"
    with pytest.raises(FormatError, match=cause):
        check_count("2", "0.5 1.5 7", "a.xyz: line 1")
    with pytest.raises(FormatError, match="skip_rows=1 and columns='x,y,z'"):
        check_count("2", "0.5 1.5 7", "a.xyz: line 1", ["x", "y", "z"])
