"""matplotlib: conversion of planar triangles to ``matplotlib.tri.Triangulation``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from liftmesh._typing import Floats, Rows
from liftmesh.optional import load

if TYPE_CHECKING:
    import matplotlib.tri


def to_triangulation(x: Floats, y: Floats, triangles: Rows) -> matplotlib.tri.Triangulation:
    """Convert planar triangles to a ``Triangulation`` for matplotlib's plots and interpolators.

    Parameters
    ----------
    x, y : (n,) ndarray of float64
        Planar coordinates; rows in no triangle may hold any value.
    triangles : (m, 3) ndarray of int32
        Rows of ``x`` and ``y``.

    Returns
    -------
    matplotlib.tri.Triangulation
        The argument of ``triplot``, ``tripcolor``, ``tricontourf`` and the interpolators.

    Raises
    ------
    MissingDependencyError
        matplotlib is not installed.

    Examples
    --------
    >>> import numpy as np
    >>> corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    >>> triangles = np.array([[0, 1, 2]], dtype=np.int32)
    >>> to_triangulation(corners[:, 0], corners[:, 1], triangles).triangles
    array([[0, 1, 2]], dtype=int32)
    """
    tri = load("matplotlib.tri", extra="plot")
    triangulation: matplotlib.tri.Triangulation = tri.Triangulation(x, y, triangles)
    return triangulation
