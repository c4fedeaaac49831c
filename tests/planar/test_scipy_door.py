"""Code written for SciPy's Delaunay runs on liftmesh's, with one import line changed."""

from __future__ import annotations

import copy
import doctest
import pickle
from itertools import pairwise

import matplotlib as mpl
import numpy as np
import pytest
import scipy.spatial
from clouds import FAMILIES
from matplotlib.tri import LinearTriInterpolator, Triangulation as PlotTriangulation
from numpy.typing import NDArray
from scipy.interpolate import CloughTocher2DInterpolator, LinearNDInterpolator

import liftmesh

mpl.use("Agg")


@pytest.fixture(scope="module")
def points() -> NDArray[np.float64]:
    """Generic points: every program must find the same triangles."""
    return np.random.default_rng(67).random((500, 2)) * (3, 2) + (10, -4)


@pytest.fixture(scope="module")
def ours(points: NDArray[np.float64]) -> liftmesh.scipy.Delaunay:
    return liftmesh.scipy.Delaunay(points)


@pytest.fixture(scope="module")
def theirs(points: NDArray[np.float64]) -> scipy.spatial.Delaunay:
    return scipy.spatial.Delaunay(points)


@pytest.fixture(scope="module")
def same_row(ours: liftmesh.scipy.Delaunay, theirs: scipy.spatial.Delaunay) -> NDArray[np.int64]:
    """For each of our triangles the row in which SciPy holds it."""
    rows = {frozenset(corners): row for row, corners in enumerate(theirs.simplices.tolist())}
    return np.array([rows[frozenset(corners)] for corners in ours.simplices.tolist()])


def run_documented_examples(delaunay: str) -> dict:
    """Run the statements of SciPy's own documentation with another import line."""
    names: dict = {}
    for example in doctest.DocTestParser().get_examples(scipy.spatial.Delaunay.__doc__):
        source = example.source.replace("from scipy.spatial import Delaunay", delaunay)
        exec(compile(source, "<documentation>", "single"), names)
    return names


@pytest.mark.usefixtures("capsys")
def test_scipys_documented_examples() -> None:
    names = run_documented_examples("from liftmesh.scipy import Delaunay")
    expected = run_documented_examples("from scipy.spatial import Delaunay")
    ours, theirs, p = names["tri"], expected["tri"], names["p"]
    assert isinstance(ours, liftmesh.scipy.Delaunay)
    assert isinstance(theirs, scipy.spatial.Delaunay)
    assert {*map(frozenset, ours.simplices.tolist())} == {
        *map(frozenset, theirs.simplices.tolist())
    }
    np.testing.assert_array_equal(ours.find_simplex(p) >= 0, theirs.find_simplex(p) >= 0)
    np.testing.assert_array_equal(
        np.sort(ours.simplices[ours.find_simplex(names["p_valids"])]),
        np.sort(theirs.simplices[theirs.find_simplex(names["p_valids"])]),
    )
    assert sorted(ours.neighbors[1].tolist()) == [-1, -1, 0]


@pytest.mark.usefixtures("capsys")
def test_documented_barycentric_coordinates_reproduce_the_points() -> None:
    names = run_documented_examples("from liftmesh.scipy import Delaunay")
    tri, p, b = names["tri"], names["p"], names["b"]
    weights = np.c_[np.transpose(b), 1 - b.sum(axis=0)]
    np.testing.assert_allclose(weights @ names["points"][tri.simplices[1]], p, atol=1e-14)


def test_every_attribute_of_scipys_is_there(
    ours: liftmesh.scipy.Delaunay, theirs: scipy.spatial.Delaunay
) -> None:
    expected = {name for name in dir(theirs) if not name.startswith("_")}
    assert expected <= set(dir(ours))


@pytest.mark.parametrize(
    "name",
    [
        "points",
        "simplices",
        "neighbors",
        "convex_hull",
        "coplanar",
        "vertex_to_simplex",
        "transform",
        "equations",
        "min_bound",
        "max_bound",
        "good",
    ],
)
def test_arrays_have_the_shape_and_dtype_of_scipys(ours, theirs, name: str) -> None:
    actual, expected = getattr(ours, name), getattr(theirs, name)
    assert actual.shape == expected.shape
    assert actual.dtype == expected.dtype


@pytest.mark.parametrize("name", ["ndim", "npoints", "nsimplex", "furthest_site"])
def test_numbers_equal_scipys(ours, theirs, name: str) -> None:
    assert getattr(ours, name) == getattr(theirs, name)
    assert type(getattr(ours, name)) is type(getattr(theirs, name))


def test_bounds_equal_scipys(ours, theirs) -> None:
    np.testing.assert_array_equal(ours.min_bound, theirs.min_bound)
    np.testing.assert_array_equal(ours.max_bound, theirs.max_bound)


def test_neighbors_equal_scipys(ours, theirs, same_row: NDArray[np.int64]) -> None:
    row_or_none = np.append(same_row, -1)
    for row, (corners, neighbors) in enumerate(zip(ours.simplices, ours.neighbors, strict=True)):
        there = theirs.simplices[same_row[row]].tolist()
        expected = [theirs.neighbors[same_row[row], there.index(corner)] for corner in corners]
        assert row_or_none[neighbors].tolist() == expected


def test_hull_edges_equal_scipys(ours, theirs) -> None:
    assert {*map(frozenset, ours.convex_hull.tolist())} == {
        *map(frozenset, theirs.convex_hull.tolist())
    }


def test_vertex_neighbors_equal_scipys(ours, theirs) -> None:
    (starts, indices), (their_starts, their_indices) = (
        ours.vertex_neighbor_vertices,
        theirs.vertex_neighbor_vertices,
    )
    np.testing.assert_array_equal(starts, their_starts)
    assert indices.dtype == their_indices.dtype
    for start, end in pairwise(starts):
        assert set(indices[start:end]) == set(their_indices[start:end])


def test_transforms_give_barycentric_coordinates(ours) -> None:
    corners = ours.points[ours.simplices]
    centered = corners - ours.transform[:, None, 2]
    weights = np.einsum("mij,mkj->mki", ours.transform[:, :2], centered)
    np.testing.assert_allclose(weights, np.tile(np.eye(3)[:, :2], (len(corners), 1, 1)), atol=1e-7)


def test_transforms_equal_scipys_where_the_corners_agree(ours, theirs, same_row) -> None:
    alike = (ours.simplices == theirs.simplices[same_row]).all(axis=1)
    assert alike.any()
    np.testing.assert_allclose(
        ours.transform[alike], theirs.transform[same_row[alike]], rtol=1e-6, atol=1e-6
    )


def test_equations_are_planes_through_the_lifted_corners(ours) -> None:
    lifted = ours.lift_points(ours.points[ours.simplices])
    normals, offsets = ours.equations[:, :3], ours.equations[:, 3]
    np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1)
    assert (normals[:, 2] < 0).all()
    heights = np.einsum("mki,mi->mk", lifted, normals) + offsets[:, None]
    np.testing.assert_allclose(heights, 0, atol=1e-8)


def test_the_paraboloid_is_what_lift_points_lifts_to(ours) -> None:
    x, y, z = ours.lift_points(ours.points).T
    np.testing.assert_array_equal(np.column_stack((x, y)), ours.points)
    scale, shift = ours.paraboloid_scale, ours.paraboloid_shift
    np.testing.assert_allclose(z, scale * (x * x + y * y) + shift)
    assert type(scale) is type(shift) is float


def test_plane_distances_have_scipys_shape_and_sign(ours, theirs, same_row) -> None:
    queries = np.random.default_rng(71).random((20, 2)) * (3, 2) + (10, -4)
    actual, expected = ours.plane_distance(queries), theirs.plane_distance(queries)[:, same_row]
    assert actual.shape == expected.shape == (20, ours.nsimplex)
    clear = abs(expected) > 1e-9
    np.testing.assert_array_equal(np.sign(actual)[clear], np.sign(expected)[clear])


def test_plane_distance_is_largest_where_the_point_lies(ours) -> None:
    queries = ours.points[ours.simplices].mean(axis=1)
    lowest = -ours.equations[:, 2]
    above = ours.plane_distance(queries) / lowest
    rows = np.arange(len(queries))
    np.testing.assert_allclose(above[rows, rows], above.max(axis=1), atol=1e-8)


def test_coplanar_rows_are_duplicates_as_scipy_reports_them() -> None:
    points = np.array([[0, 0], [2, 0], [0, 2], [2, 3], [0, 0], [2, 3], [0, 0]], dtype=float)
    actual, expected = liftmesh.scipy.Delaunay(points), scipy.spatial.Delaunay(points)
    assert len(actual.coplanar) == len(expected.coplanar) == 3
    np.testing.assert_array_equal(points[actual.coplanar[:, 0]], points[actual.coplanar[:, 2]])
    for found in actual.coplanar, expected.coplanar:  # both in the order of the triangles
        assert (np.diff(found[:, 1]) >= 0).all()


@pytest.mark.parametrize("made", [liftmesh.delaunay, liftmesh.scipy.Delaunay])
def test_every_row_has_a_triangle_at_its_position(made) -> None:
    points = np.random.default_rng(101).random((60, 2))[
        np.random.default_rng(103).permutation(90) % 60
    ]
    tri = made(points)
    assert len(tri.duplicates) == 30
    corners = tri.points[tri.simplices[tri.vertex_to_simplex]]
    assert (corners == points[:, None]).all(axis=2).any(axis=1).all()
    row, triangle, kept = tri.coplanar.T
    np.testing.assert_array_equal(triangle, tri.vertex_to_simplex[row])
    np.testing.assert_array_equal(triangle, tri.vertex_to_simplex[kept])
    assert (np.diff(triangle) >= 0).all()


def test_skipped_rows_have_no_triangle() -> None:
    points = [[0, 0], [np.nan, 0], [2, 0], [0, 2], [0, 2]]
    tri = liftmesh.delaunay(points, nonfinite="skip")
    assert tri.vertex_to_simplex.tolist() == [0, -1, 0, 0, 0]


def test_scipys_functions_take_it(ours, theirs) -> None:
    queries = np.random.default_rng(73).random((30, 2)) * (3, 2) + (10, -4)
    found = scipy.spatial.tsearch(ours, queries)
    np.testing.assert_array_equal(found, ours.find_simplex(queries))
    figure = scipy.spatial.delaunay_plot_2d(ours)
    assert len(figure.axes[0].lines) == 3
    mpl.pyplot.close(figure)


@pytest.mark.parametrize("interpolator", [LinearNDInterpolator, CloughTocher2DInterpolator])
def test_interpolators_give_what_they_give_on_scipys_own(interpolator, ours, theirs) -> None:
    values = np.sin(ours.points[:, 0] * 3) * ours.points[:, 1]
    queries = np.random.default_rng(79).random((3000, 2)) * (3.2, 2.2) + (9.9, -4.1)
    expected = interpolator(theirs, values)(queries)
    assert np.isnan(expected).any()
    assert np.isfinite(expected).any()
    for tri in ours, ours.to_scipy():
        actual = interpolator(tri, values)(queries)
        np.testing.assert_allclose(actual, expected, rtol=1e-5, atol=1e-5)


@pytest.mark.parametrize("family", ["lattice", "utm-lattice", "circle", "duplicates", "clusters"])
def test_interpolators_reproduce_a_plane_on_hard_points(family: str) -> None:
    points = FAMILIES[family](400, np.random.default_rng(83))
    corner = points.min(axis=0)
    values = (points - corner) @ (2.0, -3.0) + 1
    inside = points[liftmesh.delaunay(points).simplices].mean(axis=1)
    expected = (inside - corner) @ (2.0, -3.0) + 1
    for tri in liftmesh.scipy.Delaunay(points), liftmesh.delaunay(points).to_scipy():
        surface = LinearNDInterpolator(tri, values)
        np.testing.assert_allclose(surface(inside), expected, rtol=1e-6, atol=1e-6)


@pytest.fixture(scope="module")
def real(ours: liftmesh.scipy.Delaunay) -> scipy.spatial.Delaunay:
    return ours.to_scipy()


class TestToScipy:
    def test_it_is_an_instance(self, real) -> None:
        assert type(real) is scipy.spatial.Delaunay

    @pytest.mark.parametrize(
        "name",
        ["points", "simplices", "neighbors", "coplanar", "equations", "good", "vertex_to_simplex"],
    )
    def test_its_arrays_are_ours(self, real, ours, name: str) -> None:
        np.testing.assert_array_equal(getattr(real, name), getattr(ours, name))

    def test_its_own_hull_and_vertex_table_are_as_right_as_ours(self, real, ours) -> None:
        assert {*map(frozenset, real.convex_hull.tolist())} == {
            *map(frozenset, ours.convex_hull.tolist())
        }
        vertices = np.arange(ours.npoints)
        assert (real.simplices[real.vertex_to_simplex] == vertices[:, None]).any(axis=1).all()

    def test_it_takes_our_transform_and_finds_neighbors_of_vertices(self, real, ours) -> None:
        assert real.transform is ours.transform
        starts, _ = real.vertex_neighbor_vertices
        np.testing.assert_array_equal(starts, ours.vertex_neighbor_vertices[0])

    @pytest.mark.parametrize("bruteforce", [False, True])
    def test_its_own_search_finds_what_ours_finds(self, real, ours, bruteforce: bool) -> None:
        queries = np.random.default_rng(89).random((500, 2)) * (3.2, 2.2) + (9.9, -4.1)
        found = real.find_simplex(queries, bruteforce=bruteforce)
        np.testing.assert_array_equal(found, ours.find_simplex(queries))

    def test_its_plane_distance_is_ours(self, real, ours) -> None:
        queries = np.random.default_rng(97).random((5, 2))
        np.testing.assert_allclose(real.plane_distance(queries), ours.plane_distance(queries))


def test_the_call_is_scipys(points: NDArray[np.float64], ours: liftmesh.scipy.Delaunay) -> None:
    again = liftmesh.scipy.Delaunay(
        points, furthest_site=False, incremental=False, qhull_options="Qbb Qc Qz Q12"
    )
    np.testing.assert_array_equal(again.simplices, ours.simplices)


def test_furthest_site_is_yes_or_no(points: NDArray[np.float64]) -> None:
    with pytest.raises(liftmesh.InputError, match="furthest_site"):
        liftmesh.scipy.Delaunay(points, furthest_site="Qu")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "clone", [copy.copy, copy.deepcopy, lambda t: pickle.loads(pickle.dumps(t))]
)
def test_copies_and_pickles(ours: liftmesh.scipy.Delaunay, clone) -> None:
    ours.find_simplex([0.5, 0.5])
    other = clone(ours)
    assert type(other) is liftmesh.scipy.Delaunay
    np.testing.assert_array_equal(other.simplices, ours.simplices)
    np.testing.assert_array_equal(other.find_simplex(ours.points), ours.find_simplex(ours.points))


def test_matplotlib_takes_the_triangles(ours, points: NDArray[np.float64]) -> None:
    plot = PlotTriangulation(*points.T, ours.simplices)
    np.testing.assert_array_equal(plot.triangles, ours.simplices)
    assert len(plot.edges) == (3 * ours.nsimplex + len(ours.convex_hull)) / 2
    surface = LinearTriInterpolator(plot, points @ (1.0, 2.0))
    middle = points[ours.simplices].mean(axis=1)
    np.testing.assert_allclose(surface(*middle.T), middle @ (1.0, 2.0))
