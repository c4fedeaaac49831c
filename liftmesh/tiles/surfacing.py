"""What a surface in tiles takes besides the options of `tile`: a policy, and how rows are read."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from liftmesh.base.cloud import is_crs
from liftmesh.base.options import Duplicates, ShardFormat, as_folder, check_option, shown
from liftmesh.errors import InputError
from liftmesh.tiles.clouds import Reading, Valued

if TYPE_CHECKING:
    from liftmesh.tiles.schema import Schema
    from liftmesh.tiles.sources import Part

_WHOLE = {
    "weights": "the merges of tiles know Delaunay triangles alone",
    "radii": "the merges of tiles know Delaunay triangles alone",
    "metric": "the merges of tiles know Delaunay triangles alone",
    "max_edge": "what trimming takes away depends on faces all along the border",
}


@dataclass(frozen=True)
class Surfacing:
    """The options of a surface, checked."""

    duplicates: str
    reading: Reading

    @classmethod
    def checked(
        cls, duplicates: str, plane: object, crs: str | None, options: Mapping[str, Any]
    ) -> Surfacing:
        """Check the options."""
        check_option("duplicates", duplicates, Duplicates)
        if not isinstance(plane, str) or plane != "xy":
            raise InputError(
                f"plane is {shown(plane)}: surfaces in tiles are over x and y; turn the points "
                "first, or triangulate them in one call"
            )
        for name, reason in _WHOLE.items():
            if name in options:
                raise InputError(f"{name} is for surfaces in one call: {reason}")
        if crs is not None and not is_crs(crs):
            raise InputError(f"crs is {shown(crs)}: give WKT or 'EPSG:n' as a string, or None")
        return cls(duplicates, Reading(crs, as_json(options)))

    def check_shards(self, shards: ShardFormat) -> None:
        """Raise if the triangles of a surface cannot be in a format."""
        if shards != "npy":
            raise InputError(
                f"shards is {shown(shards)}: a surface has NPY, with vertices and faces beside the "
                "triangles; TiledSurface.meshes() gives each shard for a file of any format"
            )

    def as_dict(self, schema: Schema) -> dict[str, Any]:
        """Return what the files of a run depend on."""
        return {
            "duplicates": self.duplicates,
            "reading": dict(self.reading.options),
            **schema.as_dict(),
        }


def schema_of_parts(parts: Sequence[Part]) -> Schema:
    """Return what the rows of all parts have."""
    return cast("Valued", parts[0]).schema


def as_json(options: Mapping[str, Any]) -> dict[str, Any]:
    """Check that options of reading can be written down, to read the same rows again."""
    return {name: _plain(name, value) for name, value in options.items()}


def _plain(name: str, value: Any) -> Any:
    if value is None or isinstance(value, str | int | float):
        return value
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, os.PathLike):
        return as_folder(name, value)
    if isinstance(value, Mapping):
        return {str(key): _plain(name, each) for key, each in value.items()}
    try:
        return [_plain(name, each) for each in value]
    except TypeError as error:
        raise InputError(f"{name} is {shown(value)}: give numbers, names or lists") from error
