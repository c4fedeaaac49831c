"""Where the kernel's cycles go: instructions and mispredicted branches a point, phase by phase.

    python scripts/profile_kernel.py                        100,000 uniform points, one thread
    python scripts/profile_kernel.py --distribution lattice --n 20000

A small driver is built with the kernel's sources and runs under valgrind's callgrind, which counts
instructions exactly and simulates a simple branch predictor: hold its mispredictions against each
other, not against a processor's. What is inlined counts for the function that it became a part of,
and for the source that it stands in.
"""

from __future__ import annotations

import os
import re
import tempfile
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from benchmark.profile.build import KERNEL, build
from benchmark.profile.callgrind import Cost, Place, profile
from distributions import DISTRIBUTIONS
from rich.console import Console
from rich.markup import escape
from rich.table import Table

SEED = 20
LONGEST = 60
CLONE = re.compile(r" \[clone [^]]*\]")
TASK = re.compile(r"([\w:]+)\([^()]*\)(?: const)?::\{lambda\([^()]*\)#(\d+)\}")
NESTED = re.compile(r"<[^<>]*>|\([^()]*\)(?: const)?")
LIBRARY = "libraries"
HEADINGS = ("instructions\na point", "share", "mispredicted\na point")


def main() -> None:
    """Build, run and print."""
    options = read_options()
    console = Console() if os.isatty(1) else Console(width=120)
    points = DISTRIBUTIONS[options.distribution](options.n, np.random.default_rng(SEED))
    with tempfile.TemporaryDirectory() as name, console.status("building"):
        folder = Path(name)
        points.tofile(folder / "points")
        program = build(folder)
        found = profile([str(program), str(folder / "points")], folder)
    title = f"{len(points):,} points, {options.distribution}, one thread"
    for name, costs in (("Functions", by_function(found)), ("Sources", by_source(found))):
        console.print(table_of(costs, f"{name}: {title}", len(points), options.top))


def read_options() -> Namespace:
    """Parse the command line."""
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--distribution", choices=DISTRIBUTIONS, default="uniform", metavar="D")
    add("--n", type=int, default=100_000, metavar="ROWS")
    add("--top", type=int, default=15, help="functions, and sources, that are listed")
    return parser.parse_args()


def by_function(found: dict[Place, Cost]) -> dict[str, Cost]:
    """Sum up over functions, each with what is inlined into it: the phases of a run."""
    return summed(found, lambda _, function: plain(function))


def by_source(found: dict[Place, Cost]) -> dict[str, Cost]:
    """Sum up over the kernel's files; everything else is one line."""
    return summed(found, lambda file, _: source_of(file))


def source_of(file: str) -> str:
    path = Path(file)
    return path.relative_to(KERNEL).as_posix() if path.is_relative_to(KERNEL) else LIBRARY


def plain(function: str) -> str:
    """Leave the namespaces, parameters and template arguments out of a C++ name.

    A lambda is named by the function it stands in.
    """
    name = function.replace("(anonymous namespace)::", "").replace("liftmesh::", "")
    name = CLONE.sub("", name)
    task = TASK.search(name)
    if task:
        return f"{task[1]}, lambda {task[2]}"
    while NESTED.search(name):
        name = NESTED.sub("", name)
    return name.split()[-1][:LONGEST]


def summed(found: dict[Place, Cost], key: Callable[[str, str], str]) -> dict[str, Cost]:
    """Add up the costs of all places with one key, the dearest first."""
    sums: dict[str, Cost] = defaultdict(Cost)
    for (file, function), cost in found.items():
        sums[key(file, function)] += cost
    return dict(sorted(sums.items(), key=lambda item: -item[1].instructions))


def table_of(costs: dict[str, Cost], title: str, points: int, rows: int) -> Table:
    """Give the first rows, and the sum over all of them."""
    table = Table(title=title, title_justify="left", show_footer=True)
    total = sum(costs.values(), Cost())
    table.add_column("", "all")
    for heading, cell in zip(HEADINGS, cells(total, total, points), strict=True):
        table.add_column(heading, cell, justify="right")
    for name, cost in list(costs.items())[:rows]:
        table.add_row(escape(name), *cells(cost, total, points))
    return table


def cells(cost: Cost, total: Cost, points: int) -> Iterator[str]:
    yield f"{cost.instructions / points:,.1f}"
    yield f"{cost.instructions / total.instructions:.1%}"
    yield f"{cost.mispredicted / points:,.2f}"


if __name__ == "__main__":
    main()
