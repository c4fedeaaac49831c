"""OFF files, reader and writer: coordinates and faces as text.

An OFF file holds the word OFF, the numbers of vertices, faces and edges, then a line for each
vertex and each face. A vertex line begins with x, y and z; a face line with its number of vertices
and their indices, counted from 0. Colours and normals may follow on both, announced by letters
before OFF (COFF, NOFF): they are skipped.
"""

from __future__ import annotations

import re
from itertools import islice
from typing import BinaryIO

import numpy as np

from liftmesh._typing import Floats
from liftmesh.base.cloud import Cloud
from liftmesh.errors import FormatError
from liftmesh.io.columns import Ragged, face_counts, faces_of, gathered, triangulated
from liftmesh.io.text_tables import (
    HASH,
    Block,
    Lines,
    check_end,
    is_count,
    number_table,
    promised,
    quoted,
    ragged_numbers,
    whole,
    words_of,
    write_rows,
)

_INDEX = re.compile(r"-?\d{1,9}", re.ASCII)
_HEAD = re.compile(r"(?:ST)?C?N?OFF(?:\s+(.*))?")


def read_off(stream: BinaryIO, name: str) -> Cloud:
    """Read an OFF file."""
    lines = Lines(stream, name, HASH)
    vertices, faces = _counts(lines, name)
    points = [_points(block, name) for block in promised(lines, vertices, "vertices", name)]
    if not points:
        raise FormatError(f"{name}: the file holds no vertices")
    corners = [_corners(block, name) for block in promised(lines, faces, "faces", name)]
    check_end(lines, name)
    return _cloud(np.concatenate(points), corners, name)


def write_off(stream: BinaryIO, cloud: Cloud) -> None:
    """Write a mesh as OFF, with digits that round-trip."""
    faces = faces_of(cloud)
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
    head = _HEAD.fullmatch(lines.next())
    if head is None:
        raise FormatError(f"{name}: not a valid OFF file: it does not begin with OFF")
    words = (head[1] or lines.next()).split()[:2]
    if len(words) < 2 or not all(map(is_count, words)):
        raise FormatError(
            f"{name}: line {lines.number}: expected the numbers of vertices and faces, "
            f"found {quoted(' '.join(words))}"
        )
    return int(words[0]), int(words[1])


def _points(block: Block, name: str) -> Floats:
    table = number_table(block, name)
    if table.shape[1] < 3:
        raise FormatError(f"{name}: line {block.numbers[0]}: a vertex needs x, y and z")
    return table[:, :3]


def _corners(block: Block, name: str) -> Ragged:
    """Parse face lines: the number of vertices, the vertices, and what may follow them."""
    try:
        return _located(ragged_numbers(block, name))
    except ValueError as error:
        for text, number in block:
            _check_row(text, number, name)
        if isinstance(error, FormatError):
            raise
        raise FormatError(f"{name}: line {block.numbers[0]} or later: {error}") from error


def _located(numbers: Ragged) -> Ragged:
    ends = np.cumsum(numbers.sizes)
    starts = ends - numbers.sizes
    sizes = whole(numbers.values[starts], np.int32)
    if (sizes < 0).any() or (starts + sizes >= ends).any():
        raise ValueError("a face has fewer vertices than it says")
    return Ragged(sizes, whole(gathered(numbers.values, starts + 1, sizes), np.int32))


def _check_row(text: str, number: int, name: str) -> None:
    words = words_of(text)
    first = next(words)
    size = int(first) if is_count(first, 9) else -1
    corners = sum(_INDEX.fullmatch(word) is not None for word in islice(words, max(size, 0)))
    if size != corners:
        raise FormatError(
            f"{name}: line {number}: {quoted(text)} is not a face: expected its number of "
            "vertices, then their indices, counted from 0"
        )
