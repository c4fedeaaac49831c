"""Time regular triangulations, metrics and farthest points, compared with CGAL, SciPy and delaunay.

    python scripts/bench.py weighted                     a million rows, some minutes
    python scripts/bench.py weighted --cases metric --rounds 9
    python scripts/bench.py weighted --cgal6 FOLDER      for the filtered peer, see scripts/weighted

Rounds alternate: liftmesh on one thread, on two, then the other programs. Shown is the least of the
rounds: of one thread seconds of the processor, which other programs hardly change, and of two
threads seconds by the clock. "Filtered" is CGAL with a static filter before its power test. CGAL's
clock holds the insertion alone. Before the time of liftmesh counts, `verify` judges its triangles;
`scripts/weighted` compares them with CGAL's. SciPy runs once, for `--limit` seconds at
most; a dash stands for what was cut off.

Needs a compiler, CGAL and SciPy: apt-get install g++ libcgal-dev; pip install -e '.[bench]'.
"""

from __future__ import annotations

import math
import os
import subprocess
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import numpy as np
from benchmark.contestants import KEEP_MEMORY
from benchmark.measuring import add_common, seconds_of
from benchmark.system_load import SystemLoad
from distributions import DISTRIBUTIONS, Points
from weighted.families import under_the_hull, with_share
from weighted.peers import Peer, peers

import liftmesh

SEED = 17
METRIC = [[2.0, 0.5], [0.5, 1.25]]
TUNABLES = "GLIBC_TUNABLES"
SCIPY = """
import sys, time, numpy, scipy.spatial
points = numpy.fromfile(sys.argv[1]).reshape(-1, 2)
start = time.process_time()
scipy.spatial.Delaunay(points, furthest_site=True)
print(time.process_time() - start)
"""
HEADER = """| case | liftmesh | 2 threads | other | | ratio | 2 threads | target |
| --- | ---: | ---: | --- | ---: | ---: | ---: | ---: |"""


@dataclass(frozen=True)
class Case:
    """What liftmesh does on some threads, and what it is compared with: seconds, and the target."""

    ours: Callable[[int], Any]
    others: Mapping[str, Callable[[], float]] = field(default_factory=dict)
    targets: Mapping[str, float] = field(default_factory=dict)
    is_quick: bool = True  # or its peers run once


def run(options: Namespace) -> None:
    """Print a table of the cases."""
    if os.environ.get(TUNABLES) != KEEP_MEMORY:  # read when the process starts
        os.execve(sys.executable, sys.orig_argv, os.environ | {TUNABLES: KEEP_MEMORY})
    load = SystemLoad()
    others = peers(options.cgal6)
    print(HEADER)
    for name in options.cases:
        for line in lines(name, CASES[name](options, others), options.rounds):
            print(line, flush=True)
    print(f"\nOther programs kept {load.processors():.1f} processors busy.")


def add_options(parser: ArgumentParser) -> None:
    add = parser.add_argument
    add_common(parser, rounds=5)
    add("--cases", nargs="+", choices=CASES, default=[*CASES], metavar="CASE")
    add("--limit", type=float, default=600, metavar="SECONDS", help="of SciPy")
    add("--cgal6", type=Path, metavar="FOLDER", help="of another CGAL, for the filtered peer")


def lines(name: str, case: Case, rounds: int) -> Iterator[str]:
    """Time a case, and write a row of the table for each other program."""
    if not liftmesh.verify(case.ours(2)).canonical:
        raise SystemExit(f"{name}: verify finds flaws")
    taken: dict[str, list[float]] = {each: [] for each in ("1", "2", *case.others)}
    for number in range(rounds):
        taken["1"].append(seconds_of(lambda: case.ours(1)))
        taken["2"].append(seconds_of(lambda: case.ours(2), perf_counter))
        if case.is_quick or number == 0:
            for each, run in case.others.items():
                taken[each].append(run())
    least = {each: min(seconds) for each, seconds in taken.items()}
    for each in case.others:
        yield row(name, each, least, case.targets.get(each))


def row(name: str, other: str, least: Mapping[str, float], target: float | None) -> str:
    """Write a row: seconds of liftmesh and of another program, and what the ratios are."""
    numbers = [shown(least[each]) for each in ("1", "2")]
    ratios = [shown(least[each] / least[other]) for each in ("1", "2")]
    said = "" if target is None else f"{target:g}"
    cells = (name, *numbers, other, shown(least[other]), *ratios, said)
    return f"| {' | '.join(cells)} |"


def shown(number: float) -> str:
    """Write a number with three digits; a dash for what was cut off, and for its ratios."""
    if number in (0.0, math.inf):
        return "-"
    return f"{number:.2f}" if number >= 1 else f"{number:.3f}" if number >= 0.1 else f"{number:.2g}"


def uniform(options: Namespace) -> Points:
    """Make the points of all cases but one."""
    return DISTRIBUTIONS["uniform"](options.n, np.random.default_rng(SEED))


def weighed(share: float | None) -> Callable[[Namespace, Mapping[str, Peer]], Case]:
    """Hide a share of the rows, or all but the hull, beside CGAL."""

    def make(options: Namespace, others: Mapping[str, Peer]) -> Case:
        points = uniform(options)
        drawn = np.random.default_rng(SEED + 1).random(len(points))
        weights = under_the_hull(points) if share is None else with_share(points, drawn, share)
        return Case(
            lambda threads: liftmesh.regular(points, weights=weights, threads=threads),
            {each: lambda p=peer: p.regular(points, weights)[1] for each, peer in others.items()},
            {"CGAL": 0.55, "filtered": 0.8} if share == 0.5 else {},
        )

    return make


def beside_delaunay(points: Points, target: float, **options: Any) -> Case:
    """Take a member that hides no row, beside `delaunay` of the same points."""
    call = liftmesh.delaunay if "metric" in options else liftmesh.regular

    def plain() -> float:
        return seconds_of(lambda: liftmesh.delaunay(points, threads=1))

    return Case(
        lambda threads: call(points, threads=threads, **options),
        {"delaunay": plain},
        {"delaunay": target},
    )


def equal(options: Namespace, _: object) -> Case:
    """All rows weigh the same."""
    points = uniform(options)
    return beside_delaunay(points, 1.5, weights=np.full(len(points), 0.25))


def small(options: Namespace, _: object) -> Case:
    """The weights are too small to hide a row."""
    points = uniform(options)
    weights = np.random.default_rng(SEED + 1).random(len(points)) * 2.0**-60
    return beside_delaunay(points, 2.0, weights=weights)


def metric(options: Namespace, _: object) -> Case:
    """In a constant metric."""
    return beside_delaunay(uniform(options), 1.3, metric=METRIC)


def farthest(distribution: str) -> Callable[[Namespace, Mapping[str, Peer]], Case]:
    """The farthest points, beside SciPy."""

    def make(options: Namespace, _: object) -> Case:
        is_circle = distribution == "circle"
        n = options.n // 10 if is_circle else options.n
        points = DISTRIBUTIONS[distribution](n, np.random.default_rng(SEED))
        return Case(
            lambda threads: on_threads(points, threads),
            {"SciPy": lambda: scipy(points, options.limit)},
            {} if is_circle else {"SciPy": 0.02},
            is_quick=False,
        )

    return make


def on_threads(points: Points, threads: int) -> liftmesh.scipy.Delaunay:
    """Triangulate with the class of SciPy, which has no option for threads."""
    os.environ["LIFTMESH_NUM_THREADS"] = str(threads)
    return liftmesh.scipy.Delaunay(points, furthest_site=True)


def scipy(points: Points, limit: float) -> float:
    """Run SciPy in a process of its own; infinity if it takes longer than the limit."""
    with TemporaryDirectory() as folder:
        file = Path(folder, "points")
        points.tofile(file)
        command = [sys.executable, "-c", SCIPY, str(file)]
        try:
            done = subprocess.run(command, capture_output=True, check=True, timeout=limit)
        except subprocess.TimeoutExpired:
            return math.inf
    return float(done.stdout)


CASES: dict[str, Callable[[Namespace, Mapping[str, Peer]], Case]] = {
    "half hidden": weighed(0.5),
    "15 % hidden": weighed(0.15),
    "75 % hidden": weighed(0.75),
    "99 % hidden": weighed(0.99),
    "all hidden but the hull": weighed(None),
    "equal weights": equal,
    "weights that hide no row": small,
    "metric": metric,
    "farthest": farthest("uniform"),
    "farthest, on a circle": farthest("circle"),
}
