"""Regions: what is carved away, what is left, and where points are in it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from oracles.carving import Given, check_carved

import liftmesh
from liftmesh import ConstrainedTriangulation, constrained_delaunay

Points = np.ndarray[Any, Any]


def box(low: float, high: float) -> list[list[float]]:
    return [[low, low], [high, low], [high, high], [low, high]]


CORNERS = st.tuples(st.integers(0, 4), st.integers(0, 4))
HALVES = st.tuples(st.integers(0, 8), st.integers(0, 8))


def area(tri: ConstrainedTriangulation) -> float:
    a, b, c = tri.points[tri.simplices].transpose(1, 0, 2)
    doubled = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    return float(doubled.sum()) / 2


def by_force(tri: ConstrainedTriangulation, queries: Points) -> Points:
    """The first triangle around each point, by looking at all."""
    corners = tri.points[tri.simplices]
    is_in = np.ones((len(queries), tri.nsimplex), np.bool_)
    for k in range(3):
        tail, head = corners[:, k], corners[:, k - 2]
        is_in &= liftmesh.orient2d(tail[None], head[None], queries[:, None]) >= 0
    return np.where(is_in.any(axis=1), is_in.argmax(axis=1), -1)


NESTED = [box(0, 16), box(2, 14), box(4, 12), box(6, 10)]
FRAME = [[-1, -1], [17, -2], [18, 18], [-2, 17]]


@pytest.mark.parametrize("carve", [None, "outside", "holes"])
@pytest.mark.parametrize("form", ["edges", "polylines", "polygons", "one polygon each"])
def test_lakes_and_islands(carve: Any, form: str) -> None:
    points, options = FRAME, {}
    closed = [[*ring, ring[0]] for ring in NESTED]
    if form == "edges":
        points = [*FRAME, *(corner for ring in NESTED for corner in ring)]
        rings = 4 + np.arange(16).reshape(-1, 4)
        options["edges"] = np.stack([rings, np.roll(rings, -1, axis=1)], axis=2).reshape(-1, 2)
    elif form == "polylines":
        options["polylines"] = closed
    elif form == "polygons":
        options["polygons"] = [[NESTED[0], NESTED[1]], [closed[2][::-1], closed[3]]]
    else:
        options["polygons"] = [[ring] for ring in NESTED]
    tri = constrained_delaunay(points, carve=carve, **options)
    frame = 361.0  # of FRAME
    is_union = form == "one polygon each"
    expected = {None: frame, "outside": 256, "holes": 256 if is_union else 256 - 144 + 64 - 16}
    assert area(tri) == expected[carve]
    assert len(tri.constraints) == 16


def test_several_components_and_shared_sides() -> None:
    cells = [[[x, y], [x + 1, y], [x + 1, y + 1], [x, y + 1]] for x in range(3) for y in (0, 1)]
    far = [[7, 0], [9, 0], [9, 2]]
    tri = constrained_delaunay([[5, 5], [-1, 4]], polygons=[*cells, far], carve="holes")
    assert area(tri) == 6 + 2
    assert tri.regions.max() == 6
    assert tri.input_polygons.tolist() == [k for k in range(6) for _ in range(4)] + [6, 6, 6]


def test_open_lines_neither_leak_nor_count() -> None:
    """Across a boundary, along it, inside of it, and around a region of their own."""
    ring = box(0, 8)
    lines = [[[-2, 4], [0, 4], [8, 4], [10, 4]], [[1, 1], [2, 2], [2, 1], [1, 1]], [[0, 0], [8, 0]]]
    corners = [[-3, -3], [11, -3], [11, 11], [-3, 11]]
    tri = constrained_delaunay(corners, polylines=lines, polygons=[ring], carve="holes")
    assert area(tri) == 64
    tri = constrained_delaunay(
        [*corners, *ring], [[4, 5], [5, 6], [6, 7], [7, 4]], polylines=lines, carve="holes"
    )
    assert area(tri) == 64
    tri = constrained_delaunay(corners, polylines=[[*ring, ring[0]], lines[0]], carve="holes")
    assert area(tri) == 64


@pytest.mark.slow
@settings(max_examples=100)
@given(st.data())
def test_what_is_left_is_what_the_definition_leaves(data: st.DataObject) -> None:
    """Open lines, rings that share corners and sides or cross, islands, holes and seeds."""
    points = data.draw(st.lists(CORNERS, min_size=3, max_size=12))
    row = st.integers(0, len(points) - 1)
    edges = data.draw(st.lists(st.tuples(row, row), max_size=8))
    lines = data.draw(st.lists(st.lists(row, min_size=2, max_size=6), max_size=3))
    ring = st.lists(row, min_size=3, max_size=6)
    polygons = data.draw(st.lists(st.lists(ring, min_size=1, max_size=2), max_size=3))
    carve = data.draw(st.sampled_from([None, "outside", "holes"]))
    seeds = [(x / 2, y / 2) for x, y in data.draw(st.lists(HALVES, max_size=2))]
    options: dict[str, Any] = {
        "polylines": [np.array(line) for line in lines],
        "polygons": [[np.array(ring) for ring in polygon] for polygon in polygons],
        "crossing": "split",
    }
    try:
        whole = constrained_delaunay(points, edges, **options)
    except liftmesh.InputError:  # all on a line
        return
    try:
        carved = constrained_delaunay(points, edges, carve=carve, seeds=seeds, **options)
    except liftmesh.InputError:
        carved = None
    check_carved(whole, Given(edges, lines, polygons), carve, seeds, carved)


def test_a_line_that_ends_at_the_position_where_it_begins_is_a_ring() -> None:
    points = np.array([*FRAME, *box(0, 8), [0.0, 0.0]])
    assert area(constrained_delaunay(points, polylines=[[4, 5, 6, 7, 8]], carve="outside")) == 64
    points[8] = [-0.5, -0.5]
    with pytest.raises(liftmesh.InputError, match="no triangle is left"):
        constrained_delaunay(points, polylines=[[4, 5, 6, 7, 8]], carve="outside")


@pytest.mark.parametrize("rows", [[[2, 1]], []])
def test_both_loops_of_a_ring_that_crosses_itself_are_inside(rows: list[list[float]]) -> None:
    ring = [[0, 0], [4, 2], [4, 0], [0, 2]]
    tri = constrained_delaunay([*rows, [9, 9]], polygons=[ring], carve="holes", crossing="split")
    assert area(tri) == 4


def test_loops_that_cancel_out_are_inside_beside_other_polygons() -> None:
    ring = [[20, 0], [24, 4], [24, 0], [20, 4]]
    options: dict[str, Any] = {"carve": "holes", "crossing": "split"}
    assert area(constrained_delaunay(FRAME, polygons=[ring, box(0, 9)], **options)) == 8 + 81


def test_a_hole_as_large_as_its_polygon_leaves_nothing_of_it() -> None:
    holed = [box(0, 3), box(0, 3)]
    with pytest.raises(liftmesh.InputError, match="the holes of polygons cover all of these"):
        constrained_delaunay(FRAME, polygons=[holed], carve="holes")
    assert area(constrained_delaunay(FRAME, polygons=[holed, [box(4, 6)]], carve="holes")) == 4


TWICE = [[2, 2], [5, 2], [8, 2], [8, 8], [2, 8]]  # with a corner on a side


@pytest.mark.parametrize(
    ("holes", "left"),
    [
        ([box(2, 8)], 64),
        ([box(2, 8), box(2, 8)], 64),
        ([box(2, 8), TWICE, box(2, 8)[::-1]], 64),
        ([box(2, 8), box(4, 6)], 64),  # within another
        ([box(2, 6), box(4, 8)], 100 - 28),  # that overlap
    ],
)
def test_what_is_in_several_holes_is_in_a_hole(holes: list[list[list[float]]], left: int) -> None:
    options: dict[str, Any] = {"carve": "holes", "crossing": "split"}
    square = box(0, 10)
    assert area(constrained_delaunay([], polygons=[[square, *holes]], **options)) == left
    turned = [[square, holes[0]], [square[::-1], *holes]]
    assert area(constrained_delaunay([], polygons=turned, **options)) >= left
    island = box(4.5, 5.5)
    tri = constrained_delaunay([], polygons=[[square, holes[0]], island], **options)
    assert tri.find_simplex([5, 4.75]) >= 0


def test_no_seeds_remove_nothing() -> None:
    assert area(constrained_delaunay(box(0, 3), [[0, 2]], seeds=[])) == 9


@pytest.mark.parametrize("options", [{}, {"polylines": [[0, 2]]}, {"edges": [[0, 2], [2, 3]]}])
def test_nothing_left_is_an_error(options: dict[str, Any]) -> None:
    with pytest.raises(liftmesh.InputError, match=r"no triangle is left: .* all of 2 triangles"):
        constrained_delaunay(box(0, 3), carve="outside", **options)


def test_seeds_remove_their_regions() -> None:
    edges = [[0, 1], [1, 2], [2, 3], [3, 0]]
    tri = constrained_delaunay([*box(1, 2), *box(0, 3)], edges, seeds=[1.5, 1.25])
    assert area(tri) == 8
    assert tri.find_simplex([1.5, 1.25]) == -1
    holed = [[box(0, 9), box(1, 2), box(4, 5)]]
    tri = constrained_delaunay(
        [[-3, -3], [12, -3], [3, 12]], polygons=holed, carve="outside", seeds=[[4.5, 4.25]]
    )
    assert area(tri) == 81 - 1


@pytest.mark.parametrize(
    ("seeds", "said"),
    [
        ([[1, 0.5], [5, 5]], r"seed 1, \(5.0, 5.0\), is outside of all triangles: give a point"),
        ([[1, 0.5], [np.nan, 1]], r"seed 1, \(nan, 1.0\), is not finite: give a point"),
        ([[1, 1]], r"seed 0, \(1.0, 1.0\), is on an edge that bounds"),
        ([[2, 1], [1, 2]], r"no triangle is left: seeds remove all of 2 .* leave out those in"),
        ([1, 2, 3], r"seeds have the shape \(3,\)"),
        ("here", "seeds are 'here'"),
    ],
)
def test_wrong_seeds_are_named(seeds: Any, said: str) -> None:
    with pytest.raises(liftmesh.InputError, match=said):
        constrained_delaunay(box(0, 3), [[0, 2]], seeds=seeds)


@pytest.mark.parametrize("order", [[0, 1, 2, 3, 4, 5], [5, 4, 3, 2, 1, 0]])
def test_a_seed_at_a_corner_of_a_boundary_is_on_it(order: list[int]) -> None:
    """Also where the triangle that is found there has no side on the boundary."""
    points = np.array([[0, 0], [2, -1], [4, 0], [1, 3], [3, 3], [2, 9]], dtype=float)[order]
    ring = np.argsort(order)[[0, 1, 2, 4, 5, 3]]
    for row in ring:
        with pytest.raises(liftmesh.InputError, match=r"seed 0, .* is on an edge that bounds"):
            constrained_delaunay(points, polygons=[ring], seeds=points[row])


def test_whether_carving_or_seeds_remove_all_is_told() -> None:
    options: dict[str, Any] = {"carve": "outside", "seeds": [[1.5, 1.5]]}
    with pytest.raises(liftmesh.InputError, match="left: seeds remove all"):
        constrained_delaunay([*FRAME], polygons=[box(0, 3)], **options)
    with pytest.raises(liftmesh.InputError, match="left: carve removes all of 2 triangles, since"):
        constrained_delaunay(box(0, 3), [[0, 2]], **options | {"seeds": [[1, 2]]})


def test_many_seeds_in_one_region() -> None:
    points = np.random.default_rng(5).random((20000, 2))
    seeds = points[:5000] / 2 + 0.25
    with pytest.raises(liftmesh.InputError, match="no triangle is left"):
        constrained_delaunay(points, seeds=seeds)


def test_a_seed_on_a_breakline_is_none_on_a_boundary() -> None:
    lines = [[[1, 1], [2, 2]]]
    tri = constrained_delaunay(FRAME, polylines=lines, polygons=[box(0, 3)], seeds=[[1.5, 1.5]])
    assert area(tri) == 361 - 9


def test_what_is_left_has_neighbors_of_its_own() -> None:
    tri = constrained_delaunay(box(0, 3), polygons=[[box(0, 3), box(1, 2)]], carve="holes")
    assert tri.nsimplex == len(tri.neighbors) == len(tri.is_constrained) == len(tri.regions) == 8
    assert tri.neighbors.max() < 8
    assert (tri.neighbors < 0).sum() == 8
    np.testing.assert_array_equal(tri.neighbors < 0, tri.is_constrained)
    indptr, indices = tri.vertex_neighbor_vertices
    for row in range(8):
        around = np.unique(tri.simplices[(tri.simplices == row).any(axis=1)])
        found = np.sort(indices[indptr[row] : indptr[row + 1]])
        np.testing.assert_array_equal(found, around[around != row])
    assert len(tri.edges) == 16
    assert sorted(tri.convex_hull.tolist()) == [0, 1, 2, 3]
    lonely = constrained_delaunay([*box(0, 3), [9, 9]], polygons=[[0, 1, 2, 3]], carve="outside")
    assert lonely.vertex_to_simplex.tolist()[4] == -1
    assert lonely.max_bound.tolist() == [9, 9]


@pytest.mark.slow
@pytest.mark.parametrize("carve", [None, "holes"])
@pytest.mark.parametrize("kind", ["random", "spokes", "comb", "lattice"])
def test_points_are_found(kind: str, carve: Any) -> None:
    """Where visibility walks could run in circles or long ways, too."""
    rng = np.random.default_rng(7)
    turn = np.sort(rng.random(60)) * 2 * np.pi
    circle = np.stack([np.cos(turn), np.sin(turn)], axis=1)
    if kind == "random":
        points = rng.random((300, 2))
        loops = [rng.permutation(300)[:60].reshape(-1, 3)]
    elif kind == "spokes":  # a ring with spikes, at two scales
        points = np.concatenate(
            [circle * np.where(np.arange(60) % 2, 1, 1e-3)[:, None], circle * 2]
        )
        loops = [np.arange(60)[None], 60 + np.arange(60)[None]]
    elif kind == "comb":
        x = np.repeat(np.arange(100.0), 2)
        points = np.stack([x, np.tile([0.0, 1e3, 1e3, 0.0], 50)], axis=1)
        points = np.concatenate([points, [[-1, -5], [101, -5], [50, 2e3]]])
        loops = [np.arange(200)[None]]
    else:
        points = rng.integers(0, 12, (200, 2)).astype(float)
        loops = [rng.permutation(200)[:60].reshape(-1, 4)]
    edges = np.concatenate([
        np.stack([each, np.roll(each, -1, axis=1)], axis=2).reshape(-1, 2) for each in loops
    ])  # fmt: skip
    tri = constrained_delaunay(points, edges, crossing="split", carve=carve)
    least, most = points.min(axis=0), points.max(axis=0)
    queries = np.concatenate([
        least - 0.1 + rng.random((3000, 2)) * (most - least + 0.2), tri.points,
        tri.points[tri.edges].mean(axis=1), tri.points[tri.simplices].mean(axis=1),
    ])  # fmt: skip
    np.testing.assert_array_equal(tri.find_simplex(queries), by_force(tri, queries))
