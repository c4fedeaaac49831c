"""Triangulations with constraints, as subjects to watch."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from typing import Any

import numpy as np
from constrained.families import FAMILIES, Case, Family
from growth.counting import Prepare, Work
from growth.families import Families, random

import liftmesh
from liftmesh import ConstrainedTriangulation, RefineResult, constrained_delaunay, refine


def seeded(family: Family) -> Callable[[int], Case]:
    """Make a family of a size alone."""

    def made(n: int) -> Case:
        return family(n, random())

    made.__doc__ = family.__doc__
    return made


def crossing_lines(n: int) -> Case:
    """Lines across each other: each crossing becomes a row."""
    count = max(int(n**0.5) // 2, 1)
    along, ends = np.arange(count) + random().random(count) / 2, np.full(count, count + 1.0)
    sides = [np.column_stack([along, x]) for x in (ends - count - 2, ends)]
    points = np.vstack([*sides, *(side[:, ::-1] for side in sides)])
    rows = np.arange(count)
    pairs = [np.column_stack([rows + k, rows + k + count]) for k in (0, 2 * count)]
    return points, np.concatenate(pairs).astype(np.int32)


def overlaps(n: int) -> Case:
    """Edges on top of each other along a line of points, and a triangle beside it."""
    half = np.arange(n // 2)
    points = np.zeros((2 * len(half) + 3, 2))
    points[3:, 0] = np.arange(2 * len(half))
    points[:3] = [[0, -9], [n, -9], [n / 2, -5]]
    nested = np.column_stack([half, 2 * len(half) - 1 - half]) + 3
    staggered = np.column_stack([half, half + len(half)]) + 3
    return points, np.concatenate([[[0, 1], [1, 2], [2, 0]], nested, staggered]).astype(np.int32)


CASES: Families = {name: seeded(family) for name, family in FAMILIES.items()}
RINGS: Families = {name: CASES[name] for name in ("coast", "nested rings")}
HARD = ("star", "comb", "nested rings", "strip", "zigzag")
OVERLAPS: Families = {"overlaps": overlaps}
CROSSING: Families = {"crossing lines": crossing_lines}
REFINED: dict[str, Callable[[RefineResult], object]] = {
    "angles": lambda made: made.angles,
    "histogram": lambda made: made.histogram(),
    "verify": lambda made: made.verify(threads=1),
}


def constrained(call: Callable[..., object], **options: Any) -> Prepare:
    """Prepare a call on points and edges."""

    def prepare(case: Case) -> Work:
        points, edges = case
        return Work(lambda: call(points, edges, threads=1, **options), len(points) + len(edges))

    return prepare


def verified(case: Case, triangles: Any, **options: Any) -> Work:
    """Prepare the verification of triangles with the edges of a case as constraints."""
    points, edges = case
    call = partial(liftmesh.verify, points, triangles, constraints=edges, threads=1, **options)
    return Work(call, len(points) + len(edges))


def verified_whole(case: Case) -> Work:
    return verified(case, constrained_delaunay(*case, threads=1).simplices)


def verified_carved(case: Case) -> Work:
    made = constrained_delaunay(*case, threads=1, carve="holes")
    return verified(case, made.simplices, carved=True)


def split(case: Case) -> Work:
    """Prepare the insertion of crossings."""
    points, edges = case
    rows = (len(edges) // 2) ** 2
    return Work(lambda: constrained_delaunay(points, edges, crossing="split"), rows)


def by_coordinates(points: Any, edges: Any, **options: Any) -> object:
    """Give edges as polylines."""
    return constrained_delaunay(points[:3], polylines=list(points[edges]), **options)


def polygons(case: Case) -> Work:
    """Prepare a polygon for each ring, whose edges may have any direction."""
    points, edges = case
    beside: dict[int, set[int]] = {row: set() for row in np.unique(edges).tolist()}
    for tail, head in edges.tolist():
        beside[tail].add(head)
        beside[head].add(tail)
    rings = []
    while beside:
        row, around = beside.popitem()
        rows = [row]
        while following := around & beside.keys():
            rows.append(row := following.pop())
            around = beside.pop(row)
        rings.append([points[rows]])
    return Work(lambda: liftmesh.triangulate_polygon(rings), len(points))


def located(tri: ConstrainedTriangulation) -> object:
    """Find all rows."""
    return tri.find_simplex(tri.points)


def refined(case: Case, **options: Any) -> tuple[RefineResult, int]:
    """Refine, with the size of what is made."""
    made = refine(constrained_delaunay(*case, threads=1, carve="holes"), **options)
    return made, len(case[0]) + made.triangulation.nsimplex


def refining(**options: Any) -> Prepare:
    """Prepare a refinement, whose work is by what it makes."""

    def prepare(case: Case) -> Work:
        tri = constrained_delaunay(*case, threads=1, carve="holes")
        return Work(lambda: refine(tri, **options), refined(case, **options)[1])

    return prepare


def on_refined(call: Callable[[RefineResult], object]) -> Prepare:
    """Prepare a call on what was refined."""

    def prepare(case: Case) -> Work:
        made, size = refined(case)
        return Work(lambda: call(made), size)

    return prepare


def refused(tri: ConstrainedTriangulation) -> None:
    """Ask for a lower hull, which there is none of."""
    with suppress(liftmesh.InputError):
        tri.lifted()


def on_triangulation(call: Callable[..., object], **options: Any) -> Prepare:
    """Prepare a call on a fresh copy of a triangulation."""

    def prepare(case: Case) -> Work:
        made = constrained_delaunay(*case, threads=1, **options)
        return Work(lambda: call(copy.copy(made)), len(case[0]))

    return prepare


def subjects() -> Iterator[tuple[Any, ...]]:
    """Name, families, preparation and counted families."""
    plain, name = constrained(constrained_delaunay), "ConstrainedTriangulation"
    yield "constrained_delaunay", CASES, plain, ("tiling", *HARD)
    carved = constrained(constrained_delaunay, carve="holes", order="canonical")
    yield "constrained_delaunay carved", RINGS, carved, ("nested rings",)
    yield "triangulate_polygon", RINGS, polygons, ("nested rings",)
    yield "constrained_delaunay by coordinates", CASES, constrained(by_coordinates), ("tiling",)
    yield "constrained_delaunay split", CROSSING, split
    yield "verify with constraints", CASES, verified_whole, ("tiling", *HARD)
    yield "verify carved", RINGS, verified_carved, ("nested rings",)
    on_line = lambda case: verified(case, liftmesh.delaunay(case[0]).simplices)  # noqa: E731
    yield "verify with overlaps", OVERLAPS, on_line
    beside = lambda case: verified(case, [[0, 1, 2]], carved=True)  # noqa: E731
    yield "verify with overlaps outside", OVERLAPS, beside
    yield (
        "Triangulation.find_simplex of carved rings",
        RINGS,
        on_triangulation(located, carve="holes"),
        ("nested rings",),
    )
    for key in ("is_constrained", "regions", "repeated"):
        call = on_triangulation(lambda tri, key=key: getattr(tri, key))
        yield f"{name}.{key}", CASES, call, ("nested rings",)
    yield "refine", RINGS, refining(), ("nested rings",)
    sizes = refining(size=lambda places: 0.1 + abs(places[:, 0]))
    yield "refine by size", RINGS, sizes, ("nested rings",)
    yield "refine conforming", RINGS, refining(conforming=True), ("nested rings",)
    yield "refine smooth", RINGS, refining(smooth=3), ("nested rings",)
    for key, asked in REFINED.items():
        yield f"RefineResult.{key}", RINGS, on_refined(asked), ("nested rings",)
    often = on_refined(lambda made: [made.to_cloud() for _ in range(64)])
    yield "RefineResult.to_cloud", RINGS, often, ()
    marked = on_triangulation(lambda tri: tri.to_cloud(markers=np.arange(len(tri.input_edges))))
    yield f"{name}.to_cloud", CASES, marked, ("nested rings",)
    yield f"{name}.inputs_of", CASES, on_triangulation(lambda tri: tri.inputs_of(0)), ()
    yield f"{name}.to_scipy", CASES, on_triangulation(lambda tri: tri.to_scipy()), ()
    yield f"{name}.lifted", CASES, on_triangulation(refused), ()


CONSTRAINED = tuple(subjects())
