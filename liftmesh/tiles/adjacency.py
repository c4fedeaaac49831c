"""Which triangles share an edge, across all shards.

A shard with neighbours has two files beside it. ``-neighbors.npy``, (m, 3) int32, is written with
it: the row in the same shard beyond each edge, or -1; edge k is opposite corner k. Where another
shard goes on, ``-links.npy``, (k, 3) int64, says so: ``3 * row + side``, ascending, and the shard
and the row beyond. It is written at the end, from what the cuts above have paired (`edges.py`), so
no file has to be changed. An edge in neither is on the hull.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Array, Integers
from liftmesh.tiles.runs import load_plan
from liftmesh.tiles.stages import Done, Folders, label
from liftmesh.tiles.store import save_array

if TYPE_CHECKING:
    from liftmesh.tiles.schedule import Runner

_SHARDS = "shards.npy"
_CUTS = "cuts.npy"


def neighbors_of(shard: str) -> tuple[str, str]:
    """Name the two files beside a shard."""
    stem = Path(shard).stem
    return f"{stem}-neighbors.npy", f"{stem}-links.npy"


def link_all(runner: Runner, folders: Folders, done: Sequence[Done]) -> dict[str, str]:
    """Write the links of all shards."""
    shards = [each.name for each in done if each.triangles]
    cuts = [each.name for each in done if f"{label(each.name)}-links.npy" in each.notes]
    save_array(folders.scratch / _SHARDS, np.array(shards, dtype=np.int64))
    save_array(folders.scratch / _CUTS, np.array(cuts, dtype=np.int64))
    digests = runner.each("link", link, [(folders, name) for name in shards])
    return {
        neighbors_of(label(name))[1]: digest for name, digest in zip(shards, digests, strict=True)
    }


def link(folders: Folders, name: int) -> str:
    """Write what other shards have beyond the edges of one."""
    shards, cuts = (np.load(folders.scratch / each) for each in (_SHARDS, _CUTS))
    above = [name, *load_plan(folders).above(name)]
    found = links_to(name, [
        np.load(folders.scratch / f"{label(cut)}-links.npy")
        for cut in above if cut in cuts
    ], shards)  # fmt: skip
    return save_array(folders.out / neighbors_of(label(name))[1], found)


def links_to(name: int, links: Sequence[Integers], shards: Integers) -> Integers:
    """Gather the links of one shard."""
    both = np.concatenate([np.empty((0, 4), dtype=np.int64), *links])
    both = np.concatenate((both, both[:, [2, 3, 0, 1]]))
    mine = both[both[:, 0] == name]
    mine = mine[np.argsort(mine[:, 1])]
    order = np.argsort(shards)
    place = order[np.searchsorted(shards, mine[:, 2], sorter=order)]
    return np.column_stack((mine[:, 1], place, mine[:, 3] // 3))


def as_pairs(shard: int, neighbors: Array, links: Integers) -> Integers:
    """Put the two files of a shard together."""
    pairs = np.empty((*neighbors.shape, 2), dtype=np.int64)
    pairs[:, :, 0] = np.where(neighbors < 0, -1, shard)
    pairs[:, :, 1] = neighbors
    pairs.reshape(-1, 2)[links[:, 0]] = links[:, 1:]
    return pairs
