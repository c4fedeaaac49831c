"""The order in which the tasks of a tiled run are done, who runs them, and when rows are removed.

A runner calls tasks and collects what they return. `Serial` calls one after the other, in this
process; `liftmesh.dask` hands them to workers.

Scratch space is given back: rows are removed once their tiles are on the disk. No record says that
a group of tiles was released: the records of its tiles do, which are sealed and name the SHA-256 of
what was written. So whenever a run is stopped, before, while or after files are removed, the next
one needs the rows of those groups of which a tile is not done, or is damaged, and no others. Rows
that are missing then are sorted again from the source (`sorted_chunks.partition`).

The tasks of nodes, which are tiles and merges, each read and write files, in any process. A task
that finds its work done, and the files sound, returns what it returned then. So a run that was
killed resumes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Integers, Progress
from liftmesh.tiles.adjacency import open_edges, paired
from liftmesh.tiles.node import (
    Frontier,
    Merged,
    Vertices,
    box_of,
    choose_vertices,
    joined,
    merge,
    numbered_by_place,
)
from liftmesh.tiles.options import Done, RunContext, Runner, label, row_files
from liftmesh.tiles.shards import save_shard
from liftmesh.tiles.sorted_chunks import load_plan, stem_of, tile_records, tile_values
from liftmesh.tiles.sources import source_chunks
from liftmesh.tiles.store import (
    concatenated,
    is_sound,
    load_record,
    names_to_disk,
    save_array,
    save_record,
)

if TYPE_CHECKING:
    from liftmesh.tiles.plan import Plan
    from liftmesh.tiles.schema import Reading
    from liftmesh.tiles.source_chunks import SourceChunk

SHARES = {
    "open": 0, "spool": 5, "scan": 1, "check": 0, "partition": 2, "triangulate": 7, "link": 0
}  # fmt: skip
"""What the stages take of the whole, about; to spool, which is to copy, only if a source is."""


class Meter:
    """Counts what is done of the stages, for `progress`."""

    def __init__(self, progress: Progress | None) -> None:
        self._progress = progress
        self._before = 0.0
        self._shares = {**SHARES, "spool": 0}

    def begin(self, rows: int) -> None:
        """Tell how many rows there are, if anybody wants to know."""
        tell = getattr(self._progress, "begin", None)
        if tell is not None:
            tell(rows)

    def show(self, stage: str, share: float) -> None:
        """Report which share of a stage is done; what opens a source comes before `begin`."""
        if stage == "spool":
            self._shares = SHARES
        if self._progress is not None and stage != "open":
            shares = [*self._shares.values()]
            passed = [*self._shares].index(stage)
            units = sum(shares[:passed]) + shares[passed] * share
            self._before = max(self._before, min(1.0, units / sum(shares)))
            self._progress(self._before)


class Serial:
    """Calls tasks one after the other, each with some threads."""

    def __init__(self, threads: int, progress: Progress | None = None) -> None:
        self._threads = threads
        self._meter = Meter(progress)

    def chunks(
        self, source: object, rows: int, scratch: Path, reading: Reading
    ) -> list[SourceChunk]:
        """Cut a source into chunks; progress is that of copying what cannot be read by ranges."""
        return source_chunks(source, rows, scratch, reading, partial(self._meter.show, "spool"))

    def begin(self, rows: int) -> None:
        """Hear how many rows there are."""
        self._meter.begin(rows)

    def each(self, stage: str, task: Callable[..., Any], calls: Sequence[tuple[Any, ...]]) -> Any:
        """Call a task with each of some arguments."""
        results = []
        for arguments in calls:
            results.append(task(*arguments))
            self._meter.show(stage, len(results) / len(calls))
        return results

    def tree(self, context: RunContext, plan: Plan, sizes: Sequence[int]) -> list[Done]:
        """Work through a plan; a merge comes as soon as its children are done."""
        done: dict[int, Done] = {}
        rows, total = 0, max(1, sum(sizes))
        for name, children in in_order(plan):
            done[name] = node(context, name, [done[child] for child in children], self._threads)
            if name < 0:
                rows += sizes[~name]
                self._release(context, context.groups.of(~name), done)
            self._meter.show("triangulate", rows / total)
        return list(done.values())

    def _release(self, context: RunContext, group: int, done: Mapping[int, Done]) -> None:
        """Remove the rows of a group when its last tile is done."""
        tiles = [~tile for tile in context.groups.tiles_of(group)]
        if all(tile in done for tile in tiles):
            release(context, group, [done[tile] for tile in tiles])


def in_order(plan: Plan) -> list[tuple[int, list[int]]]:
    """List the nodes of a plan with their children: these first, and the root last."""
    nodes: list[tuple[int, list[int]]] = []
    waiting = [0 if plan.tiles > 1 else ~0]
    while waiting:  # parents first, then reversed
        name = waiting.pop()
        children = plan.children[name].tolist() if name >= 0 else []
        nodes.append((name, children))
        waiting += children
    return nodes[::-1]


def release(context: RunContext, group: int, done: Sequence[Done]) -> None:
    """Remove the rows of a group from all chunks."""
    if {~each.name for each in done} != {*context.groups.tiles_of(group)}:
        raise RuntimeError(f"the rows of group {group} are still needed, which is a bug")
    names_to_disk(context.scratch)  # the records of the tiles
    for number in range(context.chunks):
        for end in row_files(group, with_values=context.has_values):
            Path(f"{stem_of(context, number)}{end}.npy").unlink(missing_ok=True)


def released(runner: Runner, context: RunContext) -> frozenset[int]:
    """Find the groups whose rows are not needed."""
    groups = context.groups
    begun = [
        group
        for group in range(groups.count)
        if all((context.scratch / f"{label(~t)}.json").exists() for t in groups.tiles_of(group))
    ]
    if not begun:
        return frozenset()
    are_done = runner.each("check", is_done, [(context, group) for group in begun])
    return frozenset(group for group, done in zip(begun, are_done, strict=True) if done)


def is_done(context: RunContext, group: int) -> bool:
    """Whether all tiles of a group are done, and their files sound."""
    return all(earlier(context, ~tile) is not None for tile in context.groups.tiles_of(group))


_HOPELESS = 0.98  # a share of rows that goes up; the next level is passed, but not two in a row


def node(context: RunContext, name: int, children: Sequence[Done], threads: int) -> Done:
    """Do the work of a tile, or merge the frontiers below a cut."""
    before = earlier(context, name)
    if before is not None:
        return before
    done = _merged(context, name, children, threads)
    names_to_disk(context.out)
    save_record(_record(context, name), context.plan, asdict(done))
    return done


def earlier(context: RunContext, name: int) -> Done | None:
    """Return what a node has done in an earlier run."""
    before = load_record(_record(context, name), context.plan)
    if before is None:
        return None
    done = Done.from_dict(before)
    is_whole = is_sound(context.out, done.shards) and is_sound(context.scratch, done.notes)
    return done if is_whole else None


def is_recorded(context: RunContext, name: int) -> bool:
    """Whether a node was done in an earlier run; its files may be damaged."""
    return load_record(_record(context, name), context.plan) is not None


def _record(context: RunContext, name: int) -> Path:
    return context.scratch / f"{label(name)}.json"


def _merged(context: RunContext, name: int, children: Sequence[Done], threads: int) -> Done:
    plan = load_plan(context)
    is_root = _is_root(plan, name)
    handed, given = sum(c.rows_up for c in children), sum(c.rows for c in children)
    were_merged = all(child.frontier == (child.name,) for child in children)
    if children and not is_root and were_merged and handed > _HOPELESS * given:
        below = tuple(source for child in children for source in child.frontier)
        return Done(name, given, handed, 0, 0, 0, all(c.is_flat for c in children), below, {}, {})
    rows, merged, surface, corners = _decided(context, plan, name, children, threads)
    up = merged.frontier
    keeps: dict[str, Array] = {
        "duplicates": merged.duplicates,
        "records": up.records,
        "rim": up.rim,
    }
    if is_root:
        keeps["hull"] = merged.hull
    if context.neighbors:
        keeps["links"], keeps["edges"] = _linked(context, name, merged, children)
    if surface is not None:
        keeps |= {"values": surface.up, "heights": surface.heights}
    shards = _saved_shard(context, label(name), merged, surface, corners)
    notes = _saved(context.scratch, label(name), keeps)
    done = Done(
        name,
        rows,
        len(up),
        up.nbytes,
        len(merged.triangles),
        len(merged.duplicates),
        merged.is_flat,
        (name,),
        shards,
        notes,
    )
    return done if surface is None else _with_vertices(done, surface)


def _decided(
    context: RunContext, plan: Plan, name: int, children: Sequence[Done], threads: int
) -> tuple[int, Merged, Vertices | None, Integers]:
    """Merge what comes to a node; return how much that is, and what writing shards needs of it."""
    part = Frontier(tile_records(context, ~name)) if name < 0 else _below(context, children)
    rows = len(part)
    corners = part.records if context.shards == "ply" else part.records[:0]
    if context.has_values:
        part, corners = numbered_by_place(part)
    boxes = np.load(context.scratch / "boxes.npy")[plan.others(name)]
    merged = merge(
        part,
        plan.cells[name],
        boxes[boxes[:, 0] <= boxes[:, 2]],
        is_root=_is_root(plan, name),
        with_neighbors=context.neighbors,
        threads=threads,
        scratch=str(context.scratch) if children and rows > context.held else None,
    )
    del part
    if not context.has_values:
        return rows, merged, None, corners
    values = tile_values(context, ~name) if name < 0 else _values_below(context, children)
    repeated = plan.repeated if name < 0 else plan.repeated[:0]
    surface = choose_vertices(merged, corners, values, context.on_duplicate, repeated)
    return rows, surface.merged, surface, corners


def _is_root(plan: Plan, name: int) -> bool:
    return name == 0 or plan.tiles == 1


def _with_vertices(done: Done, surface: Vertices) -> Done:
    """Add what a node of a surface has done besides."""
    return replace(
        done,
        bytes_up=done.bytes_up + surface.up.nbytes,
        vertices=len(surface.shard),
        overhangs=surface.overhangs,
        box=box_of(surface.shard) if len(surface.shard) else (),
    )


def _saved_shard(
    context: RunContext, stem: str, merged: Merged, surface: Vertices | None, corners: Integers
) -> dict[str, str]:
    """Write triangles and what stands beside them; return the SHA-256 of the files."""
    if not len(merged.triangles):
        return {}
    shard = f"{stem}.{context.shards}"
    saved = {shard: save_shard(context.out / shard, merged.triangles, corners)}
    beside: dict[str, Array] = {"neighbors": merged.neighbors} if context.neighbors else {}
    if surface is not None:
        beside |= {"vertices": surface.shard, "faces": surface.faces}
    return saved | _saved(context.out, stem, beside)


def _saved(folder: Path, stem: str, arrays: Mapping[str, Array]) -> dict[str, str]:
    """Write arrays, each with the name of the node and its own; return the SHA-256 of the files."""
    return {
        f"{stem}-{what}.npy": save_array(folder / f"{stem}-{what}.npy", array)
        for what, array in arrays.items()
    }


def _linked(
    context: RunContext, name: int, merged: Merged, children: Sequence[Done]
) -> tuple[Integers, Integers]:
    """Pair the open edges of a node and of those below it; return links, and what goes up."""
    below = [context.scratch / f"{label(each)}-edges.npy" for c in children for each in c.frontier]
    edges = [open_edges(name, merged.triangles, merged.neighbors), *map(np.load, below)]
    return paired(np.concatenate(edges))


def _below(context: RunContext, children: Sequence[Done]) -> Frontier:
    """Read what the children handed up."""
    names = [label(source) for child in children for source in child.frontier]
    files = [
        [context.scratch / f"{name}-{what}.npy" for what in ("records", "rim")] for name in names
    ]
    parts = [Frontier(np.load(records, mmap_mode="r"), np.load(rim)) for records, rim in files]
    return joined(parts)


def _values_below(context: RunContext, children: Sequence[Done]) -> Array:
    """Read the values of what the children handed up."""
    names = [label(source) for child in children for source in child.frontier]
    return concatenated([np.load(context.scratch / f"{name}-values.npy") for name in names])
