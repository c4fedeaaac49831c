"""Time graphs of near points beside libpysal, and many small sets beside SciPy.

    python scripts/bench.py graphs --n 150000 --python OTHER/bin/python

Programs run in processes of their own, in turn, on one thread; shown is the least of the rounds, in
seconds of the processor, from the rows on, and the number of edges. libpysal is imported, and its
functions compiled by numba, before the time counts. A dash stands for what is missing, fails or
takes more than `--limit` seconds. Sets have 10 to 100 rows.

Needs SciPy, and libpysal with numba: pip install libpysal numba.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace

import numpy as np
from benchmark.measuring import add_common
from benchmark.tasks.shapes import shown, times

SEED = 39
ALONE = ("minimum_spanning_tree", "sphere_of_influence")  # not in libpysal
KINDS = ("delaunay", "gabriel", "relative_neighborhood", *ALONE)
OURS = """
import liftmesh
planar = points[:, :2].copy()
liftmesh.delaunay(planar[:9]).graph()
make = lambda: liftmesh.delaunay(planar, threads=1).graph("KIND", "binary")
found = timed("whole", make).nnz // 2
"""
THEIRS = """
from libpysal.graph import Graph
make = lambda rows: Graph.build_triangulation(rows[:, :2], "KIND")
make(points[:50])
found = timed("whole", lambda: make(points)).n_edges // 2
"""
SETS = """
import liftmesh
from scipy.spatial import Delaunay
sizes = np.random.default_rng(1).integers(10, 101, len(points))
ends = np.cumsum(sizes)
offsets = np.append(0, ends[ends <= len(points)])
planar = points[:offsets[-1], :2].copy()
parts = [planar[a:b] for a, b in zip(offsets[:-1], offsets[1:])]
liftmesh.delaunay(parts[0]), Delaunay(parts[0])
found = len(parts)
def many():
    return liftmesh.delaunay_many(planar, offsets, threads=1)
def loop():
    return [liftmesh.delaunay(each) for each in parts]
def loop_of_scipy():
    return [Delaunay(each) for each in parts]
timed("whole", CALL)
"""
WAYS = {"delaunay_many": "many", "delaunay": "loop", "scipy.spatial.Delaunay": "loop_of_scipy"}


def add_options(parser: ArgumentParser) -> None:
    add = parser.add_argument
    add_common(parser)
    add("--kinds", nargs="*", choices=KINDS, default=KINDS, metavar="KIND")
    add("--sets", type=int, default=550_000, metavar="ROWS", help="of all sets; 0 leaves them out")
    add("--limit", type=float, default=600, metavar="SECONDS", help="of each run")
    add("--python", default=sys.executable, help="of an environment that has libpysal")


def run(options: Namespace) -> None:
    """Print both tables."""
    rng = np.random.default_rng(SEED)
    programs = {f"liftmesh {kind}": OURS.replace("KIND", kind) for kind in options.kinds}
    both = [kind for kind in options.kinds if kind not in ALONE]
    programs |= {f"libpysal {kind}": THEIRS.replace("KIND", kind) for kind in both}
    options.peers = [*programs, *WAYS]
    said = times(programs, rng.random((options.n, 3)), options)
    print(f"{options.n:,} rows\n| graph | liftmesh | edges | libpysal | edges |")
    print("| --- | ---: | ---: | ---: | ---: |")
    for kind in options.kinds:
        found = [said.get(f"{name} {kind}", ({}, 0)) for name in ("liftmesh", "libpysal")]
        cells = [f"{shown(taken.get('whole'))} | {count or '-'}" for taken, count in found]
        print(f"| {kind} | {' | '.join(cells)} |", flush=True)
    if options.sets:
        calls = {name: SETS.replace("CALL", call) for name, call in WAYS.items()}
        said = times(calls, rng.random((options.sets, 3)), options)
        print(f"\n{max(count for _, count in said.values()):,} sets of 10 to 100 rows")
        print("| program | seconds |\n| --- | ---: |")
        for name, (taken, _) in said.items():
            print(f"| {name} | {shown(taken.get('whole'))} |", flush=True)
