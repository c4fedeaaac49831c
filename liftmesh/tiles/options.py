"""The options of `tile` and `tile_surface`, checked, and how many rows of a tile fit in memory."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from liftmesh.base.cloud import is_crs
from liftmesh.base.options import (
    NonFinite,
    OnDuplicate,
    ShardFormat,
    as_count,
    as_folder,
    as_switch,
    check_option,
    refused,
)
from liftmesh.errors import InputError
from liftmesh.tiles.context import RunContext
from liftmesh.tiles.schema import Reading

if TYPE_CHECKING:
    from liftmesh.tiles.schema import Schema

_WHOLE = {
    "weights": "the merges of tiles know Delaunay triangles alone",
    "radii": "the merges of tiles know Delaunay triangles alone",
    "metric": "the merges of tiles know Delaunay triangles alone",
    "max_edge": "what trimming takes away depends on faces all along the border",
}
TILE_ROWS = 1_500_000  # about 300 MB
_LEAST = 16  # rows of a tile
_PROCESS_BYTES = 100_000_000  # of a process without work
ROW_BYTES = 200  # of a tile
SURFACE_ROW_BYTES = 400  # with a few values
_SHARE = 0.6  # of a limit: beyond that Dask takes measures
_FEWEST = 50_000  # rows of a tile: with fewer, most of them would go up
SCRATCH = ".liftmesh-tiles"


@dataclass(frozen=True)
class Options:
    """The options of `tile`, checked; a size of None is for the run to choose."""

    context: RunContext
    tile_rows: int | None
    skips: bool
    resumes: bool
    surface: SurfaceOptions | None = None

    @property
    def reading(self) -> Reading:
        """How the rows of the source are read."""
        return Reading(is_planar=True) if self.surface is None else self.surface.reading

    @classmethod
    def validated(
        cls,
        out: str | os.PathLike[str],
        tile_rows: int | Literal["auto"],
        scratch: str | os.PathLike[str] | None,
        nonfinite: NonFinite,
        resume: bool,
        shards: ShardFormat,
        neighbors: bool,
        surface: SurfaceOptions | None = None,
    ) -> Options:
        """Check the options."""
        check_option("nonfinite", nonfinite, NonFinite)
        resumes = as_switch("resume", resume)
        is_auto = isinstance(tile_rows, str) and tile_rows == "auto"
        rows = None if is_auto else as_count("tile_rows", tile_rows, _LEAST)
        check_option("shards", shards, ShardFormat)
        if surface is not None:
            surface.check_shards(shards)
        is_linked = as_switch("neighbors", neighbors)
        context = replace(folders_of(out, scratch), shards=shards, neighbors=is_linked)
        return cls(context, rows, nonfinite == "skip", resumes, surface)


@dataclass(frozen=True)
class SurfaceOptions:
    """The options of a surface, checked."""

    on_duplicate: str
    reading: Reading

    @classmethod
    def validated(
        cls, on_duplicate: str, plane: object, crs: str | None, options: Mapping[str, Any]
    ) -> SurfaceOptions:
        """Check the options."""
        check_option("on_duplicate", on_duplicate, OnDuplicate)
        if not isinstance(plane, str) or plane != "xy":
            raise refused(
                "plane",
                plane,
                "surfaces in tiles are over x and y; turn the points first, or triangulate them in "
                "one call",
            )
        for name, reason in _WHOLE.items():
            if name in options:
                raise InputError(f"{name} is for surfaces in one call: {reason}")
        if crs is not None and not is_crs(crs):
            raise refused("crs", crs, "give WKT or 'EPSG:n' as a string, or None")
        return cls(on_duplicate, Reading(crs, as_json(options)))

    def check_shards(self, shards: ShardFormat) -> None:
        """Raise if the triangles of a surface cannot be in a format."""
        if shards != "npy":
            raise refused(
                "shards",
                shards,
                "a surface has NPY, with vertices and faces beside the triangles; "
                "TiledSurface.iter_meshes() gives each shard for a file of any format",
            )

    def as_dict(self, schema: Schema) -> dict[str, Any]:
        """Return what the files of a run depend on."""
        return {
            "on_duplicate": self.on_duplicate,
            "reading": dict(self.reading.options),
            **schema.as_dict(),
        }


def folders_of(out: str | os.PathLike[str], scratch: str | os.PathLike[str] | None) -> RunContext:
    """Name the folders of a run."""
    target = Path(os.path.abspath(as_folder("out", out)))  # noqa: PTH100 - links stay
    if scratch is None:
        return RunContext(target, target / SCRATCH)
    tag = hashlib.sha256(os.fsencode(target)).hexdigest()[:16]
    place = os.path.abspath(as_folder("scratch", scratch))  # noqa: PTH100 - as above
    return RunContext(target, Path(place) / f"{SCRATCH}-{tag}")


def rows_within(memory: int, threads: int = 1, row_bytes: int = ROW_BYTES) -> int:
    """Return how large tiles may be."""
    least = int((_PROCESS_BYTES + _FEWEST * row_bytes * threads) / _SHARE)
    if memory < least:
        raise InputError(
            f"{memory / 1e6:,.0f} MB of memory do not hold a process with a tile for each of its "
            f"{threads} threads: {least / 1e6:,.0f} MB are needed at least"
        )
    return int(_SHARE * memory - _PROCESS_BYTES) // (row_bytes * threads)


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
        raise refused(name, value, "give numbers, names or lists") from error
