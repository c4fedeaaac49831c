"""Polygons from files and objects, in the coordinate system of a surface."""

from __future__ import annotations

import os
from pathlib import Path

from liftmesh.errors import FormatError, InputError
from liftmesh.terrain.polygons import Polygon, Region, as_regions
from liftmesh.terrain.shape_files import check_system, read_shapes


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
        Polygons of a shapefile that have several rings need shapely.
    OSError
        The file cannot be opened.

    Examples
    --------
    >>> square = {"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [1, 1], [0, 1]]]}
    >>> len(polygons_in(None, square))
    1
    """
    return [each for region in regions_in(crs, polygon) for each in region.polygons]


def regions_in(crs: str | None, polygon: object, by: str = "name") -> list[Region]:
    """Convert what is given to regions, and see that they are in the system of a surface.

    Parameters
    ----------
    crs : str, optional
        The system of the surface.
    polygon : object
        A file, or as for `as_regions`.
    by : str
        As for `as_regions`.

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
        check_system(crs, polygon, "the polygon")
        return as_regions(polygon, by)
    path = Path(polygon)
    shapes = read_shapes(path, "polygons", crs)
    try:
        return as_regions(shapes, by)
    except InputError as error:
        raise FormatError(f"{path}: {error}") from error
