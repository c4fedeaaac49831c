"""Geometries of files: GeoJSON, GeoPackage and shapefiles, told apart by how they begin.

They are read here, by the standard library and NumPy: a general library would choose among many
formats by itself, and some of those fetch addresses, open other files, or run statements.

A file is in the system that it names: old GeoJSON does so in the member ``crs``, which the trees of
other files have, too. What is laid over a surface must not name another system than the surface
does, and is taken to be in that one if it names none (`check_system`). What stands by itself, as a
domain, is in degrees if it is GeoJSON without a name, as RFC 7946 says, and its coordinates may be
degrees (`own_system`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any
from warnings import warn

import numpy as np

from liftmesh.base.options import shown
from liftmesh.crs.comparison import are_different, text_of
from liftmesh.crs.description import look_up, parse_crs
from liftmesh.errors import DataWarning, FormatError, InputError, MissingDependencyError
from liftmesh.io.markup import parsed
from liftmesh.vector.geopackage import MAGIC as GEOPACKAGE, read_geopackage
from liftmesh.vector.shapefile import MAGIC as SHAPEFILE, read_shapefile

_STANDARD = "EPSG:4326"  # of GeoJSON that names no other
_MOST_DEGREES = np.array([360.0, 180.0])  # twice those of x and y
_TEXT = {".geojson", ".json", ""}
_MARK = b"\xef\xbb\xbf"


def read_features(path: Path, what: str) -> dict[str, Any]:
    """Read the geometries of a file, and the values that they have."""
    with path.open("rb") as stream:
        head = stream.read(len(GEOPACKAGE))
        data = b"" if head == GEOPACKAGE else head + stream.read()
    if head == GEOPACKAGE:
        return _with_system(*read_geopackage(path), path)
    if data.startswith(SHAPEFILE):
        return _with_system(*read_shapefile(path, data), path)
    text = data.removeprefix(_MARK)
    if path.suffix.lower() in _TEXT or text.lstrip()[:1] == b"{":
        return _geojson(path, text)
    raise FormatError(
        f"{path}: cannot be read as {what}: neither GeoJSON nor a GeoPackage nor a shapefile (.shp)"
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
