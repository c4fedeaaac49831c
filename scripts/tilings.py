"""Point sets on which tiles are tried, and their triangulation through any tree of merges."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from distributions import DISTRIBUTIONS, UTM_ORIGIN, Distribution, Points
from numpy.random import Generator
from numpy.typing import NDArray

from liftmesh.tiles.adjacency import links_to, open_edges, paired
from liftmesh.tiles.node import Frontier, Merged, joined, merge
from liftmesh.tiles.tiled_data import as_pairs

if TYPE_CHECKING:
    from liftmesh.tiles.plan import Plan


@dataclass
class Tiling:
    """What all nodes decided, and how much went up from each."""

    triangles: NDArray[np.int64]
    duplicates: NDArray[np.int64]
    skipped: NDArray[np.int64]
    root: Merged
    neighbors: NDArray[np.int64]
    points_in: dict[int, int]
    points_up: dict[int, int]


class Tree:
    """Merges the tiles of a plan; `flatten` says which cuts leave all to their parent."""

    def __init__(self, points: Points, plan: Plan, chunk: int) -> None:
        chunks = [points[i : i + chunk].copy() for i in range(0, max(1, len(points)), chunk)]
        parts = [plan.partition(rows, i * chunk) for i, rows in enumerate(chunks)]
        boxes = np.stack([part[2] for part in parts])
        self.plan = plan
        tight = np.concatenate((boxes[:, :, :2].min(0), boxes[:, :, 2:].max(0)), axis=1)
        self.boxes = plan.around(tight)
        self.skipped = np.concatenate([part[3] for part in parts])
        self.leaves = [
            np.concatenate([records[begin[t] : begin[t + 1]] for records, begin, _, _ in parts])
            for t in range(plan.tiles)
        ]

    def merged(self, flatten: Callable[[int], bool] = lambda _: False) -> Tiling:
        """Work through the tree from its leaves."""
        root = 0 if self.plan.tiles > 1 else ~0
        done: dict[int, Merged] = {}
        sizes: dict[int, int] = {}
        self._node(root, root, flatten, done, sizes)
        duplicates = np.concatenate([node.duplicates for node in done.values()])
        return Tiling(
            np.concatenate([node.triangles for node in done.values()]),
            duplicates[np.argsort(duplicates[:, 0])],
            self.skipped,
            done[root],
            self._neighbors(root, done),
            sizes,
            {name: len(node.frontier) for name, node in done.items()},
        )

    def _neighbors(self, root: int, done: dict[int, Merged]) -> NDArray[np.int64]:
        """Which triangles share an edge, as rows of all triangles."""
        edges: dict[int, NDArray[np.int64]] = {}
        links: list[NDArray[np.int64]] = []
        for name, merged in done.items():  # children first
            below = [edges.pop(each) for each in [*edges] if name in self.plan.above(each)]
            own = open_edges(name, merged.triangles, merged.neighbors)
            pairs, edges[name] = paired(np.concatenate([own, *below]))
            links.append(pairs)
        assert len(edges[root]) == (0 if done[root].is_flat else len(done[root].hull))
        names = np.array([*done])
        begins = np.cumsum([0, *(len(merged.triangles) for merged in done.values())])
        found = [np.empty((0, 3), dtype=np.int64)]
        for shard, (name, merged) in enumerate(done.items()):
            pairs = as_pairs(shard, merged.neighbors, links_to(name, links, names))
            found.append(np.where(pairs[:, :, 0] < 0, -1, begins[pairs[:, :, 0]] + pairs[:, :, 1]))
        return np.concatenate(found)

    def _node(
        self,
        name: int,
        root: int,
        flatten: Callable[[int], bool],
        done: dict[int, Merged],
        sizes: dict[int, int],
    ) -> Frontier:
        part = joined(self._parts(name, root, flatten, done, sizes))
        if name >= 0 and name != root and flatten(name):
            return part
        others = self.boxes[self.plan.others(name)]
        foreign = others[others[:, 0] <= others[:, 2]]
        done[name] = merge(
            part, self.plan.cells[name], foreign, is_root=name == root, with_neighbors=True
        )
        sizes[name] = len(part)
        return done[name].frontier

    def _parts(
        self,
        name: int,
        root: int,
        flatten: Callable[[int], bool],
        done: dict[int, Merged],
        sizes: dict[int, int],
    ) -> list[Frontier]:
        if name < 0:
            return [Frontier(self.leaves[~name])]
        return [
            self._node(child, root, flatten, done, sizes)
            for child in self.plan.children[name].tolist()
        ]


def tiled(
    points: Points,
    plan: Plan,
    *,
    chunk: int = 1 << 20,
    flatten: Callable[[int], bool] | None = None,
) -> Tiling:
    """Triangulate points tile by tile, from chunks of so many rows."""
    return Tree(points, plan, chunk).merged(flatten or (lambda _: False))


def ordered(triangles: NDArray[np.integer]) -> NDArray[np.int64]:
    """Sort triangles, to compare sets."""
    rows = np.asarray(triangles, dtype=np.int64)
    return rows[np.lexsort(rows.T[::-1])]


def adjacent(triangles: NDArray[np.integer], neighbors: NDArray[np.integer]) -> NDArray[np.integer]:
    """Sort triangles, each with the place of the neighbour beyond each edge in that order."""
    order = np.lexsort(np.asarray(triangles).T[::-1])
    place = np.full(len(order) + 1, -1)
    place[order] = np.arange(len(order))
    return np.column_stack((triangles, place[neighbors]))[order]


def scan_lines(n: int, rng: Generator) -> Points:
    """Lines twenty times as far apart as the points on them, as a line scanner leaves them."""
    count = max(1, round((n / 20) ** 0.5))
    per_line = -(-n // count)
    along = np.arange(per_line) + rng.uniform(0, 0.5, (count, per_line))
    across = 20.0 * np.arange(count)[:, None] + rng.normal(0, 0.05, (count, per_line))
    return rng.permutation(np.stack((along, across), axis=2).reshape(-1, 2))[:n]


def strips_with_lakes(n: int, rng: Generator) -> Points:
    """Overlapping strips of an airborne survey in centimetres, without echoes from round lakes."""
    side = (n / 4) ** 0.5  # in metres, at some four points a square metre
    strips = max(2, round(side / 40))
    strip = rng.integers(0, strips, 2 * n)
    width = side / strips
    x = (strip + rng.uniform(-0.1, 1.1, 2 * n)) * width
    points = np.column_stack((x, rng.uniform(0, side, 2 * n)))
    lakes, radii = rng.uniform(0, side, (8, 2)), rng.uniform(0.02, 0.12, 8) * side
    for lake, radius in zip(lakes, radii, strict=True):
        points = points[np.hypot(*(points - lake).T) > radius]
    return np.round(points[:n] + UTM_ORIGIN, 2)


def mixed_magnitudes(n: int, rng: Generator) -> Points:
    """Coordinates from the least to the greatest doubles, of either sign."""
    signs = rng.choice([-1.0, 1.0], (n, 2))
    return signs * np.ldexp(rng.uniform(0.5, 1, (n, 2)), rng.integers(-1074, 1023, (n, 2)))


FAMILIES: dict[str, Distribution] = {
    **DISTRIBUTIONS,
    **{
        generate.__name__.replace("_", "-"): generate
        for generate in (scan_lines, strips_with_lakes, mixed_magnitudes)
    },
}
