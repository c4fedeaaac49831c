"""Validation of glTF files before memory is allocated.

The JSON tree of a glTF or GLB file describes which bytes of which buffer are which numbers. Wrong
counts could demand far more memory than the file has bytes; sparse or compressed numbers would be
read as zeros; negative indices would count from the end; a required extension may change what
everything else means. All are rejected here.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO
from urllib.parse import unquote

from liftmesh.errors import FormatError, LiftmeshError
from liftmesh.io.formats.gltf.buffers import Buffers, Chunk, StatedBuffer
from liftmesh.io.markup import (
    bytes_of_text,
    bytes_of_tree,
    check_length,
    parsed,
    shown_json,
    without_buffers,
)
from liftmesh.io.options import check_expanded, limit_of
from liftmesh.io.streams import remaining

Tree = dict[str, Any]

_HEAD = struct.Struct("<4sI4xI4s")
_CHUNK = struct.Struct("<I4s")
_BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
_COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}

# Views and accessors may share bytes: the factor beyond which this is taken for an attack.
_SHARED = 64

# What JSON may take in memory: so many times its text, or so many bytes, if they are more.
_SMALL = 1 << 26
_GROWTH = 20

# Extensions that mark buffers whose data are compressed elsewhere.
_FALLBACKS = {"EXT_meshopt_compression", "KHR_meshopt_compression"}

# Extensions that change neither positions nor faces.
_HARMLESS = ("KHR_materials_", "KHR_texture_", "EXT_texture_", "MSFT_texture_", "KHR_lights_",
             "EXT_lights_", "KHR_xmp", "KHR_mesh_quantization")  # fmt: skip

# Extensions that neither do, but hold what is not read, and is named.
_NAMED = ("EXT_mesh_features", "EXT_structural_metadata", "KHR_animation_pointer")


@dataclass(frozen=True, slots=True)
class Accessor:
    """Numbers of a buffer: where they are, and of which type."""

    buffer: int
    begin: int
    size: int
    stride: int
    count: int
    component: int
    kind: str
    normalized: bool

    @property
    def width(self) -> int:
        """The numbers of one row."""
        return _COLUMNS[self.kind]

    @property
    def item(self) -> int:
        """The bytes of one row."""
        return _BYTES[self.component] * _COLUMNS[self.kind]


class Document:
    """The tree of a glTF file and its buffers; every access is checked."""

    def __init__(self, stream: BinaryIO, name: str, kind: str, max_bytes: int | None) -> None:
        self.name = name
        self._kind = kind
        size = remaining(stream)
        text, chunk = _parts(stream, name) if kind == "glb" else (stream.read(), None)
        self.tree = self._parsed(text, max_bytes)
        self._check_versions()
        self.buffers = Buffers(self._stated(), chunk, name)
        self._size = size
        self._stated_size = size + self.buffers.beside()
        self.meshes, self.nodes = self._listed("meshes"), self._listed("nodes")
        self.scenes = self._listed("scenes")
        self._views, self._accessors = self._listed("bufferViews"), self._listed("accessors")
        self._check_views()
        self._check_accessors()

    def objects(self, listed: object, what: str) -> list[Tree]:
        """Check a list of objects."""
        if not isinstance(listed, list) or not all(isinstance(each, dict) for each in listed):
            raise self.error(f"{what} is not a list of objects")
        return listed

    def count(self, part: Tree, key: str, what: str) -> int:
        """Return a whole number from 0; 0 if there is none."""
        count = part.get(key, 0)
        if type(count) is not int or count < 0:
            raise self.error(
                f"{what}: {key} is {shown_json(count)}: expected a whole number from 0"
            )
        return count

    def index(self, part: Tree, key: str, limit: int, what: str) -> int:
        """Return an index."""
        index = self.count(part, key, what)
        if index >= limit:
            raise self.error(f"{what}: {key} is {index}, but there are only {limit}")
        return index

    def indices(self, part: Tree, key: str, limit: int, what: str) -> list[int]:
        """Return a list of indices; an empty one if there is none."""
        listed = part.get(key, [])
        if not isinstance(listed, list):
            raise self.error(f"{what}: {key} is not a list")
        return [self.index({key: each}, key, limit, what) for each in listed]

    def accessor(self, part: Tree, key: str, what: str) -> Accessor:
        """Return an accessor whose numbers are in its buffer."""
        entry = self._accessors[self.index(part, key, len(self._accessors), what)]
        if "bufferView" not in entry or "sparse" in entry:
            raise self.error(
                f"{what}: {key} is sparse, compressed or without data: save the file without "
                "compression"
            )
        view = self._views[entry["bufferView"]]
        what = f"{what}: {key}"
        accessor = Accessor(
            buffer=view.get("buffer", 0),
            begin=view.get("byteOffset", 0) + entry.get("byteOffset", 0),
            size=view.get("byteLength", 0) - entry.get("byteOffset", 0),
            stride=self._stride(view, entry, what),
            count=self.count(entry, "count", what),
            component=entry["componentType"],
            kind=entry["type"],
            normalized=entry.get("normalized") is True,
        )
        self._check_extent(accessor, what)
        return accessor

    def used_size(self) -> int:
        """Return the bytes of the file, and those of the files beside it used by accessors."""
        return self._size + self.buffers.used_beside()

    def error(self, cause: str) -> FormatError:
        """Make an error about this file."""
        return FormatError(f"{self.name}: not a valid {self._kind} file: {cause}")

    def _listed(self, key: str) -> list[Tree]:
        """Return a list of the tree: all of it is looked at, so do not call this in a loop."""
        return self.objects(self.tree.get(key, []), key)

    def _parsed(self, text: bytes, max_bytes: int | None) -> Tree:
        usual = _GROWTH * len(text) - bytes_of_text(text)
        limit = limit_of(max_bytes, usual, _SMALL)
        bare = without_buffers(text)
        needed = bytes_of_tree(bare, limit)
        check_expanded(needed, limit, self.name, f"its JSON of {len(text):,} bytes")
        if max_bytes is None:
            check_length(bare, self.name)
        try:
            tree = parsed(text)
        except (ValueError, RecursionError) as error:
            raise self.error(str(error)) from error
        if not isinstance(tree, dict):
            raise self.error("its JSON is not an object")
        return tree

    def _check_versions(self) -> None:
        """Raise for other versions than 2, and for extensions that change positions or faces."""
        (asset,) = self.objects([self.tree.get("asset", {})], "asset")
        version = str(asset.get("version", "2.0"))
        if version.partition(".")[0] != "2":
            raise self.error(f"its version is {version[:20]!r}: only glTF 2 can be read")
        required = self.tree.get("extensionsRequired", [])
        if not isinstance(required, list):
            raise self.error("extensionsRequired is not a list")
        unknown = [each for each in required if not is_harmless(each) and each not in _NAMED]
        if unknown:
            raise self.error(
                f"it requires the extension {shown_json(unknown[0])}, which liftmesh does not "
                "read: save the file without it"
            )

    def _stated(self) -> list[StatedBuffer]:
        """List the buffers."""
        stated = []
        for number, each in enumerate(self._listed("buffers")):
            uri, extensions = each.get("uri"), each.get("extensions")
            if not isinstance(uri, str | None):
                raise self.error("a buffer has a name that is not a string")
            size = self.count(each, "byteLength", f"buffers[{number}]")
            is_fallback = isinstance(extensions, dict) and not _FALLBACKS.isdisjoint(extensions)
            stated.append(StatedBuffer(uri, size if "byteLength" in each else None, is_fallback))
        return stated

    def _check_views(self) -> None:
        buffers = len(self.buffers)
        total = 0
        for number, view in enumerate(self._views):
            what = f"bufferViews[{number}]"
            self.index(view, "buffer", buffers, what)
            self.count(view, "byteOffset", what)
            self.count(view, "byteStride", what)
            total += self.count(view, "byteLength", what)
            self._compare(total, what)

    def _check_accessors(self) -> None:
        views = len(self._views)
        total = 0
        for number, accessor in enumerate(self._accessors):
            what = f"accessors[{number}]"
            if "bufferView" in accessor:
                self.index(accessor, "bufferView", views, what)
            self.count(accessor, "byteOffset", what)
            count = self.count(accessor, "count", what)
            total += count * self._item(accessor, what)
            self._compare(total, what)

    def _item(self, accessor: Tree, what: str) -> int:
        """Return the size of one item in bytes."""
        try:
            return _BYTES[accessor["componentType"]] * _COLUMNS[accessor["type"]]
        except (KeyError, TypeError) as error:
            raise self.error(f"{what} has an unknown type") from error

    def _compare(self, promised: int, what: str) -> None:
        if promised > _SHARED * self._stated_size:
            raise self.error(
                f"{what} raises the size of the promised data to {promised} bytes, but there are "
                f"{self._stated_size}: the file is truncated, or its counts are wrong"
            )

    def _stride(self, view: Tree, accessor: Tree, what: str) -> int:
        """Return the bytes from row to row."""
        item = self._item(accessor, what)
        stride: int = view.get("byteStride", item)
        if stride < item:
            raise self.error(f"{what}: its rows take {item} bytes, but the next follows {stride}")
        return stride

    def _check_extent(self, accessor: Accessor, what: str) -> None:
        """Raise if rows lie beyond their view, or the view beyond its buffer."""
        needed = max(accessor.count - 1, 0) * accessor.stride + accessor.item
        there = len(self.buffers[accessor.buffer])
        if accessor.count and needed > accessor.size:
            raise self.error(
                f"{what}: {accessor.count} rows take {needed} bytes, but the view has "
                f"{max(accessor.size, 0)} for them"
            )
        if accessor.begin + accessor.size > there:
            raise self.error(
                f"{what} ends at byte {accessor.begin + accessor.size} of its buffer, "
                f"which has {there}: the file is truncated, or its counts are wrong"
            )


def is_harmless(extension: object) -> bool:
    """Whether an extension changes neither positions nor faces."""
    return isinstance(extension, str) and extension.startswith(_HARMLESS)


def _parts(stream: BinaryIO, name: str) -> tuple[bytes, Chunk | None]:
    """Return the JSON of a GLB file, and the place of its binary chunk."""
    begin = stream.tell()
    head = stream.read(_HEAD.size)
    if len(head) < _HEAD.size or not head.startswith(b"glTF"):
        raise FormatError(f"{name}: not a valid glb file: it begins with {head[:4]!r}")
    _, version, size, kind = _HEAD.unpack(head)
    if version != 2:
        raise FormatError(f"{name}: not a valid glb file: its version is {version}, not 2")
    if kind != b"JSON" or size > remaining(stream):
        raise FormatError(
            f"{name}: not a valid glb file: byte 12: the first chunk should be JSON within the "
            f"remaining {remaining(stream)} bytes, but is {kind!r} of {size} bytes"
        )
    return stream.read(size), _binary_chunk(stream, name, begin)


def _binary_chunk(stream: BinaryIO, name: str, begin: int) -> Chunk | None:
    """Find the first binary chunk; chunks of other kinds are left out."""
    while len(head := stream.read(_CHUNK.size)) == _CHUNK.size:
        size, kind = _CHUNK.unpack(head)
        at = stream.tell()
        if size > remaining(stream):
            raise FormatError(
                f"{name}: not a valid glb file: byte {at - begin - _CHUNK.size}: a chunk of {size} "
                f"bytes begins, but {remaining(stream)} are left: the file is truncated"
            )
        if kind == b"BIN\0":
            return Chunk(stream, at, size)
        stream.seek(at + size)
    return None


def named_in(path: Path) -> list[Path]:
    """List the files that a glTF file is read with, or shown with."""
    try:
        with path.open("rb") as stream:
            tree = Document(stream, str(path), path.suffix.lower().removeprefix("."), None).tree
    except (LiftmeshError, OSError):
        return []  # which the command that reads it says
    listed = (tree.get(key) for key in ("buffers", "images"))
    parts = [part for each in listed if isinstance(each, list) for part in each]
    names = [part.get("uri") for part in parts if isinstance(part, dict)]
    return [
        path.absolute().parent / unquote(each)
        for each in names
        if isinstance(each, str) and not each.startswith("data:")
    ]
