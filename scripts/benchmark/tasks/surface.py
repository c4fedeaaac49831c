"""Time what a surface is asked, compared with SciPy, matplotlib, MetPy, CGAL, PDAL and GDAL.

    python scripts/bench.py surface                       a million rows, points and pixels
    python scripts/bench.py surface --tasks rasters --pixels 100000000 --json found.json
    python scripts/bench.py surface --tasks contours --levels 169
    python scripts/bench.py surface --tasks heights --threads 1 2       on an idle machine
    python scripts/bench.py surface --tasks differences --n 500000      of 10^6 faces each

Heights at unsorted points, rasters and contours of one surface over uniform points, whose heights
are a wave. Every program gets the triangulation ready, but gdal_grid, which reads a file of the
points and writes a raster: reading and writing are timed by themselves, and subtracted. CGAL sorts
the points first, as liftmesh does; PDAL's loop is rebuilt (`heights/faceraster.cpp`). Counted are
seconds of the processor, the best of the rounds, in turn; a first call, which may make an index,
comes before. SciPy and matplotlib take no more than `--most` points and pixels, MetPy, which gets
the circles around each point ready too, a hundredth of these, and seconds are for a million.
liftmesh takes its turns with each number of threads: one table says by how much the clock gains,
and the last one has the ratios that are promised of the first number. Differences are those of two
such surfaces with other points; shapely intersects the triangles of `--most` points of both.
Programs that are not installed are left out: apt-get install g++ libcgal-dev gdal-bin.
"""

from __future__ import annotations

import json
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any, TypeAlias

import numpy as np
import shapely
from benchmark import cgal
from benchmark.contest import SEED
from benchmark.measuring import (
    add_common,
    console,
    empty_table,
    load,
    processor_seconds,
    seconds_of,
)
from benchmark.peers import OURS
from heights.peers import CgalHeights, Faceraster, GdalGrid
from matplotlib.figure import Figure
from matplotlib.tri import LinearTriInterpolator
from rich.table import Table
from scipy.interpolate import LinearNDInterpolator
from scipy.spatial import Delaunay

import liftmesh
from liftmesh.terrain.surface_data import kernel_surface

Call: TypeAlias = Callable[[], Any]
Take: TypeAlias = Callable[[], float]

SIDE = 1000.0
MILLION = 1e6
TASKS = ("heights", "rasters", "contours", "differences")
THREADS_GAIN = 1.7  # of heights, by the clock, with two


@dataclass(frozen=True)
class Contestant:
    """A program at a task, and how many points or pixels it is asked; 0 for all at once.

    `take` runs it once, and returns the seconds of the processor that count.
    """

    task: str
    name: str
    asked: int
    take: Take
    threads: int = 1


@dataclass(frozen=True)
class Result:
    """The best seconds of the processor and of the clock."""

    task: str
    name: str
    asked: int
    seconds: float
    clock: float = 0.0
    threads: int = 1

    @property
    def comparable(self) -> float:
        """Seconds of the processor for a million points or pixels, or for all at once."""
        return self.seconds * self._share

    @property
    def comparable_clock(self) -> float:
        """Seconds of the clock, likewise."""
        return self.clock * self._share

    @property
    def _share(self) -> float:
        return MILLION / self.asked if self.asked else 1.0


@dataclass(frozen=True)
class Goal:
    """How many times the seconds of liftmesh another program takes at least.

    From the other program's seconds, those of the ones named in `less` are subtracted.
    """

    task: str
    ours: str
    other: str
    least: float
    less: tuple[str, ...] = ()

    def reached(self, seconds: dict[tuple[str, str], float]) -> float | None:
        """The ratio; None if a program did not take part."""
        names = [(self.task, each) for each in (self.ours, self.other, *self.less)]
        if any(each not in seconds for each in names):
            return None
        own, other, *less = (seconds[each] for each in names)
        return (other - sum(less)) / max(own, 1e-9)


LINEAR, LAPLACE, SIBSON = (f"{OURS}, {method}" for method in ("linear", "laplace", "sibson"))
METPY, _METPY = "MetPy, natural neighbours", "metpy.interpolate"
SCAN, ALL = f"{OURS}, scan alone", f"{OURS}, triangulation too"
GDAL, READING, WRITING = "gdal_grid, with its files", "gdal_grid reads", "GDAL writes"
GOALS = (
    Goal("heights", LINEAR, "SciPy, linear", 100),
    Goal("heights", LINEAR, "matplotlib, linear", 14),
    Goal("heights", LINEAR, "CGAL, linear", 1),
    Goal("heights", LAPLACE, "CGAL, sibson", 1),
    Goal("heights", SIBSON, "CGAL, sibson", 1),
    Goal("heights", SIBSON, METPY, 100),
    Goal("rasters", SCAN, "PDAL's faceraster loop", 3),
    Goal("rasters", ALL, GDAL, 15, (READING, WRITING)),
    Goal("contours", OURS, "matplotlib", 10),
    Goal("differences", OURS, "shapely, areas alone", 10),
)


def run(options: Namespace) -> None:
    """Print a table for each task; write all results if asked to."""
    rows = terrain(options.n)
    with TemporaryDirectory() as folder:
        results = measured([*contestants(rows, options, Path(folder))], options.rounds)
    terminal = console()
    for task in options.tasks:
        terminal.print(table_of(task, results, options))
    if len(options.threads) > 1:
        terminal.print(table_of_threads(results, options))
    terminal.print(table_of_goals(results, options))
    if options.json:
        found = [asdict(each) | {"comparable": each.comparable} for each in results]
        values = {"rows": options.n, "threads": options.threads, "results": found}
        options.json.write_text(json.dumps(values, indent=1) + "\n")


def add_options(parser: ArgumentParser) -> None:
    add = parser.add_argument
    add_common(parser)
    add("--points", type=int, default=1_000_000, help="at which heights are asked")
    add("--pixels", type=int, default=1_000_000, help="of rasters")
    add("--most", type=int, default=100_000, help="points and pixels of SciPy and matplotlib")
    add("--levels", type=int, default=33, help="of contours")
    add("--threads", nargs="+", type=int, default=[1, 2], metavar="K", help="of liftmesh")
    add("--tasks", nargs="+", choices=TASKS, default=TASKS)
    add("--json", type=Path, metavar="FILE")


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
    makers = {
        "heights": of_heights,
        "rasters": of_rasters,
        "contours": of_contours,
        "differences": of_differences,
    }
    for task in options.tasks:
        yield from makers[task](surface, options, folder)


def own(
    task: str, name: str, asked: int, options: Namespace, call: Callable[[int], Any]
) -> Iterator[Contestant]:
    """List liftmesh with each number of threads, which the call is given."""
    for threads in options.threads:
        take = timed(lambda threads=threads: call(threads))
        yield Contestant(task, name, asked, take, threads)


def of_heights(surface: liftmesh.Surface, options: Namespace, folder: Path) -> Iterator[Contestant]:
    """Heights at points in the middle of the square."""
    asked = np.random.default_rng(SEED + 1).uniform(0.01 * SIDE, 0.99 * SIDE, (options.points, 2))
    for method in ("linear", "nearest", "laplace", "sibson"):
        call = lambda threads, method=method: surface.sample(asked, method, threads=threads)  # noqa: E731
        yield from own("heights", f"{OURS}, {method}", len(asked), options, call)
    some = asked[: options.most]
    for name, find in interpolators(surface).items():
        yield Contestant("heights", name, len(some), timed(lambda find=find: find(some)))
    few = asked[: max(options.most // 100, 1)]
    if (call := metpys(surface, few)) is not None:
        yield Contestant("heights", METPY, len(few), timed(call))
    try:
        peer = CgalHeights.built(folder, surface.vertices)
    except cgal.UnavailableError:
        return
    for method in ("linear", "sibson"):
        take = lambda method=method: peer.sample(asked, method)[1]  # noqa: E731
        yield Contestant("heights", f"CGAL, {method}", len(asked), take)


def interpolators(
    surface: liftmesh.Surface,
) -> dict[str, Callable[[np.ndarray[Any, Any]], Any]]:
    """Make the interpolators of other programs."""
    heights = surface.vertices[:, 2]
    scipys = LinearNDInterpolator(Delaunay(surface.triangulation.points), heights)
    theirs = LinearTriInterpolator(surface.to_matplotlib(), heights)
    return {"SciPy, linear": scipys, "matplotlib, linear": lambda asked: theirs(*asked.T)}


def metpys(surface: liftmesh.Surface, asked: np.ndarray[Any, Any]) -> Call | None:
    """Make MetPy's natural neighbours at points, whose circles are known; None without MetPy."""
    try:
        geometry, points = map(import_module, (f"{_METPY}.geometry", f"{_METPY}.points"))
    except ImportError:
        return None
    x, y, z = surface.vertices.T
    solved = Delaunay(surface.triangulation.points)
    members, centers = geometry.find_natural_neighbors(solved, asked)
    return lambda: [
        points.natural_neighbor_point(x, y, z, asked[k], solved, near, centers)
        for k, near in members.items()
    ]


def of_rasters(surface: liftmesh.Surface, options: Namespace, folder: Path) -> Iterator[Contestant]:
    """Rasters of the square, of float32."""
    side = max(int(options.pixels**0.5), 1)
    step, pixels = SIDE / side, side * side
    grid = {"transform": (step, 0, 0, 0, -step, SIDE), "shape": (side, side), "dtype": "float32"}
    rows = surface.vertices
    calls = {
        OURS: lambda threads: surface.raster(**grid, threads=threads),
        SCAN: scan(surface, grid),
        ALL: lambda threads: liftmesh.triangulate(rows, threads=threads).raster(
            **grid, threads=threads
        ),
    }
    for name, call in calls.items():
        yield from own("rasters", name, pixels, options, call)
    few = max(int(min(options.pixels, options.most) ** 0.5), 1)
    centres = (np.stack(np.meshgrid(*2 * [np.arange(few)]), axis=-1) + 0.5) * (SIDE / few)
    find = interpolators(surface)["matplotlib, linear"]
    yield Contestant(
        "rasters", "matplotlib", few * few, timed(lambda: find(centres.reshape(-1, 2)))
    )
    yield from of_other_rasters(surface, side, folder)


def scan(surface: liftmesh.Surface, grid: dict[str, Any]) -> Callable[[int], Any]:
    """The kernel's scan into pixels that are there, without the memory for them."""
    relief, locator = kernel_surface(surface), surface.triangulation._locator  # noqa: SLF001
    pixels = np.zeros((*grid["shape"], 1), grid["dtype"])
    return lambda threads: relief.scan(locator, grid["transform"], 0, pixels, threads, False)


def of_other_rasters(surface: liftmesh.Surface, side: int, folder: Path) -> Iterator[Contestant]:
    """Those of programs that may not be installed."""
    try:
        loop = Faceraster.built(folder, surface)
    except cgal.UnavailableError:
        pass
    else:
        take = lambda: loop.seconds(SIDE, side)  # noqa: E731
        yield Contestant("rasters", "PDAL's faceraster loop", side * side, take)
    if (gdal := GdalGrid.found(folder, surface.vertices)) is not None:
        calls = {
            GDAL: lambda: gdal.make(SIDE, side),
            READING: lambda: gdal.only_read(SIDE),
            WRITING: lambda: gdal.only_write(side),
        }
        for name, call in calls.items():
            yield Contestant("rasters", name, side * side, timed(call))


def of_contours(
    surface: liftmesh.Surface, options: Namespace, _folder: Path
) -> Iterator[Contestant]:
    """Lines at many levels."""
    levels = np.linspace(-90, 90, options.levels)
    call = lambda threads: surface.contours(levels, threads=threads)  # noqa: E731
    yield from own("contours", OURS, 0, options, call)
    theirs, heights = surface.to_matplotlib(), surface.vertices[:, 2]
    other = lambda: Figure().subplots().tricontour(theirs, heights, levels)  # noqa: E731
    yield Contestant("contours", "matplotlib", 0, timed(other))


def of_differences(
    surface: liftmesh.Surface, options: Namespace, _folder: Path
) -> Iterator[Contestant]:
    """The surface less one of as many other points."""
    rows = terrain(options.n)
    rows[:, :2] = rows[:, 1::-1]
    other, count = liftmesh.triangulate(rows), len(rows)
    yield Contestant("differences", OURS, count, timed(lambda: liftmesh.difference(surface, other)))
    near = [liftmesh.triangulate(np.round(each, 2)) for each in (terrain(options.n), rows)]
    decimals = timed(lambda: liftmesh.difference(*near))
    yield Contestant("differences", f"{OURS}, in centimetres", count, decimals)
    alone = timed(lambda: surface.cut_and_fill(other))
    yield Contestant("differences", f"{OURS}, volumes alone", count, alone)
    some = min(options.most, count)
    few = [liftmesh.triangulate(each[:some]) for each in (surface.vertices, rows)]
    triangles = [shapely.polygons(each.vertices[each.faces][..., :2]) for each in few]

    def overlaid() -> Any:
        one, two = shapely.STRtree(triangles[1]).query(triangles[0], predicate="intersects")
        return shapely.area(shapely.intersection(triangles[0][one], triangles[1][two]))

    yield Contestant("differences", "shapely, areas alone", some, timed(overlaid))


def measured(those: list[Contestant], rounds: int) -> list[Result]:
    """Let all take turns; the first turn does not count."""
    best = [(float("inf"), float("inf"))] * len(those)
    for turn in range(rounds + 1):
        for number, each in enumerate(those):
            began = perf_counter()
            seconds = each.take()
            clock = perf_counter() - began
            if turn:
                best[number] = min(best[number][0], seconds), min(best[number][1], clock)
    return [
        Result(x.task, x.name, x.asked, *taken, x.threads)
        for x, taken in zip(those, best, strict=True)
    ]


def timed(call: Call) -> Take:
    """Count the seconds of the processor that a call takes, of processes that it starts too."""
    return lambda: seconds_of(call, processor_seconds)


def table_of(task: str, results: list[Result], options: Namespace) -> Table:
    """Make the table of a task, with times of liftmesh's first line."""
    of_task = [each for each in results if each.task == task]
    unit = "CPU seconds" if task == "contours" else "CPU seconds a million"
    title, numbers = f"{task}: {options.n:,} rows, {load()}", ("threads", unit, f"times {OURS}")
    table = empty_table(title, ["program"], numbers)
    for each in of_task:
        ratio = each.comparable / max(of_task[0].comparable, 1e-9)
        table.add_row(each.name, f"{each.threads}", f"{each.comparable:.3f}", f"{ratio:.2f}")
    return table


def is_ours(result: Result) -> bool:
    """Whether liftmesh made it."""
    return result.name.startswith(OURS)


def table_of_threads(results: list[Result], options: Namespace) -> Table:
    """Make the table of liftmesh's seconds by the clock, and how many times as fast each is."""
    first, *more = options.threads
    title = f"by the clock: {options.n:,} rows, {load()}"
    numbers = [f"threads: {count}" for count in options.threads]
    numbers += [f"gain of {count}" for count in more]
    table = empty_table(title, ("task", "program"), numbers)
    clocks = {(x.task, x.name, x.threads): x.comparable_clock for x in results}
    of_more = [x for x in results if is_ours(x) and x.threads == options.threads[-1]]
    for task, name in dict.fromkeys((x.task, x.name) for x in of_more):
        seconds = [clocks[task, name, count] for count in options.threads]
        gains = [f"{clocks[task, name, first] / max(each, 1e-9):.2f}" for each in seconds[1:]]
        table.add_row(task, name, *(f"{each:.3f}" for each in seconds), *gains)
    if "heights" in options.tasks:
        table.caption = f"promised for two, of heights, on an idle machine: {THREADS_GAIN:g}"
    return table


def table_of_goals(results: list[Result], options: Namespace) -> Table:
    """Make the table of the ratios that are promised, of the tasks that were asked for."""
    counted = [x for x in results if x.threads == options.threads[0] or not is_ours(x)]
    seconds = {(each.task, each.name): each.comparable for each in counted}
    title = f"ratios: {options.n:,} rows, {options.pixels:,} pixels"
    table = empty_table(title, ("task", "program", "times"), ("at least", "found"))
    for each in GOALS:
        if each.task in options.tasks:
            found = each.reached(seconds)
            other = " less ".join(
                [each.other, " and ".join(each.less)] if each.less else [each.other]
            )
            said = "not here" if found is None else f"{found:.2f}"
            table.add_row(each.task, other, each.ours, f"{each.least:g}", said)
    return table
