"""Grids of heights in memory: `Raster`, DataArrays of xarray, and arrays with a transform.

Each value that is a number becomes a row at the centre of its pixel, as of a GeoTIFF. xarray is not
imported: its grids are known by the name of their class.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.arrays import as_floats, unmasked, widened
from liftmesh.base.cloud import Cloud, is_crs
from liftmesh.base.options import counted, refused
from liftmesh.errors import InputError, Option
from liftmesh.io.metadata import Unread, noted
from liftmesh.io.objects.plain import is_array, qualified_name
from liftmesh.io.options import as_missing
from liftmesh.raster.pixels import centres_of, layout_of
from liftmesh.raster.raster import Raster

_SYSTEMS = ("crs_wkt", "spatial_ref")  # attributes of a variable that says where a grid is


def to_cloud(source: Any) -> Cloud:
    """Convert a grid to rows."""
    return _of_raster(source) if isinstance(source, Raster) else _of_xarray(source)


def with_options(source: Any, given: Mapping[str, Any]) -> Cloud:
    """Convert an array of heights, whose places a transform says."""
    others = [name for name in given if name not in ("transform", "nodata")]
    if others:
        raise InputError(
            f"{Option('transform', ...)} is for a grid, and {Option(others[0], ...)} for a table"
        )
    if not is_array(source):
        raise InputError(
            f"{Option('transform', ...)} goes with an array, not with a {qualified_name(source)}"
        )
    heights = _heights(source)
    for missing in as_missing(given.get("nodata")) or ():
        heights = np.where(heights == missing, np.nan, heights)
    layout = layout_of(None, None, given["transform"], heights.shape, lambda: ())
    places = centres_of(layout.transform, range(layout.rows), layout.columns)
    return _cloud(places[..., 0], places[..., 1], heights, None, {})


def _of_raster(raster: Raster) -> Cloud:
    if raster.quantity != "height":
        raise InputError(f"a Raster of {raster.quantity} is no grid of heights: give one of these")
    unit = {} if raster.unit is None else {"unit": raster.unit}
    rows, columns = raster.values.shape
    places = centres_of(raster.transform, range(rows), columns)
    return _cloud(places[..., 0], places[..., 1], raster.values, raster.crs, unit)


def _of_xarray(grid: Any) -> Cloud:
    """Take x from the coordinates of the last dimension, and y from those of the one before."""
    squeezed = grid.squeeze(drop=False)  # a band
    if squeezed.ndim != 2:
        raise InputError(
            f"a DataArray of the dimensions {', '.join(map(str, grid.dims))} is no grid of "
            "heights: choose one, as grid.isel(band=0)"
        )
    across, along = (_positions(squeezed, name) for name in reversed(squeezed.dims))
    x, y = np.meshgrid(across, along)
    heights = _heights(squeezed.values)
    fill = grid.attrs.get("_FillValue")
    if isinstance(fill, int | float | np.number):
        heights = np.where(heights == fill, np.nan, heights)
    unit = grid.attrs.get("units")
    return _cloud(x, y, heights, _system_of(grid), {"unit": unit} if isinstance(unit, str) else {})


def _positions(grid: Any, name: Any) -> Floats:
    if name not in grid.coords:
        raise InputError(f"the dimension {name!r} of a DataArray has no coordinates: assign them")
    values = np.asarray(grid.coords[name].values)
    if values.dtype.kind not in "iuf":
        raise InputError(f"the coordinates of the dimension {name!r} are no numbers")
    return values.astype(np.float64)


def _system_of(grid: Any) -> str | None:
    """Return the system that a variable of the conventions of CF states, as rioxarray writes it."""
    variable = grid.coords.get(grid.encoding.get("grid_mapping", "spatial_ref"))
    stated: Mapping[str, Any] = {} if variable is None else variable.attrs
    texts = (stated.get(each) for each in _SYSTEMS)
    return next((each for each in texts if isinstance(each, str) and is_crs(each)), None)


def _heights(values: Any) -> Floats:
    array: Array = np.asanyarray(values)
    if array.ndim != 2 or array.dtype.kind not in "iufb":
        raise refused("transform", array.shape, "goes with an array (rows, columns) of heights")
    return widened(as_floats(unmasked(array)))


def _cloud(x: Floats, y: Floats, heights: Array, crs: str | None, entries: dict[str, Any]) -> Cloud:
    """Make rows of the heights that are numbers, row by row."""
    is_known = ~np.isnan(heights)
    missing = heights.size - int(is_known.sum())
    unread = (f"{counted(missing, 'sample')} without a value",) if missing else ()
    return Cloud(
        np.stack([x[is_known], y[is_known], heights[is_known]], axis=1),
        metadata=noted({"raster": entries} if entries else {}, not_read=Unread(unread)),
        crs=crs,
    )
