"""Time the way from a LAZ file to the mesh of its ground, beside the decoding alone.

    python scripts/bench.py lidar                 a million points
    python scripts/bench.py lidar --n 10000000    ten million

The file is made: point format 6, seven of ten points are ground. Every run is a process of its own
on two threads. "decode" is lazrs, which decompresses all points on these threads and keeps nothing.
"own" is what liftmesh does besides: selection, surface, and the PLY file. Both are done twice in
memory that the process keeps, and the second time counts: a virtual machine that returns free
memory to its host takes longer to find the pages of the first than either takes to work. "first" is
the first time of the own steps. Memory is measured in another process, which keeps none: the growth
of the peak since the imports, and what the arrays of cloud and surface hold.
"""

from __future__ import annotations

import json
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any

import laspy
import numpy as np
from benchmark.contestants import KEEP_MEMORY
from benchmark.measuring import add_common, in_process
from process_state import memory

import liftmesh
from liftmesh.io.formats.las.reader import Points

THREADS = "2"
GROUND = 0.7
_PART = 1 << 20  # points made at a time


def make(path: Path, n: int) -> None:
    """Write a LAZ file of n points."""
    rng = np.random.default_rng(1)
    header = laspy.LasHeader(point_format=6, version="1.4")
    header.scales, header.offsets = np.full(3, 0.001), np.array([500000.0, 5400000.0, 0.0])
    side = float(np.sqrt(n))
    with laspy.open(path, "w", header=header) as file:
        for first in range(0, n, _PART):
            count = min(_PART, n - first)
            points = laspy.ScaleAwarePointRecord.zeros(count, header=header)
            x, y = rng.random((2, count)) * [[side], [side * min(_PART, n) / n]]
            points.x, points.y = 500000 + x, 5400000 + y + side * first / n
            is_ground = rng.random(count) < GROUND
            points.z = 5 * np.sin(x / 50) + np.where(is_ground, 0, 10 * rng.random(count))
            points.classification = np.where(is_ground, 2, 5)
            points.intensity = rng.integers(0, 60_000, count)
            points.return_number = points.number_of_returns = np.ones(count, np.uint8)
            points.gps_time = 1e5 + np.arange(first, first + count) * 1e-5
            file.write_points(points)


def decode(path: str) -> dict[str, float]:
    """Decompress all points as laspy does, and keep none."""
    began, cpu = perf_counter(), process_time()
    with laspy.open(path, laz_backend=laspy.LazBackend.LazrsParallel) as file:
        for _ in file.chunk_iterator(1 << 18):
            pass
    return {"seconds": perf_counter() - began, "cpu": process_time() - cpu}


def mesh(path: str) -> dict[str, float]:
    """Read the ground, triangulate it, and write PLY: seconds of each step."""
    blocks, decoding = Points.blocks, [0.0]

    def timed(self: Any, *rest: Any) -> Iterator[Any]:
        pieces = blocks(self, *rest)
        while True:
            began = perf_counter()
            block = next(pieces, None)
            decoding[0] += perf_counter() - began
            if block is None:
                return
            yield block

    Points.blocks = timed  # type: ignore[method-assign]
    try:
        moments, cpu, _ = _steps(path)
    finally:
        Points.blocks = blocks  # type: ignore[method-assign]
    began, read, made, end = moments
    return {
        "decode": decoding[0], "selection": read - began - decoding[0], "triangulate": made - read,
        "write": end - made, "own": end - began - decoding[0], "cpu": cpu,
    }  # fmt: skip


def _steps(path: str) -> tuple[list[float], float, liftmesh.Surface]:
    """Do what is measured; return when each step began or ended, processors' time, and the mesh."""
    cpu, moments = process_time(), [perf_counter()]
    cloud = liftmesh.read(path, classes=2)
    moments.append(perf_counter())
    surface = liftmesh.triangulate(cloud)
    moments.append(perf_counter())
    surface.save(f"{path}.ply")
    return [*moments, perf_counter()], process_time() - cpu, surface


def used(path: str) -> dict[str, float]:
    """Return the bytes that the steps take at most, and those of the arrays that they end with."""
    held = memory("VmRSS")
    surface = _steps(path)[2]
    peak = memory("VmHWM")
    arrays = [surface.vertices, *surface.attributes.values(), surface.triangulation.simplices]
    arrays.append(surface.triangulation.neighbors)
    size = sum(each.nbytes for each in arrays)
    return {"rows": len(surface.vertices), "peak": peak - held, "arrays": size}


JOBS = {"decode": decode, "mesh": mesh, "memory": used}


def run_twice(job: str, path: str) -> dict[str, float]:
    """Do a job; one that is timed, twice."""
    liftmesh.triangulate(np.eye(3))
    if job == "memory":
        return used(path)
    first = JOBS[job](path)
    found = JOBS[job](path)
    return {**found, "first": first["own"]} if job == "mesh" else found


def measured(job: str, path: Path) -> Any:
    """Run a job in a process of its own."""
    environment = {"RAYON_NUM_THREADS": THREADS, "LIFTMESH_NUM_THREADS": THREADS}
    if job != "memory":
        environment["GLIBC_TUNABLES"] = KEEP_MEMORY
    return in_process(run_twice, job, path, environment=environment)


def add_options(parser: ArgumentParser) -> None:
    add_common(parser)
    parser.add_argument("--json", type=Path, help="write the figures to a file")


def run(options: Namespace) -> None:
    """Run all jobs in turn, and print the medians."""
    with TemporaryDirectory() as folder:
        path = Path(folder, "made.laz")
        make(path, options.n)
        runs = [{job: measured(job, path) for job in JOBS} for _ in range(options.rounds)]
    found = {
        job: {key: median(run[job][key] for run in runs) for key in runs[0][job]} for job in JOBS
    }
    if options.json:
        options.json.write_text(json.dumps({"n": options.n, **found}, indent=2))
    for job, values in found.items():
        print(job, "  ".join(f"{key} {value:,.3f}" for key, value in values.items()))
    ratio = found["mesh"]["own"] / found["decode"]["seconds"]
    cpu = found["mesh"]["cpu"] / found["decode"]["cpu"] - 1
    print(f"own steps / decoding: {ratio:.2f}, of processors' time {cpu:.2f}")
    print(f"peak / arrays: {found['memory']['peak'] / found['memory']['arrays']:.2f}")
