"""Parts of tiled surfaces, cut along polygons: bit for bit those of `Surface.clip`.

The faces that touch the box of the polygon are read. Inside of the polygon nothing else is cut, and
by heredity the triangulation of their corners has them (`surface_raster.py`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Progress
from liftmesh.errors import InputError
from liftmesh.terrain.clipping import clip, polygons_over, sides_of
from liftmesh.tiles.surface_raster import part_of, touching

if TYPE_CHECKING:
    from liftmesh.terrain.surface import Surface
    from liftmesh.tiles.tiled_data import TiledSurfaceData


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
