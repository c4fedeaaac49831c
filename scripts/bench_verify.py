"""Time `verify` against building the triangulation of the same points, for several sources.

    python scripts/bench_verify.py                                    a million rows
    python scripts/bench_verify.py --n 100000 --peers shull triangle scipy
    python scripts/bench_verify.py --distributions uniform circle --threads 1
    python scripts/bench_verify.py --flawed --distributions uniform

The triangles are liftmesh's; the same shuffled; the same apart, each with three rows of its own as
in an STL file (which makes about six times as many rows to build from); those of the given peers;
with `--flawed` also four lists that are wrong. In a fresh process for each list, building and
verifying alternate. Memory is the peak of each in a process of its own, without the input but with
the results. Hashing the input for the certificate is timed apart, and judging is the rest. The
ratio is that of judging to building.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any, TypeAlias

import numpy as np
from benchmark.contest import SEED
from benchmark.contestants import KEEP_MEMORY
from benchmark.peers import OURS, PEERS, Triangles
from benchmark.worker import memory
from distributions import DISTRIBUTIONS, Points
from rich.console import Console
from rich.table import Table

import liftmesh
from liftmesh.planar.verification import _sums as hash_input

Call: TypeAlias = Callable[[], Any]

SHUFFLED, APART = "shuffled", "apart"
USUAL = ("uniform", "gaussian", "clusters", "lattice", "utm-lattice", "circle", "two-columns")
MAKERS = [name for name, peer in PEERS.items() if peer.triangulates and name not in (OURS, "CGAL")]


@dataclass(frozen=True)
class Cost:
    """Median seconds of a call, and its peak memory in bytes without the input."""

    seconds: float
    bytes: int


@dataclass(frozen=True)
class Judged:
    """The cost of building and of verifying a list of triangles, and the verdict on it."""

    build: Cost
    verify: Cost
    hash_seconds: float
    answer: str


def main() -> None:
    """Print a table for each distribution."""
    options = read_options()
    console = Console() if os.isatty(1) else Console(width=110)
    for distribution in options.distributions:
        points = DISTRIBUTIONS[distribution](options.n, np.random.default_rng(SEED))
        table = empty_table(f"{distribution}, {len(points):,} rows")
        with TemporaryDirectory() as folder, console.status("") as status:
            wrong = flawed_lists(points) if options.flawed else ()
            for maker, rows, triangles in chain(lists_of(points, options.peers), wrong):
                for threads in options.threads:
                    status.update(f"{distribution}: triangles of {maker}, threads: {threads}")
                    judged = judge(rows, triangles, threads, options.repeat, Path(folder))
                    table.add_row(maker, f"{threads}", *cells(judged, len(rows)))
        console.print(table)


def read_options() -> Namespace:
    """Parse the command line."""
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--n", type=int, default=1_000_000, metavar="ROWS")
    add("--distributions", nargs="+", choices=DISTRIBUTIONS, default=USUAL, metavar="D")
    add("--peers", nargs="*", choices=MAKERS, default=[], metavar="P", help=", ".join(MAKERS))
    add("--flawed", action="store_true", help="lists with flaws, too")
    add("--threads", nargs="+", type=int, default=[1, 2], metavar="K")
    add("--repeat", type=int, default=5, help="rounds")
    return parser.parse_args()


def lists_of(points: Points, peers: list[str]) -> Iterator[tuple[str, Points, Triangles]]:
    """Yield lists of triangles, all counter-clockwise: source, points, triangles."""
    ours = liftmesh.delaunay(points).simplices
    yield OURS, points, ours
    yield SHUFFLED, points, np.random.default_rng(SEED).permutation(ours)
    yield APART, points[ours.ravel()], np.arange(ours.size, dtype=np.int32).reshape(-1, 3)
    for name in peers:
        triangles, *_ = PEERS[name].rows(PEERS[name].prepare(1)(points), points)
        turned = liftmesh.orient2d(*np.moveaxis(points[triangles], 1, 0)) < 0
        upward = np.where(turned[:, None], triangles[:, ::-1], triangles)
        yield name, points, upward.astype(np.int32)


def flawed_lists(points: Points) -> Iterator[tuple[str, Points, Triangles]]:
    """Yield lists of triangles with flaws: which, points, triangles."""
    ours = liftmesh.delaunay(points).simplices
    middle, half = len(ours) // 2, np.arange(len(ours)) % 2 == 0
    turned = ours[:, ::-1]
    yield (
        "one clockwise",
        points,
        np.vstack([ours[:middle], turned[middle:][:1], ours[middle + 1 :]]),
    )
    yield "all clockwise", points, np.ascontiguousarray(turned)
    yield "half clockwise", points, np.where(half[:, None], turned, ours)
    yield "all twice", points, np.vstack([ours, ours])


def judge(points: Points, triangles: Triangles, threads: int, rounds: int, folder: Path) -> Judged:
    """Time both in one fresh process, and measure the peak of each in one of its own."""
    files = folder / "points", folder / "triangles"
    points.tofile(files[0])
    triangles.tofile(files[1])
    held = {name: run("peak", name, *files, threads)["held"] for name in ("build", "verify")}
    times = run("turns", rounds, *files, threads)
    costs = {name: Cost(times[name], held[name]) for name in held}
    return Judged(**costs, hash_seconds=times["hash"], answer=times["answer"])


def run(*words: object) -> dict[str, Any]:
    """Run a job in a process of this script."""
    command = [sys.executable, __file__, *map(str, words)]
    environment = os.environ | {"GLIBC_TUNABLES": KEEP_MEMORY}
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True, env=environment)
    return json.loads(done.stdout)


def calls_on(points_file: str, triangles_file: str, threads: str) -> dict[str, Call]:
    points = np.fromfile(points_file).reshape(-1, 2)
    triangles = np.fromfile(triangles_file, np.int32).reshape(-1, 3)
    liftmesh.verify(points[:3], [[0, 1, 2]])  # resolves the lazy imports
    return {
        "build": lambda: liftmesh.delaunay(points, threads=int(threads)),
        "verify": lambda: liftmesh.verify(points, triangles, threads=int(threads)),
        "hash": lambda: hash_input(points, triangles, int(threads) > 1),
    }


def take_turns(rounds: str, *case: str) -> dict[str, Any]:
    """Time both in alternation, B V B V; the first turns are not timed."""
    calls = calls_on(*case)
    calls["build"]()
    certificate = calls["verify"]()
    seconds: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(int(rounds)):
        for name, call in calls.items():
            start = perf_counter()
            result = call()
            seconds[name].append(perf_counter() - start)
            del result
    answer = ("canonical" if certificate.canonical else "valid") if certificate else "not valid"
    return {name: median(taken) for name, taken in seconds.items()} | {"answer": answer}


def peak_of(name: str, *case: str) -> dict[str, Any]:
    """Return the peak memory of the first call in a process."""
    call = calls_on(*case)[name]
    before = memory("VmRSS")
    call()
    return {"held": max(0, memory("VmHWM") - before)}


JOBS: dict[str, Callable[..., dict[str, Any]]] = {"turns": take_turns, "peak": peak_of}


def empty_table(title: str) -> Table:
    table = Table("triangles", "threads", "answer", title=title, title_justify="left")
    for column in ("build s", "judge s", "ratio", "hash s", "build B/row", "verify B/row"):
        table.add_column(column, justify="right")
    return table


def cells(judged: Judged, rows: int) -> list[str]:
    build, judging = judged.build.seconds, judged.verify.seconds - judged.hash_seconds
    ratio = f"{judging / build:.2f}"
    seconds = [f"{build:.3f}", f"{judging:.3f}", ratio, f"{judged.hash_seconds:.3f}"]
    held = [f"{cost.bytes / rows:.0f}" for cost in (judged.build, judged.verify)]
    return [judged.answer, *seconds, *held]


if __name__ == "__main__":
    if sys.argv[1:] and sys.argv[1] in JOBS:
        print(json.dumps(JOBS[sys.argv[1]](*sys.argv[2:])))
    else:
        main()
