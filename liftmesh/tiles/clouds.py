"""Sources of surfaces: parts whose rows have heights, colours, normals and named values.

NPY files are read by ranges, as for triangles alone; all other files, and what comes once, are
written to the scratch folder first, as records (`schema.py`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, cast

import numpy as np

from liftmesh._typing import Array, Floats, Progress
from liftmesh.base.arrays import as_coordinates, widened
from liftmesh.base.frozen import FrozenDict
from liftmesh.base.options import shown
from liftmesh.errors import InputError
from liftmesh.io.read import read_chunks
from liftmesh.io.registry import as_cloud
from liftmesh.tiles.copies import nth, of_file, of_iterator, unheard, written
from liftmesh.tiles.las import readings
from liftmesh.tiles.parquet import parquet_clouds
from liftmesh.tiles.schema import POSITION, Schema, records_from, schema_of
from liftmesh.tiles.sources import (
    NpyPart,
    Origin,
    Part,
    files_of,
    npy_parts,
    parts_of,
    planar,
)
from liftmesh.tiles.store import kind_of, save_array, values_of

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_DEPTH = "give color_depth= 8 or 16, which decides it for all rows"


class Valued(Part, Protocol):
    """Consecutive rows of a source, with their values."""

    @property
    def schema(self) -> Schema:
        """What the values are."""

    def records(self) -> Array:
        """Read the rows and their values; nobody else writes to the result."""


@dataclass(frozen=True)
class HeldPart:
    """Rows in memory, with their values."""

    held: Array
    schema: Schema
    origin: Origin
    place: None = None

    @property
    def rows(self) -> int:
        """How many."""
        return len(self.held)

    def read(self) -> Array:
        """Copy the planar positions."""
        return _planar(self.held)

    def records(self) -> Array:
        """Copy the records."""
        copied: Array = self.held.copy()
        return copied

    def saved(self, path: Path) -> Valued:
        """Write the records to a file."""
        return in_record_file(self.held, path, self.schema, self.origin)


@dataclass(frozen=True)
class FilePart:
    """Rows in a file of records, with their values."""

    place: str
    rows: int
    schema: Schema
    origin: Origin

    def read(self) -> Array:
        """Read the planar positions."""
        return _planar(self.records())

    def records(self) -> Array:
        """Read the records."""
        path = Path(self.place)
        return values_of(path, 0, self.rows, kind_of(path))


@dataclass(frozen=True)
class NpyHeightPart:
    """Rows of an NPY file: the third column, if there is one, holds their heights."""

    part: NpyPart
    schema: Schema

    @property
    def rows(self) -> int:
        """How many."""
        return self.part.rows

    @property
    def origin(self) -> Origin:
        """Where they are from."""
        return self.part.origin

    @property
    def place(self) -> str:
        """The file."""
        return self.part.place

    def read(self) -> Array:
        """Read the planar positions."""
        return self.part.read()

    def records(self) -> Array:
        """Read the coordinates."""
        try:
            points = widened(as_coordinates(self.part.columns()))
        except InputError as error:
            raise type(error)(f"{self.origin.source}: {error}") from error
        found = np.zeros(len(points), self.schema.dtype)
        for (name, _), column in zip(POSITION, points.T, strict=False):
            found[name] = column
        return found


def read_part(part: Part) -> tuple[Floats, Array | None]:
    """Read the planar positions of a part, and its records if it has values."""
    if not hasattr(part, "records"):
        return planar(part), None
    records = cast("Valued", part).records()
    return _planar(records), records


def planar_of(rows: Array) -> Floats:
    """Return planar positions."""
    return rows if rows.dtype.names is None else _planar(rows)


def _planar(records: Array) -> Floats:
    return np.stack([records["x"], records["y"]], axis=1)


@dataclass(frozen=True)
class Reading:
    """How the rows of a surface are read."""

    crs: str | None = None
    options: Mapping[str, Any] = field(default_factory=FrozenDict)

    def changed(self, cloud: Cloud) -> Cloud:
        """Give a cloud the coordinate system that the caller says."""
        return cloud if self.crs is None else replace(cloud, crs=self.crs)


def valued_parts(
    source: object, rows: int, scratch: Path, reading: Reading, show: Progress = unheard
) -> list[Valued]:
    """Cut a source into parts with values."""
    files = files_of(source)
    if files is not None:
        given = readings([f.source for f in files], reading)
        each = (
            valued_parts_of_file(f, f.source, rows, scratch, given[k], nth(show, k, len(files)))
            for k, f in enumerate(files)
        )
        return alike([part for parts in each for part in parts])
    if reading.options:
        raise InputError(f"{', '.join(reading.options)}: options of files, and there is no file")
    if isinstance(source, Iterator):
        clouds = (reading.changed(as_cloud(chunk)) for chunk in of_iterator(source, show))
        return alike(spooled(clouds, rows, scratch, Origin("iterator")))
    if isinstance(source, np.memmap) and reading.crs is None:
        found = parts_of(source, rows, scratch)
        if all(isinstance(part, NpyPart) for part in found):
            return [NpyHeightPart(cast("NpyPart", part), Schema()) for part in found]
    return _of_cloud(reading.changed(as_cloud(source)), rows)


def valued_parts_of_file(
    origin: Origin,
    name: str,
    rows: int,
    scratch: Path,
    reading: Reading,
    show: Progress = unheard,
) -> list[Valued]:
    """Cut a file into parts with values."""
    suffix = Path(name).suffix.lower()
    if suffix == ".npy" and not reading.options:
        schema = Schema(crs=reading.crs)
        return [NpyHeightPart(part, schema) for part in npy_parts(origin, name, rows)]
    if suffix in (".parquet", ".pq"):
        if reading.options:
            given = ", ".join(reading.options)
            raise InputError(f"{name}: rows of Parquet are read as they are: leave out {given}")
        clouds: Iterable[Cloud] = parquet_clouds(name, rows)
    else:
        clouds = read_chunks(name, rows=rows, **reading.options)
    return spooled(map(reading.changed, of_file(clouds, show)), rows, scratch, origin)


def _of_cloud(cloud: Cloud, rows: int) -> list[Valued]:
    schema = schema_of(cloud)
    return [
        HeldPart(records_from(cloud.select(slice(i, i + rows))), schema, Origin("array", row=i))
        for i in range(0, len(cloud), rows)
    ]


def spooled(clouds: Iterable[Cloud], rows: int, scratch: Path, origin: Origin) -> list[Valued]:
    """Write clouds, which come once, to files of so many records."""
    seen: list[Schema] = []

    def write(records: Array, path: Path, at: Origin) -> Valued:
        return in_record_file(records, path, seen[0], at)

    return written(_records_of(clouds, seen, origin.source), rows, scratch, origin, write)


def _records_of(clouds: Iterable[Cloud], seen: list[Schema], name: str) -> Iterator[Array]:
    """Yield the rows of clouds that all have one schema, which is noted."""
    for cloud in clouds:
        if len(cloud):
            schema = schema_of(cloud)
            seen[:] = seen or [schema]
            _check_alike(seen[0], schema, name, "what came before")
            yield records_from(cloud)


def in_record_file(records: Array, path: Path, schema: Schema, origin: Origin) -> FilePart:
    """Write records to a file."""
    save_array(path, records)
    return FilePart(str(path), len(records), schema, origin)


def alike(parts: list[Valued]) -> list[Valued]:
    """Return parts whose rows all have the same values."""
    for part in parts[1:]:
        first = parts[0]
        _check_alike(first.schema, part.schema, part.origin.source, first.origin.source)
    return parts


def _unit_of(schema: Schema) -> str:
    return "no stated unit" if schema.unit is None else shown(schema.unit)


def _check_alike(first: Schema, other: Schema, name: str, before: str) -> None:
    if other.crs != first.crs:
        raise InputError(
            f"{name} is in {shown(other.crs)}, {before} in {shown(first.crs)}: give to_crs= or crs="
        )
    if other.unit != first.unit:
        raise InputError(
            f"the band of {name} says that heights are in {_unit_of(other)}, that of {before} in "
            f"{_unit_of(first)}: convert one, or give to_crs= with a system that names a unit"
        )
    if other.names == first.names and other.color_depth != first.color_depth:
        raise InputError(
            f"{name} has colours of {other.color_depth} bits, {before} of {first.color_depth}: "
            f"{_DEPTH}"
        )
    if other.fields != first.fields:
        raise InputError(
            f"{name} has the values {_listed(other)}, {before} has {_listed(first)}: "
            "all rows need the same"
        )


def _listed(schema: Schema) -> str:
    names = [f"{name} ({np.dtype(kind)}{shape or ''})" for name, kind, shape in schema.fields]
    return ", ".join(names) or "no names"
