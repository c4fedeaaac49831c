"""Shapefiles, reader and writer: corners in .shp, values beside it in .dbf, the system in .prj.

Records are read in the order of the file, with their heights; measures are left out. A ring that
turns clockwise is an outer one, as the format says, and each other ring a hole of the outer ring
around it. Of surfaces (MultiPatch) the strips and fans of triangles, and rings, are patches of TIN.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from liftmesh._typing import Array, Floats, Integers
from liftmesh.base.options import shown
from liftmesh.errors import FormatError, LiftmeshError
from liftmesh.io.atomic import replacing, working_folder
from liftmesh.optional import load
from liftmesh.raster.pixels import file_beside, text_beside
from liftmesh.vector.geopackage import write_by_geopandas

MAGIC = b"\0\0\x27\x0a"

_HEAD, _RECORD = 100, 8
_POINT, _LINES, _POLYGON, _POINTS, _PATCHES = 1, 3, 5, 8, 31
_STRIP, _FAN, _INNER = 0, 1, 3  # kinds of parts of a MultiPatch; others are rings
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
_OF_OTHERS = (".qix", ".sbn", ".sbx")  # an index, which readers trust
_CODE_PAGE = re.compile(r"(?i)(?:cp|ansi|windows|oem)?[ -]?(\d{3,4})")
_PAGES = (437, 850, 852, 855, 857, 858, 860, 861, 862, 863, 864, 865, 866, 869, 874, 932, 936, 949,
          950, *range(1250, 1259))  # fmt: skip
_ISO = re.compile(r"(?i)(?:iso)?[ -]?8859[ -]?(\d\d?)")


def read_shapefile(path: Path, data: bytes) -> tuple[dict[str, Any], str | None]:
    """Read the shapes."""
    with about(str(path)):
        features = [
            {"type": "Feature", "properties": row, "geometry": shape}
            for shape, row in features_of(str(path), data)
        ]
    return {"type": "FeatureCollection", "features": features}, system_of(str(path))


def system_of(name: str) -> str | None:
    """Return the coordinate system that the file beside says."""
    return text_beside(name, ".prj")


@contextmanager
def about(name: str) -> Iterator[None]:
    """Say of what the reading of features, or of the patches of one, finds which file it is in."""
    try:
        yield
    except (ValueError, struct.error, IndexError) as error:
        if isinstance(error, LiftmeshError):
            raise
        raise FormatError(f"{name}: damaged, or no shapefile: {error}") from error


def features_of(name: str, data: bytes) -> Iterator[tuple[dict[str, Any] | None, dict[str, Any]]]:
    """Yield the shape and the values of each record that is not deleted."""
    count = sum(1 for _ in _records(data))
    for (kind, begin, end), row in zip(_records(data), _rows(name, count), strict=True):
        if row is not None:
            yield _shape(kind, data[begin:end]) if kind else None, row


def write_shapefile(
    path: Path, shapes: Array, columns: Mapping[str, Array], crs: str | None, kind: str
) -> None:
    """Write geometries of a kind by geopandas, and put all files in place once all are complete.

    Of files beside the old one those that are not written again would no longer be right.
    """
    is_new = not path.exists()
    options = {"driver": "ESRI Shapefile", "encoding": "UTF-8", "geometry_type": kind}
    with working_folder(path.parent, "shapefile") as folder, ExitStack() as stack:
        write_by_geopandas(folder / "shapes.shp", shapes, columns, crs, **options)
        for made in sorted(folder.glob("shapes.*")):
            is_main = made.suffix == ".shp"
            name = path if is_main else path.with_suffix(made.suffix)
            place = replacing(name, overwrite=is_main or not is_new, follow_links=is_main)
            stack.enter_context(place).write(made.read_bytes())
    if crs is None and not is_new:
        path.with_suffix(".prj").unlink(missing_ok=True)
    for each in () if is_new else _OF_OTHERS:
        path.with_suffix(each).unlink(missing_ok=True)


def _records(data: bytes) -> Iterator[tuple[int, int, int]]:
    """Yield the type of each record, 0 if it has no shape, and where it begins and ends."""
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
        yield own, begin + 4, place


def _shape(kind: int, record: bytes) -> dict[str, Any]:
    """Convert a record behind its type; types with heights or measures are 10 or 20 more."""
    plain = kind % 10
    if kind == _PATCHES:
        return {"type": "TIN", "coordinates": _patches(record)}
    if plain not in _KINDS or kind > 30:
        raise ValueError(f"shapes of type {kind} are unknown")
    is_high = kind // 10 == _SPATIAL
    if plain == _POINT:
        place = np.frombuffer(record, "<f8", 2 + is_high)
        return {"type": "Point", "coordinates": place.tolist()}
    if plain == _POINTS:
        (count,) = struct.unpack_from("<I", record, 32)
        return {"type": "MultiPoint", "coordinates": _places(record, 36, count, is_high).tolist()}
    count, corners = struct.unpack_from("<2I", record, 32)
    points = _places(record, 40 + 4 * count, corners, is_high)
    parts = _split(record, points, count)
    held = _nested(parts) if plain == _POLYGON else [each.tolist() for each in parts]
    return {"type": _KINDS[plain], "coordinates": held}


def _places(record: bytes, begin: int, count: int, is_high: bool) -> Floats:
    """Return corners, with the heights that are behind them, and behind the range of these."""
    points = _corners(record, begin, count)
    if not is_high:
        return points
    heights = np.frombuffer(record, "<f8", count, begin + 16 * count + 16)
    return np.column_stack([points, heights])


def _split(record: bytes, points: Floats, count: int) -> list[Floats]:
    """Return the corners of each part."""
    begins = np.frombuffer(record, "<u4", count, 40)
    if count and (begins[0] or begins[-1] > len(points) or (begins[1:] < begins[:-1]).any()):
        raise ValueError("the parts of a shape do not begin one after the other")
    return np.split(points, begins[1:]) if count else []


def _patches(record: bytes) -> Iterator[list[Any]]:
    """Yield the polygons of a surface, each with its holes."""
    count, corners = struct.unpack_from("<2I", record, 32)
    kinds = np.frombuffer(record, "<u4", count, 40 + 4 * count).tolist()
    points = _places(record, 40 + 8 * count, corners, is_high=True)
    rings: list[Any] = []
    for kind, part in zip(kinds, _split(record, points, count), strict=True):
        if kind == _INNER and rings:
            rings.append(part.tolist())
            continue
        yield from [rings] * bool(rings)
        rings = [] if kind in (_STRIP, _FAN) else [part.tolist()]
        if not rings:
            yield from _triangles(part, is_fan=kind == _FAN)
    yield from [rings] * bool(rings)


def _triangles(corners: Floats, *, is_fan: bool) -> Iterator[list[Any]]:
    """Yield the triangles of a fan or strip; in this every other one turns the other way."""
    for k in range(len(corners) - 2):
        odd = k % 2 and not is_fan
        rows = [0 if is_fan else k + 2 * odd, k + 1, k + 2 * (not odd)]
        yield [corners[rows].tolist()]


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


def _rows(name: str, count: int) -> Iterator[dict[str, Any] | None]:
    """Read the values of each shape; None for one that is deleted."""
    beside = file_beside(name, (".dbf", ".DBF"))
    if beside is None:
        return ({} for _ in range(count))
    data = beside.read_bytes()
    rows, begin, size = struct.unpack_from("<I2H", data, 4)
    if rows != count:
        raise ValueError(f"{beside.name} has {rows:,} rows for {count:,} shapes")
    encoding = _encoding(text_beside(name, ".cpg"))
    fields, place = [], 1
    for at in range(_FIELD, begin - 1, _FIELD):
        if data[at] == 13:
            break
        title, kind, width = struct.unpack_from("<11sc4xB", data, at)
        fields.append((title.split(b"\0")[0].decode(encoding), kind, place, place + width))
        place += width
        if not width or place > size:
            raise ValueError(f"the columns of {beside.name} are wider than its rows")
    if begin + size * rows > len(data):
        raise ValueError(f"{beside.name} is truncated")
    records = (data[at : at + size] for at in range(begin, begin + size * rows, size or 1))
    return (
        None
        if row[:1] == b"*"
        else {title: _value(row[a:b], kind, encoding) for title, kind, a, b in fields}
        for row in records
    )


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
