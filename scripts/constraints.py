"""Put random edges into small random sets of points, and check each by definition in integers.

    python scripts/constraints.py                      2,000 sets of each kind
    python scripts/constraints.py --count 20000 --seed 7 --kinds small-integers lines

Points are those of `small_sets.py`, and of few lines and small lattices: ties, collinear points and
duplicates abound, up to the ends of the exponents. Edges are drawn at random, from one point to
many, and along lines, some of them twice, backwards or between equal rows; in one set of four they
may cross. Triangles, marks, pieces with their edges, and crossings must be those that
`oracles/constrained.py` finds by trying all there are. Exits with 1 and the set at a difference.
"""

from __future__ import annotations

import sys

import numpy as np
from campaign import run_kinds
from distributions import Points
from numpy.random import Generator
from numpy.typing import NDArray
from oracles.constrained import Constrained, check
from oracles.planar import exact
from small_sets import KINDS, small_set

from liftmesh import _kernel

MOST = (6, 12, 12, 60)  # rows
Edges = NDArray[np.int32]


def main() -> None:
    run_kinds(__doc__, SETS, 2000, holds, "sets")


def holds(kind: str, rng: Generator) -> None:
    """Check one set of points and edges; ends the program at a difference."""
    points = small_set(SETS[kind], rng, most=int(rng.choice(MOST)))
    edges = random_edges(points, rng)
    try:
        check(_kernel.constrained(points, edges, False, 1, False, None), points, edges)
    except Exception as error:
        print(f"{kind}: {points.tolist()}\nedges {edges.tolist()}", file=sys.stderr)
        raise SystemExit(1) from error


def random_edges(points: Points, rng: Generator) -> Edges:
    """Draw edges between rows; in three sets of four, only those that cross none before."""
    count = int(rng.integers(0, 2 * len(points)))
    edges = rng.integers(0, len(points), (count, 2), dtype=np.int32)
    way = rng.random()
    if way < 0.2:  # a star
        edges[:, 0] = edges[:1, 0]
    elif way < 0.4:  # a chain through sorted points
        order = np.lexsort(points.T)
        edges = np.column_stack((order[:-1], order[1:])).astype(np.int32)
    again = rng.integers(0, len(edges), len(edges) // 4) if len(edges) else []
    edges = np.concatenate((edges, edges[again][:, ::-1]))
    return edges if rng.random() < 0.25 else without_crossings(points, edges)


def without_crossings(points: Points, edges: Edges) -> Edges:
    """Leave out what crosses an edge before it."""
    crossings = Constrained(exact(points.tolist()), [(a, b) for a, b in edges.tolist()]).crossings
    out: set[int] = set()
    for first, second in crossings:
        if first not in out:
            out.add(second)
    return np.delete(edges, sorted(out), axis=0)


def lines(n: int, rng: Generator) -> Points:
    """On three lines through a point, a few off them."""
    along = (
        rng.integers(-4, 5, n)[:, None] * np.array([(1, 0), (1, 1), (1, -2)])[rng.integers(0, 3, n)]
    )
    off = rng.random((n, 1)) < 0.2
    return np.where(off, rng.integers(-4, 5, (n, 2)), along) * 1.0


def lattice(n: int, rng: Generator) -> Points:
    """On a lattice with hardly more places than points, on any scale."""
    sides = rng.integers(2, 5, 2)
    return rng.integers(0, sides, (n, 2)) * 2.0 ** rng.integers(-1070, 1000, 2)


SETS = {**KINDS, "lines": lines, "lattice": lattice}


if __name__ == "__main__":
    main()
