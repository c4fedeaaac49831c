"""STL, GLB, glTF and OFF: what single precision keeps, and the origin that it needs."""

from __future__ import annotations

import io
import json
import re
import struct

import numpy as np
import pytest
import trimesh
from file_samples import (
    AWKWARD,
    FACES,
    assert_same_bits,
    assert_same_mesh,
    loaded,
    saved,
    small_mesh,
)
from numpy.typing import NDArray

import liftmesh
from liftmesh import Cloud, FormatError
from liftmesh.io.format import needed_origin

UTM = np.array([450000.0, 5200000.0, 0.0])
SINGLE = ["stl", "glb", "gltf"]


def terrain() -> Cloud:
    """Make a mesh at map coordinates, with heights that need no origin."""
    x, y = np.meshgrid(np.arange(20) * 10.1, np.arange(15) * 9.7)
    points = np.column_stack([x.ravel(), y.ravel(), 300 + 20 * np.sin(x.ravel())]) + UTM
    corner = np.arange(14)[:, None] * 20 + np.arange(19)
    a, b, c, d = (corner.ravel() + step for step in (0, 1, 20, 21))
    faces = np.concatenate([np.column_stack([a, b, c]), np.column_stack([b, d, c])])
    return Cloud(points, faces=faces.astype(np.int32))


def triangles(cloud: Cloud) -> np.ndarray:
    assert cloud.faces is not None
    return cloud.points[cloud.faces]


@pytest.mark.parametrize("kind", SINGLE)
def test_what_single_precision_holds_is_written_as_it_is(kind: str) -> None:
    stream = io.BytesIO()
    written = liftmesh.write(stream, small_mesh(), format=kind)
    assert written.origin is None
    stream.seek(0)
    assert_same_mesh(liftmesh.read(stream, format=kind), small_mesh())


@pytest.mark.parametrize("kind", SINGLE)
def test_map_coordinates_get_an_origin_and_come_back(kind: str) -> None:
    mesh = terrain()
    stream = io.BytesIO()
    written = liftmesh.write(stream, mesh, format=kind)
    assert written.origin == (450000.0, 5200000.0, 0.0)
    assert written.bytes == len(stream.getvalue())
    stream.seek(0)
    back = liftmesh.read(stream, format=kind)
    assert back.metadata["origin"] == written.origin
    np.testing.assert_allclose(triangles(back), triangles(mesh), rtol=0, atol=2e-5)
    assert saved(mesh, kind) == stream.getvalue()


@pytest.mark.parametrize("kind", SINGLE)
def test_other_programs_see_coordinates_without_the_origin(kind: str) -> None:
    mesh = terrain()
    scene = trimesh.load_scene(io.BytesIO(saved(mesh, kind)), file_type=kind, process=False)
    (geometry,) = scene.geometry.values()
    np.testing.assert_array_equal(geometry.triangles, (triangles(mesh) - UTM).astype(np.float32))


def test_files_state_the_origin() -> None:
    mesh = terrain()
    stl = saved(mesh, "stl")
    assert stl[:80].rstrip(b"\0") == b"liftmesh origin 450000.0 5200000.0 0.0"
    assert saved(small_mesh(), "stl")[:80].rstrip(b"\0") == b"liftmesh"
    glb = saved(mesh, "glb")
    tree = json.loads(glb[20 : 20 + struct.unpack_from("<I", glb, 12)[0]])
    noted = [450000.0, 5200000.0, 0.0]
    assert tree["scenes"][0]["extras"]["liftmesh"]["origin"] == noted
    tree = json.loads(saved(mesh, "gltf"))
    assert tree["scenes"][0]["extras"]["liftmesh"]["origin"] == noted


@pytest.mark.parametrize("kind", ["glb", "gltf"])
def test_points_and_colours(kind: str) -> None:
    colors = np.array([[1, 2, 3], [4, 5, 6], [7, 8, 255], [0, 0, 0]], dtype=np.uint8)
    shape = small_mesh()
    for faces in (None, shape.faces):
        cloud = Cloud(shape.points + UTM, colors=colors, faces=faces)
        back = loaded(saved(cloud, kind), kind)
        assert_same_bits(back.points, cloud.points)
        assert back.colors is not None
        np.testing.assert_array_equal(back.colors[:, :3], colors)
        assert (back.faces is None) == (faces is None)


def test_vertices_without_faces_stay_rows() -> None:
    mesh = Cloud(small_mesh().points, faces=np.array([[0, 1, 3]], dtype=np.int32))
    assert_same_mesh(loaded(saved(mesh, "glb"), "glb"), mesh)
    assert len(loaded(saved(mesh, "stl"), "stl")) == 3


def test_stl_vertices_are_one_row_again() -> None:
    back = loaded(saved(terrain(), "stl"), "stl")
    assert len(back) == 300
    assert back.metadata["repeated_vertices"] == 3 * 532 - 300


def test_stl_as_text() -> None:
    text = trimesh.Trimesh([*AWKWARD[:2].tolist(), [0.1, 7, 8]], [[0, 1, 2]], process=False)
    back = loaded(text.export(file_type="stl_ascii").encode(), "stl")
    np.testing.assert_array_equal(triangles(back)[0], text.vertices)


def test_scenes_of_several_meshes_are_put_in_place() -> None:
    part = trimesh.Trimesh(small_mesh().points, small_mesh().faces, process=False)
    scene = trimesh.Scene([part])
    moved = np.eye(4)
    moved[:3, 3] = 10, 20, 30
    scene.add_geometry(trimesh.PointCloud(part.vertices), transform=moved)
    scene.add_geometry(part, transform=moved)
    data = io.BytesIO(scene.export(file_type="glb"))
    back = liftmesh.read(data, format="glb", up="z")
    assert len(back) == 12
    expected = np.concatenate([part.vertices, *[part.vertices + moved[:3, 3]] * 2])
    np.testing.assert_array_equal(sorted(back.points.tolist()), sorted(expected.tolist()))
    assert back.faces is not None
    assert len(back.faces) == 4
    centres = triangles(back).mean(axis=1)
    assert len(np.unique(centres, axis=0)) == 4


@pytest.mark.parametrize(
    ("points", "origin"),
    [
        ([[0, 0, 0], [1, 1, 1]], None),
        ([[-5000.3, 0, 0], [5000.7, 1, 1]], None),
        ([[0, 0, 2000.1], [1e3, 1e3, 2900.3]], None),
        ([[450000.3, 10, 0], [450001.7, 11, 1]], (450000.0, 10.0, 0.0)),
        ([[-450001.7, 10, 0], [-450000.3, 11, 1]], (-450002.0, 10.0, 0.0)),
        ([[1e6 + 0.125, 0, 0], [1e6 + 0.25, 1e-3, 0]], None),
        ([[1e6 + 1 / 3, 0, 0], [1e6 + 1 / 3 + 1e-3, 1e-3, 0]], (1000000.333, 0.0, 0.0)),
        ([[0, 0, 7e6 + 1 / 3], [5, 5, 7e6]], (0.0, 0.0, 7e6)),
        ([[1 / 3, 1e9 + 0.1, 5]], (1 / 3, 1e9 + 0.1, 0.0)),
        ([[1e300, 0, 0], [1e300 + 1e285, 1e285, 0]], "single precision"),
        ([[0, 0, 0], [1e39, 1, 1]], "single precision"),
        ([[0, 0, 0], [1e-320, 5e-324, 0]], "single precision"),
    ],
)
def test_the_origin_is_round_and_only_where_needed(
    points: list[list[float]], origin: tuple[float, ...] | str | None
) -> None:
    if isinstance(origin, str):
        with pytest.raises(FormatError, match=origin):
            needed_origin(np.array(points, dtype=np.float64), "stl")
    elif origin is None:
        assert needed_origin(np.array(points, dtype=np.float64), "stl") is None
    else:
        assert needed_origin(np.array(points), "stl") == pytest.approx(origin, rel=1e-15)


def test_no_points_need_no_origin() -> None:
    assert needed_origin(np.empty((0, 3)), "stl") is None


@pytest.mark.parametrize("kind", SINGLE)
def test_what_cannot_be_written(kind: str) -> None:
    bad = small_mesh().points.copy()
    bad[3, 1] = np.nan
    with pytest.raises(FormatError, match=r"vertex 3 is \[1.0, nan, 2.0\]"):
        saved(Cloud(bad, faces=small_mesh().faces), kind)
    with pytest.raises(FormatError, match="single precision"):
        saved(Cloud(AWKWARD, faces=FACES), kind)


def test_stl_needs_faces_and_only_their_vertices() -> None:
    with pytest.raises(FormatError, match="without faces cannot be written as STL"):
        saved(Cloud(AWKWARD), "stl")
    points = np.concatenate([small_mesh().points, [[np.nan, 1e300, 0]]])
    back = loaded(saved(Cloud(points, faces=small_mesh().faces), "stl"), "stl")
    assert_same_bits(back.points, small_mesh().points)


@pytest.mark.parametrize("kind", ["stl", "glb", "gltf", "off", "obj"])
@pytest.mark.parametrize("faces", [None, np.empty((0, 3), dtype=np.int32)])
def test_nothing_is_written_that_cannot_be_read(kind: str, faces: NDArray[np.int32] | None) -> None:
    with pytest.raises(FormatError, match=f"without (points|faces) .* as {kind.upper()}: write"):
        saved(Cloud(np.empty((0, 3)), faces=faces), kind)
    points = Cloud(small_mesh().points, faces=faces)
    if kind in {"stl", "off"}:
        with pytest.raises(FormatError, match=f"without faces .* as {kind.upper()}: write PLY"):
            saved(points, kind)
    else:
        assert_same_bits(loaded(saved(points, kind), kind).points, points.points)


@pytest.mark.parametrize("kind", SINGLE)
@pytest.mark.parametrize("data", [b"garbage", bytes(200), b"solid\n", b"{}", b"glTF" + bytes(40)])
def test_garbage(kind: str, data: bytes) -> None:
    with pytest.raises(FormatError, match=r"<stream>: (not a valid|the file holds no vertices)"):
        loaded(data, kind)


def test_counts_of_stl_that_lie() -> None:
    data = bytearray(saved(small_mesh(), "stl"))
    data[80:84] = struct.pack("<I", 2**31)
    with pytest.raises(FormatError, match=r"stl|no vertices"):
        loaded(bytes(data), "stl")


def test_a_broken_origin_in_stl() -> None:
    data = saved(terrain(), "stl").replace(b"5200000.0", b"north-by-")
    with pytest.raises(FormatError, match=re.escape("the origin in the header is invalid")):
        loaded(data, "stl")


def test_gltf_with_its_buffers_beside_it(tmp_path: object) -> None:
    folder = str(tmp_path)
    parts = trimesh.Trimesh(small_mesh().points, small_mesh().faces, process=False).export(
        file_type="gltf"
    )
    for name, content in parts.items():
        with open(f"{folder}/{name}", "wb") as file:  # noqa: PTH123
            file.write(content)
    assert_same_mesh(liftmesh.read(f"{folder}/model.gltf", up="z"), small_mesh())
