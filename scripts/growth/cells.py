"""Voronoi diagrams and cells, as subjects to watch."""

from __future__ import annotations

import copy
import io
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from distributions import Points, polar
from growth.counting import Prepare, Work, on
from growth.functions import EXACT, PLAIN, on_points
from growth.planar import PLANAR
from growth.weighted import FEW, weights_of

import liftmesh
from liftmesh.optional import load

CELLS = ("areas", "centroids", "corner_kinds", "corner_sources", "empty", "neighbors", "not_simple",
         "shared_lengths", "sides")  # fmt: skip

VORONOI = ("regions", "ridge_vertices", "ridge_dict", "ridge_points", "ridge_ends", "point_region",
           "region_vertices")  # fmt: skip


on_diagram = on(liftmesh.scipy.Voronoi, fresh=True)
"""Prepare a call on a fresh diagram of SciPy's class."""


def grown_by_half(points: Points) -> Work:
    """Prepare the addition of the second half of the points to the first."""
    half = len(points) // 2
    found = liftmesh.scipy.Voronoi(points[:half], incremental=True)
    return Work(lambda: copy.copy(found).add_points(points[half:]), len(points))


def boxed(points: Points) -> tuple[float, float, float, float]:
    """The box of the points."""
    low, high = points.min(axis=0), points.max(axis=0)
    return (*low.tolist(), *high.tolist())


def clipped(points: Points) -> liftmesh.Cells:
    """Clip Voronoi cells to the box of the points."""
    return liftmesh.voronoi(points, domain=boxed(points))


def in_lakes(points: Points) -> Work:
    """Prepare the cells of few rows, each with many lakes and an islet: a sixteenth of the rows."""
    side = int((len(points) // 16) ** 0.5) + 1
    grid = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2)
    square = np.array([(0, 0), (0, 1), (1, 1), (1, 0)])
    lakes = grid[:, None] * 4 + 1 + 2 * square
    islets = grid[:: side // 2 + 1, None] * 4 + 1.5 + square
    shapely = load("shapely", extra="shapes")
    domain = shapely.MultiPolygon(
        [shapely.Polygon(4 * side * square, lakes), *map(shapely.Polygon, islets)]
    )
    rows = 4 * side * (0.1 + 0.8 * points[:3] / np.abs(points[:3]).max())
    return Work(lambda: liftmesh.voronoi(rows, domain=domain), len(points))


def around_a_hub(points: Points) -> Work:
    """Prepare the cells of a wheel in a star, which goes into the hub's cell and out of it."""
    corners = len(points) // 4
    spokes = 2 * np.pi * np.arange(len(points) - corners) / (len(points) - corners)
    rows = np.vstack([[[0.0, 0.0]], polar(1.0, spokes)])
    reach = np.where(np.arange(corners) % 4 < 2, 0.4, 0.51)[:, None]
    star = reach * polar(1.0, 0.1 + 2 * np.pi * np.arange(corners) / corners)
    return Work(lambda: liftmesh.voronoi(rows, domain=star), len(points))


def by_weight(points: Points) -> Work:
    """Prepare a power diagram."""
    weights = weights_of(points, 1.0)
    box = boxed(points)
    return Work(lambda: liftmesh.power_diagram(points, weights=weights, domain=box), len(points))


def transported(points: Points) -> Work:
    """Prepare one step of Newton's method at different positions."""
    distinct = np.unique(points, axis=0)
    masses, box = np.ones(len(distinct)), boxed(points)
    return Work(lambda: liftmesh.transport(distinct, masses, domain=box, max_iter=1), len(distinct))


def by_density(points: Points) -> Work:
    """Prepare two steps of Lloyd's method by an image of as many pixels."""
    side = int(len(points) ** 0.5) + 1
    image = np.arange(side * side).reshape(side, side)
    box = boxed(points)
    return Work(lambda: liftmesh.lloyd(points, domain=box, density=image, max_iter=2), len(points))


def queries_of(points: Points) -> Points:
    """As many places in the box of the points, drawn."""
    low, high = points.min(axis=0), points.max(axis=0)
    return low + np.random.default_rng(7).random((len(points), 2)) * (high - low)


def neighbors_of(points: Points) -> Work:
    """Prepare the search of natural neighbours of as many places in the box of the points."""
    places = queries_of(points)
    return Work(lambda: liftmesh.natural_neighbors(points, places), len(points))


def on_neighbors(call: Callable[[liftmesh.NaturalNeighbors, Points], object]) -> Prepare:
    """Prepare a call on natural neighbours."""
    made = on(lambda points: (liftmesh.natural_neighbors(points, queries_of(points)), points))
    return made(lambda pair: call(*pair))


on_cells = on(clipped, fresh=True)
"""Prepare a call on fresh cells."""


def diagram_functions() -> Iterator[tuple[Any, ...]]:
    """Name, families, preparation and counted families of what makes and shows diagrams."""
    farthest = on_points(lambda points: liftmesh.scipy.Voronoi(points, furthest_site=True))
    yield "scipy.Voronoi", PLANAR, on_points(liftmesh.scipy.Voronoi), (*PLAIN, *EXACT)
    yield "scipy.Voronoi of the farthest site", PLANAR, farthest, ("uniform", "parabola")
    for name in VORONOI:
        yield (
            f"scipy.Voronoi.{name}",
            PLANAR,
            on_diagram(lambda v, name=name: getattr(v, name)),
            PLAIN,
        )
    yield "scipy.Voronoi.add_points", PLANAR, grown_by_half, ("uniform",)
    yield "scipy.Voronoi.close", PLANAR, on_diagram(liftmesh.scipy.Voronoi.close), ()
    yield "voronoi", PLANAR, on_points(clipped), (*PLAIN, "tilted lattice")
    yield "power_diagram", PLANAR, by_weight, ("uniform", "lattice")
    yield "voronoi in lakes", PLANAR, in_lakes, ("uniform",)
    yield "voronoi around a hub", PLANAR, around_a_hub, ("uniform",)
    for name in CELLS:
        yield f"Cells.{name}", PLANAR, on_cells(lambda c, name=name: getattr(c, name)), FEW
    lloyd = on_points(lambda points: liftmesh.lloyd(points, domain=boxed(points), max_iter=2))
    yield "lloyd", PLANAR, lloyd, ("uniform",)
    yield "natural_neighbors", PLANAR, neighbors_of, ("uniform",)
    found = on_neighbors(lambda n, values: n.interpolate(values))
    yield "Weights.interpolate", PLANAR, found, ()
    yield "Weights.to_scipy", PLANAR, on_neighbors(lambda n, _: n.to_scipy()), ()
    yield "lloyd by a density", PLANAR, by_density, ()
    yield "transport", PLANAR, transported, ()
    yield "Cells.unclipped", PLANAR, on_cells(lambda c: c.unclipped), ("uniform",)
    for name in ("rays", "regions", "ridge_dict", "ridge_vertices"):
        unclipped = on_cells(lambda c, name=name: getattr(c.unclipped, name))
        yield f"Unclipped.{name}", PLANAR, unclipped, ()
    yield "Cells.to_shapely", PLANAR, on_cells(liftmesh.Cells.to_shapely), ("uniform",)
    yield "Cells.to_geodataframe", PLANAR, on_cells(liftmesh.Cells.to_geodataframe), ()
    saved = on_cells(lambda c: c.save(io.BytesIO(), format="geojson"))
    yield "Cells.save", PLANAR, saved, ()


FUNCTIONS = tuple(diagram_functions())
