"""OFF: trimesh reads it; the writer is ours, since trimesh writes a fixed number of decimals.

trimesh does not notice that faces are missing at the end of a file: that is checked here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, BinaryIO

from liftmesh.errors import FormatError
from liftmesh.formats.digits import write_rows
from liftmesh.formats.exchange import read_with_trimesh
from liftmesh.formats.format import Format
from liftmesh.formats.lines import Lines, fields, shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from liftmesh.cloud import Cloud


def read_off(stream: BinaryIO, name: str) -> Cloud:
    """Read an OFF file: coordinates and faces; trimesh passes over colours.

    Parameters
    ----------
    stream : binary stream
        Seekable, at the first byte of the file.
    name : str
        The file's name for messages.

    Returns
    -------
    Cloud
        Coordinates as float64, polygons as triangles.

    Raises
    ------
    FormatError
        The file is broken.
    """
    begin = stream.tell()
    _check(Lines(stream, name, comments=("#",)), name)
    stream.seek(begin)
    return read_with_trimesh(stream, name, "off")


def write_off(stream: BinaryIO, cloud: Cloud) -> None:
    """Write coordinates and faces as OFF, with the shortest digits that round-trip.

    Parameters
    ----------
    stream : binary stream
        Where to write.
    cloud : Cloud
        What to write; OFF has no place for normals and attributes, and colours are left out.
    """
    faces = 0 if cloud.faces is None else len(cloud.faces)
    stream.write(f"OFF\n{len(cloud)} {faces} 0\n".encode("ascii"))
    write_rows(stream, [cloud.points])
    if cloud.faces is not None:
        write_rows(stream, [cloud.faces], prefix="3 ")


def _check(lines: Lines, name: str) -> None:
    """Compare the counts with the lines that follow."""
    words = _header(lines, name)
    vertices, faces = (_count(word, lines.number, name) for word in words[:2])
    for text, number in _taken(lines, vertices, name):
        _expect(fields(text, None), 3, number, name)
    for text, number in _taken(lines, faces, name):
        words = fields(text, None)
        _expect(words, 1 + _count(words[0], number, name), number, name)


def _taken(lines: Lines, count: int, name: str) -> Iterator[tuple[str, int]]:
    while count:
        block = lines.take(count)
        if not len(block):
            raise FormatError(
                f"{name}: line {lines.number}: the file ends, but its counts promise {count} more "
                "lines: it is cut short, or its counts are wrong"
            )
        count -= len(block)
        yield from block


def _header(lines: Lines, name: str) -> list[str]:
    words = fields(lines.next(), None)
    if words[:1] not in (["OFF"], ["COFF"]):
        raise FormatError(f"{name}: not an OFF file: its first word is not OFF")
    counts = words[1:] or fields(lines.next(), None)
    if len(counts) < 2:
        raise FormatError(f"{name}: line {lines.number}: no counts of vertices and faces")
    return counts


def _count(word: str, number: int, name: str) -> int:
    if not (word.isascii() and word.isdigit() and len(word) < 19):
        raise FormatError(f"{name}: line {number}: {shown(word)} is no count")
    return int(word)


def _expect(words: list[str], count: int, number: int, name: str) -> None:
    if len(words) < count:
        raise FormatError(f"{name}: line {number}: expected {count} values, found {len(words)}")


FORMAT = Format(
    name="off",
    suffixes=(".off",),
    read=read_off,
    write=write_off,
    description="OFF: coordinates and faces as text",
)
