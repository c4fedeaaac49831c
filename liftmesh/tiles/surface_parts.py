"""Heights of tiled surfaces at points, and what is in polygons: bit for bit those of a `Surface`.

The points are asked of the part of the surface that answers in their box (`surface_raster.py`). If
it has too many faces, the points are cut in two across the longer side of the box, so memory is
bounded by the faces of two large shards.

Of a polygon, the faces that touch the box are read. Inside of the polygon nothing else is cut, and
by heredity the triangulation of their corners has them (`surface_raster.py`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats, Integers, Progress
from liftmesh.base.options import Interpolation, check_option
from liftmesh.errors import InputError
from liftmesh.terrain.clipping import clip, polygons_over, sides_of
from liftmesh.terrain.sampling import points_above
from liftmesh.terrain.surface_data import places_on
from liftmesh.tiles.surface_raster import Parts, check_in_tiles, part_of, touching

if TYPE_CHECKING:
    from liftmesh.terrain.surface import Surface
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


def clipped(
    tiled: TiledSurfaceData, polygon: object, threads: int | None, progress: Progress | None
) -> Surface:
    """Read what is in the box of a polygon, and cut it."""
    corners = np.concatenate(sides_of(polygons_over(tiled, polygon)))
    box = (*corners.min(axis=0).tolist(), *corners.max(axis=0).tolist())
    part = part_of(tiled, touching(tiled, box), 1 << 31, threads, with_values=True)
    if isinstance(part, int):
        raise InputError("no face is left: give a polygon over the faces")
    return clip(part, polygon, progress=progress)
