"""What `check_certificate.py` checks of triangles on the sphere.

It uses the standard library only. The points are directions: vectors of integers, of any length. A
point is above the plane of three unit vectors, and so inside their circle, by the sign of a sum of
four integers times square roots of integers, which is found by squaring. The triangles are the
surface of the convex hull of the unit vectors if they meet in twos, none has an apex beyond it, an
inner point is strictly inside each of them, and the triangles at a vertex that is outside of none
turn once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from fractions import Fraction
from itertools import chain, combinations, pairwise

Ray = tuple[int, int, int]  # without a common divisor: of each direction one
Triangle = tuple[Ray, ...]
Side = Callable[[Ray, Ray, Ray, Ray], int]
Root = tuple[int, int]  # an integer, and what the root is of by which it is multiplied
AXES: tuple[Ray, ...] = ((0, 0, 1), (0, 1, 0), (1, 0, 0))


def judge_sphere(
    rows: list[tuple[float, ...]], cells: list[tuple[int, ...]]
) -> tuple[str, dict[str, object]]:
    """Return what is wrong with triangles, and what their certificate must say."""
    rays = [ray_of(row) for row in rows]
    counts = {"n_rows": len(rows), "n_skipped": rays.count(None), "n_triangles": len(cells)}
    wrong, beyond = edges_of(rays, cells)
    vertices = {*chain(*beyond)}
    if not wrong and vertices != {*rays} - {None}:
        wrong = "a direction is not a vertex"
    wrong, ties = (wrong, 0) if wrong else problem_of_surface(beyond, vertices)
    if wrong:
        return wrong, {"valid": False, "canonical": False, "counts": counts}
    corners = len({*chain(*cells)})
    others = counts["n_skipped"] + len(vertices)
    counts |= {"n_vertices": len(vertices), "n_duplicates": len(rows) - others}
    counts |= {"n_merged": corners - len(vertices), "n_hull_edges": 0}
    counts["n_edges"] = len(beyond) // 2
    flaws = [("not_canonical", ties)] if ties else []
    truth = {"valid": True, "canonical": not ties, "counts": counts, "flaws": flaws}
    return "", truth | {"euler_characteristic": 2}


def ray_of(row: tuple[float, ...]) -> Ray | None:
    if not all(map(math.isfinite, row)):
        return None
    exact = [Fraction(value) for value in row]
    scale = math.lcm(*(value.denominator for value in exact))
    x, y, z = (int(value * scale) for value in exact)
    divisor = math.gcd(x, y, z)
    if divisor == 0:
        raise ValueError("a row is (0, 0, 0), which has no direction")
    return x // divisor, y // divisor, z // divisor


def edges_of(
    rays: list[Ray | None], cells: list[tuple[int, ...]]
) -> tuple[str, dict[tuple[Ray, Ray], Ray]]:
    """Return what is wrong with the triangles, and the apex on the left of each edge."""
    if not cells:
        return "there are no triangles", {}
    if not all(0 <= row < len(rays) for row in chain(*cells)):
        return "a corner is not a row", {}
    triangles = [[ray for row in cell if (ray := rays[row])] for cell in cells]
    if any(len(triangle) < 3 for triangle in triangles):
        return "a corner is not finite", {}
    if any(len({*triangle}) < 3 for triangle in triangles):
        return "two corners of a triangle have one direction", {}
    apex = {edge: opposite for a, b, c in triangles
            for edge, opposite in (((a, b), c), ((b, c), a), ((c, a), b))}  # fmt: skip
    if len(apex) != 3 * len(triangles) or any((b, a) not in apex for a, b in apex):
        return "the triangles do not meet in twos along edges", {}
    return "", apex


def problem_of_surface(beyond: dict[tuple[Ray, Ray], Ray], vertices: set[Ray]) -> tuple[str, int]:
    """Return what is wrong with a closed surface, and how many edges are not canonical."""
    triangles = [(a, b, c) for (a, b), c in beyond.items() if a < b and a < c]
    a, b, c = u, *_ = triangles[0]
    off_circle = (ray for ray in sorted(vertices) if above(a, b, c, ray) != 0)
    fourth = next(off_circle, None)
    side: Side = above
    if fourth is None:  # all are on one circle, and the rule tells two sides of it apart
        side, fourth = above_by_rule, next(iter(vertices - {a, b, c}), None)
    if fourth is None:
        return "there are three directions alone", 0
    inner = (a, b, c, fourth)
    if any(side(*triangle, ray) > 0 for triangle in triangles for ray in inner):
        return "a triangle is inside of others", 0
    ties = 0
    for (p, q), r in beyond.items():
        apex = beyond[q, p]
        if apex == r or side(p, q, r, apex) > 0:
            return "a circle contains the apex of a neighbour", 0
        ties += p < q and above_by_rule(p, q, r, apex) > 0
    after = {q: r for (p, q), r in beyond.items() if p == u}
    ring = [next(iter(after))]
    while after[ring[-1]] != ring[0]:
        ring.append(after[ring[-1]])
    first, second = ring[:2]
    fan = [(v, w) for v, w in pairwise(ring)]
    if len(ring) != len(after) or any(
        side(u, first, v, w) > 0 or side(u, first, second, v) > 0 for v, w in fan
    ):
        return "the triangles turn more than once around a vertex", 0
    return "", ties


def determinant(a: Ray, b: Ray, c: Ray) -> int:
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = a, b, c
    return ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)


def square(ray: Ray) -> int:
    return sum(value * value for value in ray)


def sign(value: int) -> int:
    return (value > 0) - (value < 0)


def sign_of_roots(roots: Iterable[Root]) -> int:
    """The sign of the sum of at most four integers times square roots of positive integers."""
    left = [(k, m) for k, m in roots if k]
    if len(left) < 2:
        return sign(sum(k for k, _ in left))
    half = (len(left) + 1) // 2
    one, other = left[:half], left[half:]
    signs = sign_of_roots(one), sign_of_roots(other)
    if signs[0] * signs[1] >= 0:
        return signs[0] or signs[1]
    # Squared, a sum of two has a root in one term alone.
    terms: dict[int, int] = {}
    for part, factor in ((one, signs[0]), (other, -signs[0])):
        for (k, m), (n, p) in ((x, y) for x in part for y in part):
            radicand, value = (1, k * n * m) if (k, m) == (n, p) else (m * p, k * n)
            terms[radicand] = terms.get(radicand, 0) + factor * value
    return sign_of_roots((value, radicand) for radicand, value in terms.items())


def cofactors(rays: tuple[Ray, ...]) -> list[int]:
    """What the length of each ray counts in the determinant of rows (ray, length)."""
    a, b, c, d = rays
    signed = (b, c, d), (a, d, c), (a, b, d), (a, c, b)
    return [determinant(*three) for three in signed]


def above(*rays: Ray) -> int:
    """Whether the unit vector of the fourth is above the plane of the others: 1, 0 or -1."""
    if len({*rays}) < 4:
        return 0
    return sign_of_roots((k, square(ray)) for k, ray in zip(cofactors(rays), rays, strict=True))


def by_unit_vector(ray: Ray) -> list[Fraction]:
    """What is ordered as the unit vector is: squares of coordinates, with their signs."""
    return [Fraction(v * abs(v), square(ray)) for v in ray]


def above_by_rule(*rays: Ray) -> int:
    """The same, where unit vectors that are larger are a little nearer to the middle.

    Of rays in one plane, larger ones are moved by far less along the last axis that leaves it.
    """
    found = above(*rays)
    if found or len({*rays}) < 4:
        return found
    order = sorted(rays, key=by_unit_vector)
    counts = dict(zip(rays, cofactors(rays), strict=True))
    for ray in reversed(order):
        if counts[ray]:
            return sign(counts[ray])
    largest = order[-1]
    axis = next(k for k in AXES if any(determinant(k, p, q) for p, q in combinations(rays, 2)))
    moved = tuple(axis if ray == largest else ray for ray in rays)
    lengths = [0 if ray == largest else square(ray) for ray in rays]
    roots = zip(cofactors(moved), lengths, strict=True)
    return sign_of_roots((k, m) for k, m in roots if m)
