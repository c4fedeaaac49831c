"""Cells as a GeoPackage, by geopandas."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from liftmesh._typing import Array
from liftmesh.cells.columns import free_name
from liftmesh.crs.description import looked_up
from liftmesh.errors import FormatError, InputError
from liftmesh.optional import load
from liftmesh.vector.geopackage import write_shapes

if TYPE_CHECKING:
    from liftmesh.cells.clipped import ClippedCells

_MOST = np.iinfo(np.int64).max


def write_geopackage(
    stream: BinaryIO, cells: ClippedCells, columns: Mapping[str, Array], crs: str | None = None
) -> tuple[str, ...]:
    """Write cells as one layer: a writer of `files.write_cells`."""
    _check_names(columns)
    shapes = cells.to_shapely()
    shapes[cells.empty] = None
    values = {name: _signed(name, column) for name, column in columns.items()}
    system = _known(crs)
    names = {"FID": free_name("fid", columns), "GEOMETRY_NAME": free_name("geom", columns)}
    write_shapes(stream, shapes, values, system, "cells", **names)
    return ("crs",) if crs is not None and system is None else ()


def _check_names(columns: Mapping[str, Array]) -> None:
    name, count = Counter(map(str.casefold, columns)).most_common(1)[0] if columns else ("", 0)
    if count > 1:
        both = " and ".join(repr(each) for each in columns if each.casefold() == name)
        raise FormatError(f"a GeoPackage takes columns {both} for one: rename one")


def _signed(name: str, values: Array) -> Array:
    if values.dtype != np.uint64:
        return values
    if values.max(initial=0) > _MOST:
        raise FormatError(
            f"column {name!r} has the value {values.max()}: a GeoPackage has no integers beyond "
            "2**63"
        )
    return values.astype(np.int64)


def _known(crs: str | None) -> str | None:
    try:
        return crs if crs is None or looked_up(load("pyproj", extra="shapes"), crs) else None
    except InputError:
        return None
