"""Time graphs and cells of disks, and stars of metrics, compared with CGAL and `delaunay`.

    python scripts/bench.py disks                       100,000 disks and points: some minutes
    python scripts/bench.py disks --n 10000 --rounds 1 --only stars

Printed are rows for BENCHMARKS.md. Seconds are those of the processor, the least of the rounds, on
one thread; the programs take turns. Graphs are compared with CGAL's `Apollonius_graph_hierarchy_2`
(see `scripts/disks`, which also compares the triangles), whose clock holds the insertion alone.
Cells of disks are compared with Voronoi cells of the centres, and stars in a metric that turns and
stretches with the place, up to 8 times, with `delaunay`. The exponent is that of the growth from a
hundredth of the points. Without CGAL, its rows are left out: apt-get install g++ libcgal-dev.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator
from math import log
from typing import NamedTuple

import numpy as np
from benchmark import cgal
from benchmark.measuring import add_common, seconds_of
from disks.families import FAMILIES, Disks
from disks.peer import build, by_cgal
from growth.stars import metrics_of

import liftmesh

SEED = 19
SHOWN = ("uniform radii", "disjoint", "heavy overlap", "one large disk", "around a large disk")


class Row(NamedTuple):
    """A line of the table: the ratio is that of the seconds, or an exponent stands there."""

    what: str
    rows: int
    seconds: float
    other: str
    ratio: float


def least(call: Callable[[], object], rounds: int) -> float:
    """Return the least processor time of a call."""
    return max(min(seconds_of(call) for _ in range(rounds)), 1e-9)


def graphs(n: int, rounds: int) -> Iterator[Row]:
    """Compare graphs of disks with CGAL's."""
    try:
        program = build()
    except cgal.UnavailableError as error:
        print(f"CGAL is not here: {error}", file=sys.stderr)
        return
    for name in SHOWN:
        disks = FAMILIES[name](n, np.random.default_rng(SEED))
        ours = theirs = float("inf")
        for _ in range(rounds):
            ours = min(ours, least(lambda d=disks: liftmesh.apollonius(d[:, :2], d[:, 2]), 1))
            theirs = min(theirs, by_cgal(program, disks)[1])
        yield Row(f"graph, {name}", n, ours, f"CGAL, {theirs:.3g} s", ours / theirs)


def cells(n: int, rounds: int) -> Iterator[Row]:
    """Compare cells of disks with Voronoi cells."""
    disks: Disks = FAMILIES["uniform radii"](n, np.random.default_rng(SEED))
    straight = least(lambda: liftmesh.voronoi(disks[:, :2], domain=(0, 0, 1, 1)), rounds)

    def call() -> object:
        return liftmesh.apollonius_diagram(disks[:, :2], disks[:, 2], domain=(0, 0, 1, 1))

    taken = least(call, rounds)
    yield Row("cells in a box", n, taken, f"`voronoi`, {straight:.3g} s", taken / straight)


def stars(n: int, rounds: int) -> Iterator[Row]:
    """Compare stars with a triangulation, and tell how they grow."""
    found = {}
    for count in (n // 100, n // 10, n):
        points = np.random.default_rng(SEED).random((count, 2))
        metrics = metrics_of(points)
        times = rounds * (n // count if count * 10 <= n else 1)  # short calls: more rounds
        found[count] = least(lambda p=points, m=metrics: liftmesh.anisotropic_stars(p, m),
                             min(times, 20))  # fmt: skip
        plain = least(lambda p=points: liftmesh.delaunay(p, threads=1), min(times, 20))
        ratio = found[count] / plain
        yield Row("stars", count, found[count], f"`delaunay`, {plain:.3g} s", ratio)
    exponent = log(found[n] / found[n // 100]) / log(100)
    yield Row("stars, exponent of the growth", n, found[n], "n", exponent)


PARTS: dict[str, Callable[[int, int], Iterator[Row]]] = {
    "graphs": graphs, "cells": cells, "stars": stars,
}  # fmt: skip


def add_options(parser: ArgumentParser) -> None:
    add_common(parser, n=100_000)
    parser.add_argument("--only", nargs="+", choices=PARTS, default=[*PARTS])


def run(options: Namespace) -> None:
    if options.n < 1000:
        raise SystemExit("--n: give 1000 at least")
    print("| what | rows | seconds | compared with | ratio |")
    print("| --- | ---: | ---: | --- | ---: |")
    for part in options.only:
        for row in PARTS[part](options.n, options.rounds):
            print(
                f"| {row.what} | {row.rows:,} | {row.seconds:.3g} | {row.other} "
                f"| {row.ratio:.3g} |",
                flush=True,
            )
