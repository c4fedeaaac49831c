"""Time tetrahedra and their proof, beside CGAL, SciPy and shull.

    python scripts/bench.py space                        a million rows, some minutes
    python scripts/bench.py space --cases lattice --rounds 5
    python scripts/bench.py space --n 10000000 --cases uniform --peers CGAL

Rounds alternate: liftmesh on one thread, on two, `verify`, then CGAL's `Delaunay_triangulation_3`
(range insertion, so in spatial order); the other programs run once, for `--limit` seconds at most,
and a dash stands for what is missing or was cut off. Shown is the least of the rounds, in seconds
of the processor. "Two" is what the first of two threads computes: what they take where two
processors are free. Memory is the peak of each program in a process of its own, in bytes a row
beyond the rows.
`python scripts/tetrahedra` compares the tetrahedra with CGAL's, set for set.

Needs a compiler and CGAL: apt-get install g++ libcgal-dev; pip install -e '.[bench]'.
"""

from __future__ import annotations

import os
import subprocess
import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path
from tempfile import TemporaryDirectory
from time import thread_time

import numpy as np
from benchmark import cgal
from benchmark.cgal.beside import PROGRAMS, answer, built
from benchmark.contestants import KEEP_MEMORY
from benchmark.measuring import add_common, in_process, seconds_of
from benchmark.system_load import SystemLoad
from distributions import Points
from process_state import memory
from tetrahedra.families import FAMILIES

import liftmesh

SEED = 38
SOURCE = Path(__file__).resolve().parents[2] / "tetrahedra" / "cgal.cpp"
CASES = ("uniform", "ball", "clusters", "lattice", "0.1-lattice", "sphere", "moment curve")
ONCE = {"SciPy": "scipy.spatial.Delaunay", "shull": "shull.Delaunay3d"}
CALL = """
import sys, time, numpy, {module}
points = numpy.fromfile(sys.argv[1]).reshape(-1, 3)
start = time.process_time()
{call}(points)
print(time.process_time() - start)
"""
COLUMNS = (
    *("points", "tetrahedra", "liftmesh", "two", "verify", "CGAL", "ratio"),
    *("SciPy", "shull", "B/row", "CGAL"),
)
HEADER = f"| {' | '.join(COLUMNS)} |\n| ---{' | ---:' * (len(COLUMNS) - 1)} |"


def run(options: Namespace) -> None:
    """Print a table of the cases."""
    load = SystemLoad()
    print(HEADER)
    for name in options.cases:
        points = FAMILIES[name](options.n, np.random.default_rng(SEED))
        print(line(name, points, options), flush=True)
    print(f"\nOther programs kept {load.processors():.1f} processors busy.")


def add_options(parser: ArgumentParser) -> None:
    add = parser.add_argument
    add_common(parser)
    add("--cases", nargs="+", choices=FAMILIES, default=CASES, metavar="CASE")
    add("--peers", nargs="*", choices=["CGAL", *ONCE], default=["CGAL", *ONCE])
    add("--limit", type=float, default=300, metavar="SECONDS", help="of programs that run once")
    add("--python", default=sys.executable, help="of an environment that has them")


def line(name: str, points: Points, options: Namespace) -> str:
    """Time a case, and write its row."""
    with TemporaryDirectory() as folder:
        file = Path(folder, "points")
        points.tofile(file)
        keeping = {"GLIBC_TUNABLES": KEEP_MEMORY}
        taken: dict[str, list[float]] = {"1": [], "two": [], "verify": [], "CGAL": []}
        beyond = 0
        for _ in range(options.rounds):
            for key, seconds in in_process(times_of, file, environment=keeping).items():
                taken[key].append(seconds)
            if "CGAL" in options.peers:
                _, said = answer(built(cgal.build, PROGRAMS, SOURCE), points, "2", corners=4)
                taken["CGAL"].append(said["seconds"])
                beyond = said["beyond"]
        count, held = in_process(peak_of, file)
        once = [by(each, file, options) for each in ONCE]
    ours, two, verify, theirs = (min(each, default=0.0) for each in taken.values())
    ratio = ours / theirs if theirs else 0.0
    cells = [*map(shown, (ours, two, verify, theirs, ratio, *once))]
    sizes = [f"{size / len(points):.0f}" if size else "-" for size in (held, beyond)]
    return f"| {name}, {len(points):,} | {count:,} | {' | '.join([*cells, *sizes])} |"


def shown(number: float) -> str:
    """Write a number with three digits; a dash for what is missing."""
    return f"{number:#.3g}".rstrip(".") if number else "-"


def times_of(file: str) -> dict[str, float]:
    """Time each call once, after a first one that finds the pages."""
    points = np.fromfile(file).reshape(-1, 3)
    found = liftmesh.tetrahedralize(points, threads=2)
    proof = seconds_of(lambda: found.verify(threads=1))
    if not found.verify(threads=2).canonical:
        raise SystemExit("verify finds flaws")
    return {
        "1": seconds_of(lambda: liftmesh.tetrahedralize(points, threads=1)),
        "two": seconds_of(lambda: liftmesh.tetrahedralize(points, threads=2), thread_time),
        "verify": proof,
    }


def peak_of(file: str) -> tuple[int, int]:
    """Return how many tetrahedra there are, and the peak of memory beyond the rows."""
    points = np.fromfile(file).reshape(-1, 3)
    liftmesh.tetrahedralize(np.eye(4, 3), threads=1)
    before = memory("VmRSS")
    found = liftmesh.tetrahedralize(points, threads=1)
    return len(found.simplices), max(0, memory("VmHWM") - before)


def by(peer: str, file: Path, options: Namespace) -> float:
    """Run another program in a process of its own; 0 if it is missing, or takes too long."""
    if peer not in options.peers:
        return 0.0
    call = ONCE[peer]
    text = CALL.format(module=call.rpartition(".")[0], call=call)
    command = [options.python, "-c", text, str(file)]
    environment = os.environ | {"GLIBC_TUNABLES": KEEP_MEMORY}
    try:
        done = subprocess.run(
            command, capture_output=True, check=False, timeout=options.limit, env=environment
        )
    except subprocess.TimeoutExpired:
        return 0.0
    return 0.0 if done.returncode else float(done.stdout)
