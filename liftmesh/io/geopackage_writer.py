"""GeoPackage of lines and other shapes, which geopandas writes.

The file is made in memory, since the database behind it cannot be written to a stream.
"""

from __future__ import annotations

import io
import warnings
from collections.abc import Mapping
from typing import BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.crs import looked_up
from liftmesh.optional import load


def write(
    stream: BinaryIO,
    points: Floats,
    starts: Array,
    columns: Mapping[str, Array],
    crs: str | None,
    layer: str,
) -> None:
    """Write a layer of lines.

    Parameters
    ----------
    stream : binary file
        Where to write.
    points : (n, 2) ndarray of float64
        The points of all lines, one after the other.
    starts : (k + 1,) ndarray of int
        Where each line begins, and where the last ends.
    columns : mapping of str to (k,) ndarray
        The properties.
    crs : str, optional
        WKT or a number.
    layer : str
        The name of the layer.

    Raises
    ------
    InputError
        The coordinate system is unknown.
    MissingDependencyError
        geopandas or pyogrio, by which it writes, is not installed.

    Examples
    --------
    >>> file = io.BytesIO()
    >>> line = np.array([[0.0, 1.0], [2.0, 3.0]])
    >>> write(file, line, np.array([0, 2]), {"height": np.array([5.0])}, "EPSG:25832", "contours")
    >>> file.getvalue()[:6]
    b'SQLite'
    """
    shapely = load("shapely", extra="shapes")
    counts = np.diff(starts)
    lines = shapely.linestrings(points, indices=np.repeat(np.arange(len(counts)), counts))
    write_shapes(stream, lines, columns, crs, layer)


def write_shapes(
    stream: BinaryIO,
    shapes: Array,
    columns: Mapping[str, Array],
    crs: str | None,
    layer: str,
    **options: str,
) -> None:
    """Write a layer of geometries of any kind.

    Parameters
    ----------
    stream : binary file
        Where to write.
    shapes : (k,) ndarray of shapely.Geometry or None
        The geometries.
    columns : mapping of str to (k,) ndarray
        The properties.
    crs : str, optional
        WKT or a number.
    layer : str
        The name of the layer.
    **options : str
        Options of GDAL's driver, such as the names of its own columns.

    Raises
    ------
    InputError
        The coordinate system is unknown.
    MissingDependencyError
        geopandas or pyogrio, by which it writes, is not installed.

    Examples
    --------
    >>> import shapely
    >>> file = io.BytesIO()
    >>> write_shapes(file, np.array([shapely.Point(1, 2)]), {}, "EPSG:25832", "places")
    >>> file.getvalue()[:6]
    b'SQLite'
    """
    load("pyogrio", extra="shapes")  # geopandas imports it only when it writes
    geopandas = load("geopandas", extra="shapes")
    system = None if crs is None else looked_up(load("pyproj", extra="shapes"), crs)
    frame = geopandas.GeoDataFrame(dict(columns), geometry=shapes, crs=system)
    content = io.BytesIO()
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", ".*'crs' was not provided", UserWarning)
        frame.to_file(content, driver="GPKG", layer=layer, engine="pyogrio", **options)
    stream.write(content.getbuffer())
