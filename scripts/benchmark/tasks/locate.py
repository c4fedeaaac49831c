"""Time the location of points in a triangulation, compared with SciPy and matplotlib.

    python scripts/bench.py locate                   a million points in a million rows
    python scripts/bench.py locate --n 100000 --distributions uniform circle parabola
    python scripts/bench.py locate --before old/bin/python     a former liftmesh beside this one

Every program locates the same points in the same triangles: in random order, and along a curve that
fills the plane. They are uniform in the bounding box, or with `--at triangles` one in each of as
many triangles, which are drawn at random. liftmesh uses all threads, the others have one. Each runs
in a process of its own, where the best of the rounds counts; the first call, which makes an index,
stands apart. SciPy walks far where neighbours in the list are not neighbours in the plane, so it
and matplotlib take no more than `--most` points. Shown are microseconds for a point, and what as
many points as rows would take in times of building that triangulation.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any, TypeAlias

import numpy as np
from benchmark.contest import SEED
from benchmark.measuring import add_common, console, empty_table, in_process, load
from benchmark.peers import BEFORE, OURS
from distributions import DISTRIBUTIONS, Points
from rich.table import Table

import liftmesh

Find: TypeAlias = Callable[[Points], Any]

USUAL = ("uniform", "clusters", "lattice", "circle", "two-columns", "parabola")
ORDERS = ("random", "along a curve")
COLUMNS = ("first us", "again us", "a point for each row, of the build")
LEVELS = 10  # of the curve: a million cells


@dataclass(frozen=True)
class Taken:
    """Seconds of building the triangulation, of the first call, and of the best later one."""

    build: float
    first: float
    again: float
    points: int


def run(options: Namespace) -> None:
    terminal = console(110)
    with terminal.status("") as status:
        for distribution in options.distributions:
            terminal.print(table_of(distribution, options, status.update))


def table_of(distribution: str, options: Namespace, tell: Callable[[str], None]) -> Table:
    """Time all programs on a distribution."""
    points = DISTRIBUTIONS[distribution](options.n, np.random.default_rng(SEED))
    title = f"{distribution}, {len(points):,} rows, {load()}"
    table = empty_table(title, ["order", "program"], COLUMNS)
    for order in ORDERS:
        asked = ordered(queries(points, options.at), order)
        for name, python in programs(options.before):
            tell(f"{distribution}: {order}, {name}")
            most = len(asked) if name.startswith(OURS) else options.most
            found = time(python, name, points, asked[:most], options.rounds)
            table.add_row(order, name, *cells(found, len(points)))
    return table


def add_options(parser: ArgumentParser) -> None:
    add = parser.add_argument
    add_common(parser, rounds=5)
    add("--distributions", nargs="+", choices=DISTRIBUTIONS, default=USUAL, metavar="D")
    add("--at", choices=("box", "triangles"), default="box", help="where the points are")
    add("--most", type=int, default=10_000, metavar="POINTS", help="of other programs")
    add("--before", metavar="PYTHON", help="interpreter for which a former liftmesh is installed")


def programs(before: str | None) -> list[tuple[str, str]]:
    """List the programs: a name, and the interpreter that runs it."""
    former = [(BEFORE, before)] if before else []
    return [(OURS, sys.executable), *former, *((name, sys.executable) for name in PEERS)]


def queries(points: Points, at: str) -> Points:
    """Make as many points as there are rows."""
    rng = np.random.default_rng(SEED + 1)
    if at == "triangles":
        simplices = liftmesh.delaunay(points).simplices
        return points[simplices[rng.integers(0, len(simplices), len(points))]].mean(axis=1)
    return rng.uniform(points.min(axis=0), points.max(axis=0), points.shape)


def ordered(asked: Points, order: str) -> Points:
    """Sort points along a curve, or not."""
    if order == "random":
        return asked
    cells = np.argsort(np.argsort(asked, axis=0), axis=0) * 2**LEVELS // len(asked)
    bits = sum(((cells >> k) & 1) << (2 * k) for k in range(LEVELS))
    return asked[np.argsort(bits[:, 0] | bits[:, 1] << 1, kind="stable")]


def time(python: str, name: str, points: Points, asked: Points, rounds: int) -> Taken:
    """Time a program in a fresh process."""
    with TemporaryDirectory() as folder:
        files = Path(folder) / "points", Path(folder) / "asked"
        points.tofile(files[0])
        asked.tofile(files[1])
        return Taken(**in_process(take, name, *files, rounds, python=python))


def take(name: str, points_file: str, asked_file: str, rounds: int) -> Taken:
    """Time the calls of a program in this process."""
    points, asked = (np.fromfile(each).reshape(-1, 2) for each in (points_file, asked_file))
    liftmesh.delaunay(points)
    begin = perf_counter()
    triangulation = liftmesh.delaunay(points)
    build = perf_counter() - begin
    find = PEERS.get(name, ours)(triangulation)
    taken = []
    for _ in range(rounds + 1):
        begin = perf_counter()
        find(asked)
        taken.append(perf_counter() - begin)
    return Taken(build, taken[0], min(taken[1:]), len(asked))


def ours(triangulation: liftmesh.Triangulation) -> Find:
    return triangulation.find_simplex


def scipy(triangulation: liftmesh.Triangulation) -> Find:
    return triangulation.to_scipy().find_simplex


def matplotlib(triangulation: liftmesh.Triangulation) -> Find:
    """Make its finder, a trapezoidal map of all edges, when it is first asked."""
    triangulated = import_module("matplotlib.tri").Triangulation
    mesh = triangulated(*triangulation.points.T, triangulation.simplices)
    return lambda asked: mesh.get_trifinder()(*asked.T)


PEERS: dict[str, Callable[[liftmesh.Triangulation], Find]] = {
    "scipy": scipy,
    "matplotlib": matplotlib,
}


def cells(found: Taken, rows: int) -> list[str]:
    first, again = (seconds / found.points for seconds in (found.first, found.again))
    return [f"{first * 1e6:.3f}", f"{again * 1e6:.3f}", f"{again * rows / found.build:.2f}"]
