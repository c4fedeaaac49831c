"""A triangulation and what may be wrong with it, to count what `verify` takes."""

from __future__ import annotations

import numpy as np
from growth.counting import Work
from numpy.typing import NDArray

import liftmesh
from liftmesh import _kernel

Triangles = NDArray[np.int32]


def one_turned(right: Triangles) -> Triangles:
    turned = right.copy()
    turned[len(right) // 3] = turned[len(right) // 3, ::-1]
    return turned


FLAWS = {
    "none": lambda right: right,
    "a hole": lambda right: np.delete(right, len(right) // 2, axis=0),
    "one twice": lambda right: np.concatenate([right, right[len(right) // 2 :][:1]]),
    "all clockwise": lambda right: np.ascontiguousarray(right[:, ::-1]),
    "one clockwise": one_turned,
}


def prepare(flaw: str) -> Work:
    """Make a call on a mesh with one flaw."""
    points = np.random.default_rng(7).random((20_000, 2))
    triangles = FLAWS[flaw](liftmesh.delaunay(points).simplices)
    return Work(
        lambda: _kernel.verify(points, triangles, False, 1, False, None, "delaunay", np.empty(0)),
        len(points),
    )
