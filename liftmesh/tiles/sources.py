"""Sources cut into chunks: files, arrays and iterators; points alone, or rows with values.

NPY files and mapped arrays are read by ranges; of plain points also Parquet files with columns x
and y, and LAS files. What can only be read from its beginning to its end (text, PLY, LAZ,
iterators) is written to the scratch folder first, as records, and so are all other files of a
surface. These copies are the source for as long as rows are sorted by tile. A run that goes on
makes them again.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from operator import length_hint
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from liftmesh._typing import Array, Progress
from liftmesh.base.arrays import MOST_ROWS
from liftmesh.errors import InputError
from liftmesh.io import streams
from liftmesh.io.read import for_chunks, read_chunks
from liftmesh.io.registry import as_cloud
from liftmesh.tiles.schema import (
    PLANAR,
    Reading,
    Schema,
    check_alike,
    records_from,
    records_of_points,
    schema_of,
)
from liftmesh.tiles.source_chunks import (
    MemoryChunk,
    Origin,
    SourceChunk,
    las_chunks,
    mapped_chunks,
    npy_chunks,
    parquet_chunks,
    parquet_clouds,
    parquet_files,
    planar_batches,
    saved,
)
from liftmesh.tiles.store import concatenated

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

Item = TypeVar("Item")

_GROUP = 1 << 20  # rows that writers of Parquet put together unless they are told otherwise
_PARQUET = (".parquet", ".pq")
_BY_RANGES = {".npy"}
_PLANAR_BY_RANGES = {".npy", *_PARQUET, ".las"}  # LAS unless it is compressed


def unheard(_: float) -> None:
    """Take no notice of progress."""


def source_chunks(
    source: object, rows: int, scratch: Path, reading: Reading, show: Progress = unheard
) -> list[SourceChunk]:
    """Cut a source into chunks."""
    files = files_of(source)
    if files is not None:
        how = readings([file.source for file in files], reading)
        chunks_of_files = [
            file_chunks(file, file.source, rows, scratch, how[k], _nth(show, k, len(files)))
            for k, file in enumerate(files)
        ]
        return alike([chunk for chunks in chunks_of_files for chunk in chunks])
    check_no_options(reading)
    if isinstance(source, Iterator):
        items = _of_iterator(source, show)
        return alike(_spooled(items, rows, scratch, Origin("iterator"), reading))
    if isinstance(source, np.memmap) and reading.crs is None:
        _check_shape(source)
        if _is_whole(source):
            return [*mapped_chunks(source, rows, reading.schema)]
    return _of_memory(source, rows, reading)


def files_of(source: object) -> list[Origin] | None:
    """List the files of a source; None if it is something else."""
    paths: list[Any] = [*source] if isinstance(source, list | tuple) else [source]
    if not paths or not all(isinstance(path, str | os.PathLike) for path in paths):
        return None
    given = (os.path.expanduser(os.fspath(path)) for path in paths)  # noqa: PTH111 - no home
    names = (name for each in given for name in parquet_files(each))
    return [Origin(name, number, is_path=True) for number, name in enumerate(names)]


def readings(names: Sequence[str], reading: Reading) -> list[Reading]:
    """Say how each file is read: of lidar the ground of a surface, unless the caller says more."""
    of_files = [reading] * len(names)
    if reading.is_planar:
        return of_files
    kinds = [reading.options.get("format") or Path(name).suffix[1:] for name in names]
    lidar = [k for k, kind in enumerate(kinds) if kind.lower() in {"las", "laz"}]
    chosen = for_chunks([names[k] for k in lidar], reading.options)
    for k, options in zip(lidar, chosen, strict=True):
        of_files[k] = replace(reading, options=options)
    return of_files


def file_chunks(
    origin: Origin, name: str, rows: int, scratch: Path, reading: Reading, show: Progress = unheard
) -> list[SourceChunk]:
    """Cut a file into chunks."""
    suffix = Path(name).suffix.lower()
    if suffix == ".npy" and not reading.options:
        return [*npy_chunks(origin, name, rows, reading.schema)]
    if suffix in _PARQUET:
        return _of_parquet(origin, name, rows, scratch, reading, show)
    ranges = las_chunks(origin, name, rows) if suffix == ".las" and reading.is_planar else None
    if ranges is not None:
        return [*ranges]
    clouds = _of_file(read_chunks(name, rows=rows, **reading.options), show)
    return _spooled(clouds, rows, scratch, origin, reading)


def alike(chunks: list[SourceChunk]) -> list[SourceChunk]:
    """Return chunks whose rows all have the same values."""
    for chunk in chunks[1:]:
        first = chunks[0]
        check_alike(first.schema, chunk.schema, chunk.origin.source, first.origin.source)
    return chunks


def check_no_options(reading: Reading) -> None:
    """Raise if there are options of files; to be called where there is no file."""
    if reading.options:
        raise InputError(f"{', '.join(reading.options)}: options of files, and there is no file")


def stage_of(files: Sequence[Origin], reading: Reading) -> str:
    """Say what it is to cut files: to copy some of them, or just to open all."""
    suffixes = {Path(file.source).suffix.lower() for file in files}
    by_ranges = _PLANAR_BY_RANGES if reading.is_planar else _BY_RANGES
    return "spool" if suffixes - by_ranges else "open"


def records_of(piece: object, reading: Reading, source: str) -> tuple[Array, Schema]:
    """Convert an array, a table or a cloud to records."""
    if reading.is_planar:
        points = piece if isinstance(piece, np.ndarray) else as_cloud(piece).points
        return records_of_points(points, PLANAR, source), PLANAR
    cloud = reading.changed(as_cloud(piece))
    return records_from(cloud), schema_of(cloud)


def _of_parquet(
    origin: Origin, name: str, rows: int, scratch: Path, reading: Reading, show: Progress = unheard
) -> list[SourceChunk]:
    """Cut a Parquet file into chunks: large row groups, and values, are copied."""
    if not reading.is_planar:
        if reading.options:
            given = ", ".join(reading.options)
            raise InputError(f"{name}: rows of Parquet are read as they are: leave out {given}")
        clouds = _of_file(parquet_clouds(name, rows), show)
        return _spooled(clouds, rows, scratch, origin, reading)
    groups = parquet_chunks(origin, name, rows)
    if max((chunk.rows for chunk in groups), default=0) <= max(rows, _GROUP):
        return [*groups]
    return _spooled(planar_batches(name, rows), rows, scratch, origin, reading)


def _of_memory(source: object, rows: int, reading: Reading) -> list[SourceChunk]:
    """Cut an array, a table or a cloud into chunks."""
    if reading.is_planar:
        array = source if isinstance(source, np.ndarray) else as_cloud(source).points
        _check_shape(array)
        schema, begins = PLANAR, range(0, len(array), rows)
        held = [array[begin : begin + rows] for begin in begins]
    else:
        cloud = replace(reading.changed(as_cloud(source)), edges=None)
        schema, begins = schema_of(cloud), range(0, len(cloud), rows)
        held = [records_from(cloud.select(slice(begin, begin + rows))) for begin in begins]
    return [
        MemoryChunk(each, schema, Origin("array", row=begin))
        for begin, each in zip(begins, held, strict=True)
    ]


def _check_shape(array: Array) -> None:
    if array.ndim != 2 or array.shape[1] not in (2, 3):
        raise InputError(f"points need the shape (n, 2) or (n, 3), not {array.shape}")


def _is_whole(array: np.memmap[Any, Any]) -> bool:
    """Whether the array is its file from the offset on, and no slice of another array."""
    if array.filename is None or array.mode == "c" or isinstance(array.base, np.memmap):
        return False
    return array.flags.c_contiguous


def _spooled(
    pieces: Iterable[object], rows: int, scratch: Path, origin: Origin, reading: Reading
) -> list[SourceChunk]:
    """Write pieces of a source, which come once, to files of so many records."""
    schemas: list[Schema] = []
    chunks: list[SourceChunk] = []
    first = 0
    for held in _regrouped(_records(pieces, origin.source, reading, schemas), rows):
        path = scratch / f"points-{origin.number:05d}-{len(chunks):05d}.npy"
        chunks.append(saved(held, path, schemas[0], replace(origin, row=first)))
        first += len(held)
    return chunks


def _records(
    pieces: Iterable[object], source: str, reading: Reading, schemas: list[Schema]
) -> Iterator[Array]:
    """Yield the rows of pieces that all have one schema, which is noted."""
    for piece in _small(pieces) if reading.is_planar else _clouds(pieces):
        records, schema = records_of(piece, reading, source)
        schemas[:] = schemas or [schema]
        check_alike(schemas[0], schema, source, "what came before")
        yield records


def _small(pieces: Iterable[object]) -> Iterator[Array]:
    """Yield points of so few rows that they can be converted."""
    for piece in pieces:
        points = piece if isinstance(piece, np.ndarray) else as_cloud(piece).points
        for begin in range(0, len(points), MOST_ROWS):
            yield points[begin : begin + MOST_ROWS]


def _clouds(pieces: Iterable[object]) -> Iterator[Cloud]:
    """Yield the pieces that have rows."""
    return (cloud for cloud in map(as_cloud, pieces) if len(cloud))


def _regrouped(arrays: Iterable[Array], rows: int) -> Iterator[Array]:
    held: list[Array] = []
    for array in arrays:
        held.append(array)
        if sum(map(len, held)) >= rows:
            whole = concatenated(held)
            full = len(whole) // rows * rows
            yield from (whole[i : i + rows] for i in range(0, full, rows))
            held = [whole[full:].copy()]
    if sum(map(len, held)):
        yield concatenated(held)


def _of_file(chunks: Iterable[Item], show: Progress) -> Iterator[Item]:
    """Report which share of the bytes of a file has been read."""
    show(0.0)
    for chunk in chunks:
        yield chunk
        at, size = streams.progress() or (0, 1)  # a pipe has no size
        show(at / max(1, size))
    show(1.0)


def _of_iterator(items: Iterator[Item], show: Progress) -> Iterator[Item]:
    """Report which share of its items has come from an iterator."""
    show(0.0)
    count = length_hint(items)
    for number, item in enumerate(items, 1):
        yield item
        if count:
            show(min(1.0, number / count))
    show(1.0)


def _nth(show: Progress, number: int, count: int) -> Progress:
    """Return what hears the share of one of several files."""
    return lambda share: show((number + share) / count)
