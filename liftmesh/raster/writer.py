"""GeoTIFF from arrays; rasterio encodes it.

A file of an array is made in memory and handed to the stream whole, so that nothing but the file
itself is opened on the disk, and GDAL leaves no files beside it. What need not fit in memory is
written in windows, to a file in a folder of its own.
"""

from __future__ import annotations

import errno
import math
import os
import shutil
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO
from zlib import crc32

import numpy as np

from liftmesh._typing import Array
from liftmesh.base.options import refused, shown
from liftmesh.crs.description import without_files
from liftmesh.crs.geokeys import ALONE
from liftmesh.errors import InputError
from liftmesh.io.atomic import check_writable, replacing, working_folder
from liftmesh.optional import load

_COMPRESSIONS = (None, "deflate", "lzw", "zstd")
_TILE = 256
_PIECE = 1 << 24


def write(
    stream: BinaryIO,
    values: Array,
    transform: Sequence[float],
    crs: str | None,  # the unit of its heights, if any, is that of the band to GDAL
    *,
    unit: str | None = None,
    cog: bool = False,
    compress: str | None = "deflate",
) -> None:
    """Write one band, with NaN as nodata."""
    system = validate_geotiff_options(crs, compress)
    rasterio = load("rasterio", extra="terrain")
    driver = _cog(compress) if cog else _tiff(compress, values.nbytes)
    profile = _profile(values.shape, values.dtype, transform, system) | driver
    with rasterio.Env(**ALONE), rasterio.MemoryFile() as memory:
        with memory.open(**profile) as file:
            file.write(values, 1)
            _state_unit(file, unit)
        data = memoryview(memory.getbuffer())
        stream.writelines(data[start : start + _PIECE] for start in range(0, len(data), _PIECE))


def write_windows(  # noqa: PLR0913 - options are keywords
    path: Path,
    shape: tuple[int, int],
    kind: np.dtype[Any],
    windows: Iterable[tuple[tuple[range, range], Array]],  # of rows and columns, all pixels once
    transform: Sequence[float],
    crs: str | None,
    *,
    unit: str | None = None,
    cog: bool = False,
    compress: str | None = "deflate",
) -> None:
    """Write one band from windows, which need not fit in memory together; NaN is nodata."""
    system = validate_geotiff_options(crs, compress)
    rasterio = load("rasterio", extra="terrain")
    check_writable(path)
    size = math.prod(shape) * kind.itemsize
    profile = _profile(shape, kind, transform, system) | _tiff(compress, size)
    beside = Path(os.path.realpath(path)).parent
    with working_folder(beside, "raster") as folder:
        written = folder / "raster.tif"
        with rasterio.Env(**ALONE), _disk_errors(path):
            sums = []
            with rasterio.open(written, "w", **profile) as file:
                _state_unit(file, unit)
                for (down, across), values in windows:
                    window = (down.start, down.stop), (across.start, across.stop)
                    file.write(values, 1, window=window)
                    sums.append((window, crc32(np.ascontiguousarray(values).data)))
            if cog:
                written = _optimised(written, size, compress)
            _check(written, sums)
        with written.open("rb") as source, replacing(path) as stream:
            shutil.copyfileobj(source, stream, _PIECE)


def validate_geotiff_options(crs: str | None, compress: str | None) -> Any:
    """Check what a file is asked to have, before there are values."""
    if compress not in _COMPRESSIONS:
        known = ", ".join(map(repr, _COMPRESSIONS))
        raise refused("compress", compress, f"give one of {known}")
    if crs is None:
        return None
    rasterio = load("rasterio", extra="terrain")
    errors = load("rasterio.errors", extra="terrain")
    unknown = InputError(f"the coordinate system {shown(crs)} is unknown: give WKT or EPSG:n")
    text = without_files(crs)
    if text is None:
        raise unknown
    try:
        with rasterio.Env(**ALONE):  # or GDAL prints what it raises
            return rasterio.crs.CRS.from_user_input(text)
    except (errors.CRSError, UnicodeError) as error:
        raise unknown from error


def _profile(
    shape: tuple[int, ...], kind: np.dtype[Any], transform: Sequence[float], system: Any
) -> dict[str, Any]:
    """Return what rasterio is told of a raster of one band, in which NaN is nodata."""
    rows, columns = shape
    place = load("rasterio", extra="terrain").Affine(*transform)
    size = {"width": columns, "height": rows, "count": 1, "dtype": kind.name}
    return {**size, "transform": place, "crs": system, "nodata": np.nan}


def _tiff(compress: str | None, size: int) -> dict[str, Any]:
    options: dict[str, Any] = {"driver": "GTiff", "BIGTIFF": "YES" if size >> 31 else "NO"}
    if compress is None:
        return options
    tiles = {"tiled": True, "blockxsize": _TILE, "blockysize": _TILE}
    return {**options, **tiles, "compress": compress, "predictor": 3}


def _cog(compress: str | None) -> dict[str, Any]:
    options = {"driver": "COG", "compress": compress or "none", "resampling": "nearest"}
    return options if compress is None else {**options, "predictor": "FLOATING_POINT"}


def _state_unit(file: Any, unit: str | None) -> None:
    if unit is not None:
        file.set_band_unit(1, unit)


def _optimised(path: Path, size: int, compress: str | None) -> Path:
    """Copy a file as a cloud optimised one, beside it."""
    copied = path.with_name("optimised.tif")
    options = {**_cog(compress), "BIGTIFF": "YES"} if size >> 31 else _cog(compress)
    load("rasterio.shutil", extra="terrain").copy(path, copied, **options)
    path.unlink()
    return copied


@contextmanager
def _disk_errors(path: Path) -> Iterator[None]:
    """Raise what GDAL says of a file as an error of the disk."""
    errors = load("rasterio.errors", extra="terrain")
    base = load("rasterio._err", extra="terrain").CPLE_BaseError

    try:
        yield
    except (errors.RasterioError, base, SystemError) as error:
        message = "the raster could not be written whole; is the disk full?"
        raise OSError(errno.EIO, message, str(path)) from error


def _check(path: Path, sums: Sequence[tuple[Any, int]]) -> None:
    """Read what was written: what fails as GDAL closes a file is told to nobody."""
    rasterio = load("rasterio", extra="terrain")
    with rasterio.open(path) as file:
        for window, expected in sums:
            if crc32(file.read(1, window=window)) != expected:
                raise rasterio.errors.RasterioIOError(f"{path} holds other values")
