"""Lines of files of shapes: GeoJSON, GeoPackage and shapefiles.

They are lines in the plane: heights of corners, which GeoJSON allows, are left out.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from liftmesh._typing import Floats
from liftmesh.base.arrays import as_pairs, as_reals
from liftmesh.base.options import shown
from liftmesh.errors import FormatError, InputError
from liftmesh.vector.files import read_shapes
from liftmesh.vector.geojson import coordinates_of


def lines_of(path: Path, crs: str | None) -> list[Floats]:
    """Read the lines of a file, which has to be in the system of a surface."""
    tree = read_shapes(path, "lines", crs)
    try:
        found = [_line(each) for each in coordinates_of(tree, "LineString")]
    except (TypeError, AttributeError, RecursionError) as error:
        raise FormatError(f"{path}: no GeoJSON: a line has type and coordinates") from error
    except InputError as error:
        raise FormatError(f"{path}: {error}") from error
    if not found:
        raise FormatError(f"{path}: there is no LineString or MultiLineString in it")
    return found


def _line(corners: Any) -> Floats:
    try:
        array = as_reals(corners)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"a line cannot be read: {shown(corners)}") from error
    if array.ndim != 2 or array.shape[1] not in (2, 3) or len(array) < 2:
        raise InputError(f"a line needs two corners x, y or more, not the shape {array.shape}")
    if not np.isfinite(array).all():
        raise InputError("a corner of a line is not finite")
    return as_pairs(array[:, :2])
