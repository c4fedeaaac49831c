"""Triangulate a file in tiles, and compare with one call and with tiles that have buffers.

    python scripts/bench.py tiles                    ten million uniform points
    python scripts/bench.py tiles --n 1000000 --tile-rows 150000 --distributions uniform circle
    python scripts/bench.py tiles --workers 1 2      and on as many workers of Dask
    python scripts/bench.py tiles --formats --verify in each format, and proved
    python scripts/bench.py tiles --all              every table of the page: an hour, 12 GB of disk

Each way reads the same NPY file and writes its triangles with 64-bit rows, in a process of its own:
one call of `delaunay`, `tile`, and `liftmesh.dask.delaunay` on clusters of processes. Shown are the
seconds of all processors and their ratio to one call, the seconds of the clock, the peak memory of
the largest process, which share of the rows leaves the tiles, and comes to the last merge, the
bytes that are handed on for each point, and whether the triangles are those of one call, by a hash
of 192 bits that does not depend on their order. For workers also the seconds of the busiest one:
what the clock would show on an idle machine, but for the start and for waiting.

Tiles with buffers are what PDAL and LAStools make: each tile of a square grid is triangulated with
the points of a margin around it, and keeps the triangles whose centroid it holds. Shown is how many
triangles are missing in the union, and how many it has that are not Delaunay, for margins in times
of the mean distance between points.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from dataclasses import dataclass
from math import isqrt
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any

import numpy as np
from benchmark.contest import SEED
from benchmark.measuring import console, empty_table, in_process, load, processor_seconds
from distributions import Points
from numpy.typing import NDArray
from process_state import memory
from rich.table import Table
from tilings import FAMILIES

import liftmesh

BLOCK = 1 << 20
MARGINS = (2, 5, 10)
COLUMNS = (
    "ratio",
    "processors s",
    "busiest worker s",
    "clock s",
    "peak MB",
    "leave tiles",
    "last merge",
    "bytes a point",
    "triangles",
)
SHOWN = sorted({*FAMILIES} - {"mixed-magnitudes", "tenth-lattice", "parabola", "spiral"})
ALL = (  # the tables of docs/guide/tiles-planning.md, in its order
    "--workers 1 2",
    "--n 100000000 --workers 1 2 --verify",
    f"--n 2000000 --tile-rows 150000 --distributions {' '.join(SHOWN)}",
    "--n 10000000 --distributions circle",
    "--n 5000000 --formats --verify",
    "--n 1000000 --tile-rows 60000 --margins --distributions uniform kuzmin",
)
MIXERS = (1, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB)


@dataclass(frozen=True)
class Taken:
    """What a way takes, what tiles hand on, and the hash of the triangles."""

    processors: float
    clock: float
    memory: int
    busiest: float
    up: int
    root: int
    moved: int
    triangles: int
    mark: str


def run(options: Namespace) -> None:
    for each in (parsed(words.split()) for words in ALL) if options.all else [options]:
        each.folder = options.folder
        compare(each)


def compare(options: Namespace) -> None:
    """Print the tables that some options ask for."""
    terminal = console(130)
    for distribution in options.distributions:
        with TemporaryDirectory(dir=options.folder) as folder:
            points = FAMILIES[distribution](options.n, np.random.default_rng(SEED))
            np.save(Path(folder) / "points.npy", points)
            terminal.print(table_of(distribution, len(points), Path(folder), options))
            if options.margins:
                terminal.print(table_of_margins(points, options.tile_rows))


def parsed(words: list[str]) -> Namespace:
    """Parse the options of one table of tiles-planning.md."""
    parser = ArgumentParser()
    add_options(parser)
    return parser.parse_args(words)


def add_options(parser: ArgumentParser) -> None:
    add = parser.add_argument
    add("--n", type=int, default=10_000_000, metavar="ROWS")
    add("--tile-rows", type=int, default=1_500_000, metavar="ROWS")
    add("--distributions", nargs="+", choices=FAMILIES, default=("uniform",), metavar="D")
    add("--workers", nargs="*", type=int, default=(), metavar="N", help="clusters of processes")
    add("--margins", action="store_true", help="tiles with buffers, too")
    add("--formats", action="store_true", help="Parquet, PLY and neighbours, too")
    add("--verify", action="store_true", help="and the proof")
    add("--all", action="store_true", help="every table of tiles-planning.md")
    add("--folder", metavar="FOLDER", help="where files are written")


def table_of(distribution: str, rows: int, folder: Path, options: Namespace) -> Table:
    """Run all ways on a distribution."""
    table = empty_table(f"{distribution}, {rows:,} rows, {load()}", ["way"], COLUMNS)
    first = None
    for way in ways_of(options):
        found = taken(way, folder, options.tile_rows)
        first = first or found
        equal = "equal" if found.mark == first.mark else "DIFFERENT"
        ratio = f"{found.processors / first.processors:.2f}"
        table.add_row(way, ratio, *cells(found, rows), equal if way != "one call" else "")
    return table


def ways_of(options: Namespace) -> list[str]:
    """List what is compared; the proof is that of the folder before it."""
    ways = ["one call", "tile"]
    ways += ["verify"] * options.verify
    ways += ["tile parquet", "tile ply", "tile neighbors"] * options.formats
    ways += ["verify"] * (options.verify and options.formats)
    return [*ways, *(f"dask {count}" for count in options.workers)]


def cells(found: Taken, rows: int) -> list[str]:
    """Format the figures of a way."""
    return [
        f"{found.processors:.2f}",
        f"{found.busiest:.2f}" if found.busiest else "",
        f"{found.clock:.1f}",
        f"{found.memory / 1e6:.0f}",
        f"{found.up / rows:.2%}",
        f"{found.root / rows:.2%}",
        f"{found.moved / rows:.2f}",
    ]


def taken(way: str, folder: Path, tile_rows: int) -> Taken:
    """Take a way in a fresh process."""
    return Taken(**in_process(take, way, folder, tile_rows))


def take(way: str, place: str, tile_rows: int) -> Taken:
    """Take a way in this process."""
    folder = Path(place)
    source, out = folder / "points.npy", folder / "out"
    begin, before = perf_counter(), processor_seconds()
    peak, busiest = 0, 0.0
    if way == "one call":
        simplices = liftmesh.delaunay(np.load(source), threads=1).simplices.astype(np.int64)
        np.save(folder / "one.npy", simplices)
    elif way == "verify":
        if not liftmesh.open_tiled(out).verify(threads=1).canonical:
            raise SystemExit(f"{out}: not the canonical triangulation")
    elif way.startswith("tile"):
        _, _, what = way.partition(" ")
        written: Any = {"neighbors": True} if what == "neighbors" else {"shards": what or "npy"}
        liftmesh.tile(source, out, tile_rows=tile_rows, threads=1, resume=False, **written)
    else:
        peak, busiest = by_dask(int(way.split()[1]), source, out, tile_rows)
    costs = processor_seconds() - before, perf_counter() - begin, peak or memory("VmHWM"), busiest
    if way == "one call":
        blocks: Any = [turned(simplices, np.load(source))]
        merges = {"rows_up_from_tiles": 0, "rows_at_root": 0, "bytes_up": 0}
    else:
        tiled = liftmesh.open_tiled(out)
        merges, blocks = tiled.manifest["merges"], tiled.iter_blocks()
    marks = [(len(block), mark_of(block)) for block in blocks]
    mark = sum((each for _, each in marks), np.zeros(len(MIXERS), np.uint64))
    handed = (merges[name] for name in ("rows_up_from_tiles", "rows_at_root", "bytes_up"))
    return Taken(
        *costs, *handed, sum(count for count, _ in marks), "".join(f"{m:016x}" for m in mark)
    )


def by_dask(workers: int, source: Path, out: Path, tile_rows: int) -> tuple[int, float]:
    """Triangulate on a cluster; return what a worker took at most: memory, and seconds."""
    import liftmesh.dask  # noqa: PLC0415 - slow to import

    with liftmesh.dask.local_cluster(n_workers=workers) as client:
        client.wait_for_workers(workers)
        before = client.run(process_time)
        options = {"tile_rows": tile_rows, "resume": False}
        liftmesh.dask.delaunay(source, out, client=client, **options)
        after = client.run(process_time)
        busiest = max(after[worker] - before[worker] for worker in before)
        return max(client.run(memory, "VmHWM").values()), busiest


def turned(simplices: NDArray[np.int64], points: Points) -> NDArray[np.int64]:
    """Let triangles begin at their lexicographically least corner."""
    out = np.empty_like(simplices)
    for begin in range(0, len(simplices), BLOCK):
        rows = simplices[begin : begin + BLOCK]
        x, y = points[rows, 0], points[rows, 1]
        least = np.where(x == x.min(axis=1, keepdims=True), y, np.inf).argmin(axis=1)
        turn = (least[:, None] + np.arange(3)) % 3
        out[begin : begin + BLOCK] = np.take_along_axis(rows, turn, axis=1)
    return out


def mark_of(triangles: NDArray[np.int64]) -> NDArray[np.uint64]:
    """Hash triangles to three sums, which do not depend on their order."""
    sums = np.zeros(len(MIXERS), np.uint64)
    for begin in range(0, len(triangles), BLOCK):
        words = np.array(triangles[begin : begin + BLOCK]).view(np.uint64)
        mixed = np.zeros(len(words), np.uint64)
        for column in words.T:
            mixed = (mixed ^ column) * np.uint64(0x9E3779B97F4A7C15)
            mixed ^= mixed >> np.uint64(29)
        for i, factor in enumerate(MIXERS):
            each = mixed * np.uint64(factor)
            each ^= each >> np.uint64(31)
            sums[i : i + 1] += (each * (each | np.uint64(1))).sum(dtype=np.uint64)
    return sums


def table_of_margins(points: Points, tile_rows: int) -> Table:
    """Triangulate with buffers of several widths."""
    columns = ("triangles", "missing", "not Delaunay")
    table = empty_table("tiles with buffers", ["margin"], columns)
    exact = {*map(tuple, turned_rows(points, np.arange(len(points))).tolist())}
    for margin in MARGINS:
        union = with_margin(points, tile_rows, margin)
        row = (len(union), len(exact - union), len(union - exact))
        table.add_row(f"{margin} distances", *(f"{count:,}" for count in row))
    return table


def with_margin(points: Points, tile_rows: int, margin: float) -> set[tuple[int, ...]]:
    """Unite the triangles of the tiles of a grid."""
    low, high = points.min(axis=0), points.max(axis=0)
    side = max(1, isqrt(len(points) // tile_rows))
    step = (high - low) / side
    width = margin * float(np.sqrt(np.prod(high - low) / len(points)))
    found: set[tuple[int, ...]] = set()
    for cell in np.ndindex(side, side):
        begin = low + cell * step
        near = ((points >= begin - width) & (points <= begin + step + width)).all(axis=1)
        rows = np.flatnonzero(near)
        if len(rows) < 3:
            continue
        triangles = turned_rows(points, rows)
        which = np.clip((points[triangles].mean(axis=1) - low) // step, 0, side - 1)
        found |= {*map(tuple, triangles[(which == cell).all(axis=1)].tolist())}
    return found


def turned_rows(points: Points, rows: NDArray[np.intp]) -> NDArray[np.int64]:
    """Triangulate some rows; triangles begin at their least corner."""
    simplices = liftmesh.delaunay(points[rows]).simplices
    return turned(rows[simplices].astype(np.int64), points)
