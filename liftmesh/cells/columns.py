"""Columns of values that go with cells: one value for each row, under names that stay the caller's.

Cells have columns of their own, such as ``area``. Where the caller has one of that name, ours is
called ``cell_area``: no value is replaced.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from liftmesh._typing import Array
from liftmesh.base.options import counted, shown
from liftmesh.crs.comparison import common_system, given_system, system_of
from liftmesh.errors import InputError
from liftmesh.optional import load


def free_name(name: str, taken: Iterable[Any]) -> str:
    """Return a name for a column of ours that no other column has, in any letters."""
    others = {str(each).casefold() for each in taken}
    while name.casefold() in others:
        name = f"cell_{name}"
    return name


def plain_columns(columns: Mapping[str, Array]) -> tuple[dict[str, Array], tuple[str, ...]]:
    """Convert the values of rows to what files of polygons hold: one number or text each."""
    kept: dict[str, Array] = {}
    dropped = []
    for name, given in columns.items():
        values = _plain(given)
        width = math.prod(given.shape[1:])
        if values is None or not width:
            dropped.append(f"{name} ({given.dtype if width else 'no values'})")
            continue
        names = [name] if given.ndim == 1 else [f"{name}_{k}" for k in range(width)]
        if taken := kept.keys() & {*names}:
            raise InputError(f"two columns are named {min(taken)!r}: rename one")
        kept |= zip(names, values.reshape(len(given), width).T, strict=True)
    return kept, tuple(dropped)


def _plain(values: Array) -> Array | None:
    if values.dtype.kind in "biuU":
        return values
    if values.dtype.kind != "f":
        return None
    with np.errstate(all="ignore"):
        doubles = values.astype(np.float64)
    return doubles if np.array_equal(doubles, values, equal_nan=True) else None


def frame_of(data: Any, rows: int) -> Any:
    """Convert values of rows to a DataFrame, without a geometry."""
    pandas = load("pandas", extra="shapes")
    if isinstance(data, pandas.DataFrame):
        _check_length("data", len(data), rows)
        return pandas.DataFrame(data.drop(columns=_geometry_of(data)))
    if data is not None and not isinstance(data, Mapping) and not hasattr(data, "columns"):
        raise InputError(f"data is {shown(data)}: give a mapping of names to values, or a table")
    names = getattr(data, "columns", () if data is None else data)
    found = {name: _values(name, data[name], rows) for name in names}
    return pandas.DataFrame(found, index=pandas.RangeIndex(rows))


def _geometry_of(data: Any) -> list[Any]:
    """The column that is the geometry of a GeoDataFrame."""
    name = getattr(data, "active_geometry_name", None)
    return [] if name is None else [name]


def common_crs(data: Any, crs: Any, cells: str | None = None) -> Any:
    """Return the coordinate system that is given, or that of a table or of cells with one."""
    wanted = None if crs is None else given_system(crs)
    own = system_of(data) if _geometry_of(data) else None
    found = common_system(own, wanted, ("data", "crs"))
    return common_system(found, cells, ("data or crs", "the cells"))


def _values(name: Any, given: Any, rows: int) -> Any:
    if isinstance(given, str | bytes) or not hasattr(given, "__len__"):
        raise InputError(f"column {name!r} is {shown(given)}: give a value for each row")
    _check_length(f"column {name!r}", len(given), rows)
    values = getattr(given, "array", given)  # of a Series, without its index
    if np.ndim(values) > 1:
        raise InputError(f"column {name!r} has the shape {np.shape(values)}: give a value each")
    return values


def _check_length(what: str, count: int, rows: int) -> None:
    if count != rows:
        raise InputError(
            f"{what} has {counted(count, 'value')} for {counted(rows, 'row')}: give one for each"
        )
