"""A node of the tree of merges: which triangles are final, and what it hands up.

ARCHITECTURE.md has the proof that the triangles of all nodes are those of one call.

Equal positions share a tile, so a tile of a surface knows all rows at a position, in their order,
and chooses among them as `triangulate` does, by the same function. From then on that row stands for
the position: triangles, hulls and frontiers name it. The values of what goes up go with it, so
every node knows those of all its corners. Of a position at which very many rows are, the rows that
are needed come into the tile (`plan.set_apart`); the others are only told apart, into duplicates
and overhangs, when the choice is known.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Integers, Rows
from liftmesh.base.arrays import MOST_ROWS
from liftmesh.errors import InputError
from liftmesh.terrain.equal_positions import choose_rows
from liftmesh.tiles.plan import positions_of
from liftmesh.tiles.schema import ROW


@dataclass(frozen=True)
class Frontier:
    """What later merges can still change of a node."""

    records: Integers
    rim: Rows = field(default_factory=lambda: np.empty((0, 2), dtype=np.int32))

    def __len__(self) -> int:
        return len(self.records)

    @property
    def nbytes(self) -> int:
        """The size of both arrays in bytes."""
        return self.records.nbytes + self.rim.nbytes


@dataclass(frozen=True)
class Merged:
    """What a node decides."""

    triangles: Integers
    duplicates: Integers
    hull: Integers
    frontier: Frontier
    is_flat: bool
    neighbors: Rows = field(default_factory=lambda: np.empty((0, 3), dtype=np.int32))


def joined(parts: Sequence[Frontier]) -> Frontier:
    """Put frontiers side by side."""
    if len(parts) == 1:
        return parts[0]
    begins = np.cumsum([0, *(len(part) for part in parts[:-1])], dtype=np.int64)
    rims = [part.rim + np.int32(begin) for part, begin in zip(parts, begins, strict=True)]
    return Frontier(np.concatenate([part.records for part in parts]), np.concatenate(rims))


def merge(
    part: Frontier,
    cell: Sequence[float],
    foreign: Floats,
    *,
    is_root: bool,
    with_neighbors: bool = False,
    threads: int = 1,
    scratch: str | None = None,
) -> Merged:
    """Triangulate what is open in a node, and settle what no other point can change."""
    if len(part) > MOST_ROWS:
        raise InputError(
            f"{len(part):,} points come together in one merge, more than {MOST_ROWS:,}: too many "
            "are equal, or on one circle or line; thin them out"
        )
    boxes = np.ascontiguousarray(foreign, dtype=np.float64)
    status, missing, triangles, neighbors, duplicates, hull, records, rim = _kernel.merge_frontiers(
        part.records,
        part.rim,
        np.array([cell]),
        boxes,
        is_root,
        with_neighbors,
        threads,
        False,
        None,
        scratch,
    )
    if missing or status == "non-finite":
        raise RuntimeError(f"frontiers do not fit together: {missing} edges of the rim are missing")
    flat = status != "ok"
    return Merged(triangles, duplicates, hull, Frontier(records, rim), flat, neighbors)


@dataclass(frozen=True)
class Vertices:
    """What a node of a tiled surface decides."""

    merged: Merged
    shard: Array
    faces: Rows
    up: Array
    overhangs: int
    heights: Floats


def numbered_by_place(part: Frontier) -> tuple[Frontier, Integers]:
    """Call the points of a node by their places, from 0 on."""
    records = np.array(part.records)
    places = records.copy()
    places[:, 0] = np.arange(len(places))
    return replace(part, records=places), records


def choose_vertices(
    merged: Merged, records: Integers, values: Array, policy: str, repeated: Floats
) -> Vertices:
    """Choose the row that stands for each position, and name it instead of the place."""
    rows = records[:, 0]
    pairs = merged.duplicates.astype(np.int32)
    positions = records[:, 1:].view(np.float64)
    choice = choose_rows(pairs, values["z"], positions, policy, rows)
    chosen = np.arange(len(rows))
    chosen[choice.kept] = choice.chosen
    alone = np.delete(np.arange(len(rows)), pairs[:, 0])  # one place for each position
    heights = _heights_at(repeated, positions[alone], values["z"][chosen[alone]])
    values = np.array(values)
    values["z"][choice.moved] = choice.new_heights
    places = chosen[merged.frontier.records[:, 0]]
    renamed = Merged(
        rows[chosen[merged.triangles]],
        np.column_stack((rows[choice.left_out], rows[choice.representatives])),
        rows[chosen[merged.hull]],
        replace(merged.frontier, records=records[places]),
        merged.is_flat,
        merged.neighbors,
    )
    shard, faces = mesh_of(chosen[merged.triangles], rows, values)
    overhangs = int(np.count_nonzero(choice.overhanging))
    return Vertices(renamed, shard, faces, values[places], overhangs, heights)


def mesh_of(triangles: Array, rows: Integers, values: Array) -> tuple[Array, Rows]:
    """Take the corners of triangles out of all points."""
    is_corner = np.zeros(len(rows), dtype=np.bool_)
    is_corner[triangles.reshape(-1)] = True
    corners = np.flatnonzero(is_corner)
    corners = corners[np.argsort(rows[corners])]
    number = np.empty(len(rows), dtype=np.int32)
    number[corners] = np.arange(len(corners), dtype=np.int32)
    return with_rows(rows[corners], values[corners]), number[triangles]


def with_rows(rows: Integers, values: Array) -> Array:
    """Put rows and their values into records."""
    kind = values.dtype
    fields: list[Any] = [ROW, *((name, kind[name]) for name in kind.names or ())]
    records = np.empty(len(rows), fields)
    records[ROW[0]] = rows
    for name in kind.names or ():
        records[name] = values[name]
    return records


def _heights_at(repeated: Floats, positions: Floats, heights: Floats) -> Floats:
    """List the heights at positions of a plan: its number, and the height."""
    if not len(repeated):
        return np.empty((0, 2))
    sought, here = positions_of(repeated), positions_of(positions)
    at = np.minimum(np.searchsorted(sought, here), len(sought) - 1)
    is_there = sought[at] == here
    return np.column_stack((at[is_there].astype(np.float64), heights[is_there]))


def overhangs_apart(apart: Iterable[Path], chosen: Sequence[Path]) -> int:
    """Count the rows that are in no tile and at another height than the chosen one."""
    pairs = np.concatenate([np.empty((0, 2)), *(np.load(path) for path in chosen)])
    if not len(pairs):
        return 0
    heights = np.full(int(pairs[:, 0].max()) + 1, np.nan)
    heights[pairs[:, 0].astype(np.int64)] = pairs[:, 1]
    count = 0
    for path in apart:
        which, height = np.load(path).T
        at = which.astype(np.int64)
        count += int((heights[at] != height).sum())
    return count


def box_of(vertices: Array) -> tuple[float, ...]:
    """Return the least and the greatest x, y and z."""
    axes = [vertices[name] for name in ("x", "y", "z")]
    return (*(float(a.min()) + 0.0 for a in axes), *(float(a.max()) + 0.0 for a in axes))
