"""Where the paper is wrong, says two things, or says too little: each shown on a concrete case.

The tests are in the order of the text, and each also shows what liftmesh does instead.
"""

from __future__ import annotations

import math
from fractions import Fraction
from itertools import combinations, pairwise, permutations

import numpy as np
import pytest
from paper_positions import edges, lower_facets_by_definition
from paper_reference import Tally, lf, lower_facets, printed_algorithm_2, printed_lf

import liftmesh
from liftmesh.paper.geometry import (
    Exact,
    Plane,
    exact,
    is_lifting,
    is_lower_facet,
    lifted,
    mu,
    orient,
)
from liftmesh.paper.propositions import (
    Ellipse,
    first_edge,
    outward,
    proposition_3_1,
    proposition_3_2,
    proposition_4_3,
    proposition_4_4,
)

TETRAHEDRON = [exact(p) for p in [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]]
ORIGIN = (0, 0)


def rows(*points: tuple[float, float, float]) -> list[Exact]:
    return [exact(p) for p in points]


def no_four_coplanar(points: list[Exact]) -> bool:
    planes = [(Plane.through(a, b, c), d) for a, b, c, d in combinations(points, 4)]
    return all(plane.dot(d) != plane.d for plane, d in planes)


def is_lower_edge(points: list[Exact], a: int, b: int) -> bool:
    return frozenset((points[a], points[b])) in edges(lower_facets_by_definition(points))


# Section 2


def test_four_coplanar_points_have_overlapping_lower_facets() -> None:
    square = rows((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
    facets = list(combinations(range(4), 3))
    assert all(is_lower_facet(*(square[i] for i in abp), square) for abp in facets)
    assert is_lifting(square, facets)  # still: but four triangles of area 1/2 in a square of area 1
    assert len(lower_facets(square, lf(square))) == 2
    assert len(liftmesh.delaunay([[0, 0], [1, 0], [1, 1], [0, 1]], algorithm="lf").simplices) == 2


def test_mu_is_not_the_lifting_of_definition_2_2() -> None:
    space = [mu(u, ORIGIN) for u in [(0, 0), (2, 0), (0, 2)]]
    middle = (1, 1)
    assert lifted(middle, space, [(0, 1, 2)]) == exact((1, 1, 4))
    assert mu(middle, ORIGIN) == exact((1, 1, 2))


# Section 3


def test_proposition_3_1_needs_an_order_of_the_vertices() -> None:
    upper, lower = TETRAHEDRON[1:], TETRAHEDRON[:3]
    for abp in permutations(upper):
        assert not is_lower_facet(*abp, TETRAHEDRON)
        assert proposition_3_1(outward(Plane.through(*abp), TETRAHEDRON)) == "(ii)"
    for abp in permutations(lower):
        assert is_lower_facet(*abp, TETRAHEDRON)
        assert proposition_3_1(outward(Plane.through(*abp), TETRAHEDRON)) == "(i)"
    for abp in (upper, lower):  # as printed, each order has its own answer
        assert {proposition_3_1(Plane.through(*p)) for p in permutations(abp)} == {"(i)", "(ii)"}


def test_proposition_3_2_speaks_of_one_side_of_the_edge() -> None:
    """[a, b] is shared by two lower facets; for each direction, one of them has n_z >= 0."""
    space = [mu(u, ORIGIN) for u in [(0, 0), (3, 0), (3, 1), (0, 2)]]
    a, b, left, right = space[0], space[2], space[3], space[1]
    for p in (left, right):
        assert is_lower_facet(a, b, p, space)
    assert proposition_3_2(Plane.through(a, b, left), right) == "(ii)"
    assert proposition_3_2(Plane.through(b, a, left), right) == "(i)"


def test_proposition_3_2_and_procedure_1_treat_on_differently() -> None:
    a, b, p, v = rows((0, 0, 0), (0, 1, 0), (1, 0, 0), (1, 1, 1))
    assert is_lower_facet(a, b, p, [a, b, p, v])
    plane = Plane.through(a, b, p)
    assert [proposition_3_2(plane, w, printed=True) for w in (a, b, p)] == ["(ii)"] * 3
    assert [proposition_3_2(plane, w) for w in (a, b, p)] == [None] * 3
    assert printed_lf([a, b, p, v])((0, 1)) == (0, 1, 2)


def test_oyz_seen_from_plus_infinity_has_oy_from_left_to_right() -> None:
    """With Oy from left to right, case 2 would name the wrong segment; from right to left not."""
    points = rows((0, 5, 0), (0, 0, 1), (1, 3, 30), (3, 1, 7))
    assert no_four_coplanar(points)
    out_of_the_screen, up = (1, 0, 0), (0, 0, 1)
    assert np.cross(up, out_of_the_screen).tolist() == [0, 1, 0]  # what the viewer has to the right
    v1 = 0
    assert all(points[v1][2] < p[2] and points[v1][1] > p[1] for p in points[1:])  # case 2
    v2 = {
        sign: next(
            i
            for i in (1, 2, 3)
            if all(sign * turn_in_oyz(points[v1], points[i], p) >= 0 for p in points)
        )
        for sign in (1, -1)
    }
    assert not is_lower_edge(points, v1, v2[1])
    assert is_lower_edge(points, v1, v2[-1])
    assert first_edge(points).edges == ((v1, v2[-1]),)


def turn_in_oyz(a: Exact, b: Exact, c: Exact) -> Fraction:
    return orient(a[1:], b[1:], c[1:])


def test_rightmost_lowest_is_not_one_point_and_is_not_needed() -> None:
    points = rows((2, 0, 0), (1, 0, 0), (0, 3, 0), (1, 1, 5))
    assert no_four_coplanar(points)
    assert points[0][1:] == points[1][1:]  # both are the rightmost lowest point of P'
    found = first_edge(points)
    assert found.v1 == 2  # lexicographically least in (x, y): lifted least, though leftmost
    assert all(is_lower_edge(points, a, b) for a, b in found.edges)


def test_a_line_of_p_prime_may_hold_a_diagonal() -> None:
    """[v_1, v_n] of the paper may be either of two segments to the points at y = 1."""
    square = rows((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0))
    found = first_edge(square)
    assert turn_in_oyz(*(square[i] for i in (0, 2, 3))) == 0
    assert (found.v1, found.edges) == (0, ((0, 3),))
    assert is_lower_edge(square, 0, 3)
    assert not is_lower_edge(square, 0, 2)


@pytest.mark.parametrize("height", [1, Fraction(19, 2)])
def test_equality_in_the_first_case_does_not_give_an_edge(height: Fraction) -> None:
    """Three points of least y: v'_2 may be the nearer or the farther, and either choice fails."""
    points = rows((0, 0, 0), (1, 0, 9), (2, 0, height), (0, 5, 50), (3, 5, 67))
    assert no_four_coplanar(points)
    nearer, farther = sorted((1, 2), key=lambda i: points[i][2])
    assert is_lower_edge(points, 0, 2)
    assert not is_lower_edge(points, 0, 1)
    assert (nearer, farther) == ((2, 1) if height == 1 else (1, 2))
    found = first_edge(points)
    assert found.case == 3
    assert found.edges == ((0, 3),)
    assert is_lower_edge(points, 0, 3)


def test_the_procedures_run_past_the_last_point() -> None:
    """The paper's loop over p_l in {a, b} has no end where p_n is a or b."""
    space = [mu(u, ORIGIN) for u in [(0, 0), (1, 0), (0, 1)]]
    with pytest.raises(IndexError):
        printed_lf(space)((2, 0))
    assert lf(space)((2, 0)) is None
    assert lf(space)((0, 2)) == printed_lf(space)((0, 2)) == (0, 2, 1)


def test_three_points_are_enough() -> None:
    space = [mu(u, ORIGIN) for u in [(0, 0), (1, 0), (0, 1)]]
    assert len(lower_facets(space, lf(space))) == 1
    assert len(liftmesh.delaunay([[0, 0], [1, 0], [0, 1]], algorithm="lf").simplices) == 1


FOUR = [(0, Fraction(-1, 2)), (0, Fraction(1, 2)), (1, 0), (-1, 0)]
Q_OF_FOUR = (0, Fraction(-1, 10))


@pytest.mark.parametrize("moves_e", [False, True])
def test_algorithm_2_misses_what_lies_beyond_the_first_edge(moves_e: bool) -> None:
    space = [mu(u, Q_OF_FOUR) for u in FOUR]
    ((a, b),) = first_edge(space).edges
    assert {a, b} == {0, 1}  # the diagonal
    for e1 in ((a, b), (b, a)):
        found = printed_algorithm_2(e1, lf(space), moves_e=moves_e, limit=9)
        assert len(found) == 1
    assert len(lower_facets(space, lf(space))) == 2
    q = tuple(map(float, Q_OF_FOUR))
    assert len(liftmesh.delaunay(np.array(FOUR, float), algorithm="lf", apex=q).simplices) == 2


def test_algorithm_2_does_not_end_where_e_is_not_moved() -> None:
    space = [mu(u, ORIGIN) for u in [(0, 0), (3, 0), (3, 1), (0, 2)]]
    a, b = first_edge(space).edges[0]
    e1 = (a, b) if lf(space)((a, b)) else (b, a)
    endless = printed_algorithm_2(e1, lf(space), moves_e=False, limit=1000)
    assert len(endless) == 1000
    assert len({frozenset(facet) for facet in endless}) == 2
    assert len(printed_algorithm_2(e1, lf(space), moves_e=True, limit=1000)) == 2
    assert printed_algorithm_2(e1[::-1], lf(space), moves_e=True, limit=1000) == []  # no F_1
    assert len(lower_facets(space, lf(space))) == 2


@pytest.mark.parametrize("n", [10, 20, 30])
def test_the_cubic_input_in_closed_form(n: int) -> None:
    """On (t, t^2) for t = n, ..., 1 LF works through all candidates, and all points for each."""
    tally = Tally()
    space = [mu((t, t * t), ORIGIN) for t in range(n, 0, -1)]
    assert len(lower_facets(space, lf(space, tally))) == n - 2
    assert tally.candidate_planes == (n - 1) * (n - 2) // 2
    assert tally.evaluations == (n - 2) * (n - 3) * (n + 5) // 6


@pytest.mark.parametrize("method", ["lf", "lfres"])
def test_the_worst_case_is_cubic_not_quadratic(method: str) -> None:
    looked_at = []
    for n in (40, 80, 160, 320):
        t = np.arange(n, 0, -1.0)
        counters = liftmesh.delaunay(
            np.column_stack((t, t * t)), algorithm=method, apex="origin"
        ).counters
        assert counters is not None
        looked_at.append(counters.points)
        assert counters.points > n**3 / 6.5
    growth = [b / a for a, b in pairwise(looked_at)]
    assert growth == pytest.approx([8, 8, 8], abs=0.3)


# Section 4


def test_d_is_not_the_product_with_the_vertex_of_the_paraboloid() -> None:
    q = (3, 1)
    plane = Plane.through(*(mu(u, q) for u in [(0, 0), (0, 1), (1, 0)]))
    t = mu((0, 2), q)
    assert plane.position(t) == "above"
    assert plane.d - plane.dot(t) > 0  # Section 4, with d = p . n
    printed_d = plane.dot((*q, 0))
    assert printed_d - plane.dot(t) < 0  # "below"


@pytest.mark.parametrize(
    ("q", "side"), [((10, 10), "outside"), ((0, -1), "inside"), ((0, -2), "on")]
)
def test_a_vertex_outside_the_hull_may_be_anywhere_about_the_circle(
    q: tuple[int, int], side: str
) -> None:
    """The paper has "the first case", outside or on the circle, no more where q is off the hull."""
    triangle = [(-2, 0), (2, 0), (0, 2)]
    assert any(orient(a, b, q) < 0 for a, b in pairwise(triangle))
    ellipse = Ellipse(Plane.through(*(mu(u, q) for u in triangle)), q)
    assert ellipse.circle.position(q) == side
    assert proposition_4_4(ellipse, mu((0, 0), q)) is False


def test_in_lemma_4_1_the_line_cq_may_be_missing_and_equality_is_not_at_one_point() -> None:
    corners = [(5, 0), (0, 5), (-5, 0)]
    ellipse = Ellipse(Plane.through(*(mu(u, ORIGIN) for u in corners)), ORIGIN)
    assert ellipse.circle.centre == ORIGIN
    assert {ellipse.min_z.compare(mu(u, ORIGIN)[2]) for u in corners} == {0}
    assert {ellipse.max_z.compare(mu(u, ORIGIN)[2]) for u in corners} == {0}


def test_the_last_strict_inequality_in_the_proof_of_4_3_may_be_an_equality() -> None:
    corners, t, q = [(5, 0), (0, 5), (-5, 0)], (-6, 0), (0, 9)
    ellipse = Ellipse(Plane.through(*(mu(u, q) for u in corners)), q)
    circle = ellipse.circle
    assert circle.squared_radius + (circle.centre[1] - t[1]) ** 2 == circle.squared_radius
    assert proposition_4_3(ellipse, mu(t, q)) == ("4.3 (i)",)
    assert ellipse.plane.position(mu(t, q)) == "above"


def test_the_formulas_of_procedure_3_drown_in_rounding_where_q_is_far() -> None:
    """In doubles, r comes out as 0 for the unit triangle: every point below would be rejected."""
    q = (1e8, 1e8)
    corners, inside = [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0)], (0.25, 0.5)
    assert printed_radius(corners, ORIGIN) == pytest.approx(math.sqrt(0.5))
    assert printed_radius(corners, q) == 0
    ellipse = Ellipse(Plane.through(*(mu(u, q) for u in corners)), q)
    assert ellipse.circle.squared_radius == Fraction(1, 2)
    assert ellipse.plane.position(mu(inside, q)) == "below"
    triangulation = liftmesh.delaunay([*corners, inside], algorithm="lfres", apex=q)
    facets = sorted(map(sorted, triangulation.simplices.tolist()))
    assert facets == [[0, 1, 3], [0, 2, 3], [1, 2, 3]]


def printed_radius(corners: list[tuple[float, float]], q: tuple[float, float]) -> float:
    """Lines 4 and 6 of Procedure 3 as a program in doubles has them."""
    a, b, p = np.array([(x, y, (x - q[0]) ** 2 + (y - q[1]) ** 2) for x, y in corners])
    n = np.cross(b - a, p - a)
    alpha, beta, gamma = -n[0] / n[2], -n[1] / n[2], (p @ n) / n[2]
    return math.sqrt(gamma + alpha * q[0] + beta * q[1] + (alpha**2 + beta**2) / 4)
