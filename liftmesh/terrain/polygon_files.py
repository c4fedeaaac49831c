"""Polygons from files and objects, in the coordinate system of a surface."""

from __future__ import annotations

import os
from pathlib import Path

from liftmesh.errors import FormatError, InputError
from liftmesh.terrain.polygons import Polygon, Region, as_regions
from liftmesh.terrain.shape_files import check_system, read_shapes


def polygons_in(crs: str | None, polygon: object) -> list[Polygon]:
    """Convert what is given to polygons, and see that they are in the system of a surface."""
    return [each for region in regions_in(crs, polygon) for each in region.polygons]


def regions_in(crs: str | None, polygon: object) -> list[Region]:
    """Convert what is given to regions, and see that they are in the system of a surface."""
    if not isinstance(polygon, str | os.PathLike):
        check_system(crs, polygon, "the polygon")
        return as_regions(polygon)
    path = Path(polygon)
    shapes = read_shapes(path, "polygons", crs)
    try:
        return as_regions(shapes)
    except InputError as error:
        raise FormatError(f"{path}: {error}") from error
