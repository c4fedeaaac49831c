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
from typing import Any

import numpy as np
from campaign import run_kinds
from distributions import Points
from numpy.random import Generator
from numpy.typing import NDArray
from oracles.carving import Given, check_carved
from oracles.constrained import Constrained, check
from oracles.planar import exact
from small_sets import KINDS, small_set

import liftmesh
from liftmesh import _kernel

MOST = (6, 12, 12, 60)  # rows
MOST_CARVED = 14
Edges = NDArray[np.int32]


def main() -> None:
    run_kinds(__doc__, SETS, 2000, holds, "sets")


def holds(kind: str, rng: Generator) -> None:
    """Check one set of points and edges; ends the program at a difference."""
    points = small_set(SETS[kind], rng, most=int(rng.choice(MOST)))
    edges = random_edges(points, rng)
    given: Any = edges.tolist()
    try:
        check(_kernel.constrained(points, edges, False, 1, False, None), points, edges)
        given = random_bounds(points[:MOST_CARVED], rng)
        carve_randomly(points[:MOST_CARVED], given, rng)
    except Exception as error:
        print(f"{kind}: {points.tolist()}\nedges {given}", file=sys.stderr)
        raise SystemExit(1) from error


def carve_randomly(points: Points, given: Given, rng: Generator) -> None:
    """Carve in one way, with some seeds, and check what is left."""
    options: dict[str, Any] = {
        "edges": given.edges,
        "polylines": [np.array(line) for line in given.polylines],
        "polygons": [[np.array(ring) for ring in polygon] for polygon in given.polygons],
        "crossing": "split",
    }
    try:
        whole = liftmesh.constrained_delaunay(points, **options)
    except liftmesh.InputError:  # all on a line, crossings without end, a hole twice
        return
    carve = rng.choice(np.array([None, "outside", "holes"], dtype=object))
    corners = rng.integers(0, len(points), (rng.choice([0, 0, 1, 2]), 2))
    seeds = (points[corners] / 2).sum(axis=1) if rng.random() < 0.8 else points[corners[:, 0]]
    try:
        carved = liftmesh.constrained_delaunay(points, **options, carve=carve, seeds=seeds)
    except liftmesh.InputError:
        carved = None
    check_carved(whole, given, carve, seeds.tolist(), carved)


def random_bounds(points: Points, rng: Generator) -> Given:
    """Draw edges, polylines, of which some are closed, and polygons with holes."""
    triangles = _kernel.delaunay(points, False, 1, False, None)[3]
    edges = [edge for edge in random_edges(points, rng).tolist() if rng.random() < 0.5]
    if rng.random() < 0.4:
        edges = border_of(triangles[rng.random(len(triangles)) < 0.6])

    def ring() -> list[int]:
        if len(triangles) and rng.random() < 0.3:
            return list(rng.choice(triangles).tolist())
        rows = rng.integers(0, len(points), rng.integers(3, 8))
        if rng.random() < 0.6:
            near = points[rows] / 16  # their sum is within the range
            x, y = (near - near.mean(axis=0)).T
            rows = rows[np.argsort(np.arctan2(y, x))]
        return [*map(int, rows)]

    def some(most: int) -> range:
        return range(int(rng.integers(0, most)) * int(rng.random() < 0.6))

    lines = [line if rng.random() < 0.5 else [*line, line[0]] for line in (ring() for _ in some(4))]
    polygons = [[ring(), *(ring() for _ in some(3))] for _ in some(4)]
    return Given([] if rng.random() < 0.3 else edges, lines, polygons)


def border_of(triangles: NDArray[np.int32]) -> list[tuple[int, int]]:
    """Return the sides that one of some triangles has."""
    sides = {(a, b) for t in triangles.tolist() for a, b in zip(t, [*t[1:], t[0]], strict=True)}
    return sorted((a, b) for a, b in sides if (b, a) not in sides)


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
