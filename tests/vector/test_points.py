"""PCD, PTS, XYZRGB, XYZN, .node and .ele, as other programs write them."""

from __future__ import annotations

import gzip
import struct
from pathlib import Path
from typing import Any

import numpy as np
import open3d as o3d
import pytest
from file_samples import loaded

import liftmesh
from liftmesh import FormatError
from liftmesh.io.formats.pcd import decompress

RNG = np.random.default_rng(15)
POINTS = RNG.random((500, 3)) * 100
RGB = RNG.integers(0, 256, (500, 3)).astype(np.uint8)
NORMALS = np.eye(3)[np.arange(500) % 3]


def exported(path: Path, **options: Any) -> liftmesh.Cloud:
    """Write a cloud with Open3D, and read it."""
    vectors = o3d.utility.Vector3dVector
    cloud = o3d.geometry.PointCloud(vectors(POINTS))
    cloud.colors, cloud.normals = vectors(RGB / 255), vectors(NORMALS)
    assert o3d.io.write_point_cloud(str(path), cloud, **options)
    return liftmesh.read(path)


@pytest.mark.parametrize("options", [{"write_ascii": True}, {}, {"compressed": True}])
def test_pcd_of_open3d(options: dict[str, bool], tmp_path: Path) -> None:
    cloud = exported(tmp_path / "a.pcd", **options)
    if options.get("write_ascii"):
        assert np.allclose(cloud.points, POINTS, rtol=1e-9)  # ten digits, though the type is float
    else:
        assert np.array_equal(cloud.points, POINTS.astype(np.float32))
    assert cloud.colors is not None
    assert cloud.normals is not None
    assert np.array_equal(cloud.colors, RGB)
    assert np.array_equal(cloud.normals, NORMALS)


def test_pcd_of_open3d_tensors(tmp_path: Path) -> None:
    cloud = o3d.t.geometry.PointCloud(o3d.core.Tensor(POINTS))
    cloud.point["intensity"] = o3d.core.Tensor(np.arange(500, dtype=np.uint16)[:, None])
    assert o3d.t.io.write_point_cloud(str(tmp_path / "a.pcd"), cloud)
    back = liftmesh.read(tmp_path / "a.pcd")
    assert np.array_equal(back.points, POINTS)
    assert np.array_equal(back.attributes["intensity"], np.arange(500))


@pytest.mark.parametrize("kind", ["pts", "xyzrgb", "xyzn"])
def test_text_of_open3d(kind: str, tmp_path: Path) -> None:
    cloud = exported(tmp_path / f"a.{kind}")
    assert np.allclose(cloud.points, POINTS, atol=1e-9)
    if kind == "xyzn":
        assert np.array_equal(cloud.normals, NORMALS)  # type: ignore[arg-type]
        assert cloud.colors is None
    else:
        assert np.array_equal(cloud.colors, RGB)  # type: ignore[arg-type]
    assert [*cloud.attributes] == (["intensity"] if kind == "pts" else [])


def pcd(body: bytes, **lines: str) -> bytes:
    header = {
        "VERSION": ".7",
        "FIELDS": "x y z",
        "SIZE": "4 4 4",
        "TYPE": "F F F",
        "COUNT": "1 1 1",
        "WIDTH": "2",
        "HEIGHT": "1",
        "VIEWPOINT": "0 0 0 1 0 0 0",
        "POINTS": "2",
        "DATA": "ascii",
    } | lines
    text = "# .PCD v.7\n" + "".join(f"{key} {value}\n" for key, value in header.items())
    return text.encode() + body


FOUR = {"SIZE": "4 4 4 4", "COUNT": "1 1 1 1"}


@pytest.mark.parametrize(
    ("kind", "values"),
    [("F", "9.14767e-41"), ("U", "65280"), ("F", "65280"), ("I", "65280")],
)
def test_packed_colours_in_all_forms(kind: str, values: str) -> None:
    body = f"1 2 3 {values}\n4 5 6 {values}\n".encode()
    cloud = loaded(pcd(body, FIELDS="x y z rgb", TYPE=f"F F F {kind}", **FOUR), "pcd")
    assert cloud.colors is not None
    assert cloud.colors.tolist() == [[0, 255, 0]] * 2


def test_bits_of_nan_are_colours_in_binary() -> None:
    rows = struct.pack("<fffIfffI", 1, 2, 3, 0xFFFF8001, 4, 5, 6, 0x80010203)
    head = {"FIELDS": "x y z rgba", "TYPE": "F F F F", "DATA": "binary", **FOUR}
    cloud = loaded(pcd(rows, **head), "pcd")
    assert cloud.colors is not None
    assert cloud.colors.tolist() == [[255, 128, 1, 255], [1, 2, 3, 128]]


def test_nan_as_text_is_no_colour() -> None:
    body = b"1 2 3 nan\n4 5 6 1e-40\n"
    cloud = loaded(pcd(body, FIELDS="x y z rgb", TYPE="F F F F", **FOUR), "pcd")
    assert cloud.colors is None
    assert np.isnan(cloud.attributes["rgb"][0])


def test_fields_of_many_values_and_padding() -> None:
    head = {"FIELDS": "x y _ hist", "SIZE": "8 8 1 2", "TYPE": "F F U I", "COUNT": "1 1 4 2"}
    row = np.dtype([("p", "<f8", 2), ("_", "u1", 4), ("h", "<i2", 2)])
    rows = np.array([((1, 2), 7, (-5, 6)), ((3, 4), 7, (7, 8))], dtype=row)
    cloud = loaded(pcd(rows.tobytes(), DATA="binary", **head), "pcd")
    assert cloud.points.tolist() == [[1, 2, 0], [3, 4, 0]]
    assert cloud.attributes["hist"].tolist() == [[-5, 6], [7, 8]]
    assert [*cloud.attributes] == ["hist"]
    text = loaded(pcd(b"1 2 7 7 7 7 -5 6\n3 4 7 7 7 7 7 8\n", **head), "pcd")
    assert text.attributes["hist"].tolist() == [[-5, 6], [7, 8]]
    assert text.attributes["hist"].dtype == np.int16


def test_what_a_pcd_says_of_the_whole() -> None:
    head = {"WIDTH": "1", "HEIGHT": "2", "VIEWPOINT": "1 2 3 1 0 0 0"}
    cloud = loaded(pcd(b"1 2 3\nnan nan nan\n", **head), "pcd")
    assert cloud.metadata["grid"] == (1, 2)
    assert cloud.metadata["viewpoint"] == (1, 2, 3, 1, 0, 0, 0)
    assert np.isnan(cloud.points[1]).all()
    assert len(loaded(pcd(b"", POINTS="0"), "pcd")) == 0
    lying = loaded(pcd(b"1 2 3\n4 5 6\n", WIDTH="5", HEIGHT="2"), "pcd")
    assert "grid" not in lying.metadata


def packed(data: bytes, size: int = 24) -> bytes:
    return pcd(struct.pack("<II", len(data), size) + data, DATA="binary_compressed")


@pytest.mark.parametrize(
    ("data", "cause"),
    [
        (packed(b"", 99), "state 99 bytes, but the header"),
        (packed(b"\x40\x01\x00"), "refer to what is not there"),
        (packed(b"\xe0"), "end within a copy"),
        (packed(b"\x00a"), "do not expand to 24 bytes"),
        (b"hello\n", "not a PCD file: unknown or repeated header line 'HELLO'"),
        (b"VERSION .7\nFIELDS x", "does not end"),
        (pcd(b"1 2 3\n"), "promises 2 points, but 1"),
        (pcd(b"1 2 3\n" * 3), "more rows follow"),
        (pcd(b"1 2 3\n1 2 a\n"), "line 13, value 3: 'a' is not a number"),
        (pcd(b"", DATA="zip"), "unknown data 'zip'"),
        (pcd(b"", TYPE="F F"), "SIZE, TYPE and COUNT need a value for each"),
        (pcd(b"", SIZE="4 4 2"), "the size '2'"),
        (pcd(b"", FIELDS="x y y"), "two fields of the header have one name"),
        (pcd(b"1 2 3\n1 2 3\n", FIELDS="a b c"), "no fields x and y"),
        (pcd(b"", WIDTH="-2"), "WIDTH is '-2'"),
        (pcd(b"", VIEWPOINT="0"), "VIEWPOINT is '0'"),
        (pcd(b"1234", DATA="binary"), r"byte \d+: the points should take 24 bytes"),
        (pcd(bytes(36), DATA="binary"), "more rows follow"),
        (pcd(b"", DATA="binary", POINTS="1", COUNT="1 1 999999999"), "should take 4000"),
        (
            pcd(struct.pack("<II", 3, 99), DATA="binary_compressed"),
            "state 99 bytes, but the header",
        ),
        (
            pcd(struct.pack("<II", 3, 24) + b"\x40\x01\x00", DATA="binary_compressed"),
            "refer to what",
        ),
        (
            pcd(struct.pack("<II", 2, 24) + b"\x00a", DATA="binary_compressed"),
            "do not expand to 24",
        ),
    ],
)
def test_invalid_pcd_files_are_refused(data: bytes, cause: str) -> None:
    with pytest.raises(FormatError, match=cause):
        loaded(data, "pcd")


def test_lzf_stops_at_the_size_that_is_stated() -> None:
    with pytest.raises(ValueError, match="do not expand to 10 bytes"):
        decompress(b"\x00a" + b"\xe0\xff\x00" * 1_000_000, 10)


@pytest.mark.parametrize(
    ("text", "attributes", "colors"),
    [
        (b"2\n1 2 3\n4 5 6\n", [], None),
        (b"2\r\n1 2 3 -1024\r\n4 5 6 7\r\n", ["intensity"], None),
        (b"2\n1 2 3 255 0 1\n4 5 6 7 8 9\n", [], [[255, 0, 1], [7, 8, 9]]),
        (b"1\n1 2 3 -5 255 0 1\n1\n4 5 6 0 7 8 9\n", ["intensity"], [[255, 0, 1], [7, 8, 9]]),
        (b"1 2 3\n4 5 6\n", [], None),
    ],
)
def test_pts_of_scanners(text: bytes, attributes: list[str], colors: Any) -> None:
    cloud = loaded(text, "pts")
    assert cloud.points.tolist() == [[1, 2, 3], [4, 5, 6]]
    assert [*cloud.attributes] == attributes
    assert (None if cloud.colors is None else cloud.colors.tolist()) == colors
    assert cloud.metadata.get("scans") == (2 if text.startswith(b"1\n") else None)


@pytest.mark.parametrize(
    ("kind", "text", "cause"),
    [
        ("pts", b"3\n1 2 3\n", "promises 3 points, but 1"),
        ("pts", b"1\n1 2 3 4 5\n", "line 2: .* has 5 values"),
        ("pts", b"1\n1 2 3\n1\n1 2 3 4\n", "line 4: expected 3 values, found 4"),
        ("pts", b"0\n", "no points"),
        ("pts", b"1\n1 2 3\n4 5 6\n", "line 3: more points follow"),
        ("pts", b"1 2 3\n2\n1 2 3\n4 5 6\n", "line 2: expected 3 values, found 1"),
        ("xyzrgb", b"1 2 3 4 5\n", "line 1: expected 6 values"),
        ("xyzn", b"1 2 3 0 0 1\n1 2\n", "line 2: expected 6 values"),
        ("xyzn", b"# nothing\n", "no points"),
    ],
)
def test_invalid_lines_are_refused(kind: str, text: bytes, cause: str) -> None:
    with pytest.raises(FormatError, match=cause):
        loaded(text, kind)


def test_numbers_that_are_no_colours_stay_values() -> None:
    cloud = loaded(b"1 2 3 -5 0 0\n", "xyzrgb")
    assert cloud.colors is None
    assert cloud.attributes["red"].tolist() == [-5]


# The files that the documentation of Triangle shows: a square with a marker, counted from 1.
NODE = b"# a square\n4 2 1 1\n1 0 0 0.5 1\n2 1 0 1.5 1\n3 1 1 2.5 1\n4 0 1 3.5 0\n# End\n"
ELE = b"2 3 0\n1 1 2 3\n2 1 3 4\n"


def test_node_and_ele(tmp_path: Path) -> None:
    (tmp_path / "A.1.node").write_bytes(NODE)
    (tmp_path / "A.1.ele").write_bytes(ELE)
    points, mesh = liftmesh.read(tmp_path / "A.1.node"), liftmesh.read(tmp_path / "A.1.ele")
    assert points.faces is None
    assert mesh.faces is not None
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3]]
    for cloud in (points, mesh):
        assert cloud.points.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
        assert cloud.attributes["attribute_1"].tolist() == [0.5, 1.5, 2.5, 3.5]
        assert cloud.attributes["boundary_marker"].tolist() == [1, 1, 1, 0]
    assert liftmesh.verify(mesh.points[:, :2], mesh.faces).valid


def test_six_nodes_and_attributes_of_triangles_are_named(tmp_path: Path) -> None:
    (tmp_path / "A.node").write_bytes(b"3 3 0 0\n0 0 0 5\n1 1 0 6\n2 0 1 7\n")
    (tmp_path / "A.ele").write_bytes(b"1 6 1\n0 0 1 2 0 1 2 9.5\n")
    mesh = liftmesh.read(tmp_path / "A.ele")
    assert mesh.points[:, 2].tolist() == [5, 6, 7]
    assert mesh.metadata["not_read"] == ("1 attribute of triangles", "midpoints of edges")


@pytest.mark.parametrize(
    ("node", "ele", "cause"),
    [
        (b"a b\n", ELE, "A.node: line 1: expected the numbers of points"),
        (b"4 5 0 0\n", ELE, "expected points of dimension 2 or 3"),
        (b"2 2 0 0\n1 0 0\n3 1 1\n", ELE, "row 2 has the index 3, not 2"),
        (b"2 2 0 0\n1 0 0\n", ELE, "promises 2 points, but 1"),
        (b"1 2 0 0\n1 0 0\n2 0 0\n", ELE, "more rows follow"),
        (b"1 2 0 1\n1 0 0 0.5\n", ELE, "an index or marker is 0.5"),
        (NODE, b"1 4 0\n1 1 2 3 4\n", "elements of 4 nodes are no triangles"),
        (NODE, b"1 3 0\n1 1 2 5\n", "face 0 refers to vertex 4"),
        (NODE, b"1 3 0\n1 0 2 3\n", "face 0 refers to vertex -1"),
        (NODE, b"1 3 0\n1 1 2 2.5\n", "which is not int32"),
    ],
)
def test_invalid_triangle_files_are_refused(
    node: bytes, ele: bytes, cause: str, tmp_path: Path
) -> None:
    (tmp_path / "A.node").write_bytes(node)
    (tmp_path / "A.ele").write_bytes(ele)
    with pytest.raises(FormatError, match=cause):
        liftmesh.read(tmp_path / "A.ele")


def test_triangles_are_no_points_whatever_tells_the_format(tmp_path: Path) -> None:
    lines = b"2 3 1\n0 0 1 2 7\n1 0 2 3 7\n"  # as points: an index, three coordinates, a value
    with pytest.raises(FormatError, match="give a path"):
        loaded(lines, "ele")
    (tmp_path / "a.txt").write_bytes(lines)
    (tmp_path / "a.node").write_bytes(NODE)
    with pytest.raises(FormatError, match=r"index 0, not 1: .* counted from 1 as in .*a\.node"):
        liftmesh.read(tmp_path / "a.txt", format="ele")
    with (tmp_path / "a.txt").open("rb") as stream, pytest.raises(FormatError, match="index 0"):
        liftmesh.read(stream, format="ele")


def test_compressed_triangles_of_any_spelling(tmp_path: Path) -> None:
    (tmp_path / "A.node.gz").write_bytes(gzip.compress(NODE))
    (tmp_path / "A.ELE.GZ").write_bytes(gzip.compress(ELE))
    faces = liftmesh.read(tmp_path / "A.ELE.GZ").faces
    assert faces is not None
    assert faces.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_links_to_points_in_other_folders_are_refused(tmp_path: Path) -> None:
    """The error would show a line of any file of the machine."""
    inside, outside = tmp_path / "inside", tmp_path / "outside"
    for folder in (inside, outside):
        folder.mkdir()
        (folder / "A.ele").write_bytes(ELE)
    (outside / "A.node").write_bytes(b"secret\n")
    (inside / "A.node").symlink_to(outside / "A.node")
    with pytest.raises(FormatError, match=r"inside/A\.node, are a link to another folder"):
        liftmesh.read(inside / "A.ele")
    (outside / "A.node").write_bytes(NODE)
    (inside / "A.ele").unlink()
    (inside / "A.ele").symlink_to(outside / "A.ele")  # both are links to one folder
    assert len(liftmesh.read(inside / "A.ele")) == 4


def test_triangles_without_points_are_refused(tmp_path: Path) -> None:
    (tmp_path / "A.ele").write_bytes(ELE)
    with pytest.raises(FormatError, match=r"A\.node, which does not exist"):
        liftmesh.read(tmp_path / "A.ele")


def test_very_many_fields_are_limited() -> None:
    names = " ".join(f"f{k}" for k in range(10_001))
    with pytest.raises(FormatError, match="expands to 20,002,000 bytes"):
        loaded(f"FIELDS {names}\nDATA ascii\n".encode(), "pcd")
    with pytest.raises(FormatError, match="raise it with max_bytes="):
        loaded(b"1 2 10001 0\n", "node")
