"""Colours of OBJ files: as values, as comments, or none."""

from __future__ import annotations

import io
from pathlib import Path

import meshio
import numpy as np
import pytest
from file_samples import assert_same_mesh, loaded, saved

import liftmesh
from liftmesh import Cloud, InputError

COLORS = np.random.default_rng(15).integers(0, 256, (130, 3)).astype(np.uint8)
POINTS = np.random.default_rng(16).random((130, 3)) / 3
MESH = Cloud(POINTS, colors=COLORS, faces=np.array([[0, 1, 2]], dtype=np.int32))


@pytest.mark.parametrize("colors", ["comments", "none"])
def test_a_coloured_mesh_has_points_of_three_columns_in_meshio(colors: str, tmp_path: Path) -> None:
    liftmesh.write(tmp_path / "mesh.obj", MESH, colors=colors)
    found = meshio.read(tmp_path / "mesh.obj")
    assert np.array_equal(found.points, POINTS)
    assert found.cells_dict["triangle"].tolist() == [[0, 1, 2]]


@pytest.mark.parametrize("colors", ["values", "comments"])
def test_colours_come_back(colors: str) -> None:
    assert_same_mesh(loaded(saved(MESH, "obj", colors=colors), "obj"), MESH)


def test_the_comments_are_those_of_zbrush() -> None:
    text = saved(Cloud(POINTS[:1] * 0, colors=COLORS[:1]), "obj", colors="comments")
    red, green, blue = COLORS[0].tolist()
    assert text == f"# liftmesh\nv 0.0 0.0 0.0\n#MRGB ff{red:02x}{green:02x}{blue:02x}\n".encode()


def test_what_an_option_loses_is_named() -> None:
    deep = Cloud(POINTS[:2], colors=np.array([[0.5, 0, 0, 1], [1, 1, 1, 0.5]]))
    for colors, dropped in (
        ("values", ("alpha",)),
        ("comments", ("alpha", "colors beyond 8 bits")),
        ("none", ("colors",)),
    ):
        assert liftmesh.write(io.BytesIO(), deep, format="obj", colors=colors).dropped == dropped
    with pytest.raises(InputError, match="colors is 'vertex': give one of 'values', 'comments'"):
        saved(deep, "obj", colors="vertex")


def test_only_alpha_is_named_if_only_alpha_is_deeper_than_a_byte() -> None:
    clear = Cloud(POINTS[:2], colors=np.array([[0, 1, 1, 0.3], [0, 0, 1, 1]]))
    found = liftmesh.write(io.BytesIO(), clear, format="obj", colors="comments")
    assert found.dropped == ("alpha",)


@pytest.mark.parametrize(
    ("text", "is_ignored"),
    [
        (b"v 0 0 0\nv 1 0 0\n#MRGB ff010203FF040506\n", False),
        (b"#MRGB ff010203\r\nv 0 0 0\r\nv 1 0 0\r\n  #MRGB\tff040506\r\n", False),
        (b"v 0 0 0\nv 1 0 0\n#MRGB ff010203\n", True),
        (b"v 0 0 0 0 0 1\nv 1 0 0 0 0 1\n#MRGB ff010203ff040506\n", True),
    ],
)
def test_comments_of_other_programs(text: bytes, is_ignored: bool) -> None:
    cloud = loaded(text, "obj")
    if is_ignored:
        assert cloud.metadata["ignored"] == {"#MRGB": 1}
    else:
        assert cloud.colors is not None
        assert cloud.colors.tolist() == [[1, 2, 3], [4, 5, 6]]


@pytest.mark.parametrize("digits", [b"ff0102", b"xyz", b"ff01020"])
def test_comments_that_only_look_like_it_are_comments(digits: bytes) -> None:
    assert loaded(b"v 0 0 0\n#MRGB " + digits + b"\n", "obj").colors is None


def test_a_mark_between_two_blocks_is_found() -> None:
    for shift in range(7):
        text = b"v 0 0 0\n#" + b"a" * ((1 << 19) - 15 + shift) + b"\n#MRGB ff010203\n"
        assert loaded(text, "obj").colors is not None


def test_colours_are_found_where_comments_fill_a_block(tmp_path: Path) -> None:
    """The reader sees such a block without a line."""
    vertex, block = b"v 1.25 2.5 3.75\n", 1 << 21
    vertices = vertex * (block // len(vertex))
    marks = b"#MRGB " + b"ff010203" * 64 + b"\n"
    path = tmp_path / "painted.obj"
    count = len(vertices) // len(vertex)
    path.write_bytes(vertices + marks * (count // 64))
    assert len(vertices) == block
    colors = liftmesh.read(path).colors
    assert colors is not None
    assert colors.tolist() == [[1, 2, 3]] * count
