"""Time alpha surfaces beside Open3D and shull, and triangles on the sphere beside SciPy.

    python scripts/bench.py shapes                       a million rows, some minutes
    python scripts/bench.py shapes --n 100000 --tables alpha --python OTHER/bin/python

Programs run in processes of their own, in turn, on one thread where they can be told; shown is the
least of the rounds, in seconds of the processor. A dash stands for what is missing, fails or takes
more than `--limit` seconds. Alpha surfaces are those of tetrahedra whose spheres have a radius of
twice the mean distance of rows; tests compare their faces. On the sphere, "lost" is the number of
rows that Qhull's hull leaves out, each of which is a vertex.

Needs Open3D and SciPy; shull: pip install -e '.[bench]'.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from benchmark.contestants import KEEP_MEMORY
from benchmark.measuring import add_common
from distributions import Points

SEED = 38
START = """
import json, sys, time, numpy as np
points = np.fromfile(sys.argv[1]).reshape(-1, 3)
alpha = 2 * len(points) ** (-1 / 3)
taken, found = {}, 0
def timed(name, call):
    start = time.process_time()
    result = call()
    taken[name] = time.process_time() - start
    return result
"""
END = "\nprint(json.dumps([taken, int(found)]))\n"
ALPHA = {
    "liftmesh": """
import liftmesh
liftmesh.alpha_shape(points[:5])
made = timed("whole", lambda: liftmesh.tetrahedralize(points, threads=1))
found = len(timed("surface", lambda: made.alpha_shape(alpha)).faces)
""",
    "Open3D": """
import open3d as o3d
cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
make = o3d.geometry.TriangleMesh.create_from_point_cloud_alpha_shape
found = len(timed("surface", lambda: make(cloud, alpha)).triangles)
""",
    "shull": """
import shull
made = timed("whole", lambda: shull.Delaunay3d(points))
found = len(timed("surface", lambda: made.alpha_shape(alpha)))
""",
}
SPHERE = {
    "liftmesh": """
import liftmesh
liftmesh.spherical_delaunay(points[:5]).verify()
made = timed("triangles", lambda: liftmesh.spherical_delaunay(points))
timed("cells", lambda: (made.centers, made.cells))
timed("areas", lambda: made.areas)
found = len(made.simplices) * timed("verify", lambda: made.verify(threads=1)).canonical
""",
    "ConvexHull": """
from scipy.spatial import ConvexHull
found = len(points) - len(timed("triangles", lambda: ConvexHull(points)).vertices)
""",
    "SphericalVoronoi": """
from scipy.spatial import SphericalVoronoi
made = timed("triangles", lambda: SphericalVoronoi(points, threshold=1e-12))
timed("cells", made.sort_vertices_of_regions)
timed("areas", made.calculate_areas)
""",
}


def add_options(parser: ArgumentParser) -> None:
    add = parser.add_argument
    add_common(parser)
    tables = ("alpha", *FAMILIES)
    add("--tables", nargs="+", choices=tables, default=tables, metavar="NAME")
    add("--peers", nargs="*", default=[*ALPHA, *SPHERE], metavar="NAME")
    add("--limit", type=float, default=600, metavar="SECONDS", help="of each run")
    add("--python", default=sys.executable, help="of an environment that has shull")


def run(options: Namespace) -> None:
    """Print the tables."""
    rng = np.random.default_rng(SEED)
    if "alpha" in options.tables:
        said = times(ALPHA, rng.random((options.n, 3)), options)
        print(f"alpha surfaces of {options.n:,} rows\n| program | tetrahedra | surface | faces |")
        print("| --- | ---: | ---: | ---: |")
        for name, (taken, count) in said.items():
            cells = [*map(shown, (taken.get("whole"), taken.get("surface"))), f"{count or '-'}"]
            print(f"| {name} | {' | '.join(cells)} |")
    for name in [each for each in FAMILIES if each in options.tables]:
        points = FAMILIES[name](options.n, rng)
        said = times(SPHERE, points, options)
        print(f"\nsphere, {name}, {len(points):,} rows")
        print("| program | triangles | cells | areas | verify | lost |")
        print("| --- | ---: | ---: | ---: | ---: | ---: |")
        for program, (taken, count) in said.items():
            cells = [shown(taken.get(key)) for key in ("triangles", "cells", "areas", "verify")]
            lost = f"{count:,}" if program == "ConvexHull" and taken else "-"
            print(f"| {program} | {' | '.join(cells)} | {lost} |", flush=True)


def scattered(n: int, rng: np.random.Generator) -> Points:
    """Rows all over the sphere."""
    points = rng.normal(size=(n, 3))
    return points / np.linalg.norm(points, axis=1)[:, None]


def gridded(n: int, _: np.random.Generator) -> Points:
    """A grid of longitudes and latitudes, whose rows are on circles."""
    lines = max(4, round((n / 2) ** 0.5))
    lat = (np.arange(lines) + 0.5) * np.pi / lines - np.pi / 2
    lon, lat = np.meshgrid(np.arange(2 * lines) * np.pi / lines, lat)
    return np.stack(
        [np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)], axis=-1
    ).reshape(-1, 3)


def gathered(n: int, rng: np.random.Generator) -> Points:
    """Groups of rows 10^-8 apart, between which the sphere bends less than unit vectors err."""
    points = scattered(max(n // 20, 4), rng).repeat(20, axis=0)
    points += rng.normal(size=points.shape) * 1e-8
    return points / np.linalg.norm(points, axis=1)[:, None]


FAMILIES = {"scattered": scattered, "grid": gridded, "groups": gathered}


def times(
    programs: dict[str, str], points: Points, options: Namespace
) -> dict[str, tuple[dict[str, float], int]]:
    """Let programs take turns; return the least seconds of each stage, and what each counts."""
    chosen = {name: text for name, text in programs.items() if name in options.peers}
    best: dict[str, tuple[dict[str, float], int]] = {name: ({}, 0) for name in chosen}
    with TemporaryDirectory() as folder:
        file = Path(folder, "points")
        points.tofile(file)
        for _ in range(options.rounds):
            for name, text in chosen.items():
                taken, count = once(name, START + text + END, file, options)
                least, _ = best[name]
                best[name] = {k: min(v, least.get(k, v)) for k, v in taken.items()}, count
    return best


def once(name: str, text: str, file: Path, options: Namespace) -> tuple[dict[str, float], int]:
    """Run a program; nothing is taken by one that is missing, fails or takes too long."""
    python = options.python if name.startswith(("shull", "libpysal")) else sys.executable
    environment = os.environ | {"GLIBC_TUNABLES": KEEP_MEMORY, "OMP_NUM_THREADS": "1"}
    try:
        done = subprocess.run(
            [python, "-c", text, str(file)],
            capture_output=True,
            check=True,
            timeout=options.limit,
            env=environment,
        )
    except (subprocess.TimeoutExpired, subprocess.CalledProcessError):
        return {}, 0
    taken, count = json.loads(done.stdout.splitlines()[-1])
    return taken, count


def shown(number: float | None) -> str:
    """Write a number with three digits; a dash for what is missing."""
    return f"{number:#.3g}".rstrip(".") if number else "-"
