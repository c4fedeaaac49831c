"""Time binary STL, compared with trimesh.

    python scripts/bench.py stl                  two million triangles
    python scripts/bench.py stl --n 20000        twenty thousand

Both programs read and write the same terrain, in turn, in one process on one thread. Seconds are
those of the processor, so that other programs on the machine matter little, and the best counts.
liftmesh merges equal corners, which STL repeats; trimesh is told not to. So the target of reading
is 1.1 times trimesh and the merging, which is timed by itself; that of writing is trimesh.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import trimesh
from benchmark.measuring import add_common, best_in_turn, console, empty_table, load
from rich.table import Table

import liftmesh
from liftmesh.io.formats.stl import weld


def run(options: Namespace) -> None:
    cloud = terrain(options.n)
    with TemporaryDirectory() as folder:
        best = best_in_turn(calls(cloud, Path(folder)), options.rounds)
    console().print(table_of(best, len(cloud.faces)))


def add_options(parser: ArgumentParser) -> None:
    """Add the options; `--n` counts triangles."""
    add_common(parser, n=2_000_000, rounds=6)


def terrain(triangles: int) -> liftmesh.Cloud:
    """Triangulate a hilly terrain of about as many triangles, in single precision."""
    xy = np.random.default_rng(20).random((max(triangles // 2, 4), 2))
    points = np.column_stack([1000 * xy, np.sin(9 * xy[:, 0]) * np.cos(7 * xy[:, 1])])
    points = points.astype(np.float32).astype(np.float64)
    return liftmesh.Cloud(points, faces=liftmesh.delaunay(points[:, :2]).simplices)


def calls(cloud: liftmesh.Cloud, folder: Path) -> dict[str, Callable[[], object]]:
    """Make what is timed."""
    source, ours, theirs = (folder / f"{name}.stl" for name in ("source", "ours", "theirs"))
    liftmesh.write(source, cloud)
    corners = np.asarray(cloud.points[cloud.faces]).reshape(-1, 3)

    def exported() -> object:  # a new mesh: trimesh keeps the normals of one that was written
        return trimesh.Trimesh(cloud.points, cloud.faces, process=False).export(theirs)

    return {
        "read trimesh": lambda: trimesh.load(source, process=False),
        "merge corners": lambda: weld(corners),
        "read liftmesh": lambda: liftmesh.read(source),
        "write trimesh": exported,
        "write liftmesh": lambda: liftmesh.write(ours, cloud),
    }


def table_of(best: dict[str, float], triangles: int) -> Table:
    """Make the table: a row for each call, with the share of its target."""
    targets = {
        "read liftmesh": 1.1 * best["read trimesh"] + best["merge corners"],
        "write liftmesh": best["write trimesh"],
    }
    title = f"{triangles:,} triangles as binary STL, {load()}"
    table = empty_table(title, ["call"], ["CPU seconds", "of its target"])
    for name, seconds in best.items():
        share = f"{seconds / targets[name]:.2f}" if name in targets else ""
        table.add_row(name, f"{seconds:.3f}", share)
    return table
