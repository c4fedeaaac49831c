"""Time the whole job, from a cloud in a PLY file to a mesh in another, stage by stage.

    python scripts/bench.py pipeline                      a million rows
    python scripts/bench.py pipeline --n 10000000         ten million
    python scripts/bench.py pipeline --n 300000 --peers   compared with SciPy, Open3D and trimesh

The cloud has x, y, z as doubles and 8-bit colours. Every program runs in a fresh process. Memory is
the peak up to the end of a stage: in total, and per row without what the imports take.

Beside liftmesh stands the least that a job could take: the same bytes read and written as they
are, and the kernel on points that are there already. The whole command is timed with the start of
Python.
"""

from __future__ import annotations

import subprocess
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time

import numpy as np
from benchmark.measuring import (
    MILLION,
    console,
    empty_table,
    in_process,
    processor_seconds,
    seconds_of,
)
from process_state import memory
from rich.table import Table

BLOCK = 1 << 16
ROW = np.dtype([("position", "<f8", (3,)), ("color", "u1", (3,))])
HEADER = """ply
format binary_little_endian 1.0
element vertex {}
property double x
property double y
property double z
property uchar red
property uchar green
property uchar blue
end_header
"""


@dataclass(frozen=True)
class Stage:
    """The time and memory of one stage; the first stage imports the libraries."""

    name: str
    seconds: float
    cpu: float  # processors' time in seconds
    held: int
    peak: int


def by_liftmesh(source: str, target: str) -> Iterator[str]:
    liftmesh = import_module("liftmesh")
    read, triangulate = liftmesh.read, liftmesh.triangulate  # resolves the lazy imports
    yield "import"
    cloud = read(source)
    yield "read"
    surface = triangulate(cloud)
    yield "triangulate"
    surface.save(target)
    yield "write"


def at_least(source: str, target: str) -> Iterator[str]:
    """Read and write bytes as they are, those of a mesh that was written before."""
    liftmesh = import_module("liftmesh")
    points = liftmesh.read(source).points[:, :2]
    mesh = Path(target).read_bytes()
    delaunay = liftmesh.delaunay
    yield "import"
    Path(source).read_bytes()
    yield "read"
    triangulation = delaunay(points)
    yield "triangulate"
    del triangulation
    Path(target).write_bytes(mesh)
    yield "write"


def by_open3d(source: str, target: str) -> Iterator[str]:
    o3d, spatial = import_module("open3d"), import_module("scipy.spatial")
    yield "import"
    cloud = o3d.io.read_point_cloud(source)
    yield "read"
    triangles = spatial.Delaunay(np.asarray(cloud.points)[:, :2]).simplices
    yield "triangulate"
    faces = o3d.utility.Vector3iVector(triangles)
    mesh = o3d.geometry.TriangleMesh(cloud.points, faces)
    mesh.vertex_colors = cloud.colors
    o3d.io.write_triangle_mesh(target, mesh)
    yield "write"


def by_trimesh(source: str, target: str) -> Iterator[str]:
    trimesh, spatial = import_module("trimesh"), import_module("scipy.spatial")
    yield "import"
    cloud = trimesh.load(source)
    yield "read"
    triangles = spatial.Delaunay(cloud.vertices[:, :2]).simplices
    yield "triangulate"
    mesh = trimesh.Trimesh(cloud.vertices, triangles, vertex_colors=cloud.colors, process=False)
    mesh.export(target)
    yield "write"


OURS, LEAST = "liftmesh", "bytes and the kernel"
JOBS: dict[str, Callable[[str, str], Iterator[str]]] = {
    OURS: by_liftmesh,
    LEAST: at_least,
    "Open3D, SciPy": by_open3d,
    "trimesh, SciPy": by_trimesh,
}


def run(options: Namespace) -> None:
    """Run the job with each program, and print a table."""
    terminal = console()
    with TemporaryDirectory() as folder:
        source, target = Path(folder, "cloud.ply"), Path(folder, "mesh.ply")
        write_cloud(source, options.n)
        found: dict[str, list[Stage]] = {}
        for name in JOBS if options.peers else (OURS, LEAST):
            found[name] = stages_of(name, source, target)
            terminal.print(table_of(name, found[name], options.n, target.stat().st_size))
        ours, least = (total(found[name][1:]) for name in (OURS, LEAST))
        command = run_command(source, target)
    seconds = (
        f"processors' time {ours.cpu / least.cpu:.2f}, clock {ours.seconds / least.seconds:.2f}"
    )
    terminal.print(f"{OURS} without imports, in times of {LEAST}: {seconds}")
    terminal.print(
        f"the whole command: processors' time {command / least.cpu:.2f} ({command:.2f} s)"
    )


def add_options(parser: ArgumentParser) -> None:
    parser.add_argument("--n", type=int, default=MILLION, metavar="ROWS")
    parser.add_argument(
        "--peers", action="store_true", help="also SciPy with Open3D and with trimesh"
    )


def write_cloud(path: Path, rows: int) -> None:
    """Write points of a hilly terrain, the same in every run."""
    random = np.random.default_rng(20)
    with path.open("wb") as file:
        file.write(HEADER.format(rows).encode())
        for start in range(0, rows, BLOCK):
            block = np.empty(min(BLOCK, rows - start), ROW)
            x, y = 1000 * random.random((2, len(block)))
            z = 20 * np.sin(x / 90) * np.cos(y / 70)
            block["position"] = np.stack([x, y, z], axis=1)
            block["color"] = random.integers(0, 256, (len(block), 3))
            file.write(block.tobytes())


def stages_of(name: str, source: Path, target: Path) -> list[Stage]:
    """Run a job in a fresh process."""
    return [Stage(**stage) for stage in in_process(measured, name, source, target)]


def run_command(source: Path, target: Path) -> float:
    """Run ``liftmesh triangulate``; return its processors' time in seconds."""
    words = ["triangulate", str(source), str(target), "--overwrite"]
    command = [sys.executable, "-m", "liftmesh", *words]
    call = partial(subprocess.run, command, stdout=subprocess.DEVNULL, check=True)
    return seconds_of(call, processor_seconds)


def measured(job: str, source: str, target: str) -> list[Stage]:
    """Run a job in this process; measure time and memory after each stage."""
    found = []
    start, used = perf_counter(), process_time()
    for name in JOBS[job](source, target):
        seconds, cpu = perf_counter() - start, process_time() - used
        found.append(Stage(name, seconds, cpu, memory("VmRSS"), memory("VmHWM")))
        start, used = perf_counter(), process_time()
    return found


def total(stages: list[Stage]) -> Stage:
    """Add up the times of stages; memory is that of the last."""
    seconds, cpu = (sum(getattr(each, name) for each in stages) for name in ("seconds", "cpu"))
    return Stage("whole", seconds, cpu, stages[-1].held, stages[-1].peak)


def table_of(name: str, stages: list[Stage], rows: int, size: int) -> Table:
    """Make the table of one program: a row for each stage, and one for the whole."""
    libraries, *work = stages
    title = f"{name}: {rows:,} rows, a mesh of {size / 1e6:,.0f} MB"
    table = empty_table(title, ["stage"], ("seconds", "processors' s", "peak MB", "bytes a row"))
    for stage in (libraries, *work, total(work)):
        beyond = "" if stage is libraries else f"{(stage.peak - libraries.held) / rows:.0f}"
        times = f"{stage.seconds:.3f}", f"{stage.cpu:.3f}"
        table.add_row(stage.name, *times, f"{stage.peak / 1e6:,.0f}", beyond)
    return table
