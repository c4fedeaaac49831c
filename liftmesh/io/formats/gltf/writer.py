"""Clouds as GLB and glTF: trimesh writes the file, which is completed here.

trimesh writes neither places of nodes nor named values of points. So its GLB is taken as what it
is, a tree and the bytes of one buffer, to which both are added. The origin of single precision
(`io.precision`) is the translation of the node, so that every viewer shows the mesh in its place,
and stands in the ``extras`` of the scene as well, where it is exact whatever happens to the nodes.
An origin that the caller chooses stands there alone: the scene is near zero, as engines need it.

In a scene of glTF y is up, and lengths are metres. A node above all others turns and scales: the
vertices keep their bits.

Attributes have names that begin with an underscore, as glTF wants it, and single precision:
``_INTENSITY`` for intensity. The scene's extras state the old name and type of each, so that
reading gives them back; without that a name loses its underscore.
"""

from __future__ import annotations

import base64
import json
import os
import re
import struct
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, BinaryIO, TypeAlias

import numpy as np

from liftmesh._typing import Array
from liftmesh.base.cloud import Cloud
from liftmesh.base.options import Up, check_option, refused
from liftmesh.crs.units import system_of
from liftmesh.errors import DataWarning, FormatError
from liftmesh.io.axes import OriginChoice, chosen_origin
from liftmesh.io.format import (
    SINGLE,
    TOLERANCE,
    LazyFunction,
    Origin,
    fits_whole,
    needed_origin,
    without_origin,
)
from liftmesh.io.formats.gltf.shading import COMPUTED, as_light, vertex_normals
from liftmesh.io.metadata import NOTE, as_extras, storable
from liftmesh.io.objects.trimesh import to_mesh, to_points
from liftmesh.optional import load

PathLike: TypeAlias = str | os.PathLike[str]

_OTHER = re.compile(r"[^A-Z0-9_]+")
_WIDEST = 4

_HEAD = struct.Struct("<4sIII4s")
_CHUNK = struct.Struct("<I4s")
_FLOAT, _SHORT = 5126, 5123
_LINEAR, _CLAMP = {"magFilter": 9729, "minFilter": 9987}, 33071
_read_texture = LazyFunction("liftmesh.raster.texture", "read_texture")
_SHARES = ("COLOR_0",)  # whole numbers that stand for shares of one
_METRES = [1.0, 1.0, 1.0]
_KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
_EMBEDDED = "data:application/octet-stream;base64,"


def write_glb(
    stream: BinaryIO,
    cloud: Cloud,
    *,
    up: Up = "y",
    origin: OriginChoice = None,
    texture: PathLike | None = None,
) -> Origin | None:
    """Write a mesh, or points, as GLB with 8-bit colours, or with an image of its ground."""
    file, moved = _file(cloud, "glb", up, origin, texture)
    stream.write(file.glb())
    return moved


def write_gltf(
    stream: BinaryIO,
    cloud: Cloud,
    *,
    up: Up = "y",
    origin: OriginChoice = None,
    texture: PathLike | None = None,
) -> Origin | None:
    """Write a mesh, or points, as a glTF file that contains its buffers; see :func:`write_glb`."""
    file, moved = _file(cloud, "gltf", up, origin, texture)
    stream.write(file.gltf())
    return moved


def check(cloud: Cloud) -> None:
    """Raise for coordinates that single precision cannot hold, and for names that are one."""
    needed_origin(cloud.points, "glTF")
    value_columns(cloud.attributes)


def renamed(cloud: Cloud) -> dict[str, str]:
    """The attributes whose names are not just written with an underscore and in capitals."""
    names = value_keys(value_columns(cloud.attributes))
    return {name: key for name, key in names.items() if key != f"_{name.upper()}"}


def dropped_parts(cloud: Cloud, options: Mapping[str, Any]) -> tuple[str, ...]:
    """Points are written without normals, those of meshes get the length 1; colours or texture."""
    names = dropped_attributes(cloud.attributes)
    names += [] if options.get("texture") is None else ["colors"]
    if cloud.normals is None:
        return tuple(names)
    if not _has_faces(cloud) or not _are_unit(cloud.normals):
        return (*names, "normals")
    return (*names, *dropped_attributes({"normals": cloud.normals}))


def _file(
    cloud: Cloud, kind: str, up: Up, choice: OriginChoice, texture: PathLike | None
) -> tuple[File, Origin | None]:
    check_option("up", up, Up)
    zero = chosen_origin(choice, cloud.points)
    origin = needed_origin(cloud.points, kind) if zero is None else zero
    points = without_origin(cloud.points, origin)
    if zero is not None and needed_origin(points, kind) is not None:
        raise refused("origin", choice, f"give a place near the points, or 'center': {kind} files")
    has_faces, normals = _has_faces(cloud), _squarable(cloud.normals)
    is_computed = has_faces and normals is None
    if is_computed and cloud.faces is not None:
        normals = vertex_normals(points, cloud.faces)
    shown = Cloud(points, normals=normals, faces=cloud.faces)
    geometry = to_mesh(shown) if has_faces else to_points(shown)
    file = File.of(load("trimesh", extra="trimesh").Scene(geometry).export(file_type="glb"))
    if cloud.colors is not None and texture is None:  # viewers would multiply both
        file.add("COLOR_0", as_light(cloud.colors))
    file.shade()
    if texture is not None:
        _add_texture(file, cloud, texture)
    if origin is not None and zero is None:
        file.place(origin)
    metres = _metres(cloud)
    file.turn(up, metres)
    values = value_columns(cloud.attributes)
    names = value_keys(values)
    for name, key in names.items():
        file.add(key, values[name])
    note = {
        "up": up,
        "metres": [] if metres == _METRES else metres,
        "origin": [] if origin is None or zero is not None else [*origin],
        "zero": [] if zero is None else [*zero],
        "normals": COMPUTED if is_computed else "",
        "attributes": names_note(values, names),
    }
    file.tree["scenes"][0]["extras"] = _extras(cloud, note)
    return file, origin


def _add_texture(file: File, cloud: Cloud, path: PathLike) -> None:
    """Put an image over the faces, seen from above."""
    if not _has_faces(cloud):
        raise refused("texture", path, "points have no faces to show it: triangulate them first")
    image = _read_texture(path, cloud.crs)
    positions = image.positions(cloud.points)
    if outside := image.count_outside(positions):
        warnings.warn(
            f"{path}: {outside:,} of {len(positions):,} vertices lie outside the image, whose edge "
            "is drawn out to them",
            DataWarning,
            stacklevel=6,
        )
    file.add("TEXCOORD_0", positions)
    file.paint(image.png)


def _metres(cloud: Cloud) -> list[float]:
    """Return how many metres the units of x, y and z are; 1 where nothing says it."""
    system = system_of(cloud)
    units = (None, None, None) if system is None else system.units
    return [1.0 if each is None or each.metres is None else each.metres for each in units]


def _extras(cloud: Cloud, note: Mapping[str, Any]) -> dict[str, Any]:
    """What the scene says of itself: metadata, crs, and liftmesh's own note."""
    own = {key: value for key, value in note.items() if value}
    crs = {} if cloud.crs is None else {"crs": cloud.crs}
    return as_extras(storable(cloud.metadata)) | crs | {NOTE: own}


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

    def turn(self, up: Up, metres: Sequence[float]) -> None:
        """Put all nodes below one that turns z up to y up, and makes metres of other units."""
        x, y, z = metres
        columns = [(x, 0, 0), (0, 0, -y), (0, z, 0)]
        if up == "z":
            columns = [(x, 0, 0), (0, y, 0), (0, 0, z)]
        if up == "z" and [*metres] == _METRES:
            return
        nodes, scene = self.tree["nodes"], self.tree["scenes"][0]
        matrix = [float(each) for column in columns for each in (*column, 0)]
        place = {"name": "axes", "matrix": [*matrix, 0.0, 0.0, 0.0, 1.0]}
        nodes.append({**place, "children": scene["nodes"]})
        scene["nodes"] = [len(nodes) - 1]

    def shade(self) -> None:
        """Give everything a material that is dull, and no metal."""
        dull = {"metallicFactor": 0.0, "roughnessFactor": 1.0}
        self.tree["materials"] = [{"pbrMetallicRoughness": dull}]
        for primitive in self._primitives():
            primitive["material"] = 0

    def paint(self, png: bytes) -> None:
        """Give the material an image, which is not repeated beyond its edge."""
        tree = self.tree
        tree["bufferViews"].append({"buffer": 0, "byteOffset": self.size, "byteLength": len(png)})
        self._append(png)
        tree["images"] = [{"bufferView": len(tree["bufferViews"]) - 1, "mimeType": "image/png"}]
        tree["samplers"] = [{**_LINEAR, "wrapS": _CLAMP, "wrapT": _CLAMP}]
        tree["textures"] = [{"source": 0, "sampler": 0}]
        tree["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}

    def _append(self, data: bytes) -> None:
        """Add bytes; what follows begins at a multiple of four."""
        data += bytes(-len(data) % 4)
        self.parts.append(data)
        self.size += len(data)

    def _primitives(self) -> Iterator[dict[str, Any]]:
        for mesh in self.tree["meshes"]:
            yield from mesh["primitives"]

    def add(self, key: str, values: Array) -> None:
        """Add values of the vertices, (n,) or (n, k) with k from 2 to 4: float32, or 16 bits."""
        views, accessors = self.tree["bufferViews"], self.tree["accessors"]
        is_share = values.dtype == np.uint16 and key in _SHARES
        data = np.ascontiguousarray(values, dtype="<u2" if is_share else "<f4").tobytes()
        views.append({"buffer": 0, "byteOffset": self.size, "byteLength": len(data)})
        self._append(data)
        accessors.append(
            {
                "bufferView": len(views) - 1,
                "componentType": _SHORT if is_share else _FLOAT,
                "count": len(values),
                "type": _KINDS[1 if values.ndim == 1 else values.shape[1]],
                **({"normalized": True} if is_share else {}),
            }
        )
        for primitive in self._primitives():
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
