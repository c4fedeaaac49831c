"""The points of a LAS or LAZ file as laspy and lazrs decode them, in blocks of bounded size.

laspy knows the layouts of points and their extra bytes, lazrs the compression. Both are given files
whose header is checked (`io.formats.las.header`); what they raise besides becomes a `FormatError`,
and what they would log is ours to say.

LAZ is decoded on all threads of lazrs, but on one in a process that was forked: threads do not
survive that, and lazrs would wait for its own for ever.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import accumulate
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from liftmesh._typing import Array
from liftmesh.errors import FormatError, LiftmeshError
from liftmesh.io.columns import POSITION
from liftmesh.io.formats.las.copc import Index, index_of
from liftmesh.io.formats.las.header import PACKING
from liftmesh.io.formats.las.laz import LARGEST_CHUNK, Chunks, ErrorRecordingStream, chunks_of
from liftmesh.io.streams import read_exactly
from liftmesh.optional import load

if TYPE_CHECKING:
    from liftmesh.io.formats.las.header import LasHeader


_STORED = ("X", "Y", "Z")
WAVE_PACKETS = (
    "wavepacket_index", "wavepacket_offset", "wavepacket_size", "return_point_wave_location",
    "x_t", "y_t", "z_t",
)  # fmt: skip

BLOCK = 1 << 18  # points decoded at a time

_forked: list[bool] = []
os.register_at_fork(after_in_child=lambda: _forked.append(True))


class Points:
    """The points of an open file."""

    def __init__(self, stream: BinaryIO, header: LasHeader, name: str) -> None:
        self._name = name
        self._header = header
        chunks = chunks_of(stream, header, name) if header.compressed and header.points else None
        self._stream, self._begin, self._chunks = stream, stream.tell(), chunks
        self.surplus = "" if chunks is None else chunks.surplus
        # Nodes are decoded on the threads of lazrs, which do not survive a fork.
        is_indexed = chunks is not None and may_use_threads() and chunks.largest <= LARGEST_CHUNK
        self.index: Index | None = None
        self.damage: FormatError | None = None  # of the index, which points do not need
        try:
            self.index = index_of(stream, header, chunks, name) if chunks and is_indexed else None
        except FormatError as error:
            self.damage = error
        self._source = ErrorRecordingStream(stream)
        laspy = load("laspy", extra="las")
        with self._decoding("the header"):
            self._reader = laspy.LasReader(
                self._source, closefd=False, laz_backend=_backend(laspy, chunks), read_evlrs=False
            )
        self.dimensions: list[Any] = list(self._reader.header.point_format.dimensions)
        if empty := next((each for each in self.dimensions if not each.num_bits), None):
            raise FormatError(f"{name}: the extra bytes {empty.name!r} have 0 bytes: it is damaged")

    def blocks(self, size: int = BLOCK) -> Iterator[Any]:
        """Decode the points: records of laspy, of at most ``size`` points each."""
        done = 0
        while done < self._header.points:
            wanted = min(size, self._header.points - done)
            with self._decoding(f"points from {done:,} on"):
                record = self._reader.read_points(wanted)
            if len(record) != wanted:
                raise FormatError(
                    f"{self._name}: the file ends after {done + len(record):,} of "
                    f"{self._header.points:,} points: it is truncated"
                )
            done += wanted
            yield record

    def blocks_of(self, nodes: Sequence[int]) -> Iterator[Any]:
        """Decode some chunks of a COPC file: records of laspy, of chunks of `BLOCK` points."""
        table, first = (self._chunks.table, self._chunks.first) if self._chunks else ((), 0)
        places = list(accumulate((size for _, size in table), initial=first))
        for group in _grouped(nodes, [points for points, _ in table]):
            data = b"".join(self._bytes(places[k], table[k][1]) for k in group)
            with self._decoding(f"chunks from {group[0]:,} on"):
                record = self._decoded(data, [table[k] for k in group])
            if self.index is not None:
                counts = np.array([table[k][0] for k in group])
                self.index.check(np.array(group), _places(record), counts, self._name)
            yield record

    def _bytes(self, place: int, size: int) -> bytes:
        """Read a chunk; the stream goes back to where `blocks` goes on."""
        begin = self._stream.tell()
        try:
            self._stream.seek(self._begin + place)
            return read_exactly(self._stream, size, self._name, "a chunk")
        finally:
            self._stream.seek(begin)

    def _decoded(self, data: bytes, table: list[tuple[int, int]]) -> Any:
        laspy, lazrs = load("laspy", extra="las"), load("lazrs", extra="las")
        header = self._reader.header
        found = bytearray(sum(points for points, _ in table) * self._header.point_size)
        lazrs.decompress_points_with_chunk_table(data, self._header.record(*PACKING), found, table)
        array = np.frombuffer(found, header.point_format.dtype())
        return laspy.ScaleAwarePointRecord(
            array, header.point_format, header.scales, header.offsets
        )

    @contextmanager
    def _decoding(self, what: str) -> Iterator[None]:
        """Turn whatever the libraries raise of a file into one error; they log nothing."""
        try:
            with _silenced("laspy"):
                yield
        except (LiftmeshError, OSError, MemoryError):
            raise
        except Exception as error:
            raise self._error(what, error) from error
        except BaseException as error:  # a panic of Rust
            if type(error).__name__ != "PanicException":
                raise
            raise self._error(what, error) from error

    def _error(self, what: str, error: BaseException) -> Exception:
        if self._source.failure is not None:
            return self._source.failure
        cause = " ".join(str(error).split())[:200]
        return FormatError(
            f"{self._name}: {what} cannot be decoded: the file is damaged "
            f"({type(error).__name__}: {cause})"
        )


def _places(record: Any) -> Array:
    """Return the coordinates of a record of laspy."""
    numbers = np.column_stack([record.array[each] for each in ("X", "Y", "Z")])
    with np.errstate(over="ignore"):
        return np.asarray(numbers * record.scales + record.offsets)


def _grouped(nodes: Sequence[int], points: Sequence[int]) -> Iterator[list[int]]:
    """Yield nodes in groups of about `BLOCK` points."""
    group: list[int] = []
    count = 0
    for each in nodes:
        group.append(each)
        count += points[each]
        if count >= BLOCK:
            yield group
            group, count = [], 0
    if group:
        yield group


def may_use_threads() -> bool:
    """Whether lazrs may use its threads: not after a fork, which they do not survive."""
    return not _forked


def _backend(laspy: Any, chunks: Chunks | None) -> Any:
    """Choose how LAZ is decoded: on many threads where each chunk can be found, and is small."""
    if chunks is None:
        return ()
    load("lazrs", extra="las")
    is_parallel = may_use_threads() and chunks.listed and chunks.largest <= LARGEST_CHUNK
    return laspy.LazBackend.LazrsParallel if is_parallel else laspy.LazBackend.Lazrs


@contextmanager
def _silenced(library: str) -> Iterator[None]:
    """Keep a library from logging where nobody listens: Python would print it."""
    logger, handler = logging.getLogger(library), logging.NullHandler()
    logger.addHandler(handler)
    try:
        yield
    finally:
        logger.removeHandler(handler)


class Block(Mapping[str, Array]):
    """Points of a file: each column is computed when it is asked for."""

    def __init__(self, record: Any, names: Sequence[str]) -> None:
        self._record = record
        self._names = names

    def __getitem__(self, name: str) -> Array:
        """Return a column: coordinates from their whole numbers, scales and offsets."""
        if name in POSITION:
            k = POSITION.index(name)
            with np.errstate(over="ignore", invalid="ignore"):
                values: Array = self._record.array[_STORED[k]] * self._record.scales[k]
                values += self._record.offsets[k]
            return values
        return np.asarray(self._record[name])

    def __contains__(self, name: object) -> bool:
        """Whether there is such a column."""
        return name in self._names

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    @property
    def rows(self) -> int:
        """The number of points."""
        return len(self._record.array)

    def taken(self, rows: Array) -> Block:
        """Return some of the points."""
        record = self._record
        array = record.array
        # As items of bytes: NumPy would copy structured ones value by value.
        taken = array.view(f"V{array.itemsize}").take(rows).view(array.dtype)
        part = type(record)(taken, record.point_format, record.scales, record.offsets)
        return Block(part, self._names)


def types_of(dimensions: Sequence[Any]) -> tuple[dict[str, np.dtype], tuple[str, ...]]:
    """Return the columns of a cloud with their types, and the extra bytes that cannot be one."""
    double = np.dtype(np.float64)
    types: dict[str, np.dtype] = dict.fromkeys(POSITION, double)
    refused = []
    for each in dimensions:
        if each.name in _STORED:
            continue
        if each.name in POSITION or not each.name:
            refused.append(f"extra bytes {each.name!r} (the name of a coordinate, or none)")
            continue
        if each.name in types:
            refused.append(f"extra bytes {each.name!r} (the name of another value)")
            continue
        kind = np.dtype(np.uint8) if each.dtype is None else each.dtype
        kind = double if each.is_scaled else kind.base
        types[each.name] = np.dtype((kind, (each.num_elements,))) if _is_vector(each) else kind
    return types, tuple(refused)


def _is_vector(dimension: Any) -> bool:
    return dimension.dtype is not None and dimension.num_elements > 1
