"""Compare graphs of disks with CGAL's, triangle for triangle, and the time that both take.

    python scripts/disks                           10,000 disks of each family
    python scripts/disks --n 100000 --rounds 3 --families "uniform radii"

The triangles of `liftmesh.apollonius` and those of CGAL's `Apollonius_graph_hierarchy_2`, with its
filtered traits, are compared as sets of distinct disks in counter-clockwise order; where more than
three disks touch one circle, as sets of circles, in single precision. Seconds are those of the
processor, the least of some rounds in which both take turns, on one thread; the clock of CGAL holds
the insertion alone. Exits with 1 at a difference.

Needs a compiler and CGAL: apt-get install g++ libcgal-dev.
"""

from __future__ import annotations

import sys
from argparse import Namespace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from benchmark.cgal.beside import built, clocked, columns, conclude, in_turn, parser_of
from disks.families import FAMILIES, TIED, Disks
from disks.peer import build, by_cgal

import liftmesh

SEED = 19


def main() -> None:
    """Compare all families, and print a line for each."""
    options = parser_of(__doc__, FAMILIES, 10_000).parse_args()
    program = built(build)
    print(f"{'disks':<20} {'hidden':>7} {'triangles':>10} {'liftmesh':>9} {'CGAL':>9} ratio")
    conclude([compare(program, options, name) for name in options.families], "families")


def compare(program: Path, options: Namespace, name: str) -> bool:
    """Make the graph by both programs in turns; whether it is the same."""
    disks = FAMILIES[name](options.n, np.random.default_rng(SEED))

    def theirs() -> tuple[tuple[np.ndarray, int], float]:
        triangles, seconds, vertices = by_cgal(program, disks)
        return (triangles, vertices), seconds

    calls = {
        "ours": lambda: clocked(lambda: liftmesh.apollonius(disks[:, :2], disks[:, 2])),
        "theirs": theirs,
    }
    results, seconds = in_turn(calls, options.rounds)
    graph, (triangles, vertices) = results.values()
    seen = len(disks) - len(graph.hidden) - len(graph.duplicates)
    is_same = vertices == seen and agrees(disks, graph, triangles, is_tied=name in TIED)
    print(
        f"{name:<20} {len(graph.hidden) / len(disks):>7.1%} {len(graph.simplices):>10,} "
        f"{columns(seconds)}{'' if is_same else '  DIFFERENT'}",
        flush=True,
    )
    return is_same


def agrees(
    disks: Disks, graph: liftmesh.ApolloniusGraph, triangles: np.ndarray, *, is_tied: bool
) -> bool:
    """Whether triangles of distinct disks are those of the graph, or have its circles."""
    distinct, numbers = np.unique(disks, axis=0, return_inverse=True)
    ours = numbers.reshape(-1)[graph.simplices]
    if not is_tied:
        return np.array_equal(as_set(ours), as_set(triangles))
    return circles(distinct, ours) == circles(distinct, triangles)


def as_set(triangles: np.ndarray) -> np.ndarray:
    """Turn each triangle to its least corner, and order all."""
    turn = triangles.argmin(1)[:, None] + np.arange(3)
    turned = np.take_along_axis(triangles, turn % 3, 1)
    return turned[np.lexsort(turned.T[::-1])]


def circles(distinct: Disks, triangles: np.ndarray) -> set[tuple[float, ...]]:
    """Return the circles that touch the corners of triangles, each by a graph of three disks."""
    found = set()
    for corners in np.unique(np.sort(triangles, axis=1), axis=0):
        three = distinct[corners]
        for circle in liftmesh.apollonius(three[:, :2], three[:, 2]).circles:
            found.add(tuple((circle.astype(np.float32) + np.float32(0)).tolist()))
    return found


if __name__ == "__main__":
    main()
