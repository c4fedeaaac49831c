"""Rows of different lengths: what is parsed for many at once is what each row says by itself."""

from __future__ import annotations

import io
import struct
from collections.abc import Sequence

import numpy as np
import pytest
from file_samples import loaded
from hypothesis import given, strategies as st

import liftmesh
from liftmesh import FormatError
from liftmesh.io.columns import Ragged, gathered, runs

SQUARE = ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
VERTICES = ("element vertex 4", "property float x", "property float y", "property float z")

# Runs of one shape, long and short, and faces of every size.
LENGTHS = [
    [],
    [3, 4] * 400,
    [3] * 70 + [4] * 70 + [0] * 3 + [5] * 2000 + [3, 4, 5] * 30,
    [0] * 3000 + [3],
    [255, 256, 300, 3],
    [3, 100_000, 3, 2, 1, 0, 90_000],
    [*range(200), *range(200, 0, -1)],
    [70_000],
]


def polygons(lengths: Sequence[int]) -> list[list[int]]:
    rng = np.random.default_rng(len(lengths))
    return [rng.integers(0, 4, length).tolist() for length in lengths]


def fans(rows: list[list[int]]) -> list[list[int]]:
    return [[row[0], row[k], row[k + 1]] for row in rows for k in range(1, len(row) - 1)]


def header(encoding: str, *lines: str) -> bytes:
    return "\n".join(["ply", f"format {encoding} 1.0", *lines, "end_header", ""]).encode()


def text_of(rows: list[list[int]]) -> bytes:
    return b"".join(b"%d %s\n" % (len(row), " ".join(map(str, row)).encode()) for row in rows)


VERTEX_LINES = b"".join(b"%d %d %d\n" % row for row in SQUARE)


def written(form: str, rows: list[list[int]]) -> tuple[str, bytes]:
    if form == "obj":
        vertices = VERTEX_LINES.splitlines()
        lines = [b"v " + line for line in vertices]
        lines += [("f " + " ".join(str(k + 1) for k in row)).encode() for row in rows if row]
        return "obj", b"\n".join([*lines, b""])
    if form == "off":
        return "off", b"OFF\n4 %d 0\n" % len(rows) + VERTEX_LINES + text_of(rows)
    lists = (f"element face {len(rows)}", "property list uint int vertex_indices")
    if form == "ascii":
        return "ply", header(form, *VERTICES, *lists) + VERTEX_LINES + text_of(rows)
    order = "<" if "little" in form else ">"
    body = b"".join(struct.pack(f"{order}3f", *row) for row in SQUARE)
    body += b"".join(struct.pack(f"{order}I{len(row)}i", len(row), *row) for row in rows)
    return "ply", header(form, *VERTICES, *lists) + body


FORMS = ("binary_little_endian", "binary_big_endian", "ascii", "off", "obj")


@pytest.mark.slow
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("lengths", LENGTHS, ids=lambda lengths: str(len(lengths)))
def test_faces_of_every_size_become_their_fans(form: str, lengths: list[int]) -> None:
    rows = polygons(lengths)
    kind, data = written(form, rows)
    cloud = loaded(data, kind)
    faces = [] if cloud.faces is None else cloud.faces.tolist()
    assert faces == fans(rows)
    assert cloud.metadata.get("polygons", 0) == sum(length > 3 for length in lengths)
    if cloud.faces is not None:
        assert cloud.faces.dtype == np.int32


@pytest.mark.parametrize("form", FORMS)
def test_the_face_that_is_wrong_is_named_wherever_it_is(form: str) -> None:
    rows = polygons([3, 4] * 3000)
    for at in (0, 1, 2999, 5999):
        broken = [*rows]
        broken[at] = [0, 1, 7]
        kind, data = written(form, broken)
        where = f"line {5 + at}: face" if form == "obj" else f"face {at} "
        with pytest.raises(
            FormatError, match=f"{where}.*refers to vertex {8 if form == 'obj' else 7}"
        ):
            loaded(data, kind)


WIDE = (
    "element vertex 3", "property uchar x", "property list uchar ushort a", "property short y",
    "property double w", "property list int8 double b", "property list uint uchar c",
)  # fmt: skip


@pytest.mark.slow
@given(st.lists(st.tuples(*[st.integers(0, 5)] * 3), min_size=1, max_size=300))
def test_scalars_between_lists_are_found(sizes: list[tuple[int, int, int]]) -> None:
    lines = [WIDE[0].replace("3", str(len(sizes))), *WIDE[1:]]
    binary, text = [], []
    for row, (a, b, c) in enumerate(sizes):
        binary.append(struct.pack(f">BB{a}H", row % 251, a, *range(a)))
        binary.append(struct.pack(f">hdb{b}d", -row, row / 3, b, *range(b)))
        binary.append(struct.pack(f">I{c}B", c, *range(c)))
        words = [row % 251, a, *range(a), -row, repr(row / 3), b, *range(b), c, *range(c)]
        text.append(" ".join(map(str, words)).encode() + b"\n")
    rows = np.arange(len(sizes))
    for encoding, body in (("binary_big_endian", binary), ("ascii", text)):
        data = header(encoding, *lines) + b"".join(body)
        cloud = loaded(data, "ply")
        assert cloud.points[:, 0].tolist() == (rows % 251).tolist()
        assert cloud.points[:, 1].tolist() == (-rows).tolist()
        assert cloud.attributes["w"].tolist() == (rows / 3).tolist()
        chunks = [*liftmesh.read_chunks(io.BytesIO(data), rows=7, format="ply")]
        assert np.concatenate([each.points for each in chunks]).tolist() == cloud.points.tolist()


@pytest.mark.parametrize(
    ("line", "cause"),
    [
        (b"3 0 1", "line 13: lists in this row"),
        (b"2 0 1 2", "line 13: lists in this row"),
        (b"-1 0 1 2", "line 13: lists in this row"),
        (b"2.5 0 1 2", "line 13: lists in this row"),
        (b"nan 0 1", "line 13: lists in this row"),
        (b"99999999999999999999 0 1", "line 13: lists in this row"),
        (b"3 0 1 x", "line 13, value 4: 'x'"),
        (b"3 0 1 1.5", "line 13: vertex_indices is 1.5, which is not int32"),
        (b"3 0 1 2147483648", "line 13: vertex_indices is 2147483648, which is not int32"),
        (b"3 0 1 -", "line 13, value 4: '-'"),
        (b"3 0 1-2 1", "line 13, value 3: '1-2'"),
        (b"3 0 -1-2 1", "line 13, value 3: '-1-2'"),
        (b"3 0 - 1", "line 13, value 3: '-'"),
    ],
)
def test_a_row_of_text_that_is_wrong_is_named(line: bytes, cause: str) -> None:
    lists = ("element face 3", "property list uchar int vertex_indices")
    body = VERTEX_LINES + b"4 0 1 2 3\n" + line + b"\n3 0 1 2\n"
    data = header("ascii", *VERTICES, *lists) + body
    at = 1 + data[: data.index(b"\n" + line)].count(b"\n") + 1
    with pytest.raises(FormatError, match=cause.replace("line 13", f"line {at}")):
        loaded(data, "ply")


def test_numbers_are_read_alike_as_integers_and_as_floats() -> None:
    lists = ("element face 2", "property list uchar int vertex_indices")
    for third in (b"2", b"2.0", b"+2", b"002", b"2e0", b"\t2\xa0"):
        body = VERTEX_LINES + b"3 0 1 2\n4 0 1 " + third + b" 3\n"
        cloud = loaded(header("ascii", *VERTICES, *lists) + body, "ply")
        assert cloud.faces is not None
        assert cloud.faces.tolist() == [[0, 1, 2], [0, 1, 2], [0, 2, 3]]


def test_the_largest_integers_are_what_they_are() -> None:
    lists = ("element q 2", "property list uchar int64 k")
    for number, fits in ((2**53, False), (2**53 - 1, True), (2**63 - 1, False), (-(2**63), False)):
        body = VERTEX_LINES + b"1 %d\n2 1.5e0 1\n" % number
        data = header("ascii", *VERTICES, *lists) + body
        with pytest.raises(FormatError, match="1.5" if fits else "which is not int64"):
            loaded(data, "ply")


TRIANGLES = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\nvn 0 1 0\n"


@pytest.mark.parametrize(
    "faces",
    [
        b"f 1/1/1 2/1/1 3/1/1\nf 1/1/1 3/1/1 4/1/1 1/1/1\n",
        b"f 1//1 2//1 3//1\nf 1//1 3//1 4//1 1//1\n",
        b"f 1//1 2/1/1 3//1\nf 1/-1/-2 3//1 4//1 -4//-2\n",
    ],
)
def test_corners_of_every_form_give_the_same(faces: bytes) -> None:
    cloud = loaded(TRIANGLES + faces, "obj")
    assert cloud.faces is not None
    assert cloud.faces.tolist() == [[0, 1, 2], [0, 2, 3], [0, 3, 0]]
    assert cloud.normals is not None
    assert cloud.normals.tolist() == [[0, 0, 1]] * 4


def test_corners_without_normals_among_others_give_none() -> None:
    for faces in (b"f 1/1 2/1 3/1\n", b"f 1/ 2/ 3/\n", b"f 1 2 3\nf 1//1 2//1 3//1\n"):
        cloud = loaded(TRIANGLES + faces, "obj")
        assert cloud.faces is not None
        assert cloud.faces[0].tolist() == [0, 1, 2]
        assert cloud.normals is None


@pytest.mark.parametrize(
    "corner",
    ["/1", "//1", "/", "1//", "1/2/", "1///1", "1/1//", "1/0/0", "0/1/1", "-", "1-", "1/-", "--1",
     "1/x/2", "1.0", "9223372036854775808", "2147483648", "-9223372036854775809", "1//0"],
)  # fmt: skip
def test_a_corner_that_is_none_is_named(corner: str) -> None:
    for before in ("f 1 2 3\n", "f 1/1/1 2/1/1 3/1/1\n", "f 1//1 2//1 3//1 4//1\n"):
        data = TRIANGLES + before.encode() + f"f 1/1/1 {corner} 2\n".encode()
        with pytest.raises(FormatError, match=f"line 9: '{corner}' is not a corner"):
            loaded(data, "obj")


def test_runs_and_gathered_are_what_they_say() -> None:
    rng = np.random.default_rng(5)
    values = rng.integers(0, 100, 400_000)
    for sizes in (
        rng.integers(0, 9, 70_000).astype(np.uint8), np.array([300_000, 1, 0, 70_000, 3]),
        np.zeros(70_000, np.int64), np.full(70_000, 5), np.array([7]), np.zeros(0, np.int64),
    ):  # fmt: skip
        starts = rng.integers(0, len(values) - int(sizes.max(initial=0)), len(sizes))
        expected = [values[a : a + n] for a, n in zip(starts, sizes.astype(int), strict=True)]
        whole = np.concatenate(expected) if expected else values[:0]
        assert np.array_equal(gathered(values, starts, sizes.astype(np.int64)), whole)
        found = [*runs(sizes)]
        ends = np.cumsum(sizes, dtype=np.int64)
        assert [rows.start for rows, _ in found] == [0, *[r.stop for r, _ in found]][: len(found)]
        for rows, at in found:
            assert at.stop == ends[rows.stop - 1]
            assert at.stop - at.start == sizes[rows].sum(dtype=np.int64)
            assert rows.stop - rows.start == 1 or max(at.stop - at.start, rows.stop) <= 1 << 18
        for position in (0, len(whole) // 2, len(whole) - 1):
            if len(whole):
                row = Ragged(sizes, whole).row_of(position)
                assert ends[row] - sizes[row] <= position < ends[row]


class Part(io.BytesIO):
    """A stream that returns at most seven bytes at a time, as those without a buffer may."""

    def read(self, size: int | None = -1, /) -> bytes:
        return super().read(min(size, 7) if size is not None and size >= 0 else 7)


def test_streams_that_return_parts_are_read_whole() -> None:
    points = np.random.default_rng(2).random((30, 3))
    stream = io.BytesIO()
    np.save(stream, points)
    assert np.array_equal(liftmesh.read(Part(stream.getvalue()), format="npy").points, points)
    for form in FORMS:
        rows = polygons([3, 4, 5] * 40)
        kind, data = written(form, rows)
        faces = liftmesh.read(Part(data), format=kind).faces
        assert faces is not None
        assert faces.tolist() == fans(rows)


@pytest.mark.parametrize("starts", [[1, 5, 9], [0, 3, 6], [2, 2, 2], [9, 5, 1], [1, 5, 8]])
@pytest.mark.parametrize("size", [0, 1, 3])
def test_rows_at_equal_distances_and_others(starts: list[int], size: int) -> None:
    values = np.arange(24)[::2]
    found = gathered(values, np.array(starts), np.full(3, size))
    assert found.tolist() == [x for k in starts for x in values[k : k + size].tolist()]
    assert not np.shares_memory(found, values)
