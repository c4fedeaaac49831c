"""Geometries of files that geopandas reads: GeoPackage, GeoJSON, shapefiles and others."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

from liftmesh.errors import FormatError
from liftmesh.optional import load


def read_features(path: Path, what: str) -> Any:
    """Read the geometries of a file, and the values that they have.

    Parameters
    ----------
    path : Path
        Any file that geopandas reads.
    what : str
        What it is read as, for errors.

    Returns
    -------
    geopandas.GeoDataFrame
        The geometries, with their values and coordinate system; nothing if the file is a table
        without any.

    Raises
    ------
    FormatError
        The file cannot be read.
    MissingDependencyError
        geopandas is missing.
    OSError
        The file cannot be opened.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp(), "point.geojson")
    >>> _ = path.write_text('{"type": "Point", "coordinates": [1, 2]}')
    >>> float(read_features(path, "a place").geometry.x[0])
    1.0
    """
    path.open("rb").close()  # says what is wrong in fewer words
    geopandas = load("geopandas", extra="shapes")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # GDAL's, before its errors
            table = geopandas.read_file(path)
    except Exception as error:  # of whatever kind GDAL's reader makes
        first = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise FormatError(f"{path}: cannot be read as {what}: {first}") from error
    return table if "geometry" in table else geopandas.GeoDataFrame(geometry=[])
