"""Geometries of files: GeoJSON, GeoPackage and shapefiles, recognised by their first bytes.

Drawings, DXF and OBJ, are known by their suffix, and have lines alone (`drawings.py`).

They are read here, by the standard library and NumPy: a general library would choose among many
formats by itself, and some of those fetch addresses, open other files, or run statements.

A file is in the system that it names: old GeoJSON does so in the member ``crs``, which the trees of
other files have, too. What is laid over a surface must not name another system than the surface
does, and is taken to be in that one if it names none (`check_system`). What stands by itself, as a
domain, is in degrees if it is GeoJSON without a name, as RFC 7946 says, and its coordinates may be
degrees (`own_system`).

Lines are read in the plane, and written as GeoJSON, GeoPackage, shapefile or DXF. Points are read
in `clouds.py`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from numbers import Integral, Real
from pathlib import Path
from typing import Any, BinaryIO
from warnings import warn

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.arrays import as_reals
from liftmesh.base.options import shown
from liftmesh.crs.comparison import are_different, text_of
from liftmesh.crs.description import look_up, parse_crs
from liftmesh.errors import DataWarning, FormatError, InputError, MissingDependencyError
from liftmesh.io.atomic import replacing
from liftmesh.io.markup import parsed
from liftmesh.io.streams import check_suffix
from liftmesh.io.write import WriteResult, written_file
from liftmesh.optional import load
from liftmesh.vector import geojson, geopackage
from liftmesh.vector.drawings import read_dxf, read_obj_lines, write_dxf_lines
from liftmesh.vector.geopackage import MAGIC as GEOPACKAGE, read_geopackage
from liftmesh.vector.shapefile import MAGIC as SHAPEFILE, read_shapefile, write_shapefile

_STANDARD = "EPSG:4326"  # of GeoJSON that names no other
_MOST_DEGREES = np.array([360.0, 180.0])  # twice those of x and y
_TEXT = {".geojson", ".json", ""}
MARK = b"\xef\xbb\xbf"
_HEAD = 1 << 16  # bytes, of which the first of a text may be blank

LINE_SUFFIXES = (".geojson", ".json", ".gpkg", ".shp")
_WRITTEN = {
    ".geojson": "geojson", ".json": "geojson", ".gpkg": "geopackage", ".shp": "shapefile",
    ".dxf": "dxf",
}  # fmt: skip


def read_features(path: Path, what: str) -> dict[str, Any]:
    """Read the geometries of a file, and the values that they have."""
    suffix = path.suffix.lower()
    if suffix == ".dxf":
        return read_dxf(path)
    with path.open("rb") as stream:
        kind = "obj" if suffix == ".obj" else kind_of(path, stream, what)
        data = b"" if kind == "geopackage" else stream.read()
    if kind == "geopackage":
        return with_system(*read_geopackage(path), path)
    if kind == "shapefile":
        return with_system(*read_shapefile(path, data), path)
    text = data.removeprefix(MARK)
    return read_obj_lines(path, text) if kind == "obj" else _geojson(path, text)


def kind_of(path: Path, stream: BinaryIO, what: str) -> str:
    """Tell what a file is by how it begins; a file of text may have any name."""
    head = stream.read(_HEAD)
    stream.seek(0)
    if head.startswith(GEOPACKAGE):
        return "geopackage"
    if head.startswith(SHAPEFILE):
        return "shapefile"
    text = head.removeprefix(MARK)
    if path.suffix.lower() in _TEXT or text.lstrip()[:1] == b"{":
        return "geojson"
    raise FormatError(
        f"{path}: cannot be read as {what}: neither GeoJSON nor a GeoPackage nor a shapefile "
        "(.shp) nor a drawing (.dxf, .obj)"
    )


def read_shapes(path: Path, what: str, crs: str | None) -> dict[str, Any]:
    """Read a file, and see that it is in the system of a surface."""
    tree = read_features(path, what)
    check_system(crs, tree, str(path))
    return tree


def check_system(own: str | None, shapes: object, name: str) -> None:
    """Raise if shapes are known to be in another system than the surface."""
    stated = stated_system(shapes)
    if are_different(own, stated):
        raise InputError(f"{name} is in {shown(stated)}, the surface in {shown(own)}: transform it")


def stated_system(shapes: object) -> str | None:
    """Return the system that shapes say they are in."""
    if isinstance(shapes, Mapping):
        system = shapes.get("crs")
        properties = system.get("properties") if isinstance(system, Mapping) else None
        name = properties.get("name") if isinstance(properties, Mapping) else None
        if not isinstance(name, str):
            return None
        return "EPSG:4326" if name.upper().endswith("CRS84") else name
    held: Any = getattr(shapes, "crs", None)
    return str(held.to_wkt()) if hasattr(held, "to_wkt") else None


def own_system(tree: Mapping[str, Any], bounds: Sequence[float]) -> str | None:
    """Return the system of shapes of a file that stand by themselves."""
    crs = stated_system(tree) if "crs" in tree else _STANDARD
    system = parse_crs(crs)
    if system is None or (system.kind == "geographic" and not _are_degrees(bounds)):
        return None
    return crs


def _are_degrees(bounds: Sequence[float]) -> bool:
    return bool((np.abs(np.reshape(bounds, (2, 2))) <= _MOST_DEGREES).all())


def with_system(tree: dict[str, Any], crs: str | None, path: Path | str) -> dict[str, Any]:
    """Name the system as old GeoJSON does: the number that stands for it, if pyproj knows one."""
    try:
        crs = text_of(look_up(crs, extra="shapes")) if crs else None
    except MissingDependencyError:
        pass
    except InputError:
        warn(f"{path}: its coordinate system is not known: {shown(crs)}", DataWarning, stacklevel=2)
        crs = None
    return {**tree, "crs": crs and {"type": "name", "properties": {"name": crs}}}


def _geojson(path: Path, text: bytes) -> dict[str, Any]:
    try:
        tree = parsed(text.decode())
    except (ValueError, RecursionError) as error:
        raise FormatError(f"{path}: not GeoJSON: {error}") from error
    if not isinstance(tree, dict):
        return {}
    return with_system(tree, stated_system(tree), path) if tree.get("crs") else tree


def lines_of(path: Path, crs: str | None) -> list[Floats]:
    """Read the lines of a file, which has to be in the system of a surface."""
    tree = read_shapes(path, "lines", crs)
    try:
        lines = [
            geojson.planar_corners(each, "a line", "a line", 2)
            for each in geojson.coordinates_of(tree, "LineString")
        ]
    except (TypeError, AttributeError, RecursionError) as error:
        raise FormatError(f"{path}: no GeoJSON: a line has type and coordinates") from error
    except InputError as error:
        raise FormatError(f"{path}: {error}") from error
    if not lines:
        raise FormatError(f"{path}: there is no LineString or MultiLineString in it")
    return lines


def write_lines(
    path: Path,
    points: Floats,
    starts: Array,  # where each line begins, and where the last ends
    columns: Mapping[str, Array],
    crs: str | None,
    layer: str,
) -> WriteResult:
    """Write lines with a value of each column, as the name of the file says.

    DXF has lines at a height, if a column has these.
    """
    kind = _WRITTEN[path.suffix.lower()]
    if kind == "dxf":
        with replacing(path) as stream:
            write_dxf_lines(stream, points, starts, columns, layer)
        return written_file(path, kind, () if crs is None else ("crs",))
    if kind == "geojson":
        parts = (points[begin:end].tolist() for begin, end in pairwise(starts.tolist()))
        lines = ({"type": "LineString", "coordinates": part} for part in parts)
        return _write_features(path, lines, columns, crs)
    return _write_shapes(path, line_shapes(points, starts), columns, crs, layer, "LineString")


def line_shapes(points: Floats, starts: Array) -> Array:
    """Make lines of shapely."""
    counts = np.diff(starts)
    shapes: Array = load("shapely", extra="shapes").linestrings(
        points, indices=np.repeat(np.arange(len(counts)), counts)
    )
    return shapes


def write_areas(
    path: Path, shapes: Array, columns: Mapping[str, Array], crs: str | None, layer: str
) -> WriteResult:
    """Write polygons of shapely with a value of each column, as the name of the file says."""
    if _WRITTEN[path.suffix.lower()] == "geojson":
        return _write_features(path, (each.__geo_interface__ for each in shapes), columns, crs)
    return _write_shapes(path, shapes, columns, crs, layer, "MultiPolygon")


def _write_features(
    path: Path, shapes: Iterable[dict[str, Any]], columns: Mapping[str, Array], crs: str | None
) -> WriteResult:
    with replacing(path) as stream:
        geojson.write_features(stream, zip(_rows(columns), shapes, strict=True), crs)
    return written_file(path, "geojson")


def _write_shapes(
    path: Path,
    shapes: Array,
    columns: Mapping[str, Array],
    crs: str | None,
    layer: str,
    kind: str,
) -> WriteResult:
    written = _WRITTEN[path.suffix.lower()]
    if written == "shapefile":
        write_shapefile(path, shapes, columns, crs, kind)
    else:
        with replacing(path) as stream:
            geopackage.write_shapes(stream, shapes, columns, crs, layer)
    return written_file(path, written)


def check_written(path: Path, what: str, *, may_be_drawing: bool = False) -> None:
    """Raise if shapes cannot be written to a file of this name."""
    suffixes = (*LINE_SUFFIXES, *[".dxf"] * may_be_drawing)
    said = f"{what} are written as GeoJSON, GeoPackage (.gpkg) or a shapefile (.shp)"
    check_suffix(path, suffixes, f"{said}, or lines as DXF" if may_be_drawing else said)
    if _WRITTEN[path.suffix.lower()] in ("geopackage", "shapefile"):
        load("geopandas", extra="shapes")


def _rows(columns: Mapping[str, Array]) -> Iterator[dict[str, Any]]:
    """Yield the values of each row by their names."""
    rows = zip(*(values.tolist() for values in columns.values()), strict=True)
    return (dict(zip(columns, row, strict=True)) for row in rows)


def column_of(values: list[Any]) -> Array | None:
    """Return numbers as an array, NaN where there is none; None if they are no numbers."""
    present = [each for each in values if each is not None]
    if not present or not all(isinstance(each, Real) for each in present):
        return None
    if len(present) == len(values) and all(isinstance(each, Integral) for each in present):
        whole = np.asarray(values)
        if whole.dtype.kind in "iu":
            return whole
    try:
        return as_reals([np.nan if each is None else each for each in values])
    except OverflowError:
        return None
