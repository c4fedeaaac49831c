"""Definitions 2.1 and 2.2: lower facets, and how projecting and lifting undo each other."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st
from oracles import planar as oracle
from paper_positions import (
    ON_CIRCLE,
    Planar,
    lower_facets_by_definition,
    planar_sets,
    space_sets,
    vertices,
)
from paper_reference import lf, lower_facets

import liftmesh
from liftmesh.errors import InputError
from liftmesh.paper.geometry import (
    Exact,
    Plane,
    exact,
    is_lifting,
    is_lower_facet,
    lifted,
    mu,
    mu_star,
    orient,
    planar_hull,
)

GRID = [(x, y) for x in range(4) for y in range(3)]


def has_area(points: list[Planar]) -> bool:
    return any(orient(*abc) != 0 for abc in combinations(points, 3))


@given(space_sets)
def test_definition_2_1_is_about_heights(points: list[Exact]) -> None:
    for abp in combinations(points, 3):
        plane = Plane.through(*abp)
        above = plane.n[2] != 0 and all(z >= plane.height(x, y) for x, y, z in points)
        assert is_lower_facet(*abp, points) == above


@pytest.mark.slow
@given(planar_sets, vertices)
@settings(max_examples=50)
def test_the_lower_facets_of_a_lifted_set_are_a_lifting(points: list[Planar], q: Planar) -> None:
    assume(has_area(points))
    space = [mu(u, q) for u in points]
    facets = lower_facets(space, lf(space))
    assert is_lifting(space, facets)
    assert not any(is_lifting(space, facets[:k] + facets[k + 1 :]) for k in range(len(facets)))


@given(space_sets)
def test_the_lower_facets_of_any_set_are_a_lifting(points: list[Exact]) -> None:
    facets = lower_facets_by_definition(points)
    rows = [tuple(points.index(p) for p in facet) for facet in facets]
    assert is_lifting(points, rows) == bool(facets)


@pytest.mark.parametrize("q", [(0, 0), (1.5, 1), (-7, 0.1), (1e8, 1e8), (3e200, 5e-324)])
@pytest.mark.parametrize("planar", [GRID, ON_CIRCLE, "uniform"], ids=["grid", "circle", "uniform"])
def test_delaunay_triangulations_are_liftings(
    planar: list[Planar] | str, q: tuple[float, float]
) -> None:
    rows = np.random.default_rng(7).random((15, 2)) if planar == "uniform" else np.array(planar)
    simplices = liftmesh.delaunay(rows).simplices.tolist()
    space = [mu(u, q) for u in rows]
    assert is_lifting(space, simplices)
    assert not is_lifting(space, simplices[1:])


@given(planar_sets, vertices, st.data())
def test_tau_star_is_a_single_valued_inverse(
    points: list[Planar], q: Planar, data: st.DataObject
) -> None:
    """Over any point of the planar hull lies one point of the facets: the lowest of CH(P)."""
    assume(has_area(points))
    space = [mu(u, q) for u in points]
    facets = liftmesh.delaunay(np.array(points)).simplices.tolist()
    weights = data.draw(st.lists(st.integers(0, 3), min_size=len(points), max_size=len(points)))
    assume(any(weights))
    sums = [sum(w * p[k] for w, p in zip(weights, points, strict=True)) for k in (0, 1)]
    u = tuple(Fraction(s, sum(weights)) for s in sums)
    w = lifted(u, space, facets)
    assert mu_star(w) == u
    assert w[2] == min(heights_over(u, points, q))
    assert w[2] >= mu(u, q)[2]  # the paraboloid is below its chords


def heights_over(u: Exact, points: list[Planar], q: Planar) -> Iterator[Fraction]:
    for abc in combinations(points, 3):
        if orient(*abc) != 0 and oracle.contains(oracle.counter_clockwise(*abc), u):
            yield Plane.through(*(mu(p, q) for p in abc)).height(*u)


def test_tau_star_is_not_defined_outside_the_hull() -> None:
    points = [exact(p) for p in [(0, 0, 0), (2, 0, 4), (0, 2, 4)]]
    with pytest.raises(InputError, match="0 heights"):
        lifted((2, 2), points, [(0, 1, 2)])


def test_facets_at_two_heights_are_no_lower_hull() -> None:
    points = [exact(p) for p in [(0, 0, 0), (2, 0, 0), (0, 2, 0), (2, 2, 9)]]
    facets = [(0, 1, 2), (0, 1, 3), (0, 3, 2)]
    with pytest.raises(InputError, match="2 heights"):
        lifted((1, 0.5), points, facets)
    assert not is_lifting(points, facets)


def test_an_upper_facet_and_a_wrong_diagonal_are_no_lifting() -> None:
    space = [mu(u, (0, 0)) for u in [(0, 0), (3, 0), (3, 1), (0, 2)]]
    assert is_lifting(space, [(0, 1, 2), (0, 2, 3)])
    assert not is_lifting(space, [(0, 1, 3), (1, 2, 3)])


def test_points_on_a_line_have_no_facets_to_lift_to() -> None:
    assert not is_lifting([mu((t, 2 * t), (0, 0)) for t in range(4)], [])


@given(planar_sets)
def test_the_planar_hull_is_a_convex_polygon_around_all_points(points: list[Planar]) -> None:
    assume(has_area(points))
    hull = planar_hull(points)
    sides = list(zip(hull, hull[1:] + hull[:1], strict=True))
    assert all(orient(a, b, p) >= 0 for a, b in sides for p in points)
    assert all(
        orient(a, b, c) > 0 for (a, b), (_, c) in zip(sides, sides[1:] + sides[:1], strict=True)
    )
    assert {tuple(map(int, corner)) for corner in hull} <= set(points)
