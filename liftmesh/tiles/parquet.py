"""Points of Parquet: two columns, read by row groups, or in batches where these are large."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.arrays import as_floats, widened
from liftmesh.errors import FormatError
from liftmesh.io.registry import as_cloud
from liftmesh.optional import load
from liftmesh.tiles.schema import PLANAR, Schema, naming, records_of_points

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.tiles.source_chunks import Origin


@dataclass(frozen=True)
class ParquetChunk:
    """Row groups of a Parquet file."""

    origin: Origin
    place: str
    groups: tuple[int, ...]
    columns: tuple[str, str]
    rows: int
    schema: Schema = PLANAR

    def records(self) -> Array:
        """Read the two columns, each of its own type; missing values are NaN."""
        parquet = load("pyarrow.parquet", extra="dask")
        with parquet.ParquetFile(self.place) as file:
            table = file.read_row_groups(list(self.groups), columns=list(self.columns))
        with naming(self.origin.source):
            points = _stacked(table, self.columns)
        return records_of_points(points, PLANAR, self.origin.source)


def parquet_files(name: str) -> list[str]:
    """List the files of a folder of Parquet in the order of their numbers, as Dask wrote them."""
    if not (name.lower().rstrip("/").endswith((".parquet", ".pq")) and Path(name).is_dir()):
        return [name]
    names = [str(path) for path in Path(name).glob("*.parquet")]
    if not names:
        raise FormatError(f"{name}: the folder holds no *.parquet")
    return sorted(names, key=_numbers)


def _numbers(name: str) -> tuple[list[int], str]:
    return [int(digits) for digits in re.findall(r"\d+", Path(name).name)], name


def parquet_chunks(origin: Origin, name: str, rows: int) -> list[ParquetChunk]:
    """Cut a Parquet file into chunks."""
    parquet = load("pyarrow.parquet", extra="dask")
    with parquet.ParquetFile(name) as file:
        columns = planar_columns(name, file.schema_arrow.names)
        sizes = [file.metadata.row_group(i).num_rows for i in range(file.num_row_groups)]
    place = os.path.abspath(name)  # noqa: PTH100 - links stay as they are
    chunks: list[ParquetChunk] = []
    first = 0
    for groups in _grouped(sizes, rows):
        count = sum(sizes[i] for i in groups)
        chunks.append(ParquetChunk(replace(origin, row=first), place, groups, columns, count))
        first += count
    return chunks


def _grouped(sizes: Sequence[int], rows: int) -> Iterator[tuple[int, ...]]:
    """Put row groups together until they have so many rows."""
    held: list[int] = []
    count = 0
    for group, size in enumerate(sizes):
        if held and count + size > rows:
            yield tuple(held)
            held, count = [], 0
        held.append(group)
        count += size
    if held:
        yield tuple(held)


def planar_batches(name: str, rows: int) -> Iterator[Array]:
    """Read the two columns of a file in batches, which need not be whole row groups."""
    parquet = load("pyarrow.parquet", extra="dask")
    with parquet.ParquetFile(name) as file:
        columns = planar_columns(name, file.schema_arrow.names)
        for batch in file.iter_batches(rows, columns=list(columns)):
            with naming(name):
                points = _stacked(batch, columns)
            yield points


def parquet_clouds(name: str, rows: int) -> Iterator[Cloud]:
    """Read all columns of a file in batches, with the depth of colours that all of them have."""
    gaps: set[str] = set()
    read = partial(_tables, name, rows, gaps)
    depths = [cloud.color_depth for cloud in read() if cloud.colors is not None]
    depth = None if None in depths else max(filter(None, depths), default=None)
    for cloud in read():
        yield cloud if depth is None else cloud.with_color_depth(depth)


def _tables(name: str, rows: int, gaps: set[str]) -> Iterator[Cloud]:
    """Read batches; whole numbers are doubles in all that follow one where some are missing."""
    parquet = load("pyarrow.parquet", extra="dask")
    kinds = load("pyarrow.types", extra="dask")
    with parquet.ParquetFile(name) as file:
        for batch in file.iter_batches(rows):
            pairs = zip(batch.schema, batch.columns, strict=True)
            gaps |= {
                field.name
                for field, column in pairs
                if column.null_count and kinds.is_integer(field.type)
            }
            table = batch.to_pandas()
            with naming(name):
                cloud = as_cloud(table.astype(dict.fromkeys(gaps & {*table.columns}, np.float64)))
            yield cloud


def _stacked(table: Any, columns: Sequence[str]) -> Array:
    """Put columns side by side, each of its own type; missing values are NaN."""
    rows: Array = np.stack([_floats(table.column(name), name) for name in columns], axis=1)
    return rows


def _floats(column: Any, name: str) -> Floats:
    """Convert a column of Arrow without rounding; integers become floats where some are missing."""
    kinds = load("pyarrow.types", extra="dask")
    if column.null_count and kinds.is_integer(column.type):
        missing = _array(column.is_null())
        values = widened(as_floats(_array(column.fill_null(0)), name))
        return np.where(missing, np.nan, values)
    return widened(as_floats(_array(column), name))


def _array(column: Any) -> Array:
    """Convert values of a table or a batch, of which those of a batch may be copied."""
    is_batch = hasattr(column, "buffers")
    values: Array = column.to_numpy(zero_copy_only=False) if is_batch else column.to_numpy()
    return values


def planar_columns(name: str, names: Sequence[str]) -> tuple[str, str]:
    """Choose the columns of coordinates."""
    for pair in (("x", "y"), ("X", "Y")):
        if all(names.count(column) == 1 for column in pair):
            return pair
    raise FormatError(f"{name}: columns x and y are needed, not {', '.join(names)}")
