"""The corners of faces in an order that depends on coordinates alone: by x, then y.

What is computed from corners in this order has the same bits for every order of the rows.
"""

from __future__ import annotations

import numpy as np

from liftmesh._typing import Array, Floats


def ranks(corners: Floats) -> Array:
    """Order the corners of each face.

    Parameters
    ----------
    corners : (m, 3, 2) ndarray of float64
        Planar coordinates.

    Returns
    -------
    (m, 3) ndarray of int
        For each face the places of its corners, by x, then y.

    Examples
    --------
    >>> ranks(np.array([[[1.0, 0.0], [0.0, 2.0], [0.0, 1.0]]])).tolist()
    [[2, 1, 0]]
    """
    by_y = np.argsort(corners[..., 1], axis=1, kind="stable")
    by_x = np.argsort(np.take_along_axis(corners[..., 0], by_y, 1), axis=1, kind="stable")
    return np.take_along_axis(by_y, by_x, axis=1)


def ordered(corners: Floats) -> Floats:
    """Put the corners of each face into that order.

    Parameters
    ----------
    corners : (m, 3, 2) ndarray of float64
        Planar coordinates.

    Returns
    -------
    (m, 3, 2) ndarray of float64
        The same, by x, then y.

    Examples
    --------
    >>> ordered(np.array([[[1.0, 0.0], [0.0, 2.0], [0.0, 1.0]]])).tolist()
    [[[0.0, 1.0], [0.0, 2.0], [1.0, 0.0]]]
    """
    return np.take_along_axis(corners, ranks(corners)[..., None], axis=1)
