"""The distinct positions of a surface, as the kernel takes them to choose among."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Floats, Rows

if TYPE_CHECKING:
    from liftmesh.terrain.surface import Surface


def positions_of(surface: Surface) -> tuple[Rows, Floats, Rows]:
    """Return the rows in use, their planar positions, and which of these are on the hull."""
    is_used = np.ones(len(surface.vertices), np.bool_)
    is_used[surface.report.left_out] = False
    used = np.flatnonzero(is_used).astype(np.int32)
    place = np.empty(len(is_used), np.int32)
    place[used] = np.arange(len(used), dtype=np.int32)
    points = np.ascontiguousarray(surface.triangulation.points[used], np.float64) + 0.0
    return used, points, place[surface.triangulation.convex_hull[:, 0]]
