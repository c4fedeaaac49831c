"""matplotlib: conversion of planar triangles to ``matplotlib.tri.Triangulation``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from liftmesh._typing import Floats, Rows
from liftmesh.optional import load

if TYPE_CHECKING:
    import matplotlib.tri


def to_triangulation(x: Floats, y: Floats, triangles: Rows) -> matplotlib.tri.Triangulation:
    """Convert planar triangles to a ``Triangulation`` for matplotlib's plots and interpolators."""
    tri = load("matplotlib.tri", extra="plot")
    triangulation: matplotlib.tri.Triangulation = tri.Triangulation(x, y, triangles)
    return triangulation
