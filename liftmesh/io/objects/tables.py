"""Tables in memory: DataFrames, structured arrays, laspy's points, and arrays with named columns.

They are read by the names of their columns, like the same table as text (`table_columns`), and
refused for the same reasons. Values keep their types: text, dates and other objects are left out
and named. Libraries are recognised by the names of their classes and never imported.
"""

from __future__ import annotations

import numbers
from collections.abc import Mapping
from decimal import Decimal
from typing import Any

import numpy as np

from liftmesh import arrays
from liftmesh._typing import Array, Floats
from liftmesh.cloud import Cloud
from liftmesh.errors import FormatError, InputError, UnsupportedTypeError
from liftmesh.interruption import kept
from liftmesh.io.colors import fits_eight_bits, recognized
from liftmesh.io.columns import ALPHA, COLOR, NORMAL, POSITION
from liftmesh.io.objects.plain import is_array, qualified_name
from liftmesh.io.table_columns import Columns, understood, unnamed
from liftmesh.io.table_doubts import Doubts
from liftmesh.io.table_options import TableOptions, checked

_FRAMES = {("pandas", "DataFrame"), ("polars", "DataFrame")}
_RECORDS = {("laspy", "LasData"), ("laspy", "ScaleAwarePointRecord")}
_CONVERSIONS = ("collect", "compute", "to_pandas", "to_dataframe")
_OPTIONS = ("columns", "flat", "nodata")
_WHERE = "the table"


def is_table(source: object) -> bool:
    """Whether an object is a table whose columns have names."""
    return _is_structured(source) or bool(_classes(source) & (_FRAMES | _RECORDS))


def is_other_table(source: object) -> bool:
    """Whether an object looks like a table, but not like one that `to_cloud` takes."""
    kind = type(source)  # whose attributes cost nothing to look up
    named = any(hasattr(kind, name) for name in ("columns", "column_names", "colnames"))
    is_class = isinstance(source, type)
    return isinstance(source, Mapping) or (named and hasattr(kind, "__getitem__") and not is_class)


def refuse(source: object) -> Cloud:
    """Raise for a table of another library, and say how to make one that is read."""
    found = next((name for name in _CONVERSIONS if hasattr(source, name)), None)
    how = f"what its {found}() returns, " if found else ""
    raise UnsupportedTypeError(
        f"a {qualified_name(source)} is a table, but not one that is read: give {how}a pandas or "
        "polars DataFrame, or np.column_stack([x, y, z]) of its columns"
    )


def to_cloud(source: Any, options: TableOptions | None = None) -> Cloud:
    """Convert a table to a cloud, by the names of its columns.

    Parameters
    ----------
    source : DataFrame, structured array, laspy points, or (n, k) array_like
        Anything that `is_table` accepts, or rows whose columns the options name.
    options : TableOptions, optional
        What the caller says about it.

    Returns
    -------
    Cloud
        The rows in their order; ``metadata["columns"]`` says which columns are what.

    Raises
    ------
    InputError
        The columns cannot be told, or a coordinate is no number.

    Examples
    --------
    >>> table = np.array([(1.0, 2.0, 5.0)], dtype=[("E", "f8"), ("N", "f8"), ("H", "f8")])
    >>> to_cloud(table).metadata["columns"]
    {'x': 'E', 'y': 'N', 'z': 'H'}
    """
    options = options or TableOptions()
    values, described = _opened(source)
    try:
        return _cloud(values, options, described)
    except FormatError as error:  # of the rooms for files
        raise InputError(str(error)) from error


def with_options(source: Any, given: Mapping[str, Any]) -> Cloud:
    """Convert a table or an array of rows, with the options of a caller.

    Parameters
    ----------
    source : object
        The table.
    given : mapping
        Options of `liftmesh.read`; those about text are none for a table in memory.

    Returns
    -------
    Cloud
        As `to_cloud` makes it.

    Raises
    ------
    InputError
        An option is unknown or invalid, or the object is no table.

    Examples
    --------
    >>> with_options([[7, 0, 1, 5.5]], {"columns": "id,x,y,z"}).attributes["id"].tolist()
    [7.0]
    """
    unknown = [name for name in given if name not in _OPTIONS]
    if unknown:
        raise InputError(f"{unknown[0]}= is for files: an object takes {', '.join(_OPTIONS)}")
    if not is_table(source) and not is_array(source):
        raise InputError(
            f"{', '.join(f'{name}=' for name in given)} cannot be given: a "
            f"{qualified_name(source)} has no columns"
        )
    with kept():
        return to_cloud(source, checked(**given))


def _opened(source: Any) -> tuple[list[tuple[str, Any]], dict[str, Any]]:
    """Return the columns of a table with their names, and what else it says."""
    if _is_structured(source):
        return [(name, source[name]) for name in source.dtype.names], {}
    found = _classes(source)
    if found & _RECORDS:
        return _of_laspy(source)
    if ("polars", "DataFrame") in found:
        return [(name, source[name].to_numpy()) for name in source.columns], {}
    if found & _FRAMES:
        return [(str(name), source.iloc[:, k]) for k, name in enumerate(source.columns)], {}
    rows = np.asanyarray(source)
    if rows.ndim != 2:
        raise InputError(f"columns= names the columns of a table, not of the shape {rows.shape}")
    return [("", column) for column in rows.T], {}


def _of_laspy(source: Any) -> tuple[list[tuple[str, Any]], dict[str, Any]]:
    """Return scaled coordinates in place of the whole numbers that LAS stores."""
    names = [name for name in source.point_format.dimension_names if name not in {"X", "Y", "Z"}]
    columns = [(name, getattr(source, name)) for name in POSITION]
    columns += [(name, source[name]) for name in names]
    records = getattr(getattr(source, "header", None), "vlrs", ())
    systems = [getattr(each, "string", "") for each in records if "Wkt" in type(each).__name__]
    system = next((each.strip("\0 ") for each in systems if each.strip("\0 ")), None)
    return columns, {"crs": system}


def _cloud(values: list[tuple[str, Any]], options: TableOptions, described: Any) -> Cloud:
    """Make a cloud of columns, once their names and types are understood."""
    columns = _named([name for name, _ in values], options, bool(described))
    read = {k: _as_numbers(values[k][1]) for k in range(len(values)) if k not in columns.left_out}
    found = {columns.names[k]: each for k, each in read.items() if each is not None}
    unread = [_unread(columns, k, values[k][1]) for k in range(len(values)) if read.get(k) is None]
    if not options.names_all:
        columns.check_height(list(found), _WHERE)
    points = _points(found, columns, options, len(values[0][1]))
    columns.warn()
    parts = {"columns": columns.mapping(), "notes": columns.notes, "skipped": tuple(unread)}
    return Cloud(
        points,
        colors=_colors(found),
        normals=_stacked(found, NORMAL),
        attributes={k: _without_nodata(each, options) for k, each in found.items()},
        metadata={name: part for name, part in parts.items() if part},
        crs=described.get("crs"),
    )


def _named(names: list[str], options: TableOptions, has_coordinates: bool) -> Columns:
    if not any(names):
        return unnamed(len(names), options, _WHERE)
    if has_coordinates and not options.chosen and options.names is None:
        options = TableOptions(
            chosen={each: each for each in POSITION}, missing=options.missing, flat=options.flat
        )
    return understood(names, options, _WHERE)


def _unread(columns: Columns, k: int, values: Any) -> str:
    name = f"column {columns.given[k]}"
    return name if k in columns.left_out else f"{name} ({getattr(values, 'dtype', 'no numbers')})"


def _points(found: dict[str, Array], columns: Columns, options: TableOptions, rows: int) -> Floats:
    """Remove and return the coordinates."""
    points = np.zeros((rows, 3))
    parts = [each for each in POSITION if each in columns.names]
    for part in parts:
        if part not in found or found[part].ndim != 1:
            name = columns.given[columns.names.index(part)]
            raise FormatError(f"{_WHERE}: {part} is the column {name!r}, which holds no numbers")
        points[:, POSITION.index(part)] = _without_nodata(_exact(found.pop(part)), options)
    if columns.negated is not None:
        points[:, 2] = 0.0 - points[:, 2]
    doubts = Doubts(_WHERE, Columns(tuple(parts), tuple(parts)), options)
    doubts.examine(points[:, : len(parts)])
    doubts.check()
    return points


def _exact(values: Array) -> Floats:
    """Convert a column to float64; raise for a number that it cannot hold."""
    if values.itemsize < 8 or values.dtype == np.float64:
        return values.astype(np.float64)
    pairs = np.column_stack([values, values])
    return np.asarray(arrays.as_coordinates(pairs)[:, 0], dtype=np.float64)


def _as_numbers(values: Any) -> Array | None:
    """Return a column as numbers; None if it holds anything else."""
    if isinstance(values, np.ma.MaskedArray):
        values = _unmasked(values)
    array = np.asarray(values)
    if array.dtype.kind == "O":
        return _of_objects(array)
    if array.dtype.kind == "b":
        return array.astype(np.uint8)
    return array if array.dtype.kind in "iuf" and not array.dtype.names else None


def _unmasked(values: np.ma.MaskedArray[Any, Any]) -> Array:
    """Return the values, NaN where they are masked."""
    if not np.ma.is_masked(values) or values.dtype.kind not in "iufb":
        return np.asarray(values.data)
    return np.where(np.ma.getmaskarray(values), np.nan, _exact(np.asarray(values.filled(0))))


def _of_objects(array: Array) -> Floats | None:
    """Convert objects if all are numbers, or missing."""
    numbers_only = all(_is_missing(each) or _is_number(each) for each in array.flat)
    if not numbers_only or array.ndim != 1:
        return None
    floats = [np.nan if _is_missing(each) else float(each) for each in array]
    return np.array(floats, dtype=np.float64)


def _is_missing(value: object) -> bool:
    return value is None or type(value).__name__ == "NAType"


def _is_number(value: object) -> bool:
    return isinstance(value, numbers.Real | Decimal) and not isinstance(value, bool)


def _without_nodata(values: Array, options: TableOptions) -> Array:
    """Replace the caller's missing value by NaN."""
    for missing in options.missing or ():
        if isinstance(missing, float) and (values == missing).any():
            values = np.where(values == missing, np.nan, values)
    return values


def _colors(found: dict[str, Array]) -> Array | None:
    """Remove and return the colours; columns that cannot be colours stay attributes."""
    names = (*COLOR, ALPHA) if ALPHA in found else COLOR
    rest = dict(found)
    values = _stacked(rest, names)
    if values is not None and values.dtype.kind != "u" and not _are_shades(values):
        values = recognized(values.astype(np.float64))
    if values is not None:
        for name in names:
            del found[name]
    return values


def _are_shades(values: Array) -> bool:
    """Whether floats are colours, but none of 8 bits: they are not rounded to these."""
    is_share = values.dtype.kind == "f" and bool(((values >= 0) & (values <= 1)).all())
    return is_share and not fits_eight_bits(values)


def _stacked(found: dict[str, Array], names: tuple[str, ...]) -> Array | None:
    """Remove and return columns that belong together, if all are there."""
    if not all(name in found and found[name].ndim == 1 for name in names):
        return None
    return np.stack([found.pop(name) for name in names], axis=1)


def _is_structured(source: object) -> bool:
    return isinstance(source, np.ndarray) and source.dtype.names is not None and source.ndim == 1


def _classes(source: object) -> set[tuple[str, str]]:
    return {(kind.__module__.partition(".")[0], kind.__name__) for kind in type(source).__mro__}
