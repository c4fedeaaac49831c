"""Triangulate sets in tiles, and compare with exact integers, or with one call.

    python scripts/fuzz_tiles.py --seconds 600
    python scripts/fuzz_tiles.py --seed 123 --cases 1      one case again
    python scripts/fuzz_tiles.py --rows 100000             each family against one call
    python scripts/fuzz_tiles.py --rows 1000000 --families uniform --tiles 32 --workers 0 2 --verify

Of tiny sets with ties, each case draws a set of points, a plan of tiles, the order of rows, the
chunks in which they come, and which merges are left to their parents. The triangles have to be
those of the definition, by `scripts/oracles/planar.py`, each once, and neighbours
those that share an edge. A set that fails is printed with its seed.

With --rows, the families of `tilings.py` have so many rows, and come in several orders, are
cut into several numbers of tiles, and are triangulated by this process (0 workers) or by workers of
Dask. The triangles have to be those of one call, by a hash of their coordinates that depends on
neither the order of rows nor of triangles; with --verify, they are proved, too.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic
from typing import Any

import numpy as np
from benchmark.tasks.tiles import BLOCK, MIXERS, mark_of, turned
from distributions import Points
from numpy.random import Generator
from numpy.typing import NDArray
from oracles import planar as oracle
from tilings import FAMILIES, Tree

import liftmesh
from liftmesh.tiles.plan import Plan, planned

_RING = [(x, y) for x in range(-25, 26) for y in range(-25, 26) if x * x + y * y == 325]
_SCALES = (1.0, 5e-324, 2.0**1018)

ORDERS: dict[str, Callable[[Points, Generator], Points]] = {
    "made": lambda points, _: points,
    "sorted": lambda points, _: points[np.lexsort(points.T[::-1])],
    "reversed": lambda points, _: points[::-1].copy(),
    "shuffled": lambda points, rng: rng.permutation(points),
}
Make = Callable[..., liftmesh.Tiled]


def main() -> None:
    """Run cases until the time is over, or all that are asked for."""
    options = parsed(sys.argv[1:])
    if options.rows is not None:
        compare(options)
        return
    end, done = monotonic() + options.seconds, 0
    while monotonic() < end and done != options.cases:
        check(options.seed + done)
        done += 1
    print(f"{done:,} cases agree with the definition")


def parsed(words: list[str]) -> Namespace:
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--seconds", type=float, default=60)
    add("--cases", type=int, metavar="N", help="so many cases at most")
    add("--seed", type=int, default=0, help="of the first case, and of families")
    add("--rows", type=int, metavar="N", help="of families, against one call")
    add("--families", nargs="+", choices=FAMILIES, default=tuple(FAMILIES), metavar="F")
    add("--tiles", nargs="+", type=int, default=(2, 16, 256), metavar="N")
    add("--orders", nargs="+", choices=ORDERS, default=tuple(ORDERS), metavar="O")
    add("--workers", nargs="+", type=int, default=(0,), metavar="N", help="of Dask; 0: none")
    add("--verify", action="store_true", help="prove the triangles, too")
    add("--folder", metavar="FOLDER", help="where files are written")
    return parser.parse_args(words)


def compare(options: Namespace) -> None:
    """Triangulate all families in all ways; print a line for each family, or raise."""
    with ExitStack() as stack:
        makers = {count: maker(count, stack) for count in options.workers}
        for family in options.families:
            made = FAMILIES[family](options.rows, np.random.default_rng(options.seed)) + 0.0
            expected = mark_of_places(made, iter([liftmesh.delaunay(made).simplices]))
            for order in options.orders:
                points = ORDERS[order](made, np.random.default_rng(options.seed))
                for tiles in options.tiles:
                    for count, make in makers.items():
                        found = mark_in_tiles(points, tiles, make, options)
                        if found != expected:
                            case = f"{order}, {tiles} tiles, {count} workers"
                            raise AssertionError(f"{family}, seed {options.seed}: {case}")
            cases = len(options.orders) * len(options.tiles) * len(makers)
            print(f"{family}: {len(made):,} rows, {cases} cases are one call's", flush=True)


def maker(workers: int, stack: ExitStack) -> Make:
    """Return what triangulates in tiles; a cluster is there until the end."""
    if workers == 0:
        return liftmesh.tile
    from liftmesh.dask import delaunay, local_cluster  # noqa: PLC0415 - slow to import

    client = stack.enter_context(local_cluster(n_workers=workers))

    def make(*arguments: Any, **options: Any) -> liftmesh.Tiled:
        return delaunay(*arguments, client=client, **options)

    return make


def mark_in_tiles(points: Points, tiles: int, make: Make, options: Namespace) -> str:
    """Triangulate points in a folder of their own."""
    with TemporaryDirectory(dir=options.folder) as folder:
        np.save(Path(folder) / "points.npy", points)
        rows = max(16, -(-len(points) // tiles))
        found = make(Path(folder) / "points.npy", Path(folder) / "out", tile_rows=rows)
        if options.verify and not found.verify().canonical:
            raise AssertionError(f"{len(points):,} rows in {tiles} tiles: not proved")
        return mark_of_places(points, found.iter_blocks())


def mark_of_places(points: Points, blocks: Iterator[NDArray[Any]]) -> str:
    """Hash the coordinates of triangles, which each begin at their least corner."""
    sums = np.zeros(len(MIXERS), np.uint64)
    for block in blocks:
        for begin in range(0, len(block), BLOCK):
            rows = turned(np.array(block[begin : begin + BLOCK], dtype=np.int64), points)
            sums += mark_of(points[rows].reshape(-1, 6).view(np.int64))
    return "".join(f"{each:016x}" for each in sums)


def check(seed: int) -> None:
    """Raise if a case does not agree."""
    rng = np.random.default_rng(seed)
    points = tiny_set(rng)
    plan = drawn_plan(points, rng)
    flat = rng.random(plan.tiles) < 0.3
    tree = Tree(points, plan, chunk=1 + int(rng.integers(len(points))))
    found = tree.merged(lambda cut: bool(flat[cut]))
    exact = oracle.exact(points)
    named = [oracle.counter_clockwise(*(exact[i] for i in t)) for t in found.triangles.tolist()]
    if set(named) != oracle.delaunay(exact) or len(set(named)) != len(named):
        raise AssertionError(f"seed {seed}: {points.tolist()} in {plan}")
    if not np.array_equal(found.neighbors, beyond(found.triangles)):
        raise AssertionError(f"seed {seed}: neighbours of {points.tolist()} in {plan}")


def tiny_set(rng: Generator) -> Points:
    """Sets with many ties, so that every triangulation but the canonical one would be wrong."""
    n = int(rng.integers(3, 40))
    kinds = (
        rng.integers(0, 5, (n, 2)),
        np.array(_RING)[rng.integers(0, len(_RING), n)],
        np.column_stack((rng.integers(0, 2, n), rng.integers(0, 30, n))),
        np.repeat(rng.integers(0, 6, (1 + n // 4, 2)), 4, axis=0),
        np.column_stack((np.arange(n), np.zeros(n))),
        np.column_stack((np.arange(n), np.arange(n) ** 2)),
    )
    points = kinds[int(rng.integers(len(kinds)))] * float(rng.choice(_SCALES[:2]))
    if abs(points).max() < 32:
        points = points * float(rng.choice(_SCALES))
    return rng.permutation(points + 0.0)


def drawn_plan(points: Points, rng: Generator) -> Plan:
    """Cuts at any points, across any axis; or those that `tile` would make."""
    tiles = int(rng.integers(1, 9))
    if rng.random() < 0.5:
        return planned(points[rng.integers(0, len(points), len(points))], tiles)
    plan = planned(points[:1], 1)
    for _ in range(tiles - 1):
        at = points[rng.integers(len(points))]
        cut = {"axes": [int(rng.integers(2))], "at": [at], "children": [[~0, ~1]]}
        plan = plan.cut_again(int(rng.integers(plan.tiles)), Plan.from_dict(cut))
    return plan


def beyond(triangles: np.ndarray) -> np.ndarray:
    """Find neighbours by a dictionary of directed edges."""
    edges = {
        (t[(k + 1) % 3], t[(k + 2) % 3]): i
        for i, t in enumerate(triangles.tolist())
        for k in range(3)
    }
    found = [
        [edges.get((t[(k + 2) % 3], t[(k + 1) % 3]), -1) for k in range(3)]
        for t in triangles.tolist()
    ]
    return np.array(found, dtype=np.int64).reshape(-1, 3)


if __name__ == "__main__":
    main()
