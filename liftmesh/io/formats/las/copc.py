"""COPC: LAZ whose chunks are the nodes of an octree, so that a box or a resolution reads a part.

A record tells the cube of the octree, the distance between the points of its root, and where the
pages are that list the nodes. Each level halves the distance. A node must be a chunk of the table
that LAZ has anyway, with the same place, length and number of points: that table is checked
already (`laz`), so no page can make anyone read anything else. The first point of each
chunk, which is not compressed, and all points that are decoded must lie in the cubes of their
nodes: else the index is not used.

Source: COPC 1.0, copc.io.
"""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.errors import FormatError
from liftmesh.io.streams import read_exactly

if TYPE_CHECKING:
    from liftmesh.io.formats.las.header import LasHeader
    from liftmesh.io.formats.las.laz import Chunks
    from liftmesh.io.selection import Selection

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
    begin = stream.tell()
    try:
        return _Reading(stream, begin, header, name).index(record, chunks)
    finally:
        stream.seek(begin)


class _Reading:
    """Reads the record, and the pages that it leads to."""

    def __init__(self, stream: BinaryIO, begin: int, header: LasHeader, name: str) -> None:
        self._stream, self._begin, self._header, self._name = stream, begin, header, name

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
            self._stream.seek(self._begin + place)
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
            self._stream.seek(self._begin + place)
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
