"""Tables in memory: DataFrames, structured arrays, laspy's points, and arrays with named columns.

They are read by the names of their columns, like the same table as text, whose rules they share
(`io.formats.text.columns`), and refused for the same reasons. Values keep their types: text, dates
and other objects are left out and named. No library of tables is imported.
"""

from __future__ import annotations

import numbers
from collections.abc import Iterator, Mapping
from decimal import Decimal
from typing import Any

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base import arrays
from liftmesh.base.arrays import is_masked_array
from liftmesh.base.cloud import Cloud
from liftmesh.base.colors import fits_eight_bits, recognized
from liftmesh.base.interruption import preserve_signals
from liftmesh.crs.comparison import crs_of
from liftmesh.errors import FormatError, InputError, Option, UnsupportedTypeError
from liftmesh.io.columns import ALPHA, COLOR, NORMAL, POSITION, taken_together
from liftmesh.io.formats.text.column_ambiguity import ColumnAmbiguity
from liftmesh.io.formats.text.columns import Columns, understood, unnamed
from liftmesh.io.formats.text.layout import with_point
from liftmesh.io.metadata import NotedColumns, Unread, noted
from liftmesh.io.objects.plain import (
    FRAMES,
    RECORDS,
    classes,
    is_array,
    is_structured,
    is_table,
    qualified_name,
)
from liftmesh.io.options import TableOptions, validate_table_options
from liftmesh.io.text_tables import is_number, shortened

_CONVERSIONS = ("collect", "compute", "to_pandas", "to_dataframe", "read")
_OPTIONS = ("columns", "flat", "nodata")
WHERE = "the table"


def refuse(source: object) -> Cloud:
    """Raise for a table of another library, and say how to make one that is read."""
    conversion = next((name for name in _CONVERSIONS if hasattr(source, name)), None)
    how = f"what its {conversion}() returns, " if conversion else ""
    raise UnsupportedTypeError(
        f"a {qualified_name(source)} is a table, but not one that is read: give {how}a pandas or "
        "polars DataFrame, or np.column_stack([x, y, z]) of its columns"
    )


def to_cloud(source: Any, options: TableOptions | None = None) -> Cloud:
    """Convert a table to a cloud, by the names of its columns."""
    options = options or TableOptions()
    values, described = _opened(source)
    try:
        return of_columns(values, options, described)
    except FormatError as error:  # of the rooms for files
        raise InputError(error.message.marked) from error


def with_options(source: Any, given: Mapping[str, Any]) -> Cloud:
    """Convert a table or an array of rows, with the options of a caller."""
    unknown = [name for name in given if name not in _OPTIONS]
    if unknown:
        raise InputError(
            f"{Option(unknown[0], ...)} is for files: an object takes {', '.join(_OPTIONS)}"
        )
    if not is_table(source) and not is_array(source):
        raise InputError(
            f"{', '.join(f'{Option(name, ...)}' for name in given)} cannot be given: a "
            f"{qualified_name(source)} has no columns"
        )
    with preserve_signals():
        return to_cloud(source, validate_table_options(**given))


def _opened(source: Any) -> tuple[list[tuple[str, Any]], dict[str, Any]]:
    """Return the columns of a table with their names, and what else it says."""
    if isinstance(source, list | tuple) and is_table(source):
        raise InputError(
            f"a list of {len(source)} structured arrays is no table: give one of them, or what "
            "np.concatenate makes of them"
        )
    if is_structured(source):
        return _of_records(source)
    kinds = classes(source)
    if arrays.are_geometries(source) and getattr(source, "geometry", None) is not None:
        return _of_geometries(source)
    if kinds & RECORDS:
        return _of_laspy(source)
    if ("polars", "DataFrame") in kinds:
        return [(name, _of_polars(source[name])) for name in source.columns], {}
    if kinds & FRAMES:
        return [(str(name), source.iloc[:, k]) for k, name in enumerate(source.columns)], {}
    rows = np.asanyarray(source)
    if rows.ndim != 2:
        raise InputError(
            f"{Option('columns', ...)} names the columns of a table, not of the shape {rows.shape}"
        )
    return [("", column) for column in rows.T], {}


def _of_records(source: Any) -> tuple[list[tuple[str, Any]], dict[str, Any]]:
    if source.ndim != 1:
        raise InputError(
            f"a structured array of the shape {source.shape} is no list of rows: give its ravel()"
        )
    return [(name, source[name]) for name in source.dtype.names], {}


def _of_geometries(source: Any) -> tuple[list[tuple[str, Any]], dict[str, Any]]:
    """Return coordinates in place of the geometries, which come before columns of their names."""
    shapes = source.geometry
    columns: list[tuple[str, Any]] = [*zip(POSITION, arrays.coordinates_of(shapes).T, strict=False)]
    rest = [(str(name), source.iloc[:, k]) for k, name in enumerate(getattr(source, "columns", ()))]
    rest = [each for each in rest if each[0] != shapes.name]
    taken = [name for name, _ in rest if name.lower() in dict(columns)]
    columns += [each for each in rest if each[0] not in taken]
    return columns, {"crs": crs_of(shapes), "unread": [f"column {name}" for name in taken]}


def _of_polars(column: Any) -> Array:
    """Return a column as an array: of objects, where to_numpy() would round whole numbers."""
    if column.dtype.is_integer() and column.null_count():
        return np.array(column.to_list(), dtype=object)
    return np.asarray(column.to_numpy())


def _of_laspy(source: Any) -> tuple[list[tuple[str, Any]], dict[str, Any]]:
    """Return scaled coordinates in place of the whole numbers that LAS stores."""
    names = [name for name in source.point_format.dimension_names if name not in {"X", "Y", "Z"}]
    columns = [(name, getattr(source, name)) for name in POSITION]
    columns += [(name, source[name]) for name in names]
    records = getattr(getattr(source, "header", None), "vlrs", ())
    systems = [getattr(each, "string", "") for each in records if "Wkt" in type(each).__name__]
    system = next((each.strip("\0 ") for each in systems if each.strip("\0 ")), None)
    return columns, {"crs": system}


def of_columns(values: list[tuple[str, Any]], options: TableOptions, described: Any) -> Cloud:
    """Make a cloud of columns, once their names and types are understood."""
    columns = _named([name for name, _ in values], options, bool(described))
    read = {k: _as_numbers(values[k][1]) for k in range(len(values)) if k not in columns.left_out}
    columns_read = {columns.names[k]: each for k, each in read.items() if each is not None}
    unread = [_unread(columns, k, values[k][1]) for k in range(len(values)) if read.get(k) is None]
    unread += described.get("unread", ())
    if not options.names_all and "z" not in columns.names:
        words = [columns.names[k] for k, each in read.items() if _holds_number(each, values[k][1])]
        columns.check_height([*columns_read, *words], WHERE)
    for part in POSITION:
        if part in columns.names and (part not in columns_read or columns_read[part].ndim != 1):
            raise _no_numbers(part, *values[columns.names.index(part)])
    points = _points(columns_read, columns, options, len(values[0][1]))
    columns.warn()
    notes = (*columns.notes, *_rounded(columns, values, columns_read))
    return Cloud(
        points,
        colors=_colors(columns_read),
        normals=taken_together(columns_read, NORMAL),
        attributes={k: _without_nodata(each, options) for k, each in columns_read.items()},
        metadata=noted(
            {}, columns=NotedColumns(columns.mapping()), notes=notes, not_read=Unread(unread)
        ),
        crs=described.get("crs"),
    )


def _named(names: list[str], options: TableOptions, has_coordinates: bool) -> Columns:
    if not any(names):
        return unnamed(len(names), options, WHERE)
    if has_coordinates and not options.chosen and options.names is None:
        options = TableOptions(
            chosen={each: each for each in POSITION if each in names},
            missing=options.missing,
            flat=options.flat,
        )
    return understood(names, options, WHERE)


def _unread(columns: Columns, k: int, values: Any) -> str:
    name = f"column {columns.given[k]}"
    return name if k in columns.left_out else f"{name} ({getattr(values, 'dtype', 'no numbers')})"


def _rounded(
    columns: Columns, values: list[tuple[str, Any]], columns_read: dict[str, Array]
) -> Iterator[str]:
    """Name the columns whose whole numbers are rounded, because others are missing beside them."""
    for k, (name, given) in enumerate(zip(columns.names, columns.given, strict=True)):
        doubles = columns_read.get(name, np.zeros(0, np.uint8))
        kind = getattr(getattr(values[k][1], "dtype", None), "kind", "O")
        if (
            kind == "f"
            or doubles.dtype.kind != "f"
            or np.fmax.reduce(abs(doubles), initial=0) < 2**53
        ):
            continue
        pairs = zip(values[k][1], doubles.tolist(), strict=True)
        if any(isinstance(each, numbers.Integral) and int(each) != d for each, d in pairs):
            yield f"column {given}: numbers from 2**53 on are rounded to doubles"


def _no_numbers(part: str, name: str, values: Any) -> FormatError:
    """Return the error for a coordinate that is text, with the first that is none of a number."""
    is_text = np.asarray(values).dtype.kind in "OUT"
    odd = (k for k, each in enumerate(values) if is_text and not _is_plain(each))
    k = next(odd, 0 if is_text and len(values) else None)
    example = "" if k is None else f" (row {k}: {shortened(repr([*values][k]))})"
    return FormatError(
        f"{WHERE}: {part} is the column {name!r}, which holds no numbers{example}: convert it to "
        f"numbers, or name another with {Option('columns', f'{part}=..')}"
    )


def _points(
    columns_read: dict[str, Array], columns: Columns, options: TableOptions, rows: int
) -> Floats:
    """Remove and return the coordinates."""
    points = np.zeros((rows, 3))
    parts = [each for each in POSITION if each in columns.names]
    for part in parts:
        name = columns.given[columns.names.index(part)]
        points[:, POSITION.index(part)] = _without_nodata(
            _exact(columns_read.pop(part), name), options
        )
    if columns.negated is not None:
        points[:, 2] = 0.0 - points[:, 2]
    doubts = ColumnAmbiguity(WHERE, Columns(tuple(parts), tuple(parts)), options)
    doubts.examine(points[:, : len(parts)])
    doubts.check()
    return points


def _exact(values: Array, name: str = "") -> Floats:
    """Convert a column to float64; raise for a number that it cannot hold."""
    if values.itemsize < 8 or values.dtype == np.float64:
        return values.astype(np.float64)
    pairs = np.column_stack([values, values])
    try:
        return np.asarray(arrays.as_coordinates(pairs)[:, 0], dtype=np.float64)
    except InputError as error:
        raise InputError(str(error).replace("in column 0", f"in column {name!r}")) from error


def _as_numbers(values: Any) -> Array | None:
    """Return a column as numbers; None if it holds anything else."""
    if is_masked_array(values):
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
    try:
        floats = [np.nan if _is_missing(each) else float(each) for each in array]
    except OverflowError:  # a whole number beyond all doubles
        return None
    return np.array(floats, dtype=np.float64)


def _holds_number(array: Array | None, values: Any) -> bool:
    """Whether a column that is no numbers holds one, or the text of one, as a file may."""
    if array is not None or np.asarray(values).dtype.kind not in "OUT":
        return False
    present = (each for each in values if not _is_missing(each))
    return any(_is_number(each) or _is_text_of_number(each) for each in present)


def _is_plain(value: object) -> bool:
    return _is_missing(value) or _is_number(value) or _is_text_of_number(value)


def _is_text_of_number(value: object) -> bool:
    return isinstance(value, str) and bool(is_number(value) or with_point(value.strip()))


def _is_missing(value: object) -> bool:
    not_a_number = isinstance(value, float) and value != value  # noqa: PLR0124 - NaN
    return value is None or not_a_number or type(value).__name__ == "NAType"


def _is_number(value: object) -> bool:
    return isinstance(value, numbers.Real | Decimal) and not isinstance(value, bool)


def _without_nodata(values: Array, options: TableOptions) -> Array:
    """Replace the caller's missing value by NaN."""
    for missing in options.missing or ():
        if isinstance(missing, float) and (values == missing).any():
            values = np.where(values == missing, np.nan, values)
    return values


def _colors(columns_read: dict[str, Array]) -> Array | None:
    """Remove and return the colours; columns that cannot be colours stay attributes."""
    names = (*COLOR, ALPHA) if ALPHA in columns_read else COLOR
    rest = dict(columns_read)
    values = taken_together(rest, names)
    if values is not None and values.dtype.kind != "u" and not _are_shades(values):
        values = recognized(values.astype(np.float64))
    if values is not None:
        for name in names:
            del columns_read[name]
    return values


def _are_shades(values: Array) -> bool:
    """Whether floats are colours, but none of 8 bits: they are not rounded to these."""
    is_share = values.dtype.kind == "f" and bool(((values >= 0) & (values <= 1)).all())
    return is_share and not fits_eight_bits(values)
