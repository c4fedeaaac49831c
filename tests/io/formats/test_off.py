"""OFF: decimals that bring every value back, and files cut short."""

from __future__ import annotations

import numpy as np
import pytest
from file_samples import FACES, assert_same_mesh, loaded, saved

from liftmesh import Cloud, FormatError

SQUARE = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"


@pytest.mark.parametrize("scale", [1.0, 1e-300, 1e290, 5e-324])
def test_every_coordinate_comes_back(scale: float) -> None:
    values = np.array([[0.1, 0.2, 0.3], [450000.1, 5200000.2, 1 / 3], [0, -7, 1e-9]])
    points = np.concatenate([values, values[:2] + 1]) * scale
    assert_same_mesh(
        loaded(saved(Cloud(points, faces=FACES), "off"), "off"), Cloud(points, faces=FACES)
    )


@pytest.mark.parametrize("head", ["OFF\n# made by hand\n4 {} 0\n", "OFF 4 {} 0\r\n"])
@pytest.mark.parametrize("faces", ["4 0 1 2 3 0.5 0.5 0.5\n", "3 0 1 2\n3 0 2 3\n"])
def test_files_of_other_programs(head: str, faces: str) -> None:
    mesh = loaded(f"{head.format(faces.count(chr(10)))}{SQUARE}{faces}".encode(), "off")
    assert mesh.points.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    assert mesh.faces is not None
    assert [sorted(face) for face in mesh.faces.tolist()] == [[0, 1, 2], [0, 2, 3]]


@pytest.mark.parametrize(
    ("text", "cause"),
    [
        ("PFF\n", "not a valid OFF file"),
        ("OFF BINARY\n", "line 1: expected the numbers"),
        ("OFF\n3 x 0\n", "line 2: expected the numbers of vertices and faces"),
        ("OFF\n3\n", "line 2: expected the numbers"),
        ("OFF\n-2 0 0\n0 0 0\n1 0 0\n0 1 0\n", "line 2: expected the numbers"),
        ("OFF\n0 0 0\n", "no vertices"),
        ("OFF\n3 0 0\n0 0 0\n0 0 0\n", "line 4: the header promises 3 vertices, but 2 are there"),
        ("OFF\n1 0 0\n0 zero 0\n", "line 3, value 2: 'zero'"),
        ("OFF\n1 0 0\n0 0\n", "line 3: a vertex needs x, y and z"),
        (f"OFF\n4 2 0\n{SQUARE}3 0 1 2\n", "promises 2 faces, but 1 are there"),
        (f"OFF\n4 1 0\n{SQUARE}3 0 1 2\n3 0 2 3\n", "line 8: more rows follow"),
        (f"OFF\n4 1 0\n{SQUARE}3 0 1 9\n", "face 0 refers to vertex 9"),
        (f"OFF\n4 1 0\n{SQUARE}3 0 1 -1\n", "face 0 refers to vertex -1"),
        (f"OFF\n4 2 0\n{SQUARE}3 0 1 2\n4 0 1 2\n", "line 8: '4 0 1 2' is not a face"),
        (f"OFF\n4 1 0\n{SQUARE}3 0 1 1.5\n", "line 7: '3 0 1 1.5' is not a face"),
        (f"OFF\n4 1 0\n{SQUARE}{2**31} 0 1 2\n", "line 7"),
    ],
)
def test_broken_files_are_named(text: str, cause: str) -> None:
    with pytest.raises(FormatError, match=f"<stream>: .*{cause}"):
        loaded(text.encode(), "off")


def test_faces_of_every_size_are_triangles_in_their_order() -> None:
    colored = SQUARE.replace(" 0\n", " 0 255 0 0 255\n")
    mesh = loaded(f"COFF\n4 4 0\n{colored}2 0 1\n4 0 1 2 3 9 9 9\n3 3 2 1\n0\n".encode(), "off")
    assert mesh.faces is not None
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3], [3, 2, 1]]
    assert mesh.metadata["polygons"] == 1
    assert mesh.metadata["degenerate_faces"] == 2


def test_points_alone() -> None:
    mesh = loaded(f"OFF 4 0\n{SQUARE}".encode(), "off")
    assert (len(mesh), mesh.faces) == (4, None)


def test_faces_are_needed() -> None:
    with pytest.raises(FormatError, match="without faces"):
        saved(Cloud(np.zeros((3, 3))), "off")
