"""The blocks of a raster that are read, and whether they hold all of their samples.

Every k-th sample of both directions is read, in the window of a box. Where the axes of the raster
are those of the plane, the box ends at exact columns and rows, found by bisection of the centres of
pixels; of rotated rasters the window surrounds the box. Samples are decoded in pieces, so that
blocks between them, if they are worth it, are not decoded at all.

Where a strip or tile ends early, GDAL gives what its memory held before, and no error, if the block
is not compressed, or by deflate. So the sizes of blocks are compared with what they need, and those
that are deflated are inflated once more, to count their bytes. Other compressions raise errors, or,
as JPEG, tell the log alone that they go on with other samples: while blocks are decoded, that is an
error, too.
"""

from __future__ import annotations

import logging
import math
import re
import threading
import zlib
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager
from itertools import product
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from liftmesh.errors import FormatError

if TYPE_CHECKING:
    from liftmesh.io.selection import Selection
    from liftmesh.raster.pixels import Affine

_PIECE = 1 << 20  # bytes inflated at a time
_OF_TAGS = re.compile(r"TIFF\w*(Directory|Tag)\b")
_LOGS = ("rasterio._err", "rasterio._env")  # of what GDAL says, by the version of rasterio
_BLOCK = 1 << 20  # samples decoded at a time
_CALL = 1 << 14  # samples whose decoding takes as long as a call


class Window(NamedTuple):
    """Rows and columns that are read, and the number of samples left out, by reason."""

    rows: range
    columns: range
    outside: int
    between: int

    @property
    def samples(self) -> int:
        """The number of samples that are read."""
        return len(self.rows) * len(self.columns)


def window_of(transform: Affine, width: int, height: int, selection: Selection | None) -> Window:
    """Find the samples to read."""
    step = 1 if selection is None else selection.every
    rows, columns = range(height), range(width)
    if selection is not None and selection.bounds is not None:
        rows, columns = _in_box(transform, rows, columns, selection.bounds)
    inside = len(rows) * len(columns)
    rows, columns = _stepping(rows, step), _stepping(columns, step)
    between = inside - len(rows) * len(columns)
    return Window(rows, columns, width * height - inside, between)


def _in_box(
    place: Affine, rows: range, columns: range, box: tuple[float, float, float, float]
) -> tuple[range, range]:
    if place.b == place.d == 0 and place.a and place.e:
        columns = _between(columns, lambda k: place.a * (k + 0.5) + place.c, box[0], box[2])
        rows = _between(rows, lambda k: place.e * (k + 0.5) + place.f, box[1], box[3])
        return rows, columns
    determinant = place.a * place.e - place.b * place.d
    corners = [(x - place.c, y - place.f) for x in box[::2] for y in box[1::2]]
    if not determinant or not all(map(math.isfinite, (determinant, *box))):
        return rows, columns
    across = [(place.e * x - place.b * y) / determinant for x, y in corners]
    down = [(place.a * y - place.d * x) / determinant for x, y in corners]
    return _around(rows, down), _around(columns, across)


def _between(all_of: range, center: Callable[[int], float], low: float, high: float) -> range:
    """Bisect for the centres from low to high, which increase or decrease."""
    if center(0) > center(len(all_of)):
        first = bisect_left(all_of, -high, key=lambda k: -center(k))
        return all_of[first : bisect_right(all_of, -low, key=lambda k: -center(k))]
    return all_of[bisect_left(all_of, low, key=center) : bisect_right(all_of, high, key=center)]


def _around(all_of: range, places: list[float]) -> range:
    """Take what lies between the places, and two more on either side, for rounding."""
    low, high = (min(max(each, -4), len(all_of) + 4) for each in (min(places), max(places)))
    return all_of[max(math.floor(low) - 2, 0) : max(math.ceil(high) + 2, 0)]


def _stepping(some: range, step: int) -> range:
    return range(some.start + -some.start % step, some.stop, step)


class Band(NamedTuple):
    """Consecutive rows of a window, and the rows and columns of it that are decoded at once."""

    rows: range
    down: list[range]
    across: list[range]


def bands_of(window: Window, block: tuple[int, int]) -> Iterator[Band]:
    """Split a window into bands of at most about a million samples."""
    pieces = _columns_of(window.columns, block)
    width = max((each[-1] + 1 - each.start for each in pieces), default=1)
    apart = _pays(window.rows.step, block[0], width)
    taken = 1 if apart else window.rows.step
    count = max(_BLOCK // max(taken * width, len(window.columns)), 1)
    for first in range(0, len(window.rows), count):
        rows = window.rows[first : first + count]
        yield Band(rows, [rows[k : k + 1] for k in range(len(rows))] if apart else [rows], pieces)


def _columns_of(columns: range, block: tuple[int, int]) -> list[range]:
    """Split columns where blocks between them are left out, and where they are very many."""
    apart = _pays(columns.step, block[1], block[0])
    count = 1 if apart else max(_BLOCK // columns.step, 1)
    return [columns[first : first + count] for first in range(0, len(columns), count)]


def _pays(step: int, size: int, across: int) -> bool:
    """Whether not decoding what lies between two samples is worth a call for each."""
    return (step - size) * across > _CALL


def bytes_decoded(file: Any, band: int, window: Window) -> int:
    """Return the bytes of all blocks that are decoded: of all bands, if they stand together."""
    height, width = file.block_shapes[band - 1]
    each = height * width * np.dtype(file.dtypes[band - 1]).itemsize
    blocks = _count(window.rows, height) * _count(window.columns, width)
    return int(each * blocks * (file.count if _is_together(file) else 1))


def _is_together(file: Any) -> bool:
    """Whether a block has the samples of all bands."""
    return str(getattr(file.interleaving, "value", "")).lower() == "pixel"


def _touched(some: range, size: int) -> Iterable[int]:
    """Return the numbers of the blocks that hold some rows or columns."""
    if some.step >= size:
        return (each // size for each in some)
    return range(some.start // size, -(-some.stop // size)) if some else ()


def _count(some: range, size: int) -> int:
    return sum(1 for _ in _touched(some, size))


def check_blocks(file: Any, band: int, window: Window, data: bytes, name: str) -> None:
    """Raise for a block that is read, and ends early."""
    packing = "" if file.compression is None else str(file.compression.value).upper()
    if file.driver != "GTiff" or packing not in ("", "NONE", "DEFLATE"):
        return
    height, width = file.block_shapes[band - 1]
    row = _row_bytes(file, band)
    for down, across in product(_touched(window.rows, height), _touched(window.columns, width)):
        size, offset = (
            file.get_tag_item(f"BLOCK_{key}_{across}_{down}", "TIFF", bidx=band)
            for key in ("SIZE", "OFFSET")
        )
        first = down * height
        needed = min(height, file.height - first) * row
        if size is None or offset is None:  # a block of nothing but nodata
            continue
        held = min(int(size), max(len(data) - int(offset), 0))
        if packing == "DEFLATE":
            held = _inflated(data[int(offset) : int(offset) + held], needed)
        if held < needed:
            raise FormatError(
                f"{name}: the block at row {first:,}, column {across * width:,} has "
                f"{held:,} bytes, and needs {needed:,}: the file is damaged"
            )


def _row_bytes(file: Any, band: int) -> int:
    """Return the bytes of a row of a block: of all bands, if they stand together."""
    bits = file.tags(ns="IMAGE_STRUCTURE", bidx=band).get("NBITS", "")
    each = int(bits) if bits.isdecimal() else 8 * np.dtype(file.dtypes[band - 1]).itemsize
    samples = file.block_shapes[band - 1][1] * (file.count if _is_together(file) else 1)
    return int(-(-samples * each // 8))


def _inflated(packed: bytes, most: int) -> int:
    """Count the bytes that a block expands to, up to as many as are needed."""
    inflate, count = zlib.decompressobj(), 0
    try:
        while count < most and not inflate.eof:
            piece = inflate.decompress(packed, min(_PIECE, most - count))
            packed = inflate.unconsumed_tail
            count += len(piece)
            if not piece:
                break
    except zlib.error:
        return 0
    return count


@contextmanager
def warnings_as_errors(name: str) -> Iterator[None]:
    """Raise for what GDAL warns of while it decodes samples."""
    logged = _LoggedWarnings()
    with ExitStack() as held:
        for log in map(logging.getLogger, _LOGS):
            held.callback(log.setLevel, log.level)
            held.callback(log.removeHandler, logged)
            log.setLevel(logging.WARNING)
            log.addHandler(logged)
            if not log.isEnabledFor(logging.WARNING):
                raise FormatError(f"{name}: damage would go unheard: undo logging.disable()")
        yield
    if logged.heard:
        raise FormatError(f"{name}: the file is damaged: {logged.heard[0][:200]}")


class _LoggedWarnings(logging.Handler):
    """What the log hears of this thread."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self._thread = threading.get_ident()
        self.heard: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        """Keep a message, unless it is of tags: those are read late, and odd ones do no harm."""
        if record.thread == self._thread and not _OF_TAGS.search(text := record.getMessage()):
            self.heard.append(text)
