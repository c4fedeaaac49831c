"""A small correct triangulation, and ways to damage it that every checker must detect."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import liftmesh

Rows = NDArray[np.int32]

POINTS = np.random.default_rng(5).random((40, 2))


def flipped(simplices: Rows) -> Rows:
    """Exchange the diagonal of the first convex quadrilateral for the other one."""
    neighbors = liftmesh.delaunay(POINTS).neighbors
    for row, other in zip(*np.nonzero(neighbors >= 0), strict=True):
        a, b, c = np.roll(simplices[row], -other)
        (d,) = set(simplices[neighbors[row, other]]) - {b, c}
        pair = np.array([[a, b, d], [a, d, c]], dtype=np.int32)
        if (liftmesh.orient2d(*np.moveaxis(POINTS[pair], 1, 0)) > 0).all():
            return np.vstack((np.delete(simplices, [row, neighbors[row, other]], axis=0), pair))
    raise AssertionError("no edge can be flipped")


def without_a_point() -> Rows:
    """Triangulate all points but the one nearest to the middle, with their own rows."""
    inner = np.argmin(np.linalg.norm(POINTS - 0.5, axis=1))
    kept = np.delete(np.arange(len(POINTS)), inner)
    return kept[liftmesh.delaunay(POINTS[kept]).simplices].astype(np.int32)
