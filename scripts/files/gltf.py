"""glTF files of any parts: a tree whose bytes are one buffer, as GLB or as JSON."""

from __future__ import annotations

import base64
import json
import struct
from typing import Any

import numpy as np

KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
TYPES = {"b": 5120, "B": 5121, "h": 5122, "H": 5123, "I": 5125, "f": 5126}


def glb(
    tree: dict[str, Any], data: bytes | None = None, between: bytes = b"", size: int = 0
) -> bytes:
    """Pack a tree, and its bytes if there are any; `size` is what the chunk of the tree states."""
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    parts = struct.pack("<I4s", size or len(text), b"JSON") + text + between
    if data is not None:
        data += bytes(-len(data) % 4)
        parts += struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(parts)) + parts


def gltf(tree: dict[str, Any], data: bytes) -> bytes:
    """Write a tree as text, with its bytes inside."""
    if not tree.get("buffers") or "uri" not in tree["buffers"][0]:
        tree = tree | {"buffers": [{"uri": address(data), "byteLength": len(data)}]}
    return json.dumps(tree).encode()


def address(data: bytes) -> str:
    """Write bytes as an address."""
    return "data:application/octet-stream;base64," + base64.b64encode(data).decode()


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
        return gltf(self.tree, self.data)

    def glb(self, before: bytes = b"", **parts: Any) -> bytes:
        """Pack as binary."""
        size = len(self.data) + -len(self.data) % 4
        return glb({**self.tree, "buffers": [{"byteLength": size}], **parts}, self.data, before)
