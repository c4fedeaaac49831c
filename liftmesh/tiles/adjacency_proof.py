"""Whether the neighbours that a folder states are those of its triangles, shard by shard.

A stated neighbour in the same shard has to have the edge in the opposite order. The edges for which
none is stated are paired up the tree once more, and the links that come out compared with those
stated; what has no partner has to be as many edges as the hull has. Then no edge can be left out:
its partner would be stated on one side only, and be left at the root.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Array, Integers
from liftmesh.tiles.adjacency import links_to, neighbors_of
from liftmesh.tiles.edges import open_edges, paired
from liftmesh.tiles.shards import open_shard
from liftmesh.tiles.stages import label, node_of
from liftmesh.tiles.store import mapped

if TYPE_CHECKING:
    from liftmesh.tiles.findings import Findings
    from liftmesh.tiles.plan import Plan
    from liftmesh.tiles.tiled import Tiled

_BLOCK = 1 << 18  # triangles that are looked at at once


class AdjacencyProof:
    """Collects what is wrong with the neighbours of a folder."""

    def __init__(self, tiled: Tiled, plan: Plan, scratch: Path, found: Findings) -> None:
        self._tiled = tiled
        self._plan = plan
        self._scratch = scratch
        self._found = found
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
        neighbors: Array = mapped(self._tiled.directory / neighbors_of(path.name)[0])
        if neighbors.shape != triangles.shape or neighbors.dtype != np.int32:
            self._found.add("other_neighbors", 1)
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
        self._found.add("other_neighbors", wrong)

    def finish(self, hull_edges: int) -> None:
        """Compare the links of all shards, and count what is left."""
        (left,) = self._waiting.values()
        self._found.add("other_neighbors", abs(len(left) - hull_edges))
        names = [node_of(path.stem) for path in self._tiled.shards]
        for name, path in zip(names, self._tiled.shards, strict=True):
            above = [name, *self._plan.above(name)]
            links = [np.load(self._scratch / f"{label(each)}-links.npy") for each in above]
            expected = links_to(name, links, np.array(names))
            self._compare(expected, mapped(self._tiled.directory / neighbors_of(path.name)[1]))

    def _compare(self, expected: Integers, stated: Array) -> None:
        if stated.shape != expected.shape:
            self._found.add("other_neighbors", max(1, abs(len(expected) - len(stated))))
        else:
            self._found.add("other_neighbors", int((stated != expected).any(axis=1).sum()))
