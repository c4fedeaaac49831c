"""The corners of faces in an order that depends on coordinates alone: by x, then y.

What is computed from corners in this order has the same bits for every order of the rows.
"""

from __future__ import annotations

import numpy as np

from liftmesh._typing import Array, Floats


def ranks(corners: Floats) -> Array:
    """Order the corners of each face."""
    by_y = np.argsort(corners[..., 1], axis=1, kind="stable")
    by_x = np.argsort(np.take_along_axis(corners[..., 0], by_y, 1), axis=1, kind="stable")
    return np.take_along_axis(by_y, by_x, axis=1)


def ordered(corners: Floats) -> Floats:
    """Put the corners of each face into that order."""
    return np.take_along_axis(corners, ranks(corners)[..., None], axis=1)
