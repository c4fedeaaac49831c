"""Triangulate tiny sets with ties in tiles, and compare with exact integers.

    python scripts/fuzz_tiles.py --seconds 600
    python scripts/fuzz_tiles.py --seed 123 --cases 1      one case again

Each case draws a set of points, a plan of tiles, the order of rows, the chunks in which they come,
and which merges are left to their parents. The triangles have to be those of the definition, by
Python's integers (`tests/oracle.py`), each once, and neighbours those that share an edge. A set
that fails is printed with its seed.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser
from pathlib import Path
from time import monotonic

import numpy as np
from distributions import Points
from numpy.random import Generator

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests"))

import oracle
from tilings import Tree

from liftmesh.tiles.plan import Plan, planned

_RING = [(x, y) for x in range(-25, 26) for y in range(-25, 26) if x * x + y * y == 325]
_SCALES = (1.0, 5e-324, 2.0**1018)


def main() -> None:
    """Run cases until the time is over."""
    parser = ArgumentParser(description=(__doc__ or "").split("\n", maxsplit=1)[0])
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--cases", type=int, metavar="N", help="so many cases at most")
    parser.add_argument("--seed", type=int, default=0, help="of the first case")
    options = parser.parse_args()
    end, done = monotonic() + options.seconds, 0
    while monotonic() < end and done != options.cases:
        check(options.seed + done)
        done += 1
    print(f"{done:,} cases agree with the definition")


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
