"""Time the simplification of rasters, side by side with pydelatin, and compare the triangles.

    python scripts/bench.py simplify                      the example raster and a fractal
    python scripts/bench.py simplify dem.tif --max-errors 0.25 1
    python scripts/bench.py simplify --fractal 2049 --max-errors 5 --rounds 5

Both approximate the same heights within the same distances, in one process and in turns; the least
CPU seconds of the rounds count. "greedy" is the choice of vertices without the last pass, as a part
of pydelatin's time, "all" with it, and "call" the whole of `liftmesh.simplify`, which triangulates
the raster first, and checks every distance at the end. Triangles are parts of pydelatin's number,
which computes in float32 and does not check its bound. liftmesh's triangulation is the canonical
one; the last pass takes vertices out again.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from benchmark.measuring import console, empty_table, load

import liftmesh
from liftmesh import _kernel
from liftmesh._typing import Floats
from liftmesh.terrain.surface_data import positions_of

EXAMPLE = Path(__file__).resolve().parents[3] / "data" / "jacksboro.ply"
SEED = 21
RELIEF = 1000.0  # of the fractal


def run(options: Namespace) -> None:
    """Print a table of all rasters and distances."""
    table = empty_table(f"CPU seconds, {load()}", ["raster"], COLUMNS)
    for name, heights in rasters(options):
        for max_error in options.max_errors:
            table.add_row(name, "x".join(map(str, heights.shape)), f"{max_error:g}", *cells(
                compared(heights, max_error, options.rounds)
            ))  # fmt: skip
    console(120).print(table)


COLUMNS = (
    *("size", "distance", "pydelatin", "s"),
    *("greedy", "all", "call", "triangles greedy", "triangles all"),
)


def add_options(parser: ArgumentParser) -> None:
    add = parser.add_argument
    add("files", nargs="*", type=Path, metavar="RASTER", help="instead of the example")
    add("--fractal", type=int, default=1025, metavar="SIDE", help="0: none")
    add("--max-errors", nargs="+", type=float, default=(2.0, 10.0), metavar="Z")
    add("--rounds", type=int, default=3)


def rasters(options: Namespace) -> Iterator[tuple[str, Floats]]:
    """Yield names and heights."""
    for path in options.files or [EXAMPLE]:
        yield path.stem, raster(liftmesh.read(path).points)
    if options.fractal:
        yield "fractal", fractal(options.fractal)


def raster(points: Floats) -> Floats:
    """Arrange the heights of a full grid by rows and columns."""
    sides = [len(np.unique(points[:, axis])) for axis in (1, 0)]
    if sides[0] * sides[1] != len(points):
        raise SystemExit(f"{len(points)} points are no full raster of {sides[0]} x {sides[1]}")
    return np.ascontiguousarray(points[np.lexsort((points[:, 0], points[:, 1])), 2].reshape(sides))


def fractal(side: int) -> Floats:
    """Make heights whose spectrum falls with the square of the frequency."""
    size = 2 * side
    noise = np.fft.rfft2(np.random.default_rng(SEED).standard_normal((size, size)))
    frequency = np.hypot(np.fft.fftfreq(size)[:, None], np.fft.rfftfreq(size)[None])
    frequency[0, 0] = np.inf
    heights = np.fft.irfft2(noise / frequency**2)[:side, :side]
    return np.ascontiguousarray(RELIEF * (heights - heights.min()) / np.ptp(heights))


def compared(heights: Floats, max_error: float, rounds: int) -> dict[str, tuple[float, int]]:
    """Return the least seconds of each way, and its triangles."""
    ways = ways_to(heights, max_error)
    found: dict[str, tuple[float, int]] = {}
    for _ in range(rounds):
        for name, run in ways.items():
            begin = process_time()
            result = run()
            seconds = min(process_time() - begin, found.get(name, (np.inf, 0))[0])
            found[name] = seconds, result if isinstance(result, int) else triangles(heights, result)
    return found


def points_of(heights: Floats) -> Floats:
    rows, columns = np.indices(heights.shape, dtype=float)
    return np.column_stack([columns.ravel(), rows.ravel(), heights.ravel()])


def triangles(heights: Floats, rows: Any) -> int:
    return len(liftmesh.delaunay(points_of(heights)[rows, :2]).simplices)


def ways_to(heights: Floats, max_error: float) -> dict[str, Callable[[], Any]]:
    """Return what is timed: the rows that stay, or the number of triangles."""
    delatin = import_module("pydelatin").Delatin
    points = points_of(heights)
    used, plane, hull = positions_of(liftmesh.triangulate(points))
    rounded, z = heights.astype(np.float32), np.ascontiguousarray(points[used, 2])

    def choose(prunes: bool) -> Any:
        no_edges = np.empty((0, 2), dtype=np.int32)
        return _kernel.simplify(plane, z, hull, no_edges, max_error, 0, prunes, None)[0]

    return {
        "pydelatin": lambda: len(delatin(rounded, max_error=max_error).triangles),
        "greedy": lambda: choose(False),
        "all": lambda: choose(True),
        "call": lambda: len(liftmesh.simplify(points, max_error=max_error).faces),
    }


def cells(found: dict[str, tuple[float, int]]) -> list[str]:
    """Format a row: pydelatin's triangles and seconds, and the others as parts of these."""
    peer_seconds, peer = found["pydelatin"]
    times = [f"{found[way][0] / peer_seconds:.2f}" for way in ("greedy", "all", "call")]
    counts = [f"{found[way][1] / peer:.3f}" for way in ("greedy", "all")]
    return [f"{peer:,}", f"{peer_seconds:.3f}", *times, *counts]
