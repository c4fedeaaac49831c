"""The centres of a raster, to count what locating them takes the first time and again."""

from __future__ import annotations

import numpy as np
from growth.counting import Work

import liftmesh


def prepare(call: str) -> Work:
    """Make the ``"first"`` call on a triangulation, or the ``"second"``."""
    tri = liftmesh.delaunay(np.random.default_rng(8).random((40_000, 2)), threads=1)
    raster = (np.indices((180, 180)).reshape(2, -1).T + 0.5) / 180
    if call == "second":
        tri.find_simplex(raster)
    return Work(lambda: tri.find_simplex(raster), len(raster))
