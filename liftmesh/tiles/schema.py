"""Rows with values as records: which fields they have, and clouds as records and back.

A record is x, y and z as doubles, then what else the cloud has, each value of its own type, without
padding. So the bytes of records depend on the values alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from liftmesh._typing import Array
from liftmesh.base.cloud import Cloud
from liftmesh.base.frozen import FrozenDict
from liftmesh.crs.units import band_unit
from liftmesh.errors import InputError
from liftmesh.io.metadata import found_columns

POSITION = [("x", "<f8"), ("y", "<f8"), ("z", "<f8")]
ROW = ("row", "<i8")  # before the position, in what is written for a shard
_PARTS = ("colors", "normals")
_RESERVED = {ROW[0], *(name for name, _ in POSITION), *_PARTS}


@dataclass(frozen=True)
class Schema:
    """What the rows of a cloud have besides a position."""

    fields: tuple[tuple[Any, ...], ...] = ()
    crs: str | None = None
    color_depth: int | None = None
    columns: Mapping[str, str] = field(default_factory=FrozenDict)
    unit: str | None = None

    @property
    def names(self) -> list[str]:
        """The names of the values."""
        return [name for name, _, _ in self.fields]

    @property
    def metadata(self) -> dict[str, Any]:
        """What a cloud says of the unit."""
        return {} if self.unit is None else {"raster": {"unit": self.unit}}

    @property
    def dtype(self) -> np.dtype[Any]:
        """The type of a record."""
        return np.dtype([*POSITION, *self.fields])

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


def schema_of(cloud: Cloud) -> Schema:
    """Tell what the rows of a cloud have."""
    fields = []
    for name, values in _values_of(cloud).items():
        if name in _RESERVED and name not in _PARTS:
            raise InputError(f"values named {name!r} cannot be kept beside a position: rename them")
        if values.dtype.hasobject:
            raise InputError(f"the values {name!r} are objects of Python: convert them to numbers")
        fields.append((name, values.dtype.str, values.shape[1:]))
    columns = FrozenDict(found_columns(cloud.metadata))
    unit = band_unit(cloud)
    said = None if unit is None else unit.name
    return Schema(tuple(fields), cloud.crs, cloud.color_depth, columns, said)


def records_from(cloud: Cloud) -> Array:
    """Put the rows of a cloud and their values into records."""
    found = np.empty(len(cloud), schema_of(cloud).dtype)
    for k, (name, _) in enumerate(POSITION):
        found[name] = cloud.points[:, k]
    for name, values in _values_of(cloud).items():
        found[name] = values
    return found


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
