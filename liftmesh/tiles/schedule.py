"""In which order the tasks of a tiled triangulation run, and who runs them.

A runner calls tasks and collects what they return. `Serial` calls one after the other, in this
process; `liftmesh.dask` hands them to workers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from liftmesh._typing import Progress
from liftmesh.tiles.release import release
from liftmesh.tiles.stages import Done, Folders, node

if TYPE_CHECKING:
    from liftmesh.tiles.plan import Plan

SHARES = {
    "open": 0, "spool": 5, "scan": 1, "check": 0, "partition": 2, "triangulate": 7, "link": 0
}  # fmt: skip
"""What the stages take of the whole, about; to spool, which is to copy, only if a source is."""


class Runner(Protocol):
    """What calls tasks."""

    def begin(self, rows: int) -> None:
        """Hear how many rows there are, once they are counted."""

    def each(self, stage: str, task: Callable[..., Any], calls: Sequence[tuple[Any, ...]]) -> Any:
        """Call a task with each of some arguments, in any order; return its results in order."""

    def tree(self, folders: Folders, plan: Plan, sizes: Sequence[int]) -> list[Done]:
        """Call `stages.node` for all nodes of a plan, children first; the root is the last."""


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

    def copied(self, share: float) -> None:
        """Hear how much is copied of what cannot be read by ranges."""
        self._meter.show("spool", share)

    def begin(self, rows: int) -> None:
        """Hear how many rows there are."""
        self._meter.begin(rows)

    def each(self, stage: str, task: Callable[..., Any], calls: Sequence[tuple[Any, ...]]) -> Any:
        """Call a task with each of some arguments."""
        found = []
        for arguments in calls:
            found.append(task(*arguments))
            self._meter.show(stage, len(found) / len(calls))
        return found

    def tree(self, folders: Folders, plan: Plan, sizes: Sequence[int]) -> list[Done]:
        """Work through a plan; a merge comes as soon as its children are done."""
        done: dict[int, Done] = {}
        rows, total = 0, max(1, sum(sizes))
        for name, children in in_order(plan):
            done[name] = node(folders, name, [done[child] for child in children], self._threads)
            if name < 0:
                rows += sizes[~name]
                self._release(folders, folders.groups.of(~name), done)
            self._meter.show("triangulate", rows / total)
        return list(done.values())

    def _release(self, folders: Folders, group: int, done: Mapping[int, Done]) -> None:
        """Remove the rows of a group when its last tile is done."""
        tiles = [~tile for tile in folders.groups.tiles_of(group)]
        if all(tile in done for tile in tiles):
            release(folders, group, [done[tile] for tile in tiles])


def in_order(plan: Plan) -> list[tuple[int, list[int]]]:
    """List the nodes of a plan with their children: these first, and the root last."""
    found: list[tuple[int, list[int]]] = []
    waiting = [0 if plan.tiles > 1 else ~0]
    while waiting:  # parents first, then reversed
        name = waiting.pop()
        children = plan.children[name].tolist() if name >= 0 else []
        found.append((name, children))
        waiting += children
    return found[::-1]
