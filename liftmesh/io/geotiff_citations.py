"""The texts of GeoKeys, as GDAL may see them: it takes some for WKT, and fails at invalid UTF-8.

A citation that begins "ESRI PE String = " goes on as WKT, which GDAL would read by itself: its
mark is changed before, and the text is read here. The mark is looked for in all bytes, since no
other reading of the file need agree with GDAL's on where citations are.

Source: OGC 19-008r4, GeoTIFF; TIFF 6.0, section 2.
"""

from __future__ import annotations

import struct

from liftmesh.wkt import plain

_MARK, _OTHER = b"ESRI PE String", b"esri pe string"  # GDAL minds upper case
_LONGEST = 1 << 16
_CITATIONS = 34737
_MOST_TAGS = 1 << 16


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
    text = data[place : place + _LONGEST].partition(b"=")[2]
    return plain(text.partition(b"|")[0].partition(b"\0")[0].decode("utf-8", "replace").strip())


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
            if tag == _CITATIONS and size > (8 if is_big else 4):
                return at, size
    except struct.error:
        pass
    return 0, 0
