"""STL files: binary, read and written, and text, read by `io.stl_text`.

A binary file is a header of 80 bytes, the number of facets, and 50 bytes for each facet: normal,
three corners, and two bytes that programs use as they like. Many headers begin with "solid", as
every text does: a file is binary if its size is that of its number of facets, or if it begins with
bytes that no text holds.

STL has no vertices of its own: corners at equal positions become one. An origin stands in the
header as ``liftmesh origin x y z``.
"""

from __future__ import annotations

import re
import struct
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.arrays import used_rows, widened
from liftmesh.cloud import Cloud
from liftmesh.errors import FormatError
from liftmesh.io.origin import checked_origin, needed_origin, with_origin, without_origin
from liftmesh.io.stl_text import read_corners
from liftmesh.io.streams import read_exactly, remaining
from liftmesh.io.text_tables import quoted
from liftmesh.io.welding import weld

if TYPE_CHECKING:
    from liftmesh.io.format import Origin

_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_TITLE_SIZE = 80
_ROWS = 1 << 13  # a block that fits in the cache of one core
_HEAD = struct.Struct(f"<{_TITLE_SIZE}sI")
_STATED = "liftmesh origin"

# The byte order mark, white space and comments may come first. Control characters are in no text.
_TEXT = re.compile(rb"(?:\xef\xbb\xbf)?\s*(?:solid\b|[#;])[^\0-\x08\x0e-\x1f]*", re.IGNORECASE)
_CONTROL = re.compile(rb"[\0-\x08\x0e-\x1f]")


def read_stl(stream: BinaryIO, name: str) -> Cloud:
    """Read an STL file, binary or text."""
    begin, size = stream.tell(), remaining(stream)
    head = stream.read(_HEAD.size)
    if not _is_text(head, size):
        return _binary(stream, head, size, name)
    stream.seek(begin)
    corners, colors = read_corners(stream, name)
    return _welded(corners, name, **_skipped(f"{colors} lines of colours" if colors else ""))


def write_stl(stream: BinaryIO, cloud: Cloud) -> Origin | None:
    """Write triangles as binary STL."""
    faces = np.zeros((0, 3), dtype=np.int32) if cloud.faces is None else cloud.faces
    origin = needed_origin(cloud.points[used_rows(len(cloud), faces)], "stl")
    title = "liftmesh" if origin is None else f"{_STATED} {' '.join(map(repr, origin))}"
    if len(title) > _TITLE_SIZE:
        raise FormatError(f"the origin {origin} does not fit the header of STL: write PLY or OBJ")
    stream.write(_HEAD.pack(title.encode("ascii"), len(faces)))
    _write_facets(stream, without_origin(cloud.points, origin), faces)
    return origin


def _write_facets(stream: BinaryIO, points: Floats, faces: Array) -> None:
    """Write facets block by block, without a copy of the mesh in memory."""
    block = np.zeros(min(len(faces), _ROWS), dtype=_FACET)
    for start in range(0, len(faces), _ROWS):
        some = faces[start : start + _ROWS]
        corners = points.take(some.reshape(-1), axis=0).reshape(-1, 3, 3)
        part = block[: len(some)]
        part["normal"] = _normals(corners)
        part["corners"] = corners
        stream.write(part.tobytes())


def _is_text(head: bytes, size: int) -> bool:
    return _TEXT.fullmatch(head) is not None and size != _stated_size(head)


def _stated_size(head: bytes) -> int:
    """The size of a binary file with this head; 0 if the head itself is not whole."""
    return _HEAD.size + _HEAD.unpack(head)[1] * _FACET.itemsize if len(head) == _HEAD.size else 0


def _binary(stream: BinaryIO, head: bytes, size: int, name: str) -> Cloud:
    _check_size(head, size, name)
    title, count = _HEAD.unpack(head)
    origin = _stated_origin(title, name)
    facets = np.frombuffer(
        read_exactly(stream, count * _FACET.itemsize, name, "the facets"), dtype=_FACET
    )
    marked = int(np.count_nonzero(facets["attribute"]))
    skipped = _skipped(f"attribute bytes of {marked} facets" if marked else "")
    corners = widened(facets["corners"].reshape(-1, 3))
    return with_origin(_welded(corners, name, **skipped), origin)


def _skipped(what: str) -> dict[str, tuple[str, ...]]:
    return {"skipped": (what,)} if what else {}


def _check_size(head: bytes, size: int, name: str) -> None:
    if len(head) < _HEAD.size:
        raise FormatError(
            f"{name}: not a valid stl file: its {size} bytes are neither text that begins with "
            f"'solid' nor a whole header of {_HEAD.size} bytes"
        )
    stated = _stated_size(head)
    if size != stated and not _CONTROL.search(head):
        raise FormatError(
            f"{name}: not a valid stl file: its {size} bytes are neither text that begins with "
            "'solid' nor binary facets"
        )
    if size != stated:
        raise FormatError(
            f"{name}: not a valid stl file: byte {_TITLE_SIZE}: {_HEAD.unpack(head)[1]} facets "
            f"would take {stated} bytes, but the file has {size}: it is truncated, or not STL"
        )


def _stated_origin(title: bytes, name: str) -> Origin | None:
    text = title.rstrip(b"\0 ").decode("latin-1")
    if not text.startswith(_STATED):
        return None
    try:
        values = [float(word) for word in text[len(_STATED) :].split()]
    except ValueError as error:
        raise FormatError(f"{name}: the origin in the header is invalid: {quoted(text)}") from error
    return checked_origin(values, name)


def _welded(corners: Floats, name: str, **metadata: object) -> Cloud:
    """Merge equal corners, in the order of first appearance."""
    if not len(corners):
        raise FormatError(f"{name}: the file holds no vertices")
    kept, place = weld(corners)
    return Cloud(
        corners[kept],
        faces=place.reshape(-1, 3).astype(np.int32),
        metadata={"repeated_vertices": len(corners) - len(kept), **metadata},
    )


def _normals(corners: Floats) -> Floats:
    """Compute unit normals; zero for triangles without a direction."""
    a, b, c = np.moveaxis(corners, 0, -1).copy()  # each has x, y and z in rows
    first, second = b - a, c - b
    x, y, z = (first[i] * second[j] - first[j] * second[i] for i, j in ((1, 2), (2, 0), (0, 1)))
    lengths = np.sqrt(x * x + y * y + z * z)
    normals = np.zeros((3, len(corners)))
    np.divide((x, y, z), lengths, out=normals, where=lengths > 0)
    found: Floats = normals.T
    return found
