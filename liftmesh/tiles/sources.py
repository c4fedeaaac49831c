"""Where points come from: parts that can be read at any time, by any process, again and again.

NPY, Parquet and LAS files are read by ranges, with plain reads: pages of a mapped file would count
as memory of the process. What can only be read from its beginning to its end (text, PLY, LAZ,
iterators) is written to the scratch folder first, x and y alone.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from liftmesh._typing import Array, Floats, Progress
from liftmesh.base.arrays import MOST_ROWS, as_coordinates, widened
from liftmesh.errors import FormatError, InputError
from liftmesh.io.formats.numpy_arrays import Layout
from liftmesh.io.read import read_chunks
from liftmesh.io.registry import as_cloud
from liftmesh.io.streams import remaining
from liftmesh.tiles.copies import nth, of_file, of_iterator, unheard, written
from liftmesh.tiles.las import las_parts
from liftmesh.tiles.parquet import parquet_files, parquet_parts, planar_batches
from liftmesh.tiles.store import save_array

_GROUP = 1 << 20  # rows that writers put together unless they are told otherwise
BY_RANGES = (".npy", ".parquet", ".pq", ".las")
"""Suffixes of files that are read in place, but for LAS that is compressed."""


@dataclass(frozen=True)
class Origin:
    """Where rows are from: the source as the caller knows it, and the first row within that."""

    source: str
    number: int = 0
    row: int = 0
    is_path: bool = False


class Part(Protocol):
    """Consecutive rows of a source."""

    @property
    def rows(self) -> int:
        """How many."""

    @property
    def origin(self) -> Origin:
        """What the rows are, for messages and the manifest."""

    @property
    def place(self) -> str | None:
        """The file that is read; without one, the rows are in memory, and can be saved."""

    def read(self) -> Array:
        """Read the rows; the result is (n, 2) or (n, 3), of real numbers."""


@dataclass(frozen=True)
class NpyPart:
    """Rows of an NPY file, or of a mapped array of NumPy."""

    origin: Origin
    place: str
    dtype: str
    shape: tuple[int, int]
    by_columns: bool
    offset: int
    first: int
    rows: int

    def read(self) -> Array:
        """Read x and y, and no more columns than lie between."""
        return self.columns(2)

    def columns(self, wanted: int = 3) -> Array:
        """Read the first columns, and all of them where they are not apart."""
        total, columns = self.shape
        size = np.dtype(self.dtype).itemsize
        if not self.by_columns:
            at = self.offset + self.first * columns * size
            return self._values(at, self.rows * columns).reshape(self.rows, columns)
        apart = range(min(wanted, columns))
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


@dataclass(frozen=True)
class ArrayPart:
    """Rows of an array in memory."""

    array: Array
    origin: Origin = Origin("array")
    place: None = None

    @property
    def rows(self) -> int:
        """How many."""
        return len(self.array)

    def read(self) -> Array:
        """Copy the rows, with their mask if they have one: nobody else writes to the copy."""
        copied: Array = self.array.copy()
        return copied

    def saved(self, path: Path) -> Part:
        """Write the rows to a file."""
        return in_file(self.array, path, self.origin)


def planar(part: Part) -> Floats:
    """Read x and y of a part."""
    try:
        rows = widened(as_coordinates(part.read()))[:, :2]
    except InputError as error:
        raise type(error)(f"{part.origin.source}: {error}") from error
    return np.ascontiguousarray(rows)


def parts_of(source: object, rows: int, scratch: Path, show: Progress = unheard) -> list[Part]:
    """Cut a source into parts."""
    files = files_of(source)
    if files is not None:
        each = [
            parts_of_file(file, file.source, rows, scratch, nth(show, number, len(files)))
            for number, file in enumerate(files)
        ]
        return [part for parts in each for part in parts]
    if isinstance(source, Iterator):
        return _spooled(of_iterator(source, show), rows, scratch, Origin("iterator"))
    if isinstance(source, np.memmap) and _is_plain(source):
        name = str(source.filename)
        layout = source.dtype, source.shape, False, source.offset
        return [*_ranges(Origin(name), name, *layout, rows)]
    return _of_array(source, rows)


def files_of(source: object) -> list[Origin] | None:
    """List the files of a source."""
    paths: list[Any] = [*source] if isinstance(source, list | tuple) else [source]
    if not paths or not all(isinstance(path, str | os.PathLike) for path in paths):
        return None
    given = (os.path.expanduser(os.fspath(path)) for path in paths)  # noqa: PTH111 - no home
    names = (name for each in given for name in parquet_files(each))
    return [Origin(name, number, is_path=True) for number, name in enumerate(names)]


def parts_of_file(
    origin: Origin, name: str, rows: int, scratch: Path, show: Progress = unheard
) -> list[Part]:
    """Cut a file into parts."""
    suffix = Path(name).suffix.lower()
    if suffix == ".npy":
        return [*npy_parts(origin, name, rows)]
    if suffix in (".parquet", ".pq"):
        parts = parquet_parts(origin, name, rows)
        if max((part.rows for part in parts), default=0) <= max(rows, _GROUP):
            return [*parts]
        return _spooled(planar_batches(name, rows), rows, scratch, origin)
    ranges = las_parts(origin, name, rows) if suffix == ".las" else None
    if ranges is not None:
        return [*ranges]
    chunks = (cloud.points for cloud in of_file(read_chunks(name, rows=rows), show))
    return _spooled(chunks, rows, scratch, origin)


def in_file(points: Array, path: Path, origin: Origin) -> Part:
    """Write x and y of points to a file."""
    rows = planar(ArrayPart(points, origin))
    save_array(path, rows)
    offset = path.stat().st_size - rows.nbytes
    return NpyPart(origin, str(path), rows.dtype.str, (len(rows), 2), False, offset, 0, len(rows))


def _is_plain(array: np.memmap[Any, Any]) -> bool:
    """Whether the array is its file from the offset on, and no slice of another array."""
    if array.filename is None or array.mode == "c" or isinstance(array.base, np.memmap):
        return False
    return array.ndim == 2 and array.shape[1] in (2, 3) and array.flags.c_contiguous


def npy_parts(origin: Origin, name: str, rows: int) -> list[NpyPart]:
    """Cut an NPY file into parts."""
    with Path(name).open("rb") as stream:
        layout = Layout.read(stream, name)
        layout.check_size(remaining(stream), name)
        offset = stream.tell()
    if len(layout.shape) != 2 or layout.shape[1] not in (2, 3):
        raise FormatError(f"{name}: {layout.what}: points need the shape (n, 2) or (n, 3)")
    return _ranges(origin, name, layout.dtype, layout.shape, layout.by_columns, offset, rows)


def _ranges(
    origin: Origin,
    name: str,
    dtype: Any,
    shape: tuple[int, ...],
    by_columns: bool,
    offset: int,
    rows: int,
) -> list[NpyPart]:
    total, columns = shape
    return [
        NpyPart(
            replace(origin, row=first),
            os.path.abspath(name),  # noqa: PTH100 - links stay as they are
            np.dtype(dtype).str,
            (total, columns),
            by_columns,
            offset,
            first,
            min(rows, total - first),
        )
        for first in range(0, total, rows)
    ]


def _of_array(source: object, rows: int) -> list[Part]:
    array = as_cloud(source).points if not isinstance(source, np.ndarray) else source
    if array.ndim != 2 or array.shape[1] not in (2, 3):
        raise InputError(f"points need the shape (n, 2) or (n, 3), not {array.shape}")
    begins = range(0, len(array), rows)
    return [ArrayPart(array[i : i + rows], Origin("array", row=i)) for i in begins]


def _spooled(chunks: Iterable[object], rows: int, scratch: Path, origin: Origin) -> list[Part]:
    """Write x and y of chunks, which come once, to files of so many rows."""
    return written(_pieces(chunks, origin), rows, scratch, origin, in_file)


def _pieces(chunks: Iterable[object], origin: Origin) -> Iterator[Floats]:
    for chunk in chunks:
        array = chunk if isinstance(chunk, np.ndarray) else as_cloud(chunk).points
        for begin in range(0, len(array), MOST_ROWS):
            yield planar(ArrayPart(array[begin : begin + MOST_ROWS], origin))
