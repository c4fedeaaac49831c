"""Adaptive thinning: the rows without which linear interpolation loses most.

Of all points, the one is removed next without which the sum of the squares of the distances of all
that were removed, from the surface of those that are left, grows least. Each step looks at the star
of a point only: L. Demaret and A. Iske, "Adaptive image approximation by linear splines over
locally optimal Delaunay triangulations", 2006. Points gather where the surface bends, and along an
edge the triangles become long and thin.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Rows
from liftmesh.base.arrays import check_finite
from liftmesh.errors import InputError
from liftmesh.terrain.positions import positions_of
from liftmesh.terrain.triangulate import triangulate

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud


def most_significant(cloud: Cloud, wanted: int) -> Rows:
    """Choose the rows that adaptive thinning keeps."""
    check_finite(cloud.points, skippable=False)
    surface = triangulate(cloud)
    used, plane, hull = positions_of(surface)
    heights = np.ascontiguousarray(surface.vertices[used, 2], np.float64) + 0.0
    rows, _, _ = _kernel.thin(plane, heights, hull, min(wanted, _kernel.MOST_ROWS), None)
    if len(rows) > wanted:
        raise InputError(
            f"adaptive is {wanted}: the hull alone has {len(rows)} corners, which stay"
        )
    return np.sort(used[rows])
