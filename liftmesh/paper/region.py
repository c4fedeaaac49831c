"""Section 4 of the paper in exact rationals: the restricted region of a plane, and lifted disks.

A plane that is not vertical intersects the paraboloid z = (x - q_x)^2 + (y - q_y)^2 in an ellipse
(E), whose projection onto Oxy is the circle (C). The extents of (E) along the three axes classify
points by comparing coordinates alone. They contain square roots, for example minx_E = c_x - r; no
root is computed here: a `Surd` compares exactly, and is converted to a float for drawing.
"Outside", "inside" and "on" refer to the plane Oxy.

Section 6 names disks on the paraboloid. A disk is lifted point by point. By Lemma 4.2 a lifted
point is below a plane if its projection is inside the circle (C) of the plane. So a lifted disk is
above a plane if the disk and (C) are apart, and touches it from above if they touch from outside: a
plane that supports lifted disks from below, and touches three of them, is a circle that touches
three disks from outside and that no disk enters.

**Proposition.** The planes that support all lifted disks from below and touch three of them, or
more, belong to the finite triangles of `liftmesh.apollonius` whose circle has a positive radius. If
the disks are disjoint, these are all finite triangles.

The circle of a triangle may have a negative radius where three disks overlap: then it lies in all
three, and the points inside it are lifted below its plane. Such triangles have no plane: the hull
of the lifted disks misses them.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import isqrt
from typing import Literal

from liftmesh.base.frozen import cached_property
from liftmesh.errors import InputError
from liftmesh.paper.geometry import Exact, Number, Plane, Point, Position, exact, fraction


@dataclass(frozen=True, slots=True, eq=False)
class Surd:
    """A rational plus or minus the square root of a rational, compared exactly."""

    # t < c + s means t - c < s, where s^2 is known. As x |x| increases with x, this is equivalent
    # to (t - c) |t - c| < s |s|, which is rational. So c_x - r is Surd(c_x, -r_squared).
    rational: Fraction
    square: Fraction  # negative if the root is subtracted

    def compare(self, value: Number) -> int:
        """Compare with a rational number."""
        difference = fraction(value) - self.rational
        gap = self.square - difference * abs(difference)
        return (gap > 0) - (gap < 0)

    def __lt__(self, value: Number) -> bool:
        return self.compare(value) < 0

    def __le__(self, value: Number) -> bool:
        return self.compare(value) <= 0

    def __gt__(self, value: Number) -> bool:
        return self.compare(value) > 0

    def __ge__(self, value: Number) -> bool:
        return self.compare(value) >= 0

    def __float__(self) -> float:
        digits = 256  # binary digits: more than c - r can lose if q is far away
        top, bottom = self.square.numerator, self.square.denominator
        root = Fraction(isqrt(abs(top) * bottom << 2 * digits), bottom << digits)
        return float(self.rational + (root if top > 0 else -root))


@dataclass(frozen=True, slots=True)
class Circle:
    """The circle (C): the projection of (E) onto Oxy."""

    centre: Exact
    squared_radius: Fraction  # negative if the plane does not meet the paraboloid

    @classmethod
    def of(cls, plane: Plane, q: Point) -> Circle:
        """Project the intersection of a plane with the paraboloid: Section 4."""
        (qx, qy), alpha, beta = exact(q), plane.alpha, plane.beta
        squared = alpha * qx + beta * qy + (alpha**2 + beta**2) / 4 + plane.gamma
        return cls((qx + alpha / 2, qy + beta / 2), squared)

    def position(self, t: Point) -> Literal["outside", "on", "inside"]:
        """Classify a point by its projection, relative to the circle."""
        (x, y), (cx, cy) = exact(t[:2]), self.centre
        difference = (x - cx) ** 2 + (y - cy) ** 2 - self.squared_radius
        if difference > 0:
            return "outside"
        return "inside" if difference < 0 else "on"


@dataclass(frozen=True)
class Ellipse:
    """The ellipse (E) in which a plane intersects the paraboloid, with its six extents."""

    # Those along z are the squares of L_cq - r and L_cq + r of Lemma 4.1, multiplied out to the
    # surds (L_cq^2 + r^2) -+ sqrt(4 L_cq^2 r^2).

    plane: Plane
    q: Point

    @cached_property
    def circle(self) -> Circle:
        """Its projection, the circle (C)."""
        return Circle.of(self.plane, self.q)

    @cached_property
    def squared_distance(self) -> Fraction:
        """The square of L_cq, the distance from the centre of (C) to q."""
        return (self.plane.alpha**2 + self.plane.beta**2) / 4

    @property
    def min_x(self) -> Surd:
        """The least x, c_x - r."""
        return self._extent(0, -1)

    @property
    def max_x(self) -> Surd:
        """The greatest x, c_x + r."""
        return self._extent(0, 1)

    @property
    def min_y(self) -> Surd:
        """The least y, c_y - r."""
        return self._extent(1, -1)

    @property
    def max_y(self) -> Surd:
        """The greatest y, c_y + r."""
        return self._extent(1, 1)

    @property
    def min_z(self) -> Surd:
        """The least z, (L_cq - r)^2."""
        return self._extent(2, -1)

    @property
    def max_z(self) -> Surd:
        """The greatest z, (L_cq + r)^2."""
        return self._extent(2, 1)

    def _extent(self, axis: int, sign: int) -> Surd:
        circle, distance = self.circle, self.squared_distance
        squared = circle.squared_radius
        if axis == 2:
            return Surd(distance + squared, sign * 4 * distance * squared)
        return Surd(circle.centre[axis], sign * squared)


@dataclass(frozen=True, slots=True)
class Disk:
    """A disk in the plane Oxy, to be lifted."""

    centre: Exact
    radius: Fraction

    @classmethod
    def of(cls, centre: Point, radius: Number) -> Disk:
        """Make a disk of exact numbers."""
        if radius < 0:
            raise InputError(f"the radius is {radius}: radii are not negative")
        return cls(exact(centre), fraction(radius))


def position_of_disk(plane: Plane, disk: Disk, q: Point = (0, 0)) -> Position:
    """Where a lifted disk is, by Lemma 4.2: above a plane, on it, or in part below."""
    circle = Circle.of(plane, q)
    (cx, cy), (x, y) = circle.centre, disk.centre
    apart = (x - cx) ** 2 + (y - cy) ** 2
    if circle.squared_radius < 0:
        return "above"
    # apart >= (r + radius)^2, with the root of r^2 on one side and squared.
    rest = apart - circle.squared_radius - disk.radius**2
    gap = rest * abs(rest) - 4 * circle.squared_radius * disk.radius**2
    return "above" if gap > 0 else "below" if gap < 0 else "on"


def plane_of_circle(centre: Point, radius: Number, q: Point = (0, 0)) -> Plane:
    """The plane whose circle (C) is given."""
    (cx, cy), (qx, qy) = exact(centre), exact(q)
    alpha, beta = 2 * (cx - qx), 2 * (cy - qy)
    squared = fraction(radius) ** 2
    gamma = squared - alpha * qx - beta * qy - (alpha**2 + beta**2) / 4
    return Plane((alpha, beta, Fraction(-1)), -gamma)
