"""Time the functions of plugins beside those of the libraries that they are for.

    python scripts/bench.py plugins                        10^4 to 10^6 points: half an hour
    python scripts/bench.py plugins --n 10000 --works shapely matplotlib
    python scripts/bench.py plugins --limit 100 --python OTHER/bin/python

Shown are seconds of the processor, on one thread where libraries can be told: the least of the
rounds, each in a process of its own, in which both take turns. A first call does not count, unless
it takes long. What is made before (points as the
library's own objects) does not count, what comes out (meshes, geometries, finders) does. A dash
stands for a call that fails, whose error is shown, > for one that takes longer than `--limit`; on
larger sizes it is not asked again. Polygons have a ring of as many corners: on a circle, or a coast
with bays of all sizes; with liftmesh every triangle is constrained Delaunay.

Needs the libraries: pip install -e '.[bench]'.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from argparse import ArgumentParser, Namespace
from dataclasses import dataclass

from benchmark.contestants import KEEP_MEMORY
from benchmark.measuring import load

START = """
import json, sys, time, numpy as np
n = int(sys.argv[1])
rng = np.random.default_rng(39)
points = rng.random((n, 2)) * 1000
turn = np.linspace(0, 2 * np.pi, n, endpoint=False)
def ring(radius):
    return np.column_stack([radius * np.cos(turn), radius * np.sin(turn)])
def coast():
    radius = np.full(n, 1000.0)
    for size in 2 ** np.arange(2, 17):
        bays = rng.normal(size=size)
        radius += 300 / size**0.8 * np.interp(turn, np.arange(size) * 2 * np.pi / size, bays)
    return ring(radius)
"""
END = """
start = time.process_time()
made = call()
taken = time.process_time() - start
if taken < 5:  # once more where memory is there, and so often that clocks tell the time
    calls, start = 0, time.process_time()
    while not calls or time.process_time() - start < 0.3:
        made = call()
        calls += 1
    taken = (time.process_time() - start) / calls
print(json.dumps([taken, int(count(made))]))
"""


@dataclass(frozen=True)
class Work:
    """What both do: code before, the call of each, and how the results are counted."""

    before: str
    ours: str
    theirs: str
    count: str


_PYVISTA = """
import pyvista, liftmesh.plugins.pyvista
dataset = pyvista.PolyData(np.column_stack([points, np.zeros(n)]))
dataset.liftmesh
"""
_SHAPELY = """
import shapely
from liftmesh.plugins import shapely as ours
given = shapely.MultiPoint(points)
"""
_MATPLOTLIB = """
import matplotlib.tri as host
from liftmesh.plugins.matplotlib import Triangulation
x, y = points.T
"""
_POLYGON = """
import liftmesh, mapbox_earcut, shapely
corners = {corners}
polygon, ends = shapely.Polygon(corners), np.array([n], dtype=np.uint32)
liftmesh.triangulate_polygon(polygon.envelope)
"""
_GEOMETRIES = "shapely.get_num_geometries(made)"
_EARCUT = "mapbox_earcut.triangulate_float64(corners, ends).reshape(-1, 3)"
_OURS = "liftmesh.triangulate_polygon(polygon)[1]"
WORKS = {
    "pyvista": Work(
        _PYVISTA, "dataset.liftmesh.delaunay_2d()", "dataset.delaunay_2d()", "made.n_cells"
    ),
    "shapely": Work(
        _SHAPELY, "ours.delaunay_triangles(given)", "shapely.delaunay_triangles(given)", _GEOMETRIES
    ),
    "voronoi": Work(
        _SHAPELY, "ours.voronoi_polygons(given)", "shapely.voronoi_polygons(given)", _GEOMETRIES
    ),
    "matplotlib": Work(
        _MATPLOTLIB,
        "(made := Triangulation(x, y), made.get_trifinder())",
        "(made := host.Triangulation(x, y), made.get_trifinder())",
        "len(made[0].triangles)",
    ),
    "circle": Work(_POLYGON.format(corners="ring(1000)"), _OURS, _EARCUT, "len(made)"),
    "coast": Work(_POLYGON.format(corners="coast()"), _OURS, _EARCUT, "len(made)"),
}
CALLS = {
    "pyvista": "PyVista: delaunay_2d",
    "shapely": "shapely: delaunay_triangles",
    "voronoi": "shapely: voronoi_polygons",
    "matplotlib": "matplotlib: Triangulation and its finder",
    "circle": "mapbox_earcut: a circle",
    "coast": "mapbox_earcut: a coast",
}


def add_options(parser: ArgumentParser) -> None:
    add = parser.add_argument
    add("--n", type=int, nargs="+", default=[10**4, 10**5, 10**6], metavar="POINTS")
    add("--rounds", type=int, default=3, help="in which both take turns; one if it takes long")
    add("--works", nargs="+", choices=WORKS, default=[*WORKS], metavar="NAME")
    add("--limit", type=float, default=600, metavar="SECONDS", help="of the processor")
    add("--python", default=sys.executable, help="of an environment that has the libraries")


def run(options: Namespace) -> None:
    """Print a row for each work and size."""
    print(f"Seconds of the processor, {load()}")
    print("| library | points | liftmesh | library | times faster | triangles, liftmesh's first |")
    print("| --- | ---: | ---: | ---: | ---: | ---: |")
    for name in options.works:
        too_long = False
        for n in options.n:
            ours, theirs = turns(WORKS[name], n, options, too_long)
            too_long |= theirs.text.startswith(">")
            cells = CALLS[name], f"{n:,}", ours.text, theirs.text, ratio(ours, theirs)
            counts = f"{ours.count:,}, {theirs.count:,}" if theirs.seconds else f"{ours.count:,}"
            print(f"| {' | '.join(cells)} | {counts} |", flush=True)


@dataclass(frozen=True)
class Taken:
    """The seconds of a call, if it ended, as they are shown, and what it made."""

    seconds: float | None
    text: str
    count: int = 0


def turns(work: Work, n: int, options: Namespace, too_long: bool) -> tuple[Taken, Taken]:
    """Let both take turns; return the best round of each."""
    ours, theirs = [], []
    for _ in range(options.rounds):
        ours.append(once(work, work.ours, n, options))
        if too_long or any(each.seconds is None for each in theirs):
            continue
        if not theirs or min(each.seconds for each in theirs) < options.limit / 20:
            theirs.append(once(work, work.theirs, n, options))
    late = Taken(None, f"> {options.limit:,.0f}")
    return best(ours), best(theirs) if theirs else late


def best(found: list[Taken]) -> Taken:
    """Return the least, or what has none."""
    return min(found, key=lambda each: -1.0 if each.seconds is None else each.seconds)


def once(work: Work, call: str, n: int, options: Namespace) -> Taken:
    """Run a call in a process of its own, which the system ends at the limit."""
    limit = f"import resource\nresource.setrlimit(resource.RLIMIT_CPU, ({options.limit:.0f},) * 2)"
    code = f"{limit}{START}{work.before}call = lambda: {call}\ncount = lambda made: {work.count}"
    threads = dict.fromkeys(("LIFTMESH_NUM_THREADS", "OMP_NUM_THREADS"), "1")
    done = subprocess.run(
        [options.python, "-c", code + END, str(n)],
        capture_output=True,
        check=False,
        env=os.environ | {"GLIBC_TUNABLES": KEEP_MEMORY} | threads,
    )
    if done.returncode < 0:
        return Taken(None, f"> {options.limit:,.0f}")
    if done.returncode:
        print(done.stderr.decode(errors="replace").strip().splitlines()[-1], file=sys.stderr)
        return Taken(None, "-")
    seconds, count = json.loads(done.stdout.splitlines()[-1])
    return Taken(seconds, f"{seconds:#.3g}".rstrip("."), count)


def ratio(ours: Taken, theirs: Taken) -> str:
    """Say how many times faster liftmesh is, at least if the library was stopped."""
    if ours.seconds is None:
        return "-"
    if theirs.seconds is None:
        late = theirs.text.startswith(">")
        return f"> {float(theirs.text[2:].replace(',', '')) / ours.seconds:,.0f}" if late else "-"
    times = theirs.seconds / ours.seconds
    return f"{times:,.0f}" if times >= 20 else f"{times:.1f}"
