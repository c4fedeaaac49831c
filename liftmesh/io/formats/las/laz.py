"""What the compression of a LAZ file states, checked before lazrs allocates memory for it.

The points are compressed in chunks, most often of 50,000. A record of LAZ gives the number of
points in a chunk and the items of a point; a table at the end gives the chunks, and its place
stands before the first of them. In formats 6 to 10 each chunk begins with its first point as it is
and the sizes of its layers. All of these are compared with the bytes that are there.

lazrs tells errors of a stream as damage of its own, and states places from the beginning of a file:
so it reads from an `ErrorRecordingStream`, and from an `OffsetStream` if that begins later.

Source: M. Isenburg, LASzip: lossless compression of lidar data, 2013, and its source code.
"""

from __future__ import annotations

import io
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, BinaryIO

from liftmesh.errors import FormatError
from liftmesh.io.formats.las.header import PACKING
from liftmesh.io.streams import read_exactly
from liftmesh.optional import load

if TYPE_CHECKING:
    from liftmesh.io.formats.las.header import LasHeader


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
    begin = stream.tell()
    try:
        return _Reading(stream, begin, header, name).chunks()
    finally:
        stream.seek(begin)


class _Reading:
    """Reads the record of LAZ, the table of chunks, and the beginning of each chunk."""

    def __init__(self, stream: BinaryIO, begin: int, header: LasHeader, name: str) -> None:
        self._stream = stream
        self._begin = begin
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
        self._stream.seek(self._begin + self._header.start)
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
        self._stream.seek(self._begin + max(place, 0))
        return form.unpack(read_exactly(self._stream, form.size, self._name, what))

    def _error(self, cause: str) -> FormatError:
        return FormatError(f"{self._name}: LAZ: {cause}")


class ErrorRecordingStream:
    """A stream that is read, and the first error of reading it."""

    def __init__(self, stream: BinaryIO) -> None:
        self._stream = stream
        self.failure: OSError | None = None
        if hasattr(stream, "readinto"):  # which laspy asks for, as it spares a copy
            self.readinto = self._readinto

    def seek(self, place: int, whence: int = io.SEEK_SET) -> int:
        """Go to a place."""
        with self._remembered():
            return self._stream.seek(place, whence)

    def tell(self) -> int:
        """Return the place."""
        with self._remembered():
            return self._stream.tell()

    def read(self, size: int = -1) -> bytes:
        """Read bytes."""
        with self._remembered():
            return self._stream.read(size)

    def _readinto(self, memory: Any) -> int:
        with self._remembered():
            count: int = self._stream.readinto(memory)  # type: ignore[attr-defined]
            return count

    @contextmanager
    def _remembered(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            self.failure = self.failure or error
            raise


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
