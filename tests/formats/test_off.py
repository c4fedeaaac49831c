"""OFF: digits that bring every value back, and files as other programs write them."""

from __future__ import annotations

import numpy as np
import pytest
from file_samples import AWKWARD, FACES, assert_same_bits, assert_same_mesh, loaded, saved

from liftmesh import Cloud, FormatError

SQUARE = "0 0 0\n1 0 0\n\n1 1 0 # last but one\n0 1 0\n"


def test_every_digit_comes_back() -> None:
    mesh = Cloud(AWKWARD, faces=FACES)
    data = saved(mesh, "off")
    assert data.startswith(b"OFF\n5 3 0\n0.1 0.2 0.30000000000000004\n")
    assert data.endswith(b"3 4 3 1\n")
    assert_same_mesh(loaded(data, "off"), mesh)
    assert_same_mesh(loaded(saved(Cloud(AWKWARD), "off"), "off"), Cloud(AWKWARD))


@pytest.mark.parametrize("head", ["OFF\n# made by hand\n4 {} 0\n", "OFF 4 {} 0\r\n"])
@pytest.mark.parametrize(
    "faces", ["4 0 1 2 3 0.5 0.5 0.5\n", "3 0 1 2\n3 0 2 3\n", "3 0 1 2 255 0 0\n3 0 2 3\n"]
)
def test_faces_with_and_without_colours(head: str, faces: str) -> None:
    mesh = loaded(f"{head.format(faces.count(chr(10)))}{SQUARE}{faces}".encode(), "off")
    assert mesh.points.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    assert mesh.faces is not None
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_faces_of_mixed_sizes() -> None:
    mesh = loaded(f"OFF\n4 3 0\n{SQUARE}4 0 1 2 3\n2 0 1\n3 3 2 1\n".encode(), "off")
    assert mesh.faces is not None
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3], [3, 2, 1]]
    assert mesh.metadata["polygons"] == 1
    assert mesh.metadata["degenerate_faces"] == 1


def test_colours_and_normals_of_vertices() -> None:
    colored = loaded(b"COFF\n1 0 0\n1 2 3 255 0 7 255\n", "off")
    assert_same_bits(colored.colors, np.array([[255, 0, 7, 255]], dtype=np.uint8))
    normal = loaded(b"NOFF\n1 0 0\n1 2 3 0 0.6 0.8\n", "off")
    assert_same_bits(normal.normals, np.array([[0, 0.6, 0.8]]))


@pytest.mark.parametrize(
    ("text", "cause"),
    [
        ("PFF\n", "'PFF' is none of OFF"),
        ("OFF BINARY\n", "no counts"),
        ("OFF\n", "line 1: no counts"),
        ("OFF\n3\n", "line 2: no counts"),
        ("OFF\n3 x 0\n", "line 2: 'x' is no count"),
        ("OFF\n-3 1 0\n", "line 2: '-3' is no count"),
        ("OFF\n0 0 0\n", "no vertices"),
        ("OFF\n3 0 0\n0 0 0\n0 0 0\n", "line 4: the file ends, but its counts promise 1 more"),
        ("OFF\n99999999999999 1 0\n0 0 0\n", "promise 99999999999998 more"),
        ("OFF\n2 0 0\n0 0 0\n0 0\n", "line 4: expected 3 values, found 2"),
        ("OFF\n1 0 0\n0 0\n", "needs more than 2 values"),
        ("COFF\n1 0 0\n0 0 0\n", "needs more than 3 values"),
        ("OFF\n1 0 0\n0 zero 0\n", "line 3, value 2: 'zero' is not a number"),
        ("OFF\n1 1 0\n0 0 0\n", "line 3: the file ends, but its counts promise 1 more"),
        ("OFF\n1 1 0\n0 0 0\n3 0 0\n", "line 4: expected 4 values, found 3"),
        ("OFF\n1 1 0\n0 0 0\nx 0 0\n", "line 4: 'x' is no count"),
        ("OFF\n1 1 0\n0 0 0\nnan 0 0\n", "line 4: 'nan' is no count"),
        ("OFF\n1 1 0\n0 0 0\n3 0 0 x\n", "line 4, value 4: 'x' is not a number"),
        ("OFF\n1 1 0\n0 0 0\n3 0 0 0.5\n", "line 4: a vertex is 0.5"),
        ("OFF\n1 1 0\n0 0 0\n3 0 0 1\n", "face 0 refers to vertex 1"),
    ],
)
def test_broken_files_name_the_line(text: str, cause: str) -> None:
    with pytest.raises(FormatError, match=f"<stream>: .*{cause}"):
        loaded(text.encode(), "off")
