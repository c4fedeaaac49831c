"""Time `verify` against building the triangulation of the same points, for several sources.

    python scripts/bench.py verify                                    a million rows
    python scripts/bench.py verify --n 100000 --peers shull triangle scipy
    python scripts/bench.py verify --distributions uniform circle --threads 1
    python scripts/bench.py verify --flawed --distributions uniform

The triangles are liftmesh's; the same shuffled; the same apart, each with three rows of its own as
in an STL file (which makes about six times as many rows to build from); those of the given peers;
with `--flawed` also four lists that are wrong. In a fresh process for each list, building and
verifying alternate. Memory is the peak of each in a process of its own, without the input but with
the results. Hashing the input for the certificate is timed apart, and judging is the rest. The
ratio is that of judging to building.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
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
from benchmark.measuring import add_common, console, empty_table, in_process
from benchmark.peers import OURS, PEERS, Triangles
from distributions import DISTRIBUTIONS, Points
from process_state import memory

import liftmesh
from liftmesh.planar.verification import _sums as hash_input

Call: TypeAlias = Callable[[], Any]

COLUMNS = ("build s", "judge s", "ratio", "hash s", "build B/row", "verify B/row")
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


def run(options: Namespace) -> None:
    terminal = console(110)
    for distribution in options.distributions:
        points = DISTRIBUTIONS[distribution](options.n, np.random.default_rng(SEED))
        title = f"{distribution}, {len(points):,} rows"
        table = empty_table(title, ("triangles", "threads", "answer"), COLUMNS)
        with TemporaryDirectory() as folder, terminal.status("") as status:
            wrong = flawed_lists(points) if options.flawed else ()
            for maker, rows, triangles in chain(lists_of(points, options.peers), wrong):
                for threads in options.threads:
                    status.update(f"{distribution}: triangles of {maker}, threads: {threads}")
                    judged = judge(rows, triangles, threads, options.rounds, Path(folder))
                    table.add_row(maker, f"{threads}", *cells(judged, len(rows)))
        terminal.print(table)


def add_options(parser: ArgumentParser) -> None:
    add = parser.add_argument
    add_common(parser, rounds=5)
    add("--distributions", nargs="+", choices=DISTRIBUTIONS, default=USUAL, metavar="D")
    add("--peers", nargs="*", choices=MAKERS, default=[], metavar="P", help=", ".join(MAKERS))
    add("--flawed", action="store_true", help="lists with flaws, too")
    add("--threads", nargs="+", type=int, default=[1, 2], metavar="K")


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
    case = (*files, threads)
    keeping = {"GLIBC_TUNABLES": KEEP_MEMORY}
    held = {
        name: in_process(peak_of, name, *case, environment=keeping) for name in ("build", "verify")
    }
    times = in_process(take_turns, rounds, *case, environment=keeping)
    costs = {name: Cost(times[name], held[name]) for name in held}
    return Judged(**costs, hash_seconds=times["hash"], answer=times["answer"])


def calls_on(points_file: str, triangles_file: str, threads: int) -> dict[str, Call]:
    points = np.fromfile(points_file).reshape(-1, 2)
    triangles = np.fromfile(triangles_file, np.int32).reshape(-1, 3)
    liftmesh.verify(points[:3], [[0, 1, 2]])  # resolves the lazy imports
    return {
        "build": lambda: liftmesh.delaunay(points, threads=threads),
        "verify": lambda: liftmesh.verify(points, triangles, threads=threads),
        "hash": lambda: hash_input(points, triangles, threads > 1),
    }


def take_turns(rounds: int, *case: Any) -> dict[str, Any]:
    """Time both in alternation, B V B V; the first turns are not timed."""
    calls = calls_on(*case)
    calls["build"]()
    certificate = calls["verify"]()
    seconds: dict[str, list[float]] = {name: [] for name in calls}
    for _ in range(rounds):
        for name, call in calls.items():
            start = perf_counter()
            result = call()
            seconds[name].append(perf_counter() - start)
            del result
    answer = ("canonical" if certificate.canonical else "valid") if certificate else "not valid"
    return {name: median(taken) for name, taken in seconds.items()} | {"answer": answer}


def peak_of(name: str, *case: Any) -> int:
    """Return the peak memory of the first call in a process."""
    call = calls_on(*case)[name]
    before = memory("VmRSS")
    call()
    return max(0, memory("VmHWM") - before)


def cells(judged: Judged, rows: int) -> list[str]:
    build, judging = judged.build.seconds, judged.verify.seconds - judged.hash_seconds
    ratio = f"{judging / build:.2f}"
    seconds = [f"{build:.3f}", f"{judging:.3f}", ratio, f"{judged.hash_seconds:.3f}"]
    held = [f"{cost.bytes / rows:.0f}" for cost in (judged.build, judged.verify)]
    return [judged.answer, *seconds, *held]
