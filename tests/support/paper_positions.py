"""Points for the tests of the paper: lattices, duplicates, runs on lines and circles, far q."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations, permutations

from hypothesis import assume, strategies as st

from liftmesh.paper.geometry import Exact, Plane, exact, is_lower_facet, mu, orient
from liftmesh.paper.propositions import Ellipse

Planar = tuple[int, int]

ON_CIRCLE = [(5, 0), (4, 3), (3, 4), (0, 5), (-3, 4), (-4, 3), (-5, 0), (-4, -3), (0, -5), (3, -4)]
small = st.integers(-3, 3)
lattice = st.tuples(small, small)
circular = st.sampled_from(ON_CIRCLE)
planar = lattice | circular
rational = st.fractions(-4, 4, max_denominator=6)
vertices = (
    planar
    | st.tuples(rational, rational)
    | st.sampled_from([(10**8, 10**8), (-(10**8), 3), (0.1, 1e300), (5e-324, -0.3)])
)
planar_sets = st.lists(lattice, min_size=3, max_size=8) | st.lists(planar, min_size=3, max_size=8)
space = st.tuples(small, small, st.integers(0, 3)).map(exact)
space_sets = st.lists(space, min_size=4, max_size=8)


@st.composite
def ellipses(draw: st.DrawFn) -> tuple[Ellipse, list[Exact], tuple[Planar, ...]]:
    """The ellipse of three lifted points, the lifted points, and the points in the plane."""
    corners = draw(st.tuples(planar, planar, planar))
    assume(orient(*corners) != 0)
    q = draw(vertices)
    abp = [mu(u, q) for u in corners]
    return Ellipse(Plane.through(*abp), q), abp, corners


def around(ellipse: Ellipse, start: Planar, tangent: Fraction) -> Exact:
    """The point of (E) that follows a given one by a turn with this half-angle tangent: exact."""
    cx, cy = ellipse.circle.centre
    x, y = start[0] - cx, start[1] - cy
    cos, sin = (1 - tangent**2) / (1 + tangent**2), 2 * tangent / (1 + tangent**2)
    return mu((cx + cos * x - sin * y, cy + sin * x + cos * y), ellipse.q)


def raised(points: list[Exact]) -> list[Exact]:
    """Integer points, all far higher, and lifted by 1, 10^4, 10^8... in the order by (x, y)."""
    order = sorted({p[:2] for p in points})
    rises = {xy: 10_000**rank for rank, xy in enumerate(order)}
    return [(*p[:2], p[2] * 10_000 ** len(order) + rises[p[:2]]) for p in points]


def lower_facets_by_definition(points: list[Exact]) -> set[frozenset[Exact]]:
    """The canonical lower hull: every triple of the raised points, every other point above."""
    plain = dict(zip(raised(points), points, strict=True))
    return {
        frozenset(plain[p] for p in abp)
        for abp in combinations(plain, 3)
        if orient(*abp) != 0 and is_lower_facet(*abp, plain)
    }


def edges(facets: set[frozenset[Exact]]) -> set[frozenset[Exact]]:
    return {frozenset(edge) for facet in facets for edge in permutations(facet, 2)}
