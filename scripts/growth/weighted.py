"""What triangulates weighted points, as subjects to watch: from no hidden row to almost all.

Weights make work of their own where rows become hidden: merges then remove what their parts had
made. The families are those of the plane.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
from distributions import Points
from growth.counting import Prepare, Work, on
from growth.families import random
from growth.functions import EXACT, PLAIN
from growth.planar import PLANAR

import liftmesh
from liftmesh import RegularTriangulation

FEW = ("uniform", "lattice")


def weights_of(points: Points, spread: float) -> np.ndarray:
    """Draw weights up to a multiple of the area that there is for a row."""
    extent = np.ptp(points / 2, axis=0).max()
    area = min(extent, 1e150) ** 2 * 4 / len(points)
    return random().random(len(points)) * min(area * spread, 1e300)


def weighted(points: Points, spread: float) -> RegularTriangulation:
    """Triangulate with weights."""
    return liftmesh.regular(points, weights=weights_of(points, spread), threads=1)


def by_weight(spread: float) -> Prepare:
    """Prepare a triangulation with weights."""

    def prepare(points: Points) -> Work:
        weights = weights_of(points, spread)
        return Work(lambda: liftmesh.regular(points, weights=weights, threads=1), len(points))

    return prepare


def by_radius(points: Points) -> Work:
    """Prepare a triangulation with radii, half of the rows of which are hidden."""
    radii = np.sqrt(weights_of(points, 1.0))
    return Work(lambda: liftmesh.regular(points, radii=radii, threads=1), len(points))


def under_the_hull(points: Points) -> Work:
    """Prepare a triangulation whose inner rows are all hidden."""
    weights = np.zeros(len(points))
    weights[liftmesh.delaunay(points, threads=1).convex_hull] = 1e300
    return Work(lambda: liftmesh.regular(points, weights=weights, threads=1), len(points))


on_weighted = on(lambda points: weighted(points, 1.0))
"""Prepare a call on a triangulation with weights."""


def computed(name: str) -> Callable[[RegularTriangulation], object]:
    """Return the function behind a cached property."""
    held: Any = vars(RegularTriangulation)[name]
    function: Callable[[RegularTriangulation], object] = held.func
    return function


def named(points: Points) -> Work:
    """Prepare a triangulation whose weights are named values of a cloud."""
    rows = np.column_stack([points, np.zeros(len(points))])
    cloud = liftmesh.Cloud(rows, attributes={"size": weights_of(points, 1.0)})
    return Work(lambda: liftmesh.regular(cloud, weights="size", threads=1), len(points))


def weighted_functions() -> Iterator[tuple[Any, ...]]:
    """Name, families, preparation and counted families of what takes weights."""
    yield "regular with all rows seen", PLANAR, by_weight(1e-6), (*FEW, "mixed exponents")
    yield "regular with hidden rows", PLANAR, by_weight(1.0), (*FEW, *EXACT[1:])
    yield "regular with most rows hidden", PLANAR, by_weight(1e3), FEW
    yield "regular by radius", PLANAR, by_radius, (*PLAIN, "mixed exponents")
    yield "regular under the hull", PLANAR, under_the_hull, ("uniform", "column and apex")
    yield "regular of few positions", PLANAR, by_weight(1.0), ("few positions",)
    yield "regular of named values", PLANAR, named, ()
    yield "verify by weights", PLANAR, on_weighted(lambda tri: tri.verify(threads=1)), FEW
    for name in ("hidden_to_simplex", "degenerate", "equations"):
        yield f"RegularTriangulation.{name}", PLANAR, on_weighted(computed(name)), FEW
    for name, call in (
        ("lift_points", lambda tri: tri.lift_points(tri.points)),
        ("plane_distance", lambda tri: tri.plane_distance(tri.points[0])),
        ("lifted", partial(RegularTriangulation.lifted, apex="median")),
    ):
        yield f"RegularTriangulation.{name}", PLANAR, on_weighted(call), ()


FUNCTIONS = tuple(weighted_functions())
