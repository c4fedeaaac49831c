"""Points that are inserted and removed, and surfaces that are simplified, as subjects to watch."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from typing import Any

import numpy as np
from distributions import Points, polar
from growth.counting import Work
from growth.families import named, random
from growth.functions import EXACT, TERRAIN, on_points, on_surface
from growth.planar import FANS, PLANAR
from growth.spatial import SPATIAL

import liftmesh


def inserted(points: Points) -> Work:
    """Prepare the insertion of points, a tenth of all at once, into the others."""
    part = len(points) // 10
    tri = liftmesh.DynamicTriangulation(points[part:])
    return Work(lambda: copy.copy(tri).insert(points[:part]), len(points))


def removed(points: Points) -> Work:
    """Prepare the removal of a tenth of the points, those with the most neighbours among them."""
    tri = copy.copy(liftmesh.DynamicTriangulation(points))
    degree = np.bincount(tri.simplices.ravel(), minlength=len(tri.points))
    gone = np.intersect1d(np.argsort(-degree, kind="stable")[: len(points) // 10], tri.vertices)
    return Work(lambda: copy.copy(tri).remove(gone), len(points))


def constrained(points: Points) -> Work:
    """Prepare the insertion of constraints: the edges between every tenth point."""
    tri = liftmesh.DynamicTriangulation(points)
    edges = sparse_edges(tri)

    def insert() -> None:
        twin = copy.copy(tri)
        for a, b in edges:
            twin.insert_constraint(a, b)

    return Work(insert, len(points))


def released(points: Points) -> Work:
    """Prepare the removal of these."""
    edges = sparse_edges(liftmesh.DynamicTriangulation(points))
    tri = liftmesh.DynamicTriangulation(points)
    for a, b in edges:
        tri.insert_constraint(a, b)

    def remove() -> None:
        twin = copy.copy(tri)
        for a, b in edges:
            twin.remove_constraint(a, b)

    return Work(remove, len(points))


def sparse_edges(tri: liftmesh.DynamicTriangulation) -> list[list[int]]:
    """Return the edges of a triangulation of every tenth point."""
    some = tri.vertices[::10]
    try:
        few = liftmesh.delaunay(tri.points[some])
    except liftmesh.DegenerateInputError:
        return [some[[0, -1]].tolist()] if len(some) > 1 else []
    edges: list[list[int]] = some[few.edges].tolist()
    return edges


def looked_up(points: Points) -> Work:
    """Prepare a look at all that a changing triangulation tells."""
    tri = liftmesh.DynamicTriangulation(points)

    def look() -> object:
        twin = copy.copy(tri)
        told = twin.points, twin.vertices, twin.simplices, twin.neighbors, twin.convex_hull
        return told, twin.find(points[:, :2])

    return Work(look, len(points))


def found_singly(points: Points) -> Work:
    """Prepare looks for points one by one, most of the others having been removed."""
    tri = liftmesh.DynamicTriangulation(points)
    tri.remove(tri.vertices[: 3 * len(tri) // 4])
    wanted = points[tri.vertices[: len(tri) // 16], :2]
    return Work(lambda: [tri.find(each[None]) for each in wanted], len(points))


def simplified(points: Points) -> Work:
    """Prepare an approximation within a fifth of the range of heights."""
    bound = float(np.ptp(points[:, 2] / 2)) / 2.5
    return Work(lambda: liftmesh.simplify(points, max_error=bound), len(points))


def simplified_along(points: Points) -> Work:
    """Prepare one of a surface that follows every tenth point, from left to right."""
    _, rows = np.unique(points[::10, :2], axis=0, return_index=True)
    surface = liftmesh.triangulate(points, breaklines=points[10 * rows], threads=1)
    bound = float(np.ptp(points[:, 2] / 2)) / 2.5
    return Work(lambda: liftmesh.simplify(surface, max_error=bound), len(points))


def thinned(points: Points) -> Work:
    """Prepare adaptive thinning to a fiftieth of the rows."""
    most = len(liftmesh.delaunay(points[:, :2]).convex_hull)
    wanted = max(len(points) // 50, most, 64)
    return Work(lambda: liftmesh.thin(points, adaptive=wanted), len(points))


def without_spikes(points: Points) -> Work:
    """Prepare thinning without spikes in sixteen layers, by about twice the mean distance."""
    low, high = points.min(axis=0), points.max(axis=0)
    width, height = float(np.max(high / 2 - low / 2)), float(high[2] / 2 - low[2] / 2)
    options = {"spike_free": 4 * width / len(points) ** 0.5, "spike_buffer": height / 8}
    return Work(lambda: liftmesh.thin(points, **options), len(points))


def few_vertices(surface: liftmesh.Surface) -> object:
    """Simplify a surface to a quarter of its rows."""
    return liftmesh.simplify(surface, max_points=max(len(surface.vertices) // 4, 64))


def hub(n: int) -> Points:
    """A ring around a vertex within a square: it has all others of the ring for neighbours."""
    angles = np.sort(random().random(n - 5)) * 2 * np.pi
    square = [[9.0, 9.0], [9.0, -9.0], [-9.0, 9.0], [-9.0, -9.0]]
    planar = np.vstack([polar(1.0, angles), [[0.0, 0.0]], square])
    return np.column_stack([planar, random().random(n)])


def all_corners(n: int) -> Points:
    """Every point is a corner of the hull, to begin with: one by one, each would meet them all."""
    along = np.linspace(-1, 1, n)
    return np.column_stack([along, along**2, np.sin(9 * along)])


def saw(n: int) -> Points:
    """Two rows of points, all equally far from their approximation."""
    along = np.arange(n) / n
    return np.column_stack([along, np.arange(n) % 2 * 1e-4, np.arange(n) % 2])


def subjects() -> Iterator[tuple[Any, ...]]:
    """Name, families, preparation and counted families."""
    whole = on_points(lambda p: liftmesh.DynamicTriangulation(p).to_triangulation())
    yield "DynamicTriangulation", PLANAR, on_points(liftmesh.DynamicTriangulation), ("lattice",)
    yield "DynamicTriangulation.insert", PLANAR, inserted, ("uniform", *FANS, *EXACT)
    # On rings of cocircular points each removal of the hub of a fan makes another hub.
    fans = [name for name in FANS if name != "polar scan"]
    yield "DynamicTriangulation.remove", PLANAR, removed, ("uniform", *fans, *EXACT)
    yield "DynamicTriangulation.insert_constraint", PLANAR, constrained, ("uniform", *FANS)
    yield "DynamicTriangulation.remove_constraint", PLANAR, released, ("uniform", *FANS)
    yield "DynamicTriangulation.find", PLANAR, looked_up, ("uniform",)
    yield "DynamicTriangulation.find singly", PLANAR, found_singly, ("uniform",)
    yield "DynamicTriangulation.to_triangulation", PLANAR, whole, ()
    hard = named(all_corners, saw)
    yield "simplify", {**SPATIAL, **hard}, simplified, (*TERRAIN, *hard)
    yield "simplify with lines", SPATIAL, simplified_along, ("random heights",)
    yield "thin adaptively", {**SPATIAL, **named(hub)}, thinned, (*TERRAIN, "hub")
    yield "thin without spikes", SPATIAL, without_spikes, ("random heights",)
    yield "simplify a surface", SPATIAL, on_surface(few_vertices), ("random heights",)


CHANGING = tuple(subjects())
