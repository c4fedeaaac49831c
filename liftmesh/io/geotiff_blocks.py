"""Whether the blocks of a GeoTIFF file hold all their samples.

Where a strip or tile ends early, GDAL gives what its memory held before, and no error, if the block
is not compressed, or by deflate. So the sizes of blocks are compared with what they need, and those
that are deflated are inflated once more, to count their bytes. Other compressions raise errors.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterable
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh.errors import FormatError

if TYPE_CHECKING:
    from liftmesh.io.raster_window import Window

_PIECE = 1 << 20  # bytes inflated at a time


def check_blocks(file: Any, band: int, window: Window, data: bytes, name: str) -> None:
    """Raise for a block that is read, and ends early.

    Parameters
    ----------
    file : rasterio dataset
        The raster.
    band : int
        The band that is read, from 1.
    window : Window
        What is read of it.
    data : bytes
        The whole file.
    name : str
        The file for messages.

    Raises
    ------
    FormatError
        A block is damaged; the message gives its row and column.
    """
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


def bytes_of_a_block(file: Any, band: int) -> int:
    """Return the bytes in memory of a block: of all bands, if they stand together.

    Parameters
    ----------
    file : rasterio dataset
        The raster.
    band : int
        The band that is read, from 1.

    Returns
    -------
    int
        What GDAL decodes at a time.
    """
    height, width = file.block_shapes[band - 1]
    each = np.dtype(file.dtypes[band - 1]).itemsize
    return int(height * width * each * (file.count if _is_together(file) else 1))


def _is_together(file: Any) -> bool:
    """Whether a block has the samples of all bands."""
    return str(getattr(file.interleaving, "value", "")).lower() == "pixel"


def _touched(some: range, size: int) -> Iterable[int]:
    """Return the numbers of the blocks that hold some rows or columns."""
    if some.step >= size:
        return (each // size for each in some)
    return range(some.start // size, -(-some.stop // size)) if some else ()


def _row_bytes(file: Any, band: int) -> int:
    """Return the bytes of a row of a block: of all bands, if they stand together.

    Samples may have fewer bits than their type (NBITS): 12, or 16 of a float.
    """
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
