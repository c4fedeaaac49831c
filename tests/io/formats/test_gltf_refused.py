"""GLB and glTF: what is refused, and why."""

from __future__ import annotations

import base64
import io
import json
import struct
from typing import Any

import numpy as np
import pytest
from file_samples import loaded
from gltf_models import SQUARE, TRIANGLE, Model, shape

import liftmesh
from liftmesh import FormatError

IDENTITY = np.eye(4).ravel().tolist()

REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "scene -1": ({"scene": -1}, "scene is -1: expected a whole number from 0"),
    "scene true": ({"scene": True}, "scene is True: expected a whole"),
    "scene 1.0": ({"scene": 0.0}, "scene is 0.0: expected a whole"),
    "scene beyond": ({"scene": 1}, "scene is 1, but there are only 1"),
    "scene null": ({"scene": None}, "scene is None: expected a whole"),
    "draco": ({"extensionsRequired": ["KHR_draco_mesh_compression"]}, "requires the extension"),
    "another": ({"extensionsRequired": ["EXT_mesh_features_2"]}, "requires the extension"),
    "a number": ({"extensionsRequired": [3]}, "requires the extension 3"),
    "no list": ({"extensionsRequired": "KHR"}, "extensionsRequired is not a list"),
    "version 1": ({"asset": {"version": "1.0"}}, "its version is '1.0': only glTF 2"),
    "version 3": ({"asset": {"version": 3}}, "its version is '3': only glTF 2"),
    "no list of nodes": ({"scenes": [{"nodes": 0}]}, r"scenes\[0\]: nodes is not a list"),
    "no object": ({"accessors": [3]}, "accessors is not a list of objects"),
    "a list": ({"asset": []}, "asset is not a list of objects"),
    "a cycle": ({"nodes": [{"mesh": 0, "children": [1]}, {"children": [0]}]}, "twice, or within"),
    "two parents": ({"nodes": [{"children": [1, 1]}, {"mesh": 0}]}, r"nodes\[1\] is in the scene"),
    "a root twice": ({"scenes": [{"nodes": [0, 0]}]}, r"nodes\[0\] is in the scene twice"),
    "a node beyond": ({"scenes": [{"nodes": [9]}]}, "nodes is 9, but there are only 2"),
    "a mesh beyond": ({"nodes": [{}, {"mesh": 5}]}, "mesh is 5, but there are only 2"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_trees_that_are_refused(name: str) -> None:
    changes, cause = REFUSED[name]
    model = shape(5)
    model.tree.update(changes)
    model.refused(cause)


@pytest.mark.parametrize(
    ("node", "cause"),
    [
        ({"matrix": [1] * 15}, "expected 16 finite numbers"),
        ({"matrix": [float("nan")] * 16}, "matrix is nan, nan, nan, nan: expected 16 finite"),
        ({"matrix": [1.0] * 16}, "matrix is not affine"),
        ({"matrix": [*IDENTITY[:11], 2e-5, *IDENTITY[12:]]}, "matrix is not affine"),
        ({"matrix": [*IDENTITY[:15], 0.0]}, "matrix is not affine"),
        ({"translation": [1, 2, True]}, "translation is 1, 2, True: expected 3 finite numbers"),
        ({"translation": ["1", 2, 3]}, "translation is '1', 2, 3: expected"),
        ({"translation": [10**400, 2, 3]}, "translation is 10{36}..., 2, 3: expected"),
        ({"translation": {"x": 1}}, "translation is dict: expected"),
        ({"translation": [[[1]], 2, 3]}, "translation is list, 2, 3: expected"),
        ({"rotation": [0, 0, 0, 0]}, "rotation is zero"),
        ({"rotation": [0, 0, 1]}, "expected 4 finite numbers"),
        ({"scale": 2}, "scale is 2: expected 3 finite numbers"),
    ],
)
def test_transformations_that_are_none(node: dict[str, Any], cause: str) -> None:
    shape(5, **node).refused(cause)


def test_places_beyond_doubles() -> None:
    model = shape(5, scale=[1e200] * 3, children=[2])
    model.node(scale=[1e200] * 3, mesh=0, root=False)
    model.refused(r"nodes\[2\]: its place is beyond double precision")


def test_numbers_of_the_wrong_type_or_count() -> None:
    for key, values, cause in (
        ("indices", np.zeros(3, "<f4"), "indices is SCALAR of component type 5126"),
        ("indices", np.zeros(3, "<i2"), "indices is SCALAR of component type 5122"),
        ("indices", np.zeros((3, 2), "<u2"), "indices is VEC2 of component type 5123"),
        ("indices", np.zeros(4, "<u2"), "4 corners are not whole triangles"),
        ("POSITION", SQUARE, "4 corners are not whole triangles"),
        ("POSITION", np.zeros((3, 2), "<f4"), "POSITION is VEC2"),
        ("POSITION", np.zeros((3, 3), "<u4"), "POSITION is VEC3 of component type 5125"),
        ("POSITION", np.zeros((0, 3), "<f4"), "POSITION has no rows"),
        ("NORMAL", SQUARE, "NORMAL has 4 rows, POSITION 3"),
        ("COLOR_0", SQUARE, "COLOR_0 has 4 rows, POSITION 3"),
        ("COLOR_0", np.zeros((3, 2), "<u1"), "COLOR_0 is VEC2"),
    ):
        model = Model()
        part: dict[str, Any] = {"attributes": {"POSITION": model.accessor(TRIANGLE)}}
        place = part if key == "indices" else part["attributes"]
        place[key] = model.accessor(values)
        model.node(mesh=model.mesh(part))
        model.refused(cause)


@pytest.mark.parametrize("mode", [7, -1, "4", None, 4.0, True])
def test_modes_that_are_none(mode: Any) -> None:
    shape(mode).refused(r"meshes\[1\]: mode is .*: expected 0 to 6")


def test_bytes_that_are_not_there() -> None:
    for part, key, value, cause in (
        ("accessors", "byteOffset", 4, "4 rows take 48 bytes, but the view has 44"),
        ("accessors", "count", 5, "5 rows take 60 bytes, but the view has 48"),
        ("bufferViews", "byteLength", 60, "ends at byte 96 of its buffer, which has 84"),
        ("bufferViews", "byteStride", 8, "rows take 12 bytes, but the next follows 8"),
        ("bufferViews", "byteStride", 16, "4 rows take 60 bytes, but the view has 48"),
    ):
        model = shape(5)
        model.tree[part][1][key] = value
        model.refused(cause)


def test_chunks_of_glb() -> None:
    model = shape(5)
    other = struct.pack("<I4s", 8, b"MINE") + bytes(8)
    assert len(loaded(model.glb(other), "glb")) == 7
    assert len(loaded(model.glb() + other, "glb")) == 7
    whole = model.glb()
    with pytest.raises(FormatError, match="a chunk of 84 bytes begins, but 83 are left"):
        loaded(whole[:-1], "glb")
    without = whole[: whole.index(b"BIN\0") - 4]
    with pytest.raises(FormatError, match=r"buffers\[0\] is without data"):
        loaded(without, "glb")
    with pytest.raises(FormatError, match="its version is 1, not 2"):
        loaded(whole[:4] + b"\1" + whole[5:], "glb")


@pytest.mark.parametrize(
    ("uri", "cause"),
    [
        ("data:;base64,!!!!", r"buffers\[0\] is not valid base64"),
        ("data:;base64,AAA", r"buffers\[0\] is not valid base64"),
        ("data:,plain", r"buffers\[0\] is text, but not base64"),
        ("x?base64,AAAA", "its buffer 'x\\?base64,AAAA' is a separate file"),
    ],
)
def test_buffers_that_are_none(uri: str, cause: str) -> None:
    tree = json.loads(shape(5).gltf())
    tree["buffers"][0]["uri"] = uri
    with pytest.raises(FormatError, match=cause):
        loaded(json.dumps(tree).encode(), "gltf")


def compressed(**changes: Any) -> bytes:
    """Pack a triangle as GLB whose bytes are a fallback of others, as compressors write it."""
    model = shape(5)
    stated = {"buffer": 0, "byteOffset": 0, "byteLength": 84, "byteStride": 12, "count": 7}
    for view in model.tree["bufferViews"]:
        view["buffer"] = 1
        view["extensions"] = {"EXT_meshopt_compression": {**stated, "mode": "ATTRIBUTES"}}
    fallback = {"byteLength": 84, "extensions": {"EXT_meshopt_compression": {"fallback": True}}}
    model.tree["extensionsUsed"] = ["EXT_meshopt_compression"]
    return model.glb(buffers=[{"byteLength": 84}, {**fallback, **changes}])


def test_a_fallback_without_data_is_not_the_binary_chunk() -> None:
    with pytest.raises(FormatError, match=r"buffers\[1\] is without data: save the file without"):
        loaded(compressed(), "glb")
    data = base64.b64encode(np.concatenate([TRIANGLE, SQUARE]).tobytes()).decode()
    stream = io.BytesIO(compressed(uri=f"data:;base64,{data}"))
    cloud = liftmesh.read(stream, format="glb", up="z")
    assert cloud.points.tolist() == [*SQUARE.tolist(), *TRIANGLE.tolist()]


@pytest.mark.parametrize("name", ["EXT_meshopt_compression", "KHR_meshopt_compression"])
def test_nor_is_it_if_it_comes_first(name: str) -> None:
    data = shape(5).glb(buffers=[{"byteLength": 84, "extensions": {name: {"fallback": True}}}])
    with pytest.raises(FormatError, match=r"buffers\[0\] is without data"):
        loaded(data, "glb")


def test_only_the_first_buffer_is_the_binary_chunk() -> None:
    model = shape(5)
    for view in model.tree["bufferViews"]:
        view["buffer"] = 1
    with pytest.raises(FormatError, match=r"buffers\[1\] is without data"):
        loaded(model.glb(buffers=[{"byteLength": 84}, {"byteLength": 84}]), "glb")
    for view in model.tree["bufferViews"]:
        view["buffer"] = 0
    assert len(loaded(model.glb(buffers=[{"byteLength": 84}, {"byteLength": 84}]), "glb")) == 7


@pytest.mark.parametrize(
    ("size", "cause"),
    [
        (88, "byteLength is 88, but its data have 84 bytes"),
        (80, "ends at byte 84 of its buffer, which has 80"),
        (-1, "byteLength is -1: expected a whole number from 0"),
        (84.0, "byteLength is 84.0: expected a whole number"),
        (True, "byteLength is True: expected a whole number"),
        ("84", "byteLength is '84': expected a whole number"),
        (None, "byteLength is None: expected a whole number"),
    ],
)
def test_sizes_of_buffers_that_are_none(size: Any, cause: str) -> None:
    model = shape(5)
    with pytest.raises(FormatError, match=cause):
        loaded(model.glb(buffers=[{"byteLength": size}]), "glb")
    tree = json.loads(model.gltf())
    tree["buffers"][0]["byteLength"] = size
    with pytest.raises(FormatError, match=cause):
        loaded(json.dumps(tree).encode(), "gltf")


def test_a_chunk_may_be_longer_than_its_buffer() -> None:
    model = shape(5)
    size = len(model.data)
    model.data += b"\xff" * 4
    assert len(loaded(model.glb(buffers=[{"byteLength": size}]), "glb")) == 7
    assert len(loaded(model.glb(buffers=[{}]), "glb")) == 7  # without a size, all of it
