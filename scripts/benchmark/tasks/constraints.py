"""Time constrained triangulations, compared with CGAL, CDT, triangle and `delaunay`.

    python scripts/bench.py constraints                  up to a million edges: half an hour
    python scripts/bench.py constraints --quick          a twentieth of the sizes
    python scripts/bench.py constraints --cases star comb --rounds 1

Cases are those of `scripts/constrained/families.py`. Each program runs in processes of its own, in
turns, on one thread; shown are the least seconds of the processor, conversions left out where a
program is not called from Python. Before a time counts, the triangles are checked exactly and in
full (`scripts/oracles/second_opinion.py`); those of a carved coast must also have its area. The
edges of hard cases are compared with as many of the tiling, "tame edges", and one edge along a
strip with the triangulation of its points without the edge.

Needs a compiler and CGAL: apt-get install g++ libcgal-dev; pip install -e '.[bench]'.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from benchmark.measuring import MILLION
from benchmark.system_load import SystemLoad
from constrained.families import FAMILIES, Edges
from constrained.peers import CGAL, OURS, NoAnswerError, ask, liftmesh, write
from distributions import Points
from oracles.second_opinion import find_neighbors, flaw, keys, sides
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

SEED = 23
PEERS = (CGAL, "CDT", "triangle")
TAME = "tame edges"
QUICK = 20
HEADER = """| case | points | edges | program | seconds | liftmesh | ratio | target |
| --- | ---: | ---: | --- | ---: | ---: | ---: | ---: |"""


@dataclass(frozen=True)
class Case:
    """A family, about how many edges it has, what it is compared with, and the targets."""

    family: str
    size: int
    targets: Mapping[str, float] = field(default_factory=dict)
    others: tuple[str, ...] = PEERS
    is_carved: bool = False


def hard(family: str, size: int) -> Case:
    return Case(family, size, {TAME: 5}, (*PEERS, TAME))


CASES = {
    "tiling": Case("tiling", MILLION, {CGAL: 0.4}),
    "uniform": Case("uniform", MILLION, {CGAL: 0.4}),
    "coast": Case("coast", 105_000, {CGAL: 0.6}),
    "shuffled coast": Case("shuffled coast", 105_000),
    "carved coast": Case("coast", 105_000, {"triangle": 0.4}, ("CDT", "triangle"), is_carved=True),
    "star of 20,000": hard("star", 20_000),
    "star": hard("star", 100_000),
    "comb": hard("comb", 100_000),
    "spiral": hard("spiral", 100_000),
    "nested rings": hard("nested rings", 100_000),
    "nearly parallel": hard("nearly parallel", 100_000),
    "strip": Case("strip", 500_000, {"delaunay": 2}, (*PEERS, "delaunay")),
}


def carved(points: Points, edges: Edges) -> tuple[Edges, Points]:
    """Return the triangles at odd depth between rings, and a point in each hole."""
    triangles = liftmesh(points, edges, carve=False)()
    neighbors = find_neighbors(triangles)
    walls = np.isin(sides(triangles), keys(*edges.T)).reshape(-1, 3)
    t, k = np.nonzero((neighbors >= 0) & ~walls)
    count, part = components(t, neighbors[t, k], len(triangles))
    depth = np.full(count, -1)
    depth[part[np.nonzero((neighbors < 0) & ~walls)[0]]] = 0
    depth[part[np.nonzero((neighbors < 0) & walls)[0]]] = 1
    t, k = np.nonzero((neighbors >= 0) & walls)
    one, other = part[t], part[neighbors[t, k]]
    while (depth < 0).any():
        reached = (depth[one] >= 0) & (depth[other] < 0)
        depth[other[reached]] = depth[one[reached]] + 1
    first = np.unique(part, return_index=True)[1]
    holes = first[(depth % 2 == 0) & (depth > 0)]
    return triangles[depth[part] % 2 == 1], points[triangles[holes]].mean(axis=1)


def components(one: Edges, other: Edges, count: int) -> tuple[int, Edges]:
    """Number the parts of a graph."""
    matrix = coo_matrix((np.ones(len(one), bool), (one, other)), (count, count))
    return connected_components(matrix, directed=False)


def add_options(parser: ArgumentParser) -> None:
    add = parser.add_argument
    add("--cases", nargs="+", choices=CASES, default=[*CASES], metavar="CASE")
    add("--rounds", type=int, default=3, help="in which all take turns")
    add("--limit", type=float, default=120, metavar="SECONDS", help="of each program")
    add("--quick", action="store_true", help="a twentieth of the sizes")


def run(options: Namespace) -> None:
    """Print a table of the cases."""
    load = SystemLoad()
    print(HEADER)
    for name in options.cases:
        measure(name, CASES[name], options)
    print(f"\nOther programs kept {load.processors():.1f} processors busy.")


def measure(name: str, case: Case, options: Namespace) -> None:
    """Time a case, and print a row for each other program."""
    size = case.size // (QUICK if options.quick else 1)
    with TemporaryDirectory() as folder:
        trial = Trial(Path(folder), case, size, options.limit)
        for _ in range(options.rounds):
            trial.take_turns()
    ours = trial.said(OURS)
    for other in case.others:
        ratio = trial.least(OURS) / trial.least(other)
        target = case.targets.get(other)
        cells = (
            *(name, f"{len(trial.points):,}", f"{len(trial.edges):,}", other, trial.said(other)),
            *(ours, f"{ratio:.2f}" if ratio > 0 else "-", "" if target is None else f"{target:g}"),
        )
        print(f"| {' | '.join(cells)} |", flush=True)


class Trial:
    """A case that programs take turns at."""

    def __init__(self, folder: Path, case: Case, size: int, limit: float) -> None:
        self.case, self.limit, self.folder = case, limit, folder
        self.points, self.edges = FAMILIES[case.family](size, np.random.default_rng(SEED))
        self.seconds: dict[str, list[float]] = {each: [] for each in (OURS, *case.others)}
        self.trouble: dict[str, str] = {}
        self.expected, holes = carved(self.points, self.edges) if case.is_carved else (None, None)
        write(folder, (self.points, self.edges), holes)
        if TAME in case.others:
            self.tame = folder / "tame"
            self.tame.mkdir()
            write(self.tame, FAMILIES["tiling"](size, np.random.default_rng(SEED)))

    def take_turns(self) -> None:
        """Let each program that has had no trouble run once."""
        for name, taken in self.seconds.items():
            if name in self.trouble:
                continue
            try:
                taken.append(self.once(name))
            except NoAnswerError as error:
                self.trouble[name] = str(error)

    def once(self, name: str) -> float:
        """Return the seconds of a run, whose triangles are checked the first time."""
        if name == TAME:
            return ask(OURS, self.tame, self.limit)[0]
        seconds, triangles = ask(name, self.folder, self.limit, carve=self.case.is_carved)
        found = "" if self.seconds[name] else self.flaw(triangles, name)
        if found:
            raise NoAnswerError(f"wrong: {found}")
        return seconds

    def flaw(self, triangles: Edges, name: str) -> str:
        if self.expected is not None:
            same = np.array_equal(in_order(triangles), in_order(self.expected))
            return "" if same else "other triangles than those of the definition"
        return flaw(self.points, triangles, pieces=None if name == "delaunay" else self.edges)

    def least(self, name: str) -> float:
        return min(self.seconds[name], default=float("inf"))

    def said(self, name: str) -> str:
        return self.trouble.get(name) or f"{self.least(name):.3g}"


def in_order(triangles: Edges) -> Edges:
    """Sort triangles, and their corners."""
    corners = np.sort(triangles, axis=1)
    return corners[np.lexsort(corners.T)]
