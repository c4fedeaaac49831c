"""What the compression of a LAZ file states, checked before lazrs allocates memory for it.

The points are compressed in chunks, most often of 50,000. A record of LAZ gives the number of
points in a chunk and the items of a point; a table at the end gives the chunks, and its place
stands before the first of them. In formats 6 to 10 each chunk begins with its first point as it is
and the sizes of its layers. All of these are compared with the bytes that are there.

lazrs tells errors of a stream as damage of its own, and states places from the beginning of a file:
so it reads from an `ErrorRecordingStream`, and from an `OffsetStream` if that begins later.

Source: M. Isenburg, LASzip: lossless compression of lidar data, 2013, and its source code.

*COPC* is LAZ whose chunks are the nodes of an octree, so that a box or a resolution reads a part. A
record tells the cube of the octree, the distance between the points of its root, and where the
pages are that list the nodes. Each level halves the distance. A node must be a chunk of the table
that LAZ has anyway, with the same place, length and number of points: that table is checked
already, so no page can make anyone read anything else. The first point of each chunk, which is not
compressed, and all points that are decoded must lie in the cubes of their nodes: else the index is
not used. Source: COPC 1.0, copc.io.
"""

from __future__ import annotations

import io
import math
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.errors import FormatError
from liftmesh.io.formats.las.header import PACKING, LasHeader
from liftmesh.io.streams import kept_place, read_exactly
from liftmesh.optional import load

if TYPE_CHECKING:
    from liftmesh.io.selection import Selection

LARGEST_CHUNK = 1 << 20  # points that a thread decodes at once

_HEAD = struct.Struct("<HHBBHIIqqH")
_ITEM = struct.Struct("<HHH")
_PLACE = struct.Struct("<q")
_TABLE = struct.Struct("<II")
_VARIABLE = 0xFFFFFFFF  # points of a chunk, where the table gives them
_CHUNKED, _LAYERED = 2, 3  # compressors
_LAYERS = {10: 9, 11: 1, 12: 2, 13: 1}  # of the items of formats 6 to 10; of extra bytes one each
_EXTRA_BYTES = 14
_EMPTY = 16  # chunks of nothing, which some programs write
_PASSED_ON = {"seek", "tell", "read", "readinto", "write", "flush"}


@dataclass(frozen=True, slots=True)
class Chunks:
    """The chunks of a file."""

    listed: bool  # whether a table lists them
    largest: int  # points
    first: int = 0  # byte
    table: tuple[tuple[int, int], ...] = ()  # points and bytes of each
    surplus: str = ""  # what there is beyond the points that the header counts


def chunks_of(stream: BinaryIO, header: LasHeader, name: str) -> Chunks:
    """Check what a file states of its chunks; the stream goes back to where it was."""
    with kept_place(stream):
        return _Reading(stream, header, name).chunks()


class _Reading:
    """Reads the record of LAZ, the table of chunks, and the beginning of each chunk."""

    def __init__(self, stream: BinaryIO, header: LasHeader, name: str) -> None:
        self._stream = stream
        self._header = header
        self._name = name

    def chunks(self) -> Chunks:
        header = self._header
        record = header.record(*PACKING)
        if record is None or len(record) < _HEAD.size:
            raise self._error("the record that tells how the points are compressed is missing")
        compressor, _, _, _, _, _, size, _, _, count = _HEAD.unpack_from(record)
        items = self._items(record, count)
        if compressor not in (_CHUNKED, _LAYERED):
            return Chunks(listed=False, largest=header.points)
        if size == 0:
            raise self._error("the chunks have 0 points each")
        place, number = self._table()
        if size != _VARIABLE and number * size < header.points:
            raise self._error(
                f"the header states {header.points:,} points, but {number:,} chunks of {size:,} "
                f"hold {number * size:,}: it is truncated, or its header is wrong"
            )
        listed = self._listed(record, size, place)
        needed = len(listed) if size == _VARIABLE else -(-header.points // size)
        more = sum(length > 0 for _, length in listed[needed:])
        surplus = f"{more:,} chunks after the last point" if more else ""
        if compressor == _LAYERED:
            there = self._points_of_layers(listed, items) - header.points
            surplus = f"{there:,} points that the header does not count" if there > 0 else ""
        return Chunks(
            listed=True,
            largest=max((points for points, _ in listed), default=0),
            first=header.start + _PLACE.size,
            table=tuple(listed),
            surplus=surplus,
        )

    def _items(self, record: bytes, count: int) -> list[tuple[int, int]]:
        if len(record) < _HEAD.size + count * _ITEM.size:
            raise self._error(f"the record of its compression states {count:,} items, and ends")
        items = [_ITEM.unpack_from(record, _HEAD.size + k * _ITEM.size) for k in range(count)]
        total = sum(size for _, size, _ in items)
        if total != self._header.point_size:
            raise self._error(
                f"a point has {self._header.point_size} bytes, but its compressed items {total}"
            )
        return [(kind, size) for kind, size, _ in items]

    def _table(self) -> tuple[int, int]:
        """Return the place of the table, and the number of chunks that it lists."""
        start, size = self._header.start, self._header.size
        place = self._at(start, _PLACE, "the place of the table of chunks")[0]
        if place == -1:  # written where a file could not be changed afterwards
            place = self._at(size - _PLACE.size, _PLACE, "the place of the table of chunks")[0]
        if not start + _PLACE.size <= place <= size - _TABLE.size:
            raise self._error(
                f"the table of chunks should begin at byte {place:,}, and the file ends after "
                f"{size:,}: it is truncated"
            )
        version, number = self._at(place, _TABLE, "the table of chunks")
        there = place - start - _PLACE.size  # a chunk begins with a point as it is
        if version or number > there // self._header.point_size + _EMPTY:
            raise self._error(
                f"the table of chunks states {number:,} chunks of {there:,} bytes, in version "
                f"{version}"
            )
        return place, number

    def _listed(self, record: bytes, size: int, place: int) -> list[tuple[int, int]]:
        """Read the points and bytes of each chunk, and check their sums."""
        lazrs = load("lazrs", extra="las")
        self._stream.seek(self._header.start)
        source = ErrorRecordingStream(self._stream)
        try:
            vlr = lazrs.LazVlr(record)
            pairs = lazrs.read_chunk_table(source, vlr)
        except (lazrs.LazrsError, ValueError, OverflowError) as error:
            if source.failure is not None:
                raise source.failure from error
            raise self._error(f"the table of chunks cannot be decoded ({error})") from error
        listed = [(int(points), int(length)) for points, length in pairs]
        there = place - self._header.start - _PLACE.size
        if sum(length for _, length in listed) > there:
            raise self._error(f"the table lists chunks of more than the {there:,} bytes there are")
        total = sum(points for points, _ in listed)
        if size == _VARIABLE and total != self._header.points:
            raise self._error(
                f"the header states {self._header.points:,} points, but its chunks {total:,}"
            )
        if size != _VARIABLE:
            listed = [(size, length) for _, length in listed]
        return listed

    def _points_of_layers(self, listed: list[tuple[int, int]], items: list[tuple[int, int]]) -> int:
        """Compare the sizes of the layers of each chunk with its bytes; return all its points."""
        layers = sum(size if kind == _EXTRA_BYTES else _LAYERS.get(kind, 0) for kind, size in items)
        form = struct.Struct(f"<I{layers}I")
        place, points = self._header.start + _PLACE.size, 0
        for k, (_, length) in enumerate(listed):
            head = self._header.point_size + form.size
            if length >= head:
                count, *sizes = self._at(place + self._header.point_size, form, f"chunk {k}")
                head += sum(sizes)
                points += count
            if 0 < length < head:  # some programs end with a chunk of nothing
                raise self._error(f"chunk {k} has {length:,} bytes, and states {head:,}")
            place += length
        return points

    def _at(self, place: int, form: struct.Struct, what: str) -> Any:
        self._stream.seek(max(place, 0))
        return form.unpack(read_exactly(self._stream, form.size, self._name, what))

    def _error(self, cause: str) -> FormatError:
        return FormatError(f"{self._name}: LAZ: {cause}")


class ErrorRecordingStream:
    """A stream, and the first error of reading or writing it."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self.failure: OSError | None = None

    def __getattr__(self, name: str) -> Any:
        if name not in _PASSED_ON:  # readinto is what laspy asks for, as it spares a copy
            raise AttributeError(name)
        method = getattr(self._stream, name)

        def remembering(*values: Any) -> Any:
            try:
                return method(*values)
            except OSError as error:
                self.failure = self.failure or error
                raise

        return remembering


class OffsetStream:
    """A stream whose places count from another one's ``begin``."""

    def __init__(self, stream: BinaryIO, begin: int) -> None:
        self._stream = stream
        self._begin = begin

    def seek(self, place: int, whence: int = io.SEEK_SET) -> int:
        """Go to a place."""
        place += self._begin if whence == io.SEEK_SET else 0
        return self._stream.seek(place, whence) - self._begin

    def tell(self) -> int:
        """Return the place."""
        return self._stream.tell() - self._begin

    def read(self, size: int = -1) -> bytes:
        """Read bytes."""
        return self._stream.read(size)

    def write(self, data: bytes) -> int:
        """Write bytes."""
        return self._stream.write(data)

    def flush(self) -> None:
        """Hand on what has been written."""
        self._stream.flush()


_RECORD = (b"copc", 1)
_INFO = struct.Struct("<5d2Q")  # centre, half of the size, spacing, place and size of the root page
_ENTRY = np.dtype([("key", "<i4", (4,)), ("place", "<u8"), ("size", "<i4"), ("points", "<i4")])
_FIRST = np.dtype([("xyz", "<i4", (3,))])
_PAGE = -1  # number of points of an entry that is a page
_DEEPEST = 32


class DamagedIndexError(FormatError):
    """Points lie outside the cubes of their nodes."""


@dataclass(frozen=True, slots=True)
class Index:
    """The nodes of a file: their chunks, which increase, boxes, levels and numbers of points."""

    spacing: float
    chunks: Array
    levels: Array
    low: Floats
    high: Floats
    points: Array

    def chosen(self, selection: Selection, *, boxed: bool) -> tuple[Array, dict[str, int]]:
        """Choose nodes by resolution and, if boxed, by box; count points of others by reason."""
        kept = np.ones(len(self.levels), np.bool_)
        left_out = {}
        for reason, meets in self._conditions(selection, boxed=boxed):
            left_out[reason] = int(self.points[kept & ~meets].sum())
            kept &= meets
        return np.flatnonzero(kept), left_out

    def check(self, chunks: Array, points: Array, counts: Array | int, name: str) -> None:
        """Raise if points of some chunks, so many of each, lie outside the cubes of their nodes."""
        nodes = np.repeat(np.searchsorted(self.chunks, chunks), counts)
        if not ((points >= self.low[nodes]) & (points <= self.high[nodes])).all():
            raise DamagedIndexError(f"{name}: COPC: points lie outside the cubes of their nodes")

    def _conditions(self, selection: Selection, *, boxed: bool) -> list[tuple[str, Array]]:
        conditions: list[tuple[str, Array]] = []
        if selection.copc_resolution is not None:
            level = math.log2(self.spacing) - math.log2(selection.copc_resolution)
            conditions.append(
                ("copc_resolution", np.asarray(self.levels <= max(math.ceil(level - 1e-9), 0)))
            )
        if selection.bounds is not None and boxed:
            box = np.array(selection.bounds).reshape(2, 2)
            conditions.append(("bounds", _meet(self.low[:, :2], self.high[:, :2], *box)))
        if selection.z_range is not None and boxed:
            low, high = (np.array([each]) for each in selection.z_range)
            conditions.append(("z_range", _meet(self.low[:, 2:], self.high[:, 2:], low, high)))
        return conditions


def _meet(low: Floats, high: Floats, wanted_low: Floats, wanted_high: Floats) -> Array:
    return np.asarray(((low <= wanted_high) & (high >= wanted_low)).all(axis=1))


def index_of(stream: BinaryIO, header: LasHeader, chunks: Chunks, name: str) -> Index | None:
    """Read the nodes of a file; the stream goes back to where it was."""
    record = header.record(*_RECORD)
    if record is None:
        return None
    with kept_place(stream):
        return _IndexReading(stream, header, name).index(record, chunks)


class _IndexReading:
    """Reads the record, and the pages that it leads to."""

    def __init__(self, stream: BinaryIO, header: LasHeader, name: str) -> None:
        self._stream, self._header, self._name = stream, header, name

    def index(self, record: bytes, chunks: Chunks) -> Index:
        if len(record) < _INFO.size:
            raise self._error(f"its record has {len(record)} bytes")
        *centre, half, spacing, place, size = _INFO.unpack_from(record)
        is_good = all(map(math.isfinite, (*centre, half, spacing))) and half > 0 and spacing > 0
        if not is_good:
            raise self._error(f"a cube of {2 * half:g} around {centre}, points {spacing:g} apart")
        entries = self._entries(place, size)
        entries = entries[entries["points"] > 0]
        nodes, numbers = self._of_chunks(entries, chunks)
        key = nodes["key"]
        if len(key) and not (key[:, 0].min() >= 0 and key[:, 0].max() <= _DEEPEST):
            raise self._error("a node is of no level from 0 to 32")
        if len(np.unique(key, axis=0)) < len(key):
            raise self._error("two nodes are one")
        side = (2 * half / 2.0 ** key[:, 0])[:, None]
        margin = np.abs(self._header.scales)  # the places of points are rounded
        low = np.array(centre) - half + key[:, 1:] * side
        points = nodes["points"].astype(np.int64)
        index = Index(spacing, numbers, key[:, 0], low - margin, low + side + margin, points)
        index.check(numbers, self._first_points(nodes["place"].tolist()), 1, self._name)
        return index

    def _first_points(self, places: list[int]) -> Floats:
        """Return the first point of each chunk, which stands there as it is."""
        points = bytearray()
        for place in places:
            self._stream.seek(place)
            points += read_exactly(self._stream, _FIRST.itemsize, self._name, "a chunk")
        with np.errstate(over="ignore"):
            return np.frombuffer(points, _FIRST)["xyz"] * self._header.scales + self._header.offsets

    def _entries(self, place: int, size: int) -> Array:
        """Walk over the pages: each once, and all together within the file."""
        pages, parts, total, seen = [(place, size)], [], 0, set()
        while pages:
            place, size = pages.pop()
            total += size
            if place in seen or size % _ENTRY.itemsize or total > self._header.size:
                raise self._error(f"a page of {size:,} bytes at byte {place:,} cannot be one")
            if place > self._header.size:
                raise self._error("an entry leads to a page outside the file")
            seen.add(place)
            self._stream.seek(place)
            data = read_exactly(self._stream, size, self._name, "a page of COPC")
            entries = np.frombuffer(data, _ENTRY)
            is_page = entries["points"] == _PAGE
            more = entries[is_page]
            if (more["size"] <= 0).any():
                raise self._error("an entry leads to a page outside the file")
            pages += zip(more["place"].tolist(), more["size"].tolist(), strict=True)
            parts.append(entries[~is_page])
        return np.concatenate(parts)

    def _of_chunks(self, entries: Array, chunks: Chunks) -> tuple[Array, Array]:
        """Order nodes as the chunks are: each must be one, and each chunk with points a node."""
        table = np.array(chunks.table, np.int64).reshape(-1, 2)
        places = chunks.first + np.cumsum(table[:, 1]) - table[:, 1]
        ordered = entries[np.argsort(entries["place"], kind="stable")]
        filled = np.flatnonzero(table[:, 0])  # some programs end with a chunk of nothing
        same = len(ordered) == len(filled) and (
            np.array_equal(ordered["place"], places[filled].astype(np.uint64))
            and np.array_equal(ordered["size"], table[filled, 1])
            and np.array_equal(ordered["points"], table[filled, 0])
        )
        if not same:
            raise self._error("its nodes are not the chunks of the file")
        return ordered, filled

    def _error(self, cause: str) -> FormatError:
        return FormatError(f"{self._name}: COPC: {cause}")
