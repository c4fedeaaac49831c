"""Clouds as LAS and LAZ files.

A cloud that was read from such a file becomes the same again: every whole number, every bit of a
point, the header and the records; with other classes, say, nothing but the classes is another. Of
LAZ the compressed bytes may differ, if it had chunks of other sizes, or from another compressor.
Points are filled in and compressed in blocks; memory beyond the arrays is that of a block. Bytes
are a function of the cloud: a new file has no date. A cloud may come in chunks, of which the first
decides the layout.
"""

from __future__ import annotations

import struct
from collections.abc import Collection, Iterable, Iterator, Mapping
from itertools import chain
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from liftmesh._typing import Array
from liftmesh.base.colors import as_float
from liftmesh.base.interruption import preserve_signals
from liftmesh.errors import FormatError
from liftmesh.io.formats.las.fields import depth_of, levels
from liftmesh.io.formats.las.header import (
    ENCODING_WKT,
    PACKING,
    SIZES,
    Record,
    make_record,
    replace_records,
)
from liftmesh.io.formats.las.layout import Layout, layout_of
from liftmesh.io.formats.las.laz import ErrorRecordingStream, OffsetStream
from liftmesh.io.formats.las.reader import BLOCK, may_use_threads
from liftmesh.io.metadata import Provenance
from liftmesh.optional import load

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_NAMES = ("X", "Y", "Z")
_PACKED = 128
_LAYERED = 6  # the first point format of LAS 1.4
_CONFUSED = (9, 10)
_INTERNAL_WAVES = 1 << 1  # of the global encoding
_LAST_BITS = "last bits of coordinates, whose decimals are the same"
_LEGACY_RETURNS, _RETURNS = 5, 15


def write_las(
    stream: BinaryIO,
    cloud: Cloud,
    *,
    compressed: bool = False,
    scale: float | None = None,
    point_format: int | None = None,
) -> None:
    """Write a cloud as LAS, or LAZ."""
    write_las_chunks(stream, [cloud], compressed=compressed, scale=scale, point_format=point_format)


def write_las_chunks(
    stream: BinaryIO,
    chunks: Iterable[Cloud],
    *,
    compressed: bool = False,
    scale: float | None = None,
    point_format: int | None = None,
) -> None:
    """Write the chunks of a cloud, of which there is at least one, as LAS, or LAZ."""
    later = iter(chunks)
    cloud = next(later)
    layout = layout_of(cloud, scale, point_format)
    if compressed and layout.point_format in _CONFUSED and _has_waves(cloud):
        raise FormatError(
            f"wave packets of point format {layout.point_format} cannot be compressed: write .las"
        )
    lazrs = load("lazrs", extra="las") if compressed else None
    vlr = None if lazrs is None else _packing(lazrs, layout)
    before = _packed([each for each in layout.records if not each.extended], vlr)
    after = [each for each in layout.records if each.extended]
    head = _Header(layout, is_packed=compressed)
    begin = stream.tell()
    stream.write(bytes(head.data))
    stream.writelines(each.head + each.data for each in before)
    stream.write(layout.gap)
    start = stream.tell() - begin
    blocks = chain(_blocks(cloud, layout, head), _later_blocks(later, layout, head))
    if lazrs is None:
        stream.writelines(blocks)
    else:
        _compress(blocks, lazrs, vlr, OffsetStream(stream, begin))
    end = stream.tell()
    stream.writelines(each.head + each.data for each in after)
    last = stream.tell()
    head.finish(start, len(before), end - begin, len(after))
    stream.seek(begin)
    stream.write(bytes(head.data))
    stream.seek(last)


def dropped_parts(cloud: Cloud, options: Mapping[str, Any]) -> Collection[str]:
    """Return what is not kept of a cloud: values without a place, bits of coordinates, colours."""
    layout = layout_of(cloud, options.get("scale"), options.get("point_format"))
    parts = [*layout.fields.lost]
    if not all(each.near for each in layout.steps):
        parts.append("float64")
    elif not all(each.exact for each in layout.steps):
        parts.append(_LAST_BITS)
    if "copc" in Provenance(cloud.metadata).las:
        parts.append("the index of COPC")
    colors = cloud.colors
    if colors is not None and not _is_16_bits(colors[:, :3], depth_of(cloud)):
        parts.append("deep_colors")
    return parts


def check(cloud: Cloud) -> None:
    """Raise if a value does not fit."""
    layout_of(cloud, None, None)


def _is_16_bits(colors: Array, depth: int | None) -> bool:
    if colors.dtype.itemsize <= 2 and colors.dtype.kind == "u":
        return True
    again = levels(colors, depth) / np.float64(65535.0)
    if colors.dtype.kind == "f":
        again = again.astype(colors.dtype).astype(np.float64)
    return np.array_equal(again, as_float(colors))


def _has_waves(cloud: Cloud) -> bool:
    values = cloud.attributes.get("wavepacket_index")
    return values is not None and bool(values.any())


def _packed(records: list[Record], vlr: Any) -> list[Record]:
    """Put the record of LAZ in its place, as it was if it says the same."""
    before = [each for each in records if (each.user, each.number) == PACKING]
    if vlr is None:
        return replace_records(records, None, *before)
    data = bytes(vlr.record_data())
    if before and _packing_of(before[0].data) == _packing_of(data):
        return records
    return replace_records(records, make_record(*PACKING, data, b"lazrs"), *before)


def _packing_of(data: bytes) -> tuple[bytes, ...]:
    """Return compressor, coder, points of a chunk and items; the rest is by whom, and for where."""
    return data[:4], data[12:16], data[32:]


def _packing(lazrs: Any, layout: Layout) -> Any:
    extra = sum(each.kind.itemsize for each in layout.fields.extras)
    return lazrs.LazVlr.new_for_compression(layout.point_format, extra)


def _compress(blocks: Iterable[memoryview], lazrs: Any, vlr: Any, stream: OffsetStream) -> None:
    """Compress blocks; what a stream raises is raised as it is, and not as an error of lazrs."""
    target = ErrorRecordingStream(stream)  # type: ignore[arg-type]  # with all that lazrs asks for
    kind = lazrs.ParLasZipCompressor if may_use_threads() else lazrs.LasZipCompressor
    try:
        with preserve_signals():
            compressor = kind(target, vlr)
            for block in blocks:
                compressor.compress_many(block)
            compressor.done()
    except Exception as error:
        if target.failure is not None and target.failure is not error:
            raise target.failure from error
        raise


def _blocks(cloud: Cloud, layout: Layout, head: _Header) -> Iterator[memoryview]:
    """Yield the bytes of the points, which the header counts."""
    head.count(cloud)
    for start in range(0, len(cloud), BLOCK):
        rows = slice(start, min(start + BLOCK, len(cloud)))
        points = np.zeros(rows.stop - start, layout.fields.kind)
        for name, steps, values in zip(_NAMES, layout.steps, cloud.points[rows].T, strict=True):
            points[name] = steps.numbers(values.astype(np.float64, copy=False))
        layout.fields.fill(points, rows)
        yield points.view(np.uint8).data


def _later_blocks(chunks: Iterator[Cloud], first: Layout, head: _Header) -> Iterator[memoryview]:
    """Yield the bytes of the chunks after the first."""
    for number, cloud in enumerate(chunks, 1):
        steps = [(each.scale, each.offset) for each in first.steps]
        layout = layout_of(cloud, None, first.point_format)
        if layout.fields.kind != first.fields.kind or steps != [
            (each.scale, each.offset) for each in layout.steps
        ]:
            raise FormatError(
                f"chunk {number} has other values, or coordinates of other steps, than chunk 0: "
                "write the cloud as a whole"
            )
        yield from _blocks(cloud, layout, head)


class _Header:
    """The header of a file: that of the file that was read, with what the points decide."""

    def __init__(self, layout: Layout, *, is_packed: bool) -> None:
        size = max(SIZES[layout.version[1]], len(layout.header))
        self.data = bytearray((layout.header or _new()).ljust(size, b"\0"))
        self._version, self._before = layout.version, layout.header
        self._set("<2B", 24, *layout.version)
        encoding = int.from_bytes(self.data[6:8], "little") & ~(ENCODING_WKT | _INTERNAL_WAVES)
        self._set("<H", 6, encoding | (ENCODING_WKT if layout.is_wkt else 0))
        number = layout.point_format | (_PACKED if is_packed else 0)
        self._set("<BH", 104, number, layout.fields.kind.itemsize)
        self._set("<6d", 131, *(s.scale for s in layout.steps), *(s.offset for s in layout.steps))
        self._layout, self._points, self._returns = layout, 0, np.zeros(_RETURNS, np.int64)
        self._ends = np.full((2, 3), [[-np.inf], [np.inf]])  # the greatest coordinates, the least

    def count(self, cloud: Cloud) -> None:
        """Take note of points, and of what the header says of them."""
        if len(cloud):
            self._points += len(cloud)
            self._returns += _returns(cloud)
            self._ends[0] = np.maximum(self._ends[0], cloud.points.max(axis=0))
            self._ends[1] = np.minimum(self._ends[1], cloud.points.min(axis=0))

    def finish(self, start: int, records: int, end: int, extended: int) -> None:
        """Set what all points decide, and where points and extended records begin."""
        self._set_counts()
        self._set_bounds()
        self._set("<HII", 94, len(self.data), start, records)
        if self._version[1] >= 4:
            self._set("<QI", 235, end if extended else 0, extended)

    def _set(self, form: str, place: int, *values: float) -> None:
        struct.pack_into(form, self.data, place, *values)

    def _set_counts(self) -> None:
        counted, older, before = _counts_of(self._before)
        is_same = counted == self._points
        is_uncounted = is_same and not any(before)
        returns = [0] * _RETURNS if is_uncounted else self._returns.tolist()
        fits = self._points < 1 << 32
        # Some programs count points in the older field in all formats.
        is_older = self._layout.point_format < _LAYERED or any(older[:1])
        is_left_out = is_same and counted > 0 and self._version[1] >= 4 and not any(older)
        is_older &= fits and not is_left_out
        older = [self._points, *returns[:_LEGACY_RETURNS]] if is_older else [0] * 6
        if self._version[1] < 4 and not fits:
            raise FormatError(f"{self._points:,} points are too many for LAS 1.{self._version[1]}")
        self._set("<6I", 107, *older)
        if self._version[1] >= 3:
            self._set("<Q", 227, 0)
        if self._version[1] >= 4:
            self._set("<16Q", 247, self._points, *returns)

    def _set_bounds(self) -> None:
        """Set the box; that of the file before is kept where it is the same within a step."""
        ends = self._ends.T if self._points else np.zeros((3, 2))
        for k, steps in enumerate(self._layout.steps):
            bounds = steps.coordinates(steps.numbers(ends[k]))
            place = 179 + 16 * k
            before = struct.unpack_from("<2d", self.data, place)
            if not self._before or not (np.abs(bounds - before) < abs(steps.scale)).all():
                self._set("<2d", place, *bounds)


def _counts_of(header: bytes) -> tuple[int, list[int], list[int]]:
    """Return what a header counts: points, all in its older fields, and points by return."""
    if not header:
        return -1, [], [1]
    older = [*struct.unpack_from("<6I", header, 107)]
    if header[25] < 4 or len(header) < SIZES[4]:
        return older[0], older, older[1:]
    count, *returns = struct.unpack_from("<16Q", header, 247)
    return count, older, [*returns, *older[1:]]


def _returns(cloud: Cloud) -> Array:
    """Count the points of the 1st to 15th return."""
    values = cloud.attributes.get("return_number", np.zeros(0, np.int64))
    return np.bincount(values.astype(np.int64), minlength=_RETURNS + 1)[1 : _RETURNS + 1]


def _new() -> bytes:
    """Begin a header: by whom, without version and date."""
    return struct.pack("<4s54x32s6x", b"LASF", b"liftmesh")
