"""What the tasks of a run are told: folders, groups of tiles, and who calls tasks.

The rows of a chunk are sorted by tile. In one file, they would all be needed until the last tile is
done. So there is a file for each group of consecutive tiles, and when all tiles of a group are on
the disk, its files of all chunks are removed (`schedule.release`): the triangles take their place.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from liftmesh._typing import Array
from liftmesh.base.options import ShardFormat

if TYPE_CHECKING:
    from liftmesh.tiles.plan import Plan
    from liftmesh.tiles.schema import Reading
    from liftmesh.tiles.source_chunks import SourceChunk

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
        """Call `stages.node` for all nodes of a plan, children first; the root is the last."""
