"""Where a plane cuts the paraboloid: the ellipse (E), the circle (C) below it, and their extents.

The names are those of Section 4: the plane z = alpha x + beta y + gamma, the vertex q, the centre
c and the radius r of (C), the distance L_cq. They are found in exact rationals and rounded to
doubles, for drawing.
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
    """The cut of a plane through three lifted points.

    Parameters
    ----------
    corners : (3, 2) ndarray of float64
        The planar points a', b', p', not on one line.
    q : tuple of float
        The vertex of the paraboloid.

    Examples
    --------
    >>> section = CrossSection(np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]]), (0.5, 0.0))
    >>> (section.center + 0.0).tolist(), section.radius, section.distance
    ([0.0, 0.0], 1.0, 0.5)
    """

    corners: Floats
    q: tuple[float, float]

    @property
    def ellipse(self) -> Ellipse:
        """(E), in exact rationals."""
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
        """L_cq, the distance of c and q."""
        return math.sqrt(self.ellipse.squared_distance)

    @property
    def box(self) -> Floats:
        """The least and the greatest coordinates on (E), [[min x, max x], ...], (3, 2) float64."""
        e = self.ellipse
        extents = [[e.min_x, e.max_x], [e.min_y, e.max_y], [e.min_z, e.max_z]]
        return np.array(extents, dtype=np.float64)

    def circle(self, count: int = 181) -> Floats:
        """Give points of (C).

        Parameters
        ----------
        count : int, default 181
            How many, the first again as the last.

        Returns
        -------
        (count, 2) ndarray of float64
            The points, counter-clockwise.

        Examples
        --------
        >>> section = CrossSection(np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]]), (0.5, 0.0))
        >>> np.hypot(*section.circle(5).T)
        array([1., 1., 1., 1., 1.])
        """
        angles = np.linspace(0, 2 * np.pi, count)
        around = np.column_stack([np.cos(angles), np.sin(angles)])
        points: Floats = self.center + self.radius * around
        return points

    def on_plane(self, points: ArrayLike) -> Floats:
        """Give the points of the plane above planar points.

        Parameters
        ----------
        points : array_like of shape (n, 2)
            Planar points.

        Returns
        -------
        (n, 3) ndarray of float64
            The same with the plane's heights.

        Examples
        --------
        >>> section = CrossSection(np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]]), (0.0, 0.0))
        >>> section.on_plane([[5.0, 7.0]])
        array([[5., 7., 1.]])
        """
        rows = np.asarray(points, dtype=np.float64)
        return np.column_stack([rows, rows @ self.plane[:2] + self.plane[2]])

    def decided_by(self, points: Floats) -> NDArray[np.str_]:
        """Name the proposition that decides each point, in the order in which Procedure 3 asks.

        Parameters
        ----------
        points : (n, 2) ndarray of float64
            Planar points.

        Returns
        -------
        (n,) ndarray of str
            ``"4.4"``, ``"4.3 (i)"`` to ``"4.3 (v)"``, or ``""`` where it takes a dot product.

        Examples
        --------
        >>> section = CrossSection(np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]]), (0.5, 0.0))
        >>> section.decided_by(np.array([[0.5, 0.1], [-2.0, 0.0], [0.9, 0.9], [-0.9, 0.9]]))
        array(['4.4', '4.3 (i)', '', '4.3 (v)'], dtype='<U9')
        """
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
