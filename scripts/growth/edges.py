"""Triangulations that contain given edges, as subjects to watch."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from math import isqrt
from typing import Any

import numpy as np
from constrained.families import FAMILIES, Case
from distributions import Points
from growth.counting import Prepare, Work
from growth.families import Family, random
from growth.functions import computed
from growth.planar import FANS, PLANAR

import liftmesh
from liftmesh import ConstrainedTriangulation

Call = Callable[[ConstrainedTriangulation], object]


def drawn(name: str) -> Family:
    """Make a family of one of the benchmark's."""

    def family(n: int) -> Case:
        return FAMILIES[name](n, random())

    family.__doc__ = FAMILIES[name].__doc__
    return family


def woven(n: int) -> Case:
    """As many crossings as the number says, of far fewer edges that are not quite straight."""
    count = max(isqrt(n), 2)
    across = (np.arange(2 * count) // 2)[:, None] + random().random((2 * count, 1)) / 4
    ends = np.tile([[-1.0], [count + 1.0]], (count, 1))
    points = np.vstack([np.hstack([across, ends]), np.hstack([ends, across])])
    return points, np.arange(4 * count, dtype=np.int32).reshape(-1, 2)


EDGES = {name: drawn(name) for name in FAMILIES}
WOVEN = {"woven": woven}
PLAIN = ("tiling", "star")


def build(case: Case, **options: Any) -> ConstrainedTriangulation:
    points, edges = case
    return liftmesh.constrained_delaunay(points, edges, threads=1, **options)


def built(**options: Any) -> Prepare:
    """Prepare a triangulation with the edges of a case."""
    return lambda case: Work(lambda: build(case, **options), len(case[0]) + len(case[1]))


def split(case: Case) -> Work:
    """Prepare one whose crossings are inserted: a quarter as many as pairs of edges."""
    return Work(lambda: build(case, crossing="split"), len(case[1]) ** 2 // 4)


def along_x(points: Points) -> Work:
    """Prepare one with a path through all points, from the least on: it crosses nowhere."""
    order = np.lexsort(points.T[::-1])
    path = np.column_stack([order[:-1], order[1:]])
    return Work(lambda: build((points, path)), len(points))


def on_triangulation(call: Call) -> Prepare:
    """Prepare a call on the triangulation of a case."""

    def prepare(case: Case) -> Work:
        found = build(case)
        return Work(lambda: call(found), len(case[0]) + len(case[1]))

    return prepare


def lift(found: ConstrainedTriangulation) -> None:
    """Raise what it always raises."""
    with suppress(liftmesh.InputError):
        found.lifted()


def functions() -> Iterator[tuple[Any, ...]]:
    """Name, families, preparation and counted families."""
    hard = (*PLAIN, "uniform", "comb", "spiral", "nested rings", "nearly parallel", "strip")
    yield "constrained_delaunay", EDGES, built(), hard
    yield "constrained_delaunay with holes", {"coast": EDGES["coast"]}, built(carve="holes"), None
    yield "constrained_delaunay along x", PLANAR, along_x, (*FANS, "lattice", "mixed exponents")
    yield "constrained_delaunay by splits", WOVEN, split, None
    for name in ("is_constrained", "regions", "repeated"):
        call = computed(ConstrainedTriangulation, name)
        yield f"ConstrainedTriangulation.{name}", EDGES, on_triangulation(call), PLAIN
    for name, call in (
        ("inputs_of", lambda tri: [tri.inputs_of(i) for i in range(len(tri.constraints))]),
        ("find_simplex", lambda tri: tri.find_simplex(tri.points)),
        ("to_scipy", ConstrainedTriangulation.to_scipy),
        ("lifted", lift),
    ):
        yield f"ConstrainedTriangulation.{name}", EDGES, on_triangulation(call), PLAIN


FUNCTIONS = tuple(functions())
