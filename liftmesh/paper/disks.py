"""Disks on the paraboloid in exact rationals: what Section 6 of the paper names, by its Lemma 4.2.

A disk is lifted point by point. By Lemma 4.2 a lifted point is below a plane if its projection is
inside the circle (C) of the plane. So a lifted disk is above a plane if the disk and (C) are apart,
and touches it from above if they touch from outside: a plane that supports lifted disks from below,
and touches three of them, is a circle that touches three disks from outside and that no disk
enters.

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

from liftmesh.errors import InputError
from liftmesh.paper.geometry import Exact, Number, Plane, Point, Position, exact, fraction
from liftmesh.paper.region import Circle


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
