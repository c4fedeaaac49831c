"""Families of rasters.

Work grows where blocks are many and small, and memory where they compress to nothing.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import rasterio
from files.geotiff import geotiff
from growth.families import families_in, random
from growth.files.points import Compressed

_WIDTH = 16
_ROW = 24  # bytes of three doubles


def _written(values: Any, **options: Any) -> bytes:
    transform = rasterio.Affine(1, 0, 0, 0, -1, 0)
    made = Compressed(geotiff(values, transform=transform, **options))
    made.content = max(len(made), _ROW * values.size)
    return made


def _heights(n: int, width: int = _WIDTH) -> Any:
    return random().random((max(n, 1), width))


def samples(n: int) -> bytes:
    """The ordinary raster."""
    return bytes(_written(_heights(n)))


def compressed_samples(n: int) -> bytes:
    """The ordinary raster, compressed."""
    return _written(_heights(n), compress="deflate")


def equal_samples(n: int) -> bytes:
    """One height everywhere: what expands the most."""
    return _written(np.zeros((64 * n, _WIDTH)), compress="deflate", nodata=1)


def strips_of_one_row(n: int) -> bytes:
    """Blocks of a row each."""
    return _written(_heights(n, 4), blockysize=1)


def one_long_row(n: int) -> bytes:
    """A raster of one row."""
    return _written(_heights(1, 16 * n))


def grid_of_digits(n: int) -> bytes:
    """An ASCII grid of few bytes each sample."""
    head = b"ncols 16\nnrows %d\nxllcorner 0\nyllcorner 0\ncellsize 1\n" % n
    made = Compressed(head + (b"1 2 " * 8 + b"\n") * n)
    made.content = max(len(made), _ROW * 16 * n)
    return made


RASTER = families_in(globals(), "bytes")
