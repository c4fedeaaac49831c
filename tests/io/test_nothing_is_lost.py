"""What a file holds beyond its counts, and what a format has no place for, is never lost unsaid."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from file_samples import loaded, saved

import liftmesh
from liftmesh import Cloud, FormatError

FULL = Cloud(
    np.eye(3),
    colors=np.zeros((3, 3), dtype=np.uint8),
    normals=np.eye(3),
    attributes={"class": np.arange(3), "age": np.ones(3)},
    faces=np.array([[0, 1, 2]], dtype=np.int32),
)


def test_ply_text_with_more_rows_than_promised() -> None:
    text = saved(Cloud(np.eye(3)), "ply", encoding="ascii")
    assert len(loaded(text + b"\n\n", "ply")) == 3
    with pytest.raises(FormatError, match=r"line \d+: more rows follow than the header promises"):
        loaded(text + b"5 5 5\n", "ply")


def test_binary_ply_with_more_rows_than_promised() -> None:
    data = saved(Cloud(np.eye(3)), "ply")
    assert len(loaded(data + b"\0\n", "ply")) == 3
    with pytest.raises(FormatError, match=r"byte \d+: 24 bytes follow the rows"):
        loaded(data + np.ones(3).tobytes(), "ply")


@pytest.mark.parametrize(
    ("kind", "dropped"),
    [
        ("ply", ()),
        ("npz", ()),
        ("obj", ("age", "class")),
        ("glb", ()),
        ("off", ("colors", "normals", "age", "class")),
        ("stl", ("colors", "normals", "age", "class")),
    ],
)
def test_the_writer_says_what_the_format_does_not_keep(
    kind: str, dropped: tuple[str, ...], tmp_path: Path
) -> None:
    assert liftmesh.write(tmp_path / f"mesh.{kind}", FULL).dropped == dropped
    assert liftmesh.write(io.BytesIO(), FULL, format=kind).dropped == dropped


def test_off_without_faces_is_a_cloud() -> None:
    cloud = loaded(b"OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n", "off")
    assert (len(cloud), cloud.faces) == (3, None)


@pytest.mark.parametrize("kind", ["stl", "glb"])
def test_coordinates_that_no_float32_holds(kind: str) -> None:
    points = np.array([[1e308, 0, 0], [-1e308, 0, 0], [0, 1, 0]])
    with pytest.raises(FormatError, match="do not fit the single precision"):
        saved(Cloud(points, faces=FULL.faces), kind)


def test_attributes_are_named_whatever_their_names() -> None:
    names = ("metadata", "attributes", "faces")
    cloud = Cloud(
        np.eye(3),
        attributes={name: np.arange(3) for name in names},
        faces=FULL.faces,
    )
    for metadata in ({}, {"survey": 2024}):
        described = replace(cloud, metadata=metadata)
        dropped = liftmesh.write(io.BytesIO(), described, format="off").dropped
        assert sorted(dropped) == sorted([*names, *(f"metadata {key}" for key in metadata)])


def test_a_mesh_without_a_face_loses_none() -> None:
    cloud = Cloud(np.eye(3), faces=np.zeros((0, 3), dtype=np.int32))
    assert liftmesh.write(io.BytesIO(), cloud, format="csv").dropped == ()
