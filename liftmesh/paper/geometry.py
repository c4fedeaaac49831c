"""Section 2 of the paper in exact rationals: the plane (a, b, p), the lifting, the projection.

A plane is represented by its normal vector n and its d, as in the text. "Above", "below" and "on"
refer to the z-axis. Numbers are fractions; a float means the exact value of the double.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from numbers import Integral
from typing import Literal, TypeAlias

from liftmesh.errors import InputError

Number: TypeAlias = int | float | Fraction
Point: TypeAlias = Sequence[Number]
Exact: TypeAlias = tuple[Fraction, ...]
Position: TypeAlias = Literal["above", "on", "below"]


def exact(point: Iterable[Number]) -> Exact:
    """Convert coordinates to their exact values."""
    return tuple(fraction(value) for value in point)


def fraction(value: Number) -> Fraction:
    """Convert a number to its exact value."""
    if isinstance(value, Fraction):
        return value
    try:
        return Fraction(int(value) if isinstance(value, Integral) else float(value))
    except (ValueError, OverflowError) as error:
        raise InputError(f"a coordinate is {value!r}: give finite numbers") from error


def orient(a: Point, b: Point, c: Point) -> Fraction:
    """Twice the signed area of the planar triangle a, b, c."""
    (ax, ay), (bx, by), (cx, cy) = exact(a[:2]), exact(b[:2]), exact(c[:2])
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)


def mu(u: Point, q: Point) -> Exact:
    """Lift a planar point to the paraboloid with vertex q: Section 2, step 1."""
    (x, y), (qx, qy) = exact(u), exact(q)
    return x, y, (x - qx) ** 2 + (y - qy) ** 2


def mu_star(w: Point) -> Exact:
    """Project a point parallel to the z-axis onto the plane Oxy: Section 2, step 3."""
    return exact(w[:2])


@dataclass(frozen=True, slots=True)
class Plane:
    """The plane x n_x + y n_y + z n_z = d."""

    n: Exact
    d: Fraction

    @classmethod
    def through(cls, a: Point, b: Point, p: Point) -> Plane:
        """Construct the plane (a, b, p), with n = ab x ap."""
        (ax, ay, az), (bx, by, bz), (px, py, pz) = exact(a), exact(b), exact(p)
        ux, uy, uz = bx - ax, by - ay, bz - az
        vx, vy, vz = px - ax, py - ay, pz - az
        n = (uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx)
        return cls(n, px * n[0] + py * n[1] + pz * n[2])

    @property
    def alpha(self) -> Fraction:
        """The coefficient of x in z = alpha x + beta y + gamma; the plane must not be vertical."""
        return -self.n[0] / self.n[2]

    @property
    def beta(self) -> Fraction:
        """The coefficient of y in z = alpha x + beta y + gamma; the plane must not be vertical."""
        return -self.n[1] / self.n[2]

    @property
    def gamma(self) -> Fraction:
        """The constant of z = alpha x + beta y + gamma; the plane must not be vertical."""
        return self.d / self.n[2]

    def dot(self, v: Point) -> Fraction:
        """The paper's unit of work, n . v, for one point."""
        return sum((n * x for n, x in zip(self.n, exact(v), strict=True)), Fraction(0))

    def height(self, x: Number, y: Number) -> Fraction:
        """The height w*_z of the plane over a planar point."""
        if self.n[2] == 0:
            raise InputError("the plane is vertical (n_z = 0): nothing is above or below it")
        x, y = exact((x, y))
        return (self.d - x * self.n[0] - y * self.n[1]) / self.n[2]

    def position(self, w: Point) -> Position:
        """Classify a point as above, below or on the plane: Section 2."""
        x, y, z = exact(w)
        return _position(z - self.height(x, y))


def _position(difference: Fraction) -> Position:
    if difference > 0:
        return "above"
    return "below" if difference < 0 else "on"
