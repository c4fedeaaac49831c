"""Rasters: GeoTIFF, made by rasterio, and its bytes; ASCII grids, made of their words."""

from __future__ import annotations

import numpy as np
import rasterio
from files.geotiff import geotiff as made
from fuzz.structure.case import Case, Points, in_order, told
from fuzz.structure.parts import Chance, Part
from fuzz.structure.text import line

GRID_WORDS = [b"ncols", b"nrows", b"xllcenter", b"yllcenter", b"dx", b"dy", b"NODATA_value", b"nan"]
EXPANDED = 4 << 20
"""What a compressed raster may expand to in these files, whose sizes are lies: up to the limit, of
256 MiB, a reader believes them."""

_FORMS = ("<H", "<I", "<Q", "<d")


def _heights(chance: Chance) -> Points:
    shape = chance.randint(1, 6), chance.randint(1, 6)
    values = [chance.randint(-200, 200) / 4 for _ in range(shape[0] * shape[1])]
    return np.array(values).reshape(shape)


def _points(heights: Points) -> Points:
    """The centres of pixels of size 1, the last row at y = 0.5."""
    rows, columns = np.indices(heights.shape)
    y = len(heights) - rows - 0.5
    return np.column_stack([columns.ravel() + 0.5, y.ravel(), heights.ravel()])


def geotiff(chance: Chance) -> Case:
    """Make a GeoTIFF file; in three of four some numbers are others, or the end is missing."""
    heights = _heights(chance)
    data = _written(heights, chance)
    if chance.one_in(4):
        return Case("tif", data, in_order(_points(heights)))
    damaged = bytearray(data)
    for _ in range(chance.randint(1, 4)):
        form = chance.choice(_FORMS)
        value = chance.whole() if form != "<d" else chance.real()
        part = Part(value, form).encode()
        place = chance.randrange(len(damaged) - len(part))
        damaged[place : place + len(part)] = part
    end = chance.randrange(len(damaged)) if chance.one_in(6) else len(damaged)
    return Case("tif", bytes(damaged[:end]), content=EXPANDED)


def _written(heights: Points, chance: Chance) -> bytes:
    options = chance.choice(({}, {"compress": "deflate"}, {"compress": "lzw"}, {"nodata": -9999}))
    transform = rasterio.Affine(1, 0, 0, 0, -1, len(heights))
    kind = chance.choice(("float32", "float64"))
    return made(heights.astype(kind), transform=transform, **options)


def grid(chance: Chance) -> Case:
    """Make an ASCII grid."""
    heights = _heights(chance)
    parts = [*line("ncols", heights.shape[1]), *line("nrows", heights.shape[0])]
    parts += [*line("xllcorner", 0), *line("yllcorner", 0), *line("cellsize", 1)]
    for row in heights.tolist():
        parts += line(*row)
    return told("raster", parts, GRID_WORDS, _points(heights), chance)
