"""OFF to Cloud and back.

A file is a word (OFF, COFF with colours, NOFF with normals), the numbers of vertices, faces and
edges, a line for each vertex, and one for each face: its size, its vertices counted from 0, and
perhaps a colour, which is passed over.

It is read and written here, not by trimesh, which writes a fixed number of decimals, does not
notice that faces are missing, and misreads lines that end in a comment.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from liftmesh.cloud import Cloud
from liftmesh.errors import FormatError
from liftmesh.formats.colors import recognized
from liftmesh.formats.digits import write_rows
from liftmesh.formats.format import Format
from liftmesh.formats.lines import Block, Lines, exact_column, fields, number_table, shown
from liftmesh.formats.ragged import Ragged
from liftmesh.formats.triangles import remarks, triangulated

if TYPE_CHECKING:
    from collections.abc import Iterator

Array = NDArray[Any]

_KINDS = ("OFF", "COFF", "NOFF")
_INDEX = np.dtype(np.int64)


def read_off(stream: BinaryIO, name: str) -> Cloud:
    """Read an OFF file.

    Parameters
    ----------
    stream : binary stream
        At the first byte of the file.
    name : str
        The file's name for messages.

    Returns
    -------
    Cloud
        Coordinates as float64, polygons as fans of triangles; colours of COFF, normals of NOFF.

    Raises
    ------
    FormatError
        The file is broken; the message names the line.
    """
    lines = Lines(stream, name, comments=("#",))
    kind, vertices, faces = _header(lines, name)
    table = _vertices(lines, vertices, name)
    if table.shape[1] < (3 if kind == "OFF" else 6):
        raise FormatError(f"{name}: a vertex of {kind} needs more than {table.shape[1]} values")
    polygons = _faces(lines, faces, name)
    return Cloud(
        np.ascontiguousarray(table[:, :3]),
        colors=recognized(table[:, 3:7].copy()) if kind == "COFF" else None,
        normals=table[:, 3:6].copy() if kind == "NOFF" else None,
        faces=triangulated(polygons, len(table), name) if faces else None,
        metadata=remarks(polygons),
    )


def write_off(stream: BinaryIO, cloud: Cloud) -> None:
    """Write coordinates and faces as OFF, with the shortest digits that round-trip.

    Parameters
    ----------
    stream : binary stream
        Where to write.
    cloud : Cloud
        What to write; colours, normals and attributes are left out.
    """
    faces = 0 if cloud.faces is None else len(cloud.faces)
    stream.write(f"OFF\n{len(cloud)} {faces} 0\n".encode("ascii"))
    write_rows(stream, [cloud.points])
    if cloud.faces is not None:
        write_rows(stream, [cloud.faces], prefix="3 ")


def _header(lines: Lines, name: str) -> tuple[str, int, int]:
    kind, *counts = fields(lines.next(), None) or [""]
    if kind not in _KINDS:
        raise FormatError(f"{name}: {shown(kind)} is none of {', '.join(_KINDS)}: not an OFF file")
    counts = counts or fields(lines.next(), None)
    if len(counts) < 2:
        raise FormatError(f"{name}: line {lines.number}: no counts of vertices and faces")
    vertices, faces = (_count(word, lines.number, name) for word in counts[:2])
    if not vertices:
        raise FormatError(f"{name}: the file holds no vertices")
    return kind, vertices, faces


def _vertices(lines: Lines, count: int, name: str) -> NDArray[np.float64]:
    tables: list[NDArray[np.float64]] = []
    for block in _taken(lines, count, name):
        width = tables[0].shape[1] if tables else None
        tables.append(number_table(block, name, width=width))
    return np.concatenate(tables)


def _faces(lines: Lines, count: int, name: str) -> Ragged:
    parts = [_alike(block, name) or _by_line(block, name) for block in _taken(lines, count, name)]
    return Ragged.joined(parts) if parts else Ragged.empty(_INDEX)


def _alike(block: Block, name: str) -> Ragged | None:
    """Parse faces that all have the size of the first; None if they do not."""
    try:
        table = number_table(block, name)
    except FormatError:
        return None
    size = int(table[0, 0]) if np.isfinite(table[0, 0]) else -1
    if not 0 <= size < table.shape[1] or np.any(table[:, 0] != size):
        return None
    return Ragged.uniform(_indices(table[:, 1 : size + 1], block, name))


def _by_line(block: Block, name: str) -> Ragged:
    parts: list[Ragged] = []
    for row, (text, number) in enumerate(block):
        words = fields(text, None)
        size = _count(words[0], number, name)
        if len(words) <= size:
            raise FormatError(
                f"{name}: line {number}: expected {size + 1} values, found {len(words)}"
            )
        line = block[row : row + 1]
        corners = number_table(line, name)[:, 1 : size + 1]
        parts.append(Ragged.uniform(_indices(corners, line, name)))
    return Ragged.joined(parts)


def _indices(table: NDArray[np.float64], block: Block, name: str) -> Array:
    columns = [exact_column(each, _INDEX, name, "a vertex", block.numbers) for each in table.T]
    return np.stack(columns, axis=1) if columns else np.empty((len(table), 0), _INDEX)


def _taken(lines: Lines, count: int, name: str) -> Iterator[Block]:
    while count:
        block = lines.take(count)
        if not len(block):
            raise FormatError(
                f"{name}: line {lines.number}: the file ends, but its counts promise {count} more "
                "lines: it is cut short, or its counts are wrong"
            )
        yield block
        count -= len(block)


def _count(word: str, number: int, name: str) -> int:
    if not (word.isascii() and word.isdigit() and len(word) < 19):
        raise FormatError(f"{name}: line {number}: {shown(word)} is no count")
    return int(word)


FORMAT = Format(
    name="off",
    suffixes=(".off",),
    read=read_off,
    write=write_off,
    description="OFF: coordinates and faces as text",
)
