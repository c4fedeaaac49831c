"""The programs that are timed, each in a process of its own: ``python -m constrained.peers``.

A process reads the points and edges of a folder, calls its program, twice unless that is slow,
writes the triangles to the folder, and prints the version and the better of its processor's
seconds. `carve` leaves out the outside and holes by parity; triangle takes points in them.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Callable
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from benchmark import cgal
from benchmark.contestants import KEEP_MEMORY, PROGRAMS
from benchmark.process import cause
from constrained.families import Case, Edges
from distributions import Points

SCRIPTS = Path(__file__).resolve().parents[1]
SOURCE = Path(__file__).with_name("cgal.cpp")
LONG = 2.0  # seconds of a call that is not repeated
CARVE = "carve"

Call = Callable[[], Any]


class NoAnswerError(Exception):
    """A program gave no triangles; the message says why."""


def liftmesh(points: Points, edges: Edges, carve: bool, *_: object) -> Call:
    build = import_module("liftmesh").constrained_delaunay
    way = "holes" if carve else None
    return lambda: build(points, edges, carve=way, threads=1).simplices


def delaunay(points: Points, *_: object) -> Call:
    """Without the edges."""
    kernel = import_module("liftmesh._kernel")
    return lambda: kernel.delaunay(points, False, 1, False, None)[3]


def cdt(points: Points, edges: Edges, carve: bool, _: Points) -> Call:
    program = import_module("pythoncdt")
    order = program.VertexInsertionOrder.AUTO
    crossings = program.IntersectingConstraintEdges.NOT_ALLOWED
    pairs = edges.astype(np.uint32)

    def call() -> Any:
        made = program.Triangulation(order, crossings, 0.0)
        made.insert_vertices(points)
        made.insert_edges(pairs)
        made.erase_outer_triangles_and_holes() if carve else made.erase_super_triangle()
        return made.triangles_array()["vertices"]

    return call


def triangle(points: Points, edges: Edges, carve: bool, holes: Points) -> Call:
    program = import_module("triangle")
    given = {"vertices": points, "segments": edges} | ({"holes": holes} if len(holes) else {})
    return lambda: program.triangulate(given, "pQ" if carve else "pcQ")["triangles"]


CGAL = "CGAL"
OURS = "liftmesh"
PROGRAMS_OF_PYTHON: dict[str, tuple[str, Callable[..., Call]]] = {
    OURS: ("liftmesh", liftmesh),
    "delaunay": ("liftmesh", delaunay),
    "CDT": ("pythoncdt", cdt),
    "triangle": ("triangle", triangle),
}


def write(folder: Path, case: Case, holes: Points | None = None) -> None:
    """Write a case for programs to read."""
    points, edges = case
    np.ascontiguousarray(points).tofile(folder / "points")
    np.ascontiguousarray(edges, dtype=np.int32).tofile(folder / "edges")
    (np.empty((0, 2)) if holes is None else holes).tofile(folder / "holes")


def ask(name: str, folder: Path, limit: float, *, carve: bool = False) -> tuple[float, Edges]:
    """Run a program in a fresh process; return its seconds and triangles."""
    command = [sys.executable, "-m", "constrained.peers", name, *([CARVE] * carve)]
    if name == CGAL:
        try:
            command = [str(cgal.build(PROGRAMS, SOURCE))]
        except cgal.UnavailableError as error:
            raise NoAnswerError(f"not available: {error}") from error
    paths = os.pathsep.join(filter(None, (str(SCRIPTS), os.environ.get("PYTHONPATH"))))
    environment = os.environ | {"GLIBC_TUNABLES": KEEP_MEMORY, "PYTHONPATH": paths}
    try:
        done = subprocess.run([*command, str(folder)], capture_output=True, text=True,
                              env=environment, timeout=limit, check=False)  # fmt: skip
    except subprocess.TimeoutExpired:
        raise NoAnswerError(f"> {limit:g} s") from None
    if done.returncode:
        raise NoAnswerError(cause(done.returncode, done.stderr))
    triangles = np.fromfile(folder / "triangles", np.int32).reshape(-1, 3)
    return json.loads(done.stdout.splitlines()[-1])["seconds"], triangles


def main(name: str, *words: str) -> None:
    *carve, folder = words
    points, holes = (np.fromfile(Path(folder, each)).reshape(-1, 2) for each in ("points", "holes"))
    edges = np.fromfile(Path(folder, "edges"), np.int32).reshape(-1, 2)
    package, prepare = PROGRAMS_OF_PYTHON[name]
    call = prepare(points, edges, carve == [CARVE], holes)
    taken: list[float] = []
    while len(taken) < 2 and sum(taken) < LONG:
        start = process_time()
        triangles = call()
        taken.append(process_time() - start)
    np.asarray(triangles).astype(np.int32).tofile(Path(folder, "triangles"))
    print(json.dumps({"version": version(package), "seconds": min(taken)}))


if __name__ == "__main__":
    main(*sys.argv[1:])
