"""Polygons from files, and the coordinate systems that files and objects say of them.

GeoJSON is read here; any other kind of file is left to geopandas. Old GeoJSON names its system in
the member ``crs``; without it, coordinates are taken to be those of the surface.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from liftmesh.choices import shown
from liftmesh.errors import FormatError, InputError
from liftmesh.io.geometry_files import read_features
from liftmesh.same_crs import are_different
from liftmesh.terrain.polygons import Polygon, Region, as_regions

_TEXT = {".geojson", ".json", ""}


def polygons_in(crs: str | None, polygon: object) -> list[Polygon]:
    """Convert what is given to polygons, and see that they are in the system of a surface.

    Parameters
    ----------
    crs : str, optional
        The system of the surface.
    polygon : object
        A file, or as for `as_polygons`.

    Returns
    -------
    list of list of (k, 2) ndarray of float64
        For each polygon its rings.

    Raises
    ------
    InputError
        It holds no polygon, a corner is not finite, or the systems are known to differ.
    FormatError
        A file cannot be read, or holds no polygon.
    MissingDependencyError
        Files other than GeoJSON need geopandas.
    OSError
        The file cannot be opened.

    Examples
    --------
    >>> square = {"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 1]]]}
    >>> len(polygons_in(None, square))
    1
    """
    return [each for region in regions_in(crs, polygon) for each in region.polygons]


def regions_in(crs: str | None, polygon: object) -> list[Region]:
    """Convert what is given to regions, and see that they are in the system of a surface.

    Parameters
    ----------
    crs : str, optional
        The system of the surface.
    polygon : object
        A file, or as for `as_regions`.

    Returns
    -------
    list of Region
        The features of a file or collection, the rows of a table, or all in one.

    Raises
    ------
    InputError, FormatError, MissingDependencyError, OSError
        As for `polygons_in`.

    Examples
    --------
    >>> regions_in(None, [[0, 0], [1, 0], [1, 1]])[0].name
    0
    """
    if not isinstance(polygon, str | os.PathLike):
        _check_system(crs, _stated(polygon), "the polygon")
        return as_regions(polygon)
    path = Path(polygon)
    tree = _geojson(path) if path.suffix.lower() in _TEXT else _frame(path)
    _check_system(crs, _stated(tree), str(path))
    try:
        return as_regions(tree)
    except InputError as error:
        raise FormatError(f"{path}: {error}") from error


def _geojson(path: Path) -> dict[str, Any]:
    try:
        tree = json.loads(path.read_bytes().decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise FormatError(f"{path}: not GeoJSON: {error}") from error
    return tree if isinstance(tree, dict) else {}


def _frame(path: Path) -> Any:
    """Read a file of another kind, such as GeoPackage, with the names of its rows."""
    table = read_features(path, "polygons")
    return table if "name" in table else table.geometry


def _stated(polygon: object) -> str | None:
    """Return the system that GeoJSON or an object of geopandas says; None if it says none."""
    if isinstance(polygon, Mapping):
        system = polygon.get("crs")
        properties = system.get("properties") if isinstance(system, Mapping) else None
        name = properties.get("name") if isinstance(properties, Mapping) else None
        if not isinstance(name, str):
            return None
        return "EPSG:4326" if name.upper().endswith("CRS84") else name
    held: Any = getattr(polygon, "crs", None)
    return str(held.to_wkt()) if hasattr(held, "to_wkt") else None


def _check_system(own: str | None, stated: str | None, name: str) -> None:
    if are_different(own, stated):
        raise InputError(f"{name} is in {shown(stated)}, the surface in {shown(own)}: transform it")
