"""A glTF file that trimesh wrote, taken apart, completed and packed again.

trimesh writes neither places of nodes nor named values of points. So its GLB is taken as what it
is, a tree and the bytes of one buffer, to which both are added.
"""

from __future__ import annotations

import base64
import json
import struct
from dataclasses import dataclass
from typing import Any

import numpy as np

from liftmesh._typing import Array

_HEAD = struct.Struct("<4sIII4s")
_CHUNK = struct.Struct("<I4s")
_FLOAT = 5126
_KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
_EMBEDDED = "data:application/octet-stream;base64,"


@dataclass(slots=True)
class File:
    """The tree of a glTF file and its one buffer, in parts."""

    tree: dict[str, Any]
    parts: list[bytes]
    size: int  # of all parts

    @classmethod
    def of(cls, glb: bytes) -> File:
        """Take a GLB file apart."""
        size = _HEAD.unpack_from(glb)[3]
        begin = _HEAD.size + size
        (length, _) = _CHUNK.unpack_from(glb, begin)
        tree = json.loads(glb[_HEAD.size : begin])
        buffer = glb[begin + _CHUNK.size :][:length]
        return cls(tree, [buffer], len(buffer))

    def place(self, origin: tuple[float, float, float]) -> None:
        """Move the meshes to an origin."""
        for node in self.tree["nodes"]:
            if "mesh" in node:
                node["translation"] = list(origin)

    def add(self, key: str, values: Array) -> None:
        """Add float32 values of the vertices, (n,) or (n, k) with k from 2 to 4."""
        views, accessors = self.tree["bufferViews"], self.tree["accessors"]
        data = np.ascontiguousarray(values, dtype="<f4").tobytes()
        views.append({"buffer": 0, "byteOffset": self.size, "byteLength": len(data)})
        self.parts.append(data)
        self.size += len(data)
        accessors.append(
            {
                "bufferView": len(views) - 1,
                "componentType": _FLOAT,
                "count": len(values),
                "type": _KINDS[1 if values.ndim == 1 else values.shape[1]],
            }
        )
        for mesh in self.tree["meshes"]:
            for primitive in mesh["primitives"]:
                primitive["attributes"][key] = len(accessors) - 1

    def glb(self) -> bytes:
        """Pack as GLB."""
        size = self.size
        self.tree["buffers"] = [{"byteLength": size}]
        text = self._text()
        text += b" " * (-len(text) % 4)
        total = _HEAD.size + len(text) + _CHUNK.size + size
        head = _HEAD.pack(b"glTF", 2, total, len(text), b"JSON")
        return b"".join([head, text, _CHUNK.pack(size, b"BIN\0"), *self.parts])

    def gltf(self) -> bytes:
        """Pack as text that contains the buffer."""
        data = base64.b64encode(b"".join(self.parts)).decode("ascii")
        self.tree["buffers"] = [{"byteLength": self.size, "uri": _EMBEDDED + data}]
        return self._text()

    def _text(self) -> bytes:
        return json.dumps(self.tree, separators=(",", ":")).encode("ascii")
