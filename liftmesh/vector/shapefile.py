"""Shapes and values of a shapefile: corners in .shp, values beside it in .dbf, the system in .prj.

Records are read in the order of the file, with the heights of lines and rings; other heights, and
measures, are left out. A ring that turns clockwise is an outer one, as the format says, and each
other ring a hole of the outer ring around it.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from liftmesh._typing import Array, Floats, Integers
from liftmesh.base.options import shown
from liftmesh.errors import FormatError
from liftmesh.optional import load
from liftmesh.raster.pixels import text_beside

MAGIC = b"\0\0\x27\x0a"

_HEAD, _RECORD = 100, 8
_POINT, _LINES, _POLYGON, _POINTS = 1, 3, 5, 8
_KINDS = {
    _POINT: "Point",
    _LINES: "MultiLineString",
    _POLYGON: "MultiPolygon",
    _POINTS: "MultiPoint",
}
_SPATIAL = 1  # the tens of types with heights
_FEWEST = 4  # corners of a ring, of which the last is the first
_AT_ONCE = 64  # outer rings that are compared with all holes
_PAIRS, _PAIRS_MORE = 100, 1_000_000  # of outer rings and holes whose boxes meet
_FIELD = 32
_CODE_PAGE = re.compile(r"(?i)(?:cp|ansi|windows|oem)?[ -]?(\d{3,4})")
_PAGES = (437, 850, 852, 855, 857, 858, 860, 861, 862, 863, 864, 865, 866, 869, 874, 932, 936, 949,
          950, *range(1250, 1259))  # fmt: skip
_ISO = re.compile(r"(?i)(?:iso)?[ -]?8859[ -]?(\d\d?)")


def read_shapefile(path: Path, data: bytes) -> tuple[dict[str, Any], str | None]:
    """Read the shapes."""
    try:
        shapes = list(_shapes(data))
        rows = _rows(path, len(shapes))
    except (ValueError, struct.error, IndexError) as error:
        raise FormatError(f"{path}: damaged, or no shapefile: {error}") from error
    features = [
        {"type": "Feature", "properties": row, "geometry": shape}
        for row, shape in zip(rows, shapes, strict=True)
        if row is not None
    ]
    return {"type": "FeatureCollection", "features": features}, text_beside(str(path), ".prj")


def _shapes(data: bytes) -> Iterator[dict[str, Any] | None]:
    """Yield the shape of each record; None where it has none."""
    (words,) = struct.unpack_from(">i", data, 24)
    (kind,) = struct.unpack_from("<i", data, 32)
    place, end = _HEAD, 2 * words
    if end > len(data):
        raise ValueError(f"it has {len(data):,} bytes, and says {end:,}")
    while place < end:
        _, words = struct.unpack_from(">2i", data, place)
        begin, place = place + _RECORD, place + _RECORD + 2 * words
        if words < 2 or place > end:
            raise ValueError(f"the record at byte {begin - _RECORD:,} has {2 * words:,} bytes")
        (own,) = struct.unpack_from("<i", data, begin)
        if own not in (0, kind):
            raise ValueError(f"the record at byte {begin - _RECORD:,} has the type {own}")
        yield _shape(kind, data[begin + 4 : place]) if own else None


def _shape(kind: int, record: bytes) -> dict[str, Any]:
    """Convert a record behind its type; types with heights or measures are 10 or 20 more."""
    plain = kind % 10
    if plain not in _KINDS or kind > 30:
        raise ValueError(f"shapes of type {kind} are surfaces or unknown")
    if plain == _POINT:
        return {"type": "Point", "coordinates": _corners(record, 0, 1)[0].tolist()}
    if plain == _POINTS:
        (count,) = struct.unpack_from("<I", record, 32)
        return {"type": "MultiPoint", "coordinates": _corners(record, 36, count).tolist()}
    count, corners = struct.unpack_from("<2I", record, 32)
    begins = np.frombuffer(record, "<u4", count, 40)
    points = _corners(record, 40 + 4 * count, corners)
    if kind // 10 == _SPATIAL:
        place = 40 + 4 * count + 16 * corners + 16  # behind the least and the greatest height
        points = np.column_stack([points, np.frombuffer(record, "<f8", corners, place)])
    if count and (begins[0] or begins[-1] > corners or (begins[1:] < begins[:-1]).any()):
        raise ValueError("the parts of a shape do not begin one after the other")
    parts = np.split(points, begins[1:]) if count else []
    held = _nested(parts) if plain == _POLYGON else [each.tolist() for each in parts]
    return {"type": _KINDS[plain], "coordinates": held}


def _corners(record: bytes, place: int, count: int) -> Floats:
    return np.frombuffer(record, "<f8", 2 * count, place).reshape(-1, 2)


def _nested(rings: Sequence[Floats]) -> list[list[Any]]:
    """Assign each hole to the smallest outer ring around it; a ring alone is no hole."""
    if len(rings) < 2:
        return [[each.tolist()] for each in rings]
    if min(map(len, rings)) < _FEWEST or not all(np.isfinite(each[:, :2]).all() for each in rings):
        raise ValueError("a ring has less than four corners, or one that is not finite")
    shapely = load("shapely", extra="shapes")
    lines = shapely.linearrings(np.concatenate(rings), indices=_numbers(rings))
    is_hole = shapely.is_ccw(lines)
    areas, holes = shapely.polygons(lines[~is_hole]), shapely.polygons(lines[is_hole])
    polygons = [[ring.tolist()] for ring, each in zip(rings, is_hole, strict=True) if not each]
    inner = (ring.tolist() for ring, each in zip(rings, is_hole, strict=True) if each)
    for ring, place in zip(inner, _around(shapely, areas, holes), strict=True):
        polygons[place].append(ring)
    return polygons


def _numbers(rings: Sequence[Floats]) -> Integers:
    return np.repeat(np.arange(len(rings)), [len(each) for each in rings])


def _around(shapely: Any, areas: Array, holes: Array) -> list[int]:
    """Find the smallest area around each hole."""
    tree = shapely.STRtree(holes)
    nearest = np.full(len(holes), -1)
    left = _PAIRS * (len(areas) + len(holes)) + _PAIRS_MORE
    order = np.argsort(-shapely.area(areas), kind="stable")
    for some in np.split(order, range(_AT_ONCE, len(order), _AT_ONCE)):
        left -= tree.query(areas[some]).shape[1]
        if left < 0:
            raise ValueError("the rings of a polygon lie in each other, too many to sort")
        place, hole = tree.query(areas[some], predicate="covers")
        nearest[hole] = some[place]  # the smallest one last
    if (nearest < 0).any():
        raise ValueError("a hole of a polygon is in none of its outer rings")
    return nearest.tolist()  # type: ignore[no-any-return]


def _rows(path: Path, count: int) -> list[dict[str, Any] | None]:
    """Read the values of each shape; None for one that is deleted."""
    beside = next(
        (each for each in map(path.with_suffix, (".dbf", ".DBF")) if each.is_file()), None
    )
    if beside is None:
        return [{} for _ in range(count)]
    data = beside.read_bytes()
    rows, begin, size = struct.unpack_from("<I2H", data, 4)
    if rows != count:
        raise ValueError(f"{beside.name} has {rows:,} rows for {count:,} shapes")
    encoding = _encoding(text_beside(str(path), ".cpg"))
    fields, place = [], 1
    for at in range(_FIELD, begin - 1, _FIELD):
        if data[at] == 13:
            break
        name, kind, width = struct.unpack_from("<11sc4xB", data, at)
        fields.append((name.split(b"\0")[0].decode(encoding), kind, place, place + width))
        place += width
        if not width or place > size:
            raise ValueError(f"the columns of {beside.name} are wider than its rows")
    if begin + size * rows > len(data):
        raise ValueError(f"{beside.name} is truncated")
    records = (data[at : at + size] for at in range(begin, begin + size * rows, size or 1))
    return [
        None
        if row[:1] == b"*"
        else {name: _value(row[a:b], kind, encoding) for name, kind, a, b in fields}
        for row in records
    ]


def _encoding(said: str | None) -> str:
    """Return the encoding of text; that of a file that says none is the one of the format."""
    text = (said or "8859-1").strip()
    if text.upper().replace("-", "") in ("UTF8", "65001"):
        return "utf-8"
    page, iso = _CODE_PAGE.fullmatch(text), _ISO.fullmatch(text)
    if page and int(page[1]) in _PAGES:
        return f"cp{page[1]}"
    if iso and int(iso[1]) in range(1, 17) and iso[1] != "12":
        return f"iso8859-{int(iso[1])}"
    raise ValueError(f"the .cpg file says {shown(said)}, no known encoding: save it as UTF-8")


def _value(text: bytes, kind: bytes, encoding: str) -> Any:
    """Convert a value: numbers, truth, and text; None if there is none."""
    word = text.decode(encoding, "replace").rstrip("\0 ").lstrip() if kind != b"C" else ""
    if kind in b"NF":
        is_empty = not word.strip("*")
        return None if is_empty else int(word) if word.lstrip("+-").isdecimal() else float(word)
    if kind == b"L":
        return {"T": True, "Y": True, "F": False, "N": False}.get(word.upper())
    return word or text.decode(encoding).rstrip("\0 ") or None
