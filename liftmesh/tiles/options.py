"""The options of `tile` and `tile_surface`, and the types of a run: memory, files, tasks done.

Tasks are told folders, groups of tiles, and who calls tasks (`RunContext`). The rows of a chunk are
sorted by tile. In one file, they would all be needed until the last tile is done. So there is a
file for each group of consecutive tiles, and when all tiles of a group are on the disk, its files
of all chunks are removed (`schedule.release`): the triangles take their place.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Protocol

import numpy as np

from liftmesh._typing import Array
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
from liftmesh.crs.comparison import given_text
from liftmesh.errors import InputError
from liftmesh.tiles.schema import Reading, Schema

if TYPE_CHECKING:
    from liftmesh.tiles.plan import Plan
    from liftmesh.tiles.source_chunks import SourceChunk

_LINES = "lines of all tiles would have to be known before any"
_WHOLE = {
    **dict.fromkeys(("breaklines", "soft_breaklines", "boundary", "holes"), _LINES),
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
    surface: TiledSurfaceOptions | None = None

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
        surface: TiledSurfaceOptions | None = None,
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
class TiledSurfaceOptions:
    """The options of `tile_surface`, checked."""

    on_duplicate: str
    reading: Reading

    @classmethod
    def validated(
        cls, on_duplicate: str, plane: object, crs: Any, options: Mapping[str, Any]
    ) -> TiledSurfaceOptions:
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
        text = given_text(crs)
        if text is not None and not is_crs(text):
            raise refused("crs", crs, "give WKT or 'EPSG:n' as a string, or None")
        return cls(on_duplicate, Reading(text, as_plain(options)))

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


def as_plain(options: Mapping[str, Any]) -> dict[str, Any]:
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


_MOST = 16  # more would hardly save anything: a sixteenth of the rows is 1.5 bytes a point
_ROWS = 50_000  # of a file on average: sorting them takes a hundred times what a file takes
_FEW = 4  # groups, if chunks have fewer rows
_LEAST_ROWS = 500  # of a file even then: it takes a few kilobytes anyway
_OF_ROWS = ("", "-values")  # the ends of the names of what is sorted by tile
_BESIDE = ("-begins", "-boxes", "-skipped", "-duplicates")
_BESIDE_VALUES = ("-apart",)
JOB = "job.json"


@dataclass(frozen=True)
class Groups:
    """Groups of consecutive tiles, as equal as can be."""

    tiles: int = 1
    count: int = 1

    @classmethod
    def of_plan(cls, tiles: int, chunk_rows: int) -> Groups:
        """Choose how many groups there are."""
        wanted = max(chunk_rows // _ROWS, min(_FEW, chunk_rows // _LEAST_ROWS), 1)
        return cls(tiles, min(_MOST, tiles, wanted))

    def of(self, tile: int) -> int:
        """Return the group of a tile."""
        return tile * self.count // self.tiles

    def tiles_of(self, group: int) -> range:
        """Return the tiles of a group."""
        first, end = (-(-each * self.tiles // self.count) for each in (group, group + 1))
        return range(first, end)

    def apart(self, arrays: Mapping[str, Array]) -> dict[str, Array]:
        """Give each group its part of what is sorted by tile."""
        parts = {what: each for what, each in arrays.items() if what not in _OF_ROWS}
        begins = arrays["-begins"]
        for group in range(self.count):
            tiles = self.tiles_of(group)
            rows = slice(begins[tiles.start], begins[tiles.stop])
            parts |= {
                f"{group_suffix(group)}{what}": arrays[what][rows]
                for what in _OF_ROWS
                if what in arrays
            }
        return parts

    def names(self, *, with_values: bool, without: Collection[int] = ()) -> list[str]:
        """List what `apart` returns."""
        beside = [*_BESIDE, *(_BESIDE_VALUES if with_values else ())]
        groups = [group for group in range(self.count) if group not in without]
        return beside + [
            end for group in groups for end in row_files(group, with_values=with_values)
        ]


def group_suffix(group: int) -> str:
    """Return what the names of the files of a group have behind the name of the chunk."""
    return f"-{group:02d}"


def row_files(group: int, *, with_values: bool) -> list[str]:
    """List the ends of the names of the rows of a group in each chunk."""
    return [f"{group_suffix(group)}{what}" for what in (_OF_ROWS if with_values else _OF_ROWS[:1])]


@dataclass(frozen=True)
class RunContext:
    """Where a run writes: the triangles, and what it needs itself."""

    out: Path
    scratch: Path
    plan: str = ""
    held: int = 0  # rows of a merge whose large arrays are in memory
    chunks: int = 0  # how many there are
    groups: Groups = field(default_factory=Groups)
    released: frozenset[int] = frozenset()
    shards: ShardFormat = "npy"
    neighbors: bool = False
    has_values: bool = False
    on_duplicate: str = "first"


@dataclass(frozen=True)
class Done:
    """What a node has done."""

    name: int
    rows: int
    rows_up: int
    bytes_up: int
    triangles: int
    duplicates: int
    is_flat: bool
    frontier: tuple[int, ...]
    shards: dict[str, str]
    notes: dict[str, str]
    vertices: int = 0
    overhangs: int = 0
    box: tuple[float, ...] = ()

    @classmethod
    def from_dict(cls, said: Mapping[str, Any]) -> Done:
        """Return what a record of it says."""
        lists = {name: tuple(said[name]) for name in ("frontier", "box")}
        return cls(**{**said, **lists})


def label(name: int) -> str:
    """Name the files of a node."""
    return f"seam-{name:05d}" if name >= 0 else f"tile-{~name:05d}"


def node_of(stem: str) -> int:
    """Return the node whose files have a name."""
    kind, number = stem.split("-")
    return int(number) if kind == "seam" else ~int(number)


class Runner(Protocol):
    """What calls tasks."""

    def chunks(
        self, source: object, rows: int, scratch: Path, reading: Reading
    ) -> list[SourceChunk]:
        """Cut a source into chunks that all tasks can read."""

    def begin(self, rows: int) -> None:
        """Hear how many rows there are, once they are counted."""

    def each(self, stage: str, task: Callable[..., Any], calls: Sequence[tuple[Any, ...]]) -> Any:
        """Call a task with each of some arguments, in any order; return its results in order."""

    def tree(self, context: RunContext, plan: Plan, sizes: Sequence[int]) -> list[Done]:
        """Call `schedule.node` for all nodes of a plan, children first; the root is the last."""
