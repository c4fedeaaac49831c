"""Rows as records: which fields they have, and clouds as records and back.

A record of plain points is x and y, as doubles. That of a surface is x, y and z, then what else the
cloud has, each value of its own type, without padding. So the bytes of records depend on the values
alone.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.arrays import as_coordinates, widened
from liftmesh.base.cloud import Cloud
from liftmesh.base.frozen import FrozenDict
from liftmesh.base.options import shown
from liftmesh.crs.units import band_unit
from liftmesh.errors import InputError, Option
from liftmesh.io.metadata import Provenance

POSITION = [("x", "<f8"), ("y", "<f8"), ("z", "<f8")]
ROW = ("row", "<i8")  # before the position, in what is written for a shard
_PARTS = ("colors", "normals")
_DEPTH = f"give {Option('color_depth', ...)} 8 or 16, which decides it for all rows"
_RESERVED = {ROW[0], *(name for name, _ in POSITION), *_PARTS}


@dataclass(frozen=True)
class Schema:
    """What rows have: a position, in space unless `is_planar`, and the values of a cloud."""

    fields: tuple[tuple[Any, ...], ...] = ()
    crs: str | None = None
    color_depth: int | None = None
    columns: Mapping[str, str] = field(default_factory=FrozenDict)
    unit: str | None = None
    is_planar: bool = False

    @property
    def names(self) -> list[str]:
        """The names of the values."""
        return [name for name, _, _ in self.fields]

    @property
    def metadata(self) -> dict[str, Any]:
        """What a cloud says of the unit."""
        return {} if self.unit is None else {"raster": {"unit": self.unit}}

    @property
    def position(self) -> list[tuple[str, str]]:
        """The fields of the position."""
        return POSITION[:2] if self.is_planar else POSITION

    @property
    def dtype(self) -> np.dtype[Any]:
        """The type of a record."""
        return np.dtype([*self.position, *self.fields])

    def as_dict(self) -> dict[str, Any]:
        """Return what JSON holds."""
        fields = [[name, kind, list(shape)] for name, kind, shape in self.fields]
        return {
            "fields": fields,
            "crs": self.crs,
            "color_depth": self.color_depth,
            "columns": dict(self.columns),
            **({} if self.unit is None else {"unit": self.unit}),
        }

    @classmethod
    def from_dict(cls, said: Mapping[str, Any]) -> Schema:
        """Return the schema of such a dictionary."""
        fields = tuple((name, kind, tuple(shape)) for name, kind, shape in said["fields"])
        columns = FrozenDict(said["columns"])
        return cls(fields, said["crs"], said["color_depth"], columns, said.get("unit"))


PLANAR = Schema(is_planar=True)


@dataclass(frozen=True)
class Reading:
    """How rows are read: x and y alone, or those of a surface."""

    crs: str | None = None
    options: Mapping[str, Any] = field(default_factory=FrozenDict)  # of `read_chunks`
    is_planar: bool = False

    @property
    def schema(self) -> Schema:
        """What rows without values have."""
        return PLANAR if self.is_planar else Schema(crs=self.crs)

    def changed(self, cloud: Cloud) -> Cloud:
        """Give a cloud the coordinate system that the caller says."""
        return cloud if self.crs is None else replace(cloud, crs=self.crs)


@contextmanager
def naming(source: str) -> Iterator[None]:
    """Let errors of input begin with the source of the rows."""
    try:
        yield
    except InputError as error:
        error.within(source)
        raise


def records_of_points(points: Array, schema: Schema, source: str) -> Array:
    """Put rows of two or three numbers into records, without rounding."""
    with naming(source):
        exact = widened(as_coordinates(points))
    if schema.is_planar:
        return np.ascontiguousarray(exact[:, :2]).view(schema.dtype).reshape(-1)
    records = np.zeros(len(exact), schema.dtype)
    for (name, _), column in zip(schema.position, exact.T, strict=False):
        records[name] = column
    return records


def planar_of(records: Array) -> Floats:
    """Return x and y as rows; those of planar records stay in the same memory."""
    if heights_of(records) is None:
        return np.ascontiguousarray(records).view(np.float64).reshape(-1, 2)
    return np.stack([records["x"], records["y"]], axis=1)


def heights_of(records: Array) -> Floats | None:
    """Return z; None for planar records."""
    return records["z"] if "z" in (records.dtype.names or ()) else None


def schema_of(cloud: Cloud) -> Schema:
    """Tell what the rows of a cloud have."""
    fields = []
    for name, values in _values_of(cloud).items():
        if name in _RESERVED and name not in _PARTS:
            raise InputError(f"values named {name!r} cannot be kept beside a position: rename them")
        if values.dtype.hasobject:
            raise InputError(f"the values {name!r} are objects of Python: convert them to numbers")
        fields.append((name, values.dtype.str, values.shape[1:]))
    columns = FrozenDict(Provenance(cloud.metadata).columns)
    unit = band_unit(cloud)
    said = None if unit is None else unit.name
    return Schema(tuple(fields), cloud.crs, cloud.color_depth, columns, said)


def records_from(cloud: Cloud) -> Array:
    """Put the rows of a cloud and their values into records."""
    records = np.empty(len(cloud), schema_of(cloud).dtype)
    for k, (name, _) in enumerate(POSITION):
        records[name] = cloud.points[:, k]
    for name, values in _values_of(cloud).items():
        records[name] = values
    return records


def cloud_from(records: Array, schema: Schema) -> Cloud:
    """Make a cloud of records."""
    values = {name: np.ascontiguousarray(records[name]) for name, _, _ in schema.fields}
    parts: dict[str, Any] = {name: values.pop(name) for name in _PARTS if name in values}
    points = np.stack([records[name] for name, _ in POSITION], axis=1)
    depth = schema.color_depth
    said: dict[str, Any] = {"metadata": schema.metadata, "crs": schema.crs, "color_depth": depth}
    return Cloud(points, **parts, attributes=values, **said)


def _values_of(cloud: Cloud) -> dict[str, Array]:
    parts = {"colors": cloud.colors, "normals": cloud.normals}
    named = {name: values for name, values in cloud.attributes.items() if name not in _PARTS}
    if len(named) < len(cloud.attributes):
        raise InputError("values named 'colors' or 'normals' cannot be kept: rename them")
    return {name: values for name, values in parts.items() if values is not None} | named


def check_alike(first: Schema, other: Schema, name: str, before: str) -> None:
    """Raise if rows of a source have other values than those before."""
    if other.crs != first.crs:
        raise InputError(
            f"{name} is in {shown(other.crs)}, {before} in {shown(first.crs)}: "
            f"give {Option('dst_crs', ...)} or {Option('src_crs', ...)}"
        )
    if other.unit != first.unit:
        raise InputError(
            f"the band of {name} says that heights are in {_unit_of(other)}, that of {before} in "
            f"{_unit_of(first)}: convert one, or give {Option('dst_crs', ...)} with a system that "
            "names a unit"
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


def _unit_of(schema: Schema) -> str:
    return "no stated unit" if schema.unit is None else shown(schema.unit)


def _listed(schema: Schema) -> str:
    names = [f"{name} ({np.dtype(kind)}{shape or ''})" for name, kind, shape in schema.fields]
    return ", ".join(names) or "no names"
