"""Linear interpolation in space: the mean of the values of four corners, by volumes.

The weight of a corner is the volume that the place spans with the other three. Volumes are rounded,
from offsets of the place, which are scaled by powers of two; corners are taken in lexicographic
order, so that a value has the same bits in any order of the rows. At a corner it is the corner's.
"""

from __future__ import annotations

import numpy as np

from liftmesh._typing import Array, Floats, Rows


def interpolated(points: Floats, corners: Rows, places: Floats, values: Array) -> Floats:
    """Return the values, (k, ...), at places in tetrahedra of these corners."""
    axes = points.take(corners, axis=0)
    order = np.lexsort((axes[:, :, 2], axes[:, :, 1], axes[:, :, 0]), axis=1)
    corners = np.take_along_axis(corners, order, axis=1)
    weights = _weights(points.take(corners, axis=0), places)
    shaped = weights.reshape(*weights.shape, *[1] * (values.ndim - 1))
    with np.errstate(all="ignore"):
        parts = np.where(shaped == 0, 0.0, shaped * values.take(corners, axis=0))
        found: Floats = parts[:, 0] + parts[:, 1] + parts[:, 2] + parts[:, 3]
    return found


def _weights(corners: Floats, places: Floats) -> Floats:
    """Return the share of each corner, (k, 4)."""
    half = corners / 2 - places[:, None] / 2  # differences of doubles may overflow
    exponents = np.frexp(np.abs(half).max(axis=(1, 2), initial=0))[1]
    offsets = np.ldexp(half, -exponents[:, None, None])
    shares = np.stack([np.abs(_volumes(np.delete(offsets, k, axis=1))) for k in range(4)], axis=1)
    with np.errstate(all="ignore"):
        whole = shares[:, 0] + shares[:, 1] + shares[:, 2] + shares[:, 3]
        weights: Floats = shares / whole[:, None]
    weights[whole == 0] = 0.25  # so flat that all volumes vanish
    return weights


def _volumes(three: Floats) -> Floats:
    """Return determinants of rows, (k, 3, 3)."""
    (a, b, c), (d, e, f), (g, h, i) = np.moveaxis(three, 0, 2)
    found: Floats = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    return found
