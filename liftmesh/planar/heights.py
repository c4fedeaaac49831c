"""What the rows of a triangulation are lifted to, in floating point.

A triangulation is the lower hull of lifted points, seen from above. Points are lifted to z = |p|^2,
or to the quadratic form of a metric; weights lower them. These numbers are rounded, and shown to
those who ask for the lifted points: no triangle depends on them, for the kernel decides by exact
signs of the coordinates, the weights, the radii and the metric themselves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftmesh._typing import Floats, Rows
from liftmesh.planar.lifting import lift


@dataclass(frozen=True, slots=True, eq=False)
class Heights:
    """The heights of points: those of a paraboloid or a metric, less the weights."""

    metric: Floats | None = None
    weights: Floats | None = None
    radii: Floats | None = None

    def lifted(self, points: Floats, q: tuple[float, float] = (0.0, 0.0)) -> Floats:
        """Lift points without weight."""
        if self.metric is None:
            return lift(points, q)
        placed = np.empty((len(points), 3))
        placed[:, :2] = points
        with np.errstate(all="ignore"):
            placed[:, 2] = self._product(points - q, points - q)
        return placed

    def lifted_rows(self, points: Floats, q: tuple[float, float] = (0.0, 0.0)) -> Floats:
        """Lift the rows, each lowered by its weight."""
        lifted = self.lifted(points, q)
        with np.errstate(all="ignore"):
            if self.weights is not None:
                lifted[:, 2] -= self.weights
            elif self.radii is not None:
                lifted[:, 2] -= self.radii * self.radii
        return lifted

    def planes(self, points: Floats, simplices: Rows) -> Floats:
        """Compute the planes of lifted triangles."""
        a, b, c = (points[corner] for corner in simplices.T)
        u, v = b - a, c - a
        with np.errstate(all="ignore"):
            rise_u = self._product(u, a + b) - self._lowering(*simplices[:, :2].T)
            rise_v = self._product(v, a + c) - self._lowering(*simplices[:, ::2].T)
            area = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
            slope_x = (rise_u * v[:, 1] - rise_v * u[:, 1]) / area
            slope_y = (rise_v * u[:, 0] - rise_u * v[:, 0]) / area
            at_a = self._product(a, a) - self._lowering(None, simplices[:, 0])
            height = at_a - slope_x * a[:, 0] - slope_y * a[:, 1]
            planes = np.stack([slope_x, slope_y, np.full_like(area, -1.0), height], axis=1)
            unit: Floats = planes / np.sqrt(slope_x**2 + slope_y**2 + 1)[:, None]
        return unit

    def _product(self, u: Floats, v: Floats) -> Floats:
        """Inner products of vectors, row by row."""
        product: Floats = (u * (v if self.metric is None else v @ self.metric)).sum(axis=1)
        return product

    def _lowering(self, start: Rows | None, end: Rows) -> Floats | float:
        """By how much rows are lowered more than others, or than points without weight."""
        if self.weights is not None:
            return self.weights[end] - (0.0 if start is None else self.weights[start])
        if self.radii is None:
            return 0.0
        first = 0.0 if start is None else self.radii[start]
        return (self.radii[end] - first) * (self.radii[end] + first)
