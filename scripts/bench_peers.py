"""The programs that are timed, each in its fastest single-threaded way from Python.

A peer is imported when it is first run, so a fresh process loads no other one. Its triangles are
what it returns; every page of what it made has been read by then.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import version

import numpy as np
from distributions import Points
from numpy.typing import NDArray

Triangles = NDArray[np.int32]
PAGE = 512


@dataclass(frozen=True)
class Peer:
    """A program and its way from points to triangles."""

    name: str
    package: str
    triangulate: Callable[[Points], Triangles]

    @property
    def version(self) -> str:
        return version(self.package)


def touched(*arrays: Triangles) -> Triangles:
    """Read one value of each page, so that no lazily mapped memory escapes the clock."""
    for array in arrays:
        array.reshape(-1)[::PAGE].sum()
    return arrays[0]


def liftmesh(points: Points) -> Triangles:
    triangulation = import_module("liftmesh").delaunay(points)
    return touched(triangulation.simplices, triangulation.neighbors)


def lfres_indexed(points: Points) -> Triangles:
    triangulation = import_module("liftmesh").delaunay(points, method="lfres-indexed")
    return touched(triangulation.simplices, triangulation.neighbors)


def shull(points: Points) -> Triangles:
    triangulation = import_module("shull").Delaunay(points)
    return touched(triangulation.simplices, triangulation.neighbors)


def triangle(points: Points) -> Triangles:
    return touched(import_module("triangle").delaunay(points))


def scipy(points: Points) -> Triangles:
    triangulation = import_module("scipy.spatial").Delaunay(points)
    return touched(triangulation.simplices, triangulation.neighbors)


OURS = "liftmesh"
RIVALS = ("shull", "triangle", "scipy")
PEERS = {
    peer.name: peer
    for peer in (
        Peer(OURS, OURS, liftmesh),
        Peer("lfres-indexed", OURS, lfres_indexed),
        Peer("shull", "shull", shull),
        Peer("triangle", "triangle", triangle),
        Peer("scipy", "scipy", scipy),
    )
}
