"""STL files: binary, read and written, and text, which is read.

A binary file is a header of 80 bytes, the number of facets, and 50 bytes for each facet: normal,
three corners, and two bytes that programs use as they like. Many headers begin with "solid", as
every text does: a file is binary if its size is that of its number of facets, or if it begins with
bytes that no text holds. An origin stands in the header as ``liftmesh origin x y z``.

A text file holds solids, each from a line ``solid`` to a line ``endsolid``, both with a name or
without, and between them facets of seven lines::

    facet normal nx ny nz
    outer loop
    vertex x y z        (three times)
    endloop
    endfacet

Normals are not read: programs write what they like for a triangle without a direction. Keywords
are in lower or upper case, and ``end`` may be a word of its own. Empty lines and comments, from
``#`` or a ``;`` at the beginning of a line, do not count, and lines ``color`` are left out. A solid
also ends where the next one begins; after the last one, NUL and Ctrl-Z may fill the file. The lines
are taken in large blocks, and all numbers of a block are parsed at once.

STL has no vertices of its own: corners at equal positions become one. Rows are sorted by a hash of
their coordinates, and neighbours in this order compared. If different rows share a hash, the
coordinates themselves are sorted: a collision costs one more sort. The hash depends on a secret of
the process, so that no file gives very many different rows one hash; the result does not depend on
it. Many rows are first distributed by bits of their hashes, so that no step takes long: between
steps Python hears signals.
"""

from __future__ import annotations

import os
import re
import struct
from collections.abc import Iterator
from dataclasses import replace
from typing import BinaryIO

import numpy as np
from numpy.typing import NDArray

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Integers, Mask
from liftmesh.base.arrays import used_rows, widened
from liftmesh.base.cloud import Cloud
from liftmesh.errors import FormatError
from liftmesh.io.columns import faces_of
from liftmesh.io.format import Origin, checked_origin, needed_origin, with_origin, without_origin
from liftmesh.io.metadata import noted
from liftmesh.io.streams import read_exactly, remaining
from liftmesh.io.text_tables import BLOCK, Block, Lines, Syntax, number_table, quoted

_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
_TITLE_SIZE = 80
_ROWS = 1 << 13  # a block that fits in the cache of one core
_HEAD = struct.Struct(f"<{_TITLE_SIZE}sI")
_STATED = "liftmesh origin"

# The byte order mark, white space and comments may come first. Control characters are in no text.
_TEXT = re.compile(rb"(?:\xef\xbb\xbf)?\s*(?:solid\b|[#;])[^\0-\x08\x0e-\x1f]*", re.IGNORECASE)
_CONTROL = re.compile(rb"[\0-\x08\x0e-\x1f]")

_LINES = 7
_VERTICES = slice(2, 5)  # of the lines of a facet
_MARK = "\ufeff".encode().decode("latin-1")  # some editors begin a text with it
_SYNTAX = Syntax(comments=("#", ";"))
_FILLING = "\0\x1a"  # some programs fill the last block of a file

_PART = 1 << 20  # rows sorted at once
_FACTORS = tuple(int.from_bytes(os.urandom(8), "little") | 1 for _ in range(3))

Hashes = NDArray[np.uint64]


def read_stl(stream: BinaryIO, name: str) -> Cloud:
    """Read an STL file, binary or text."""
    begin, size = stream.tell(), remaining(stream)
    head = stream.read(_HEAD.size)
    if not _is_text(head, size):
        return _binary(stream, head, size, name)
    stream.seek(begin)
    corners, colors = read_corners(stream, name)
    return _welded(corners, name, f"{colors} lines of colours" if colors else "")


def write_stl(stream: BinaryIO, cloud: Cloud) -> Origin | None:
    """Write triangles as binary STL."""
    faces = faces_of(cloud)
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


def _is_text(head: bytes, size: int) -> bool:
    return _TEXT.fullmatch(head) is not None and size != _stated_size(head)


def _stated_size(head: bytes) -> int:
    """The size of a binary file with this head; 0 if the head itself is not whole."""
    return _HEAD.size + _HEAD.unpack(head)[1] * _FACET.itemsize if len(head) == _HEAD.size else 0


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


def _binary(stream: BinaryIO, head: bytes, size: int, name: str) -> Cloud:
    _check_size(head, size, name)
    title, count = _HEAD.unpack(head)
    origin = _stated_origin(title, name)
    facets = np.frombuffer(
        read_exactly(stream, count * _FACET.itemsize, name, "the facets"), dtype=_FACET
    )
    marked = int(np.count_nonzero(facets["attribute"]))
    skipped = f"attribute bytes of {marked} facets" if marked else ""
    corners = widened(facets["corners"].reshape(-1, 3))
    return with_origin(_welded(corners, name, skipped), origin)


def _stated_origin(title: bytes, name: str) -> Origin | None:
    text = title.rstrip(b"\0 ").decode("latin-1")
    if not text.startswith(_STATED):
        return None
    try:
        values = [float(word) for word in text[len(_STATED) :].split()]
    except ValueError as error:
        raise FormatError(f"{name}: the origin in the header is invalid: {quoted(text)}") from error
    return checked_origin(values, name)


def _welded(corners: Floats, name: str, skipped: str) -> Cloud:
    """Merge equal corners, in the order of first appearance."""
    if not len(corners):
        raise FormatError(f"{name}: the file holds no vertices")
    kept, place = weld(corners)
    return Cloud(
        corners[kept],
        faces=place.reshape(-1, 3).astype(np.int32),
        metadata=noted(
            {},
            repeated_vertices=len(corners) - len(kept),
            not_read=(skipped,) if skipped else (),
        ),
    )


def read_corners(stream: BinaryIO, name: str) -> tuple[Floats, int]:
    """Read the corners of all facets of a text file, three rows each; count lines of colours."""
    solids = _Solids(name)
    lines = Lines(stream, name, _SYNTAX)
    parts = [_corners(facets, name) for facets in _facets(lines, solids)]
    return np.concatenate(parts) if parts else np.empty((0, 3)), solids.colors


def _facets(lines: Lines, solids: _Solids) -> Iterator[Block]:
    """Yield the lines of whole facets, without those of the solids around them."""
    left = Block.empty()
    while len(block := lines.take(BLOCK)):
        facets, left = solids.split(left.followed_by(solids.without_colors(block)))
        yield facets  # errors in them come first
        solids.check()
    solids.finish(left, lines.number)


class _Solids:
    """Finds the facets among the lines, and checks that every solid has its end."""

    def __init__(self, name: str) -> None:
        self.colors = 0  # lines left out
        self._name = name
        self._begin = 0  # the line of the solid that has no end yet
        self._wrong: FormatError | None = None

    def without_colors(self, block: Block) -> Block:
        """Leave out the colours of facets, which may stand anywhere."""
        if b"color" not in block.data.lower():
            return block
        kept = [text[:6].rstrip().lower() != "color" for text in block.texts]
        self.colors += len(block) - sum(kept)
        return block[np.array(kept)]

    def split(self, block: Block) -> tuple[Block, Block]:
        """Return the lines of the whole facets, and those of an unfinished one at the end."""
        texts = block.texts
        facets: list[slice] = []
        at = 0
        while at < len(block):
            end = self._end_of_facets(texts, at)
            facets.append(slice(at, end))
            at = end
            if at == len(block) or self._within_facet(texts[at]):
                break
            if not self._take(texts[at], int(block.numbers[at])):
                break
            at += 1
        return _cut(block, facets), block[at:]

    def check(self) -> None:
        """Raise if a line was wrong."""
        if self._wrong is not None:
            raise self._wrong

    def _end_of_facets(self, texts: list[str], at: int) -> int:
        while at + _LINES <= len(texts) and self._within_facet(texts[at]):
            at += _LINES
        return at

    def _within_facet(self, text: str) -> bool:
        return self._begin > 0 and text[:6].rstrip().lower() == "facet"

    def _take(self, text: str, number: int) -> bool:
        """Take the first or last line of a solid, or what fills the file; False if it is none."""
        words = text.removeprefix(_MARK).strip(_FILLING).lower().split(None, 2)[:2]
        ends = words[:1] == ["endsolid"] or words == ["end", "solid"]
        if ends and self._begin:
            self._begin = 0
        elif words[:1] == ["solid"]:  # many programs do not end the one before
            self._begin = number
        elif words or self._begin:
            expected = "'facet' or 'endsolid'" if self._begin else "'solid'"
            self._wrong = _unexpected(self._name, number, text, expected)
            return False
        return True

    def finish(self, left: Block, number: int) -> None:
        """Raise if the file ends too early."""
        if self._begin:
            part = "a facet" if len(left) else f"the solid that begins in line {self._begin}"
            raise FormatError(
                f"{self._name}: not a valid stl file: line {number}: the file ends within {part}: "
                "it is truncated"
            )


def _cut(block: Block, runs: list[slice]) -> Block:
    """Join some runs of lines."""
    if len(runs) == 1:
        return block[runs[0]]
    kept = np.zeros(len(block), dtype=bool)
    for run in runs:
        kept[run] = True
    return block[kept]


def _corners(facets: Block, name: str) -> Floats:
    """Parse the lines of whole facets."""
    parts = [facets[k::_LINES] for k in range(_LINES)]
    _check_alone(parts[1], ("outer loop",), name)
    values = [_values(part, name) for part in parts[_VERTICES]]
    _check_alone(parts[5], ("endloop", "end loop"), name)
    _check_alone(parts[6], ("endfacet", "end facet"), name)
    corners = replace(
        facets,
        places=np.stack([part.places for part in values], axis=1).reshape(-1, 2),
        numbers=np.stack([part.numbers for part in values], axis=1).reshape(-1),
    )
    return number_table(corners, name, width=3)


def _check_alone(lines: Block, words: tuple[str, ...], name: str) -> None:
    """Raise if a line is not a keyword alone."""
    texts = lines.texts
    if not {*map(_plain, {*texts})} <= {*words}:
        text, number = next(each for each in lines if _plain(each[0]) not in words)
        raise _unexpected(name, number, text, repr(words[0]))


def _plain(text: str) -> str:
    """Write a keyword as most programs do."""
    return " ".join(text.lower().split(None, 2))


def _values(lines: Block, name: str) -> Block:
    """Return what follows the keyword ``vertex`` in each line."""
    if not _kernel.find_keywords(lines.data, lines.places, ["vertex"]).any():
        return lines.behind(len("vertex"))
    return lines.behind(np.array([_prefix(*line, name) for line in lines]))


def _prefix(text: str, number: int, name: str) -> int:
    """Count the characters before the numbers of a vertex, a byte each in this encoding."""
    word, *numbers = text.split(None, 1)
    if word.lower() != "vertex" or not numbers:
        raise _unexpected(name, number, text, "'vertex' with three numbers")
    return len(text) - len(numbers[0])


def _unexpected(name: str, number: int, text: str, expected: str) -> FormatError:
    return FormatError(
        f"{name}: not a valid stl file: line {number}: {quoted(text)}, where {expected} should be"
    )


def weld(points: Floats) -> tuple[Integers, Integers]:
    """Find the first of equal rows, and for each row the place of its equal among these."""
    rows = np.arange(len(points))
    first = rows.copy()
    hashes = _hashes(points)
    for part in _parts(hashes, rows[~np.isnan(points).any(axis=1)]):
        _find_first(points, hashes, part, first)
    kept = first == rows
    return np.flatnonzero(kept), (np.cumsum(kept) - 1)[first]


def _hashes(points: Floats) -> Hashes:
    """Hash rows; equal rows have equal hashes."""
    hashes = np.zeros(len(points), dtype=np.uint64)
    for axis, factor in enumerate(_FACTORS):
        hashes += (points[:, axis] + 0.0).view(np.uint64)  # + 0.0 turns -0.0 into 0.0
        hashes *= np.uint64(factor)
        hashes ^= hashes >> np.uint64(32)
    return hashes


def _parts(hashes: Hashes, rows: Integers) -> Iterator[Integers]:
    """Distribute rows by the bits of their hashes until few are left in a part, or all agree."""
    waiting = [rows]
    while waiting:
        rows = waiting.pop()  # a row is in one part only: splits take no more memory
        bit = _first_that_differs(hashes[rows]) if len(rows) > _PART else -1
        if bit < 0:
            yield rows
            continue
        upper = (hashes[rows] >> np.uint64(bit)) & np.uint64(1) == 1
        waiting += [rows[upper], rows[~upper]]


def _first_that_differs(hashes: Hashes) -> int:
    """Find the highest bit in which some hashes differ; -1 if all are equal."""
    return int(np.bitwise_or.reduce(hashes ^ hashes[0])).bit_length() - 1


def _find_first(points: Floats, hashes: Hashes, rows: Integers, first: Integers) -> None:
    """Set the first row that is equal to each of some rows; all rows equal to one are given."""
    order = rows[np.argsort(hashes[rows])]
    alike = hashes[order[1:]] == hashes[order[:-1]]
    equal = _equal_to_next(points, order)
    if not np.array_equal(alike, equal):
        order = rows[np.lexsort(points[rows].T)]
        equal = _equal_to_next(points, order)
    begins = np.flatnonzero(np.concatenate([[True], ~equal]))[: len(rows)]
    lowest = np.minimum.reduceat(order, begins) if len(rows) else order
    first[order] = np.repeat(lowest, np.diff(begins, append=len(rows)))


def _equal_to_next(points: Floats, order: Integers) -> Mask:
    placed = points[order]
    equal: Mask = (placed[1:] == placed[:-1]).all(axis=1)
    return equal
