"""The Delaunay graph of disks by its definition, in exact rationals and square roots.

Hidden disks are found pair by pair. The others are made smaller by concrete tiny amounts, the more
the smaller they are, and of equal ones the later they come by x, then y. Then every triple is
tried: the circles that touch its three disks solve a quadratic equation, and those that no other
disk enters are the triangles. A circle that is larger than any which the given numbers have is
infinite, but for the tiny amounts. Nothing here is shared with the program, which never solves for
a circle.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations

Row = tuple[Fraction, Fraction, Fraction]
TINY = Fraction(1, 10**30)
LARGEST = 10**15


@dataclass(frozen=True)
class Surd:
    """A number a + b sqrt(c), with c shared by all that meet."""

    a: Fraction
    b: Fraction
    c: Fraction

    def __add__(self, other: Surd | Fraction | int) -> Surd:
        if isinstance(other, Surd):
            return Surd(self.a + other.a, self.b + other.b, self.c)
        return Surd(self.a + other, self.b, self.c)

    def __mul__(self, other: Surd | Fraction | int) -> Surd:
        if isinstance(other, Surd):
            even = self.a * other.a + self.b * other.b * self.c
            return Surd(even, self.a * other.b + self.b * other.a, self.c)
        return Surd(self.a * other, self.b * other, self.c)

    def __sub__(self, other: Surd | Fraction | int) -> Surd:
        return self + other * -1

    @property
    def sign(self) -> int:
        even, odd = _sign(self.a), _sign(self.b) if self.c else 0
        if odd in (even, 0):
            return even
        return odd if even == 0 else even * _sign(self.a**2 - self.b**2 * self.c)


def _sign(value: Fraction) -> int:
    return (value > 0) - (value < 0)


def contains(a: Row, b: Row) -> bool:
    """Whether disk a contains disk b, or is equal to it."""
    return a[2] >= b[2] and (a[0] - b[0]) ** 2 + (a[1] - b[1]) ** 2 <= (a[2] - b[2]) ** 2


def apollonius(
    disks: Sequence[Sequence[float]],
) -> tuple[set[tuple[int, int, int]], set[int], set[tuple[int, int]]]:
    """Triangles from their lowest row on, hidden rows, and duplicates with their first row."""
    rows = [(Fraction(x), Fraction(y), Fraction(r)) for x, y, r in disks]
    hidden = {i for i, a in enumerate(rows) if any(a != b and contains(b, a) for b in rows)}
    first: dict[Row, int] = {}
    for i, row in enumerate(rows):
        first.setdefault(row, i)
    doubles = {(i, first[row]) for i, row in enumerate(rows) if first[row] != i and i not in hidden}
    seen = [i for i, row in enumerate(rows) if first[row] == i and i not in hidden]
    seen.sort(key=lambda i: (-rows[i][2], rows[i]))
    shrunk = {
        i: (rows[i][0], rows[i][1], rows[i][2] - TINY ** (len(seen) - place))
        for place, i in enumerate(seen)
    }
    found = {
        tuple(sorted_from_lowest(corners))
        for triple in combinations(seen, 3)
        for corners in empty_circles(triple, shrunk)
    }
    return found, hidden, doubles  # type: ignore[return-value]


def sorted_from_lowest(corners: Sequence[int]) -> list[int]:
    """Turn a triangle until its lowest row comes first."""
    at = corners.index(min(corners))
    return [*corners[at:], *corners[:at]]


def empty_circles(triple: Sequence[int], rows: dict[int, Row]) -> Iterator[tuple[int, ...]]:
    """Yield the triple in counter-clockwise order, for each empty circle that touches it."""
    for x, y, radius in circles(*(rows[i] for i in triple)):
        if (radius - LARGEST).sign > 0:
            continue
        if all(distance_sign(x, y, radius, rows[i]) >= 0 for i in rows if i not in triple):
            a, b, c = ((x - rows[i][0], y - rows[i][1], radius + rows[i][2]) for i in triple)
            yield tuple(triple) if turn(a, b, c) > 0 else (triple[0], triple[2], triple[1])


def circles(p: Row, q: Row, r: Row) -> Iterator[tuple[Surd, Surd, Surd]]:
    """Yield centre and radius of the circles that touch three disks from outside, all in a field.

    Relative to p, with R the distance of the centre: x^2 + y^2 = R^2, and each of q and r gives
    2 x dx + 2 y dy + 2 R dr = dx^2 + dy^2 - dr^2.
    """
    lines = []
    for d in (q, r):
        dx, dy, dr = (d[k] - p[k] for k in range(3))
        lines.append((2 * dx, 2 * dy, 2 * dr, dx * dx + dy * dy - dr * dr))
    (a, b, c), (e, f, g) = lines[0][:3], lines[1][:3]
    # The line of all (x, y, R) that satisfy both: a point and a direction.
    along = (b * g - c * f, c * e - a * g, a * f - b * e)
    point = a_point_on(lines, along)
    if point is None:
        return
    two, one, none = (
        quadratic(along, along),
        2 * quadratic(point, along),
        quadratic(point, point),
    )
    for root in roots(two, one, none):
        x, y, distance = (root * along[k] + point[k] for k in range(3))
        if all((distance + (d[2] - p[2])).sign > 0 for d in (p, q, r)):
            yield x + p[0], y + p[1], distance - p[2]


def quadratic(u: Sequence[Fraction], v: Sequence[Fraction]) -> Fraction:
    """Return the Lorentz product."""
    return u[0] * v[0] + u[1] * v[1] - u[2] * v[2]


def a_point_on(
    lines: Sequence[Sequence[Fraction]], along: Sequence[Fraction]
) -> list[Fraction] | None:
    """Solve for two of x, y and R, with the third zero."""
    for zero in (2, 1, 0):
        if along[zero] == 0:
            continue
        i, j = (k for k in range(3) if k != zero)
        (a, b, d), (e, f, h) = ((line[i], line[j], line[3]) for line in lines)
        point = [Fraction(0)] * 3
        point[i] = (d * f - b * h) / (a * f - b * e)
        point[j] = (a * h - d * e) / (a * f - b * e)
        return point
    return None


def roots(two: Fraction, one: Fraction, none: Fraction) -> list[Surd]:
    """Return the real solutions of two t^2 + one t + none = 0."""
    if two == 0:
        return [] if one == 0 else [Surd(-none / one, Fraction(0), Fraction(0))]
    radicand = one * one - 4 * two * none
    if radicand < 0:
        return []
    return [
        Surd(-one / (2 * two), sign / (2 * two), radicand) for sign in (Fraction(1), -Fraction(1))
    ]


def distance_sign(x: Surd, y: Surd, radius: Surd, d: Row) -> int:
    """Return the sign of the distance of a disk from a circle."""
    reach = radius + d[2]
    if reach.sign < 0:
        return 1
    across, up = x - d[0], y - d[1]
    return (across * across + up * up - reach * reach).sign


def turn(a: Sequence[Surd], b: Sequence[Surd], c: Sequence[Surd]) -> int:
    """Return the orientation of three directions from a centre, given reversed, with lengths."""
    bc, ca, ab = (u[0] * v[1] - u[1] * v[0] for u, v in ((b, c), (c, a), (a, b)))
    return (bc * a[2] + ca * b[2] + ab * c[2]).sign
