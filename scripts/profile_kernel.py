"""Profile the kernel: instructions and mispredicted branches per point, by function and source.

    python scripts/profile_kernel.py                        100,000 uniform points, one thread
    python scripts/profile_kernel.py --distribution lattice --n 20000
    python scripts/profile_kernel.py --stages               which stages many threads can share
    python scripts/profile_kernel.py --stages --distribution uniform circle half-duplicates

A small driver, built with the kernel's sources, runs under valgrind's callgrind. It counts
instructions exactly and simulates a simple branch predictor, so mispredictions compare with each
other but not with a processor's. Inlined code counts towards the function that it is inlined into,
and towards the source file that it was written in.

With `--stages`, each task of a run with 1, 2 and 16 threads is counted (a million points, unless
`--n` says otherwise), and how long the stages are on so many threads follows by the model of
`benchmark/stages/table.py`. With several distributions, these tables are followed by one that
compares them on 16 threads.
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
from benchmark.profile.callgrind import Cost, Place, profile
from benchmark.stages.counting import steps_of
from benchmark.stages.table import MANY, Stage, comparison, stages, table, verdict
from distributions import DISTRIBUTIONS, Distribution, Points
from native.build import KERNEL, NATIVE, Program, built
from rich.console import Console
from rich.markup import escape
from rich.table import Table

SEED = 20
LONGEST = 60
CLONE = re.compile(r" \[clone [^]]*\]")
TASK = re.compile(r"([\w:]+)\([^()]*\)(?: const)?::\{lambda\([^()]*\)#(\d+)\}")
NESTED = re.compile(r"<[^<>]*>|\([^()]*\)(?: const)?")
LIBRARY = "libraries"
PROGRAM = Program(
    "profile",
    Path(__file__).parent / "benchmark" / "profile",
    ("-O3", "-g"),
    compiler=NATIVE,
    remedy="install g++, or name a compiler in CXX",
)
HEADINGS = ("instructions\na point", "share", "mispredicted\na point")


def half_duplicates(n: int, rng: np.random.Generator) -> Points:
    """Generate uniform points of which half are repeated once, in random order."""
    points = DISTRIBUTIONS["uniform"](n - n // 2, rng)
    return rng.permutation(np.concatenate([points, points[: n // 2]]))


INPUTS: dict[str, Distribution] = {**DISTRIBUTIONS, "half-duplicates": half_duplicates}


def main() -> None:
    """Count what runs of the kernel take, and print tables."""
    options = read_options()
    rows = options.n or (1_000_000 if options.stages else 100_000)
    points = {
        name: INPUTS[name](rows, np.random.default_rng(SEED)) for name in options.distribution
    }
    if options.stages:
        print_stages(points)
        return
    console = Console() if os.isatty(1) else Console(width=120)
    for name, some in points.items():
        print_profile(name, some, console, options.top)


def print_profile(kind: str, points: Points, console: Console, top: int) -> None:
    """Print what one run takes, by function and by source."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        points.tofile(folder / "points")
        with console.status("building"):
            program = built(PROGRAM)
        found = profile([str(program), str(folder / "points"), "1"], folder)
    title = f"{len(points):,} points, {kind}, one thread"
    for name, costs in (("Functions", by_function(found)), ("Sources", by_source(found))):
        console.print(table_of(costs, f"{name}: {title}", len(points), top))


def print_stages(points: dict[str, Points]) -> None:
    """Print the stages as Markdown: millions of instructions, one after the other."""
    found = {name: stages_of(some) for name, some in points.items()}
    for name, runs in found.items():
        print(f"**{name}**", "\n".join(table(runs)), verdict(runs[MANY]), sep="\n\n", end="\n\n")
    if len(found) > 1:
        print("\n".join(comparison({name: runs[MANY] for name, runs in found.items()})))


def stages_of(points: Points) -> dict[int, list[Stage]]:
    """Count the stages of runs with few and with many threads."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        points.tofile(folder / "points")
        return {n: stages(steps_of(folder / "points", n, folder), n) for n in (1, 2, MANY)}


def read_options() -> Namespace:
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--distribution", choices=INPUTS, nargs="+", default=["uniform"], metavar="D")
    add("--n", type=int, metavar="ROWS")
    add("--stages", action="store_true", help="the stages of a run on many threads")
    add("--top", type=int, default=15, help="number of functions and of sources to list")
    return parser.parse_args()


def by_function(found: dict[Place, Cost]) -> dict[str, Cost]:
    """Sum up costs by function, each with the code inlined into it."""
    return summed(found, lambda _, function: plain(function))


def by_source(found: dict[Place, Cost]) -> dict[str, Cost]:
    """Sum up costs by source file of the kernel; all other code is one entry."""
    return summed(found, lambda file, _: source_of(file))


def source_of(file: str) -> str:
    path = Path(file)
    return path.relative_to(KERNEL).as_posix() if path.is_relative_to(KERNEL) else LIBRARY


def plain(function: str) -> str:
    """Remove namespaces, parameters and template arguments from a C++ name.

    A lambda is named after its enclosing function.
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
    """Sum up the costs of all places with the same key, the most expensive first."""
    sums: dict[str, Cost] = defaultdict(Cost)
    for (file, function), cost in found.items():
        sums[key(file, function)] += cost
    return dict(sorted(sums.items(), key=lambda item: -item[1].instructions))


def table_of(costs: dict[str, Cost], title: str, points: int, rows: int) -> Table:
    """Make a table of the first rows, with the sum over all rows."""
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
