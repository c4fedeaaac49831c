"""Surfaces within rings: `triangulate(boundary=, holes=)`."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
import shapely
from surfaces import hills, plane_area

import liftmesh
from liftmesh import InputError

SQUARE = np.array([[8, 4], [56, 4], [56, 28], [8, 28]], dtype=float)


@pytest.mark.parametrize("has_heights", [False, True])
def test_a_boundary_and_a_lake_with_an_island(has_heights: bool) -> None:
    lake = np.array([[20, 8], [30, 8], [30, 20], [20, 20]], dtype=float)
    island = np.array([[22, 10], [22, 14], [26, 14], [26, 10]], dtype=float)
    rings = [SQUARE, lake, island]
    if has_heights:
        rings = [np.column_stack([each, np.full(4, 2.0)]) for each in rings]
    surface = liftmesh.triangulate(hills(), boundary=rings[0], holes=[[rings[1], rings[2]]])
    assert plane_area(surface) == pytest.approx(48 * 24 - 120 + 16, rel=1e-14)
    shown = surface.sample([[9, 5], [7, 5], [21, 9], [24, 12], [2, 2]])
    assert np.isnan(shown).tolist() == [False, True, True, False, True]
    assert surface.bounds == (8, 4, 56, 28)
    assert len(surface.boundary()) == 3
    if has_heights:
        assert (surface.sample(np.vstack(rings)[:, :2]) == 2).all()
    else:
        plain = liftmesh.triangulate(hills())
        rows = surface.vertices[surface.attributes["breakline"] == 2]
        np.testing.assert_allclose(plain.sample(rows[:, :2]), rows[:, 2], atol=1e-9)
    assert surface.solid(-5.0).faces is not None


def test_a_boundary_may_leave_the_cloud() -> None:
    points = hills()
    around = liftmesh.triangulate(points, boundary=[[-9, -9], [99, -9], [99, 99], [-9, 99]])
    assert len(around.faces) == len(liftmesh.triangulate(points).faces)
    assert around.report.lines["rows"] == 0
    half = liftmesh.triangulate(points, boundary=[[-9, 8], [99, 8], [99, 99], [-9, 99]])
    assert half.bounds[1] == 8
    assert np.isnan(half.sample([[30, 7.9], [30, 8.1]])).tolist() == [True, False]
    with pytest.raises(InputError, match="no face is left"):
        liftmesh.triangulate(points, holes=[[-9, -9], [99, -9], [99, 99], [-9, 99]])


def assert_bounded_by_constraints(surface: liftmesh.Surface) -> None:
    """What is left verifies as a carved triangulation, and so does the whole."""
    tri = surface.triangulation
    left = liftmesh.verify(tri.points, surface.faces, constraints=tri.constraints, carved=True)
    assert left.canonical, left.flaws
    assert surface.verify().canonical
    starts, members = tri.constraint_inputs
    assert (np.diff(starts) > 0).all()
    ends = tri.input_edges[members]
    assert len(ends) == starts[-1]
    marked = np.sort(tri.simplices[:, [[1, 2], [2, 0], [0, 1]]][tri.is_constrained], axis=1)
    assert {*map(tuple, marked.tolist())} == {*map(tuple, tri.constraints.tolist())}


def test_a_ring_that_cuts_a_corner_of_the_hull_leaves_no_open_side() -> None:
    for seed in range(6):
        points = np.random.default_rng(seed).random((60, 3)) * [10, 10, 1]
        surface = liftmesh.triangulate(points, boundary=[[-3, 4], [4, -3], [13, 6], [6, 13]])
        assert_bounded_by_constraints(surface)
        copy = pickle.loads(pickle.dumps(surface))
        np.testing.assert_array_equal(
            copy.triangulation.constraints, surface.triangulation.constraints
        )


def test_slivers_beside_the_hull_do_not_depend_on_the_order_of_the_rows() -> None:
    rng = np.random.default_rng(121)
    planar = np.unique(rng.integers(0, 17, (40, 2)), axis=0)
    points = np.column_stack([planar, np.zeros(len(planar))])
    angles = np.sort(rng.random(5)) * 2 * np.pi
    ring = np.column_stack([np.cos(angles), np.sin(angles)]) * rng.uniform(2, 12)
    ring += rng.random(2) * 16
    found = []
    for seed in range(8):
        mixed = np.random.default_rng(seed).permutation(points)
        surface = liftmesh.triangulate(mixed, holes=ring)
        corners = surface.triangulation.points[surface.faces].tolist()
        found.append({tuple(sorted(map(tuple, each))) for each in corners})
    assert all(each == found[0] for each in found)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:the lines of .* lie beyond")
def test_rings_that_leave_the_hull_cut_exactly() -> None:
    """Also where a breakline is a side of the hull, or a ring crosses one side twice."""
    for seed in range(60):
        rng = np.random.default_rng(seed)
        points = rng.random((rng.integers(5, 40), 3)) * 12
        angles = np.sort(rng.random(4) * 2 * np.pi)
        ring = np.column_stack([np.cos(angles), np.sin(angles)]) * 6 + rng.random(2) * 12
        line = rng.random((3, 3)) * 12
        hull = shapely.MultiPoint(np.vstack([points, line])[:, :2]).convex_hull
        hidden = shapely.Polygon(ring).buffer(0)
        if hull.within(hidden) or hidden.area < 1:
            continue
        surface = liftmesh.triangulate(points, breaklines=line, holes=ring)
        assert plane_area(surface) == pytest.approx(hull.difference(hidden).area, rel=1e-9)
        assert_bounded_by_constraints(surface)


@pytest.mark.parametrize("seed", [41, 47, 53, 57])
def test_no_sliver_is_left_where_a_boundary_leaves_the_hull(seed: int) -> None:
    rng = np.random.default_rng(seed)
    cloud = rng.random((30, 3)) * 10
    turn = np.sort(rng.random(5)) * 2 * np.pi
    ring = 5 + np.stack([np.cos(turn), np.sin(turn)], axis=1) * rng.uniform(3, 8)
    surface = liftmesh.triangulate(cloud, boundary=ring)
    a, b, c = surface.vertices[surface.faces][..., :2].transpose(1, 0, 2)
    u, v = b - a, c - a
    assert (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).min() > 1e-9
    tri = surface.triangulation
    for k, piece in enumerate(tri.constraints):
        tail, head = tri.points[tri.input_edges[tri.inputs_of(k)]].transpose(1, 0, 2)
        assert not liftmesh.orient2d(tail[:, None], head[:, None], tri.points[piece]).any()


@pytest.mark.parametrize("seed", range(4))
def test_faces_are_those_whose_centroids_are_inside(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points = rng.random((2000, 3)) * 100
    turns = np.linspace(0, 2 * np.pi, 30, endpoint=False)
    circle = np.column_stack([np.cos(turns), np.sin(turns)])
    coast, lakes = 50 + 20 * (1 + seed) * circle, [c + 9 * circle for c in rng.random((4, 2)) * 100]
    surface = liftmesh.triangulate(points, boundary=coast, holes=lakes)
    shown = shapely.Polygon(coast) - shapely.union_all([shapely.Polygon(each) for each in lakes])
    corners = surface.triangulation.points[surface.triangulation.simplices]
    is_left_out = ~shapely.contains_xy(shown, corners.mean(axis=1))
    found = np.zeros(len(corners), bool) if surface.mask is None else surface.mask
    areas = shapely.area(shapely.polygons(corners))
    assert areas[found != is_left_out].sum() < 1e-9
