"""Heights of tiled surfaces at points: bit for bit those of `Surface.sample`.

The points are asked of the part of the surface that answers in their box (`surface_raster.py`). If
it has too many faces, the points are cut in two across the longer side of the box, so memory is
bounded by the faces of two large shards.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats, Integers
from liftmesh.base.options import Interpolation, check_option
from liftmesh.terrain.sampling import points_above
from liftmesh.terrain.surface_data import places_on
from liftmesh.tiles.surface_raster import Parts, check_in_tiles

if TYPE_CHECKING:
    from liftmesh.tiles.tiled_data import TiledSurfaceData


def heights_at(
    tiled: TiledSurfaceData, points: ArrayLike, interpolation: Interpolation, threads: int | None
) -> Floats:
    """Interpolate heights at points, (..., 2)."""
    check_option("interpolation", interpolation, Interpolation)
    check_in_tiles(interpolation)
    pairs = places_on(tiled, points)
    places = pairs.reshape(-1, 2)
    heights = np.full(len(places), np.nan)
    parts = Parts(tiled, interpolation, threads)
    waiting = [np.flatnonzero(np.isfinite(places).all(axis=1))]
    while waiting:
        rows = waiting.pop()
        part = parts.around(places[rows]) if len(rows) else 0
        if not isinstance(part, int):
            heights[rows] = part.sample(places[rows], interpolation, threads=threads)
        elif part:
            waiting += halves(rows, places)
    shaped: Floats = heights.reshape(pairs.shape[:-1])
    return shaped[()]


def heights_above(
    tiled: TiledSurfaceData, cloud: object, interpolation: Interpolation, threads: int | None
) -> Floats:
    """Compute how high points are above the faces."""
    points = points_above(tiled, cloud).points
    heights: Floats = points[:, 2] - heights_at(tiled, points[:, :2], interpolation, threads)
    return heights


def halves(rows: Integers, places: Floats) -> list[Integers]:
    """Cut points in two across the longer side of their box."""
    axis = int(np.argmax(np.ptp(places[rows], axis=0)))
    middle = len(rows) // 2
    order = np.argpartition(places[rows, axis], middle)
    return [rows[order[:middle]], rows[order[middle:]]]
