"""Heightmaps of engines: heights as whole numbers of 16 bits, in PNG or as bare samples (.r16).

The lowest height is 0 and the highest 65,535: height = scale * value + offset. Rows come from the
north, samples of .r16 are little-endian. PNG states scale and offset in its description; a file of
bare samples has no place for them, so a file beside it (.r16.json) has them, the number of rows and
columns, and where the pixels are.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from liftmesh._typing import Array
from liftmesh.base.options import Voids, check_option
from liftmesh.crs.geokeys import ALONE
from liftmesh.errors import InputError, Option
from liftmesh.io.atomic import replacing
from liftmesh.optional import load

if TYPE_CHECKING:
    from liftmesh.raster.pixels import Transform

SUFFIXES = (".png", ".r16")
SIZES = "Unreal takes 127, 253, 505, 1009, 2017, 4033 or 8129, Unity 33, 65 and so on to 4097"
_UNREAL = (127, 253, 505, 1009, 2017, 4033, 8129)
_UNITY = tuple(2**k + 1 for k in range(5, 13))
_TOP = 65535


def is_heightmap(path: Path) -> bool:
    """Whether a file has the suffix of a heightmap."""
    return path.suffix.lower() in SUFFIXES


def suits_engines(size: int) -> bool:
    """Whether engines take a heightmap of so many rows and columns."""
    return size in _UNREAL + _UNITY


def save(
    values: Array, transform: Transform, path: Path, voids: Voids, about: Mapping[str, Any]
) -> tuple[float, float]:
    """Write heights as a heightmap, and what else is known of them; return scale and offset."""
    check_option("voids", voids, Voids)
    samples, scale, offset = _samples(values, voids)
    a, b, _, d, e, _ = transform
    across, down = float(np.hypot(a, d)), float(np.hypot(b, e))
    if path.suffix.lower() == ".r16":
        pixels = {"pixel_size": [across, down], "transform": [*map(float, transform)]}
        _write_bare(path, samples, {"scale": scale, "offset": offset, **pixels, **about})
    else:
        said = f"height = {scale!r} * value + {offset!r}; pixels of {across!r} x {down!r}"
        with replacing(path) as stream:
            _write_png(stream, samples, said)
    return scale, offset


def _write_bare(path: Path, samples: Array, known: Mapping[str, Any]) -> None:
    """Write samples, and beside them what is known of these."""
    rows, columns = samples.shape
    head = {"columns": columns, "rows": rows, "type": "uint16", "byte_order": "little"}
    about = path.with_name(f"{path.name}.json")
    with replacing(about, follow_links=False) as described, replacing(path) as stream:
        described.write(json.dumps({**head, **known}, indent=1).encode() + b"\n")
        stream.write(np.ascontiguousarray(samples, "<u2").data)


def _samples(values: Array, voids: Voids) -> tuple[Array, float, float]:
    """Convert values to 16 bits; return also scale and offset."""
    heights = values.astype(np.float64)
    is_void = np.isnan(heights)
    if is_void.all():
        raise InputError("no pixel has a value: give bounds over the surface")
    low, high = float(np.nanmin(heights)), float(np.nanmax(heights))
    if is_void.any() and voids == "error":
        row, column = (int(each[0]) for each in np.nonzero(is_void))
        raise InputError(
            f"{int(is_void.sum()):,} of {is_void.size:,} pixels have no value, the first in row "
            f"{row}, column {column}, and a heightmap has no mark for that: give bounds inside the "
            f"surface, or {Option('voids', 'lowest')} to fill them with the lowest height"
        )
    with np.errstate(over="ignore"):
        span = high - low if np.isfinite([low, high]).all() else np.inf
    if span == np.inf:
        raise InputError(f"heights from {low} to {high} are beyond what a heightmap can hold")
    if span / _TOP == 0:
        return np.zeros(heights.shape, np.uint16), 1.0, low
    shares = np.where(is_void, 0.0, (heights - low) / span)
    return np.rint(shares * _TOP).astype(np.uint16), span / _TOP, low


def _write_png(stream: BinaryIO, samples: Array, said: str) -> None:
    rasterio = load("rasterio", extra="terrain")
    rows, columns = samples.shape
    profile: dict[str, Any] = {"driver": "PNG", "dtype": "uint16", "count": 1}
    profile |= {"width": columns, "height": rows, "DESCRIPTION": said}
    errors = load("rasterio.errors", extra="terrain")
    with warnings.catch_warnings(), rasterio.Env(**ALONE), rasterio.MemoryFile() as memory:
        warnings.simplefilter("ignore", errors.NotGeoreferencedWarning)
        with memory.open(**profile) as file:
            file.write(samples, 1)
        stream.write(memoryview(memory.getbuffer()))


def square(bounds: Sequence[float], size: int) -> Transform:
    """Return the transform of so many rows and columns over the largest square in the middle."""
    left, low, right, high = bounds
    half = min(right - left, high - low) / 2
    x, y = (left + right) / 2, (low + high) / 2
    return stretched((x - half, y - half, x + half, y + half), size)


def stretched(bounds: Sequence[float], size: int) -> Transform:
    """Return the transform of so many rows and columns over bounds."""
    left, low, right, high = bounds
    return (right - left) / size, 0.0, left, 0.0, (low - high) / size, high
