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
    """Write a layer of lines."""
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
    """Write a layer of geometries of any kind."""
    load("pyogrio", extra="shapes")  # geopandas imports it only when it writes
    geopandas = load("geopandas", extra="shapes")
    system = None if crs is None else looked_up(load("pyproj", extra="shapes"), crs)
    frame = geopandas.GeoDataFrame(dict(columns), geometry=shapes, crs=system)
    content = io.BytesIO()
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", ".*'crs' was not provided", UserWarning)
        frame.to_file(content, driver="GPKG", layer=layer, engine="pyogrio", **options)
    stream.write(content.getbuffer())
