"""Shards: files of triangles, as NPY, Parquet or PLY; the same bytes whoever writes them.

NPY and Parquet name rows of the whole source. PLY has no 64-bit integers, and viewers of it want
positions: such a shard has the vertices of its own triangles, each with its ``row``. Parquet packs
differences of row numbers (``DELTA_BINARY_PACKED``): less than half the bytes, and faster than
compression.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from liftmesh._typing import Array, Integers
from liftmesh.base.cloud import Cloud
from liftmesh.base.options import ShardFormat
from liftmesh.errors import FormatError, InputError, Option
from liftmesh.io.formats.ply import read_ply
from liftmesh.io.formats.ply.writer import write_ply
from liftmesh.optional import load
from liftmesh.tiles.store import damaged, mapped, save_array, saving, sound

_COLUMNS = ("a", "b", "c")
_GROUP = 1 << 20  # triangles of a row group
_MOST_ROWS = 1 << 31  # that have a number in PLY


def check_format(shards: ShardFormat, rows: int) -> None:
    """Raise if shards of a format cannot be written, before anything is."""
    if shards == "ply" and rows > _MOST_ROWS:
        raise InputError(
            f"PLY has no 64-bit integers for the numbers of {rows:,} rows, only of "
            f"{_MOST_ROWS:,}: give {Option('shards', 'npy')} or 'parquet'"
        )
    if shards == "parquet":
        load("pyarrow.parquet", extra="dask")


def save_shard(path: Path, triangles: Integers, records: Integers) -> str:
    """Write triangles in the format that the suffix names."""
    return _FORMATS[path.suffix].save(path, triangles, records)


def read_shard(path: Path, stated: Mapping[str, Any] | None = None) -> Integers:
    """Read the triangles of a shard."""
    if stated is not None:
        sound(path, stated["sha256"])
    return _checked(path, _FORMATS[path.suffix].read(path), stated)


def open_shard(path: Path, stated: Mapping[str, Any] | None = None) -> Integers:
    """Map the triangles of a shard if its format allows, and read them otherwise."""
    if path.suffix != ".npy":
        return read_shard(path, stated)
    if stated is not None:
        sound(path, stated["sha256"])
    return _checked(path, mapped(path), stated)


def vertices_of(path: Path) -> Integers | None:
    """Read the vertices that a shard has itself."""
    if path.suffix != ".ply":
        return None
    cloud = _read_cloud(path)
    points = np.ascontiguousarray(cloud.points[:, :2]).view(np.int64)
    return np.column_stack((cloud.attributes["row"].astype(np.int64), points))


def _checked(path: Path, triangles: Array, stated: Mapping[str, Any] | None) -> Integers:
    if triangles.dtype != np.int64 or triangles.shape[1:] != (3,):
        raise damaged(path, "not rows of three 64-bit integers")
    if stated is not None and len(triangles) != stated["triangles"]:
        raise damaged(path, f"{len(triangles):,} triangles, not {stated['triangles']:,}")
    return triangles


def _save_npy(path: Path, triangles: Integers, _: Integers) -> str:
    return save_array(path, triangles)


def _read_npy(path: Path) -> Array:
    return np.array(mapped(path))


def _save_parquet(path: Path, triangles: Integers, _: Integers) -> str:
    arrow, parquet = load("pyarrow", extra="dask"), load("pyarrow.parquet", extra="dask")
    schema = arrow.schema([arrow.field(name, arrow.int64(), nullable=False) for name in _COLUMNS])
    packed: dict[str, Any] = {
        "column_encoding": dict.fromkeys(_COLUMNS, "DELTA_BINARY_PACKED"),
        "use_dictionary": False,
        "compression": "none",
    }
    with saving(path) as stream:
        with parquet.ParquetWriter(arrow.PythonFile(stream, "w"), schema, **packed) as writer:
            for begin in range(0, len(triangles), _GROUP):
                columns = np.ascontiguousarray(triangles[begin : begin + _GROUP].T)
                writer.write_table(arrow.table([*columns], schema=schema))
        return stream.digest


def _read_parquet(path: Path) -> Array:
    arrow, parquet = load("pyarrow", extra="dask"), load("pyarrow.parquet", extra="dask")
    try:
        with parquet.ParquetFile(path) as file:
            return _columns(file, arrow.int64())
    except (arrow.ArrowException, ValueError, KeyError) as error:
        raise damaged(path, str(error).splitlines()[0]) from error


def _columns(file: Any, kind: Any) -> Array:
    if any(file.schema_arrow.field(name).type != kind for name in _COLUMNS):
        raise ValueError("the columns hold no 64-bit integers")
    triangles = np.empty((file.metadata.num_rows, 3), dtype=np.int64)
    at = 0
    for group in file.iter_batches(_GROUP, columns=[*_COLUMNS], use_threads=False):
        for k, column in enumerate(group.columns):
            triangles[at : at + len(column), k] = column.to_numpy()  # refuses missing values
        at += group.num_rows
    if at != len(triangles):
        raise ValueError(f"{at:,} rows of {len(triangles):,}")
    return triangles


def _save_ply(path: Path, triangles: Integers, records: Integers) -> str:
    rows, corners = np.unique(triangles, return_inverse=True)
    order = np.argsort(records[:, 0])
    of_rows = records[order[np.searchsorted(records[:, 0], rows, sorter=order)]]
    points = np.zeros((len(rows), 3))
    points[:, :2] = of_rows.view(np.float64)[:, 1:]
    faces = corners.reshape(-1, 3).astype(np.int32)
    cloud = Cloud(points, faces=faces, attributes={"row": rows.astype(np.int32)})
    with saving(path) as stream:
        write_ply(stream, cloud)  # type: ignore[arg-type]  # it writes, and nothing else
        return stream.digest


def _read_ply(path: Path) -> Array:
    cloud = _read_cloud(path)
    triangles: Array = cloud.attributes["row"].astype(np.int64)[cloud.faces]
    return triangles


def _read_cloud(path: Path) -> Cloud:
    with path.open("rb") as stream:
        try:
            cloud = read_ply(stream, str(path))
        except FormatError as error:
            raise damaged(path, error) from error
    if cloud.faces is None or "row" not in cloud.attributes:
        raise damaged(path, "it has no faces, or no rows")
    return cloud


@dataclass(frozen=True)
class _Format:
    save: Callable[[Path, Integers, Integers], str]
    read: Callable[[Path], Array]


_FORMATS = {
    ".npy": _Format(_save_npy, _read_npy),
    ".parquet": _Format(_save_parquet, _read_parquet),
    ".ply": _Format(_save_ply, _read_ply),
}
