"""Points as text: delimiters, headers, comments, and what each column means."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest
from file_samples import AWKWARD, assert_same_bits, loaded

import liftmesh
from liftmesh import Cloud, FormatError

POINTS = [[1.5, 2.0, -3.0], [4.0, 5.25, 6e3]]


def read(text: str, suffix: str = "csv", **options: Any) -> Cloud:
    return liftmesh.read(io.BytesIO(text.encode()), format=suffix, **options)


@pytest.mark.parametrize("suffix", ["xyz", "csv", "txt", "asc", "tsv"])
@pytest.mark.parametrize(
    "text",
    [
        "1.5 2 -3\n4 5.25 6e3\n",
        "1.5,2,-3\n4,5.25,6e3",
        "1.5, 2, -3\n4, 5.25, 6e3\n",
        "1.5;2;-3\n4;5.25;6e3\n",
        "1.5\t2\t-3\n4\t5.25\t6e3\n",
        "  1.5   2\t-3  \n 4 5.25 6e3\n",
        "# made by hand\n1.5 2 -3\n\n4 5.25 6e3 # the last\n",
        "// made by hand\n1.5,2,-3\n\n# between\n4,5.25,6e3\n\n",
        "\ufeff1.5 2 -3\r\n4 5.25 6e3\r\n",
        "\ufeffx,y,z\r\n1.5,2,-3\r\n4,5.25,6e3\r\n",
        "1.5 2 -3\r4 5.25 6e3\r",
        'x,y,z\n1.5,2,-3\n"4","5.25",6e3\n',
        '"X","Y","Z"\n1.5,2,-3\n4,5.25,6e3\n',
        "Easting Northing Elevation\n1.5 2 -3\n4 5.25 6e3\n",
        "z;north;east\n-3;2;1.5\n6e3;5.25;4\n",
        "#x y z\n1.5 2 -3\n4 5.25 6e3\n",
        "# by hand\n//Z,Y,X\n-3,2,1.5\n6e3,5.25,4\n",
        "x_coord\tY_coord\tZ\n1.5\t2\t-3\n4\t5.25\t6e3\n",
    ],
)
def test_layouts(text: str, suffix: str) -> None:
    cloud = read(text, suffix)
    assert cloud.points.tolist() == POINTS
    assert not cloud.attributes
    assert cloud.colors is None
    assert cloud.faces is None


def test_every_double_comes_back() -> None:
    text = "".join(" ".join(map(repr, row)) + "\n" for row in AWKWARD.tolist())
    assert_same_bits(read(text, nodata="none").points, AWKWARD)
    table = "x,y,z\n" + text.replace(" ", ",")
    assert_same_bits(read(table, nodata="none").points, AWKWARD)


def test_two_columns_lie_at_zero() -> None:
    assert read("1 2\n3 4\n").points.tolist() == [[1, 2, 0], [3, 4, 0]]
    assert read("y,x\n1,2\n").points.tolist() == [[2, 1, 0]]


def test_one_row() -> None:
    assert read("1,2,3\n").points.tolist() == [[1, 2, 3]]


def test_nan_and_infinity_are_numbers() -> None:
    points = read("x,y,z\n1,2,nan\ninf,-inf,NaN\n").points
    assert np.isnan(points[:, 2]).all()
    assert points[1, :2].tolist() == [np.inf, -np.inf]


def test_colours_normals_and_attributes() -> None:
    cloud = read(
        "Intensity,X,Y,Z,R,G,B,nx,ny,nz,gps_time\n"
        "7,1,2,3,255,0,10,0,0,1,0.5\n8,4,5,6,1,2,3,1,0,0,1.5\n"
    )
    assert cloud.points.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert_same_bits(cloud.colors, np.array([[255, 0, 10], [1, 2, 3]], dtype=np.uint8))
    assert_same_bits(cloud.normals, np.array([[0.0, 0, 1], [1, 0, 0]]))
    assert list(cloud.attributes) == ["Intensity", "gps_time"]
    assert cloud.attributes["gps_time"].tolist() == [0.5, 1.5]


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ("0,255,7", np.array([[0, 255, 7]], dtype=np.uint8)),
        ("0,256,65535", np.array([[0, 256, 65535]], dtype=np.uint16)),
        ("0,0.5,1", np.array([[0, 0.5, 1]])),
        ("0,0.501961,1", np.array([[0, 128, 255]], dtype=np.uint8)),
    ],
)
def test_what_colours_are(values: str, expected: np.ndarray) -> None:
    assert_same_bits(read(f"x,y,z,red,green,blue\n1,2,3,{values}\n").colors, expected)


@pytest.mark.parametrize("values", ["-1,0,0", "0,0,65536", "0,2.5,0", "nan,0,0"])
def test_what_colours_are_not(values: str) -> None:
    cloud = read(f"x,y,z,red,green,blue\n1,2,3,{values}\n")
    assert cloud.colors is None
    assert list(cloud.attributes) == ["red", "green", "blue"]


def test_columns_without_a_header() -> None:
    four = read("1 2 3 0.5\n4 5 6 0.25\n")
    assert four.attributes["column_4"].tolist() == [0.5, 0.25]
    six = read("1 2 3 255 0 10\n")
    assert_same_bits(six.colors, np.array([[255, 0, 10]], dtype=np.uint8))
    normals = read("1 2 3 0.6 0 0.8\n")
    assert list(normals.attributes) == ["column_4", "column_5", "column_6"]


def test_more_lines_than_a_block() -> None:
    points = np.random.default_rng(1).random((140_000, 3))
    text = "".join("{!r} {!r} {!r}\n".format(*tuple(row)) for row in points.tolist())
    assert_same_bits(read(text).points, points)


@pytest.mark.parametrize(
    ("text", "cause"),
    [
        ("\n\n", "no line holds numbers"),
        ("# only a comment", "no line holds numbers"),
        ("x,y,z\n", "a header but no points"),
        ("1\n2\n", "line 1: only one value"),
        ("1 2 3\n4 5\n", "line 2: expected 3 values, found 2"),
        ("1 2 3\n\n4 5 6 7\n", "line 3: expected 3 values, found 4"),
        ("1 2 3\n4 five 6\n", "line 2, value 2: 'five' is not a number"),
        ("1 two 3\n", "line 1, value 2: 'two' is not a number"),
        ("1,5 2,5 3,5\n", "line 1: '1,5' is a number with a decimal comma, or two numbers"),
        ("name,value\n1,2\n", "line 1: the header 'name', 'value' has no column x or y"),
        ("x,z\n1,2\n", "has no column y"),
        ("x,y,easting\n1,2,3\n", "the header has 2 columns for 'x'"),
        ("x,y,z\n1,2\n", "line 2: expected 3 values, found 2"),
        ("1 2 1_000\n", "line 1, value 3: '1_000' is not a number"),
        ("ncols 4\nnrows 3\nxllcorner 0\n", "an Arc/Info ASCII grid"),
        ("1 2 3\n\x00\x01\x02 4 5\n", r"line 2, value 1: '\\x00\\x01\\x02' is not"),
    ],
)
def test_broken_files_name_the_line(text: str, cause: str) -> None:
    with pytest.raises(FormatError, match=f"<stream>: .*{cause}"):
        read(text)


def test_wrong_encodings() -> None:
    with pytest.raises(FormatError, match="UTF-16 without its mark"):
        loaded("1 2 3\n".encode("utf-16-le"), "txt")
    with pytest.raises(FormatError, match=r"damaged UTF-16 .*: save it as UTF-8"):
        loaded("1 2 3\n".encode("utf-16")[:-1], "txt")
    with pytest.raises(FormatError, match=r"line 2: byte 3 of the line \(0xf6\) is not UTF-8"):
        loaded("1 2 3\n# höhe\n4 5 6\n".encode("latin-1"), "txt")
    with pytest.raises(FormatError, match=r"line 1: byte 0 .*save the file as UTF-8"):
        loaded(b"\x89PNG\r\n\x1a\n", "xyz")


def test_long_lines_are_shortened_in_messages() -> None:
    with pytest.raises(FormatError) as caught:
        read("1 2 3\n1 2 " + "x" * 10_000)
    assert len(str(caught.value)) < 120


@pytest.mark.parametrize("value", ["nan", "inf", "-inf", "1e400"])
def test_columns_that_are_called_colours_and_are_not_finite_stay_attributes(value: str) -> None:
    cloud = read(f"x,y,red,green,blue\n0,0,0.5,0,1\n1,1,{value},0,0\n")
    assert cloud.colors is None
    assert sorted(cloud.attributes) == ["blue", "green", "red"]
