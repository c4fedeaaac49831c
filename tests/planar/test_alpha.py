"""Alpha complexes and shapes, against rationals by their definition."""

from __future__ import annotations

import math
import pickle
from collections import Counter
from fractions import Fraction
from itertools import combinations, pairwise

import numpy as np
import open3d as o3d
import pytest
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from oracles import alpha as oracle
from scipy.spatial import cKDTree

import liftmesh
from liftmesh import _kernel

Points = NDArray[np.float64]

SMALL = st.integers(-2, 2).map(float)
ULPS = st.integers(-2, 2).map(lambda steps: 1 + steps * 2.0**-52)
SCALES = st.sampled_from([1.0, 0.1, 2.0**-1073, 2.0**-540, 2.0**300, 2.0**1021])


def clouds(*axes: st.SearchStrategy[float]) -> st.SearchStrategy[Points]:
    rows = st.lists(st.tuples(*axes), min_size=len(axes) + 1, max_size=8)
    return st.builds(lambda points, scale: np.array(points) * scale, rows, SCALES)


def triangulated(points: Points) -> liftmesh.Triangulation | liftmesh.Tetrahedralization | None:
    make = liftmesh.delaunay if points.shape[1] == 2 else liftmesh.tetrahedralize
    try:
        return make(points)
    except liftmesh.DegenerateInputError:
        return None


def is_ceiling(radius: float, square: Fraction) -> bool:
    """Whether it is the least double that is not less than a root."""
    if radius == math.inf:
        return square > Fraction(np.finfo(np.float64).max) ** 2
    before = Fraction(math.nextafter(radius, 0))
    return before**2 < square <= Fraction(radius) ** 2


def is_nearest(radius: float, square: Fraction) -> bool:
    """Whether no other double is nearer to a root."""
    if radius == math.inf:
        return square >= Fraction(2**1024 - 2**970) ** 2
    above = math.nextafter(radius, math.inf)
    next_one = Fraction(2) ** 1024 if above == math.inf else Fraction(above)
    low = (Fraction(math.nextafter(radius, 0)) + Fraction(radius)) / 2
    return low**2 <= square <= ((Fraction(radius) + next_one) / 2) ** 2


def check(points: Points) -> None:
    found = triangulated(points)
    if found is None:
        return
    exact = [tuple(map(Fraction, row)) for row in points.tolist()]
    simplices = [[exact[row] for row in simplex] for simplex in found.simplices.tolist()]
    for simplex, radius in zip(simplices, found.circumradii().tolist(), strict=True):
        assert is_nearest(radius, oracle.smallest_sphere(simplex)[1])
    expected = oracle.filtration(exact, simplices)
    whole = found.alpha_complex()
    parts = (
        (whole.edges, whole.edge_radii),
        (whole.triangles, whole.triangle_radii),
        (whole.tetrahedra, whole.tetrahedron_radii),
    )
    count = 0
    for rows, radii in parts:
        for face, radius in zip(rows.tolist(), radii.tolist(), strict=True):
            count += 1
            assert face == sorted(face)
            assert is_ceiling(radius, expected[tuple(sorted(exact[row] for row in face))])
    assert count == len(expected)
    for radius in np.unique(np.concatenate([radii for _, radii in parts]))[::3].tolist():
        for alpha in (radius, math.nextafter(radius, 0)):
            check_shape(found, whole.at(alpha))


def check_shape(
    found: liftmesh.Triangulation | liftmesh.Tetrahedralization, part: liftmesh.AlphaComplex
) -> None:
    """The shape of a part of the complex: by its simplices and their sides."""
    shape = found.alpha_shape(part.alpha)
    size = found.simplices.shape[1]
    tops, facets = (part.tetrahedra, part.triangles) if size == 4 else (part.triangles, part.edges)
    assert np.array_equal(np.sort(shape.simplices, axis=1), tops)
    sides = Counter(face for top in tops.tolist() for face in combinations(top, size - 1))
    assert sorted(map(sorted, shape.faces.tolist())) == sorted(
        list(face) for face, times in sides.items() if times == 1
    )
    alone = {tuple(face) for face in facets.tolist()} - sides.keys()
    assert {*map(tuple, shape.singular.tolist())} == alone


@pytest.mark.slow
class TestAgainstTheDefinition:
    @settings(max_examples=45)
    @given(clouds(SMALL, SMALL))
    def test_in_the_plane(self, points: Points) -> None:
        check(points)

    @settings(max_examples=45)
    @given(clouds(SMALL, SMALL, SMALL))
    def test_in_space(self, points: Points) -> None:
        check(points)

    @settings(max_examples=20)
    @given(clouds(*[st.one_of(SMALL, ULPS, st.floats(-2, 2))] * 3))
    def test_mixed_kinds_of_doubles(self, points: Points) -> None:
        check(points)

    @pytest.mark.parametrize("seed", range(3))
    def test_random_points(self, seed: int) -> None:
        rng = np.random.default_rng([38, seed])
        check(rng.random((8, 3)))
        check(rng.normal(size=(9, 2)) + 1e6)


def turns(shape: liftmesh.AlphaShape) -> set[tuple[int, int]]:
    """The directed sides of faces."""
    return {(a, b) for face in shape.faces.tolist() for a, b in pairwise([*face, face[0]])}


class TestShapesInSpace:
    @pytest.mark.parametrize("share", [1.0, 1.6, 3.0])
    def test_surfaces_are_those_of_open3d(self, share: float) -> None:
        points = np.random.default_rng(38).random((1000, 3))
        alpha = share * 0.1
        cloud = o3d.geometry.PointCloud(o3d.utility.Vector3dVector(points))
        theirs = o3d.geometry.TriangleMesh.create_from_point_cloud_alpha_shape(cloud, alpha)
        ours = liftmesh.alpha_shape(points, alpha).to_open3d()

        def faces(mesh: o3d.geometry.TriangleMesh) -> set[tuple[int, ...]]:
            """By rows: the vertices of Open3D are rounded."""
            apart, rows = cKDTree(points).query(np.asarray(mesh.vertices))
            assert apart.max() < 1e-7
            return {tuple(sorted(face)) for face in rows[np.asarray(mesh.triangles)].tolist()}

        assert faces(ours) == faces(theirs)

    def test_faces_turn_outwards_and_enclose_the_tetrahedra(self) -> None:
        points = np.random.default_rng(7).random((400, 3))
        shape = liftmesh.alpha_shape(points, 0.13)
        for corner in (shape.simplices, shape.faces):
            assert len(corner) > 100
        a, b, c, d = np.moveaxis(points[shape.simplices], 1, 0)
        inside = np.einsum("ij,ij->i", d - a, np.cross(b - a, c - a)).sum()
        a, b, c = np.moveaxis(points[shape.faces], 1, 0)
        enclosed = np.einsum("ij,ij->i", a, np.cross(b, c)).sum()
        assert math.isclose(abs(inside), enclosed, rel_tol=1e-9)
        directed = turns(shape)
        assert all((b, a) in directed for a, b in directed)

    def test_edges_of_touching_parts_are_told(self) -> None:
        wedge = [[0, 0, 0], [0, 0, 1], [1, 0.2, 0.5], [1, -0.2, 0.5], [-1, 0.2, 0.5]]
        points = np.array([*wedge, [-1, -0.2, 0.5]])
        shape = liftmesh.tetrahedralize(points).alpha_shape(0.75)
        assert len(shape.simplices) == 2
        assert shape.nonmanifold.tolist() == [[0, 1]]

    def test_rows_stay_what_they_are(self) -> None:
        rng = np.random.default_rng(3)
        points = np.vstack([rng.random((50, 3)), rng.random((50, 3))[:20]])
        points[7] = np.nan
        points[60] = points[3]
        shape = liftmesh.alpha_shape(points, 0.4, nonfinite="skip")
        assert not {7, 60} & {*shape.vertices.tolist()}
        cloud = shape.to_cloud()
        assert np.array_equal(cloud.points, points[shape.vertices])
        assert np.array_equal(shape.vertices[cloud.faces], shape.faces)
        again = pickle.loads(pickle.dumps(shape))
        assert np.array_equal(again.faces, shape.faces)
        assert not again.faces.flags.writeable

    def test_hull_normals_of_flat_sides_take_no_wait(self) -> None:
        """A cloud of a cube's sides, on which Qhull took minutes to find outward normals."""
        u, v = np.indices((9, 9)).reshape(2, -1) / 8
        side = np.column_stack([u, v, 0 * u])
        points = np.unique(
            np.vstack(
                [np.roll(s, k, 1) for s in (side, side + np.array([0, 0, 1])) for k in range(3)]
            ),
            axis=0,
        )
        shape = liftmesh.alpha_shape(points, 1)
        directed = turns(shape)
        assert {(b, a) for a, b in directed} == directed
        a, b, c = np.moveaxis(points[shape.faces], 1, 0)
        assert (np.einsum("ij,ij->i", np.cross(b - a, c - a), a + b + c - 1.5) > 0).all()


class TestInThePlane:
    def test_rings_are_the_edges_of_the_boundary(self) -> None:
        x, y = np.indices((9, 9)).reshape(2, -1)
        kept = (abs(x - 4) > 1) | (abs(y - 4) > 1)
        shape = liftmesh.alpha_shape(np.column_stack([x, y])[kept], 0.8)
        outer, gap = shape.rings
        assert (len(outer), len(gap)) == (32, 12)
        edges = {(a, b) for ring in shape.rings for a, b in pairwise([*ring, ring[0]])}
        assert edges == {*map(tuple, shape.faces.tolist())}

    def test_meshes_are_of_the_triangles(self) -> None:
        shape = liftmesh.alpha_shape([[0, 0], [4, 0], [0, 3], [8, 8]], 3)
        assert shape.to_trimesh().area == 6
        shape = liftmesh.alpha_shape([[9, 9], [0, 0], [4, 0], [4, 4], [0, 4], [2, 2]], 3)
        assert shape.vertices.tolist() == [1, 2, 3, 4, 5]  # the last one inside

    @pytest.mark.parametrize("kind", ["weighted", "constrained", "by a metric", "farthest"])
    def test_other_triangulations_are_refused(self, kind: str) -> None:
        points = np.random.default_rng(1).random((9, 2))
        other: liftmesh.Triangulation = liftmesh.delaunay(points, metric=[[2, 0], [0, 1]])
        if kind == "weighted":
            other = liftmesh.regular(points, weights=np.zeros(9))
        elif kind == "constrained":
            other = liftmesh.constrained_delaunay(points, [[0, 1]])
        elif kind == "farthest":
            other = liftmesh.scipy.Delaunay(points, furthest_site=True)
        for call in (other.alpha_shape, other.alpha_complex, other.optimal_alpha):
            with pytest.raises(liftmesh.InputError, match="triangles with empty circles"):
                call()
        assert len(other.circumradii()) == other.nsimplex

    def test_corners_that_a_caller_has_rewritten_do_not_count(self) -> None:
        points = np.random.default_rng(2).random((30, 2))
        rewritten = liftmesh.scipy.Delaunay(points)
        own = rewritten.simplices.copy()
        rewritten.simplices[:] = -(10**6)
        fresh = liftmesh.delaunay(points)
        for simplices in (rewritten.simplices, own[:2], np.vstack([own, own, own])):
            rewritten.simplices = simplices
            shape = rewritten.alpha_shape(0.3)
            assert np.array_equal(shape.faces, fresh.alpha_shape(0.3).faces)
            assert np.array_equal(rewritten.circumradii(), fresh.circumradii())
            assert np.array_equal(rewritten.alpha_complex().edges, fresh.alpha_complex().edges)
            assert rewritten.optimal_alpha() == fresh.optimal_alpha()

    @pytest.mark.parametrize(("written", "radius"), [(math.nan, math.inf), (7.0, 0.0)])
    @pytest.mark.parametrize("columns", [2, 3])
    def test_rows_that_a_caller_has_rewritten_have_radii(
        self, columns: int, written: float, radius: float
    ) -> None:
        rows = np.random.default_rng(3).random((12, columns))
        given = liftmesh.delaunay(rows) if columns == 2 else liftmesh.tetrahedralize(rows)
        assert np.shares_memory(given.points, rows)
        rows[:] = written
        assert (given.circumradii() == radius).all()
        assert given.optimal_alpha() == radius

    def test_the_kernel_takes_a_number_for_each_simplex(self) -> None:
        points, simplices = np.eye(3), np.array([[0, 1, 2]], dtype=np.int32)
        none, all_outside = np.empty(0), np.full((1, 3), -1, np.int32)
        for call, words in (
            ("circumradii", (points, simplices, False, none)),
            ("alpha_filtration", (points, simplices, all_outside, none)),
            ("alpha_surface", (points, simplices, all_outside, 1.0, none.astype(np.uint8))),
            ("solid_alpha", (simplices, all_outside, 3, none, 1)),
            ("solid_alpha", (simplices, all_outside[:0], 3, np.ones(1), 1)),
        ):
            with pytest.raises(ValueError, match="one for each simplex"):
                getattr(_kernel, call)(*words)


class TestAlpha:
    @pytest.mark.parametrize("alpha", [math.nan, -1.0, -math.inf, "one", True, [1]])
    def test_wrong_ones(self, alpha: float) -> None:
        with pytest.raises(liftmesh.InputError, match="alpha"):
            liftmesh.alpha_shape([[0, 0, 0]], alpha)  # before anything else

    def test_the_limits(self) -> None:
        points = np.random.default_rng(5).random((30, 3))
        tetra = liftmesh.tetrahedralize(points)
        assert len(tetra.alpha_shape(math.inf).faces) == len(tetra.convex_hull)
        nothing = tetra.alpha_shape(0)
        assert len(nothing.simplices) == len(nothing.faces) == len(nothing.singular) == 0
        assert len(tetra.alpha_complex(0).vertices) == 30
        assert len(nothing.vertices) == len(nothing.nonmanifold) == 0

    def test_a_larger_one_than_the_complex_has(self) -> None:
        part = liftmesh.delaunay([[0, 0], [4, 0], [0, 3]]).alpha_complex(2)
        assert part.at(1.5).edges.tolist() == [[0, 2]]
        with pytest.raises(liftmesh.InputError, match="up to alpha 2"):
            part.at(3)

    @pytest.mark.parametrize("components", [1, 2, 3])
    @pytest.mark.parametrize("dimension", [2, 3])
    def test_the_optimal_one_is_the_least(self, dimension: int, components: int) -> None:
        rng = np.random.default_rng([dimension, 38])
        points = np.vstack([rng.random((12, dimension)) + at for at in (0, 4, 9)])
        found = triangulated(points)
        assert found is not None
        optimal = found.optimal_alpha(components)
        radii = np.unique(found.alpha_complex().triangle_radii)
        if dimension == 3:
            radii = np.unique(found.alpha_complex().tetrahedron_radii)
        good = [alpha for alpha in radii.tolist() if is_good(found, alpha, components)]
        assert optimal == good[0]
        assert found.alpha_shape().alpha == found.optimal_alpha()

    @pytest.mark.parametrize("components", [0, -1, 1.5, True, "1"])
    def test_wrong_numbers_of_components(self, components: int) -> None:
        with pytest.raises(liftmesh.InputError, match="components"):
            liftmesh.delaunay([[0, 0], [4, 0], [0, 3]]).optimal_alpha(components)


def is_good(
    found: liftmesh.Triangulation | liftmesh.Tetrahedralization, alpha: float, components: int
) -> bool:
    """Whether the shape has all points, and few parts: by flooding."""
    shape = found.alpha_shape(alpha)
    if len(np.unique(shape.simplices)) < len(found.points):
        return False
    waiting = {*np.flatnonzero(shape.mask).tolist()}
    parts = 0
    while waiting:
        parts += 1
        flood = [waiting.pop()]
        while flood:
            beside = {*found.neighbors[flood.pop()].tolist()} & waiting
            waiting -= beside
            flood += beside
    return parts <= components
