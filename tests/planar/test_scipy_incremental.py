"""Points added to `liftmesh.scipy.Delaunay`: as if all had been there from the start."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
import scipy.spatial
from clouds import FAMILIES
from numpy.typing import NDArray
from scipy.interpolate import LinearNDInterpolator

import liftmesh


@pytest.fixture(scope="module")
def points() -> NDArray[np.float64]:
    return np.random.default_rng(149).random((300, 2))


@pytest.fixture
def growing(points) -> liftmesh.scipy.Delaunay:
    return liftmesh.scipy.Delaunay(points[:100], incremental=True)


@pytest.mark.parametrize("restart", [False, True])
@pytest.mark.parametrize("family", ["lattice", "utm-lattice", "circle", "duplicates", "clusters"])
def test_added_points_give_the_triangulation_of_all(family: str, restart: bool) -> None:
    points = FAMILIES[family](300, np.random.default_rng(151))
    tri = liftmesh.scipy.Delaunay(points[:50], incremental=True)
    for start, end in ((50, 51), (51, 180), (180, 300)):
        tri.add_points(points[start:end], restart=restart)
    whole = liftmesh.scipy.Delaunay(points)
    assert (tri.npoints, tri.nsimplex) == (whole.npoints, whole.nsimplex)
    for name in ("points", "simplices", "neighbors", "convex_hull", "coplanar", "duplicates"):
        np.testing.assert_array_equal(getattr(tri, name), getattr(whole, name))
    assert tri.verify().canonical


def test_what_was_computed_before_is_computed_anew(growing, points) -> None:
    names = (
        "points", "simplices", "neighbors", "equations", "transform", "vertex_to_simplex",
        "convex_hull", "coplanar", "good", "min_bound", "max_bound",
    )  # fmt: skip
    before = {name: getattr(growing, name).copy() for name in names}
    held = growing.simplices
    starts, _ = growing.vertex_neighbor_vertices
    growing.find_simplex(points)
    growing.add_points(points[100:])
    whole = liftmesh.scipy.Delaunay(points)
    for name in names:
        np.testing.assert_array_equal(getattr(growing, name), getattr(whole, name))
    assert len(growing.vertex_neighbor_vertices[0]) == len(starts) + 200
    np.testing.assert_array_equal(growing.find_simplex(points), whole.find_simplex(points))
    np.testing.assert_array_equal(held, before["simplices"])


def test_scipys_interpolators_take_what_has_grown(growing, points) -> None:
    growing.add_points(points[100:])
    theirs = scipy.spatial.Delaunay(points[:100], incremental=True)
    theirs.add_points(points[100:])
    queries = np.random.default_rng(157).random((500, 2))
    values = np.sin(points @ (5, 3))
    actual, expected = (LinearNDInterpolator(tri, values)(queries) for tri in (growing, theirs))
    np.testing.assert_allclose(actual, expected, rtol=1e-9, atol=1e-9)


def test_the_callers_array_is_not_looked_at_again(points) -> None:
    given = points.copy()
    tri = liftmesh.scipy.Delaunay(given, incremental=True)
    given[:] = 0
    assert tri.verify().valid


def test_no_points_add_nothing(growing) -> None:
    held = growing.simplices
    growing.add_points(np.empty((0, 2)))
    assert growing.simplices is held


def test_tuples_and_attributes_of_the_callers_own(growing) -> None:
    growing.name = "terrain"
    growing.add_points([(0.5, 0.5), (0.25, 0.5)])
    assert (growing.npoints, growing.name) == (102, "terrain")


def finished(points) -> list[liftmesh.scipy.Delaunay]:
    closed = liftmesh.scipy.Delaunay(points, incremental=True)
    closed.close()
    return [liftmesh.scipy.Delaunay(points), closed, pickle.loads(pickle.dumps(closed))]


def test_only_an_open_triangulation_grows(points) -> None:
    for tri in finished(points):
        with pytest.raises(liftmesh.InputError, match="incremental=True"):
            tri.add_points(points)
        with pytest.raises(RuntimeError, match="incremental=True"):
            tri.add_points(points)
        tri.close()


def test_one_that_was_pickled_grows_on(growing, points) -> None:
    twin = pickle.loads(pickle.dumps(growing))
    twin.add_points(points[100:])
    assert (twin.npoints, growing.npoints) == (300, 100)


@pytest.mark.parametrize(
    ("added", "message"),
    [
        ([[0.5, np.nan]], "row 0 is not finite"),
        ([[0.5, 0.5], [np.inf, 0]], "row 1 is not finite"),
        ([0.5, 0.5], r"not \(2,\)"),
        ([[1, 2, 3]], "3 columns"),
        ([["a", "b"]], "give real numbers"),
        ([], r"not \(0,\)"),
    ],
)
def test_after_an_error_nothing_has_changed(growing, added, message: str) -> None:
    before = growing.simplices.copy()
    with pytest.raises(liftmesh.InputError, match=message):
        growing.add_points(added)
    np.testing.assert_array_equal(growing.simplices, before)
    assert growing.npoints == 100
    assert growing.find_simplex(growing.points[5]) >= 0


def test_degenerate_points_are_refused_in_the_incremental_mode_too() -> None:
    with pytest.raises(scipy.spatial.QhullError):
        liftmesh.scipy.Delaunay([[0, 0], [1, 1]], incremental=True)
