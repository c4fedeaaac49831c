"""Validation of glTF files before anything is allocated, and the files that they may name.

The JSON tree of a glTF or GLB file says which bytes of which buffer are which numbers. Counts that
lie would ask for memory that no file backs; numbers that are written as differences to others, or
compressed, would be read as zeros; indices below zero would be counted from the end. All are
refused here.

A glTF file may keep its numbers in other files. Whoever made it is not trusted with a choice among
all files of the machine, nor with its network: only buffers in its own folder are read. Names that
lead out of it, by ``..``, from the root, through a link or to a server, are refused.
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
    """Reads files in the folder of ``name``, each once, and only those that were ``announced``."""

    def __init__(self, name: str, announced: Collection[str] = ()) -> None:
        self._name = name
        self._announced = announced
        self._contents: dict[str, bytes] = {}

    def __getitem__(self, wanted: str) -> bytes:
        if wanted not in self._announced:
            raise FormatError(f"{self._name}: {wanted[:60]!r} is none of its buffers")
        if wanted not in self._contents:
            self._contents[wanted] = self._path(wanted).read_bytes()
        return self._contents[wanted]

    def size(self, wanted: str) -> int:
        """Count the bytes of a file without reading it."""
        return self._path(wanted).stat().st_size

    def _path(self, wanted: str) -> Path:
        if not os.path.isfile(self._name):  # noqa: PTH113 - a name of a stream may hold any bytes
            raise FormatError(
                f"{self._name}: its buffer {wanted[:60]!r} is another file, and only a file has "
                "others beside it: give its path"
            )
        folder = Path(self._name).absolute().parent.resolve()
        try:
            path = (folder / unquote(wanted)).resolve()
            is_there = path.is_file()
        except (OSError, ValueError):  # no name that a file can have
            path, is_there = folder, False
        if "://" in wanted or not path.is_relative_to(folder):
            raise FormatError(
                f"{self._name}: its buffer {wanted[:60]!r} is not in its folder: put it there"
            )
        if not is_there:
            raise FormatError(f"{self._name}: its buffer {wanted[:60]!r} is not there")
        return path


Tree = dict[str, Any]

_MAGIC = b"glTF"
_JSON = b"JSON"
_HEAD = struct.Struct("<4s8xI4s")
_BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
_COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}

# Views and accessors may share bytes: how often, in all, before that is no use but an attack.
_SHARED = 64


def checked_gltf(stream: BinaryIO, name: str, kind: str) -> Resolver:
    """Check the tree of a file, and say how the files that it names are read.

    The stream stays where it is.

    Raises
    ------
    FormatError
        The tree is broken, or promises what is not there; the message names the part.
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
        raise FormatError(f"{name}: not a whole {kind} file: {error}") from error
    if not isinstance(tree, dict):
        raise FormatError(f"{name}: not a whole {kind} file: its JSON is no object")
    return tree


def _json_chunk(stream: BinaryIO, name: str) -> bytes:
    head = stream.read(_HEAD.size)
    if len(head) < _HEAD.size or not head.startswith(_MAGIC):
        raise FormatError(f"{name}: not a whole glb file: it begins with {head[:4]!r}")
    _, size, kind = _HEAD.unpack(head)
    if kind != _JSON or size > remaining(stream):
        raise FormatError(
            f"{name}: not a whole glb file: byte 12: a chunk {kind!r} of {size} bytes should be "
            f"its JSON, and {remaining(stream)} are left"
        )
    return stream.read(size)


class _Validation:
    """The parts of a tree, each checked."""

    def __init__(self, tree: Tree, name: str, kind: str) -> None:
        self._tree = tree
        self._name = name
        self._kind = kind

    def check(self, size: int) -> Resolver:
        """Hold everything against the bytes of the file and of those that it names."""
        uris = [each["uri"] for each in self._list("buffers") if "uri" in each]
        if not all(isinstance(uri, str) for uri in uris):
            raise self._error("a buffer has a name that is no text")
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
        """Count the bytes of one item."""
        try:
            return _BYTES[accessor["componentType"]] * _COLUMNS[accessor["type"]]
        except (KeyError, TypeError) as error:
            raise self._error(f"{what} has no known type") from error

    def _check_primitives(self) -> None:
        accessors = self._list("accessors")
        for number, mesh in enumerate(self._list("meshes")):
            for primitive in self._dicts(mesh.get("primitives", []), f"meshes[{number}]"):
                for key, found in self._used(primitive, f"meshes[{number}]").items():
                    what = f"meshes[{number}]"
                    accessor = accessors[self._index({key: found}, key, len(accessors), what)]
                    if "bufferView" not in accessor or "sparse" in accessor:
                        raise self._error(
                            f"{what}: {key} is sparse, compressed or without bytes: save it plain"
                        )

    def _used(self, primitive: Tree, what: str) -> Tree:
        """Pick the accessors that become rows, normals, colours and faces."""
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
                    raise self._error(f"{kind}[{number}]: {key} is no list")
                for child in named:
                    self._index({key: child}, key, len(nodes), f"{kind}[{number}]")

    def _list(self, key: str) -> list[Tree]:
        return self._dicts(self._tree.get(key, []), key)

    def _dicts(self, found: object, what: str) -> list[Tree]:
        if not isinstance(found, list) or not all(isinstance(each, dict) for each in found):
            raise self._error(f"{what} is no list of objects")
        return found

    def _count(self, part: Tree, key: str, what: str) -> int:
        count = part.get(key, 0)
        if type(count) is not int or count < 0:
            raise self._error(f"{what}: {key} is {str(count)[:40]}")
        return count

    def _index(self, part: Tree, key: str, limit: int, what: str) -> int:
        index = self._count(part, key, what)
        if index >= limit:
            raise self._error(f"{what}: {key} is {index}, but there are {limit}")
        return index

    def _compare(self, promised: int, there: int, what: str) -> None:
        if promised > _SHARED * there:
            raise self._error(
                f"{what} would bring the bytes that are promised to {promised}, but {there} are "
                "there: the file is cut short, or its counts are wrong"
            )

    def _error(self, cause: str) -> FormatError:
        return FormatError(f"{self._name}: not a whole {self._kind} file: {cause}")
