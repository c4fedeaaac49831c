"""The canonical Delaunay triangulation in exact integers, by its definition.

Every finite double is an integer on a common power-of-two lattice, so Python's integers decide
each question without rounding. Nothing here is shared with the program, neither code nor
formulas: the program evaluates in-circle determinants under a rule for ties, and this module

* compares the angles under which an edge is seen (`cells`), which gives the cells of the Delaunay
  diagram: the maximal convex polygons with an empty circumcircle;
* triangulates a cell of four or more cocircular vertices by its definition: the vertex that comes
  last in the order by x, then y, is cut off as an ear, and so on (`delaunay`);
* or, for a few points, lifts them to the paraboloid, raises each by a concrete tiny amount, far
  more for a later point than for an earlier one, and keeps the triangles with nothing below them
  (`delaunay_by_definition`).

Points are pairs of integers, ``(x, y)``, and triangles are triples of points, counter-clockwise,
starting from their smallest vertex.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cmp_to_key
from itertools import combinations
from math import gcd

Point = tuple[int, int]
Triangle = tuple[Point, Point, Point]
Edge = tuple[Point, Point]


def exact(values: Iterable[Iterable[float]]) -> list[Point]:
    """Rows of finite floats on their common lattice: integers, all scaled by one factor."""
    ratios = [tuple(float(value).as_integer_ratio() for value in row) for row in values]
    scale = max((bottom for row in ratios for _, bottom in row), default=1)
    rows = [tuple(top * (scale // bottom) for top, bottom in row) for row in ratios]
    common = gcd(*(value for row in rows for value in row)) or 1
    return [tuple(value // common for value in row) for row in rows]


def cross(origin: Point, a: Point, b: Point) -> int:
    """Twice the signed area of the triangle: positive when it turns counter-clockwise."""
    return (a[0] - origin[0]) * (b[1] - origin[1]) - (a[1] - origin[1]) * (b[0] - origin[0])


def dot(origin: Point, a: Point, b: Point) -> int:
    """Inner product of the two vectors that leave the origin."""
    return (a[0] - origin[0]) * (b[0] - origin[0]) + (a[1] - origin[1]) * (b[1] - origin[1])


def counter_clockwise(a: Point, b: Point, c: Point) -> Triangle:
    """Order three points counter-clockwise, the smallest first."""
    first, second, third = sorted((a, b, c))
    return (first, second, third) if cross(first, second, third) > 0 else (first, third, second)


def delaunay(points: Iterable[Point]) -> set[Triangle]:
    """All triangles of the canonical triangulation; none for points on one line."""
    return {triangle for cell in cells(points) for triangle in cut_ears(cell)}


def cells(points: Iterable[Point]) -> list[list[Point]]:
    """Find the cells of the Delaunay diagram, each a counter-clockwise polygon, edge by edge."""
    distinct = sorted(set(points))
    found: list[list[Point]] = []
    done: set[Edge] = set()
    pending = hull_edges(distinct)[:1]
    while pending:
        edge = pending.pop()
        if edge in done:
            continue
        cell = cell_beside(edge, distinct)
        sides = list(zip(cell, cell[1:] + cell[:1], strict=True)) if cell else [edge]
        done.update(sides)
        if cell:
            found.append(cell)
            pending += [(b, a) for a, b in sides]
    return found


def cell_beside(edge: Edge, points: Sequence[Point]) -> list[Point]:
    """Find the cell to the left of a Delaunay edge; an empty list outside the hull.

    Of the points to the left, those on the empty circle see the edge under the largest angle:
    the smallest cotangent, which is the quotient of inner and cross product.
    """
    a, b = edge
    best: list[Point] = []
    top, bottom = 0, 1
    for p in points:
        height = cross(a, b, p)
        if height <= 0:
            continue
        closeness = dot(p, a, b)
        difference = closeness * bottom - top * height
        if not best or difference < 0:
            best, top, bottom = [p], closeness, height
        elif difference == 0:
            best.append(p)
    return turning_around(a, [b, *best]) if best else []


def turning_around(origin: Point, others: list[Point]) -> list[Point]:
    """Order points of one circle counter-clockwise, starting from one of them."""
    return [origin, *sorted(others, key=cmp_to_key(lambda p, q: -cross(origin, p, q)))]


def cut_ears(polygon: Sequence[Point]) -> list[Triangle]:
    """Triangulate a cocircular polygon: cut off its largest vertex until a triangle is left."""
    rest = list(polygon)
    triangles = []
    while len(rest) >= 3:
        i = rest.index(max(rest))
        triangles.append(counter_clockwise(rest[i - 1], rest[i], rest[(i + 1) % len(rest)]))
        del rest[i]
    return triangles


def is_delaunay_side(a: Point, b: Point, left: Point, right: Point) -> bool:
    """Whether the side from a to b may part the triangles with these apexes to its two sides.

    It may if the two angles that see it sum to less than a half turn: the sum of their cotangents
    is positive. If they make a half turn, the four are cocircular, and one apex is the largest.
    """
    balance = dot(left, a, b) * cross(right, b, a) + dot(right, b, a) * cross(left, a, b)
    return balance > 0 or (balance == 0 and max(a, b, left, right) in (left, right))


def hull_edges(points: Iterable[Point]) -> list[Edge]:
    """Edges of the hull, counter-clockwise, through every point that lies on it.

    For points on one line there is no hull, and the list is empty.
    """
    distinct = sorted(set(points))
    lower, upper = chain(distinct), chain(distinct[::-1])
    around = lower[:-1] + upper[:-1]
    if len(lower) == len(upper) == len(distinct):
        return []
    return list(zip(around, around[1:] + around[:1], strict=True))


def chain(points: Sequence[Point]) -> list[Point]:
    """Keep what never turns clockwise on the way from the first point to the last."""
    kept: list[Point] = []
    for p in points:
        while len(kept) >= 2 and cross(kept[-2], kept[-1], p) < 0:
            kept.pop()
        kept.append(p)
    return kept


def delaunay_by_definition(points: Iterable[Point]) -> set[Triangle]:
    """All triangles, from the lower hull of the raised lift: every triple, every fourth point."""
    distinct = sorted(set(points))
    lifted = raised_lift(distinct)
    return {
        counter_clockwise(a, b, c)
        for a, b, c in combinations(distinct, 3)
        if cross(a, b, c) != 0 and is_lower_facet(counter_clockwise(a, b, c), lifted)
    }


def raised_lift(points: Sequence[Point]) -> dict[Point, int]:
    """Heights x^2 + y^2 in units so small that every rise, a power of one base, stays below one.

    The base exceeds every sum of the orientations that multiply the rises in a determinant, so a
    later point's rise outweighs all earlier ones, and all rises together outweigh nothing else.
    """
    width = max((abs(value) for p in points for value in p), default=0) * 2 + 1
    base = 1 << (8 * width * width).bit_length()
    unit = base ** (len(points) + 1)
    return {(x, y): (x * x + y * y) * unit + base**rank for rank, (x, y) in enumerate(points)}


def is_lower_facet(triangle: Triangle, lifted: dict[Point, int]) -> bool:
    """Whether no lifted point lies below the plane through the three lifted corners."""
    a, b, c = triangle
    whole = cross(a, b, c)
    return all(
        lifted[p] * whole
        >= lifted[a] * cross(p, b, c) + lifted[b] * cross(a, p, c) + lifted[c] * cross(a, b, p)
        for p in lifted
    )


def contains(triangle: Sequence[Point], p: Point) -> bool:
    """Whether a closed counter-clockwise triangle holds the point."""
    a, b, c = triangle
    return cross(a, b, p) >= 0 and cross(b, c, p) >= 0 and cross(c, a, p) >= 0


def locate(triangles: Sequence[Sequence[Point]], p: Point) -> int:
    """Row of the first triangle that holds the point on its inside or border; -1 for none."""
    return next((row for row, corners in enumerate(triangles) if contains(corners, p)), -1)
