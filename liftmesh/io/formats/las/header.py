"""What a LAS or LAZ file states of itself, checked against its size before a library believes it.

A header of 227 to 393 bytes gives the number of points, the layout of a point, and where the points
begin; variable length records (VLR) stand between: coordinate system, extra bytes, and what LAZ
needs. A file that lies about their number or lengths lets readers run for hours or ask for all
memory. So all numbers are compared with the bytes that are there, in a walk over the records.

Source: ASPRS, LAS Specification 1.4-R15.

*Variable length records (VLR)* are kept, and there is one of our own: ``metadata["las_records"]``
of a cloud that was read holds the bytes of the header and of the records, before the points and
behind them, so that they can be written again. What would be wrong in a new file is left out of it:
what COPC and waveforms state of their own bytes. It is a note of the reader, which no other format
writes.

The coordinate system is WKT, or the GeoKeys of GeoTIFF. The header says which of the two counts;
the other one is taken where there is none.

What LAS has no place for stands in a record of liftmesh's own: metadata, and how the rest is meant.
The coordinate system stands as WKT, or as the numbers of EPSG where the file that was read had
them. What the cloud itself said, such as ``EPSG:25832``, is noted with a checksum of the WKT, and
holds as long as that is the same: other programs may have changed it.
"""

from __future__ import annotations

import io
import json
import math
import struct
import zlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, BinaryIO

from liftmesh.base.cloud import Cloud, is_crs
from liftmesh.crs.geokeys import KEYS, OF_KEYS, crs_of_geokeys, has_parameters, wkt_of
from liftmesh.errors import FormatError
from liftmesh.io import metadata
from liftmesh.io.markup import parsed_or_none
from liftmesh.io.metadata import Provenance
from liftmesh.io.streams import kept_place, read_exactly, read_most, remaining

_HEADER = struct.Struct("<4s H H 16s B B 32s 32s H H H I I B H I 5I 6d 6d")  # of every version
_OF_1_4 = struct.Struct("<Q I Q")  # of the extended records and the points
_PLACE_OF_WAVES, _PLACE_OF_1_4 = 227, 235
SIZES = {0: 227, 1: 227, 2: 227, 3: 235, 4: 375, 5: 393}  # by minor version
POINT_SIZES = (20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67)
RECORD = struct.Struct("<H16sHH32s")
LONG_RECORD = struct.Struct("<H16sHQ32s")
_PACKED = 0b1100_0000  # bits of the point format that LAZ sets
ENCODING_WKT = 1 << 4
PACKING = (b"laszip encoded", 22204)  # the record of LAZ
_MOST_GAP = 1 << 10
_MOST_EXTENDED = 1 << 26  # bytes of extended records
_INDEXES = ((b"LASF_Spec", 65535), (b"copc", 1000))  # waveforms, and where points are in COPC


@dataclass(frozen=True, slots=True)
class Record:
    """A variable length record: whose it is, its number, and its content."""

    user: bytes
    number: int
    data: bytes
    head: bytes = b""  # its first bytes as they are: 60 of extended records, 54 of others
    left_out: bool = False  # whether the content was not read

    @property
    def extended(self) -> bool:
        """Whether the record stands behind the points."""
        return len(self.head) == LONG_RECORD.size


@dataclass(frozen=True, slots=True)
class LasHeader:
    """What a header states; ``header`` are its bytes, ``gap`` those between records and points."""

    version: tuple[int, int]
    point_format: int
    point_size: int  # bytes
    points: int
    start: int  # first byte of the points
    size: int  # of the file
    compressed: bool
    wkt: bool  # whether the coordinate system is WKT
    end: int  # where records or waveforms begin behind the points, else the size
    scales: tuple[float, ...]
    offsets: tuple[float, ...]
    records: tuple[Record, ...]
    header: bytes = b""
    gap: bytes = b""

    def record(self, user: bytes, number: int) -> bytes | None:
        """Return the content of the first record of a user with a number."""
        contents = (
            each.data for each in self.records if (each.user, each.number) == (user, number)
        )
        return next(contents, None)


def read_header(stream: BinaryIO, name: str) -> LasHeader:
    """Read a header and its records, and check them; the stream goes back to where it was."""
    with kept_place(stream):
        return _Reading(stream, remaining(stream), name).all()


class _Reading:
    """Reads a header of a file of ``size`` bytes, which begins where its stream does."""

    def __init__(self, stream: BinaryIO, size: int, name: str) -> None:
        self._stream = stream
        self._size = size
        self._name = name

    def all(self) -> LasHeader:
        head = read_most(self._stream, min(_HEADER.size, self._size))
        if not head.startswith(b"LASF") or len(head) < _HEADER.size:
            raise FormatError(f"{self._name}: not a LAS file: it has no header that begins LASF")
        fields = _HEADER.unpack(head)
        version = self._version(fields[4:6])
        header_size, start, records, kind, point_size, points = fields[10:16]
        self._check_sizes(version, header_size, start, records)
        is_packed = bool(kind & _PACKED)
        kind &= ~_PACKED
        self._check_point(kind, point_size)
        long_start, long_count = 0, 0
        if version[1] >= 4:
            long_start, long_count, points = self._extended(points)
        found = [*self._records(header_size, start, records)]
        found += self._long_records(long_start, long_count)
        scales, offsets = fields[21:24], fields[24:27]
        self._check_steps(scales, offsets)
        if not is_packed:
            self._check_points(start, point_size, points)
        return LasHeader(
            version=version,
            point_format=kind,
            point_size=point_size,
            points=points,
            start=start,
            size=self._size,
            compressed=is_packed,
            wkt=bool(fields[2] & ENCODING_WKT),
            end=self._end(version, start, long_start if long_count else 0),
            scales=scales,
            offsets=offsets,
            records=tuple(found),
            header=self._bytes(0, header_size),
            gap=self._gap(header_size, start, found),
        )

    def _end(self, version: tuple[int, int], start: int, extended: int) -> int:
        """Return the first byte that other things behind the points have."""
        waves = self._bytes(_PLACE_OF_WAVES, 8) if version[1] >= 3 else b""
        places = extended, int.from_bytes(waves, "little")
        return min([self._size, *(each for each in places if start <= each)])

    def _bytes(self, place: int, size: int) -> bytes:
        self._stream.seek(place)
        return read_exactly(self._stream, size, self._name, "the header")

    def _gap(self, place: int, start: int, records: list[Record]) -> bytes:
        """Return the bytes between the records and the points: two in LAS 1.0, most often none."""
        place += sum(len(each.head) + len(each.data) for each in records if not each.extended)
        return self._bytes(place, start - place) if start - place <= _MOST_GAP else b""

    def _version(self, version: tuple[int, int]) -> tuple[int, int]:
        if version[0] != 1 or version[1] not in SIZES:
            raise self._error(24, f"LAS {version[0]}.{version[1]} is unknown: known are 1.0 to 1.5")
        return version

    def _check_sizes(self, version: tuple[int, int], header: int, start: int, count: int) -> None:
        least = SIZES[version[1]]
        if header < least:
            raise self._error(94, f"the header states {header} bytes, and needs {least}")
        if start > self._size:
            raise self._error(
                96,
                f"the points should begin at byte {start:,}, but the file has {self._size:,}: it "
                "is truncated, or its header is wrong",
            )
        if not header <= start:
            raise self._error(
                96, f"the points should begin at byte {start}, outside {header} to {self._size}"
            )
        if count * RECORD.size > start - header:
            raise self._error(
                100,
                f"the header states {count:,} records, but there are only {start - header:,} bytes "
                "before the points",
            )

    def _check_point(self, kind: int, size: int) -> None:
        if kind >= len(POINT_SIZES):
            raise self._error(104, f"point format {kind} is unknown: known are 0 to 10")
        if size < POINT_SIZES[kind]:
            raise self._error(
                105, f"a point has {size} bytes, and format {kind} needs {POINT_SIZES[kind]}"
            )

    def _extended(self, older: int) -> tuple[int, int, int]:
        """Read the numbers of 64 bits, which count where both are there."""
        self._stream.seek(_PLACE_OF_1_4)
        data = read_exactly(self._stream, _OF_1_4.size, self._name, "the header of LAS 1.4")
        start, count, points = _OF_1_4.unpack(data)
        if older and not points:
            raise self._error(247, f"the header states 0 points, and {older:,} at byte 107")
        if count and (start > self._size or count * LONG_RECORD.size > max(self._size - start, 0)):
            raise self._error(
                243,
                f"the header states {count:,} extended records from byte {start} on, but the file "
                f"has {self._size}",
            )
        return start, count, points

    def _records(self, place: int, end: int, count: int) -> Iterator[Record]:
        """Walk over the records before the points, which are read at once."""
        self._stream.seek(place)
        data = io.BytesIO(read_exactly(self._stream, end - place, self._name, "the records"))
        for k in range(count):
            at = place + data.tell()
            head = data.read(RECORD.size).ljust(RECORD.size, b"\0")
            _, user, number, size, _ = RECORD.unpack(head)
            if data.tell() + size > end - place:
                raise self._error(
                    at, f"record {k} states {size:,} bytes, beyond the first point at byte {end}"
                )
            yield Record(user.partition(b"\0")[0], number, data.read(size), head)

    def _long_records(self, place: int, count: int) -> Iterator[Record]:
        """Walk over the extended records; waveforms and very long ones are left out."""
        left = _MOST_EXTENDED
        for k in range(count):
            self._stream.seek(place)
            data = read_exactly(self._stream, LONG_RECORD.size, self._name, "a record")
            _, user, number, size, _ = LONG_RECORD.unpack(data)
            first = place + LONG_RECORD.size
            if size > self._size - first:
                raise self._error(
                    place, f"record {k} states {size:,} bytes, and the file ends after {self._size}"
                )
            user = user.partition(b"\0")[0]
            is_wanted = (user, number) not in _INDEXES and size <= left
            left -= size if is_wanted else 0
            content = read_most(self._stream, size) if is_wanted else b""
            yield Record(user, number, content, data, not is_wanted)
            place = first + size

    def _check_steps(self, scales: tuple[float, ...], offsets: tuple[float, ...]) -> None:
        if not all(math.isfinite(each) for each in (*scales, *offsets)) or 0 in scales:
            raise self._error(
                131, f"the coordinates have the scales {scales} and offsets {offsets}"
            )

    def _check_points(self, start: int, point_size: int, points: int) -> None:
        there = (self._size - start) // point_size
        if points > there:
            raise self._error(
                start,
                f"the header states {points:,} points of {point_size} bytes, but the file holds "
                f"{there:,}: it is truncated, or its header is wrong",
            )

    def _error(self, place: int, cause: str) -> FormatError:
        return FormatError(f"{self._name}: byte {place}: {cause}")


ENTRY = "las_records"
EXTRA_BYTES = (b"LASF_Spec", 4)
_PARTS = ("header", "records", "extended", "gap")
_LEAST, _MOST = 227, 1 << 16  # bytes of a header; fewer than the latter also of a record


def entry_of(header: LasHeader) -> dict[str, bytes]:
    """Return the entry of metadata."""
    kept = [each for each in header.records if _is_kept(each)]
    return {
        "header": header.header,
        "records": b"".join(each.head + each.data for each in kept if not each.extended),
        "extended": b"".join(each.head + each.data for each in kept if each.extended),
        "gap": header.gap,
    }


def _is_kept(record: Record) -> bool:
    return bool(record.head) and not record.left_out and record.user != b"copc"


@dataclass(frozen=True, slots=True)
class Vlrs:
    """The header and the records that a cloud brings along; empty if it brings none."""

    header: bytes = b""
    records: tuple[Record, ...] = ()
    gap: bytes = b""

    @property
    def is_wkt(self) -> bool:
        """Whether the header says that WKT counts."""
        return len(self.header) > 8 and bool(self.header[6] & ENCODING_WKT)

    def of(self, user: bytes, number: int) -> list[Record]:
        """Return the records of a user with a number."""
        return [each for each in self.records if (each.user, each.number) == (user, number)]


def kept_vlrs(metadata: Mapping[str, Any]) -> Vlrs:
    """Take the entry out of the metadata of a cloud; anything else of that name is nothing."""
    entry = Provenance(metadata).las_records
    values = [entry.get(key) for key in _PARTS]
    parts = [each for each in values if isinstance(each, bytes)]
    if len(parts) < len(_PARTS):
        return Vlrs()
    header, records, extended, gap = parts
    if not _LEAST <= len(header) < _MOST or not header.startswith(b"LASF"):
        return Vlrs()
    both = (*_walked(records, RECORD), *_walked(extended, LONG_RECORD))
    return Vlrs(header, both, gap)


def _walked(data: bytes, form: Any) -> Iterator[Record]:
    place = 0
    while place + form.size <= len(data):
        head = data[place : place + form.size]
        _, user, number, size, _ = form.unpack(head)
        content = data[place + form.size : place + form.size + size]
        yield Record(user.partition(b"\0")[0], number, content, head)
        place += form.size + size


def make_record(user: bytes, number: int, data: bytes, description: bytes) -> Record:
    """Make a record: an extended one if it is too long for others."""
    form = RECORD if len(data) < _MOST else LONG_RECORD
    return Record(user, number, data, form.pack(0, user, number, len(data), description))


def replace_records(records: Iterable[Record], new: Record | None, *olds: Record) -> list[Record]:
    """Put a record in the place of the first of some others, or at the end; they are left out."""
    kept: list[Record] = []
    for each in records:
        if not any(each is old for old in olds):
            kept.append(each)
        elif new is not None:
            kept.append(new)
            new = None
    return kept if new is None else [*kept, new]


PROJECTION, LIBLAS = b"LASF_Projection", b"liblas"
WKT = 2112


def crs_of(records: Iterable[Record], *, is_wkt: bool) -> str | None:
    """Return the coordinate system as `Cloud.crs` holds it; None if there is none."""
    contents = _first(records)
    wkt = _text(contents.get((PROJECTION, WKT)))
    if is_wkt and wkt:
        return wkt
    keys, _ = crs_of_geokeys(contents.get((PROJECTION, KEYS)))
    text = keys or wkt or (None if is_wkt else _text(contents.get((LIBLAS, WKT))))
    return text or _made_up(contents, is_wkt=is_wkt)[0]


def refused(records: Iterable[Record], *, is_wkt: bool) -> tuple[str, ...]:
    """Name GeoKeys that contradict themselves or are not understood, unless they do not count."""
    records = [*records]
    contents = _first(records)
    _, cause = crs_of_geokeys(contents.get((PROJECTION, KEYS)))
    if not cause and crs_of(records, is_wkt=is_wkt) is None:
        cause = _made_up(contents, is_wkt=is_wkt)[1]
    return (cause,) if cause and not is_wkt else ()


def _made_up(
    contents: Mapping[tuple[bytes, int], bytes], *, is_wkt: bool
) -> tuple[str | None, str]:
    """Return the system that GeoKeys make up of parameters, or why there is none."""
    records = {key: contents[PROJECTION, key] for key in OF_KEYS if (PROJECTION, key) in contents}
    return wkt_of(records) if not is_wkt and has_parameters(records.get(KEYS)) else (None, "")


def _first(records: Iterable[Record]) -> dict[tuple[bytes, int], bytes]:
    contents: dict[tuple[bytes, int], bytes] = {}
    for each in records:
        contents.setdefault((each.user, each.number), each.data)
    return contents


def _text(data: bytes | None) -> str | None:
    text = (data or b"").decode("utf-8", "replace").strip("\0 \r\n\t").partition("\0")[0]
    return text if is_crs(text) else None


LIFTMESH_VLR = (b"liftmesh", 1)
LAYOUT = "las"  # the entry of metadata that says how a file holds its points
DEPTH = "color_depth"  # of that entry: 8 where all colours of the file are no larger than 255
_DESCRIPTION = b"metadata"
_MOST_JSON = 1 << 19  # characters


def liftmesh_record(cloud: Cloud, crs: str | None, depth: int | None) -> Record | None:
    """Make the record; None if there is nothing to say."""
    statement: dict[str, Any] = {}
    entries = {k: v for k, v in metadata.storable(cloud.metadata).items() if not is_layout(k, v)}
    statement |= {"metadata": entries} if entries else {}
    if cloud.crs is not None and cloud.crs != crs:
        statement["crs"] = [cloud.crs, _checksum(crs)]
    statement |= {} if depth is None else {DEPTH: depth}
    data = json.dumps(statement, sort_keys=True).encode() if statement else b""
    return make_record(*LIFTMESH_VLR, data, _DESCRIPTION) if data else None


def is_layout(key: str, value: object) -> bool:
    """Whether an entry of metadata is what the reader of LAS says of the layout."""
    is_known = key == LAYOUT and isinstance(value, dict)
    return key == ENTRY or (is_known and {"version", "point_format"} <= {*value})  # type: ignore[misc]


class LiftmeshVlr:
    """What the record of a file says; nothing if there is none, or it is not understood."""

    def __init__(self, records: Iterable[Record]) -> None:
        mine = (each.data for each in records if (each.user, each.number) == LIFTMESH_VLR)
        statement = _parsed(next(mine, b""))
        self.metadata: dict[str, Any] = _entries(statement.get("metadata"))
        depth = statement.get(DEPTH)
        self.color_depth = depth if depth in (8, 16) else None
        self._crs = statement.get("crs")

    def crs(self, text: str | None) -> str | None:
        """Return what the cloud said of its coordinate system, if the file still says the same."""
        pair = self._crs if isinstance(self._crs, list) and len(self._crs) == 2 else [None, -1]
        mine = pair[0] if is_crs(pair[0]) and pair[1] == _checksum(text) else text
        return None if mine is None else str(mine)


def _checksum(text: str | None) -> int | None:
    return None if text is None else zlib.crc32(text.encode("utf-8", "replace"))


def _entries(value: object) -> dict[str, Any]:
    text = json.dumps(value) if isinstance(value, dict) else ""
    entries = metadata.parsed(text) or {}
    return {key: each for key, each in entries.items() if key not in (LAYOUT, ENTRY)}


def _parsed(data: bytes) -> dict[str, Any]:
    statement = parsed_or_none(data) if len(data) <= _MOST_JSON else None
    return statement if isinstance(statement, dict) else {}
