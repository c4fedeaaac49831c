"""LAS and LAZ files as clouds: coordinates, colours, and every other value of a point by its name.

The file holds whole numbers, scales and offsets; coordinates are ``number * scale + offset`` in
double precision, as in every other program. Scales and offsets stay in ``metadata["las"]``: with
them the whole numbers can be had again from the coordinates. Values of bits (return number, flags)
become bytes, extra bytes keep their types, scaled ones become doubles. Names are those of laspy.

Points are decoded in blocks, straight into the arrays of the cloud; rows that are not selected are
left out at once. Memory beyond the arrays is that of a block.

The points come as laspy and lazrs decode them, in blocks of bounded size. laspy knows the layouts
of points and their extra bytes, lazrs the compression. Both are given files whose header is checked
(`header.py`); what they raise besides becomes a `FormatError`, and what they would log is ours to
say. LAZ is decoded on all threads of lazrs, but on one in a process that was forked: threads do not
survive that, and lazrs would wait for its own for ever.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import accumulate
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, BinaryIO, cast

import numpy as np

from liftmesh._typing import Array
from liftmesh.base.platform import after_fork
from liftmesh.errors import FormatError, LiftmeshError
from liftmesh.io.columns import COLOR, POSITION, CloudBuilder, built_in_chunks
from liftmesh.io.formats.las.header import (
    DEPTH,
    PACKING,
    LasHeader,
    LiftmeshVlr,
    crs_of,
    entry_of,
    read_header,
    refused,
)
from liftmesh.io.formats.las.laz import (
    LARGEST_CHUNK,
    Chunks,
    DamagedIndexError,
    ErrorRecordingStream,
    Index,
    OffsetStream,
    chunks_of,
    index_of,
)
from liftmesh.io.metadata import noted
from liftmesh.io.options import check_columns, check_expanded, limit_of
from liftmesh.io.selection import Selection, Selector
from liftmesh.io.streams import kept_place, read_exactly
from liftmesh.optional import load

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

DENSEST = 200  # bytes in memory that a byte of LAZ is allowed
_KNOWN = (b"LASF_Spec", b"copc")  # records of waveforms, and of the places of points
_WAVES = (4, 5, 9, 10)  # point formats that refer to waveforms
_MOST_EXACT = 2**53  # steps of a scaled value that doubles hold
_SHALLOW = 8  # bits of colours that stand in 16
_CONFUSED = (9, 10)  # whose wave packets lazrs 0.8 confuses if points have several channels


def read_las(
    stream: BinaryIO,
    name: str,
    *,
    max_bytes: int | None = None,
    selection: Selection | None = None,
) -> Cloud:
    """Read a LAS or LAZ file."""
    file = _File(stream, name, max_bytes)
    if selection is not None:
        return _selected(file, selection, name)
    builder, filled = CloudBuilder(file.types, file.points), 0
    for block in file.blocks(BLOCK):
        builder.fill(slice(filled, filled + block.rows), block)
        filled += block.rows
    return file.cloud(builder)


def _selected(file: _File, selection: Selection, name: str) -> Cloud:
    """Read the rows that are selected, of COPC the nodes that may have any."""
    try:
        cloud, has_ground = _part(file, selection, name, boxed=True)
    except DamagedIndexError as damage:
        if file.index is None:
            raise
        file.index, file.damage = None, damage
        return _selected(file, selection, name)
    is_part = file.index is not None and not (
        selection.bounds is None and selection.z_range is None
    )
    if selection.classes == "ground" and is_part and not has_ground:
        return _part(file, selection, name, boxed=False)[0]  # is there any beyond the box?
    return cloud


def _part(file: _File, selection: Selection, name: str, *, boxed: bool) -> tuple[Cloud, bool]:
    """Read rows, of COPC some nodes; all that are read decide how many bits colours have."""
    if selection.copc_resolution is not None and file.damage is not None:
        raise file.damage
    selector = Selector(selection, name, has_levels=file.index is not None)
    blocks, points = file.blocks(BLOCK), file.points
    if file.index is not None:
        nodes, left_out = file.index.chosen(selection, boxed=boxed)
        blocks = file.blocks_of(file.index.chunks[nodes].tolist())
        points = int(file.index.points[nodes].sum())
        selector.leave_out(left_out)
    builder, filled, brightest = CloudBuilder(file.types, points), 0, 0
    for block in blocks:
        brightest = max(brightest, *(int(block[each].max()) for each in COLOR if each in block), 0)
        rows, is_first = selector.rows(block.rows, block)
        filled = 0 if is_first else filled
        builder.fill(slice(filled, filled + len(rows)), block.taken(rows))
        filled += len(rows)
    builder.shorten(filled)
    depth = 16 if brightest > 255 else None
    counts = selector.counts()
    return file.cloud(builder, depth, counts), bool(counts.get("ground"))


def read_las_chunks(
    stream: BinaryIO, name: str, rows: int, *, max_bytes: int | None = None
) -> Iterator[Cloud]:
    """Read a LAS or LAZ file in chunks; see `liftmesh.read_chunks`."""
    file = _File(stream, name, max_bytes)
    for builder in built_in_chunks(file.types, file.points, file.blocks(min(rows, BLOCK)), rows):
        yield file.cloud(builder)


class _File:
    """An open file whose header is checked."""

    def __init__(self, stream: BinaryIO, name: str, max_bytes: int | None) -> None:
        if begin := stream.tell():
            stream = cast("BinaryIO", OffsetStream(stream, begin))
        self._header = read_header(stream, name)
        self.points = self._header.points
        source = Points(stream, self._header, name)
        self._source, self.index, self.damage = source, source.index, source.damage
        self.types, self._refused = types_of(source.dimensions)
        if self._header.compressed and self._header.point_format in _CONFUSED:
            self.types = {k: v for k, v in self.types.items() if k not in WAVE_PACKETS}
            self._refused += ("wave packets (compressed in formats 9 and 10)",)
        self._wide = [each.name for each in source.dimensions if _is_wide(each)]
        self._rounded: dict[str, None] = {}
        columns = sum(kind.itemsize // kind.base.itemsize for kind in self.types.values())
        check_columns(columns, max_bytes, name, f"a point of {columns:,} values")
        each = sum(kind.itemsize for kind in self.types.values())
        limit = limit_of(max_bytes, DENSEST * self._header.size)
        check_expanded(each * self.points, limit, name, f"{self.points:,} points")

    def blocks(self, size: int) -> Iterator[Block]:
        """Decode all points, in blocks of at most some."""
        return self._of_records(self._source.blocks(size))

    def blocks_of(self, nodes: list[int]) -> Iterator[Block]:
        """Decode the points of some nodes of COPC."""
        return self._of_records(self._source.blocks_of(nodes))

    def _of_records(self, records: Iterator[Any]) -> Iterator[Block]:
        for record in records:
            self._look_for_rounded(record)
            yield Block(record, tuple(self.types))

    def _look_for_rounded(self, record: Any) -> None:
        """Note the scaled values of which doubles do not hold all digits."""
        for name in self._wide:
            numbers = record.array[name]
            if len(numbers) and max(int(numbers.max()), -int(numbers.min())) > _MOST_EXACT:
                self._rounded[name] = None

    def cloud(
        self,
        builder: CloudBuilder,
        depth: int | None = None,
        selection: Mapping[str, int] = MappingProxyType({}),
    ) -> Cloud:
        """Make a cloud of filled arrays, with what the file says of all its points."""
        header = self._header
        layout: dict[str, Any] = {
            "version": f"{header.version[0]}.{header.version[1]}",
            "point_format": header.point_format,
            "scale": list(header.scales),
            "offset": list(header.offsets),
        }
        if self.index is not None:
            levels = self.index.levels
            layout["copc"] = {
                "spacing": self.index.spacing,
                "levels": int(levels.max()) + 1 if len(levels) else 0,
            }
        own_vlr = LiftmeshVlr(header.records)
        entries = noted({**own_vlr.metadata, "las": layout}, las_records=entry_of(header))
        entries = noted(entries, selection=selection, not_read=self._skipped())
        crs = own_vlr.crs(crs_of(header.records, is_wkt=header.wkt))
        cloud = builder.cloud(metadata=entries, crs=crs, color_depth=own_vlr.color_depth or depth)
        if cloud.color_depth == _SHALLOW:  # which surfaces and other formats do not keep
            layout[DEPTH] = _SHALLOW
        return cloud

    def _skipped(self) -> tuple[str, ...]:
        header = self._header
        waves = ("waveforms",) if header.point_format in _WAVES else ()
        end = header.start + header.points * header.point_size
        is_more = not header.compressed and header.end - end >= header.point_size
        rest = (f"{header.end - end:,} bytes after the last point",) if is_more else ()
        rest = (self._source.surplus,) if self._source.surplus else rest
        long = sum(each.left_out and each.user not in _KNOWN for each in header.records)
        records = (f"{long:,} very long records",) if long else ()
        index = () if self.damage is None else ("the index of COPC (damaged)",)
        keys = refused(header.records, is_wkt=header.wkt)
        low = (f"low digits of {each} (beyond 2**53 steps)" for each in self._rounded)
        return (*self._refused, *waves, *rest, *records, *index, *keys, *low)


def _is_wide(dimension: Any) -> bool:
    """Whether values are whole numbers of 64 bits with a scale."""
    kind = dimension.dtype
    return bool(dimension.is_scaled and kind is not None and kind.base.str[1:] in ("u8", "i8"))


_STORED = ("X", "Y", "Z")
WAVE_PACKETS = (
    "wavepacket_index", "wavepacket_offset", "wavepacket_size", "return_point_wave_location",
    "x_t", "y_t", "z_t",
)  # fmt: skip

BLOCK = 1 << 18  # points decoded at a time

_forked: list[bool] = []
after_fork(lambda: _forked.append(True))


class Points:
    """The points of an open file."""

    def __init__(self, stream: BinaryIO, header: LasHeader, name: str) -> None:
        self._name = name
        self._header = header
        chunks = chunks_of(stream, header, name) if header.compressed and header.points else None
        self._stream, self._chunks = stream, chunks
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
        with kept_place(self._stream):
            self._stream.seek(place)
            return read_exactly(self._stream, size, self._name, "a chunk")

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
