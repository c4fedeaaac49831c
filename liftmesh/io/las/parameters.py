"""GeoKeys that make up a projected system of parameters: GDAL turns them into WKT.

It reads such keys from GeoTIFF, where they come from: they are put into a file of one pixel, in
memory.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping

from liftmesh.cloud import is_crs
from liftmesh.errors import MissingDependencyError
from liftmesh.io.geotiff_citations import without_wkt
from liftmesh.optional import load

_SHORT, _ASCII, _LONG, _DOUBLE = 3, 2, 4, 12
_SIZES = {_SHORT: 2, _ASCII: 1, _LONG: 4, _DOUBLE: 8}
_DOUBLES = 34736
_KINDS = {34735: _SHORT, _DOUBLES: _DOUBLE, 34737: _ASCII}  # keys, their doubles and their text
_PIXEL = {256: 1, 257: 1, 258: 8, 259: 1, 262: 1, 273: 8, 277: 1, 278: 1, 279: 1}
_PLACE = {33550: (2, 2, 0), 33922: (0, 0, 0, 0, 0, 0)}  # or rasterio warns that there is none
_MOST = 1 << 16  # bytes of a record


def wkt_of(records: Mapping[int, bytes]) -> tuple[str | None, str]:
    """Return the system that is made up of parameters."""
    if not records.get(_DOUBLES):
        return None, "GeoKeys (a system made up of parameters, which are missing)"
    try:
        rasterio = load("rasterio", extra="terrain")
        errors = load("rasterio.errors", extra="terrain")
        inner = load("rasterio._err", extra="terrain")
    except MissingDependencyError as error:
        return None, f"GeoKeys (a system made up of parameters: {error})"
    options = {"GTIFF_REPORT_COMPD_CS": "YES", "GDAL_DISABLE_READDIR_ON_OPEN": "EMPTY_DIR"}
    data = without_wkt(_tiff({number: each[:_MOST] for number, each in records.items()}))
    try:
        with (
            rasterio.Env(**options, GDAL_PAM_ENABLED="NO", CPL_DEBUG="OFF"),
            rasterio.MemoryFile(data, ext=".tif") as memory,
            memory.open(driver="GTiff") as file,
        ):
            text = None if file.crs is None else file.crs.to_wkt()
    except (errors.RasterioError, errors.CRSError, inner.CPLE_BaseError, UnicodeError):
        text = None
    if text is None or not is_crs(text) or text.startswith(("LOCAL_CS", "ENGCRS")):
        return None, "GeoKeys (a system made up of parameters that GDAL does not know)"
    return text, ""


def _tiff(records: Mapping[int, bytes]) -> bytes:
    """Write a TIFF file of one pixel with these tags."""
    values = {number: (_LONG, struct.pack("<I", each)) for number, each in _PIXEL.items()}
    values |= {k: (_DOUBLE, struct.pack(f"<{len(each)}d", *each)) for k, each in _PLACE.items()}
    for number, data in records.items():
        kind = _KINDS[number]
        if whole := len(data) // _SIZES[kind] * _SIZES[kind]:
            values[number] = kind, data[:whole]
    place = 8 + 4  # the pixel stands behind the header
    start = place + 2 + 12 * len(values) + 4
    entries, rest = [], b""
    for number, (kind, data) in sorted(values.items()):
        held = data.ljust(4, b"\0") if len(data) <= 4 else struct.pack("<I", start + len(rest))
        entries.append(struct.pack("<HHI", number, kind, len(data) // _SIZES[kind]) + held)
        rest += b"" if len(data) <= 4 else data + bytes(-len(data) % 2)
    head = struct.pack("<2sHI4x", b"II", 42, place) + struct.pack("<H", len(entries))
    return head + b"".join(entries) + bytes(4) + rest
