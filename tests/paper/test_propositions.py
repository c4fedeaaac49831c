"""Each lemma and proposition of the paper on exact rationals, and how far it reaches."""

from __future__ import annotations

from decimal import Context, Decimal
from fractions import Fraction
from itertools import combinations
from random import Random

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st
from paper_positions import (
    Planar,
    around,
    edges,
    ellipses,
    lattice,
    lower_facets_by_definition,
    planar,
    planar_sets,
    rational,
    space,
    space_sets,
    vertices,
)

from liftmesh.errors import DegenerateInputError, InputError
from liftmesh.paper.geometry import Exact, Plane, exact, mu, mu_star, orient
from liftmesh.paper.propositions import (
    Circle,
    Ellipse,
    Surd,
    first_edge,
    lemma_4_1,
    lemma_4_2,
    outward,
    proposition_3_1,
    proposition_3_2,
    proposition_4_3,
    proposition_4_4,
    tie_sign,
)
from liftmesh.predicates import incircle

Section = tuple[Ellipse, list[Exact], tuple[Planar, ...]]
EXACT = Context(prec=400)


def decimal(value: Fraction) -> Decimal:
    return EXACT.divide(Decimal(value.numerator), Decimal(value.denominator))


def decimal_root(value: Fraction) -> Decimal:
    return EXACT.sqrt(decimal(value))


# Section 2


@given(planar, vertices)
def test_mu_lifts_to_the_paraboloid_and_mu_star_brings_back(u: Planar, q: Planar) -> None:
    x, y, z = mu(u, q)
    assert mu_star((x, y, z)) == exact(u)
    assert z == sum((Fraction(s) - Fraction(t)) ** 2 for s, t in zip(u, q, strict=True))


@given(space, space, space, space)
def test_a_plane_holds_its_points_and_does_not_depend_on_their_order(
    a: Exact, b: Exact, p: Exact, w: Exact
) -> None:
    assume(orient(a, b, p) != 0)
    plane = Plane.through(a, b, p)
    assert [plane.position(v) for v in (a, b, p)] == ["on"] * 3
    assert plane.n[2] == orient(a, b, p)
    assert plane.position(w) == Plane.through(b, a, p).position(w)
    z = plane.alpha * w[0] + plane.beta * w[1] + plane.gamma
    assert plane.position(w) == ("above" if w[2] > z else "below" if w[2] < z else "on")


def test_a_vertical_plane_has_nothing_above_it() -> None:
    wall = Plane.through((0, 0, 0), (1, 1, 0), (0, 0, 1))
    with pytest.raises(InputError, match="vertical"):
        wall.position((1, 0, 0))


def test_numbers_of_numpy_keep_their_value() -> None:
    values = np.int64(2**60 + 1), np.float32(0.1), np.uint8(7)
    assert exact(values) == (2**60 + 1, Fraction(float(np.float32(0.1))), 7)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -float("inf")])
def test_only_finite_numbers_have_an_exact_value(value: float) -> None:
    with pytest.raises(InputError, match="finite"):
        exact((0.0, value))


# Section 3


@given(space_sets)
@settings(max_examples=60)
def test_proposition_3_1_holds_of_the_outward_normal(points: list[Exact]) -> None:
    for abp in combinations(points, 3):
        plane = Plane.through(*abp)
        sides = {plane.dot(v) > plane.d for v in points if plane.dot(v) != plane.d}
        if any(plane.n) and len(sides) == 1:  # a facet of CH(P), which is not flat
            lower = plane.n[2] != 0 and all(plane.position(v) != "below" for v in points)
            assert proposition_3_1(outward(plane, points)) == ("(i)" if lower else "(ii)")
        elif any(plane.n) and sides:
            with pytest.raises(InputError, match="both sides"):
                outward(plane, points)


@given(space, space, space, space)
def test_proposition_3_2_tells_above_from_below(a: Exact, b: Exact, p: Exact, v: Exact) -> None:
    plane = Plane.through(a, b, p)
    holds = proposition_3_2(plane, v)
    if plane.n[2] >= 0:
        assert holds == "(ii)"
    else:
        assert holds == {"above": "(i)", "on": None, "below": "(ii)"}[plane.position(v)]
    printed = proposition_3_2(plane, v, printed=True)
    assert printed == (holds or "(ii)")


@given(space_sets)
@settings(max_examples=60)
def test_no_point_gives_3_2_ii_exactly_for_lower_facets(points: list[Exact]) -> None:
    for a, b, p in combinations(points, 3):
        turned = (a, b, p) if orient(a, b, p) < 0 else (b, a, p)
        plane = Plane.through(*turned)
        lower = plane.n[2] != 0 and all(plane.position(v) != "below" for v in points)
        assert lower == all(proposition_3_2(plane, v) != "(ii)" for v in points)


@given(space_sets)
@settings(max_examples=120)
def test_the_first_edge_is_an_edge_of_the_lower_hull(points: list[Exact]) -> None:
    if len({p[1] for p in points}) < 2:
        with pytest.raises(DegenerateInputError, match="same y"):
            first_edge(points)
        return
    hull = lower_facets_by_definition(points)
    found = first_edge(points)
    for edge in found.edges:
        assert not hull or frozenset(points[i] for i in edge) in edges(hull)
    assert points[found.v1] == min(points, key=lambda p: (p[2], p[:2]))
    assert len(found.edges) == (2 if found.case == 1 else 1)


@given(space_sets)
def test_all_points_are_on_the_sides_that_v2_and_vn_promise(points: list[Exact]) -> None:
    assume(len({p[1] for p in points}) > 1)
    found = first_edge(points)
    v1, v2, vn = ((-points[v][1], points[v][2]) for v in (found.v1, found.v2, found.vn))
    for _, y, z in points:  # Oy runs from right to left
        assert orient(v1, v2, (-y, z)) >= 0
        assert orient(v1, vn, (-y, z)) <= 0


@given(space_sets)
def test_the_three_cases_are_those_of_the_paper_with_strict_inequalities(
    points: list[Exact],
) -> None:
    assume(len({p[1] for p in points}) > 1)
    found = first_edge(points)
    y1, y2, yn = (points[v][1] for v in (found.v1, found.v2, found.vn))
    assert found.case == (1 if y2 < y1 < yn else 2 if y2 < y1 else 3)
    assert not yn < y1 < y2
    if y1 not in (y2, yn):  # then the printed cases say the same
        printed = 2 if y1 > max(y2, yn) else 3 if y1 < min(y2, yn) else 1
        assert found.case == printed


@given(space_sets, st.randoms(use_true_random=False))
def test_the_first_edge_does_not_depend_on_the_order_of_points(
    points: list[Exact], random: Random
) -> None:
    assume(len({p[1] for p in points}) > 1)
    shuffled = points.copy()
    random.shuffle(shuffled)
    edges_of = [
        [tuple(rows[i] for i in edge) for edge in first_edge(rows).edges]
        for rows in (points, shuffled)
    ]
    assert edges_of[0] == edges_of[1]


def test_a_tie_goes_to_the_largest_point_that_enters() -> None:
    low, high = exact((0, 9, 0)), exact((1, -9, 0))
    assert tie_sign(Fraction(0), [(low, Fraction(5)), (high, Fraction(-1))]) == -1
    assert tie_sign(Fraction(0), [(low, Fraction(5)), (high, Fraction(0))]) == 1
    assert tie_sign(Fraction(0), [(low, Fraction(5)), (low, Fraction(-5))]) == 0
    assert tie_sign(Fraction(1, 10**99), [(high, Fraction(-1))]) == 1


# Section 4


@given(rational, rational, rational)
def test_surds_compare_as_their_values_do(
    centre: Fraction, square: Fraction, value: Fraction
) -> None:
    surd = Surd(centre, square)
    root = decimal_root(abs(square))
    size = EXACT.add(decimal(centre), root if square > 0 else EXACT.minus(root))
    gap = EXACT.subtract(size, decimal(value))
    sign = 0 if abs(gap) < Decimal("1e-300") else 1 if gap > 0 else -1
    assert surd.compare(value) == sign
    comparisons = (value < surd, value <= surd, value > surd, value >= surd)
    assert comparisons == (sign > 0, sign >= 0, sign < 0, sign <= 0)
    assert float(surd) == pytest.approx(float(size), rel=1e-15, abs=1e-60)


@given(ellipses(), planar)
def test_the_circle_passes_through_the_three_points(section: Section, t: Planar) -> None:
    ellipse, abp, corners = section
    assert [ellipse.circle.position(u) for u in corners] == ["on"] * 3
    assert ellipse.circle == Circle.of(Plane.through(abp[1], abp[0], abp[2]), ellipse.q)


@given(ellipses(), vertices)
def test_the_circle_does_not_depend_on_q(section: Section, other: Planar) -> None:
    ellipse, _, corners = section
    plane = Plane.through(*(mu(u, other) for u in corners))
    assert Circle.of(plane, other) == ellipse.circle


@given(ellipses(), rational)
def test_lemma_4_1_bounds_every_point_of_the_ellipse(section: Section, tangent: Fraction) -> None:
    ellipse, _, corners = section
    least, greatest = lemma_4_1(ellipse)
    x, y, z = around(ellipse, corners[0], tangent)
    assert ellipse.plane.position((x, y, z)) == "on"
    assert least <= z <= greatest
    assert ellipse.min_x <= x <= ellipse.max_x
    assert ellipse.min_y <= y <= ellipse.max_y


@pytest.mark.slow
@given(lattice, lattice, rational)
def test_lemma_4_1_bounds_are_attained_on_the_line_cq(
    c: Planar, radius: Planar, share: Fraction
) -> None:
    """With q at c + share (a' - c), the line cq meets the circle in a' and in its antipode."""
    assume(radius != (0, 0))
    (cx, cy), (x, y) = c, radius
    q = (cx + share * x, cy + share * y)
    near, far = (cx + x, cy + y), (cx - x, cy - y)
    plane = Plane.through(mu(near, q), mu(far, q), mu((cx - y, cy + x), q))
    least, greatest = lemma_4_1(Ellipse(plane, q))
    heights = sorted([mu(near, q)[2], mu(far, q)[2]])
    assert [least.compare(heights[0]), greatest.compare(heights[1])] == [0, 0]


@given(ellipses())
def test_lemma_4_1_is_the_printed_formula(section: Section) -> None:
    ellipse, _, _ = section
    length = decimal_root(ellipse.squared_distance)
    radius = decimal_root(ellipse.circle.squared_radius)
    roots = EXACT.subtract(length, radius), EXACT.add(length, radius)
    for surd, root in zip(lemma_4_1(ellipse), roots, strict=True):
        expected = Fraction(EXACT.multiply(root, root))
        slack = Fraction(1, 10**60) * (expected + Fraction(1, 10**30))
        assert expected - slack < surd < expected + slack


@given(ellipses(), st.integers(0, 3))
@settings(max_examples=50)
def test_the_extents_are_no_wider_than_the_ellipse(section: Section, quarter: int) -> None:
    """A turn that a rational tangent takes close to an extreme point comes close to the bound."""
    ellipse, _, corners = section
    bound = (ellipse.max_x, ellipse.max_y, ellipse.min_x, ellipse.min_y)[quarter]
    steps = [Fraction(k, 30) for k in range(-30, 31)]
    turns = [*steps, *(1 / t for t in steps if t)]
    values = [around(ellipse, corners[0], t)[quarter % 2] for t in turns]
    extreme = max(values) if quarter < 2 else min(values)
    radius = float(Surd(Fraction(0), ellipse.circle.squared_radius))
    assert abs(float(bound) - float(extreme)) < 0.003 * radius


@given(ellipses(), planar)
@settings(max_examples=200)
def test_lemma_4_2_in_all_three_cases_and_both_directions(section: Section, t: Planar) -> None:
    ellipse, _, corners = section
    position = lemma_4_2(ellipse.circle, t)
    assert position == ellipse.plane.position(mu(t, ellipse.q))
    side = int(incircle(*corners, t)) * (1 if orient(*corners) > 0 else -1)
    assert position == {1: "below", 0: "on", -1: "above"}[side]


@given(ellipses(), planar | st.tuples(st.integers(-30, 30), st.integers(-30, 30)))
@settings(max_examples=200)
def test_proposition_4_3_finds_only_points_above(section: Section, t: Planar) -> None:
    ellipse, _, _ = section
    if proposition_4_3(ellipse, mu(t, ellipse.q)):
        assert ellipse.plane.position(mu(t, ellipse.q)) == "above"


@given(ellipses(), planar, rational)
def test_the_conditions_of_proposition_4_3_are_beyond_every_point_of_the_ellipse(
    section: Section, t: Planar, tangent: Fraction
) -> None:
    ellipse, _, corners = section
    (x, y, z), (sx, sy, sz) = mu(t, ellipse.q), around(ellipse, corners[0], tangent)
    beyond = {"(i)": x < sx, "(ii)": x > sx, "(iii)": y < sy, "(iv)": y > sy, "(v)": z > sz}
    for condition in proposition_4_3(ellipse, (x, y, z)):
        assert beyond[condition.removeprefix("4.3 ")]


CIRCLE_OF_5 = ((5, 0), (0, 5), (-5, 0))


@pytest.mark.parametrize(
    ("t", "q", "conditions"),
    [
        ((-6, 0), (0, 9), ("4.3 (i)",)),
        ((6, 0), (0, 9), ("4.3 (ii)",)),
        ((0, -6), (9, 0), ("4.3 (iii)",)),
        ((0, 6), (9, 0), ("4.3 (iv)",)),
        ((4, 4), (0, 0), ("4.3 (v)",)),
        ((-6, 7), (0, 0), ("4.3 (i)", "4.3 (iv)", "4.3 (v)")),
        ((5, 0), (1, 2), ()),  # on the circle where it touches its box
        ((-5, 0), (1, 2), ()),
        ((0, 5), (1, 2), ()),
        ((0, -5), (1, 2), ()),
        ((3, 4), (0, 0), ()),  # on a circle about q, at the greatest height
        ((0, 0), (7, 7), ()),
    ],
)
def test_each_condition_of_proposition_4_3_alone(
    t: Planar, q: Planar, conditions: tuple[str, ...]
) -> None:
    ellipse = Ellipse(Plane.through(*(mu(u, q) for u in CIRCLE_OF_5)), q)
    assert proposition_4_3(ellipse, mu(t, q)) == conditions


def test_proposition_4_3_misses_points_above_in_the_corners_of_the_box() -> None:
    q = (9, 9)
    ellipse = Ellipse(Plane.through(*(mu(u, q) for u in CIRCLE_OF_5)), q)
    assert ellipse.plane.position(mu((4, 4), q)) == "above"
    assert proposition_4_3(ellipse, mu((4, 4), q)) == ()


@given(ellipses(), planar)
@settings(max_examples=200)
def test_proposition_4_4_finds_only_points_below(section: Section, t: Planar) -> None:
    ellipse, _, _ = section
    lifted = mu(t, ellipse.q)
    if proposition_4_4(ellipse, lifted):
        assert ellipse.plane.position(lifted) == "below"
        assert ellipse.circle.position(ellipse.q) == "inside"


@pytest.mark.parametrize(
    ("t", "q", "holds"),
    [((1, 1), (0, 0), True), ((1, 1), (3, 3), False), ((5, 0), (0, 0), False)],
)
def test_proposition_4_4_reaches_a_disc_about_q(t: Planar, q: Planar, holds: bool) -> None:
    """The second point is below the plane, and in the circle about q that reaches (C): too far."""
    ellipse = Ellipse(Plane.through(*(mu(u, q) for u in CIRCLE_OF_5)), q)
    assert proposition_4_4(ellipse, mu(t, q)) == holds
    assert (ellipse.plane.position(mu(t, q)) == "below") == (t == (1, 1))


@given(ellipses(), planar)
@settings(max_examples=200)
def test_without_its_second_condition_proposition_4_4_turns_around(
    section: Section, t: Planar
) -> None:
    """Where L_cq > r, t_z < minz_E puts t above: it is closer to q than the circle is."""
    ellipse, _, _ = section
    lifted = mu(t, ellipse.q)
    outside = ellipse.squared_distance > ellipse.circle.squared_radius
    if outside and lifted[2] < ellipse.min_z:
        assert ellipse.plane.position(lifted) == "above"
        assert not proposition_4_4(ellipse, lifted)


@given(planar_sets, vertices)
def test_a_point_is_decided_by_at_most_one_of_the_two_propositions(
    points: list[Planar], q: Planar
) -> None:
    assume(orient(*points[:3]) != 0)
    ellipse = Ellipse(Plane.through(*(mu(u, q) for u in points[:3])), q)
    for t in points:
        lifted = mu(t, q)
        assert not (proposition_4_3(ellipse, lifted) and proposition_4_4(ellipse, lifted))


def test_the_propositions_are_about_points_of_the_paraboloid_only() -> None:
    """A point of any height may be beyond (E) and below the plane: LFRes is not for such points."""
    ellipse = Ellipse(Plane.through(*(mu(u, (0, 0)) for u in CIRCLE_OF_5)), (0, 0))
    beyond, low = (9, 0, 0), (4, 4, 0)
    assert proposition_4_3(ellipse, beyond) == ("4.3 (ii)",)
    assert lemma_4_2(ellipse.circle, low) == "above"
    assert [ellipse.plane.position(t) for t in (beyond, low)] == ["below", "below"]
    assert ellipse.plane.position(mu((9, 0), (0, 0))) == "above"
