"""The variable length records (VLR) of a LAS file: those that are kept, and our own.

``metadata["las_records"]`` of a cloud that was read holds the bytes of the header and of the
records, before the points and behind them, so that they can be written again. What would be wrong
in a new file is left out of it: what COPC and waveforms state of their own bytes. It is a note of
the reader, which no other format writes.

The coordinate system is WKT, or the GeoKeys of GeoTIFF. The header says which of the two counts;
the other one is taken where there is none.

What LAS has no place for stands in a record of liftmesh's own: metadata, and how the rest is meant.
The coordinate system stands as WKT, or as the numbers of EPSG where the file that was read had
them. What the cloud itself said, such as ``EPSG:25832``, is noted with a checksum of the WKT, and
holds as long as that is the same: other programs may have changed it.

Source: ASPRS, LAS Specification 1.4-R15, section 3.
"""

from __future__ import annotations

import json
import zlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from liftmesh.base.cloud import is_crs
from liftmesh.crs.geokeys import KEYS, OF_KEYS, crs_of_geokeys, has_parameters, wkt_of
from liftmesh.io import metadata
from liftmesh.io.formats.las.header import ENCODING_WKT, LONG_RECORD, RECORD, LasHeader, Record
from liftmesh.io.markup import parsed_or_none
from liftmesh.io.metadata import Provenance

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud


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
