"""The definitions of Section 2 in exact rationals: lower facets and liftings.

P is a sequence of points in space, a facet three of its rows. Definition 2.2 requires of an affine
transformation tau, which maps a polyhedron L onto a polyhedron Q, that it has a single-valued
inverse tau* whose image is a union of closed faces of L. In the paper L is CH(P), Q the convex
hull of P*, tau the projection parallel to the z-axis, and tau* maps to the lower facets. (The
paper's sentence after the definition exchanges the letters L and Q, and calls the projection mu*
the lifting.)
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TypeAlias

from liftmesh.errors import InputError
from liftmesh.paper.geometry import Exact, Plane, Point, exact, mu_star, orient

Facet: TypeAlias = Sequence[int]
Polygon: TypeAlias = list[Exact]


def is_lower_facet(a: Point, b: Point, p: Point, points: Iterable[Point]) -> bool:
    """Definition 2.1: all points of P are on or above the plane (a, b, p)."""
    plane = Plane.through(a, b, p)
    return plane.n[2] != 0 and all(plane.position(v) != "below" for v in points)


def lifted(u: Point, points: Sequence[Point], facets: Iterable[Facet]) -> Exact:
    """The lifting tau* of Definition 2.2 at one point of the planar hull."""
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
