"""Whether the blocks of a GeoTIFF file hold all their samples.

Where a strip or tile ends early, GDAL gives what its memory held before, and no error, if the block
is not compressed, or by deflate. So the sizes of blocks are compared with what they need, and those
that are deflated are inflated once more, to count their bytes. Other compressions raise errors, or,
as JPEG, tell the log alone that they go on with other samples: while blocks are decoded, that is an
error, too.
"""

from __future__ import annotations

import logging
import re
import threading
import zlib
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh.errors import FormatError

if TYPE_CHECKING:
    from liftmesh.raster.window import Window

_PIECE = 1 << 20  # bytes inflated at a time
_OF_TAGS = re.compile(r"TIFF\w*(Directory|Tag)\b")
_LOGS = ("rasterio._err", "rasterio._env")  # of what GDAL says, by the version of rasterio


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


@contextmanager
def without_warnings(name: str) -> Iterator[None]:
    """Raise for what GDAL warns of while it decodes samples."""
    said = _Said()
    with ExitStack() as held:
        for log in map(logging.getLogger, _LOGS):
            held.callback(log.setLevel, log.level)
            held.callback(log.removeHandler, said)
            log.setLevel(logging.WARNING)
            log.addHandler(said)
            if not log.isEnabledFor(logging.WARNING):
                raise FormatError(f"{name}: damage would go unheard: undo logging.disable()")
        yield
    if said.heard:
        raise FormatError(f"{name}: the file is damaged: {said.heard[0][:200]}")


class _Said(logging.Handler):
    """What the log hears of this thread."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self._thread = threading.get_ident()
        self.heard: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        """Keep a message, unless it is of tags: those are read late, and odd ones do no harm."""
        if record.thread == self._thread and not _OF_TAGS.search(text := record.getMessage()):
            self.heard.append(text)


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
