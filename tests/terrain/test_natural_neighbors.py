"""Heights from natural neighbours: Voronoi cells in rationals, clipped by bisectors."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from clouds import FAMILIES
from hypothesis import given, settings, strategies as st
from oracles.surfaces import Point, exact_point, turn
from scipy.spatial import cKDTree
from surfaces import LATTICE, drawn, exactly, family_surface, meadow

import liftmesh

NATURAL = ("laplace", "sibson")
QUERIES = st.lists(
    st.tuples(*[st.integers(0, 40).map(lambda each: each / 8)] * 2), min_size=1, max_size=6
)


def nearer(polygon: list[tuple[Point, object]], centre: Point, other: Point):
    """Clip a convex polygon to what is nearer to a centre; sides know who made them."""

    def excess(p: Point) -> Fraction:
        to_other = (p[0] - other[0]) ** 2 + (p[1] - other[1]) ** 2
        return to_other - (p[0] - centre[0]) ** 2 - (p[1] - centre[1]) ** 2

    for k, (p, maker) in enumerate(polygon):  # the side from p on was made by `maker`
        q = polygon[(k + 1) % len(polygon)][0]
        at_p, at_q = excess(p), excess(q)
        if at_p >= 0:
            yield p, maker
        if at_p * at_q < 0:
            share = at_p / (at_p - at_q)
            cut = (p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1]))
            yield cut, (other if at_p > 0 else maker)
        elif at_p == 0 and at_q < 0:
            yield p, other


def cell(centre: Point, others: list[Point], within):
    polygon = within
    for other in others:
        if other != centre:
            polygon = list(nearer(polygon, centre, other))
    return polygon


def area(polygon) -> Fraction:
    corners = [p for p, _ in polygon]
    return sum(
        (turn(corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)),
        Fraction(0),
    )


def expected(points: list[Point], heights: list[Fraction], query: Point) -> tuple[float, float]:
    """Laplace's and Sibson's heights at a point strictly inside the hull, at no vertex."""
    far = Fraction(10**9)
    box = [((x, y), None) for x, y in ((-far, -far), (far, -far), (far, far), (-far, far))]
    own = cell(query, points, box)
    laplace, sibson = [], []
    for place, height in zip(points, heights, strict=True):
        length = sum(
            math.dist(map(float, p), map(float, own[(k + 1) % len(own)][0]))
            for k, (p, maker) in enumerate(own)
            if maker == place
        )
        away = math.dist(map(float, place), map(float, query))
        laplace.append((length / away, float(height)))
        sibson.append((area(cell(place, points, own)), height))
    return (
        sum(w * z for w, z in laplace) / sum(w for w, _ in laplace),
        float(sum(w * z for w, z in sibson) / sum(w for w, _ in sibson)),
    )


@settings(max_examples=50, deadline=None)
@given(LATTICE, QUERIES)
def test_heights_are_those_of_exact_cells(points, queries) -> None:
    surface = drawn(points)
    if surface is None:
        return
    oracle = exactly(surface)
    used = sorted({row for face in oracle.faces for row in face})
    places, heights = [oracle.points[r] for r in used], [oracle.heights[r] for r in used]
    hull = [places[used.index(row)] for row in surface.boundary()[0].tolist()]
    found = {method: surface.sample(np.array(queries), method).tolist() for method in NATURAL}
    for number, query in enumerate(map(exact_point, queries)):
        sides = [turn(hull[k - 1], hull[k], query) for k in range(len(hull))]
        if min(sides) < 0:
            assert all(math.isnan(found[method][number]) for method in NATURAL)
        elif min(sides) == 0 or query in places:
            linear = float(oracle.height(query))
            assert all(found[method][number] == pytest.approx(linear) for method in NATURAL)
        else:
            laplace, sibson = expected(places, heights, query)
            assert found["laplace"][number] == pytest.approx(laplace, rel=1e-9, abs=1e-9)
            assert found["sibson"][number] == pytest.approx(sibson, rel=1e-9, abs=1e-9)


@settings(max_examples=60)
@given(LATTICE, QUERIES)
def test_the_nearest_is_exact_and_the_least_of_several(points, queries) -> None:
    surface = drawn(points)
    if surface is None:
        return
    oracle = exactly(surface)
    used = sorted({row for face in oracle.faces for row in face})
    found = surface.sample(np.array(queries), "nearest")
    for query, height in zip(map(exact_point, queries), found.tolist(), strict=True):
        if oracle.height(query) is None:
            assert math.isnan(height)
            continue
        _, _, row = min(
            (
                (p[0] - query[0]) ** 2 + (p[1] - query[1]) ** 2,
                p,
                row,
            )
            for row, p in ((row, oracle.points[row]) for row in used)
        )
        assert height == float(oracle.heights[row])


@pytest.mark.parametrize("method", ["nearest", *NATURAL])
@pytest.mark.parametrize("family", FAMILIES)
def test_no_bit_depends_on_the_order_of_the_rows(family: str, method: str) -> None:
    surface, queries = family_surface(family)
    rng = np.random.default_rng(3)
    heights = surface.sample(queries, method)
    linear = surface.sample(queries)
    np.testing.assert_array_equal(np.isnan(heights), np.isnan(linear))
    low, high = surface.vertices[:, 2].min(), surface.vertices[:, 2].max()
    known = heights[~np.isnan(heights)]
    assert ((known >= low) & (known <= high)).all()
    rows = surface.vertices[rng.permutation(len(surface.vertices))]
    turned = liftmesh.triangulate(rows, on_duplicate="lowest")
    order = rng.permutation(len(queries))
    np.testing.assert_array_equal(turned.sample(queries[order], method), heights[order])


@pytest.mark.parametrize("method", NATURAL)
def test_a_plane_is_reproduced(method: str) -> None:
    rng = np.random.default_rng(7)
    planar = rng.random((3000, 2)) * 100
    surface = liftmesh.triangulate(np.column_stack([planar, planar @ (2.0, -3.0)]))
    queries = rng.uniform(10, 90, (3000, 2))
    np.testing.assert_allclose(
        surface.sample(queries, method), queries @ (2.0, -3.0), rtol=0, atol=1e-11
    )


def test_the_nearest_agrees_with_a_tree_and_threads_change_nothing() -> None:
    rng = np.random.default_rng(11)
    points = rng.random((20_000, 3))
    surface = liftmesh.triangulate(points)
    queries = rng.uniform(0.02, 0.98, (30_000, 2))
    _, rows = cKDTree(points[:, :2]).query(queries)
    np.testing.assert_array_equal(surface.sample(queries, "nearest"), points[rows, 2])
    for method in ("nearest", *NATURAL):
        one = surface.sample(queries, method, threads=1)
        np.testing.assert_array_equal(surface.sample(queries, method, threads=3), one)


@pytest.mark.parametrize(
    ("exponent", "offset"),
    [(-1074, 0), (-1000, 0), (-530, 0), (515, 0), (1000, 0), (-2, 0), (-2, 2**45)],
)
def test_of_four_nearest_the_least_counts_at_any_size(exponent: int, offset: int) -> None:
    size = 2.0**exponent
    even = np.stack(np.meshgrid(*2 * [np.arange(0, 14, 2)]), axis=-1).reshape(-1, 2)
    rows = np.random.default_rng(2).permutation(even)
    surface = liftmesh.triangulate(np.column_stack([(offset + rows) * size, rows @ [1, 100]]))
    middles = np.stack(np.meshgrid(*2 * [np.arange(1, 13, 2)]), axis=-1)
    found = surface.sample((offset + middles) * size, "nearest")
    np.testing.assert_array_equal(found, (middles - 1) @ [1, 100])


def test_the_nearest_around_a_vertex_of_many_faces() -> None:
    rng = np.random.default_rng(23)
    angles, sides = rng.random(400) * 2 * np.pi, rng.random((400, 1)) * 1e-6 + 1
    ring = np.column_stack([np.cos(angles), np.sin(angles)]) * sides
    planar = np.vstack([ring, [[0, 0]], rng.uniform([2, -0.5], [3, 0.5], (200, 2))])
    surface = liftmesh.triangulate(np.column_stack([planar, np.arange(len(planar))]))
    faces_at = np.bincount(surface.faces.ravel())
    assert faces_at.max() > 200
    queries = np.vstack(
        [rng.uniform(-0.7, 0.7, (300, 2)), rng.uniform([1, -0.4], [3, 0.4], (300, 2))]
    )
    _, rows = cKDTree(planar).query(queries)
    found = surface.sample(queries, "nearest")
    assert np.isfinite(found).sum() > 500
    np.testing.assert_array_equal(found, np.where(np.isnan(surface.sample(queries)), np.nan, rows))


@pytest.mark.parametrize("size", [1.0, 2.0**-1060, 2.0**1010])
def test_of_many_nearest_the_least_counts_however_it_is_found(size: float) -> None:
    radius = 160225  # its square is a sum of two squares in many ways
    sides = np.arange(-401, 402)
    x, y = (each.ravel() for each in np.meshgrid(sides, sides))
    ring = np.column_stack([x, y])[x**2 + y**2 == radius]
    rows = np.random.default_rng(4).permutation(np.concatenate([ring, ring * 2]))
    surface = liftmesh.triangulate(np.column_stack([rows * size, rows @ [1000, 1]]))
    least = min(map(tuple, ring.tolist()))
    # Walks, until they have cost as much as a tree of the vertices.
    found = surface.sample(np.zeros((4000, 2)), "nearest", threads=1)
    assert set(found.tolist()) == {1000 * least[0] + least[1]}


def test_masked_faces_have_no_height() -> None:
    surface = liftmesh.triangulate(meadow()).trim(max_edge=12)
    queries = np.random.default_rng(0).uniform(0, 100, (2000, 2))
    expected_nan = np.isnan(surface.sample(queries))
    assert expected_nan.any()
    for method in ("nearest", *NATURAL):
        np.testing.assert_array_equal(np.isnan(surface.sample(queries, method)), expected_nan)


def test_other_members_of_the_family_are_refused() -> None:
    points = np.random.default_rng(1).random((20, 3))
    for options in ({"weights": np.zeros(20)}, {"metric": [[2, 0], [0, 1]]}):
        surface = liftmesh.triangulate(points, **options)
        assert np.isfinite(surface.sample([0.5, 0.5]))
        with pytest.raises(liftmesh.InputError, match="interpolation 'sibson' needs a Delaunay"):
            surface.sample([0.5, 0.5], "sibson")
