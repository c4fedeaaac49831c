"""SciPy's class in space and beyond: exact tetrahedra; Qhull's simplices, certified or not."""

from __future__ import annotations

import copy
import pickle
import warnings

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from scipy import spatial
from scipy.interpolate import LinearNDInterpolator

import liftmesh
from liftmesh.qhull.certification import determinants, faults_of, rank_of

Points = NDArray[np.float64]
RNG = np.random.default_rng(20)
CLOUD = RNG.random((80, 3))
QUERIES = RNG.random((400, 3)) * 1.2 - 0.1
GRID = np.indices((4, 4, 4)).reshape(3, -1).T * 0.1
FOUR = RNG.random((60, 4))
BY_QHULL = spatial.Delaunay(FOUR)


def as_sets(simplices: NDArray[np.int32]) -> set[tuple[int, ...]]:
    return {*map(tuple, np.sort(simplices, axis=1).tolist())}


@pytest.fixture(scope="module")
def ours() -> liftmesh.scipy.SpaceDelaunay:
    return liftmesh.scipy.Delaunay(CLOUD)


@pytest.fixture(scope="module")
def theirs() -> spatial.Delaunay:
    return spatial.Delaunay(CLOUD)


class TestInSpace:
    def test_classes(self, ours) -> None:
        for kind in (liftmesh.scipy.Delaunay, liftmesh.scipy.SpaceDelaunay, spatial.Delaunay):
            assert isinstance(ours, kind)
        assert not isinstance(ours, liftmesh.Triangulation)
        assert not isinstance(spatial.Delaunay(CLOUD), liftmesh.scipy.Delaunay)
        assert (ours.ndim, ours.npoints, ours.nsimplex) == (3, 80, len(ours.simplices))
        assert ours.certified
        assert liftmesh.verify(ours).canonical

    def test_attributes_are_scipys(self, ours, theirs) -> None:
        assert as_sets(ours.simplices) == as_sets(theirs.simplices)
        assert as_sets(ours.convex_hull) == as_sets(theirs.convex_hull)
        np.testing.assert_array_equal(ours.min_bound, theirs.min_bound)
        np.testing.assert_array_equal(ours.max_bound, theirs.max_bound)
        for name in ("simplices", "neighbors", "equations", "good", "coplanar", "transform"):
            one, other = getattr(ours, name), getattr(theirs, name)
            assert (one.shape, one.dtype) == (other.shape, other.dtype), name
        starts, others = ours.vertex_neighbor_vertices
        expected_starts, expected = theirs.vertex_neighbor_vertices
        np.testing.assert_array_equal(starts, expected_starts)
        for row in range(80):
            here = slice(starts[row], starts[row + 1])
            assert {*others[here]} == {*expected[here]}
        assert all(row in ours.simplices[ours.vertex_to_simplex[row]] for row in range(80))

    def test_planes_of_lifted_tetrahedra(self, ours) -> None:
        lifted = ours.lift_points(CLOUD)
        np.testing.assert_array_equal(lifted[:, 3], (CLOUD * CLOUD).sum(axis=1))
        normals, offsets = ours.equations[:, :4], ours.equations[:, 4:]
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1)
        corners = lifted[ours.simplices]
        np.testing.assert_allclose((corners * normals[:, None]).sum(2) + offsets, 0, atol=1e-12)
        assert (ours.plane_distance(CLOUD) < 1e-12).all()

    def test_location(self, ours, theirs) -> None:
        found = ours.find_simplex(QUERIES)
        np.testing.assert_array_equal(found >= 0, theirs.find_simplex(QUERIES) >= 0)
        np.testing.assert_array_equal(spatial.Delaunay.find_simplex(ours, QUERIES), found)
        np.testing.assert_array_equal(spatial.tsearch(ours, QUERIES), found)

    def test_interpolation(self, ours, theirs) -> None:
        values = np.sin(5 * CLOUD).prod(axis=1)
        expected = LinearNDInterpolator(theirs, values, fill_value=-9)(QUERIES)
        actual = LinearNDInterpolator(ours, values, fill_value=-9)(QUERIES)
        np.testing.assert_allclose(actual, expected, rtol=1e-9, atol=1e-12)
        order = RNG.permutation(80)
        shuffled = liftmesh.scipy.Delaunay(CLOUD[order])
        again = LinearNDInterpolator(shuffled, values[order], fill_value=-9)(QUERIES)
        np.testing.assert_allclose(again, actual, rtol=1e-12, atol=1e-12)

    def test_no_cell_of_a_grid_is_flat_and_none_overlap(self) -> None:
        """SciPy's of such grids overlap, or are flat."""
        flat = spatial.Delaunay(GRID)
        assert (liftmesh.orient3d(*np.moveaxis(GRID[flat.simplices], 1, 0)) == 0).any()
        tri = liftmesh.scipy.Delaunay(np.vstack([GRID, GRID]))
        a, b, c, d = np.moveaxis(GRID[tri.simplices], 1, 0)
        volumes = np.einsum("ij,ij->i", b - a, np.cross(c - a, d - a)) / 6
        assert volumes.min() > 1e-4
        assert volumes.sum() == pytest.approx(0.3**3)
        np.testing.assert_array_equal(tri.duplicates[:, 0], np.arange(64, 128))
        np.testing.assert_array_equal(tri.coplanar[:, ::2], tri.duplicates)
        assert all(kept in tri.simplices[at] for _, at, kept in tri.coplanar)
        centers = GRID[tri.simplices].mean(axis=1)
        np.testing.assert_array_equal(tri.find_simplex(centers), np.arange(tri.nsimplex))

    def test_points_are_added(self) -> None:
        tri = liftmesh.scipy.Delaunay(CLOUD[:50], incremental=True)
        tri.add_points(CLOUD[50:])
        np.testing.assert_array_equal(tri.simplices, liftmesh.scipy.Delaunay(CLOUD).simplices)
        with pytest.raises(liftmesh.InputError, match="2 columns: give points of 3, as those"):
            tri.add_points([[0, 0]])
        tri.close()
        with pytest.raises(RuntimeError, match="incremental=True"):
            tri.add_points(CLOUD)

    def test_writes_and_copies(self, ours) -> None:
        expected = ours.find_simplex(QUERIES)
        mine = CLOUD.copy()
        fresh = liftmesh.scipy.Delaunay(mine, copy=True)
        mine[:] = 0
        fresh.simplices.sort()
        for clone in (copy.copy(fresh), copy.deepcopy(fresh), pickle.loads(pickle.dumps(fresh))):
            np.testing.assert_array_equal(clone.find_simplex(QUERIES), expected)
            np.testing.assert_array_equal(clone.points, CLOUD)
            assert not clone.points.flags.writeable
        fresh.neighbors += 5000
        with pytest.raises(liftmesh.InputError, match="damaged"):
            copy.copy(fresh)


class TestBeyond:
    def test_simplices_are_scipys_and_certified(self) -> None:
        tri = liftmesh.scipy.Delaunay(FOUR)
        assert isinstance(tri, liftmesh.scipy.Delaunay)
        np.testing.assert_array_equal(tri.simplices, BY_QHULL.simplices)
        np.testing.assert_array_equal(tri.convex_hull, BY_QHULL.convex_hull)
        queries = RNG.random((50, 4))
        np.testing.assert_array_equal(tri.find_simplex(queries), BY_QHULL.find_simplex(queries))
        assert tri.certified
        assert tri.faults == ()
        assert pickle.loads(pickle.dumps(tri)).certified

    def test_grids_are_not_trusted(self) -> None:
        grid = np.indices((3, 3, 3, 3)).reshape(4, -1).T
        with pytest.warns(liftmesh.DataWarning, match=r"not certified: .* 81 points .* flat cell"):
            tri = liftmesh.scipy.Delaunay(grid)
        assert not tri.certified
        assert "flat cells" in tri.faults[0]

    def test_those_that_are_too_many_are_not_certified(self, monkeypatch) -> None:
        monkeypatch.setattr("liftmesh.qhull.certification.MOST_PRODUCTS", 1000)
        with pytest.warns(liftmesh.DataWarning, match=r"none is checked: .* products"):
            assert not liftmesh.scipy.Delaunay(FOUR).certified

    def test_warnings_name_the_callers_line(self) -> None:
        grid = np.indices((3, 3, 3, 3)).reshape(4, -1).T * 1.0
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            liftmesh.scipy.SpaceDelaunay(grid)
            liftmesh.scipy.Delaunay(grid, incremental=True).add_points(grid[:1] + 9)
        assert [each.filename for each in told] == [__file__] * 3

    def test_duplicates_and_points_that_are_added(self) -> None:
        tri = liftmesh.scipy.Delaunay(np.vstack([FOUR[:40], FOUR[:3]]), incremental=True)
        assert tri.duplicates.tolist() == [[40, 0], [41, 1], [42, 2]]
        assert tri.certified
        tri.add_points(FOUR[40:])
        assert (tri.npoints, tri.certified) == (63, True)


class TestCertification:
    """Every kind of fault is found, and none where nothing is wrong, in the plane as beyond."""

    @pytest.mark.parametrize("dimension", [2, 3, 4, 5])
    def test_those_of_general_points(self, dimension: int) -> None:
        points = np.ldexp(np.random.default_rng(dimension).random((9 + dimension, dimension)), -900)
        right = spatial.Delaunay(points * 2.0**900).simplices
        assert faults_of(points, right) == []
        assert "facet" in " ".join(faults_of(points, right[1:]))
        assert faults_of(points, np.vstack([right, right[:1]])) != []

    @pytest.mark.parametrize("n", [2, 3, 4])
    def test_lattices_of_our_engines(self, n: int) -> None:
        for dimension, make in ((2, liftmesh.delaunay), (3, liftmesh.tetrahedralize)):
            points = np.indices((n,) * dimension).reshape(dimension, -1).T * 0.1
            assert faults_of(points, make(points).simplices) == []

    def test_rows_that_are_no_corners(self) -> None:
        points = np.vstack([FOUR, FOUR.mean(axis=0), FOUR[:1] * -0.0])
        assert faults_of(points, BY_QHULL.simplices)[0] == "2 points at no corner"
        assert faults_of(np.vstack([FOUR, FOUR]), BY_QHULL.simplices + 60) == []

    def test_flat_cells(self) -> None:
        square = np.array([[0.0, 0], [1, 0], [2, 0], [1, 1]])
        cells = np.array([[0, 1, 3], [1, 2, 3], [0, 1, 2]])
        assert faults_of(square, cells) == ["1 flat cell"]

    def test_the_other_diagonal(self) -> None:
        kite = np.array([[0.0, 0], [4, -1], [8, 0], [4, 1]])
        across = np.array([[0, 1, 2], [0, 2, 3]])
        assert faults_of(kite, across) == ["1 sphere with the apex of a neighbour inside"]

    def test_a_boundary_that_is_not_convex(self) -> None:
        points = np.array([[0.0, 0], [4, 0], [0, 4], [1, 1]])
        assert faults_of(points, np.array([[0, 1, 3], [0, 2, 3]])) == [
            "2 outer facets with points beyond"
        ]

    def test_what_covers_twice(self) -> None:
        """Around a middle, along a pentagram."""
        turn = np.arange(5) * 4 * np.pi / 5
        points = np.vstack([[0, 0], np.column_stack([np.cos(turn), np.sin(turn)])])
        around = np.array([[0, 1 + i, 1 + (i + 1) % 5] for i in range(5)])
        found = faults_of(points, around)
        assert any("over the first" in text for text in found)

    @settings(max_examples=60)
    @given(st.lists(st.lists(st.integers(-9, 9), min_size=4, max_size=4), min_size=4, max_size=4))
    def test_determinants(self, matrix: list[list[int]]) -> None:
        assert determinants(matrix) == round(np.linalg.det(np.array(matrix, float)))
        assert rank_of(np.vstack([np.zeros(4), matrix])) == np.linalg.matrix_rank(matrix)


class TestRefusals:
    @pytest.mark.parametrize(
        ("points", "message"),
        [
            (np.zeros((5, 3)), "5 rows hold 1 distinct point: a tetrahedron needs four"),
            (np.eye(3), "3 rows hold 3 distinct points"),
            (GRID * (1, 1, 0), "lie on one plane"),
            (np.zeros((9, 4)), "all points lie in a flat of 0 dimensions"),
            (FOUR * (1, 1, 1, 0), "all points lie in a flat of 3 dimensions"),
            (np.eye(4), "4 rows of 4 columns: a simplex needs 5"),
        ],
    )
    def test_what_spans_no_space(self, points: Points, message: str) -> None:
        for error in (spatial.QhullError, liftmesh.DegenerateInputError):
            with pytest.raises(error, match=message):
                liftmesh.scipy.Delaunay(points)

    def test_other_input(self) -> None:
        for points in (CLOUD, FOUR):
            bad = points.copy()
            bad[7, 1] = np.nan
            with pytest.raises(liftmesh.NonFiniteError, match="row 7 is not finite"):
                liftmesh.scipy.Delaunay(bad)
            with pytest.raises(liftmesh.InputError, match="furthest_site=True is for planar"):
                liftmesh.scipy.Delaunay(points, furthest_site=True)
            with pytest.raises(liftmesh.InputError, match="'QJ' moves"):
                liftmesh.scipy.Delaunay(points, qhull_options="QJ")
        with pytest.raises(liftmesh.InputError, match="give points of three or more"):
            liftmesh.scipy.SpaceDelaunay(np.zeros((5, 2)))
        with pytest.raises(liftmesh.InputError, match=r"these are columns; give points\.T"):
            liftmesh.scipy.Delaunay(CLOUD[:7].T)

    def test_classes_of_users_are_planar(self) -> None:
        class Mine(liftmesh.scipy.Delaunay):
            pass

        assert type(Mine(CLOUD[:, :2])) is Mine
        with pytest.raises(liftmesh.InputError, match=r"use liftmesh\.scipy\.SpaceDelaunay"):
            Mine(CLOUD)

    def test_nothing_is_said_of_what_is_right(self) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            liftmesh.scipy.Delaunay(CLOUD)
            liftmesh.scipy.Delaunay(FOUR.tolist())
