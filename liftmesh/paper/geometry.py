"""Section 2 of the paper in exact rationals: planes, the lifting, the projection, lower facets.

A plane is represented by its normal vector n and its d, as in the text. "Above", "below" and "on"
refer to the z-axis. Numbers are fractions; a float means the exact value of the double.

In the definitions P is a sequence of points in space, a facet three of its rows. Definition 2.2
requires of an affine transformation tau, which maps a polyhedron L onto a polyhedron Q, that it has
a single-valued inverse tau* whose image is a union of closed faces of L. In the paper L is CH(P), Q
the convex hull of P*, tau the projection parallel to the z-axis, and tau* maps to the lower facets.
(The paper's sentence after the definition exchanges the letters L and Q, and calls the projection
mu* the lifting.)
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from numbers import Integral
from typing import Literal, TypeAlias

from liftmesh.errors import InputError

Number: TypeAlias = int | float | Fraction
Point: TypeAlias = Sequence[Number]
Exact: TypeAlias = tuple[Fraction, ...]
Position: TypeAlias = Literal["above", "on", "below"]
Facet: TypeAlias = Sequence[int]
Polygon: TypeAlias = list[Exact]


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


def is_lower_facet(a: Point, b: Point, p: Point, points: Iterable[Point]) -> bool:
    """Definition 2.1: all points of P are on or above the plane (a, b, p)."""
    # With four coplanar points, which the paper excludes, lower facets overlap.
    plane = Plane.through(a, b, p)
    return plane.n[2] != 0 and all(plane.position(v) != "below" for v in points)


def lifted(u: Point, points: Sequence[Point], facets: Iterable[Facet]) -> Exact:
    """The lifting tau* of Definition 2.2 at one point of the planar hull."""
    # Not mu of Section 2, with which it agrees only at the points of P*: between them it follows
    # the facets, and mu the paraboloid below.
    x, y = exact(u)
    corners = [[points[i] for i in facet] for facet in facets]
    heights = {Plane.through(*abp).height(x, y) for abp in corners if _covers(abp, u)}
    if len(heights) != 1:
        raise InputError(f"{len(heights)} heights over {u!r}: no facet there, or no lower hull")
    return x, y, heights.pop()


def _covers(corners: Sequence[Point], u: Point) -> bool:
    a, b, c = corners
    signs = [orient(a, b, u), orient(b, c, u), orient(c, a, u)]
    return orient(a, b, c) != 0 and (min(signs) >= 0 or max(signs) <= 0)


def is_lifting(points: Sequence[Point], facets: Iterable[Facet]) -> bool:
    """Definition 2.2, for the projection tau = mu* of CH(P) and the inverse given by the facets."""
    # (ii) Their union is one of closed faces of CH(P) if all points are on or above each plane.
    # Then they are parts of the graph of one function, the least height of CH(P), and (i) the
    # inverse is single-valued; it is defined everywhere if nothing is left of the planar hull.
    corners = [[points[i] for i in facet] for facet in facets]
    if not all(is_lower_facet(abp[0], abp[1], abp[2], points) for abp in corners):
        return False
    hull = planar_hull(points)
    left = [hull]
    for abp in corners:
        left = [piece for polygon in left for piece in _subtract(polygon, abp)]
    return len(hull) > 2 and not left


def planar_hull(points: Iterable[Point]) -> Polygon:
    """The convex hull L of the projected points, a polygon according to the paper."""
    distinct = sorted({mu_star(p) for p in points})
    return _half_hull(distinct)[:-1] + _half_hull(distinct[::-1])[:-1]


def _half_hull(ordered: Polygon) -> Polygon:
    kept: Polygon = []
    for p in ordered:
        while len(kept) > 1 and orient(kept[-2], kept[-1], p) <= 0:
            kept.pop()
        kept.append(p)
    return kept


def _subtract(polygon: Polygon, triangle: Sequence[Point]) -> Iterator[Polygon]:
    """Subtract a triangle from a convex polygon; yield convex pieces with area."""
    a, b, c = planar_hull(triangle)
    rest, pieces = polygon, []
    for u, v in ((a, b), (b, c), (c, a)):
        pieces.append(_half(rest, v, u))
        rest = _half(rest, u, v)
    yield from [piece for piece in pieces if piece] if rest else [polygon]


def _half(polygon: Polygon, u: Exact, v: Exact) -> Polygon:
    """Return the part of a convex polygon to the left of the line uv; empty if it has no area."""
    kept: Polygon = []
    signs = [orient(u, v, w) for w in polygon]
    for i, w in enumerate(polygon):
        before = signs[i - 1]
        if before * signs[i] < 0:
            share = before / (before - signs[i])
            kept.append(tuple(s + share * (t - s) for s, t in zip(polygon[i - 1], w, strict=True)))
        if signs[i] >= 0:
            kept.append(w)
    return kept if any(sign > 0 for sign in signs) else []
