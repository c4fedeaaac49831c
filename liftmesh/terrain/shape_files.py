"""Files of polygons, lines and points, and the coordinate systems that shapes say they are in.

GeoJSON is read here; any other kind of file is left to geopandas. Old GeoJSON names its system in
the member ``crs``; without it, coordinates are taken to be those of the surface.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from liftmesh.choices import shown
from liftmesh.errors import FormatError, InputError
from liftmesh.io.geometry_files import read_features
from liftmesh.same_crs import are_different

_TEXT = {".geojson", ".json", ""}


def read_shapes(path: Path, what: str, crs: str | None, *, columns: bool = False) -> Any:
    """Read a file, and see that it is in the system of a surface.

    Parameters
    ----------
    path : Path
        GeoJSON, or anything that geopandas reads.
    what : str
        What it is read as, for errors.
    crs : str, optional
        The system of the surface.
    columns : bool
        Whether a table of geopandas keeps all that it says of its rows, not the names alone.

    Returns
    -------
    dict or object with ``__geo_interface__``
        The tree of GeoJSON, or a table of geopandas, with the names of its rows if it has them.

    Raises
    ------
    InputError
        The systems are known to differ.
    FormatError
        The file cannot be read.
    MissingDependencyError
        Files other than GeoJSON need geopandas.
    OSError
        The file cannot be opened.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp(), "point.geojson")
    >>> _ = path.write_text('{"type": "Point", "coordinates": [1, 2]}')
    >>> read_shapes(path, "a place", None)["coordinates"]
    [1, 2]
    """
    if path.suffix.lower() in _TEXT:
        tree: Any = _geojson(path)
    else:
        tree = read_features(path, what) if columns else _frame(path, what)
    check_system(crs, tree, str(path))
    return tree


def check_system(own: str | None, shapes: object, name: str) -> None:
    """Raise if shapes are known to be in another system than the surface.

    Parameters
    ----------
    own : str, optional
        The system of the surface.
    shapes : object
        A tree of GeoJSON, an object of geopandas, or anything else, which says nothing.
    name : str
        What the shapes are called in the message.

    Raises
    ------
    InputError
        The systems differ.

    Examples
    --------
    >>> check_system("EPSG:25832", [[0, 0], [1, 1]], "the line")
    """
    stated = stated_system(shapes)
    if are_different(own, stated):
        raise InputError(f"{name} is in {shown(stated)}, the surface in {shown(own)}: transform it")


def stated_system(shapes: object) -> str | None:
    """Return the system that shapes say they are in.

    Parameters
    ----------
    shapes : object
        As for `check_system`.

    Returns
    -------
    str or None
        WKT or a name; None if they say none.

    Examples
    --------
    >>> stated_system({"crs": {"type": "name", "properties": {"name": "EPSG:25832"}}})
    'EPSG:25832'
    """
    if isinstance(shapes, Mapping):
        system = shapes.get("crs")
        properties = system.get("properties") if isinstance(system, Mapping) else None
        name = properties.get("name") if isinstance(properties, Mapping) else None
        if not isinstance(name, str):
            return None
        return "EPSG:4326" if name.upper().endswith("CRS84") else name
    held: Any = getattr(shapes, "crs", None)
    return str(held.to_wkt()) if hasattr(held, "to_wkt") else None


def _geojson(path: Path) -> dict[str, Any]:
    try:
        tree = json.loads(path.read_bytes().decode("utf-8-sig"))
    except (ValueError, RecursionError) as error:
        raise FormatError(f"{path}: not GeoJSON: {error}") from error
    return tree if isinstance(tree, dict) else {}


def _frame(path: Path, what: str) -> Any:
    """Read a file of another kind, such as GeoPackage, with the names of its rows."""
    table = read_features(path, what)
    return table if "name" in table else table.geometry
