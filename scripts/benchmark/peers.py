"""The programs that are timed, each called in its fastest way from Python.

`prepare` imports the program and returns the call that is timed, from points to the arrays that the
program makes. For a program that numbers vertices in its own way, the conversion to rows of the
points is not timed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import version
from typing import Any

import numpy as np
from distributions import Points
from numpy.typing import NDArray

Triangles = NDArray[np.int32]
Outputs = tuple[NDArray[Any], ...]
Call = Callable[[Points], Outputs]

SMALLEST = 5e-324
PAGE = 4096


@dataclass(frozen=True)
class Peer:
    """A program: its package, its call, its colour in plots, and whether it can use threads."""

    name: str
    package: str
    prepare: Callable[[int], Call]
    color: str
    parallel: bool = False
    rows: Callable[[Outputs, Points], Outputs] = lambda outputs, _: outputs
    triangulates: bool = True

    @property
    def version(self) -> str:
        return version(self.package)


def touch(outputs: Outputs) -> None:
    """Read a value of each page, so that the time includes lazily mapped memory."""
    for array in outputs:
        if array.nbytes > PAGE:
            array[:: max(1, PAGE // array.strides[0])].max()


def liftmesh(threads: int, **options: Any) -> Call:
    delaunay = import_module("liftmesh").delaunay

    def call(points: Points) -> Outputs:
        triangulation = delaunay(points, threads=threads, **options)
        return triangulation.simplices, triangulation.neighbors

    return call


def lfres_indexed(_: int) -> Call:
    delaunay = import_module("liftmesh").delaunay

    def call(points: Points) -> Outputs:
        triangulation = delaunay(points, algorithm="lfres-indexed")
        return triangulation.simplices, triangulation.neighbors

    return call


def with_progress(threads: int) -> Call:
    """Prepare liftmesh with a callback that records the progress."""
    shares: list[float] = []
    return liftmesh(threads, progress=shares.append)


def shull(threads: int) -> Call:
    delaunay = import_module("shull").Delaunay

    def call(points: Points) -> Outputs:
        triangulation = delaunay(points, parallel=threads > 1)
        return triangulation.simplices, triangulation.neighbors

    return call


def triangle(_: int) -> Call:
    delaunay = import_module("triangle").delaunay
    return lambda points: (delaunay(points),)


def scipy(_: int) -> Call:
    delaunay = import_module("scipy.spatial").Delaunay

    def call(points: Points) -> Outputs:
        triangulation = delaunay(points)
        return triangulation.simplices, triangulation.neighbors

    return call


def pythoncdt(_: int) -> Call:
    cdt = import_module("pythoncdt")
    order = cdt.VertexInsertionOrder.AUTO
    crossings = cdt.IntersectingConstraintEdges.NOT_ALLOWED

    def call(points: Points) -> Outputs:
        triangulation = cdt.Triangulation(order, crossings, 0.0)
        triangulation.insert_vertices(points)
        triangulation.erase_super_triangle()
        return (triangulation.triangles_array()["vertices"],)

    return call


def startinpy(_: int) -> Call:
    terrain = import_module("startinpy").DT

    def call(points: Points) -> Outputs:
        made = terrain()
        made.snap_tolerance = SMALLEST
        made.insert(np.column_stack((points, np.zeros(len(points)))))
        return made.triangles, made.points

    return call


def rows_by_position(outputs: Outputs, points: Points) -> Outputs:
    """Replace a program's own vertex numbers by the first rows at the same positions."""
    triangles, vertices = outputs
    positions = np.ascontiguousarray(points + 0.0).view(complex).reshape(-1)
    order = np.argsort(positions, kind="stable")
    sought = np.ascontiguousarray(vertices[:, :2]).view(complex).reshape(-1)
    found = np.searchsorted(positions, sought, sorter=order)
    return (order[found.clip(max=len(points) - 1)][triangles],)


def matplotlib(_: int) -> Call:
    triangulation = import_module("matplotlib.tri").Triangulation
    return lambda points: (triangulation(points[:, 0], points[:, 1]).triangles,)


def igl_triangle(_: int) -> Call:
    triangulate = import_module("igl.triangle").triangulate
    return lambda points: (triangulate(points, flags="cQ")[1],)


def numpy_sort(_: int) -> Call:
    """Prepare the sort of one coordinate, a yardstick."""
    return lambda points: (np.sort(points[:, 0]),)


def cgal(_: int) -> Call:
    raise NotImplementedError("CGAL is a program of its own")


OURS, BEFORE, CGAL, SORT = "liftmesh", "liftmesh before", "CGAL", "numpy.sort"
PEERS = {
    peer.name: peer
    for peer in (
        Peer(OURS, OURS, liftmesh, "#d1495b", parallel=True),
        Peer(BEFORE, OURS, liftmesh, "#9a8c98", parallel=True),
        Peer("liftmesh progress", OURS, with_progress, "#e5989b", parallel=True),
        Peer("lfres-indexed", OURS, lfres_indexed, "#8d5a97"),
        Peer(CGAL, "", cgal, "#00798c"),
        Peer("shull", "shull", shull, "#edae49", parallel=True),
        Peer("triangle", "triangle", triangle, "#30638e"),
        Peer("igl.triangle", "libigl", igl_triangle, "#7fa7c9"),
        Peer("pythoncdt", "pythoncdt", pythoncdt, "#66a182"),
        Peer("scipy", "scipy", scipy, "#5c5c5c"),
        Peer("matplotlib", "matplotlib", matplotlib, "#a3a3a3"),
        Peer("startinpy", "startinpy", startinpy, "#b58d6e", rows=rows_by_position),
        Peer(SORT, "numpy", numpy_sort, "#c9c9c9", triangulates=False),
    )
}
RIVALS = tuple(name for name, peer in PEERS.items() if peer.triangulates and peer.package != OURS)
