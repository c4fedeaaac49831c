"""glTF files of any parts, put together for tests."""

from __future__ import annotations

import base64
import io
import json
import struct
from typing import Any

import numpy as np
import pytest

import liftmesh
from liftmesh import Cloud, FormatError

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype="<f4")
TRIANGLE = np.array([[5, 5, 0], [6, 5, 0], [5, 6, 0]], dtype="<f4")
KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
TYPES = {"b": 5120, "B": 5121, "h": 5122, "H": 5123, "I": 5125, "f": 5126}


class Model:
    """A glTF tree, put together part by part; its bytes are one buffer."""

    def __init__(self, **parts: Any) -> None:
        self.data = b""
        self.tree: dict[str, Any] = {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [],
            "meshes": [], "accessors": [], "bufferViews": [], **parts,
        }  # fmt: skip

    def accessor(self, values: np.ndarray, **parts: Any) -> int:
        """Add numbers."""
        self.data += bytes(-len(self.data) % 4)
        view = {"buffer": 0, "byteOffset": len(self.data), "byteLength": values.nbytes}
        self.data += values.tobytes()
        self.tree["bufferViews"].append(view)
        width = 1 if values.ndim == 1 else values.shape[1]
        self.tree["accessors"].append(
            {
                "bufferView": len(self.tree["bufferViews"]) - 1,
                "componentType": TYPES[values.dtype.char.replace("L", "I")],
                "count": len(values),
                "type": KINDS[width],
                **parts,
            }
        )
        return len(self.tree["accessors"]) - 1

    def mesh(self, *primitives: dict[str, Any], **parts: Any) -> int:
        """Add a mesh."""
        self.tree["meshes"].append({"primitives": [*primitives], **parts})
        return len(self.tree["meshes"]) - 1

    def node(self, *, root: bool = True, **parts: Any) -> int:
        """Add a node to the scene."""
        self.tree["nodes"].append(parts)
        number = len(self.tree["nodes"]) - 1
        if root:
            self.tree["scenes"][0]["nodes"].append(number)
        return number

    def gltf(self) -> bytes:
        """Pack as text."""
        uri = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        tree = {**self.tree, "buffers": [{"uri": uri, "byteLength": len(self.data)}]}
        return json.dumps(tree).encode()

    def glb(self, before: bytes = b"", **parts: Any) -> bytes:
        """Pack as binary."""
        data = self.data + bytes(-len(self.data) % 4)
        tree = {**self.tree, "buffers": [{"byteLength": len(data)}], **parts}
        text = json.dumps(tree).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text + before
        chunks += struct.pack("<I4s", len(data), b"BIN\0") + data
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks

    def read(self, **options: Any) -> Cloud:
        """Read, as both."""
        one = liftmesh.read(io.BytesIO(self.gltf()), format="gltf", **options)
        other = liftmesh.read(io.BytesIO(self.glb()), format="glb", **options)
        assert one.points.tobytes() == other.points.tobytes()
        assert {**one.metadata, "format": "glb"} == other.metadata
        return one

    def refused(self, cause: str, **options: Any) -> None:
        for data, kind in ((self.gltf(), "gltf"), (self.glb(), "glb")):
            with pytest.raises(FormatError, match=cause):
                liftmesh.read(io.BytesIO(data), format=kind, **options)


def shape(mode: int, rows: np.ndarray = SQUARE, **node: Any) -> Model:
    """Make a model of a mesh of some mode and a triangle beside it."""
    model = Model()
    model.node(mesh=model.mesh({"attributes": {"POSITION": model.accessor(TRIANGLE)}}))
    part = {"attributes": {"POSITION": model.accessor(rows)}, "mode": mode}
    model.node(mesh=model.mesh(part), **node)
    return model


def faces(cloud: Cloud) -> list[list[int]]:
    return [] if cloud.faces is None else cloud.faces.tolist()
