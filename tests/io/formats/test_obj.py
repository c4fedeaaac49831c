"""OBJ: digits that bring every value back, and files as other programs write them."""

from __future__ import annotations

import re

import numpy as np
import pytest
from file_samples import (
    AWKWARD,
    COLORS,
    FACES,
    NORMALS,
    assert_same_bits,
    assert_same_mesh,
    full_mesh,
    loaded,
    saved,
)

from liftmesh import Cloud, FormatError, InputError

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def read(text: str) -> Cloud:
    return loaded(text.encode(), "obj")


def test_everything_but_attributes_comes_back() -> None:
    assert_same_mesh(loaded(saved(full_mesh(), "obj"), "obj"), full_mesh(), attributes=False)


@pytest.mark.parametrize("faces", [None, FACES])
@pytest.mark.parametrize("normals", [None, NORMALS])
@pytest.mark.parametrize("colors", [None, COLORS])
def test_every_combination(
    faces: np.ndarray | None, normals: np.ndarray | None, colors: np.ndarray | None
) -> None:
    mesh = Cloud(AWKWARD, faces=faces, normals=normals, colors=colors)
    assert_same_mesh(loaded(saved(mesh, "obj"), "obj"), mesh)


def test_the_text_of_a_small_mesh() -> None:
    mesh = Cloud(
        np.array([[0.1, -0.0, 1e300]]),
        colors=np.array([[0, 128, 255]], dtype=np.uint8),
        normals=np.array([[0.0, 0.6, 0.8]]),
        faces=np.zeros((1, 3), dtype=np.int32),
    )
    assert saved(mesh, "obj", comments="by hand") == (
        b"# liftmesh\n# by hand\nv 0.1 -0.0 1e+300 0.0 0.5019608 1.0\nvn 0.0 0.6 0.8\n"
        b"f 1//1 1//1 1//1\n"
    )


def test_all_eight_bit_levels_come_back() -> None:
    levels = np.arange(256, dtype=np.uint8).repeat(3).reshape(-1, 3)
    back = loaded(saved(Cloud(np.zeros((256, 3)), colors=levels), "obj"), "obj")
    assert_same_bits(back.colors, levels)


def test_other_colours() -> None:
    floats = np.array([[0.1, 0.2, 0.3], [1 / 3, 0.0, 1.0]])
    assert_same_bits(loaded(saved(Cloud(AWKWARD[:2], colors=floats), "obj"), "obj").colors, floats)
    wide = np.array([[0, 257, 65535], [512, 0, 65535]], dtype=np.uint16)
    back = loaded(saved(Cloud(AWKWARD[:2], colors=wide), "obj"), "obj").colors
    assert back is not None
    np.testing.assert_array_equal(np.rint(back * 65535), wide)
    alpha = np.array([[1, 2, 3, 4]], dtype=np.uint8)
    back = loaded(saved(Cloud(AWKWARD[:1], colors=alpha), "obj"), "obj").colors
    assert_same_bits(back, alpha[:, :3].copy())


def test_colours_of_other_programs() -> None:
    eight = read("v 0 0 0 0.501961 1.000000 0.003922\n")
    assert_same_bits(eight.colors, np.array([[128, 255, 1]], dtype=np.uint8))
    whole = read("v 0 0 0 128 255 1\n")
    assert_same_bits(whole.colors, np.array([[128, 255, 1]], dtype=np.uint8))
    alpha = read("v 0 0 0 1 0 0 0.2\n")
    assert_same_bits(alpha.colors, np.array([[255, 0, 0, 51]], dtype=np.uint8))
    none = read("v 0 0 0 -1 0 0.5\n")
    assert none.colors is None
    assert none.attributes["color"].tolist() == [[-1.0, 0.0, 0.5]]


@pytest.mark.parametrize(
    "faces",
    [
        "f 1 2 3\nf 1 3 4\n",
        "f 1 2 3 4\n",
        "f 1/1 2/1 3/1 4/1\n",
        "f 1/1/1 2/1/1 3/1/1 4/1/1\n",
        "f 1//1 2//1 3//1 4//1\n",
        "f 1/ 2 3/1 4//1\n",
        "f -4 -3 -2\nf -4 -2 -1\n",
        "f\t1\t2\t3 \\\n4 # the square\n",
        "f 1 2 3\r\n\r\nf 1 3 4\r\n",
        "  f 1 2 3\nf 1 3 4",
    ],
)
def test_faces_in_every_spelling(faces: str) -> None:
    for end in ("\n", "\r\n", "\r"):
        found = read(f"vn 0 0 1\nvt 0 0\n{SQUARE}".replace("\n", end) + faces).faces
        assert found is not None
        assert found.tolist() == [[0, 1, 2], [0, 2, 3]]


def test_backward_indices_count_from_their_own_line() -> None:
    triangle = "v {0} 0 0\nv {0} 1 0\nv {0} 1 1\nvn {0} 0 1\nf -3//-1 -2//-1 -1//-1\n"
    mesh = read(triangle.format(1) + triangle.format(2))
    assert mesh.faces is not None
    assert mesh.normals is not None
    assert mesh.faces.tolist() == [[0, 1, 2], [3, 4, 5]]
    assert mesh.normals[:, 0].tolist() == [1, 1, 1, 2, 2, 2]


def test_faces_may_come_before_their_vertices() -> None:
    mesh = read("f 1 2 3\n" + SQUARE)
    assert mesh.faces is not None
    assert mesh.faces.tolist() == [[0, 1, 2]]


def test_a_continued_line_counts_its_lines() -> None:
    with pytest.raises(FormatError, match="line 6: expected 3 values, found 2"):
        read(f"v 0 \\\n 0 0\n{SQUARE.splitlines()[0]}\nv 1 \\\n1 \\\n\nv 1 1 1\n")


def test_what_says_nothing_about_the_shape_is_counted() -> None:
    mesh = read(f"mtllib a.mtl\no one\nusemtl b_1\n{SQUARE}vt 0 0\nvt 1 0\ns off\nf 1 2 3\n")
    assert mesh.metadata["ignored"] == {
        "mtllib": 1, "o": 1, "usemtl": 1, "vt": 2, "s": 1
    }  # fmt: skip
    assert read("v 1 2 3 1.0\n").metadata["ignored"] == {"weight of v": 1}


def test_normals_by_corner() -> None:
    agree = read(SQUARE + "vn 0 0 1\nvn 1 0 0\nf 1//1 2//2 3//1\n")
    assert agree.normals is not None
    assert agree.normals.tolist() == [[0, 0, 1], [1, 0, 0], [0, 0, 1], [0, 0, 0]]
    differ = read(SQUARE + "vn 0 0 1\nvn 1 0 0\nf 1//1 2//2 3//1\nf 1//2 3//1 4//1\n")
    assert differ.normals is None
    some = read(SQUARE + "vn 0 0 1\nf 1//1 2 3\n")
    assert some.normals is None


def test_more_lines_than_a_block() -> None:
    points = np.random.default_rng(1).random((150_000, 3))
    faces = np.random.default_rng(2).integers(0, 150_000, (200_000, 3)).astype(np.int32)
    mesh = Cloud(points, faces=faces)
    assert_same_mesh(loaded(saved(mesh, "obj"), "obj"), mesh)


@pytest.mark.parametrize(
    ("text", "cause"),
    [
        ("", "empty"),
        ("# nothing\n", "no 'v' line"),
        ("solid cube\nendsolid\n", "no 'v' line"),
        ("v 1 2\n", "line 1: a vertex has 3 coordinates"),
        ("v 1 2 3\nv 1 2\n", "line 2: expected 3 values, found 2"),
        ("v 1 2 3\nv 1 2 3 4\n", "line 2: expected 3 values, found 4"),
        ("v 1 2 3\n\nv 1 x 3\n", "line 3, value 2: 'x' is not a number"),
        ("v 1 2,5 3\n", "line 1, value 2: '2,5' is not a number"),
        ("v\n", "line 1: 'v' without values"),
        (SQUARE + "f\n", "line 5: 'f' without values"),
        (SQUARE + "vn 0 1\n", "line 5: expected 3 values, found 2"),
        (SQUARE + "f 1 2 3\nf 1 2 0\n", "line 6: '0' is not a corner"),
        (SQUARE + "f 1 2 3\nf 1 2 1.5\n", "line 6: '1.5' is not a corner"),
        (SQUARE + "f 1 2 3\nf 1 2 x\n", "line 6: 'x' is not a corner"),
        (SQUARE + "f 1 2 3_0\n", "line 5: '3_0' is not a corner"),
        (SQUARE + "f 1/1/1/1 2 3\n", "line 5: '1/1/1/1' is not a corner"),
        (SQUARE + "f 1//0 2//1 3//1\n", "line 5: '1//0' is not a corner"),
        (SQUARE + "f 1 2 99999999999999999999\n", "line 5: '99999999999999999999' is not a corner"),
        (SQUARE + "f 1 2/9999999999 2147483648/1\n", "line 5: '2147483648/1' is not a corner"),
        (SQUARE + "f 1 2 3//2147483648\n", "line 5: '3//2147483648' is not a corner"),
        (SQUARE + "f 1 2 inf\n", "line 5: 'inf' is not a corner"),
        (SQUARE + "f 1 2 5\n", "line 5: face refers to vertex 5, but there are 4 vertices"),
        (SQUARE + "f 1 2 9\n", "line 5: face refers to vertex 9, but there are 4 vertices"),
        (
            SQUARE + "f 1 2 3\nf -5 2 3\n",
            "line 6: face refers back to before the first of 4 vertices",
        ),
        (SQUARE + "vn 0 0 1\nf 1//1 2//1 3//2\n", "line 6: a corner refers to normal 2, but"),
        (
            SQUARE + "vn 0 0 1\nf 1//1 2//1 3//-2\n",
            "line 6: a corner refers back to before the first of 1 normals",
        ),
    ],
)
def test_broken_files_name_the_line(text: str, cause: str) -> None:
    with pytest.raises(FormatError, match=f"<stream>: .*{cause}"):
        read(text)


@pytest.mark.parametrize("texture", ["9999999999", "-2147483649", "0", "9" * 18])
def test_indices_of_textures_are_not_used(texture: str) -> None:
    for form in ("{0}/{1}", "{0}/{1}/1"):
        corners = " ".join(form.format(k, texture) for k in (1, 2, 4))
        cloud = read(SQUARE + f"vn 0 0 1\nf {corners}\n")
        assert cloud.faces is not None
        assert cloud.faces.tolist() == [[0, 1, 3]]


def test_bad_colours_and_comments_are_refused() -> None:
    with pytest.raises(InputError, match="row 0"):
        saved(Cloud(AWKWARD[:1], colors=np.array([[0.0, 2.0, 0.0]])), "obj")
    with pytest.raises(FormatError, match="not a single line"):
        saved(full_mesh(), "obj", comments=["v 1 2 3\nv 4 5 6"])


def test_indices_may_have_a_plus() -> None:
    normals = "vn 0 0 1\n" * 3
    mesh = read(f"{SQUARE}{normals}f +1 +2 3\nf +1/+2/+1 2/-1/2 3//+3\n")
    assert mesh.faces is not None
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 1, 2]]
    for corner in ("+", "1/+", "+-1", "1+", "+0", "1/-/2", "1.0"):
        with pytest.raises(FormatError, match=f"line 5: {re.escape(repr(corner))} is not a corner"):
            read(f"{SQUARE}f {corner} 2 3\n")


def test_chains_are_edges() -> None:
    text = b"v 0 0 1\nv 1 0 2\nv 0 1 3\nl 1/1 2 3\nl 1\nl -1 -3\nf 1 2 3\n"
    cloud = loaded(text, "obj")
    assert cloud.edges is not None
    assert cloud.edges.tolist() == [[0, 1], [1, 2], [2, 0]]
    assert saved(cloud, "obj").endswith(b"f 1 2 3\nl 1 2\nl 2 3\nl 3 1\n")
    assert str(cloud) == "<Cloud of 3 points, 1 face, 3 edges>"


@pytest.mark.parametrize(
    ("line", "cause"),
    [
        ("l 1 9", "line 3: a corner of a chain refers to vertex 9, but there are 2 vertices"),
        ("l 1 -3", "line 3: a corner of a chain refers back to before the first of 2 vertices"),
        ("l 1 x", "line 3: 'x' is not a corner"),
    ],
)
def test_chains_of_vertices_that_are_not_there(line: str, cause: str) -> None:
    with pytest.raises(FormatError, match=cause):
        loaded(f"v 0 0 0\nv 1 0 0\n{line}\n".encode(), "obj")
