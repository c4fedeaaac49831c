"""Intersection of a plane and the paraboloid: the ellipse (E), the circle (C), and their extents.

The names are those of Section 4: the plane z = alpha x + beta y + gamma, the vertex q, the centre
c and the radius r of (C), the distance L_cq. They are computed in exact rationals and rounded to
doubles for drawing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liftmesh._typing import Floats
from liftmesh.paper.geometry import Plane, mu
from liftmesh.paper.region import Ellipse
from liftmesh.planar.lifting import lift

UNDECIDED = ""


@dataclass(frozen=True, slots=True)
class CrossSection:
    """The intersection of the paraboloid and the plane through three lifted points."""

    corners: Floats
    q: tuple[float, float]

    @property
    def ellipse(self) -> Ellipse:
        """The ellipse (E) in exact rationals."""
        a, b, p = (mu(corner, self.q) for corner in self.corners.tolist())
        return Ellipse(Plane.through(a, b, p), self.q)

    @property
    def plane(self) -> Floats:
        """alpha, beta and gamma, (3,) float64."""
        plane = self.ellipse.plane
        return np.array([plane.alpha, plane.beta, plane.gamma], dtype=np.float64)

    @property
    def center(self) -> Floats:
        """c, the centre of (C), (2,) float64."""
        return np.array(self.ellipse.circle.centre, dtype=np.float64)

    @property
    def radius(self) -> float:
        """r, the radius of (C)."""
        return math.sqrt(self.ellipse.circle.squared_radius)

    @property
    def distance(self) -> float:
        """L_cq, the distance between c and q."""
        return math.sqrt(self.ellipse.squared_distance)

    @property
    def box(self) -> Floats:
        """The least and the greatest coordinates on (E), [[min x, max x], ...], (3, 2) float64."""
        e = self.ellipse
        extents = [[e.min_x, e.max_x], [e.min_y, e.max_y], [e.min_z, e.max_z]]
        return np.array(extents, dtype=np.float64)

    def circle(self, count: int = 181) -> Floats:
        """Return points of (C)."""
        angles = np.linspace(0, 2 * np.pi, count)
        around = np.column_stack([np.cos(angles), np.sin(angles)])
        points: Floats = self.center + self.radius * around
        return points

    def on_plane(self, points: ArrayLike) -> Floats:
        """Return the points of the plane above planar points."""
        rows = np.asarray(points, dtype=np.float64)
        return np.column_stack([rows, rows @ self.plane[:2] + self.plane[2]])

    def decided_by(self, points: Floats) -> NDArray[np.str_]:
        """Return the proposition that decides each point, tested in the order of Procedure 3."""
        x, y, z = lift(points, self.q).T
        (min_x, max_x), (min_y, max_y), (min_z, max_z) = self.box
        tests = {
            "4.4": (z < min_z) & (self.distance < self.radius),
            "4.3 (i)": x < min_x,
            "4.3 (ii)": x > max_x,
            "4.3 (iii)": y < min_y,
            "4.3 (iv)": y > max_y,
            "4.3 (v)": z > max_z,
        }
        return np.select(list(tests.values()), list(tests), UNDECIDED)
