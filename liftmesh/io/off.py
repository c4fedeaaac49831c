"""OFF files, reader and writer: coordinates and faces as text.

An OFF file holds the word OFF, the numbers of vertices, faces and edges, then a line for each
vertex and each face. A vertex line begins with x, y and z; a face line with its number of vertices
and their indices, counted from 0. Colours and normals may follow on both, announced by letters
before OFF (COFF, NOFF): they are skipped.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import BinaryIO

import numpy as np

from liftmesh._typing import Floats
from liftmesh.cloud import Cloud
from liftmesh.errors import FormatError
from liftmesh.io.faces import Ragged, face_counts, triangulated
from liftmesh.io.format import Format
from liftmesh.io.text_tables import BLOCK, Block, Lines, number_table, quoted, write_rows

_HEAD = re.compile(r"(?:ST)?C?N?OFF(?:\s+(.*))?")


def read_off(stream: BinaryIO, name: str) -> Cloud:
    """Read an OFF file.

    Returns
    -------
    Cloud
        Coordinates and faces, polygons split into triangles; ``metadata`` counts ``polygons``, and
        omitted ``degenerate_faces`` of fewer than three vertices.

    Raises
    ------
    FormatError
        The file is invalid, or holds fewer or more rows than its header promises; the message gives
        the line.
    """
    lines = Lines(stream, name, comments=("#",))
    vertices, faces = _counts(lines, name)
    points = [_points(block, name) for block in _take(lines, vertices, "vertices", name)]
    if not points:
        raise FormatError(f"{name}: the file holds no vertices")
    corners = [_corners(block, name) for block in _take(lines, faces, "faces", name)]
    if len(lines.take(1)):
        raise FormatError(
            f"{name}: line {lines.number}: more rows follow than the header promises: "
            "correct its counts"
        )
    return _cloud(np.concatenate(points), corners, name)


def write_off(stream: BinaryIO, cloud: Cloud) -> None:
    """Write a mesh as OFF, with digits that round-trip.

    Parameters
    ----------
    cloud : Cloud
        A mesh; colours, normals and attributes are not written.
    """
    faces = np.zeros((0, 3), dtype=np.int32) if cloud.faces is None else cloud.faces
    stream.write(b"OFF\n%d %d 0\n" % (len(cloud), len(faces)))
    write_rows(stream, [cloud.points])
    write_rows(stream, [faces], prefix="3 ")


def _cloud(points: Floats, corners: list[Ragged], name: str) -> Cloud:
    if not corners:
        return Cloud(points)
    faces = Ragged.joined(corners)
    return Cloud(points, faces=triangulated(faces, len(points), name), metadata=face_counts(faces))


def _counts(lines: Lines, name: str) -> tuple[int, int]:
    """Read the numbers of vertices and faces."""
    found = _HEAD.fullmatch(lines.next())
    if found is None:
        raise FormatError(f"{name}: not a valid OFF file: it does not begin with OFF")
    words = (found[1] or lines.next()).split()[:2]
    if len(words) < 2 or not all(w.isascii() and w.isdigit() and len(w) < 19 for w in words):
        raise FormatError(
            f"{name}: line {lines.number}: expected the numbers of vertices and faces, "
            f"found {quoted(' '.join(words))}"
        )
    return int(words[0]), int(words[1])


def _take(lines: Lines, wanted: int, what: str, name: str) -> Iterator[Block]:
    """Take as many lines as the header promises."""
    left = wanted
    while left:
        block = lines.take(min(left, BLOCK))
        if not len(block):
            raise FormatError(
                f"{name}: line {lines.number}: the header promises {wanted} {what}, but "
                f"{wanted - left} are there: the file is truncated, or its header is wrong"
            )
        yield block
        left -= len(block)


def _points(block: Block, name: str) -> Floats:
    table = number_table(block, name)
    if table.shape[1] < 3:
        raise FormatError(f"{name}: line {block.numbers[0]}: a vertex needs x, y and z")
    return table[:, :3]


def _corners(block: Block, name: str) -> Ragged:
    """Parse face lines, all at once if the faces have one size, as most do."""
    try:
        table = number_table(block, name)
    except FormatError:
        return _by_line(block, name)
    size = table[0, 0]
    alike = 0 <= size < table.shape[1] and np.all(table[:, 0] == size)
    values = table[:, 1 : int(size) + 1] if alike else table[:, :0]
    if not alike or not np.all((values == np.rint(values)) & (np.abs(values) < 2.0**53)):
        return _by_line(block, name)
    return Ragged.uniform(values.astype(np.int64))


def _by_line(block: Block, name: str) -> Ragged:
    rows = [_row(text, number, name) for text, number in block]
    sizes = np.array([len(row) for row in rows], dtype=np.int64)
    return Ragged(sizes, np.array([vertex for row in rows for vertex in row], dtype=np.int64))


def _row(text: str, number: int, name: str) -> list[int]:
    words = text.split()
    size = int(words[0]) if words[0].isascii() and words[0].isdigit() and len(words[0]) < 10 else -1
    corners = words[1 : size + 1]
    whole = all(re.fullmatch(r"-?\d{1,18}", word, re.ASCII) for word in corners)
    if not whole or size != len(corners):
        raise FormatError(
            f"{name}: line {number}: {quoted(text)} is not a face: expected its number of "
            "vertices, then their indices, counted from 0"
        )
    return [int(word) for word in corners]


FORMAT = Format(
    name="off",
    suffixes=(".off",),
    read=read_off,
    write=write_off,
    description="OFF: coordinates and faces as text",
    keeps=("points", "faces", "float64"),
    needs=("points", "faces", "finite"),
)
