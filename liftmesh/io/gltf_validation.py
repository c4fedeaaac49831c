"""Validation of glTF files before memory is allocated, and access to their buffer files.

The JSON tree of a glTF or GLB file describes which bytes of which buffer are which numbers. Wrong
counts could demand far more memory than the file has bytes; sparse or compressed numbers would be
read as zeros; negative indices would count from the end. All are rejected here.

A glTF file may keep its numbers in other files. Its author is not trusted to choose among all files
of the machine, nor to use its network: only buffers in the file's own folder are read. Names that
lead out of it, by ``..``, from the root, through a link or to a server, are rejected.
"""

from __future__ import annotations

import json
import os
import struct
from collections.abc import Collection
from pathlib import Path
from typing import Any, BinaryIO
from urllib.parse import unquote

from liftmesh.errors import FormatError
from liftmesh.io.streams import remaining


class Resolver:
    """Reads files in the folder of ``name``, each once, and only those in ``announced``."""

    def __init__(self, name: str, announced: Collection[str] = ()) -> None:
        self._name = name
        self._announced = announced
        self._contents: dict[str, bytes] = {}

    def __getitem__(self, wanted: str) -> bytes:
        if wanted not in self._announced:
            raise FormatError(f"{self._name}: {wanted[:60]!r} is not one of its buffers")
        if wanted not in self._contents:
            self._contents[wanted] = self._path(wanted).read_bytes()
        return self._contents[wanted]

    def size(self, wanted: str) -> int:
        """Return the size of a file in bytes without reading it."""
        return self._path(wanted).stat().st_size

    def _path(self, wanted: str) -> Path:
        if not os.path.isfile(self._name):  # noqa: PTH113 - a name of a stream may hold any bytes
            raise FormatError(
                f"{self._name}: its buffer {wanted[:60]!r} is a separate file in the same folder, "
                "which is unknown for a stream: give a path"
            )
        folder = Path(self._name).absolute().parent.resolve()
        try:
            path = (folder / unquote(wanted)).resolve()
            is_there = path.is_file()
        except (OSError, ValueError, RuntimeError):  # no name of a file, or links in a circle
            path, is_there = folder, False
        if "://" in wanted or not path.is_relative_to(folder):
            raise FormatError(
                f"{self._name}: its buffer {wanted[:60]!r} is outside its folder: move it there"
            )
        if not is_there:
            raise FormatError(f"{self._name}: its buffer {wanted[:60]!r} does not exist")
        return path


Tree = dict[str, Any]

_MAGIC = b"glTF"
_JSON = b"JSON"
_HEAD = struct.Struct("<4s8xI4s")
_BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
_COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}

# Views and accessors may share bytes: the factor beyond which this is taken for an attack.
_SHARED = 64


def checked_gltf(stream: BinaryIO, name: str, kind: str) -> Resolver:
    """Validate the tree of a file, and return the resolver for the files that it refers to.

    The position of the stream is restored.

    Raises
    ------
    FormatError
        The tree is invalid, or promises more than there is; the message names the part.
    """
    begin, size = stream.tell(), remaining(stream)
    tree = _tree(stream, name, kind)
    stream.seek(begin)
    return _Validation(tree, name, kind).check(size)


def _tree(stream: BinaryIO, name: str, kind: str) -> Tree:
    data = _json_chunk(stream, name) if kind == "glb" else stream.read()
    try:
        tree = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise FormatError(f"{name}: not a valid {kind} file: {error}") from error
    if not isinstance(tree, dict):
        raise FormatError(f"{name}: not a valid {kind} file: its JSON is not an object")
    return tree


def _json_chunk(stream: BinaryIO, name: str) -> bytes:
    head = stream.read(_HEAD.size)
    if len(head) < _HEAD.size or not head.startswith(_MAGIC):
        raise FormatError(f"{name}: not a valid glb file: it begins with {head[:4]!r}")
    _, size, kind = _HEAD.unpack(head)
    if kind != _JSON or size > remaining(stream):
        raise FormatError(
            f"{name}: not a valid glb file: byte 12: the first chunk should be JSON within the "
            f"remaining {remaining(stream)} bytes, but is {kind!r} of {size} bytes"
        )
    return stream.read(size)


class _Validation:
    """Checks of each part of a tree."""

    def __init__(self, tree: Tree, name: str, kind: str) -> None:
        self._tree = tree
        self._name = name
        self._kind = kind

    def check(self, size: int) -> Resolver:
        """Compare all counts with the sizes of the file and of the files that it refers to."""
        uris = [each["uri"] for each in self._list("buffers") if "uri" in each]
        if not all(isinstance(uri, str) for uri in uris):
            raise self._error("a buffer has a name that is not a string")
        named = {uri for uri in uris if "base64," not in uri}
        resolver = Resolver(self._name, named)
        there = size + sum(map(resolver.size, named))
        self._check_views(there)
        self._check_accessors(there)
        self._check_primitives()
        self._check_nodes()
        return resolver

    def _check_views(self, there: int) -> None:
        buffers = len(self._list("buffers"))
        total = 0
        for number, view in enumerate(self._list("bufferViews")):
            what = f"bufferViews[{number}]"
            self._index(view, "buffer", buffers, what)
            self._count(view, "byteOffset", what)
            self._count(view, "byteStride", what)
            total += self._count(view, "byteLength", what)
            self._compare(total, there, what)

    def _check_accessors(self, there: int) -> None:
        views = len(self._list("bufferViews"))
        total = 0
        for number, accessor in enumerate(self._list("accessors")):
            what = f"accessors[{number}]"
            if "bufferView" in accessor:
                self._index(accessor, "bufferView", views, what)
            self._count(accessor, "byteOffset", what)
            count = self._count(accessor, "count", what)
            total += count * self._item(accessor, what)
            self._compare(total, there, what)

    def _item(self, accessor: Tree, what: str) -> int:
        """Return the size of one item in bytes."""
        try:
            return _BYTES[accessor["componentType"]] * _COLUMNS[accessor["type"]]
        except (KeyError, TypeError) as error:
            raise self._error(f"{what} has an unknown type") from error

    def _check_primitives(self) -> None:
        accessors = self._list("accessors")
        for number, mesh in enumerate(self._list("meshes")):
            for primitive in self._dicts(mesh.get("primitives", []), f"meshes[{number}]"):
                for key, found in self._used(primitive, f"meshes[{number}]").items():
                    what = f"meshes[{number}]"
                    accessor = accessors[self._index({key: found}, key, len(accessors), what)]
                    if "bufferView" not in accessor or "sparse" in accessor:
                        raise self._error(
                            f"{what}: {key} is sparse, compressed or without data: save the file "
                            "without compression"
                        )

    def _used(self, primitive: Tree, what: str) -> Tree:
        """Return the accessors of rows, normals, colours and faces."""
        (attributes,) = self._dicts([primitive.get("attributes", {})], what)
        read = ("POSITION", "NORMAL", "COLOR_0")
        used = {key: attributes[key] for key in read if key in attributes}
        return used | ({"indices": primitive["indices"]} if "indices" in primitive else {})

    def _check_nodes(self) -> None:
        nodes, meshes = self._list("nodes"), len(self._list("meshes"))
        for number, node in enumerate(nodes):
            if "mesh" in node:
                self._index(node, "mesh", meshes, f"nodes[{number}]")
        for kind, key in (("nodes", "children"), ("scenes", "nodes")):
            for number, parent in enumerate(self._list(kind)):
                named = parent.get(key, [])
                if not isinstance(named, list):
                    raise self._error(f"{kind}[{number}]: {key} is not a list")
                for child in named:
                    self._index({key: child}, key, len(nodes), f"{kind}[{number}]")

    def _list(self, key: str) -> list[Tree]:
        return self._dicts(self._tree.get(key, []), key)

    def _dicts(self, found: object, what: str) -> list[Tree]:
        if not isinstance(found, list) or not all(isinstance(each, dict) for each in found):
            raise self._error(f"{what} is not a list of objects")
        return found

    def _count(self, part: Tree, key: str, what: str) -> int:
        count = part.get(key, 0)
        if type(count) is not int or count < 0:
            raise self._error(f"{what}: {key} is {str(count)[:40]}")
        return count

    def _index(self, part: Tree, key: str, limit: int, what: str) -> int:
        index = self._count(part, key, what)
        if index >= limit:
            raise self._error(f"{what}: {key} is {index}, but there are only {limit}")
        return index

    def _compare(self, promised: int, there: int, what: str) -> None:
        if promised > _SHARED * there:
            raise self._error(
                f"{what} raises the size of the promised data to {promised} bytes, but there are "
                f"{there}: the file is truncated, or its counts are wrong"
            )

    def _error(self, cause: str) -> FormatError:
        return FormatError(f"{self._name}: not a valid {self._kind} file: {cause}")
