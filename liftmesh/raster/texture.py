"""Orthophotos as textures: a GeoTIFF as PNG, and where its pixels are on the map.

As of rasters of heights, GDAL sees the file in memory, with the driver of its format alone. What a
viewer cannot show as it is, such as other types of numbers, is refused with what makes it so.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.options import refused
from liftmesh.crs.comparison import are_different
from liftmesh.crs.geokeys import READING, without_wkt
from liftmesh.errors import FormatError, InputError, Option
from liftmesh.io.options import check_expanded, limit_of
from liftmesh.io.streams import at_home
from liftmesh.optional import load
from liftmesh.raster.blocks import bytes_decoded, check_blocks, warnings_as_errors, window_of
from liftmesh.raster.pixels import Affine
from liftmesh.raster.reader import decoding

_WIDEST = 16384  # of textures, in most graphics processors
_DENSEST = 200  # bytes in memory that a byte of a compressed image is allowed
_TIFF = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")


@dataclass(frozen=True, slots=True)
class Texture:
    """An image as PNG, and the transform from its columns and rows to the map."""

    png: bytes
    width: int
    height: int
    place: Affine

    def positions(self, points: Floats) -> Floats:
        """Compute the shares of width and height, from the upper left, at which points lie."""
        a, b, c, d, e, f = self.place
        x, y = points[:, 0] - c, points[:, 1] - f
        determinant = a * e - b * d
        columns, rows = (e * x - b * y) / determinant, (a * y - d * x) / determinant
        return np.column_stack([columns / self.width, rows / self.height])

    def count_outside(self, positions: Floats) -> int:
        """Count the points beyond the image by more than a pixel."""
        margin = 1 / np.array([self.width, self.height])
        return int(((positions < -margin) | (positions > 1 + margin)).any(axis=1).sum())


def read_texture(path: Any, crs: str | None) -> Texture:
    """Read a GeoTIFF for a mesh in a coordinate system."""
    if not isinstance(path, str | os.PathLike):
        raise refused("texture", path, "give the path of a GeoTIFF")
    name = str(at_home(path))
    data = Path(name).read_bytes()
    if data[:4] not in _TIFF:
        raise FormatError(f"{name}: not a TIFF file: a texture is a GeoTIFF, as an orthophoto")
    rasterio = load("rasterio", extra="terrain")
    with (
        decoding(name),
        rasterio.Env(**READING),
        rasterio.MemoryFile(without_wkt(data), ext=".tif") as memory,
        memory.open(driver="GTiff") as file,
    ):
        _check(file, name, crs)
        return _texture(file, name, data)


def _check(file: Any, name: str, crs: str | None) -> None:
    """Raise for an image that cannot be shown as it is, or is somewhere else."""
    kinds = sorted(set(file.dtypes))
    if kinds != ["uint8"] or file.count not in (1, 3, 4):
        raise FormatError(
            f"{name}: {file.count} bands of {', '.join(kinds)}: a texture has 1, 3 or 4 of uint8: "
            "convert it (gdal_translate -b 1 -b 2 -b 3 -ot Byte -scale)"
        )
    if file.colorinterp[0].name == "palette":
        raise FormatError(f"{name}: its colours are a palette: gdal_translate -expand rgb")
    place = Affine(*[*file.transform][:6])
    if place.is_identity or not place.a * place.e - place.b * place.d:
        raise FormatError(f"{name}: it does not say where its pixels are: gdal_translate -a_ullr")
    if max(file.width, file.height) > _WIDEST:
        raise FormatError(
            f"{name}: {file.width:,} x {file.height:,} pixels: textures have at most {_WIDEST:,} "
            "on a side: gdal_translate -outsize"
        )
    system = None if file.crs is None else file.crs.to_wkt()
    if are_different(crs, system):
        raise InputError(
            f"{name} is in another coordinate system than the mesh: warp it first (gdalwarp "
            f"-t_srs), or read the points with {Option('dst_crs', ...)}"
        )


def _texture(file: Any, name: str, data: bytes) -> Texture:
    place = Affine(*[*file.transform][:6])
    whole = window_of(place, file.width, file.height, None)
    needed = sum(bytes_decoded(file, band, whole) for band in file.indexes)
    what = f"an image of {file.width:,} x {file.height:,} pixels"
    check_expanded(needed, limit_of(None, _DENSEST * len(data)), name, what)
    for band in file.indexes:
        check_blocks(file, band, whole, data, name)
    with warnings_as_errors(name):
        image, mask = file.read(), file.dataset_mask()
    if file.count < 4 and (missing := int(np.count_nonzero(mask == 0))):
        raise FormatError(
            f"{name}: {missing:,} pixels have no value, which a texture cannot say: fill them "
            "(gdal_fillnodata.py), or cut the image (gdalwarp -te)"
        )
    return Texture(_png(image), file.width, file.height, place)


def _png(image: Array) -> bytes:
    rasterio = load("rasterio", extra="terrain")
    bands, rows, columns = image.shape
    profile = {"driver": "PNG", "dtype": "uint8", "count": bands, "width": columns, "height": rows}
    with rasterio.MemoryFile() as memory:
        with memory.open(**profile) as file:
            file.write(image)
        return bytes(memory.getbuffer())
