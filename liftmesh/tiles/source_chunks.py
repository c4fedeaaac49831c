"""Chunks of a source: consecutive rows that any process can read at any time, again and again.

NPY and LAS files are read by ranges, with plain reads: pages of a mapped file would count as memory
of the process. Points of Parquet are two columns, read by row groups, or in batches where these are
large.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import accumulate
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.arrays import as_floats, widened
from liftmesh.errors import FormatError
from liftmesh.io.formats.las.header import read_header
from liftmesh.io.formats.numpy_arrays import Layout
from liftmesh.io.registry import as_cloud
from liftmesh.io.streams import remaining
from liftmesh.optional import load
from liftmesh.tiles.schema import PLANAR, Schema, naming, planar_of, records_of_points
from liftmesh.tiles.store import save_array, values_of

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud


@dataclass(frozen=True)
class Origin:
    """Where rows are from: the source as the caller knows it, and the first row within that."""

    source: str
    number: int = 0
    row: int = 0
    is_path: bool = False


class SourceChunk(Protocol):
    """Consecutive rows of a source."""

    @property
    def rows(self) -> int:
        """How many."""

    @property
    def origin(self) -> Origin:
        """What the rows are, for messages and the manifest."""

    @property
    def place(self) -> str | None:
        """The file that is read; None for rows in memory."""

    @property
    def schema(self) -> Schema:
        """What a row has."""

    def records(self) -> Array:
        """Read the rows as records; nobody else writes to the result."""


@dataclass(frozen=True)
class MemoryChunk:
    """Rows in memory: planar points, perhaps with a mask or a third column, or records."""

    held: Array
    schema: Schema
    origin: Origin
    place: None = None

    @property
    def rows(self) -> int:
        """How many."""
        return len(self.held)

    def records(self) -> Array:
        """Copy the rows."""
        copied: Array = self.held.copy()
        if not self.schema.is_planar:
            return copied
        return records_of_points(copied, PLANAR, self.origin.source)


@dataclass(frozen=True)
class SavedChunk:
    """Records in a file that `saved` has written."""

    place: str
    rows: int
    schema: Schema
    origin: Origin

    def records(self) -> Array:
        """Read all of the file."""
        return values_of(Path(self.place), 0, self.rows, self.schema.dtype)


def saved(records: Array, path: Path, schema: Schema, origin: Origin) -> SavedChunk:
    """Write records to a file; planar ones as rows of two numbers."""
    save_array(path, planar_of(records) if schema.is_planar else records)
    return SavedChunk(str(path), len(records), schema, origin)


def in_files(chunks: Sequence[SourceChunk], folder: Path) -> list[SourceChunk]:
    """Write the chunks in memory to files, for other processes."""
    return [
        saved(chunk.records(), folder / f"points-{number:05d}.npy", chunk.schema, chunk.origin)
        if chunk.place is None
        else chunk
        for number, chunk in enumerate(chunks)
    ]


def numbered(chunks: Sequence[SavedChunk]) -> list[SavedChunk]:
    """Tell each chunk which row of all is its first."""
    firsts = accumulate((chunk.rows for chunk in chunks), initial=0)
    return [
        replace(chunk, origin=replace(chunk.origin, row=first))
        for chunk, first in zip(chunks, firsts, strict=False)
    ]


@dataclass(frozen=True)
class NpyChunk:
    """Rows of an NPY file, or of a mapped array of NumPy."""

    origin: Origin
    schema: Schema
    place: str
    dtype: str
    shape: tuple[int, int]
    by_columns: bool
    offset: int  # of the values, in bytes
    first: int
    rows: int

    def records(self) -> Array:
        """Read x and y, and of a surface the third column, if there is one, as heights."""
        return records_of_points(self._columns(), self.schema, self.origin.source)

    def _columns(self) -> Array:
        """Read the columns that are needed, and all of them where they are not apart."""
        total, columns = self.shape
        size = np.dtype(self.dtype).itemsize
        if not self.by_columns:
            at = self.offset + self.first * columns * size
            return self._values(at, self.rows * columns).reshape(self.rows, columns)
        apart = range(min(2 if self.schema.is_planar else 3, columns))
        begins = [self.offset + (column * total + self.first) * size for column in apart]
        return np.stack([self._values(at, self.rows) for at in begins], axis=1)

    def _values(self, at: int, count: int) -> Array:
        values = np.fromfile(self.place, self.dtype, count, offset=at)
        if len(values) < count:
            raise FormatError(
                f"{self.place}: rows {self.first:,} to {self.first + self.rows:,} are missing: "
                "the file is truncated"
            )
        return values


def npy_chunks(origin: Origin, name: str, rows: int, schema: Schema) -> list[NpyChunk]:
    """Cut an NPY file into chunks."""
    with Path(name).open("rb") as stream:
        layout = Layout.read(stream, name)
        layout.check_size(remaining(stream), name)
        offset = stream.tell()
    if len(layout.shape) != 2 or layout.shape[1] not in (2, 3):
        raise FormatError(f"{name}: {layout.what}: points need the shape (n, 2) or (n, 3)")
    return _ranges(
        origin, schema, name, (layout.dtype, layout.shape, layout.by_columns, offset), rows
    )


def mapped_chunks(array: np.memmap[Any, Any], rows: int, schema: Schema) -> list[NpyChunk]:
    """Cut a mapped array, which is its file from the offset on, into chunks."""
    name = str(array.filename)
    return _ranges(
        Origin(name), schema, name, (array.dtype, array.shape, False, array.offset), rows
    )


def _ranges(
    origin: Origin,
    schema: Schema,
    name: str,
    layout: tuple[Any, tuple[int, ...], bool, int],  # type, shape, by columns, offset in bytes
    rows: int,
) -> list[NpyChunk]:
    dtype, (total, columns), by_columns, offset = layout
    return [
        NpyChunk(
            replace(origin, row=first),
            schema,
            _absolute(name),
            np.dtype(dtype).str,
            (total, columns),
            by_columns,
            offset,
            first,
            min(rows, total - first),
        )
        for first in range(0, total, rows)
    ]


@dataclass(frozen=True)
class LasChunk:
    """Planar points of a LAS file that is not compressed."""

    origin: Origin
    place: str
    begin: int
    point_size: int
    scales: tuple[float, ...]
    offsets: tuple[float, ...]
    rows: int
    schema: Schema = PLANAR

    def records(self) -> Array:
        """Read x and y, with the arithmetic of `liftmesh.read`."""
        kind = np.dtype(
            {"names": ["x", "y"], "formats": ["<i4", "<i4"], "offsets": [0, 4],
             "itemsize": self.point_size}
        )  # fmt: skip
        steps = np.fromfile(self.place, kind, self.rows, offset=self.begin)
        if len(steps) < self.rows:
            raise FormatError(
                f"{self.place}: points from {self.origin.row:,} on are missing: the file is "
                "truncated"
            )
        points = np.empty((self.rows, 2))
        for k, name in enumerate(("x", "y")):
            np.multiply(steps[name], self.scales[k], out=points[:, k])
            points[:, k] += self.offsets[k]
        return records_of_points(points, PLANAR, self.origin.source)


def las_chunks(origin: Origin, name: str, rows: int) -> list[LasChunk] | None:
    """Cut a LAS file into chunks; None for LAZ and COPC, which are decoded once."""
    if not Path(name).is_file():
        return None
    with Path(name).open("rb") as stream:
        header = read_header(stream, name)
    if header.compressed:
        return None
    return [
        LasChunk(
            replace(origin, row=first),
            _absolute(name),
            header.start + first * header.point_size,
            header.point_size,
            header.scales,
            header.offsets,
            min(rows, header.points - first),
        )
        for first in range(0, header.points, rows)
    ]


def _absolute(name: str) -> str:
    return os.path.abspath(name)  # noqa: PTH100 - links stay as they are


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
