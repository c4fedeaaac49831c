"""A domain that is a file: the union of its polygons, and their coordinate system."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from liftmesh.cells.domain import united
from liftmesh.errors import InputError
from liftmesh.io.geometry_files import read_features
from liftmesh.same_crs import text_of

_DEGREES = np.array([180.0, 90.0])


def read_domain(path: Path) -> tuple[Any, str | None]:
    """Read the polygons of a file.

    Parameters
    ----------
    path : Path
        Any file that geopandas reads.

    Returns
    -------
    shape : shapely.Geometry
        The union of all polygons.
    crs : str or None
        Their coordinate system. That of a GeoJSON file is degrees by the standard; if its
        coordinates are none, and it says nothing else, it is not known.

    Raises
    ------
    FormatError
        The file cannot be read.
    InputError
        There are no polygons in it, or something else too, or a polygon is not valid.
    MissingDependencyError
        geopandas is missing.
    OSError
        The file cannot be opened.
    """
    shapes = read_features(path, "a domain").geometry
    try:
        shape = united(shapes.to_numpy())
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    return shape, _system(shapes.crs, shape)


def _system(crs: Any, shape: Any) -> str | None:
    if crs is None or (crs.is_geographic and not _is_degrees(shape.bounds)):
        return None
    return text_of(crs)


def _is_degrees(bounds: tuple[float, ...]) -> bool:
    return bool((np.abs(np.reshape(bounds, (2, 2))) <= 2 * _DEGREES).all())
