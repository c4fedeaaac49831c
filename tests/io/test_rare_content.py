"""Valid content that files rarely have: read as it is meant, or refused by name."""

from __future__ import annotations

import io
import struct

import numpy as np
import pytest
import trimesh
from file_samples import assert_same_bits, loaded, saved, small_mesh

from liftmesh import Cloud, FormatError

VERTICES = "element vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
POINTS = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 2.0], [1.0, 1.0, 3.0], [0.0, 1.0, 4.0]])
ROWS = "0 0 1\n1 0 2\n1 1 3\n0 1 4\n"
READ_AT_A_TIME = 1 << 22


def ply(elements: str, body: bytes, encoding: str = "ascii") -> Cloud:
    header = f"ply\nformat {encoding} 1.0\n{elements}end_header\n"
    return loaded(header.encode() + body, "ply")


def test_two_lists_whose_lengths_make_up_for_each_other() -> None:
    lists = "property list uchar int vertex_indices\nproperty list uchar int near\n"
    body = f"{ROWS}3 0 1 2 1 7\n2 0 1 2 7 7\n4 0 1 2 3 0\n"
    cloud = ply(f"{VERTICES}element face 3\n{lists}", body.encode())
    assert cloud.faces is not None
    assert cloud.faces.tolist() == [[0, 1, 2], [0, 1, 2], [0, 2, 3]]


def test_a_face_of_three_hundred_corners() -> None:
    angle = np.arange(300) * (2 * np.pi / 300)
    points = np.column_stack([np.cos(angle), np.sin(angle), angle])
    elements = (
        VERTICES.replace("4", "300") + "element face 1\nproperty list uint int vertex_index\n"
    )
    face = struct.pack("<I", 300) + np.arange(300, dtype="<i4").tobytes()
    cloud = ply(elements, points.tobytes() + face, "binary_little_endian")
    assert cloud.faces is not None
    assert cloud.faces.shape == (298, 3)
    assert sorted(np.unique(cloud.faces)) == [*range(300)]


@pytest.mark.parametrize("encoding", ["ascii", "binary_little_endian"])
def test_faces_without_corners(encoding: str) -> None:
    body = f"{ROWS}0.5\n0.25\n".encode()
    if encoding != "ascii":
        body = POINTS.tobytes() + struct.pack("<2f", 0.5, 0.25)
    cloud = ply(f"{VERTICES}element face 2\nproperty float quality\n", body, encoding)
    assert cloud.faces is None
    assert_same_bits(cloud.points, POINTS)
    assert cloud.metadata["not_read"] == ("face property quality (2 rows)",)


def test_an_obj_line_goes_on_where_a_block_ends() -> None:
    begin = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
    comment = "#" * (READ_AT_A_TIME - len(begin) - 3)
    cloud = loaded(f"{begin}{comment}\nf 1 \\\n2 \\\n3\n".encode(), "obj")
    assert cloud.faces is not None
    assert cloud.faces.tolist() == [[0, 1, 2]]


def test_an_obj_file_ends_in_a_backslash() -> None:
    assert loaded(b"v 0 0 0\nv 1 2 3 \\\n", "obj").points.tolist() == [[0, 0, 0], [1, 2, 3]]


def test_digits_of_other_scripts_are_no_numbers() -> None:
    with pytest.raises(FormatError, match=r"<stream>: line 1, value 3: '\u0663'"):
        loaded("1 2 \u0663\n4 5 6\n".encode(), "xyz")


def test_numpy_arrays_of_the_second_layout() -> None:
    stream = io.BytesIO()
    np.lib.format.write_array(stream, POINTS, version=(2, 0))
    assert_same_bits(loaded(stream.getvalue(), "npy").points, POINTS)


@pytest.mark.parametrize(
    "told",
    ["north", [1.0, 2.0], {"x": 1.0}, ["1", "2", "3"], [True, 0, 3], [None] * 3, [10**400, 0, 0]],
)
def test_an_origin_is_three_finite_numbers(told: object) -> None:
    mesh = trimesh.Trimesh(small_mesh().points, small_mesh().faces, process=False)
    data = trimesh.Scene(mesh, metadata={"origin": told}).export(file_type="glb")
    with pytest.raises(FormatError, match=r"<stream>: the origin is .*: expected three finite"):
        loaded(data, "glb")


def test_an_origin_too_long_for_stl() -> None:
    point = Cloud(np.full((1, 3), -1.2345678901234567e-100), faces=np.zeros((1, 3), dtype=np.int32))
    with pytest.raises(FormatError, match="does not fit the header of STL"):
        saved(point, "stl")
