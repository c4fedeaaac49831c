"""Clouds as GLB and glTF: trimesh writes the file, which is completed here.

trimesh writes neither places of nodes nor named values of points. So its GLB is taken as what it
is, a tree and the bytes of one buffer, to which both are added. The origin of single precision
(`io.precision`) is the translation of the node, so that every viewer shows the mesh in its place,
and stands in the ``extras`` of the scene as well, where it is exact whatever happens to the nodes.

Attributes have names that begin with an underscore, as glTF wants it, and single precision:
``_INTENSITY`` for intensity. The scene's extras state the old name and type of each, so that
reading gives them back; without that a name loses its underscore.
"""

from __future__ import annotations

import base64
import json
import re
import struct
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from liftmesh._typing import Array
from liftmesh.base.cloud import Cloud
from liftmesh.base.colors import kept_depth
from liftmesh.errors import FormatError
from liftmesh.io.format import SINGLE, TOLERANCE, fits_whole, needed_origin, without_origin
from liftmesh.io.metadata import NOTE, as_extras, storable
from liftmesh.io.objects.trimesh import to_mesh, to_points
from liftmesh.optional import load

if TYPE_CHECKING:
    from liftmesh.io.format import Origin


_OTHER = re.compile(r"[^A-Z0-9_]+")
_WIDEST = 4

_HEAD = struct.Struct("<4sIII4s")
_CHUNK = struct.Struct("<I4s")
_FLOAT = 5126
_KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
_EMBEDDED = "data:application/octet-stream;base64,"


def write_glb(stream: BinaryIO, cloud: Cloud) -> Origin | None:
    """Write a mesh, or points, as GLB with 8-bit colours."""
    file, origin = _file(cloud, "glb")
    stream.write(file.glb())
    return origin


def write_gltf(stream: BinaryIO, cloud: Cloud) -> Origin | None:
    """Write a mesh, or points, as a glTF file that contains its buffers; see :func:`write_glb`."""
    file, origin = _file(cloud, "gltf")
    stream.write(file.gltf())
    return origin


def check(cloud: Cloud) -> None:
    """Raise for coordinates that single precision cannot hold, and for names that are one."""
    needed_origin(cloud.points, "glTF")
    value_columns(cloud.attributes)


def renamed(cloud: Cloud) -> dict[str, str]:
    """The attributes whose names are not just written with an underscore and in capitals."""
    names = value_keys(value_columns(cloud.attributes))
    return {name: key for name, key in names.items() if key != f"_{name.upper()}"}


def dropped_parts(cloud: Cloud, _options: Mapping[str, Any]) -> tuple[str, ...]:
    """Points are written without normals; those of meshes get the length 1, but for zeros."""
    names = dropped_attributes(cloud.attributes)
    if cloud.normals is None:
        return tuple(names)
    if not _has_faces(cloud) or not _are_unit(cloud.normals):
        return (*names, "normals")
    return (*names, *dropped_attributes({"normals": cloud.normals}))


def _file(cloud: Cloud, kind: str) -> tuple[File, Origin | None]:
    origin = needed_origin(cloud.points, kind)
    shown = Cloud(
        without_origin(cloud.points, origin),
        colors=cloud.colors,
        color_depth=kept_depth(cloud.colors),
        normals=_squarable(cloud.normals),
        faces=cloud.faces,
    )
    geometry = to_mesh(shown) if _has_faces(cloud) else to_points(shown)
    file = File.of(load("trimesh").Scene(geometry).export(file_type="glb"))
    if origin is not None:
        file.place(origin)
    values = value_columns(cloud.attributes)
    names = value_keys(values)
    for name, key in names.items():
        file.add(key, values[name])
    if extras := _extras(cloud, origin, names_note(values, names)):
        file.tree["scenes"][0]["extras"] = extras
    return file, origin


def _extras(cloud: Cloud, origin: Origin | None, names: dict[str, list[str]]) -> dict[str, Any]:
    """What the scene says of itself: metadata, crs, and liftmesh's own note."""
    note = {"origin": None if origin is None else list(origin), "attributes": names}
    own = {key: value for key, value in note.items() if value}
    crs = {} if cloud.crs is None else {"crs": cloud.crs}
    return as_extras(storable(cloud.metadata)) | crs | ({NOTE: own} if own else {})


def _has_faces(cloud: Cloud) -> bool:
    return cloud.faces is not None and len(cloud.faces) > 0


def _squarable(normals: Array | None) -> Array | None:
    """Shorten or lengthen normals whose squares overflow or vanish; None if one is not finite."""
    if normals is None or not np.isfinite(normals).all():
        return None
    largest = np.abs(normals).max(axis=1, keepdims=True).astype(np.float64)
    is_extreme = (largest > 1e100) | ((largest > 0) & (largest < 1e-100))
    return normals / np.where(is_extreme, largest, 1.0) if is_extreme.any() else normals


def _are_unit(normals: Array) -> bool:
    with np.errstate(over="ignore", invalid="ignore"):
        lengths = np.sqrt((normals.astype(np.float64) ** 2).sum(axis=1))
    return bool(((np.abs(lengths - 1.0) <= TOLERANCE) | (normals == 0).all(axis=1)).all())


def value_columns(attributes: Mapping[str, Array]) -> dict[str, Array]:
    """Return what glTF can hold of attributes: vectors of more than four values are split."""
    columns: dict[str, Array] = {}
    for name, values in attributes.items():
        if _reason(values):
            continue
        if values.ndim == 1 or (values.ndim == 2 and 2 <= values.shape[1] <= _WIDEST):
            columns[name] = values
        else:
            flat = values.reshape(len(values), -1)
            split = {f"{name}_{k}": column for k, column in enumerate(flat.T)}
            twice = next((each for each in split if each in attributes or each in columns), None)
            if twice is not None:
                raise FormatError(f"two attributes are named {twice!r}: rename one")
            columns |= split
    return columns


def value_keys(names: Mapping[str, Array]) -> dict[str, str]:
    """Choose the name of each attribute in the file."""
    keys: dict[str, str] = {}
    numbers: Counter[str] = Counter()
    taken: set[str] = set()
    for name in names:
        base = key = f"_{_OTHER.sub('_', name.upper()).strip('_') or 'ATTRIBUTE'}"
        while key in taken:
            numbers[base] += 1
            key = f"{base}_{numbers[base]}"
        taken.add(key)
        keys[name] = key
    return keys


def names_note(attributes: Mapping[str, Array], names: Mapping[str, str]) -> dict[str, list[str]]:
    """State the old name and type of each attribute."""
    return {key: [name, attributes[name].dtype.name] for name, key in names.items()}


def dropped_attributes(attributes: Mapping[str, Array]) -> list[str]:
    """Name the attributes that a file does not hold, or not in full."""
    names: list[str] = []
    for name, values in sorted(attributes.items()):
        if why := _reason(values):
            names.append(f"{name} ({why})")
        elif not _is_exact(values):
            names.append(f"double precision of {name}")
    return names


def _reason(values: Array) -> str:
    """Say why glTF cannot hold an attribute; an empty text if it can."""
    if values.dtype.kind not in "biuf":
        return "not numbers"
    if not values.size:
        return "no values"
    return "" if np.isfinite(_single(values)).all() else "not finite"


def _is_exact(values: Array) -> bool:
    """Whether single precision holds all values."""
    if values.dtype.kind in "iu":
        return fits_whole(values, SINGLE)
    return np.array_equal(_single(values).astype(values.dtype), values)


def _single(values: Array) -> Array:
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        return values.astype(np.float32)


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
