"""Reading PLY as other programs write it."""

from __future__ import annotations

import struct
from collections.abc import Sequence

import numpy as np
import pytest
from file_samples import assert_same_bits, loaded

from liftmesh import Cloud, FormatError

VERTEX = "element vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
POINTS = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 2.0], [1.0, 1.0, 3.0], [0.0, 1.0, 4.0]])
ROWS = "0 0 1\n1 0 2\n1 1 3\n0 1 4\n"
FACE = "element face {}\nproperty list uchar int vertex_indices\n"


def ascii_ply(header: str, body: str) -> Cloud:
    return loaded(f"ply\nformat ascii 1.0\n{header}end_header\n{body}".encode(), "ply")


def binary_ply(header: str, body: bytes, order: str = "little") -> Cloud:
    start = f"ply\nformat binary_{order}_endian 1.0\n{header}end_header\n".encode()
    return loaded(start + body, "ply")


def lists(rows: Sequence[Sequence[int]], code: str = "<B", item: str = "<i") -> bytes:
    return b"".join(
        struct.pack(code, len(row)) + b"".join(struct.pack(item, value) for value in row)
        for row in rows
    )


@pytest.mark.parametrize("order", ["little", "big"])
@pytest.mark.parametrize(
    ("names", "code"),
    [
        (("char", "int8"), "i1"),
        (("uchar", "uint8"), "u1"),
        (("short", "int16"), "i2"),
        (("ushort", "uint16"), "u2"),
        (("int", "int32"), "i4"),
        (("uint", "uint32"), "u4"),
        (("float", "float32"), "f4"),
        (("double", "float64"), "f8"),
        (("int64",), "i8"),
        (("uint64",), "u8"),
    ],
)
def test_every_scalar_type(names: tuple[str, ...], code: str, order: str) -> None:
    low = np.finfo(code).min if code[0] == "f" else np.iinfo(code).min
    values = np.array([low, 0, 1, 100], dtype=code)
    layout = np.dtype([("x", code), ("v", code), ("y", code)]).newbyteorder(
        "<" if order == "little" else ">"
    )
    table = np.zeros(4, layout)
    table["x"], table["v"], table["y"] = values, values, values[::-1]
    for name in names:
        header = "element vertex 4\n" + "".join(f"property {name} {key}\n" for key in "xvy")
        cloud = binary_ply(header, table.tobytes(), order)
        assert_same_bits(cloud.attributes["v"], values)
        assert_same_bits(cloud.points[:, 0].copy(), values.astype(np.float64))
        assert_same_bits(cloud.points[:, 1].copy(), values[::-1].astype(np.float64))
        assert not cloud.points[:, 2].any()
        text = "".join(f"{x} {v} {y}\n" for x, v, y in table.tolist())
        if code != "i8":
            assert_same_bits(ascii_ply(header, text).attributes["v"], values)


def test_polygons_are_cut_into_fans_and_counted() -> None:
    rows = [(0, 1, 2), (0, 1, 2, 3), (3, 2, 1, 0, 1), (0, 1), ()]
    expected = [[0, 1, 2], [0, 1, 2], [0, 2, 3], [3, 2, 1], [3, 1, 0], [3, 0, 1]]
    text = ROWS + "".join(f"{len(row)} {' '.join(map(str, row))}\n" for row in rows)
    from_text = ascii_ply(VERTEX + FACE.format(5), text)
    from_bytes = binary_ply(VERTEX + FACE.format(5), POINTS.tobytes() + lists(rows))
    for cloud in (from_text, from_bytes):
        assert cloud.faces is not None
        assert cloud.faces.tolist() == expected
        assert cloud.metadata["polygons"] == 2
        assert cloud.metadata["degenerate_faces"] == 2


def test_quadrilaterals_only() -> None:
    cloud = binary_ply(VERTEX + FACE.format(2), POINTS.tobytes() + lists([(0, 1, 2, 3)] * 2))
    assert cloud.faces is not None
    assert cloud.faces.tolist() == [[0, 1, 2], [0, 2, 3]] * 2


@pytest.mark.parametrize(
    ("count", "item", "codes"),
    [("uchar", "uint", "<B <I"), ("int", "ushort", "<i <H"), ("uint64", "int64", "<Q <q")],
)
def test_lists_of_other_types(count: str, item: str, codes: str) -> None:
    header = f"{VERTEX}element face 2\nproperty list {count} {item} vertex_index\n"
    for rows in ([(0, 1, 2), (1, 2, 3)], [(0, 1, 2, 3), (1, 2, 3)]):
        cloud = binary_ply(header, POINTS.tobytes() + lists(rows, *codes.split()))
        assert cloud.faces is not None
        assert cloud.faces[-1].tolist() == [1, 2, 3]


@pytest.mark.parametrize("mixed", [False, True])
def test_other_elements_and_properties_are_passed_over_in_place(mixed: bool) -> None:
    last = (0, 1, 2, 3) if mixed else (0, 1, 2)
    header = (
        "element material 2\nproperty uchar kind\nproperty list uchar float weights\n"
        f"{VERTEX}element edge 2\nproperty int vertex1\nproperty int vertex2\n"
        "element face 2\nproperty uchar flags\nproperty list uchar int vertex_indices\n"
        "property list uchar float texcoord\nproperty float quality\n"
        "element tail 1\nproperty short value\n"
    )
    material = b"\x07" + lists([(1, 2)], item="<f") + b"\x08" + lists([(1,)], item="<f")
    faces = b"".join(
        b"\x01" + lists([row]) + lists([(0, 1)], item="<f") + struct.pack("<f", 0.5)
        for row in [(0, 1, 2), last]
    )
    body = material + POINTS.tobytes() + bytes(16) + faces + b"\x01\x02"
    text = (
        f"7 2 1 2\n8 1 1\n{ROWS}0 1\n1 2\n1 3 0 1 2 2 0 1 0.5\n"
        f"1 {len(last)} {' '.join(map(str, last))} 2 0 1 0.5\n513\n"
    )
    made = (binary_ply(header, body), [[0, 0]] * 2), (ascii_ply(header, text), [[0, 1], [1, 2]])
    for cloud, edges in made:
        assert_same_bits(cloud.points, POINTS)
        assert cloud.faces is not None
        assert len(cloud.faces) == 2 + mixed
        assert cloud.edges is not None
        assert cloud.edges.tolist() == edges
        assert cloud.metadata["not_read"] == (
            "element material (2 rows)",
            "face property flags (2 rows)",
            "face property texcoord (2 rows)",
            "face property quality (2 rows)",
            "element tail (1 row)",
        )


def test_lists_of_vertices_are_named_as_skipped() -> None:
    header = "element vertex 2\nproperty float x\nproperty list uchar int near\nproperty float y\n"
    body = b"".join(
        struct.pack("<f", x) + lists([near]) + struct.pack("<f", y)
        for x, near, y in [(1.5, (1,), 2.5), (3.5, (0, 1), 4.5)]
    )
    for cloud in (binary_ply(header, body), ascii_ply(header, "1.5 1 1 2.5\n3.5 2 0 1 4.5\n")):
        assert cloud.points.tolist() == [[1.5, 2.5, 0.0], [3.5, 4.5, 0.0]]
        assert cloud.metadata["not_read"] == ("vertex property near (2 rows)",)


def test_comments_line_ends_and_blank_lines() -> None:
    data = (
        "ply\r\nformat ascii 1.0\r\ncomment made by hand\r\nobj_info grid 2 2\r\ncomment höhe\r\n"
        + VERTEX.replace("\n", "\r\n")
        + "end_header\r\n\r\n"
        + ROWS.replace("\n", "\r\n\r\n")
    )
    cloud = loaded(data.encode(), "ply")
    assert_same_bits(cloud.points, POINTS)
    assert cloud.metadata["comments"] == ("made by hand", "höhe")
    assert cloud.metadata["obj_info"] == ("grid 2 2",)


def test_colours_and_normals_are_found_by_name() -> None:
    header = (
        "element vertex 1\nproperty uchar blue\nproperty uchar green\nproperty uchar red\n"
        "property float nz\nproperty float ny\nproperty float nx\nproperty uchar alpha\n"
        "property int z\nproperty int y\nproperty int x\n"
    )
    cloud = ascii_ply(header, "3 2 1 0.5 0.25 0.125 4 30 20 10\n")
    assert cloud.points.tolist() == [[10.0, 20.0, 30.0]]
    assert_same_bits(cloud.colors, np.array([[1, 2, 3, 4]], dtype=np.uint8))
    assert_same_bits(cloud.normals, np.array([[0.125, 0.25, 0.5]], dtype=np.float32))
    assert not cloud.attributes


def test_part_of_a_colour_is_an_attribute() -> None:
    cloud = ascii_ply(
        "element vertex 1\nproperty int x\nproperty int y\nproperty uchar red\n", "1 2 3\n"
    )
    assert cloud.colors is None
    assert cloud.attributes["red"].tolist() == [3]


@pytest.mark.parametrize(
    ("header", "line", "cause"),
    [
        ("elephant 3\n", 3, "unknown header line 'elephant 3'"),
        ("element vertex -1\n", 3, "needs a name and a count"),
        ("element vertex\n", 3, "needs a name and a count"),
        ("element vertex 1 2\n", 3, "needs a name and a count"),
        ("element vertex 99999999999999999999\n", 3, "needs a name and a count"),
        ("property float x\n", 3, "a property precedes the first element"),
        ("element vertex 1\nproperty real x\n", 4, "unknown type 'real'"),
        ("element vertex 1\nproperty x\n", 4, "needs a type and a name"),
        ("element vertex 1\nproperty list float int x\n", 4, "length of a list cannot be"),
        ("element vertex 1\nproperty int x\nproperty int x\n", 5, "'x' of vertex occurs twice"),
        ("element vertex 1\nelement vertex 1\n", 4, "'vertex' occurs twice"),
        ("format ascii 2.0\n", 3, "unknown format 'ascii 2.0'"),
    ],
)
def test_broken_headers_name_the_line(header: str, line: int, cause: str) -> None:
    with pytest.raises(FormatError, match=f"<stream>: line {line}: .*{cause}"):
        ascii_ply(header, "")


@pytest.mark.parametrize(
    ("data", "cause"),
    [
        (b"solid cube\n", "not a PLY file"),
        (b"plywood is a long word\n", "not a PLY file"),
        (b"ply\nformat ascii 1.0\nelement vertex 0\n", "no complete end_header line"),
        (b"ply\nelement vertex 0\nend_header\n", "precedes the format line"),
        (b"ply\nend_header\n", "no format line"),
        (b"ply\nformat ascii 1.0\nend_header\n", "no vertex element"),
        (
            b"ply\nformat ascii 1.0\nelement vertex 0\nproperty int z\nend_header\n",
            "no x and y: .* z",
        ),
        (b"ply\nformat ascii 1.0\nelement vertex 0\nend_header\n", "properties are none"),
    ],
)
def test_what_is_no_ply_is_refused(data: bytes, cause: str) -> None:
    with pytest.raises(FormatError, match=cause):
        loaded(data, "ply")


@pytest.mark.parametrize(
    ("body", "cause"),
    [
        ("0 0 1\n1 0\n1 1 3\n0 1 4\n", "line 9: expected 3 values, found 2"),
        ("0 0 1\n1 0 2 5\n1 1 3\n0 1 4\n", "line 9: expected 3 values, found 4"),
        ("0 0 1\n1 zero 2\n1 1 3\n0 1 4\n", "line 9, value 2: 'zero' is not a number"),
        ("0 0 1\n1 0,5 2\n1 1 3\n0 1 4\n", "line 9, value 2: '0,5' is not a number"),
        ("0 0 1\n1 1_0 2\n1 1 3\n0 1 4\n", "line 9, value 2: '1_0' is not a number"),
        ("0 0 1\n\n1 0 2\n", "line 10: the file ends before the 4 rows of element vertex"),
        ("0 0 1", "line 7: the file ends before the 4 rows of element vertex"),
    ],
)
def test_broken_rows_name_the_line(body: str, cause: str) -> None:
    with pytest.raises(FormatError, match=f"<stream>: {cause}"):
        ascii_ply(VERTEX, body)


@pytest.mark.parametrize(
    ("value", "kind"), [("256", "uchar"), ("-1", "uchar"), ("1.5", "int"), ("nan", "short")]
)
def test_values_must_fit_their_type(value: str, kind: str) -> None:
    header = f"element vertex 1\nproperty float x\nproperty float y\nproperty {kind} v\n"
    with pytest.raises(FormatError, match=f"line 8: v is {float(value)}"):
        ascii_ply(header, f"1 2 {value}\n")


def test_faces_must_refer_to_vertices() -> None:
    rows = [(0, 1, 2), (0, 1, 4)]
    with pytest.raises(FormatError, match=r"face 1 refers to vertex 4 .* there are 4 vertices"):
        binary_ply(VERTEX + FACE.format(2), POINTS.tobytes() + lists(rows))
    with pytest.raises(FormatError, match="face 1 refers to vertex -1"):
        ascii_ply(VERTEX + FACE.format(2), f"{ROWS}4 0 1 2 3\n3 0 1 -1\n")


@pytest.mark.parametrize("body", ["3 0 1\n", "3 0 1 2 3\n", "-1\n", "2.5 0 1\n", "3 0 1 x\n"])
def test_broken_lists_name_the_line(body: str) -> None:
    with pytest.raises(FormatError, match="<stream>: line 15"):
        ascii_ply(VERTEX + FACE.format(2), f"{ROWS}3 0 1 2\n{body}")


def test_indices_must_be_integers() -> None:
    header = f"{VERTEX}element face 1\nproperty list uchar float vertex_indices\n"
    with pytest.raises(FormatError, match="must be integers"):
        ascii_ply(header, f"{ROWS}3 0 1 2\n")


@pytest.mark.parametrize("rows", [5, 2**31, 10**17])
@pytest.mark.parametrize("encoding", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_headers_that_promise_too_much(rows: int, encoding: str) -> None:
    start = f"ply\nformat {encoding} 1.0\n"
    body = ROWS.encode() if encoding == "ascii" else POINTS.tobytes()
    for header in (
        VERTEX.replace("vertex 4", f"vertex {rows}"),
        VERTEX + FACE.format(rows),
        f"{VERTEX}element other {rows}\nproperty uchar value\n",
        f"{VERTEX}element other {rows}\nproperty uchar a\nproperty list uchar int b\n",
    ):
        with pytest.raises(FormatError, match=f"{rows} rows of element"):
            loaded(f"{start}{header}end_header\n".encode() + body, "ply")


def test_an_element_without_properties_holds_nothing() -> None:
    header = f"{VERTEX}element nothing {10**17}\n"
    assert_same_bits(ascii_ply(header, ROWS).points, POINTS)
    assert_same_bits(binary_ply(header, POINTS.tobytes()).points, POINTS)


def test_lists_that_promise_too_much() -> None:
    header = f"{VERTEX}element face 1\nproperty list uint int vertex_indices\n"
    with pytest.raises(FormatError, match="row 0 of element face: vertex_indices has 4294967295"):
        binary_ply(header, POINTS.tobytes() + b"\xff\xff\xff\xff" + bytes(12))
    signed = f"{VERTEX}element face 1\nproperty list char int vertex_indices\n"
    with pytest.raises(FormatError, match="row 0 of element face: vertex_indices has -1"):
        binary_ply(signed, POINTS.tobytes() + b"\xff" + bytes(12))


def test_text_keeps_the_digits_that_float_would_lose() -> None:
    """A northing of eight digits moved by a quarter of a metre; 1e300 became infinite."""
    header = "element vertex 2\nproperty float x\nproperty float y\nproperty float quality\n"
    for near in ("", "property list uchar int near\n"):
        rest = " 1 7\n" if near else "\n"
        cloud = ascii_ply(header + near, f"500051.1822 5400095.046 0.1{rest}1e300 2 3{rest}")
        assert cloud.points[:, :2].tolist() == [[500051.1822, 5400095.046], [1e300, 2]]
        assert cloud.attributes["quality"].dtype == np.float32
