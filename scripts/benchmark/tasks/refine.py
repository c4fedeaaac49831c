"""Time refinement of a coast and of squares, beside triangle and Gmsh, and smoothing.

    python scripts/bench.py refine                        105,000 points, and a million triangles
    python scripts/bench.py refine --n 20000 --triangles 100000 --rounds 1

The coast is that of `scripts/constrained/families.py`, carved, and both programs start from points
and edges: "refine" is what `liftmesh.refine` takes of liftmesh's time. "Below" are triangles under
the angle, which small input angles force. One square has edges of one length, in the other those at
one corner are to be twenty times as long as at the opposite one; triangle, which takes no function,
refines again under bounds of areas until none is larger, and Gmsh, which promises no angle, has a
field by a formula. An edge is near if it is from half to twice as long as what is wanted in its
middle. Smoothed are the coast and a pentagon with lengths as in the square; angles are the smallest
ones of the triangles. In one process and in turns; the least CPU seconds of the rounds count.
Memory is the peak of the first such mesh in a process of its own, with what it returns, without
what imports take.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from time import process_time
from typing import Any

import numpy as np
from benchmark.measuring import console, empty_table, in_process, load
from benchmark.tasks.constraints import SEED, carved
from constrained.families import COAST, FAMILIES, Edges
from distributions import Points
from process_state import memory

import liftmesh

ANGLES = (20, 30, 34)  # degrees
SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
SIDES = np.array([[0, 1], [1, 2], [2, 3], [3, 0]], dtype=np.int32)
GRADED = 30  # degrees
SPREADS = {"uniform": 1.0, "graded": 20.0}  # of lengths
FILLING = 1.4  # triangles made, for each equilateral one of the wanted length
MOST_ROUNDS = 30
PENTAGON = np.array([[0.0, 0.1], [0.8, 0], [1, 0.7], [0.5, 1], [0.1, 0.8]])
SMOOTHED = 0, 1, 3, 10  # rounds
Mesh = tuple[Points, Edges]


def add_options(parser: ArgumentParser) -> None:
    add = parser.add_argument
    add("--n", type=int, default=COAST, metavar="POINTS", help="of the coast")
    add("--triangles", type=int, default=1_000_000, help="of each square")
    add("--rounds", type=int, default=3)


def run(options: Namespace) -> None:
    """Print the tables."""
    if not find_spec("gmsh"):
        print("Gmsh is left out: pip install gmsh")
    show("coast", COAST_COLUMNS, coast(import_module("triangle"), options))
    for name, spread in SPREADS.items():
        show(f"{name} square", SQUARE_COLUMNS, square(spread, options))
    show("smoothed, in rounds", SMOOTHED_COLUMNS, [*smoothed(options)])


COAST_COLUMNS = "angle", "triangles", "below", "seconds", "refine"
SQUARE_COLUMNS = "near", "triangles", "seconds", "microseconds a triangle", "bytes a triangle"
SMOOTHED_COLUMNS = (
    "least angle",
    "mean",
    "under 35",
    "triangles",
    "microseconds a triangle and round",
)


def show(name: str, columns: tuple[str, ...], rows: list[list[str]]) -> None:
    table = empty_table(f"{name}, {load()}", ["program"], columns)
    for row in rows:
        table.add_row(*row)
    console().print(table)


def coast(program: Any, options: Namespace) -> list[list[str]]:
    """Refine the carved coast at each angle."""
    points, edges = FAMILIES["coast"](options.n, np.random.default_rng(SEED))
    given = {"vertices": points, "segments": edges, "holes": carved(points, edges)[1]}
    rows = []
    for angle in ANGLES:
        took: dict[str, float] = {"refine": np.inf}

        def ours(angle: int = angle, took: dict[str, float] = took) -> Mesh:
            tri = liftmesh.constrained_delaunay(points, edges, carve="holes", threads=1)
            start = process_time()
            made = liftmesh.refine(tri, min_angle=angle).triangulation
            took["refine"] = min(took["refine"], process_time() - start)
            return made.points, made.simplices

        def theirs(angle: int = angle) -> Mesh:
            return mesh_of(program.triangulate(given, f"pq{angle}Q"))

        for name, (seconds, mesh) in in_turn({"triangle": theirs, "liftmesh": ours}, options):
            below = int(np.count_nonzero(smallest_angles(*mesh) < angle - 1e-9))
            part = f"{took['refine']:.2f}" if name == "liftmesh" else ""
            rows.append([name, str(angle), f"{len(mesh[1]):,}", str(below), f"{seconds:.2f}", part])
    return rows


def square(spread: float, options: Namespace) -> list[list[str]]:
    """Refine the square to lengths of a function, and measure the memory anew."""
    case = unit_length(options.triangles, spread), spread
    programs = [name for name in MESHERS if name != "Gmsh" or find_spec("gmsh")]
    calls = {name: partial(MESHERS[name], *case) for name in programs}
    rows = []
    for name, (seconds, mesh) in in_turn(calls, options):
        count = len(mesh[1])
        cells = f"{near(*mesh, lambda places: lengths(*case, places)):.2%}", f"{count:,}"
        each = f"{1e6 * seconds / count:.2f}", f"{in_process(peak_of, name, *case) / count:.0f}"
        rows.append([name, *cells, f"{seconds:.2f}", *each])
    return rows


def peak_of(name: str, *case: float) -> int:
    """Return what the first mesh of a process takes at most, in bytes."""
    MESHERS[name](unit_length(1000, case[1]), case[1])  # which imports what is needed
    before = memory("VmRSS")
    made = MESHERS[name](*case)
    return max(0, memory("VmHWM") - before) if len(made[1]) else 0


def by_liftmesh(least: float, spread: float) -> Mesh:
    tri = liftmesh.constrained_delaunay(SQUARE, SIDES, threads=1)
    wanted = partial(lengths, least, spread)
    made = liftmesh.refine(tri, min_angle=GRADED, size=wanted if spread > 1 else least)
    return made.triangulation.points, made.triangulation.simplices


def by_triangle(least: float, spread: float) -> Mesh:
    """Refine again and again, until no triangle has an area that is too large."""
    program = import_module("triangle")
    made = program.triangulate({"vertices": SQUARE, "segments": SIDES}, "pQ")
    for _ in range(MOST_ROUNDS):
        points, triangles = mesh_of(made)
        wanted = lengths(least, spread, points[triangles].mean(axis=1))
        most = wanted**2 * np.sqrt(3) / 4 * FILLING
        if (areas(points, triangles) <= most).all():
            break
        made["triangle_max_area"] = most[:, None]
        made = program.triangulate(made, f"prq{GRADED}aQ")
    return mesh_of(made)


def by_gmsh(least: float, spread: float) -> Mesh:
    """Mesh with the field that it computes itself from a formula, and its usual algorithm."""
    gmsh = import_module("gmsh")
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("General.NumThreads", 1)
        for name in ("ExtendFromBoundary", "FromPoints", "FromCurvature"):
            gmsh.option.setNumber(f"Mesh.MeshSize{name}", 0)
        surface = gmsh.model.occ.addRectangle(0, 0, 0, 1, 1)
        gmsh.model.occ.synchronize()
        field = gmsh.model.mesh.field.add("MathEval")
        formula = f"{least!r} * (1 + {spread - 1!r} * Sqrt((x*x + y*y) / 2))"
        gmsh.model.mesh.field.setString(field, "F", formula)
        gmsh.model.mesh.field.setAsBackgroundMesh(field)
        gmsh.model.mesh.generate(2)
        tags, places, _ = gmsh.model.mesh.getNodes()
        corners = gmsh.model.mesh.getElements(2, surface)[2][0]
    finally:
        gmsh.finalize()
    row = np.zeros(int(tags.max()) + 1, np.int32)
    row[tags] = np.arange(len(tags))
    return places.reshape(-1, 3)[:, :2], row[corners].reshape(-1, 3)


MESHERS: dict[str, Callable[[float, float], Mesh]] = {
    "triangle": by_triangle,
    "Gmsh": by_gmsh,
    "liftmesh": by_liftmesh,
}


def smoothed(options: Namespace) -> Iterator[list[str]]:
    """Smooth the carved coast, and a graded pentagon."""
    scale = unit_length(options.triangles, SPREADS["graded"])
    land = FAMILIES["coast"](options.n, np.random.default_rng(SEED))
    cases: dict[str, Any] = {
        "coast": (liftmesh.constrained_delaunay(*land, carve="holes", threads=1), None),
        "pentagon": ([PENTAGON], partial(lengths, scale, SPREADS["graded"])),
    }
    for name, (domain, size) in cases.items():

        def made(rounds: int, domain: Any = domain, size: Any = size) -> Mesh:
            found = liftmesh.refine(domain, min_angle=GRADED, size=size, smooth=rounds)
            return found.triangulation.points, found.triangulation.simplices

        calls = {str(rounds): partial(made, rounds) for rounds in SMOOTHED}
        (_, (plain, _)), *_ = found = in_turn(calls, options)
        for rounds, (seconds, mesh) in found:
            angles = smallest_angles(*mesh)
            each = 1e6 * (seconds - plain) / len(angles) / max(int(rounds), 1)
            told = f"{angles.min():.2f}", f"{angles.mean():.2f}", f"{np.mean(angles < 35):.1%}"
            yield [f"{name}, {rounds}", *told, f"{len(angles):,}", f"{each:.2f}"]


def lengths(least: float, spread: float, places: Points) -> Any:
    """Return the lengths that are wanted at places in the square."""
    return least * (1 + (spread - 1) * np.hypot(*places.T) / np.sqrt(2))


def unit_length(triangles: int, spread: float) -> float:
    """Return the least length with which a mesh has about so many triangles."""
    places = (np.indices((512, 512)).reshape(2, -1) + 0.5) / 512
    many = 4 / np.sqrt(3) / lengths(1.0, spread, places.T) ** 2
    return float(np.sqrt(FILLING * many.mean() / triangles))


def in_turn(
    calls: dict[str, Callable[[], Mesh]], options: Namespace
) -> list[tuple[str, tuple[float, Mesh]]]:
    """Return the least seconds of each call, and what it made."""
    found: dict[str, tuple[float, Mesh]] = {}
    for _ in range(options.rounds):
        for name, call in calls.items():
            start = process_time()
            mesh = call()
            seconds = process_time() - start
            found[name] = min(seconds, found.get(name, (np.inf,))[0]), mesh
    return [*found.items()]


def mesh_of(made: Any) -> Mesh:
    return made["vertices"], made["triangles"]


def areas(points: Points, triangles: Edges) -> Any:
    a, b, c = points[triangles].transpose(1, 2, 0)
    return ((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0]) / 2


def smallest_angles(points: Points, triangles: Edges) -> Any:
    """Return the smallest angle of each triangle in degrees."""
    corners = points[triangles]
    sides = np.roll(corners, -1, axis=1) - corners
    back = -np.roll(sides, 1, axis=1)
    cosines = (sides * back).sum(axis=2) / np.sqrt((sides**2).sum(axis=2) * (back**2).sum(axis=2))
    return np.degrees(np.arccos(cosines.max(axis=1).clip(max=1)))


def near(points: Points, triangles: Edges, wanted: Callable[[Points], Any]) -> float:
    """Return the share of edges that are from half to twice as long as what is wanted."""
    ends = np.sort(np.concatenate([triangles[:, [k, k - 1]] for k in range(3)]), axis=1)
    a, b = points[np.unique(ends, axis=0)].transpose(1, 0, 2)
    share = np.hypot(*(a - b).T) / wanted((a + b) / 2)
    return float(np.mean((share >= 0.5) & (share <= 2)))
