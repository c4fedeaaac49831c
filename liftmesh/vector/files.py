"""Geometries of files: GeoJSON, GeoPackage and shapefiles, told apart by how they begin.

Drawings, DXF and OBJ, are known by their suffix, and have lines alone (`drawings.py`).

They are read here, by the standard library and NumPy: a general library would choose among many
formats by itself, and some of those fetch addresses, open other files, or run statements.

A file is in the system that it names: old GeoJSON does so in the member ``crs``, which the trees of
other files have, too. What is laid over a surface must not name another system than the surface
does, and is taken to be in that one if it names none (`check_system`). What stands by itself, as a
domain, is in degrees if it is GeoJSON without a name, as RFC 7946 says, and its coordinates may be
degrees (`own_system`).

*Lines* are read in the plane, and written as GeoJSON or GeoPackage.

*Points* are places in the plane: heights, which GeoJSON allows, are left out. Properties are named
values of a point, as the columns of a table are, if all of them are numbers.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from numbers import Integral, Real
from pathlib import Path
from typing import Any
from warnings import warn

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.arrays import as_reals
from liftmesh.base.cloud import Cloud
from liftmesh.base.options import counted, shown
from liftmesh.crs.comparison import are_different, text_of
from liftmesh.crs.description import look_up, parse_crs
from liftmesh.errors import DataWarning, FormatError, InputError, MissingDependencyError
from liftmesh.io.atomic import replacing
from liftmesh.io.markup import parsed
from liftmesh.io.metadata import Unread, noted
from liftmesh.io.write import WriteResult, written_file
from liftmesh.vector import geojson, geopackage
from liftmesh.vector.drawings import read_dxf, read_obj_lines
from liftmesh.vector.geojson import geometries
from liftmesh.vector.geopackage import MAGIC as GEOPACKAGE, read_geopackage
from liftmesh.vector.shapefile import MAGIC as SHAPEFILE, read_shapefile

_STANDARD = "EPSG:4326"  # of GeoJSON that names no other
_MOST_DEGREES = np.array([360.0, 180.0])  # twice those of x and y
_TEXT = {".geojson", ".json", ""}
_MARK = b"\xef\xbb\xbf"

LINE_SUFFIXES = (".geojson", ".json", ".gpkg")


def read_features(path: Path, what: str) -> dict[str, Any]:
    """Read the geometries of a file, and the values that they have."""
    suffix = path.suffix.lower()
    if suffix == ".dxf":
        return read_dxf(path)
    with path.open("rb") as stream:
        head = stream.read(len(GEOPACKAGE))
        data = b"" if head == GEOPACKAGE else head + stream.read()
    if head == GEOPACKAGE:
        return _with_system(*read_geopackage(path), path)
    if data.startswith(SHAPEFILE):
        return _with_system(*read_shapefile(path, data), path)
    text = data.removeprefix(_MARK)
    if suffix == ".obj":
        return read_obj_lines(path, text)
    if suffix in _TEXT or text.lstrip()[:1] == b"{":
        return _geojson(path, text)
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


def _with_system(tree: dict[str, Any], crs: str | None, path: Path) -> dict[str, Any]:
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
    return _with_system(tree, stated_system(tree), path) if tree.get("crs") else tree


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
    """Write lines with a value of each column, as the name of the file says."""
    parts = (points[begin:end].tolist() for begin, end in pairwise(starts.tolist()))
    lines = ({"type": "LineString", "coordinates": part} for part in parts)
    with replacing(path) as stream:
        if _is_package(path):
            geopackage.write_lines(stream, points, starts, columns, crs, layer)
        else:
            geojson.write_features(stream, zip(_rows(columns), lines, strict=True), crs)
    return written_file(path, "geopackage" if _is_package(path) else "geojson")


def write_areas(
    path: Path, shapes: Array, columns: Mapping[str, Array], crs: str | None, layer: str
) -> WriteResult:
    """Write polygons of shapely with a value of each column, as the name of the file says."""
    with replacing(path) as stream:
        if _is_package(path):
            geopackage.write_shapes(stream, shapes, columns, crs, layer)
        else:
            described = (each.__geo_interface__ for each in shapes)
            geojson.write_features(stream, zip(_rows(columns), described, strict=True), crs)
    return written_file(path, "geopackage" if _is_package(path) else "geojson")


def _is_package(path: Path) -> bool:
    return path.suffix.lower() == ".gpkg"


def _rows(columns: Mapping[str, Array]) -> Iterator[dict[str, Any]]:
    """Yield the values of each row by their names."""
    rows = zip(*(values.tolist() for values in columns.values()), strict=True)
    return (dict(zip(columns, row, strict=True)) for row in rows)


_EXPANSION, _VALUES_MORE = 20, 1 << 21  # values for each that is stated, and in all
_COORDINATES = {"x", "y", "z"}


def points_of(path: Path, crs: str | None) -> Cloud:
    """Read the points of a file, which has to be in the system of a surface, at height 0."""
    shapes = read_shapes(path, "points", crs)
    points = _Points()
    try:
        points.take(shapes)
    except (TypeError, AttributeError, RecursionError) as error:
        raise FormatError(f"{path}: no GeoJSON: a point has type and coordinates") from error
    if not points.places:
        raise FormatError(f"{path}: there is no Point or MultiPoint in it")
    points.check_size(path)
    planar = _planar(points.places)
    if planar is None:
        number = next(k for k, place in enumerate(points.places) if _planar([place]) is None)
        wrong = shown(points.places[number])
        raise FormatError(f"{path}: point {number} is {wrong}: give two finite numbers, or three")
    columns = points.columns()
    unread = (f"property {name}" for name in points.names() if name not in columns)
    skipped = (*unread, *(counted(count, kind) for kind, count in points.others.items()))
    return Cloud(
        np.column_stack([planar, np.zeros(len(planar))]),
        attributes=columns,
        metadata=noted({}, not_read=Unread(skipped)),
        crs=stated_system(shapes),
    )


@dataclass(slots=True)
class _Points:
    """The points of a tree of GeoJSON, properties and how many points have them, and the rest."""

    places: list[Any] = field(default_factory=list)
    properties: list[Mapping[str, Any]] = field(default_factory=list)
    counts: list[int] = field(default_factory=list)
    others: Counter[str] = field(default_factory=Counter)

    def take(self, tree: object) -> None:
        """Collect the points of a tree."""
        for kind, coordinates, properties in geometries(tree):
            if kind not in {"Point", "MultiPoint"}:
                self.others[kind] += 1
                continue
            is_one = kind == "Point" and coordinates
            parts = [coordinates] if is_one else coordinates
            if len(parts):
                self.places += parts
                self.properties.append(properties)
                self.counts.append(len(parts))

    def check_size(self, path: Path) -> None:
        """Raise if a value for every point and property is far more than the file states."""
        stated = len(self.places) + sum(map(len, self.properties))
        names = len(self.names())
        if names * len(self.places) > _EXPANSION * stated + _VALUES_MORE:
            raise FormatError(
                f"{path}: {len(self.places):,} points with {names:,} properties are far more "
                "values than the file states: save only the properties you need"
            )

    def names(self) -> list[str]:
        """Return the names of the properties, in the order of the file."""
        return [*dict.fromkeys(name for each in self.properties for name in each)]

    def columns(self) -> dict[str, Array]:
        """Return the values of the properties that are numbers."""
        names = (name for name in self.names() if name.lower() not in _COORDINATES)
        columns = {name: _column([each.get(name) for each in self.properties]) for name in names}
        return {
            name: np.repeat(values, self.counts)
            for name, values in columns.items()
            if values is not None
        }


def _column(values: list[Any]) -> Array | None:
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


def _planar(places: list[Any]) -> Floats | None:
    """Return x and y of points; None if one has none."""
    try:
        planar = as_reals([place[:2] for place in places])
    except (TypeError, ValueError, OverflowError, KeyError):
        return None
    return planar if planar.shape == (len(places), 2) and np.isfinite(planar).all() else None
