"""Surfaces in rationals: which closed faces contain a point, and their heights there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cmp_to_key

Point = tuple[Fraction, Fraction]
Face = tuple[Point, Point, Point]


def exact_point(values: Sequence[float]) -> Point:
    return Fraction(values[0]), Fraction(values[1])


def turn(a: Point, b: Point, c: Point) -> Fraction:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


class ExactSurface:
    """Faces over rows with heights, counter-clockwise, as a caller sees them."""

    def __init__(self, planar, heights, faces) -> None:
        self.points = [exact_point(row) for row in planar.tolist()]
        self.heights = [Fraction(z) for z in heights.tolist()]
        self.faces = [tuple(face) for face in faces.tolist()]

    def containing(self, query: Point) -> Iterator[int]:
        for number, face in enumerate(self.faces):
            a, b, c = (self.points[row] for row in face)
            if turn(a, b, query) >= 0 and turn(b, c, query) >= 0 and turn(c, a, query) >= 0:
                yield number

    def height(self, query: Point) -> Fraction | None:
        """The height by the first face that contains the point: all give the same number."""
        number = next(self.containing(query), None)
        return None if number is None else self.height_in(number, query)

    def height_in(self, number: int, query: Point) -> Fraction:
        a, b, c = (self.points[row] for row in self.faces[number])
        za, zb, zc = (self.heights[row] for row in self.faces[number])
        weighted = turn(query, b, c) * za + turn(a, query, c) * zb + turn(a, b, query) * zc
        return weighted / turn(a, b, c)

    def gradient_of(self, number: int) -> Point:
        a, b, c = (self.points[row] for row in self.faces[number])
        za, zb, zc = (self.heights[row] for row in self.faces[number])
        area = turn(a, b, c)
        x = (zb - za) * (c[1] - a[1]) - (zc - za) * (b[1] - a[1])
        y = (zc - za) * (b[0] - a[0]) - (zb - za) * (c[0] - a[0])
        return x / area, y / area

    def owner(self, query: Point) -> int | None:
        """The face that a ray from the point meets first as it turns from just above x."""
        found = list(self.containing(query))
        return min(found, key=lambda number: self._entry(number, query), default=None)

    def _entry(self, number: int, query: Point):
        """Where the turning ray enters the face: first of all if it starts inside."""
        corners = [self.points[row] for row in self.faces[number]]
        directions = self._sides(corners, query)
        if directions is None:
            return _Direction((Fraction(1), Fraction(0)))
        start, end = directions
        ahead = (Fraction(1), Fraction(0))
        begins_before = _cross(start, ahead) >= 0 and not _is_back(start, ahead)
        ends_after = _cross(ahead, end) > 0 or _is_back(ahead, end)
        return _Direction(ahead if begins_before and ends_after else start)

    @staticmethod
    def _sides(corners: Sequence[Point], query: Point) -> tuple[Point, Point] | None:
        """The directions between which the face lies, seen from a point on its border."""
        for k in range(3):
            if corners[k] == query:
                return tuple(  # type: ignore[return-value]
                    _minus(corners[(k + step) % 3], query) for step in (1, 2)
                )
        for k in range(3):
            u, v = corners[k], corners[(k + 1) % 3]
            if turn(u, v, query) == 0:
                return _minus(v, query), _minus(u, query)
        return None


def _minus(p: Point, q: Point) -> Point:
    return p[0] - q[0], p[1] - q[1]


def _cross(u: Point, v: Point) -> Fraction:
    return u[0] * v[1] - u[1] * v[0]


def _is_back(u: Point, v: Point) -> bool:
    return _cross(u, v) == 0 and u[0] * v[0] + u[1] * v[1] < 0


def _compare(u: Point, v: Point) -> int:
    halves = [not (p[1] > 0 or (p[1] == 0 and p[0] > 0)) for p in (u, v)]
    if halves[0] != halves[1]:
        return 1 if halves[0] else -1
    side = _cross(u, v)
    return (side < 0) - (side > 0)


_Direction = cmp_to_key(_compare)
