"""In which order the tasks of a tiled triangulation run, who runs them, and which rows are removed.

A runner calls tasks and collects what they return. `Serial` calls one after the other, in this
process; `liftmesh.dask` hands them to workers.

Scratch space is given back: rows are removed once their tiles are on the disk. No record says that
a group of tiles was released: the records of its tiles do, which are sealed and name the SHA-256 of
what was written. So whenever a run is stopped, before, while or after files are removed, the next
one needs the rows of those groups of which a tile is not done, or is damaged, and no others. Rows
that are missing then are sorted again from the source (`sorted_chunks.partition`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from liftmesh._typing import Progress
from liftmesh.tiles.context import Done, RunContext, Runner, label, row_files
from liftmesh.tiles.sorted_chunks import stem_of
from liftmesh.tiles.sources import source_chunks
from liftmesh.tiles.stages import earlier, node
from liftmesh.tiles.store import names_to_disk

if TYPE_CHECKING:
    from liftmesh.tiles.context import Done, RunContext
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
