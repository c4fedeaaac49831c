"""Time reading and writing numbers as text, compared with polars.

    python scripts/bench.py text                 a million rows of three columns
    python scripts/bench.py text --n 10000000    ten million
    python scripts/bench.py text --alone         without polars

CSV and XYZ hold x, y, z in 17 digits; OBJ and ASCII PLY the mesh on them, with two faces a row.
Each call runs in processes of its own, on the default number of threads, and its best time counts;
beside it stands the best of the processors' time, which other programs change less. The last two
columns are both times for a byte, as multiples of polars' `read_csv` or `write_csv`: 1.5 is the
target. What is read is compared with what was written, bit for bit.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any

import numpy as np
from benchmark.measuring import add_common, console, empty_table, in_process
from benchmark.tasks.pipeline import BLOCK
from rich.table import Table

FILES = {"CSV": "points.csv", "XYZ": "points.xyz", "OBJ": "mesh.obj", "PLY": "mesh.ply"}
POLARS = {"read": "polars read_csv", "write": "polars write_csv"}
CALLS = [f"{verb} {kind}" for verb in ("read", "write") for kind in FILES]
IN_A_PROCESS = 3  # calls, of which the best counts


def run(options: Namespace) -> None:
    calls = [*([] if options.alone else POLARS.values()), *CALLS]
    with TemporaryDirectory() as name:
        folder = Path(name)
        prepare(folder, options.n)
        rounds = [
            {call: in_process(job, call, folder) for call in calls} for _ in range(options.rounds)
        ]
        best = {call: best_of([times[call] for times in rounds]) for call in calls}
        sizes = {kind: (folder / file).stat().st_size for kind, file in FILES.items()}
    console().print(table_of(best, sizes, options.n))


def add_options(parser: ArgumentParser) -> None:
    add_common(parser, rounds=5)
    parser.add_argument("--alone", action="store_true", help="without polars")


def prepare(folder: Path, rows: int) -> None:
    """Write a hilly terrain, the same in every run, in all formats."""
    liftmesh = import_module("liftmesh")
    random = np.random.default_rng(20)
    points = np.empty((rows, 3))
    for start in range(0, rows, BLOCK):
        block = points[start : start + BLOCK]
        block[:, :2] = 1000 * random.random((len(block), 2))
        block[:, 2] = 20 * np.sin(block[:, 0] / 90) * np.cos(block[:, 1] / 70)
    np.save(folder / "points.npy", points)
    faces = liftmesh.delaunay(points[:, :2]).simplices
    np.save(folder / "faces.npy", faces)
    for kind, file in FILES.items():
        liftmesh.write(folder / file, liftmesh.Cloud(points, faces=faces), **options_of(kind))


def options_of(kind: str) -> dict[str, Any]:
    """Return the options for writing a format as text."""
    return {"encoding": "ascii"} if kind == "PLY" else {}


Times = Sequence[float]  # of the clock, and of the processors


def best_of(times: Sequence[Times]) -> Times:
    """Return the least of both."""
    return [min(each) for each in zip(*times, strict=True)]


def job(call: str, folder: str) -> Times:
    """Prepare a call, and return the best of its times; compare what it read."""
    make = by_polars if call in POLARS.values() else by_liftmesh
    work, points_of = make(call, Path(folder))
    times: list[Times] = []
    for _ in range(IN_A_PROCESS):
        start, worked = perf_counter(), process_time()
        found = work()
        times.append((perf_counter() - start, process_time() - worked))
    if points_of(found).tobytes() != np.load(Path(folder, "points.npy")).tobytes():
        raise SystemExit(f"{call}: other values")
    return best_of(times)


Job = tuple[Callable[[], Any], Callable[[Any], Any]]


def by_liftmesh(call: str, folder: Path) -> Job:
    """Make a call of liftmesh, and what gives the points that it read or wrote."""
    liftmesh = import_module("liftmesh")
    verb, kind = call.split()
    source, target = folder / FILES[kind], folder / f"new-{FILES[kind]}"
    if verb == "read":
        return lambda: liftmesh.read(source), lambda cloud: cloud.points
    points, faces = np.load(folder / "points.npy"), np.load(folder / "faces.npy")
    cloud = liftmesh.Cloud(points, faces=faces)
    options = options_of(kind)
    return (
        lambda: liftmesh.write(target, cloud, **options),
        lambda _: liftmesh.read(target).points,
    )


def by_polars(call: str, folder: Path) -> Job:
    """Make a call of polars, and what gives the points that it read or wrote."""
    polars = import_module("polars")
    source, target = folder / FILES["CSV"], folder / "polars.csv"
    if call == POLARS["read"]:
        return lambda: polars.read_csv(source), lambda frame: np.ascontiguousarray(frame.to_numpy())
    frame = polars.DataFrame(dict(zip("xyz", np.load(folder / "points.npy").T, strict=True)))
    return (
        lambda: frame.write_csv(target),
        lambda _: np.ascontiguousarray(polars.read_csv(target).to_numpy()),
    )


def table_of(best: dict[str, Times], sizes: dict[str, int], rows: int) -> Table:
    """Make the table: a row for each call."""
    columns = ("MB", "seconds", "processors'", "MB/s", "for a byte", "processors'")
    table = empty_table(f"{rows:,} rows", ["call"], columns)
    for call, times in best.items():
        verb, kind = ("", "CSV") if call in POLARS.values() else call.split()
        size = sizes[kind]
        peer = best.get(POLARS.get(verb, ""))
        scale = sizes["CSV"] / size
        ratios = [f"{mine * scale / its:.2f}" for mine, its in zip(times, peer or (), strict=False)]
        shown = f"{size / 1e6:.1f}", *(f"{each:.3f}" for each in times)
        table.add_row(call, *shown, f"{size / 1e6 / times[0]:.0f}", *ratios)
    return table
