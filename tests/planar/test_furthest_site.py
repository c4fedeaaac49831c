"""Delaunay(points, furthest_site=True), beside SciPy's."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest
from scipy import spatial

import liftmesh
from liftmesh._typing import Floats, Rows

RNG = np.random.default_rng(51)
CIRCLE = np.linspace(0, 6, 40)
SETS = {
    "square": RNG.random((500, 2)),
    "normal": RNG.standard_normal((500, 2)) * [3, 1] + [10, -4],
    "convex": np.c_[np.cos(CIRCLE), 2 * np.sin(CIRCLE)] + RNG.random((40, 2)) * 1e-4,
}


def as_sets(triangles: Rows) -> set[frozenset[int]]:
    return {frozenset(triangle) for triangle in triangles.tolist()}


@pytest.fixture(params=SETS)
def points(request: pytest.FixtureRequest) -> Floats:
    return SETS[request.param]


def test_the_triangles_are_scipys(points: Floats) -> None:
    ours = liftmesh.scipy.Delaunay(points, furthest_site=True)
    scipys = spatial.Delaunay(points, furthest_site=True)
    assert as_sets(ours.simplices) == as_sets(scipys.simplices)
    assert as_sets(ours.convex_hull) == as_sets(scipys.convex_hull)
    assert ours.furthest_site is scipys.furthest_site is True
    np.testing.assert_array_equal(ours.vertex_to_simplex < 0, scipys.vertex_to_simplex < 0)
    assert (ours.equations[:, 2] > 0).all()
    assert (ours.plane_distance(points) < 1e-9).all()
    corners = {*ours.simplices.ravel().tolist()}
    assert ours.hidden.tolist() == [row for row in range(len(points)) if row not in corners]
    a, b, c = (points[corner] for corner in ours.simplices.T)
    assert (liftmesh.orient2d(a, b, c) > 0).all()


def test_points_are_found_in_their_triangles(points: Floats) -> None:
    tri = liftmesh.scipy.Delaunay(points, furthest_site=True)
    found = tri.find_simplex(points)
    assert (found >= 0).all()
    for k in range(3):
        ends = points[tri.simplices[found]][:, [k, (k + 1) % 3]]
        assert (liftmesh.orient2d(ends[:, 0], ends[:, 1], points) >= 0).all()
    assert tri.find_simplex([100, 100]) == -1


def test_it_is_verified_as_what_it_is(points: Floats) -> None:
    found = liftmesh.scipy.Delaunay(points, furthest_site=True).verify()
    assert found.canonical
    assert found.member == "farthest"
    assert "farthest-point Delaunay triangulation" in str(found)


def test_rows_in_another_order_give_the_same_triangles() -> None:
    lattice = np.stack(np.meshgrid(np.arange(-5.0, 6), np.arange(-5.0, 6)), axis=-1).reshape(-1, 2)
    disc = lattice[(lattice**2).sum(axis=1) <= 25]
    expected = as_sets(liftmesh.scipy.Delaunay(disc, furthest_site=True).simplices)
    for _ in range(5):
        order = RNG.permutation(len(disc))
        found = liftmesh.scipy.Delaunay(disc[order], furthest_site=True)
        assert as_sets(order[found.simplices]) == expected


@pytest.mark.parametrize(
    "clone",
    [copy.copy, copy.deepcopy, lambda tri: pickle.loads(pickle.dumps(tri)), lambda t: t.to_scipy()],
)
def test_copies_keep_what_it_is(clone) -> None:
    tri = liftmesh.scipy.Delaunay(SETS["square"], furthest_site=True)
    other = clone(tri)
    assert other.furthest_site is True
    np.testing.assert_array_equal(other.equations, tri.equations)
    assert as_sets(other.simplices) == as_sets(tri.simplices)


def test_points_can_be_added() -> None:
    tri = liftmesh.scipy.Delaunay(
        [[0, 0], [2, 0], [0, 2], [1, 1]], furthest_site=True, incremental=True
    )
    assert (tri.nsimplex, tri.hidden.tolist()) == (1, [3])
    tri.add_points([[3, 3], [0, 0]])
    assert (tri.nsimplex, tri.hidden.tolist(), tri.duplicates.tolist()) == (2, [3], [[5, 0]])
    assert tri.coplanar[:, [0, 2]].tolist() == [[5, 0]]
    assert liftmesh.scipy.Delaunay([[0, 0], [2, 0], [0, 2]]).hidden.tolist() == []


def test_bad_input_is_named() -> None:
    with pytest.raises(spatial.QhullError, match="all 3 distinct points lie on one line, from row"):
        liftmesh.scipy.Delaunay([[0, 0], [1, 2], [2, 4]], furthest_site=True)
    with pytest.raises(liftmesh.DegenerateInputError, match="hold 2 distinct planar points"):
        liftmesh.scipy.Delaunay([[0, 0], [1, 2], [0, 0]], furthest_site=True)
    with pytest.raises(liftmesh.NonFiniteError, match="row 1"):
        liftmesh.scipy.Delaunay([[0, 0], [1, np.nan], [0, 0]], furthest_site=True)
    with pytest.raises(liftmesh.InputError, match="upper hull"):
        liftmesh.scipy.Delaunay([[0, 0], [1, 0], [0, 1]], furthest_site=True).lifted()
