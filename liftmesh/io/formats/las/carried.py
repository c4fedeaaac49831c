"""What a LAS file says besides its points, kept as it is so that it can be written again.

``metadata["las_records"]`` of a cloud that was read holds the bytes of the header and of the
records, before the points and behind them. What would be wrong in a new file is left out of it:
what COPC and waveforms state of their own bytes. It is a note of the reader, which no other format
writes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from liftmesh.io.formats.las.header import ENCODING_WKT, LONG_RECORD, RECORD, LasHeader, Record

ENTRY = "las_records"
EXTRA_BYTES = (b"LASF_Spec", 4)
_PARTS = ("header", "records", "extended", "gap")
_LEAST, _MOST = 227, 1 << 16  # bytes of a header; fewer than the latter also of a record


def entry(stated: LasHeader) -> dict[str, bytes]:
    """Return the entry of metadata."""
    kept = [each for each in stated.records if _is_kept(each)]
    return {
        "header": stated.header,
        "records": b"".join(each.head + each.data for each in kept if not each.extended),
        "extended": b"".join(each.head + each.data for each in kept if each.extended),
        "gap": stated.gap,
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


def carried(metadata: Mapping[str, Any]) -> Vlrs:
    """Take the entry out of the metadata of a cloud; anything else of that name is nothing."""
    found = metadata.get(ENTRY)
    values = [found.get(key) for key in _PARTS] if isinstance(found, Mapping) else []
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


def made(user: bytes, number: int, data: bytes, description: bytes) -> Record:
    """Make a record: an extended one if it is too long for others."""
    form = RECORD if len(data) < _MOST else LONG_RECORD
    return Record(user, number, data, form.pack(0, user, number, len(data), description))


def replaced(records: Iterable[Record], new: Record | None, *olds: Record) -> list[Record]:
    """Put a record in the place of the first of some others, or at the end; they are left out."""
    found: list[Record] = []
    for each in records:
        if not any(each is old for old in olds):
            found.append(each)
        elif new is not None:
            found.append(new)
            new = None
    return found if new is None else [*found, new]
