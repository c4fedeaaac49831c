"""Files of polygons, lines and points, and the coordinate systems that shapes say they are in.

Old GeoJSON names its system in the member ``crs``, and so do the trees of other files; without it,
coordinates are taken to be those of the surface.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from liftmesh.choices import shown
from liftmesh.errors import InputError
from liftmesh.io.geometry_files import read_features, stated_system
from liftmesh.same_crs import are_different


def read_shapes(path: Path, what: str, crs: str | None) -> dict[str, Any]:
    """Read a file, and see that it is in the system of a surface.

    Parameters
    ----------
    path : Path
        GeoJSON, a GeoPackage or a shapefile.
    what : str
        What it is read as, for errors.
    crs : str, optional
        The system of the surface.

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
        Polygons of a shapefile that have several rings need shapely.
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
    tree = read_features(path, what)
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
