"""The procedures in fractions against the definition, and the compiled ones against both."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from oracles import planar as oracle
from paper_positions import (
    Planar,
    lower_facets_by_definition,
    planar_sets,
    space_sets,
    vertices,
)
from paper_reference import Tally, lf, lower_facets

import liftmesh
from liftmesh.paper.geometry import Exact, mu

METHODS = ["lf", "lfres", "lfres-indexed", "auto"]


def triangles(points: list[Planar], facets: list[tuple[int, int, int]]) -> list[oracle.Triangle]:
    return [oracle.counter_clockwise(*(points[i] for i in facet)) for facet in facets]


@given(planar_sets, vertices)
@settings(max_examples=60)
def test_both_procedures_find_the_triangulation_and_each_facet_once(
    points: list[Planar], q: Planar
) -> None:
    expected = oracle.delaunay_by_definition(points)
    assume(expected)
    space = [mu(u, q) for u in points]
    for procedure in (lf(space), lf(space, q=q)):
        found = triangles(points, lower_facets(space, procedure))
        assert len(found) == len(expected)
        assert set(found) == expected


@given(space_sets)
@settings(max_examples=60)
def test_lf_finds_the_lower_hull_of_any_set(points: list[Exact]) -> None:
    expected = lower_facets_by_definition(points)
    assume(expected)
    facets = lower_facets(points, lf(points))
    assert len(facets) == len(expected)
    assert {frozenset(points[i] for i in facet) for facet in facets} == expected


@given(planar_sets, vertices)
@settings(max_examples=40)
def test_lfres_looks_at_the_points_that_lf_looks_at(points: list[Planar], q: Planar) -> None:
    assume(oracle.delaunay_by_definition(points))
    space = [mu(u, q) for u in points]
    plain, restricted = Tally(), Tally()
    lower_facets(space, lf(space, plain))
    lower_facets(space, lf(space, restricted, q))
    assert restricted.evaluations + restricted.rejected.total() == plain.evaluations
    assert restricted.candidate_planes == plain.candidate_planes


@pytest.mark.parametrize("method", METHODS)
@given(planar_sets, vertices)
@settings(max_examples=80)
def test_the_compiled_procedures_find_the_same_facets(
    method: str, points: list[Planar], q: Planar
) -> None:
    expected = oracle.delaunay_by_definition(points)
    assume(expected)
    vertex = tuple(map(float, q))
    simplices = liftmesh.delaunay(
        np.array(points), algorithm=method, apex=vertex
    ).simplices.tolist()
    found = triangles(points, simplices)
    assert len(found) == len(expected)
    assert set(found) == expected


@given(space_sets)
@settings(max_examples=80)
def test_the_compiled_lf_finds_the_lower_hull_of_any_set(points: list[Exact]) -> None:
    expected = lower_facets_by_definition(points)
    assume(expected)
    for method in ("lf", "auto"):
        faces = liftmesh.lower_hull(np.array(points, dtype=np.float64), algorithm=method).faces
        assert len(faces) == len(expected)
        assert {frozenset(points[i] for i in face) for face in faces.tolist()} == expected
