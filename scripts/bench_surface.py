"""Time what a surface is asked, compared with SciPy, matplotlib and GDAL.

    python scripts/bench_surface.py                       a million rows, points and pixels
    python scripts/bench_surface.py --n 100000 --pixels 16000000 --json found.json
    python scripts/bench_surface.py --tasks contours --threads 2

Heights at unsorted points, rasters and contours of one surface over uniform points, whose heights
are a wave. Every program gets the triangulation ready, but gdal_grid, which reads a file of the
points and writes a raster: it takes part if it is installed. Counted are seconds of the processor,
the best of the rounds, in turn; a first call, which may make an index, comes before. SciPy and
matplotlib take no more than `--most` points and pixels, and seconds are for a million of them.
"""

from __future__ import annotations

import json
import os
import resource
import shutil
import subprocess
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any, TypeAlias

import numpy as np
from benchmark.contest import SEED
from benchmark.peers import OURS
from matplotlib.figure import Figure
from matplotlib.tri import LinearTriInterpolator
from rich.console import Console
from rich.table import Table
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import Delaunay

import liftmesh

Call: TypeAlias = Callable[[], Any]

SIDE = 1000.0
MILLION = 1e6
TASKS = ("heights", "rasters", "contours")
LEVELS = np.linspace(-90, 90, 33)


@dataclass(frozen=True)
class Contestant:
    """A program at a task, and how many points or pixels it is asked; 0 for all at once."""

    task: str
    name: str
    asked: int
    call: Call


@dataclass(frozen=True)
class Result:
    """The best seconds of the processor; for a million points or pixels, or for all at once."""

    task: str
    name: str
    asked: int
    seconds: float

    @property
    def comparable(self) -> float:
        """Seconds for a million."""
        return self.seconds * MILLION / self.asked if self.asked else self.seconds


def main() -> None:
    """Print a table for each task; write all results if asked to."""
    options = read_options()
    rows = terrain(options.n)
    with TemporaryDirectory() as folder:
        results = measured([*contestants(rows, options, Path(folder))], options.rounds)
    console = Console() if os.isatty(1) else Console(width=100)
    for task in options.tasks:
        console.print(table_of(task, results, options))
    if options.json:
        found = [asdict(each) | {"comparable": each.comparable} for each in results]
        values = {"rows": options.n, "threads": options.threads, "results": found}
        options.json.write_text(json.dumps(values, indent=1) + "\n")


def read_options() -> Namespace:
    """Parse the command line."""
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--n", type=int, default=1_000_000, metavar="ROWS")
    add("--points", type=int, default=1_000_000, help="at which heights are asked")
    add("--pixels", type=int, default=1_000_000, help="of rasters")
    add("--most", type=int, default=100_000, help="points and pixels of SciPy and matplotlib")
    add("--threads", type=int, default=1, help="of liftmesh")
    add("--rounds", type=int, default=3)
    add("--tasks", nargs="+", choices=TASKS, default=TASKS)
    add("--json", type=Path, metavar="FILE")
    return parser.parse_args()


def terrain(count: int) -> np.ndarray[Any, Any]:
    """Draw points with the heights of a wave."""
    planar = np.random.default_rng(SEED).uniform(0, SIDE, (count, 2))
    heights = 60 * np.sin(planar[:, 0] / 90) + 40 * np.cos(planar[:, 1] / 55)
    return np.column_stack([planar, heights])


def contestants(
    rows: np.ndarray[Any, Any], options: Namespace, folder: Path
) -> Iterator[Contestant]:
    """List who takes part in the tasks that are asked for."""
    surface = liftmesh.triangulate(rows)
    if "heights" in options.tasks:
        yield from of_heights(surface, options)
    if "rasters" in options.tasks:
        yield from of_rasters(surface, options, folder)
    if "contours" in options.tasks:
        yield from of_contours(surface, options)


def of_heights(surface: liftmesh.Surface, options: Namespace) -> Iterator[Contestant]:
    """Heights at points in the middle of the square."""
    asked = np.random.default_rng(SEED + 1).uniform(0.01 * SIDE, 0.99 * SIDE, (options.points, 2))
    for method in ("linear", "nearest", "laplace", "sibson"):
        yield Contestant(
            "heights",
            f"{OURS}, {method}",
            len(asked),
            lambda method=method: surface.sample(asked, method, threads=options.threads),
        )
    some = asked[: options.most]
    for name, find in interpolators(surface).items():
        yield Contestant("heights", name, len(some), lambda find=find: find(some))


def interpolators(
    surface: liftmesh.Surface,
) -> dict[str, Callable[[np.ndarray[Any, Any]], Any]]:
    """Make the interpolators of other programs."""
    heights = surface.vertices[:, 2]
    scipys = LinearNDInterpolator(Delaunay(surface.triangulation.points), heights)
    theirs = LinearTriInterpolator(surface.to_matplotlib(), heights)
    return {"SciPy, linear": scipys, "matplotlib, linear": lambda asked: theirs(*asked.T)}


def of_rasters(surface: liftmesh.Surface, options: Namespace, folder: Path) -> Iterator[Contestant]:
    """Rasters of the square, of float32."""
    side = max(int(options.pixels**0.5), 1)
    step = SIDE / side
    grid = {"transform": (step, 0, 0, 0, -step, SIDE), "shape": (side, side), "dtype": "float32"}
    yield Contestant(
        "rasters", OURS, side * side, lambda: surface.raster(**grid, threads=options.threads)
    )
    few = max(int(min(options.pixels, options.most) ** 0.5), 1)
    centres = (np.stack(np.meshgrid(*2 * [np.arange(few)]), axis=-1) + 0.5) * (SIDE / few)
    find = interpolators(surface)["matplotlib, linear"]
    yield Contestant("rasters", "matplotlib", few * few, lambda: find(centres.reshape(-1, 2)))
    if program := shutil.which("gdal_grid"):
        np.savetxt(folder / "rows.csv", surface.vertices, "%.17g", ",", header="x,y,z", comments="")
        words = ["-q", "-a", "linear:radius=0", "-zfield", "z", "-ot", "Float32"]
        words += ["-oo", "X_POSSIBLE_NAMES=x", "-oo", "Y_POSSIBLE_NAMES=y"]
        words += ["-txe", "0", str(SIDE), "-tye", "0", str(SIDE), "-outsize", str(side), str(side)]
        command = [program, *words, str(folder / "rows.csv"), str(folder / "out.tif")]
        call = lambda: subprocess.run(command, check=True)  # noqa: E731
        yield Contestant("rasters", "gdal_grid, with its files", side * side, call)


def of_contours(surface: liftmesh.Surface, options: Namespace) -> Iterator[Contestant]:
    """Lines at many levels."""
    yield Contestant("contours", OURS, 0, lambda: surface.contours(LEVELS, threads=options.threads))
    theirs, heights = surface.to_matplotlib(), surface.vertices[:, 2]
    yield Contestant(
        "contours", "matplotlib", 0, lambda: Figure().subplots().tricontour(theirs, heights, LEVELS)
    )


def measured(those: list[Contestant], rounds: int) -> list[Result]:
    """Let all take turns; the first turn does not count."""
    best = [float("inf")] * len(those)
    for turn in range(rounds + 1):
        for number, each in enumerate(those):
            seconds = spent(each.call)
            if turn:
                best[number] = min(best[number], seconds)
    return [Result(x.task, x.name, x.asked, s) for x, s in zip(those, best, strict=True)]


def spent(call: Call) -> float:
    """Count seconds of the processor, of processes that are started too."""
    began = process_time() + of_children()
    call()
    return process_time() + of_children() - began


def of_children() -> float:
    """Seconds of processes that have ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def table_of(task: str, results: list[Result], options: Namespace) -> Table:
    """Make the table of a task, with times of liftmesh's first line."""
    of_task = [each for each in results if each.task == task]
    load = f"load {os.getloadavg()[0]:.1f}"
    unit = "CPU seconds" if task == "contours" else "CPU seconds a million"
    table = Table(title=f"{task}: {options.n:,} rows, {options.threads} threads, {load}")
    for title in ("program", unit, f"times {OURS}"):
        table.add_column(title, justify="left" if title == "program" else "right")
    for each in of_task:
        ratio = each.comparable / max(of_task[0].comparable, 1e-9)
        table.add_row(each.name, f"{each.comparable:.3f}", f"{ratio:.2f}")
    return table


if __name__ == "__main__":
    main()
