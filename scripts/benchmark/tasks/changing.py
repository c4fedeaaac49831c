"""Time points that come and go in a large triangulation, compared with CGAL.

    python scripts/bench.py changing                    100,000 of a million points: some minutes
    python scripts/bench.py changing --n 50000 --rounds 1

Points are uniform. A tenth of them goes into the others as one call, beside CGAL's insertion of a
range, and one at a time in random order, beside CGAL's hierarchy; and another tenth goes, beside
CGAL's removal of as many vertices in the same order. One at a time, `DynamicTriangulation` has 63
points a call, the most that it takes in the order given: so calls from Python are left out. Seconds
are those of the processor, the least of the rounds, in which both take turns; the numbers of
triangles must be equal. Needs a compiler and CGAL: apt-get install g++ libcgal-dev.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from pathlib import Path

import numpy as np
from benchmark import cgal
from benchmark.cgal.beside import PROGRAMS, answer, built, clocked
from benchmark.measuring import add_common
from benchmark.system_load import SystemLoad
from distributions import Points

import liftmesh

SEED = 29
IN_ORDER = 63  # rows of a call
SOURCE = Path(__file__).parents[2] / "constrained" / "changing.cpp"
TARGETS = {"range": 1.0, "alone": 1.0, "removal": 1.2}
SAID = {"range": "inserted at once", "alone": "inserted one at a time", "removal": "removed"}
HEADER = "| change | points | before | CGAL | liftmesh | ratio | target |\n" + "| --- " * 7 + "|"


def add_options(parser: ArgumentParser) -> None:
    add_common(parser, rounds=3)


def run(options: Namespace) -> None:
    """Print a table of the changes."""
    load = SystemLoad()
    program = built(cgal.build, PROGRAMS, SOURCE)
    points = np.random.default_rng(SEED).random((options.n, 2))
    many = len(points) // 10
    taken = [turn(program, points, many) for _ in range(options.rounds)]
    print(HEADER)
    for name, target in TARGETS.items():
        theirs, ours = (min(each[program][name] for each in taken) for program in (0, 1))
        before = len(points) - many * (name != "removal")
        cells = (SAID[name], f"{many:,}", f"{before:,}", f"{theirs:.3g}", f"{ours:.3g}")
        print(f"| {' | '.join(cells)} | {ours / max(theirs, 1e-9):.2f} | {target:g} |")
    print(f"\nOther programs kept {load.processors():.1f} processors busy.")


def turn(program: Path, points: Points, many: int) -> tuple[dict[str, float], dict[str, float]]:
    """Return the seconds of CGAL's changes and of ours."""
    counts, theirs = answer(program, points, str(many))
    found, ours = changes(points, many)
    if counts.ravel().tolist() != found:
        raise SystemExit(f"CGAL has {counts.ravel().tolist()} triangles, liftmesh {found}")
    return theirs, ours


def changes(points: Points, many: int) -> tuple[list[int], dict[str, float]]:
    """Return how many triangles there are after each change, and what it took."""
    tri = liftmesh.DynamicTriangulation(points[:-many])
    seconds = {"range": clocked(lambda: tri.insert(points[-many:]))[1]}
    counts = [len(tri.simplices)]
    tri = liftmesh.DynamicTriangulation(points[:-many])

    def insert_alone() -> None:
        for first in range(len(points) - many, len(points), IN_ORDER):
            tri.insert(points[first : first + IN_ORDER])

    seconds["alone"] = clocked(insert_alone)[1]
    counts.append(len(tri.simplices))
    gone = tri.find(points[:many])
    seconds["removal"] = clocked(lambda: tri.remove(gone))[1]
    return [*counts, len(tri.simplices)], seconds
