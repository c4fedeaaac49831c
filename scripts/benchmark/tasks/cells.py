"""Time Voronoi diagrams and cells, compared with SciPy, shapely and geogram.

    python scripts/bench.py cells                    a million points; SciPy takes 20 seconds
    python scripts/bench.py cells --n 100000 --rounds 5
    python scripts/bench.py cells --n 100000 --only transport      what has this in its name

Shown is processor time of one thread, the best of the rounds, and as a multiple of the time in
which liftmesh triangulates the same points. Cells are clipped to a box and to a coast of ten
thousand corners. shapely makes them by `voronoi_polygons` and clips them one by one; it, SciPy and
what takes many diagrams get no more than `--most` points; `transport` tells its steps, too, in the
square that the points fill and in a box that is wider by a tenth on each side. geogram, if it is
installed (the extra `bench`), returns the triangles of cells. `out/bench_cells.json`, or `--json
FILE`, holds the times.
"""

from __future__ import annotations

import importlib.util
import json
import os
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from time import process_time
from typing import TypeAlias

import numpy as np
import scipy.spatial
import shapely
from benchmark.contest import SEED
from benchmark.measuring import add_common, console, empty_table
from distributions import Points

import liftmesh
from liftmesh.cells.optimization import TransportResult

Case: TypeAlias = tuple[str, str, Points, Callable[[Points], object]]

UNIT = (0, 0, 1, 1)
BOX = (-0.1, -0.1, 1.1, 1.1)


def coast(corners: int = 10_000) -> Points:
    """Draw a ragged outline about the middle of the unit square."""
    rng = np.random.default_rng(SEED)
    turn = np.linspace(0, 2 * np.pi, corners, endpoint=False)
    radius = 0.4 + 0.05 * np.sin(40 * turn) + 0.002 * rng.random(corners)
    return np.stack([np.cos(turn), np.sin(turn)], axis=1) * radius[:, None] + 0.5


def clipped_by_shapely(points: Points, domain: shapely.Polygon) -> np.ndarray:
    """Voronoi polygons, each cut with a domain."""
    whole = shapely.voronoi_polygons(shapely.MultiPoint(points), extend_to=shapely.box(*BOX))
    shapely.prepare(domain)
    return shapely.intersection(shapely.get_parts(whole), domain)


def of_geogram(points: Points, weights: Points | None = None) -> object:
    """Cells in the box, by weights if there are any."""
    import geogram  # noqa: PLC0415 - it need not be installed

    left, low, right, high = BOX
    corners = np.array([[left, low], [right, low], [right, high], [left, high]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.uint32)
    given = {} if weights is None else {"weights": weights}
    return geogram.Voronoi(points, domain_vertices=corners, domain_simplices=triangles, **given)


def every_array(points: Points) -> tuple[object, ...]:
    """A diagram with its ridges and regions, which are found on first use."""
    made = liftmesh.scipy.Voronoi(points)
    return made, made.ridge_points, made.ridge_ends, made.point_region, made.region_vertices


def cases(points: Points, most: int) -> Iterator[Case]:
    """What is made, by what, of which points, and how."""
    outline, few = coast(), points[:most]
    yield "Voronoi", "liftmesh", points, liftmesh.scipy.Voronoi
    yield "Voronoi, every array", "liftmesh", points, every_array
    yield "Voronoi, every array", "scipy", few, scipy.spatial.Voronoi
    for name, domain in (("box", BOX), ("coast", outline)):
        shape = shapely.box(*BOX) if name == "box" else shapely.Polygon(outline)
        clip = partial(liftmesh.voronoi, domain=domain)
        yield f"cells in a {name}", "liftmesh", points, clip
        yield f"cells in a {name}", "shapely", few, partial(clipped_by_shapely, domain=shape)
    weights = np.random.default_rng(SEED).random(len(points)) / len(points)
    power = partial(liftmesh.power_diagram, weights=weights, domain=BOX)
    yield "power cells in a box", "liftmesh", points, power
    if importlib.util.find_spec("geogram"):
        yield "cells in a box", "geogram", points, of_geogram
        yield "power cells in a box", "geogram", points, partial(of_geogram, weights=weights)
    yield from uses(few)


def uses(few: Points) -> Iterator[Case]:
    """What cells are for."""
    rng = np.random.default_rng(SEED + 1)  # not what the points are drawn by
    masses, image = rng.random(len(few)) + 0.5, np.tile(np.arange(1, 501), (500, 1))
    spread = partial(liftmesh.transport, masses=masses, domain=BOX)
    relaxed = partial(liftmesh.lloyd, domain=BOX, max_iter=10, tol=0)
    yield "transport to 1e-8", "liftmesh", few, partial(spread, domain=UNIT)
    yield "transport to 1e-8, wider", "liftmesh", few, spread
    yield "transport of an image", "liftmesh", few, partial(spread, density=image)
    yield "10 steps of lloyd", "liftmesh", few, relaxed
    yield "10 steps by an image", "liftmesh", few, partial(relaxed, density=image)
    queries = rng.random(few.shape)
    yield "natural neighbors", "liftmesh", few, partial(liftmesh.natural_neighbors, queries=queries)


def best(call: Callable[[], object], rounds: int) -> tuple[float, object]:
    """Seconds of the processor for the best of some rounds, and what the last one returned."""
    taken, made = [], None
    for _ in range(rounds):
        made = None  # two results would need twice the memory
        start = process_time()
        made = call()
        taken.append(process_time() - start)
    return min(taken), made


def steps_of(made: object) -> str:
    """How many steps were made, if they are no matter of an option."""
    return str(len(made.damping)) if isinstance(made, TransportResult) else ""


def add_options(parser: ArgumentParser) -> None:
    add_common(parser)
    parser.add_argument("--most", type=int, default=100_000)
    parser.add_argument("--only", default="")
    parser.add_argument("--json", type=Path, default=Path("out/bench_cells.json"))


def run(options: Namespace) -> None:
    os.environ["LIFTMESH_NUM_THREADS"] = "1"
    points = np.random.default_rng(SEED).random((options.n, 2))
    numbers = ("points", "seconds", "x delaunay", "steps")
    table = empty_table("uniform points", ("what", "program"), numbers)
    held = []
    for what, program, of, call in cases(points, options.most):
        if options.only not in what:
            continue
        seconds, made = best(lambda of=of, call=call: call(of), options.rounds)
        own, _ = best(lambda of=of: liftmesh.delaunay(of, threads=1), options.rounds)
        times = f"{seconds:.3f}", f"{seconds / own:.1f}"
        table.add_row(what, program, f"{len(of):,}", *times, steps_of(made))
        held.append(
            {
                "what": what,
                "program": program,
                "points": len(of),
                "seconds": seconds,
                "delaunay": own,
            }
        )
    options.json.parent.mkdir(parents=True, exist_ok=True)
    options.json.write_text(json.dumps(held, indent=1) + "\n")
    console(110).print(table)
