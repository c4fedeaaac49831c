"""`liftmesh.scipy.Delaunay` is SciPy's class and a `Triangulation` at once."""

from __future__ import annotations

import copy
import pickle
import subprocess
import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
import scipy.spatial
from clouds import FAMILIES
from numpy.typing import NDArray
from scipy.interpolate import (
    CloughTocher2DInterpolator,
    LinearNDInterpolator,
    NearestNDInterpolator,
)

import liftmesh

mpl.use("Agg")


@pytest.fixture(scope="module")
def points() -> NDArray[np.float64]:
    """Points in metres of a map projection, in general position."""
    return np.random.default_rng(107).random((800, 2)) * (900, 700) + (512_000, 5_403_000)


@pytest.fixture
def ours(points: NDArray[np.float64]) -> liftmesh.scipy.Delaunay:
    return liftmesh.scipy.Delaunay(points)


@pytest.fixture(scope="module")
def theirs(points: NDArray[np.float64]) -> scipy.spatial.Delaunay:
    return scipy.spatial.Delaunay(points)


def queries(count: int) -> NDArray[np.float64]:
    return np.random.default_rng(109).random((count, 2)) * (1000, 800) + (511_950, 5_402_950)


def heights(points: NDArray[np.float64]) -> NDArray[np.float64]:
    x, y = ((points - points.min(axis=0)) / 300).T
    return np.sin(x) * y


def test_it_is_both(ours) -> None:
    assert isinstance(ours, scipy.spatial.Delaunay)
    assert isinstance(ours, liftmesh.Triangulation)
    assert issubclass(liftmesh.scipy.Delaunay, scipy.spatial.Delaunay)


@pytest.mark.parametrize(
    "interpolator", [LinearNDInterpolator, CloughTocher2DInterpolator, NearestNDInterpolator]
)
@pytest.mark.parametrize("kind", [float, complex])
def test_interpolators_give_scipys_values(interpolator, kind: type, ours, theirs) -> None:
    values = heights(ours.points).astype(kind) * kind(1.5)
    wanted = queries(3000)
    actual, expected = interpolator(ours, values)(wanted), interpolator(theirs, values)(wanted)
    assert np.isfinite(expected).sum() > 1000
    np.testing.assert_allclose(actual, expected, rtol=1e-6, atol=1e-6)


def test_interpolation_takes_the_transform_that_is_there(ours) -> None:
    values = heights(ours.points)
    ours.transform[:] = np.nan  # nothing is found in triangles that are all too thin
    assert np.isnan(LinearNDInterpolator(ours, values)(queries(10))).all()


def test_location_stays_exact() -> None:
    corners = np.array([[0, 0], [1, 0], [0, 1]], dtype=float)
    ours, theirs = liftmesh.scipy.Delaunay(corners), scipy.spatial.Delaunay(corners)
    beyond = (0.5, np.nextafter(0.5, 1))
    assert ours.find_simplex((0.5, 0.5)) == 0
    assert ours.find_simplex(beyond) == -1
    assert theirs.find_simplex(beyond) == 0  # SciPy allows for rounding


def test_scipys_own_functions_take_it(ours) -> None:
    np.testing.assert_array_equal(
        scipy.spatial.tsearch(ours, queries(50)), ours.find_simplex(queries(50))
    )
    figure = scipy.spatial.delaunay_plot_2d(ours)
    assert len(figure.axes[0].lines) == 3
    mpl.pyplot.close(figure)


@pytest.mark.filterwarnings("error")
def test_distances_of_points_that_are_not_finite(ours, theirs) -> None:
    rows = np.array([[np.nan, 0], [np.inf, 0], [-np.inf, np.inf]])
    assert not np.isfinite(ours.plane_distance(rows)).any()
    assert not np.isfinite(theirs.plane_distance(rows)).any()


def test_scipys_search_finds_what_ours_finds(ours) -> None:
    found = scipy.spatial.Delaunay.find_simplex(ours, queries(2000))
    np.testing.assert_array_equal(found, ours.find_simplex(queries(2000)))


@pytest.mark.parametrize("family", ["lattice", "utm-lattice", "circle", "duplicates", "clusters"])
def test_scipys_methods_work_on_hard_points(family: str) -> None:
    points = FAMILIES[family](300, np.random.default_rng(113))
    tri = liftmesh.scipy.Delaunay(points)
    inside = points[tri.simplices].mean(axis=1)
    named = np.arange(tri.nsimplex)
    accurate = np.isfinite(tri.transform).all(axis=(1, 2))
    found = scipy.spatial.Delaunay.find_simplex(tri, inside)
    np.testing.assert_array_equal(found[accurate], named[accurate])
    hull = scipy.spatial.Delaunay.convex_hull.fget(tri)
    assert {*map(frozenset, hull.tolist())} == {*map(frozenset, tri.convex_hull.tolist())}


@pytest.mark.parametrize("kind", [np.float32, np.int16, np.float64])
@pytest.mark.parametrize("form", ["slice", "fortran", "reversed", "list"])
def test_compiled_code_reads_rows_of_any_layout(kind: type, form: str) -> None:
    rows = (np.random.default_rng(127).random((200, 3)) * 1000).astype(kind)
    given = {
        "slice": rows[:, :2],
        "fortran": np.asfortranarray(rows[:, :2]),
        "reversed": rows[::-1, 1::-1],
        "list": rows[:, :2].tolist(),
    }[form]
    tri = liftmesh.scipy.Delaunay(given)
    assert tri.points.flags.c_contiguous
    np.testing.assert_array_equal(tri.points, np.asarray(given))
    x, y = tri.points.T
    wanted = tri.points[tri.simplices].mean(axis=1)
    found = LinearNDInterpolator(tri, 2 * x - y)(wanted)
    np.testing.assert_allclose(found, wanted @ (2, -1), rtol=1e-9, atol=1e-6)


class TestWrites:
    """SciPy's users write to what they get; point location does not see it."""

    def test_sorting_the_corners(self, ours) -> None:
        expected = ours.find_simplex(queries(100))
        fresh = liftmesh.scipy.Delaunay(ours.points)
        fresh.simplices.sort()
        np.testing.assert_array_equal(fresh.find_simplex(queries(100)), expected)
        np.testing.assert_array_equal(fresh.simplices, np.sort(ours.simplices))
        assert fresh.verify().valid is False  # sorted, some are clockwise
        assert liftmesh.delaunay(ours.points).verify().valid

    def test_what_is_computed_later_follows_the_corners_as_in_scipy(self, points, theirs) -> None:
        again = scipy.spatial.Delaunay(points)
        ours = liftmesh.scipy.Delaunay(points)
        for tri in ours, again:
            tri.simplices.sort()
        order = {corners.tobytes(): row for row, corners in enumerate(again.simplices)}
        same = [order[corners.tobytes()] for corners in ours.simplices]
        np.testing.assert_allclose(ours.transform, again.transform[same], rtol=1e-5, atol=1e-7)
        compare_neighbors(ours.vertex_neighbor_vertices, again.vertex_neighbor_vertices)

    def test_edges_follow_the_corners(self, points) -> None:
        expected = {*map(tuple, liftmesh.delaunay(points).edges.tolist())}
        for change in (
            lambda tri: tri.simplices.sort(),
            lambda tri: tri.neighbors.fill(-1),
            lambda tri: setattr(tri, "simplices", tri.simplices[::-1]),
        ):
            tri = liftmesh.scipy.Delaunay(points)
            change(tri)
            assert len(tri.edges) == len(expected)
            assert {*map(tuple, tri.edges.tolist())} == expected
            assert not tri.edges.flags.writeable
        tri = liftmesh.scipy.Delaunay(points)
        tri.simplices = tri.simplices[7:9]
        ends = [sorted(pair) for corners in tri.simplices.tolist() for pair in sides(corners)]
        assert tri.edges.tolist() == [*map(list, dict.fromkeys(map(tuple, ends)))]

    def test_leaving_out_triangles(self, points) -> None:
        for tri in liftmesh.scipy.Delaunay(points), scipy.spatial.Delaunay(points):
            a, b, c = (points[corner] for corner in tri.simplices.T)
            longest = np.max([np.hypot(*(u - v).T) for u, v in ((a, b), (b, c), (c, a))], axis=0)
            tri.simplices = tri.simplices[longest < 60]
            tri.nsimplex = len(tri.simplices)
            assert 0 < tri.nsimplex < 1500
            if isinstance(tri, liftmesh.scipy.Delaunay):
                actual = tri.vertex_neighbor_vertices
        compare_neighbors(actual, tri.vertex_neighbor_vertices)

    def test_a_comparison_takes_the_triangulation_as_it_was_computed(self) -> None:
        points = np.random.default_rng(167).random((200, 2))
        for change in (lambda tri: np.sort(tri.simplices), lambda tri: tri.simplices[5:]):
            tri = liftmesh.scipy.Delaunay(points)
            tri.simplices = change(tri)
            assert liftmesh.compare(tri).verdict == "identical"

    @pytest.mark.parametrize(
        "name",
        ["simplices", "neighbors", "equations", "coplanar", "good", "nsimplex", "npoints", "ndim",
         "min_bound", "max_bound", "paraboloid_scale", "paraboloid_shift", "furthest_site"],
    )  # fmt: skip
    def test_attributes_can_be_replaced_as_scipys(self, ours, name: str) -> None:
        other = copy.copy(getattr(ours, name))
        setattr(ours, name, other)
        assert getattr(ours, name) is other

    @pytest.mark.parametrize("name", ["simplices", "neighbors", "equations", "transform", "good"])
    def test_arrays_can_be_written_to(self, ours, name: str) -> None:
        for tri in ours, pickle.loads(pickle.dumps(ours)):
            getattr(tri, name)[0] = 1
            assert (getattr(tri, name)[0] == 1).all()
            assert tri.find_simplex(tri.points[7]) >= 0

    def test_what_locates_points_cannot_be_written_to(self, ours) -> None:
        for tri in ours, pickle.loads(pickle.dumps(ours)):
            for array in tri.points, tri.duplicates, tri.skipped:
                with pytest.raises(ValueError, match="read-only"):
                    array[...] = 0


def sides(corners: list[int]) -> list[tuple[int, int]]:
    a, b, c = corners
    return [(b, c), (c, a), (a, b)]


def compare_neighbors(actual, expected) -> None:
    np.testing.assert_array_equal(actual[0], expected[0])
    for start, end in zip(actual[0], actual[0][1:], strict=False):
        assert {*actual[1][start:end]} == {*expected[1][start:end]}


@pytest.mark.parametrize(
    "again", [copy.copy, copy.deepcopy, lambda tri: pickle.loads(pickle.dumps(tri))]
)
def test_copies_are_both_too(ours, again) -> None:
    values = heights(ours.points)
    expected = LinearNDInterpolator(ours, values)(queries(100))
    twin = again(ours)
    assert type(twin) is liftmesh.scipy.Delaunay
    np.testing.assert_array_equal(LinearNDInterpolator(twin, values)(queries(100)), expected)
    np.testing.assert_array_equal(twin.find_simplex(queries(100)), ours.find_simplex(queries(100)))


def test_another_process_reads_a_pickle(ours, tmp_path: Path) -> None:
    path = tmp_path / "triangulation.pickle"
    path.write_bytes(pickle.dumps(ours))
    code = f"""
import pickle, sys
tri = pickle.loads(open({str(path)!r}, "rb").read())
from scipy.spatial import Delaunay
import liftmesh
kind = liftmesh.scipy.Delaunay
print(isinstance(tri, Delaunay), type(tri) is kind, tri.find_simplex(tri.points[3]))
"""
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["True", "True", str(ours.find_simplex(ours.points[3]))]


def test_classes_can_be_derived_from_it(points) -> None:
    class Named(liftmesh.scipy.Delaunay):
        def __init__(self, rows, name: str) -> None:
            super().__init__(rows)
            self.name = name

    tri = Named(points, "terrain")
    assert (tri.name, tri.nsimplex) == ("terrain", liftmesh.delaunay(points).nsimplex)


@pytest.mark.parametrize("power", [-300, -150, 0, 150, 300])
def test_interpolation_at_every_scale(power: int) -> None:
    unit = np.random.default_rng(137).random((300, 2)) - 0.5
    points = np.ldexp(unit, 3 * power)
    tri = liftmesh.scipy.Delaunay(points)
    x, y = unit.T
    inside = points[tri.simplices].mean(axis=1)
    assert np.isfinite(tri.transform).all()
    weights = np.einsum("mij,mj->mi", tri.transform[:, :2], inside - tri.transform[:, 2])
    np.testing.assert_allclose(weights, 1 / 3, rtol=1e-6)
    if abs(power) <= 150:  # beyond, SciPy's search overflows or loses all digits
        found = LinearNDInterpolator(tri, 2 * x - y)(inside)
        np.testing.assert_allclose(found, np.ldexp(inside, -3 * power) @ (2, -1), atol=1e-9)


class TestErrors:
    @pytest.mark.parametrize(
        "points", [np.zeros((5, 2)), [[0, 0], [1, 1]], [[0, 0], [1, 1], [3, 3]], np.zeros((0, 2))]
    )
    def test_degenerate_points_raise_both_errors(self, points) -> None:
        for kind in liftmesh.DegenerateInputError, scipy.spatial.QhullError, ValueError:
            with pytest.raises(kind):
                liftmesh.scipy.Delaunay(points)
        with pytest.raises(liftmesh.DegenerateInputError, match="triangle needs") as caught:
            liftmesh.scipy.Delaunay(points)
        twin = pickle.loads(pickle.dumps(caught.value))
        assert isinstance(twin, scipy.spatial.QhullError)
        assert str(twin) == str(caught.value)

    @pytest.mark.parametrize("columns", [2, 3])
    def test_exchanged_rows_and_columns_are_not_taken_for_points_in_space(self, columns) -> None:
        with pytest.raises(liftmesh.InputError, match=rf"not \({columns}, 50\).*give points.T"):
            liftmesh.scipy.Delaunay(np.zeros((columns, 50)))

    def test_columns_as_arguments_are_to_be_joined(self, points) -> None:
        with pytest.raises(liftmesh.InputError, match=r"np.column_stack\(\[x, y\]\) joins"):
            liftmesh.scipy.Delaunay(*points.T)

    @pytest.mark.parametrize(
        ("given", "said"),
        [
            (None, "points are None: give an array"),
            ("hill.csv", "points are a str: give an array; liftmesh.read"),
            ({"x": [0, 1, 0], "y": [0, 0, 1]}, r"column_stack\(\[points\['x'\], points\['y'\]\]\)"),
            (iter([[0, 0], [1, 0], [0, 1]]), r"give list\(points\)"),
            ({(0, 0), (1, 0), (0, 1)}, "points are a set, which has no order"),
            (np.ndarray, "points are a type"),
        ],
    )
    def test_what_is_no_array_gets_a_sentence(self, given, said: str) -> None:
        with pytest.raises(liftmesh.InputError, match=said):
            liftmesh.scipy.Delaunay(given)
        with pytest.raises(liftmesh.InputError, match=said):
            liftmesh.scipy.Delaunay(np.eye(3, 2), incremental=True).add_points(given)

    @pytest.mark.parametrize("value", [np.nan, np.inf])
    def test_rows_that_are_not_finite_cannot_be_skipped(self, points, value: float) -> None:
        rows = np.vstack([points, (value, 0)])
        with pytest.raises(liftmesh.NonFiniteError, match=r"remove such rows first$") as caught:
            liftmesh.scipy.Delaunay(rows)
        assert caught.value.row == len(points)

    def test_rows_of_different_lengths_are_named(self) -> None:
        with pytest.raises(liftmesh.InputError, match="row 2 has 1 values"):
            liftmesh.scipy.Delaunay([[0, 0], [1, 0], [2]])

    @pytest.mark.parametrize(
        "options", ["", "Qbb Qc Qz Q12", "Qc", "Qt Qbb", "Qz Qx Pp", "Q11 Qs Tv", "d Qi o s Fv"]
    )
    def test_options_of_qhull_that_change_nothing(self, options: str) -> None:
        points = np.random.default_rng(139).random((100, 2))  # elsewhere, Qhull needs its options
        tri = liftmesh.scipy.Delaunay(points, qhull_options=options)
        np.testing.assert_array_equal(tri.simplices, liftmesh.delaunay(points).simplices)
        assert tri.nsimplex == scipy.spatial.Delaunay(points, qhull_options=options).nsimplex

    @pytest.mark.parametrize(
        "options",
        ["QJ", "QJ Pp", "Qt QJ1e-6", "QbB", "Qb0:0", "QR0", "QV3", "Qg", "Pd0:0.5", "C-0.1",
         "A-0.99", "R1e-3", "Qm", "TO /etc/passwd", "v", "QbbQc"],
    )  # fmt: skip
    def test_other_options_of_qhull_are_refused(self, points, options: str) -> None:
        with pytest.raises(liftmesh.InputError, match=r"qhull_options: '.+' m.+leave it out"):
            liftmesh.scipy.Delaunay(points, qhull_options=options)

    def test_the_farthest_sites_are_an_argument(self, points) -> None:
        with pytest.raises(liftmesh.InputError, match=r"'Qu' is furthest_site=True here"):
            liftmesh.scipy.Delaunay(points, qhull_options="Qu")

    def test_options_that_are_no_string(self, points) -> None:
        with pytest.raises(liftmesh.InputError, match="qhull_options are a bytes"):
            liftmesh.scipy.Delaunay(points, qhull_options=b"Qt")
