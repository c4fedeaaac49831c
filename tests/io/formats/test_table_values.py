"""Values of tables: layouts, text, missing values, decimal commas, and what has two readings."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest

import liftmesh
from liftmesh import Cloud, FormatError
from liftmesh.io.formats.text.layout import _BYTES as BLOCK

POINTS = [[1.5, 2.5, 3.5], [4, 5, 6], [7, 8.25, 9]]


def read(text: str | bytes, **options: Any) -> Cloud:
    """Read a table whole; in chunks it must be the same."""
    data = text.encode() if isinstance(text, str) else text
    cloud = liftmesh.read(io.BytesIO(data), format="csv", **options)
    rows = max(2, len(cloud) // 3)
    chunks = [*liftmesh.read_chunks(io.BytesIO(data), format="csv", rows=rows, **options)]
    assert np.array_equal(np.concatenate([c.points for c in chunks]), cloud.points, equal_nan=True)
    for chunk in chunks:
        assert chunk.attributes.keys() == cloud.attributes.keys()
        assert chunk.metadata == cloud.metadata
    return cloud


def refused(text: str | bytes, **options: Any) -> str:
    with pytest.raises(FormatError) as caught:
        read(text, **options)
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "options"),
    [
        ("1,5;2,5;3,5\n4;5;6\n7;8,25;9\n", {}),
        ("X;Y;Z\n1,5;2,5;3,5\n4;5;6\n7;8,25;9\n", {}),
        ("4;5;6\n", {}),
        ("1,5\t2,5\t3,5\n4\t5\t6\n7\t8,25\t9\n", {}),
        ('"1,5","2,5","3,5"\n4,5,6\n7,"8,25",9\n', {}),
        ('"X";"Y";"Z"\n"1,5";"2,5";"3,5"\n4;5;6\n7;"8,25";9\n', {}),
        ("1,5 2,5 3,5\n4 5 6\n7 8,25 9\n", {"decimal": ","}),
        ("1|2,5|3\n", {}),
        ("1.5|2.5|3.5\n4|5|6\n7|8.25|9\n", {}),
        ("1.5:2.5:3.5\n4:5:6\n7:8.25:9\n", {"delimiter": ":"}),
        ('"1,5","2,5","3,5"\n4,5,6\n7,"8,25",9\n', {"decimal": ","}),
        ("1.5,2.5,3.5,12 30 5\n4,5,6,\n7,8.25,9,1 2 3\n", {}),
        ("sep=;\nX;Y;Z\n1,5;2,5;3,5\n4;5;6\n7;8,25;9\n", {}),
        ("X [m]   Y [m]  Z [m]\n1.5 2.5   3.5\n 4 5 6\n7 8.25 9\n", {}),
        ("Title, of 2019\nx,y,z\n1.5,2.5,3.5\n4,5,6\n7,8.25,9\n", {"skip_rows": 1}),
        ("Title\r\rx y z\r1.5 2.5 3.5\r4 5 6\r7 8.25 9\r", {"skip_rows": 2}),
        ("3\n1.5 2.5 3.5\n4 5 6\n7 8.25 9\n", {"skip_rows": 1}),
        ("1.5 2.5 3.5\n4 5 6\n7 8.25 9\nEND\n", {"end": "END"}),
        ("x;y;z\n1,5;2,5;3,5\n4;5;6\n7;8,25;9\nEND\n", {"end": "END"}),
    ],
)
def test_layouts(text: str, options: dict[str, Any]) -> None:
    points = read(text, **options).points.tolist()
    assert points in (POINTS, POINTS[1:2], [[1, 2.5, 3]])


@pytest.mark.parametrize("encoding", ["utf-16", "utf-8-sig", "utf-8"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_encodings(encoding: str, end: str) -> None:
    text = end.join(["Rechtswert;Hochwert;Höhe", "1,5;2,5;3,5", "4;5;6", "7;8,25;9", ""])
    assert read(text.encode(encoding)).points.tolist() == POINTS
    swapped = b"\xfe\xff" + text.encode("utf-16-be")
    assert read(swapped).points.tolist() == POINTS


def test_text_of_windows_is_read_by_its_encoding() -> None:
    data = "Rechtswert;Hochwert;Höhe\n1,5;2,5;3,5\n".encode("cp1252")
    assert "or if it is a table, read it with encoding='cp1252' (or cp1250 for" in refused(data)
    assert read(data, encoding="cp1252").points.tolist() == POINTS[:1]
    assert "damaged ascii" in refused(data, encoding="ascii")
    marked = "\ufeffx;y;z\n1,5;2,5;3,5\n".encode()
    assert read(marked, encoding="utf-8").points.tolist() == POINTS[:1]


def test_blank_values_are_missing_ones() -> None:
    cloud = read("x,y,z,w\n1.5,2.5,3.5,1\n4,5,,\n7, ,9,3\n")
    assert np.array_equal(
        cloud.points, [[1.5, 2.5, 3.5], [4, 5, np.nan], [7, np.nan, 9]], equal_nan=True
    )
    assert np.array_equal(cloud.attributes["w"], [1, np.nan, 3], equal_nan=True)
    with pytest.raises(liftmesh.NonFiniteError, match="row 1 is not finite"):
        liftmesh.triangulate(cloud)


def test_blank_values_at_the_ends_of_lines_between_tabs() -> None:
    cloud = read("x\ty\tz\tname\n1.5\t2.5\t3.5\ta\n\t5\t6\t\n7\t8.25\t\t\n")
    expected = [[1.5, 2.5, 3.5], [np.nan, 5, 6], [7, 8.25, np.nan]]
    assert np.array_equal(cloud.points, expected, equal_nan=True)


def test_columns_of_text_and_dates_are_left_out_and_named() -> None:
    cloud = read(
        'name,x,y,z,when,code,note\n"P, 1",1.5,2.5,3.5,2019-05-01,7,\n'
        'P2,4,5,6,2019-05-02,8,"a ""b"""\nP3,7,8.25,9,,9,\n'
    )
    assert cloud.points.tolist() == POINTS
    assert [*cloud.attributes] == ["code"]
    assert cloud.metadata["not_read"] == (
        "column name (text, line 2: 'P, 1')",
        "column when (text, line 2: '2019-05-01')",
        "column note (text, line 3: 'a \"b\"')",
    )


@pytest.mark.slow
def test_a_text_far_behind_the_first_block_leaves_out_the_whole_column() -> None:
    rows = "".join(f"{k % 7}.5,{k % 5},{k},{k}\n" for k in range(50_000))
    cloud = read(f"x,y,z,code\n{rows}1,2,3,A7\n")
    assert not cloud.attributes
    assert cloud.metadata["not_read"] == ("column code (text, line 50002: 'A7')",)
    assert len(cloud) == 50_001


def test_a_height_with_text_in_it_is_no_column_of_text() -> None:
    assert "line 3, value 3: 'low' is not a number" in refused("x,y,z\n1,2,3\n4,5,low\n")
    told = refused("x,y,z\n1,2,3\n4,5,NA\n")
    assert "if it stands for a missing value, read it with nodata='NA'" in told
    assert np.isnan(read("x,y,z\n1,2,3\n4,5,NA\n", nodata="NA").points[1, 2])
    assert "'GroundZ' holds numbers" in refused("x,y,GroundZ\n1,2,3\n4,5,NA\n")


def test_empty_columns_are_named() -> None:
    cloud = read("1.5,2.5,3.5,\n4,5,6,\n7,8.25,9,\n")
    assert cloud.points.tolist() == POINTS
    assert cloud.metadata["not_read"] == ("column column_4 (empty)",)


@pytest.mark.parametrize(
    ("header", "row", "name"),
    [
        ("Pt #,x,y,z", "7,1,2,3", "Pt #"),
        ("x,y,z,Scalar field #2", "1,2,3,7", "Scalar field #2"),
        ("x\ty\tz\tname\tw", "1\t2\t3\tNo #4\t7", "w"),
        ("x;y;z;name;w", '1;2;3;"a # b";7', "w"),
        ("x;y;z;w # all in metres", "1;2;3;7 # the first", "w"),
    ],
)
def test_a_hash_in_a_value_begins_no_comment(header: str, row: str, name: str) -> None:
    cloud = read(f"{header}\n{row}\n")
    assert cloud.points.tolist() == [[1, 2, 3]]
    assert {key: values.tolist() for key, values in cloud.attributes.items()} == {name: [7]}


def test_a_number_before_a_hash_is_text_and_no_number() -> None:
    cloud = read("x,y,z,flat,color\n1,2,3,12#A,#ff0000\n4,5,6,13,#00ff00\n")
    assert not cloud.attributes
    assert cloud.metadata["not_read"] == (
        "column flat (text, line 2: '12#A')",
        "column color (text, line 2: '#ff0000')",
    )


def test_comments_among_the_rows_are_counted() -> None:
    text = "# by hand\nx,y,z\n1,2,3\n#N/A,2,3\n\n// 7,8,9\n4,5,6\n"
    cloud = read(text)
    assert cloud.points.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert cloud.metadata["notes"] == ("comments among the rows, not read: 2, first in line 4",)
    assert "notes" not in read("# by hand\n// more\nx,y,z\n1,2,3\n").metadata


def test_comments_are_counted_in_every_block() -> None:
    rows = f"1,2,3\n#{'no' * 100}\n" * 20_000  # two blocks of bytes
    cloud = read("x,y,z\n" + rows)
    assert len(cloud) == 20_000
    told = "comments among the rows, not read: 20,000, first in line 3"
    assert cloud.metadata["notes"] == (told,)


def test_ids_that_doubles_round_are_told() -> None:
    cloud = read("x,y,z,id,big\n1,2,3,9007199254740993,1e300\n4,5,6,,\n")
    told = "column id: numbers from 2**53 on are rounded to doubles"
    assert cloud.metadata["notes"] == (told,)
    assert "notes" not in read("x,y,z,id\n1,2,3,9007199254740991\n").metadata


def test_quotes_that_are_not_closed_name_the_line() -> None:
    assert "line 3: its quotes are not closed" in refused('x,y,z,n\n1,2,3,a\n4,5,6,"b\n')
    assert "line 2: its quotes" in refused('x,y,z\n"1"2,2,3\n')


@pytest.mark.parametrize(
    ("text", "options", "readings"),
    [
        ("1,234;5,678;9,012\n", {}, ("'1,234' is 1.234 with", "or 1234 with", "decimal=','")),
        ("1,5;2;3\n4;5.5;6\n", {}, ("line 1 has a comma", "line 2 a point", "decimal='.'")),
        ("1.5;2;3\n4;5,5;6\n", {}, ("line 2 has a comma", "line 1 a point", "decimal=','")),
        ("1,5 2,5\n", {}, ("decimal comma, or two numbers", "decimal=','", "delimiter=','")),
        (
            "2\n1 2 3\n4 5 6\n",
            {},
            ("line 1 is the number 2", "a count of rows or a", "skip_rows=1"),
        ),
        (
            "1 2 3\n4 5 6\nEND\n",
            {},
            ("line 3: 'END' is a broken row", "marks the end", "end='END'"),
        ),
        ("//X Y Z R\n1\n1 2 3 4\n", {}, ("with skip_rows=2 and columns='X,Y,Z,R'",)),
        ("//X Y Z a=\n1\n1 2 3 4\n", {}, ("skip_rows=2 and columns= with the names above",)),
        ("1\nX Y Z R\n1 2 3 4\n", {}, ("if it is no row, read it with skip_rows=1",)),
        ("x,y,z\n1,2,3\n(1 row)\n", {}, ("(1 row)' is a broken row", "end='(1 row)'")),
        ("a|b\n--+--\n", {}, ("has no column x or y",)),
        ("x|y\n--+--\n", {}, ("line 2, value 1: '--+--' is not a number",)),
        ("x,y,z\n1,2,\\N\n", {}, ("a missing value, read it with nodata='\\\\N'",)),
        ("x;y\n512.345,25;1\n", {}, ("value 1: '512.345,25'", "the marks between thousands")),
        ("x;y\n1;5\u202f403,5\n", {}, ("value 2: '5\\u202f403,5'", "the marks between thous")),
        ("p,E,N\n,m,m\n1,2,3\n", {}, ("holds units", "skip_rows=2 and columns='p,E,N'")),
        ("1,north,2,3\n", {}, ("is not a number: there is no header", "columns='id,-,x,y,z'")),
        ("P1 1 2 3\n", {}, ("'P1' is not a number", "names the points", "columns='id,x,y,z'")),
    ],
)
def test_two_readings_are_refused_and_the_option_is_named(
    text: str, options: dict[str, Any], readings: tuple[str, ...]
) -> None:
    told = refused(text, **options)
    assert [each for each in readings if each not in told] == []


IDS = [
    "1,5.5,6.5,7\n2,5.25,6,8\n3,5,6,9\n",
    "101 5.5 6.5 7 4\n105 5.25 6 8 4\n230 5 6 9 4\n",
    "0 5.5 6.5\n1 5.25 6\n2 5 6\n",
    "1001 5.5 6.5 7\n12 5.25 6 8\n507 5 6 9\n3 5 6 9\n",
    "30,5.5,6.5,7,CP\n20,5.25,6,8,\n10,5,6,9,TREE\n",
]


@pytest.mark.parametrize("text", IDS)
def test_an_id_before_the_coordinates_is_refused_with_both_readings(text: str) -> None:
    told = refused(text)
    assert "there is no header, and the first column holds whole numbers that " in told
    assert "if an id, read it with columns='id,x,y" in told
    width = len(text.splitlines()[0].replace(",", " ").split())
    as_x = ",".join(["x", "y", "z", "a", "b"][:width])
    assert f"if x, with columns='{as_x[:5]}" in told
    first = float(text.replace(",", " ").split()[0])
    assert read(text, columns=as_x).points[0, 0] == first
    as_id = ",".join(["id", "x", "y", "z", "b"][:width])
    assert read(text, columns=as_id).attributes["id"][0] == first


@pytest.mark.parametrize(
    "text",
    [
        "0 0 5\n1 0 6\n2 1 7\n",
        "1 5.5 6.5 7\n2 5.25 6 8\n2 5 6 9\n",
        "1.5 5.5 6.5 7\n2.5 5.25 6 8\n3.5 5 6 9\n",
        "10 5.5 6.5\n20 5.25 6\n30 5 6\n",
        "30 5.5 6.5 7\n20 5.25 6 8\n30 5 6 9\n",
        "30 5.5 6 7\n20 5.25 6 8\n10 5 6 9\n",
        "1 2 3 4\n2 3 4 5\n",
    ],
)
def test_coordinates_that_grow_are_no_id(text: str) -> None:
    assert read(text).points[0, 0] == float(text.split(maxsplit=1)[0])


def test_ids_behind_the_coordinates_are_no_heights() -> None:
    rows = "512345.25 5403210.5 1\n512350.75 5403212 2\n512347 5403220.125 3\n"
    told = refused(rows)
    assert "the third column holds whole numbers that grow from 1 to 3, z or an id" in told
    assert "read it with columns='x,y,id', if z, with columns='x,y,z'" in told
    flat = read(rows, columns="x,y,id")
    assert flat.points[:, 2].tolist() == [0, 0, 0]
    assert flat.attributes["id"].tolist() == [1, 2, 3]
    assert read(rows, columns="x,y,z").points[:, 2].tolist() == [1, 2, 3]
    assert read(rows, flat=True).points[:, 2].tolist() == [0, 0, 0]
    assert read("0.5 5 1\n1.5 6 2\n2.5 7 3\n").points[:, 2].tolist() == [1, 2, 3]


@pytest.mark.parametrize("value", ["-9999", "-9999.0", "-32768", "1e20", "-3.4028234663852886e+38"])
@pytest.mark.parametrize("header", ["", "x,y,z\n"])
def test_marks_of_missing_values_are_refused_with_both_readings(value: str, header: str) -> None:
    text = f"{header}0.5,0,310\n1,0,{value}\n1,4,325\n2,3,{value}\n"
    told = refused(text)
    assert "in 2 of 4 rows, far from all others, a value or the mark of a missing one" in told
    shown = told.partition("nodata='")[2].partition("'")[0]
    assert float(shown) == float(value)
    gone = read(text, nodata=shown)
    assert np.isnan(gone.points[[1, 3], 2]).all()
    assert read(text, nodata="none").points[1, 2] == float(value)


def test_depths_near_a_mark_are_values() -> None:
    assert len(read("0.5 0 -9990\n1 0 -9999\n1 4 -10008\n2 3 -9950\n")) == 4
    assert len(read("0.5 0 -8990\n1 0 -9999\n1 4 12\n2 3 -4\n")) == 4


def test_marks_apart_from_a_wide_range_and_alone() -> None:
    told = refused("x,y,z\n0.5,0,120\n1,0,28800\n1,4,-9999\n2,3,15000\n")
    assert "z is -9999 in 1 of 4 rows, far from all others, a value or the mark" in told
    told = refused("0.5 0 -9999\n1 0 -9999\n")
    assert "z is -9999 in 2 of 2 rows, a value or the mark of a missing one: read" in told
    flat = read("0.5 0 -9999\n1 0 -9999\n", nodata="none")
    assert flat.points[:, 2].tolist() == [-9999, -9999]


@pytest.mark.parametrize(
    ("text", "options", "point"),
    [
        ("//X Y Z R\n1\n1 2 3 4\n", {"skip_rows": 2, "columns": "X,Y,Z,R"}, [1, 2, 3]),
        ("p,E,N\n,m,m\n7,2,3\n", {"skip_rows": 2, "columns": "p,E,N", "flat": True}, [2, 3, 0]),
        ("x,y,z\n1,2,3\n(1 row)\n", {"end": "(1 row)"}, [1, 2, 3]),
        ("1,north,2,3,4\n", {"columns": "id,-,x,y,z"}, [2, 3, 4]),
    ],
)
def test_the_remedies_work(text: str, options: dict[str, Any], point: list[float]) -> None:
    assert read(text, **options).points.tolist() == [point]


def test_what_follows_the_end_is_named() -> None:
    cloud = read("1.5 2.5 3.5\nEND\n4 5 6\n", end="END")
    assert cloud.points.tolist() == POINTS[:1]
    assert cloud.metadata["notes"] == ("line 2 ends the table: the lines that follow are not read",)


@pytest.mark.parametrize(
    ("text", "above"), [("x,y,z\nEND\n1,2,3\n", "a header but no points"), ("1 2 3\n", "no points")]
)
def test_a_table_that_ends_before_its_first_row_has_no_points(text: str, above: str) -> None:
    end = "END" if "END" in text else "1 2 3"
    with pytest.raises(FormatError, match=f"the file has {above}"):
        read(text, end=end)
    with pytest.raises(FormatError, match=f"the file has {above}"):
        list(liftmesh.read_chunks(io.BytesIO(text.encode()), format="csv", end=end))


def test_six_columns_that_are_colours_are_said_to_be() -> None:
    cloud = read("1 2 3 255 0 10\n")
    assert cloud.metadata["notes"] == ("columns 4, 5 and 6 are read as red, green and blue",)
    assert cloud.metadata["columns"]["red"] == "column_4"


def test_columns_without_a_header_are_told_if_there_are_more_than_three() -> None:
    told = read("1 2 3 4\n").metadata["notes"]
    assert told == ("there is no header: columns 1, 2 and 3 are read as x, y and z",)
    told = read("1 2 3 4\n", flat=True).metadata["notes"]
    assert told == ("there is no header: columns 1 and 2 are read as x and y",)
    assert "notes" not in read("1 2 3\n").metadata
    assert "notes" not in read("1 2 3 4\n", columns="x,y,z,w").metadata


@pytest.mark.parametrize("last", [b"\r\n", b"\r", b"\n", b"\r\r\n"])
@pytest.mark.parametrize("beyond", range(-1, 4))
def test_lines_are_skipped_whose_ends_two_blocks_share(last: bytes, beyond: int) -> None:
    title = b"#" * (BLOCK - len(last) + beyond) + last
    text = title + b"9 9 9\n7 8 9\n1 2 3\n4 5 6\n"
    points = read(text, skip_rows=2 + last.count(b"\r\r")).points
    assert points.tolist() == [[7, 8, 9], [1, 2, 3], [4, 5, 6]]


def test_skipping_more_lines_than_there_are_is_refused() -> None:
    assert "the file has 2 lines, and skip_rows=7 skips more" in refused("1 2\n3 4\n", skip_rows=7)


def test_every_double_survives_a_decimal_comma_and_a_text_column() -> None:
    values = np.random.default_rng(3).standard_normal((300, 3)) * 10.0 ** np.arange(-3, 6, 3)
    lines = ["x;y;z;code"]
    lines += [";".join(map(repr, row)).replace(".", ",") + ";a.b" for row in values.tolist()]
    assert np.array_equal(read("\n".join(lines)).points, values)
