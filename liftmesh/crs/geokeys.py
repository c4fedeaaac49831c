"""GeoKeys: the coordinate system as numbers of EPSG and units, as LAS has it from GeoTIFF.

The key of the model says which of the others count: the geographic system that a projected one is
made of is not the system of the coordinates. Heights have a number or a unit of their own, which
may be another than that of the plane.

Systems that are made up of parameters have no number: the WKT that other programs write besides
counts, or GDAL reads the keys from GeoTIFF, where they come from: they are put into a file of one
pixel, in memory.

A citation that begins "ESRI PE String = " goes on as WKT, which GDAL would read by itself: its
mark is changed before, and the text is read here. The mark is looked for in all bytes, since no
other reading of the file need agree with GDAL's on where citations are. And GDAL fails at invalid
UTF-8.

Source: OGC 19-008r4, GeoTIFF; GeoTIFF 1.0, section 6.3.4, for the old numbers of heights; TIFF 6.0,
section 2.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping

from liftmesh.base.cloud import is_crs
from liftmesh.crs.description import FOOT, METRE, SURVEY_FOOT, as_wkt, parse_crs, plain_wkt
from liftmesh.errors import MissingDependencyError
from liftmesh.optional import load

_ENTRY = struct.Struct("<4H")
_MODEL, _GEOGRAPHIC, _PROJECTED, _LENGTH = 1024, 2048, 3072, 3076
_VERTICAL, _HEIGHT = 4096, 4099  # the system of heights, and their unit
_OF_PROJECTED = range(3072, 3097)
_METHODS = (3074, 3075)  # of projection, by a number of EPSG or of GeoTIFF
_IS_PROJECTED, _IS_GEOCENTRIC = 1, 3
_NUMBERS = range(1024, 32767)  # of EPSG; 32767 is user-defined
_OLD = range(5001, 5107)  # of GeoTIFF 1.0, which EPSG does not know
_UNITS = {9001: METRE, 9002: FOOT, 9003: SURVEY_FOOT}

_HEIGHTS = {  # systems of heights by an old number, or that of metres, and the unit
    (5101, 0): 5701, (5101, 9001): 5701, (5102, 9001): 7968, (5102, 9003): 5702,
    (5103, 0): 5703, (5103, 9001): 5703, (5103, 9002): 8228, (5103, 9003): 6360,
    (5703, 9002): 8228, (5703, 9003): 6360, (5104, 0): 5736, (5104, 9001): 5736,
    (5105, 0): 5705, (5105, 9001): 5705,
}  # fmt: skip

_GEOCENTRIC_OF = {4326: 4978, 4978: 4978, 4979: 4978, 4258: 4936, 4936: 4936, 4937: 4936}
_SHORT, _ASCII, _LONG, _DOUBLE = 3, 2, 4, 12
_SIZES = {_SHORT: 2, _ASCII: 1, _LONG: 4, _DOUBLE: 8}
KEYS, DOUBLES, CITATIONS = OF_KEYS = 34735, 34736, 34737  # keys, their doubles and their text
_KINDS = {KEYS: _SHORT, DOUBLES: _DOUBLE, CITATIONS: _ASCII}
_PIXEL = {256: 1, 257: 1, 258: 8, 259: 1, 262: 1, 273: 8, 277: 1, 278: 1, 279: 1}
_PLACE = {33550: (2, 2, 0), 33922: (0, 0, 0, 0, 0, 0)}  # or rasterio warns that there is none
_MOST = 1 << 16  # bytes of a record that are read
_MOST_TAGS = 1 << 16
# Settings by which GDAL looks for no file beside another, makes none, and prints nothing; as it
# reads, it also says the system of heights, that of files of GeoTIFF 1.0, too.
ALONE = {"GDAL_DISABLE_READDIR_ON_OPEN": "EMPTY_DIR", "GDAL_PAM_ENABLED": "NO", "CPL_DEBUG": "OFF"}
READING = {**ALONE, "GTIFF_REPORT_COMPD_CS": "YES"}
_MARK, _OTHER = b"ESRI PE String", b"esri pe string"  # GDAL minds upper case


def crs_of_geokeys(data: bytes | None) -> tuple[str | None, str]:
    """Return the coordinate system that GeoKeys state."""
    keys = _entries(data or b"")
    if keys.get(_MODEL) == _IS_GEOCENTRIC:
        return _geocentric(keys.get(_GEOGRAPHIC, 0)), ""
    is_projected = keys.get(_MODEL, 0) == _IS_PROJECTED or (
        _MODEL not in keys and any(each in keys for each in _OF_PROJECTED)
    )
    number = keys.get(_PROJECTED if is_projected else _GEOGRAPHIC, 0)
    if number not in _NUMBERS:
        return None, ""
    base, unit = f"EPSG:{number}", _UNITS.get(keys.get(_LENGTH, 0))
    known = parse_crs(base)
    plane = known.units[0] if known else None
    if is_projected and unit and plane and plane.metres != unit.metres:
        return None, f"GeoKeys ({base} has the unit {plane.name}, but they state {unit.name})"
    return _with_heights(base, keys), ""


def _geocentric(number: int) -> str:
    """Name a geocentric system, by which programs refuse it, if by nothing else."""
    known = _GEOCENTRIC_OF.get(number)
    return f"EPSG:{known}" if known else f'GEOCCS["geocentric, {number}",UNIT["metre",1]]'


def _with_heights(base: str, keys: Mapping[int, int]) -> str:
    """Add the system of heights, or a unit where there is none, or it has another unit."""
    code = keys.get(_HEIGHT, 0)
    number, unit = keys.get(_VERTICAL, 0), _UNITS.get(code)
    number = _HEIGHTS.get((number, code), number)
    if number in _NUMBERS and number not in _OLD:
        both = f"{base}+{number}"
        if parse_crs(base) is None:
            return both
        known = parse_crs(both)
        if known and (unit is None or known.units[2] == unit):
            return both
    text = as_wkt(base) if unit and parse_crs(base) else None
    if unit is None or text is None or not text.startswith(("PROJCS", "GEOGCS")):
        return base
    return (
        f'COMPD_CS["{base} + heights in {unit.name}",{text},VERT_CS["unknown",'
        f'VERT_DATUM["unknown",2005],UNIT["{unit.name}",{unit.metres!r}],'
        'AXIS["Gravity-related height",UP]]]'
    )


def has_parameters(data: bytes | None) -> bool:
    """Whether GeoKeys make up a projected system of parameters, rather than name one."""
    keys = _entries(data or b"")
    is_named = keys.get(_PROJECTED, 0) in _NUMBERS
    is_projected = keys.get(_MODEL, _IS_PROJECTED) == _IS_PROJECTED
    return is_projected and not is_named and any(each in keys for each in _METHODS)


def _entries(data: bytes) -> dict[int, int]:
    """Return the keys whose value stands in the directory itself, as all numbers of EPSG do."""
    if len(data) < _ENTRY.size:
        return {}
    count = min(_ENTRY.unpack_from(data)[3], len(data) // _ENTRY.size - 1)
    rows = (_ENTRY.unpack_from(data, _ENTRY.size * (k + 1)) for k in range(count))
    return {key: value for key, place, _, value in rows if place == 0}


def wkt_of(records: Mapping[int, bytes]) -> tuple[str | None, str]:
    """Return the system that is made up of parameters."""
    if not records.get(DOUBLES):
        return None, "GeoKeys (a system made up of parameters, which are missing)"
    try:
        rasterio = load("rasterio", extra="terrain")
        errors = load("rasterio.errors", extra="terrain")
        inner = load("rasterio._err", extra="terrain")
    except MissingDependencyError as error:
        return None, f"GeoKeys (a system made up of parameters: {error})"
    data = without_wkt(_tiff({number: each[:_MOST] for number, each in records.items()}))
    try:
        with (
            rasterio.Env(**READING),
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


def without_wkt(data: bytes) -> bytes:
    """Return a TIFF file whose citations are names for GDAL, in ASCII unless all are UTF-8."""
    data = data.replace(_MARK, _OTHER) if _MARK in data else data
    place, size = _citations(data)
    text = data[place : place + size]
    try:
        text.decode()
    except UnicodeDecodeError:
        named = text.decode("ascii", "replace").replace("\ufffd", "?").encode()
        return data[:place] + named + data[place + size :]
    return data


def wkt_in(data: bytes) -> str | None:
    """Return the WKT of a citation, from the file as it was or after `without_wkt`."""
    place = max(data.find(_OTHER), data.find(_MARK))
    if place < 0:
        return None
    text = data[place : place + _MOST].partition(b"=")[2]
    return plain_wkt(text.partition(b"|")[0].partition(b"\0")[0].decode("utf-8", "replace").strip())


def _citations(data: bytes) -> tuple[int, int]:
    """Find the record of citations; nothing if it is too short to stand apart."""
    order, is_big = "<" if data[:2] == b"II" else ">", data[2:4] in (b"+\0", b"\0+")
    first, head, entry = ("8xQ", "Q", "HHQQ") if is_big else ("4xI", "H", "HHII")
    try:
        (place,) = struct.unpack_from(order + first, data)
        (count,) = struct.unpack_from(order + head, data, place)
        place += struct.calcsize(order + head)
        step = struct.calcsize(order + entry)
        for k in range(min(count, _MOST_TAGS)):
            tag, _, size, at = struct.unpack_from(order + entry, data, place + k * step)
            if tag == CITATIONS and size > (8 if is_big else 4):
                return at, size
    except struct.error:
        pass
    return 0, 0
