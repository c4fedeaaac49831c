"""Which triangles share an edge, across all shards: written, read and proved.

A shard with neighbours has two files beside it. ``-neighbors.npy``, (m, 3) int32, is written with
it: the row in the same shard beyond each edge, or -1; edge k is opposite corner k. Where another
shard goes on, ``-links.npy``, (k, 3) int64, says so: ``3 * row + side``, ascending, and the shard
and the row beyond. It is written at the end, so no file has to be changed. An edge in neither is on
the hull.

Beyond an edge without a neighbour in its node is the hull, or a triangle that another node writes,
above or below. Such edges go up the tree. Two with the same ends in opposite order are the same
edge, seen from both sides: they are paired at the first cut that knows both. What has no partner at
the root is on the hull.

In the proof, a stated neighbour in the same shard has to have the edge in the opposite order. The
edges for which none is stated are paired up the tree once more, and the links that come out
compared with those stated; what has no partner has to be as many edges as the hull has. Then no
edge can be left out: its partner would be stated on one side only, and be left at the root.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Array, Integers
from liftmesh.tiles.options import Done, RunContext, Runner, label, node_of
from liftmesh.tiles.shards import open_shard
from liftmesh.tiles.sorted_chunks import load_plan
from liftmesh.tiles.store import links_name, mapped, neighbors_name, save_array

if TYPE_CHECKING:
    from liftmesh.tiles.plan import Plan
    from liftmesh.tiles.tiled_data import TiledData

_SHARDS = "shards.npy"
_CUTS = "cuts.npy"
_BLOCK = 1 << 18  # triangles that are looked at at once


def link_all(runner: Runner, context: RunContext, done: Sequence[Done]) -> dict[str, str]:
    """Write the links of all shards."""
    shards = [each.name for each in done if each.triangles]
    cuts = [each.name for each in done if f"{label(each.name)}-links.npy" in each.notes]
    save_array(context.scratch / _SHARDS, np.array(shards, dtype=np.int64))
    save_array(context.scratch / _CUTS, np.array(cuts, dtype=np.int64))
    digests = runner.each("link", link, [(context, name) for name in shards])
    return {links_name(label(name)): digest for name, digest in zip(shards, digests, strict=True)}


def link(context: RunContext, name: int) -> str:
    """Write what other shards have beyond the edges of one."""
    shards, cuts = (np.load(context.scratch / each) for each in (_SHARDS, _CUTS))
    above = [name, *load_plan(context).above(name)]
    links = links_to(name, [
        np.load(context.scratch / f"{label(cut)}-links.npy")
        for cut in above if cut in cuts
    ], shards)  # fmt: skip
    return save_array(context.out / links_name(label(name)), links)


def links_to(name: int, links: Sequence[Integers], shards: Integers) -> Integers:
    """Gather the links of one shard."""
    both = np.concatenate([np.empty((0, 4), dtype=np.int64), *links])
    both = np.concatenate((both, both[:, [2, 3, 0, 1]]))
    mine = both[both[:, 0] == name]
    mine = mine[np.argsort(mine[:, 1])]
    order = np.argsort(shards)
    place = order[np.searchsorted(shards, mine[:, 2], sorter=order)]
    return np.column_stack((mine[:, 1], place, mine[:, 3] // 3))


def open_edges(name: int, triangles: Integers, neighbors: Array) -> Integers:
    """List the edges without a neighbour among the triangles of a node."""
    triangle, side = np.nonzero(neighbors < 0)
    tail, head = (triangles[triangle, (side + turn) % 3] for turn in (1, 2))
    return np.column_stack((tail, head, np.full(len(tail), name), 3 * triangle + side))


def paired(edges: Integers) -> tuple[Integers, Integers]:
    """Pair edges with the same ends in opposite order."""
    ends = np.sort(edges[:, :2], axis=1)
    order = np.lexsort((edges[:, 0] > edges[:, 1], ends[:, 1], ends[:, 0]))
    one, other = order[:-1], order[1:]
    is_pair = (ends[one] == ends[other]).all(axis=1) & (edges[one, 0] == edges[other, 1])
    one, other = one[is_pair], other[is_pair]
    is_open = np.ones(len(edges), dtype=np.bool_)
    is_open[one] = is_open[other] = False
    return np.column_stack((edges[one, 2:], edges[other, 2:])), edges[is_open]


class AdjacencyProof:
    """Collects what is wrong with the neighbours of a folder."""

    def __init__(
        self, tiled: TiledData, plan: Plan, scratch: Path, add: Callable[[str, int], None]
    ) -> None:
        self._tiled = tiled
        self._plan = plan
        self._scratch = scratch
        self._add = add
        self._shards = {path.stem: path for path in tiled.shards}
        self._waiting: dict[int, Integers] = {}

    def add(self, name: int, children: Sequence[int]) -> None:
        """Check what a node states of its own triangles, and pair the edges that are left."""
        edges = [self._waiting.pop(child) for child in children]
        path = self._shards.get(label(name))
        if path is not None:
            edges.append(self._own(name, path))
        links, self._waiting[name] = paired(
            np.concatenate([np.empty((0, 4), dtype=np.int64), *edges])
        )
        np.save(self._scratch / f"{label(name)}-links.npy", links)

    def _own(self, name: int, path: Path) -> Integers:
        triangles = open_shard(path)
        neighbors: Array = mapped(self._tiled.folder / neighbors_name(path.name))
        if neighbors.shape != triangles.shape or neighbors.dtype != np.int32:
            self._add("other_neighbors", 1)
            neighbors = np.full(triangles.shape, -1, dtype=np.int32)
        for begin in range(0, len(triangles), _BLOCK):
            block = slice(begin, begin + _BLOCK)
            self._check(triangles, np.array(triangles[block]), np.array(neighbors[block]))
        return open_edges(name, triangles, neighbors)

    def _check(self, triangles: Integers, block: Integers, neighbors: Array) -> None:
        """The neighbour beyond each edge has that edge, in the opposite order."""
        is_row = neighbors < len(triangles)
        wrong = int((~is_row | (neighbors < -1)).sum())
        for side in range(3):
            here = np.flatnonzero(is_row[:, side] & (neighbors[:, side] >= 0))
            beyond = triangles[neighbors[here, side]]
            tail, head = (block[here, (side + turn) % 3] for turn in (1, 2))
            has_edge = np.zeros(len(here), dtype=np.bool_)
            for k in range(3):
                has_edge |= (beyond[:, k] == head) & (beyond[:, (k + 1) % 3] == tail)
            wrong += int((~has_edge).sum())
        self._add("other_neighbors", wrong)

    def finish(self, hull_edges: int) -> None:
        """Compare the links of all shards, and count what is left."""
        (left,) = self._waiting.values()
        self._add("other_neighbors", abs(len(left) - hull_edges))
        names = [node_of(path.stem) for path in self._tiled.shards]
        for name, path in zip(names, self._tiled.shards, strict=True):
            above = [name, *self._plan.above(name)]
            links = [np.load(self._scratch / f"{label(each)}-links.npy") for each in above]
            expected = links_to(name, links, np.array(names))
            self._compare(expected, mapped(self._tiled.folder / links_name(path.name)))

    def _compare(self, expected: Integers, stated: Array) -> None:
        if stated.shape != expected.shape:
            self._add("other_neighbors", max(1, abs(len(expected) - len(stated))))
        else:
            self._add("other_neighbors", int((stated != expected).any(axis=1).sum()))
