"""Points on the sphere: against square roots of many digits, SciPy, and themselves."""

from __future__ import annotations

import math
import pickle
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from oracles import sphere as oracle
from scipy.spatial import ConvexHull

import liftmesh
from liftmesh import _kernel

Points = NDArray[np.float64]

SMALL = st.tuples(*[st.integers(-2, 2)] * 3).filter(any)
EQUATOR = st.tuples(st.integers(-2, 2), st.integers(-2, 2), st.just(0)).filter(any)


def check(rays: list[tuple[int, int, int]], scale: float = 1.0) -> None:
    """What is found is what the definition says of the directions."""
    first: dict[oracle.Ray, oracle.Ray] = {}
    for ray in rays:
        first.setdefault(oracle.direction(ray), ray)
    chosen = [*first.values()]
    points = np.array(rays, dtype=np.float64) * scale
    if len(chosen) < 4:
        with pytest.raises(liftmesh.DegenerateInputError, match="need four"):
            liftmesh.spherical_delaunay(points)
        return
    tri = liftmesh.spherical_delaunay(points)
    found = [tuple(rays[row] for row in corners) for corners in tri.simplices.tolist()]
    assert len(found) == 2 * len(chosen) - 4
    assert {*map(oracle.from_least, found)} == oracle.triangles(chosen)
    for row, kept in tri.duplicates.tolist():
        assert oracle.direction(rays[row]) == oracle.direction(rays[kept])
        assert kept < row
    assert len({*tri.duplicates[:, 0].tolist()} | {*tri.simplices.ravel().tolist()}) == len(rays)
    assert tri.verify().canonical
    assert math.isclose(tri.areas.sum(), 4 * math.pi, rel_tol=1e-9)


@pytest.mark.slow
class TestAgainstTheDefinition:
    @settings(max_examples=40)
    @given(st.lists(SMALL, min_size=1, max_size=7), st.sampled_from([1.0, 2.0**-1073, 2.0**1000]))
    def test_small_integers(self, rays: list[tuple[int, int, int]], scale: float) -> None:
        check(rays, scale)

    @settings(max_examples=20)
    @given(st.lists(EQUATOR, min_size=4, max_size=6), st.lists(SMALL, max_size=2))
    def test_great_circles(
        self, circle: list[tuple[int, int, int]], others: list[tuple[int, int, int]]
    ) -> None:
        check([*circle, *others])
        check([(z, x, y) for x, y, z in [*circle, *others]])


def on_sphere(n: int, seed: int = 38) -> Points:
    points = np.random.default_rng(seed).normal(size=(n, 3))
    return points / np.linalg.norm(points, axis=1)[:, None]


def as_sets(simplices: NDArray[np.int32]) -> set[tuple[int, ...]]:
    return {tuple(sorted(corners)) for corners in simplices.tolist()}


class TestTriangles:
    def test_random_ones_are_those_of_qhull(self) -> None:
        points = on_sphere(2000)
        tri = liftmesh.spherical_delaunay(points)
        assert as_sets(tri.simplices) == as_sets(ConvexHull(points).simplices)
        assert tri.verify().canonical
        for k in range(3):
            beside = tri.simplices[tri.neighbors[:, k]]
            edge = np.delete(tri.simplices, k, axis=1)
            assert (edge[:, :, None] == beside[:, None, :]).any(axis=2).all()

    def test_the_order_of_rows_makes_no_difference(self) -> None:
        lon, lat = np.meshgrid(np.arange(-180, 180, 30), np.arange(-90, 91, 30))
        lon, lat = lon.ravel(), lat.ravel()
        tri = liftmesh.spherical_delaunay(lon, lat)
        order = np.random.default_rng(1).permutation(len(lon))
        other = liftmesh.spherical_delaunay(np.column_stack([lon, lat])[order])
        assert len(tri.duplicates) == len(other.duplicates) == 22

        def places(found: liftmesh.SphericalTriangulation) -> set[tuple[bytes, ...]]:
            return {tuple(sorted(p.tobytes() for p in t)) for t in found.points[found.simplices]}

        assert places(tri) == places(other)
        assert tri.verify().canonical

    def test_rows_a_billionth_apart_are_all_vertices(self) -> None:
        """Rounded unit vectors so near to each other are inside of their hull, many of them."""
        near = 45 + np.random.default_rng(2).random((300, 2)) * 1e-7
        tri = liftmesh.spherical_delaunay(np.vstack([near, [[0, 0], [90, 0], [0, -90], [200, 9]]]))
        assert len(tri.simplices) == 2 * 304 - 4
        assert len(ConvexHull(tri.points).vertices) < 304
        assert tri.verify().canonical
        assert (tri.areas > 0).all()

    def test_doubles_of_other_lengths_break_no_tie(self) -> None:
        cube = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * 1.0
        alone = liftmesh.spherical_delaunay(cube)
        for factors in ((0.5,), (3.0, 0.25), (0.5, 0.7, 7.0)):
            rows = np.vstack([cube, *(factor * cube for factor in factors)])
            tri = liftmesh.spherical_delaunay(rows)
            assert as_sets(tri.simplices) == as_sets(alone.simplices)
            assert len(tri.duplicates) == len(rows) - 8
            assert tri.verify().canonical
            for secret in range(20):  # which decides who is inserted first
                found = _kernel.spherical_delaunay(rows, False, secret, None)[3]
                assert np.array_equal(found, tri.simplices)
            shorter = liftmesh.spherical_delaunay(rows[::-1].copy())
            assert len(shorter.simplices) == 12
            assert shorter.verify().canonical

    def test_lengths_do_not_count(self) -> None:
        points = on_sphere(300)
        scaled = np.ldexp(points, np.random.default_rng(3).integers(-900, 900, (300, 1)))
        assert as_sets(liftmesh.spherical_delaunay(scaled).simplices) == as_sets(
            liftmesh.spherical_delaunay(points).simplices
        )

    def test_poles_and_the_antimeridian_are_exact(self) -> None:
        lon = np.array([0, 90, 180, -180, 540, 17, -33, 270, -90])
        lat = np.array([0, 0, 0, 0, 0, 90, 90, -90, 0])
        tri = liftmesh.spherical_delaunay(lon, lat)
        assert tri.duplicates.tolist() == [[3, 2], [4, 2], [6, 5]]
        assert set(np.abs(tri.points).ravel().tolist()) == {0.0, 1.0}
        in_radians = liftmesh.spherical_delaunay(*np.deg2rad([lon, lat]), degrees=False)
        assert np.allclose(in_radians.points, tri.points)

    def test_an_infinite_latitude_is_not_finite_and_beyond_no_pole(self) -> None:
        lon, lat = [0.0, 90.0, 180.0, 270.0, 0.0], [10.0, -10.0, 20.0, -20.0, np.inf]
        with pytest.raises(liftmesh.NonFiniteError, match="row 4"):
            liftmesh.spherical_delaunay(lon, lat)
        assert liftmesh.spherical_delaunay(lon, lat, nonfinite="skip").skipped.tolist() == [4]

    def test_a_hemisphere_and_a_circle_have_cells_too(self) -> None:
        lon = np.arange(0, 360, 45)
        one = liftmesh.spherical_delaunay(lon, 0 * lon)  # lunes
        assert np.allclose(one.areas, 4 * np.pi / 8)
        north = liftmesh.spherical_delaunay([*lon, 5], [*0 * lon, 70])
        assert math.isclose(north.areas.sum(), 4 * np.pi)
        assert one.verify().canonical
        assert north.verify().canonical


class TestCells:
    def test_corners_are_the_centres_around_each_row(self) -> None:
        points = on_sphere(200)
        tri = liftmesh.spherical_delaunay(np.vstack([points, points[3]]))
        indptr, indices = tri.cells
        assert indptr[-1] == indptr[-2] == 3 * len(tri.simplices)
        for row in range(200):
            own = indices[indptr[row] : indptr[row + 1]]
            assert (tri.simplices[own] == row).any(axis=1).all()
            corners = tri.centers[own]
            turns = np.cross(np.roll(corners, 1, axis=0) - points[row], corners - points[row])
            assert (turns @ points[row] > 0).all()
        assert tri.areas[200] == 0

    def test_centers_are_as_far_from_their_corners(self) -> None:
        tri = liftmesh.spherical_delaunay(on_sphere(500))
        a, b, c = np.moveaxis(tri.points[tri.simplices], 1, 0)
        for p, q in ((a, b), (b, c)):
            assert np.abs(np.einsum("ij,ij->i", tri.centers, p - q)).max() < 1e-15


class TestFlawsAreFound:
    @pytest.mark.parametrize(
        ("corner", "kind"), [(0, "non_manifold_edges"), (1, "non_manifold_edges")]
    )
    def test_another_corner(self, corner: int, kind: str) -> None:
        tri = liftmesh.spherical_delaunay(on_sphere(20))
        simplices = tri.simplices.copy()
        simplices[4, corner] = simplices[9, 0]
        wrong = replace(tri, simplices=simplices).verify()
        assert not wrong
        assert kind in {flaw.kind for flaw in wrong.flaws}

    def test_turned_triangles_and_missing_rows(self) -> None:
        tri = liftmesh.spherical_delaunay(on_sphere(20))
        none = np.empty((0, 3), dtype=np.int32)
        nothing = replace(tri, simplices=none, neighbors=none).verify()
        assert {"no_triangles", "missing_vertices"} <= {flaw.kind for flaw in nothing.flaws}
        inside_out = replace(tri, simplices=tri.simplices[:, ::-1].copy()).verify()
        assert {"not_convex", "not_delaunay"} <= {flaw.kind for flaw in inside_out.flaws}
        more = replace(tri, points=np.vstack([tri.points, [[1, 2, 3]]])).verify()
        assert [flaw.kind for flaw in more.flaws] == ["missing_vertices"]

    def test_a_flipped_edge(self) -> None:
        points = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0.5], [0.1, 0, -1]])
        tri = liftmesh.spherical_delaunay(points)
        own = tri.simplices.tolist()
        for t, corners in enumerate(own):
            for k in range(3):
                other = int(tri.neighbors[t, k])
                apex = ({*own[other]} - {*corners}).pop()
                a, b, c = (corners[(k + step) % 3] for step in range(3))
                flipped = tri.simplices.copy()
                flipped[t], flipped[other] = (a, b, apex), (a, apex, c)
                assert not replace(tri, simplices=flipped).verify()

    def test_copies(self) -> None:
        tri = liftmesh.spherical_delaunay(on_sphere(20))
        again = pickle.loads(pickle.dumps(tri))
        assert np.array_equal(again.simplices, tri.simplices)
        assert not again.points.flags.writeable


class TestWrongInput:
    def test_rows(self) -> None:
        points = on_sphere(9)
        points[4] = 0
        with pytest.raises(liftmesh.InputError, match="row 4"):
            liftmesh.spherical_delaunay(points)
        points[4] = np.nan
        with pytest.raises(liftmesh.NonFiniteError, match="row 4"):
            liftmesh.spherical_delaunay(points)
        tri = liftmesh.spherical_delaunay(points, nonfinite="skip")
        assert tri.skipped.tolist() == [4]
        assert tri.verify().canonical
        assert tri.areas[4] == 0

    @pytest.mark.parametrize(("lon", "lat"), [([0, 1], [0]), ([[0, 1]], [[0, 1]]), ("a", "b")])
    def test_columns(self, lon: object, lat: object) -> None:
        with pytest.raises(liftmesh.InputError, match=r"point|shapes"):
            liftmesh.spherical_delaunay(lon, lat)

    def test_latitudes_beyond_a_pole(self) -> None:
        with pytest.raises(liftmesh.InputError, match="row 2 has the latitude 91"):
            liftmesh.spherical_delaunay([0, 1, 2, 3], [0, 9, 91, 5])

    def test_too_few_directions(self) -> None:
        with pytest.raises(liftmesh.DegenerateInputError, match="5 rows of 3 different directions"):
            liftmesh.spherical_delaunay([[1, 0, 0], [2, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 3]])
        with pytest.raises(liftmesh.DegenerateInputError, match="need four"):
            liftmesh.spherical_delaunay(np.empty((0, 3)))


def test_the_order_of_insertion_changes_nothing_of_equal_directions() -> None:
    directions = np.random.default_rng(4).integers(-3, 4, (400, 3)).astype(float)
    rays = directions[directions.any(axis=1)]
    rays = np.concatenate([rays, 3 * rays[::-1]])
    runs = [_kernel.spherical_delaunay(rays, False, secret, None)[3:] for secret in range(5)]
    for run in runs[1:]:
        for one, other in zip(run, runs[0], strict=True):
            np.testing.assert_array_equal(one, other)
