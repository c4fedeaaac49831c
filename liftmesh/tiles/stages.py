"""The tasks of nodes, which are tiles and merges; each reads and writes files, in any process.

A task that finds its work done, and the files sound, returns what it returned then. So a run that
was killed resumes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Array, Integers
from liftmesh.tiles.adjacency import open_edges, paired
from liftmesh.tiles.context import Done, RunContext, label
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
from liftmesh.tiles.shards import save_shard
from liftmesh.tiles.sorted_chunks import load_plan, tile_records, tile_values
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
