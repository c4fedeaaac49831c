"""The lemmas, propositions and the first edge of the paper, as functions in exact rationals.

Each function takes the hypotheses of a statement and returns the condition that holds, or the
conclusion, so that it can be compared with the paper. If a statement is wrong as printed, a comment
says so and the function includes the correction.

The first edge of the lower hull is found by the projection onto Oyz (Section 3). P' is P seen along
the x-axis, with Oy from right to left. (That is the view from x = -infinity; the paper says
+infinity, from where Oy runs from left to right.) v'_1 is the lowest point of P'; all of P' is on
or to the left of v'_1 v'_2, and on or to the right of v'_1 v'_n. As v'_1 is lowest, all of P' lies
within a half turn around it, from v'_2 to v'_n. So

* if v_2y < v_1y, the points are above the line v'_1 v'_2, and [v_1, v_2] is a lower edge;
* if v_1y < v_ny, the points are above the line v'_1 v'_n, and [v_1, v_n] is a lower edge.

Both hold in the paper's first case, one each in its second and third. Neither holds with equality:
the line is then vertical, and a segment on it need not be an edge.

Ties are decided by the canonical perturbation: every point is lifted by an infinitesimal amount,
infinitely more for a point that is lexicographically larger in (x, y). Then no two points are
equally low and the paper's "rightmost" is not needed, and no three points of different y are
collinear in P'.

The restricted region (Section 4), and lifted disks.

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

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cmp_to_key
from math import isqrt
from typing import Literal, TypeAlias

from liftmesh.base.frozen import cached_property
from liftmesh.errors import DegenerateInputError, InputError
from liftmesh.paper.geometry import Exact, Number, Plane, Point, Position, exact, fraction

Edge: TypeAlias = tuple[int, int]


def outward(plane: Plane, points: Iterable[Point]) -> Plane:
    """Orient the normal of a facet's plane away from P."""
    excesses = [plane.dot(v) - plane.d for v in points]
    if max(excesses, default=0) <= 0:
        return plane
    if min(excesses) < 0:
        raise InputError("P lies on both sides of the plane: it contains no facet of CH(P)")
    nx, ny, nz = plane.n
    return Plane((-nx, -ny, -nz), -plane.d)


def proposition_3_1(plane: Plane) -> Literal["(i)", "(ii)"]:
    """Proposition 3.1: a facet of CH(P) is a lower facet iff n_z < 0."""
    # Printed for n = ab x ap, whose sign depends on the order of the vertices: true of
    # `Plane.through(a, b, p)` only if n points out of CH(P), as that of `outward` does.
    return "(i)" if plane.n[2] < 0 else "(ii)"


def proposition_3_2(
    plane: Plane, v: Point, *, printed: bool = False
) -> Literal["(i)", "(ii)"] | None:
    """Proposition 3.2: what a point v implies for the facet (e, p), where n_z < 0 is required."""
    # (i) v is above; (ii) (e, p) is no lower facet on this side of e. The paper prints (ii) also
    # of v on the plane, which is wrong: a, b and p themselves are on it.
    x, y, z = exact(v)
    nx, ny, nz = plane.n
    left, right = nz * z, plane.d - x * nx - y * ny
    if nz < 0 and left < right:
        return "(i)"
    return "(ii)" if nz >= 0 or left > right or printed else None


def lemma_4_1(ellipse: Ellipse) -> tuple[Surd, Surd]:
    """Lemma 4.1: the least and the greatest z on (E)."""
    return ellipse.min_z, ellipse.max_z


def lemma_4_2(circle: Circle, t: Point) -> Position:
    """Lemma 4.2: a point of the paraboloid is above (a, b, p) iff t' is outside (C), and so on."""
    positions: dict[str, Position] = {"outside": "above", "on": "on", "inside": "below"}
    return positions[circle.position(t)]


def proposition_4_3(ellipse: Ellipse, t: Point) -> tuple[str, ...]:
    """Proposition 4.3: conditions on coordinates, each sufficient for t to be above (a, b, p)."""
    x, y, z = exact(t)
    conditions = {
        "4.3 (i)": x < ellipse.min_x,
        "4.3 (ii)": x > ellipse.max_x,
        "4.3 (iii)": y < ellipse.min_y,
        "4.3 (iv)": y > ellipse.max_y,
        "4.3 (v)": z > ellipse.max_z,
    }
    return tuple(name for name, holds in conditions.items() if holds)


def proposition_4_4(ellipse: Ellipse, t: Point) -> bool:
    """Proposition 4.4: t_z < minz_E and L_cq < r imply that t is below (a, b, p)."""
    # The paper omits L_cq > r: then q lies outside (C), and t is above, as t' is closer to q.
    q_inside = ellipse.squared_distance < ellipse.circle.squared_radius
    return q_inside and exact(t)[2] < ellipse.min_z


@dataclass(frozen=True, slots=True)
class FirstEdge:
    """Result of finding the first edge by the projection onto Oyz."""

    v1: int
    v2: int
    vn: int
    case: int
    edges: tuple[Edge, ...]


def first_edge(points: Sequence[Point]) -> FirstEdge:
    """Find edges of the lower convex hull by the projection onto Oyz."""
    rows = [exact(p) for p in points]
    v1 = min(range(len(rows)), key=lambda i: (rows[i][2], rows[i][:2]), default=0)
    if len({y for _, y, _ in rows}) < 2:
        raise DegenerateInputError("all points have the same y: there is no lower facet")
    others = [i for i, row in enumerate(rows) if row != rows[v1]]

    def before(i: int, j: int) -> int:
        return _turn(rows[v1], rows[i], rows[j])

    around = cmp_to_key(before)
    return _cases(rows, v1, min(others, key=around), max(others, key=around))


def _cases(rows: Sequence[Exact], v1: int, v2: int, vn: int) -> FirstEdge:
    y1, y2, yn = rows[v1][1], rows[v2][1], rows[vn][1]
    if y2 < y1 < yn:
        return FirstEdge(v1, v2, vn, 1, ((v1, v2), (v1, vn)))
    if y2 < y1:
        return FirstEdge(v1, v2, vn, 2, ((v1, v2),))
    return FirstEdge(v1, v2, vn, 3, ((v1, vn),))


def _turn(v1: Exact, i: Exact, j: Exact) -> int:
    """Return -1 if v'_1 v'_i precedes v'_1 v'_j on the half turn from right to left."""
    yi, yj = i[1] - v1[1], j[1] - v1[1]
    turn = yj * (i[2] - v1[2]) - yi * (j[2] - v1[2])
    return -tie_sign(turn, [(v1, yi - yj), (i, yj), (j, -yi)])


def tie_sign(value: Fraction, rises: Iterable[tuple[Exact, Fraction]]) -> int:
    """The sign of a sum of heights, each times its factor, after the canonical perturbation."""
    totals: dict[Exact, Fraction] = {}
    for point, factor in rises:
        totals[point[:2]] = totals.get(point[:2], Fraction(0)) + factor
    entering = [totals[xy] for xy in sorted(totals, reverse=True) if totals[xy] != 0]
    deciding = value or (entering[0] if entering else 0)
    return (deciding > 0) - (deciding < 0)


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
