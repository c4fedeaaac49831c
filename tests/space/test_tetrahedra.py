"""Tetrahedra: against exact integers, CGAL, and themselves in every order."""

from __future__ import annotations

import pickle
from itertools import permutations

import numpy as np
import pytest
from CGAL.CGAL_Kernel import Point_3
from CGAL.CGAL_Triangulation_3 import Delaunay_triangulation_3
from hypothesis import given, settings, strategies as st
from numpy.typing import ArrayLike, NDArray
from oracles import planar, space as oracle
from space_clouds import SPACE, sphere
from stopped import LONG_RUN, seconds_to_stop

import liftmesh
from liftmesh.space import tetrahedra as module

Points = NDArray[np.float64]
Found = set[tuple[tuple[float, ...], ...]]

SMALL = st.integers(-2, 2).map(float)
STEPS = st.integers(-2, 2).map(lambda steps: steps * 2.0**-1074)
ULPS = st.integers(-2, 2).map(lambda steps: 1 + steps * 2.0**-52)
SCALES = st.sampled_from([2.0**-1070, 2.0**-537, 0.1, 1.0, 1 / 3, 2.0**300, 2.0**1020])
CUBE = np.indices((2, 2, 2)).reshape(3, -1).T.astype(np.float64)


def rows(*axes: st.SearchStrategy[float]) -> st.SearchStrategy[Points]:
    return st.lists(st.tuples(*axes), min_size=1, max_size=9).map(np.array)


def positions(points: ArrayLike, simplices: NDArray[np.int32]) -> Found:
    corners = (np.asarray(points, dtype=np.float64) + 0.0)[simplices].tolist()
    return {tuple(sorted(map(tuple, each))) for each in corners}


def check(points: Points) -> None:
    """What is found is what the definition says, or nothing where that says nothing."""
    exact = planar.exact(points.tolist())
    expected = oracle.delaunay_by_definition(exact)
    if not expected:
        with pytest.raises(liftmesh.DegenerateInputError):
            liftmesh.tetrahedralize(points)
        return
    tetra = liftmesh.tetrahedralize(points)
    found = [tuple(sorted(exact[row] for row in four)) for four in tetra.simplices.tolist()]
    assert len(found) == len(set(found))
    assert set(found) == expected, points.tolist()
    assert_whole(tetra)


def assert_whole(tetra: liftmesh.Tetrahedralization) -> None:
    """Orientation, neighbours, hull and certificate."""
    simplices, neighbors = tetra.simplices, tetra.neighbors
    assert (liftmesh.orient3d(*np.moveaxis(tetra.points[simplices], 1, 0)) == 1).all()
    facets = [np.sort(np.delete(simplices, k, axis=1), axis=1) for k in range(4)]
    for k in range(4):
        beyond = neighbors[:, k]
        here = np.flatnonzero(beyond >= 0)
        back = neighbors[beyond[here]] == here[:, None]
        assert (back.sum(axis=1) == 1).all()
        there = np.stack([facets[j][beyond[here]] for j in range(4)], axis=1)
        assert (there[back] == facets[k][here]).all()
    outer = np.concatenate([facets[k][neighbors[:, k] < 0] for k in range(4)])
    assert {*map(tuple, outer.tolist())} == {
        *map(tuple, np.sort(tetra.convex_hull, axis=1).tolist())
    }
    certificate = tetra.verify()
    assert certificate.canonical, str(certificate)
    assert certificate.n_hull_edges == len(tetra.convex_hull)


class TestAgainstTheDefinition:
    @settings(max_examples=150)
    @given(rows(SMALL, SMALL, SMALL))
    def test_lattices(self, points: Points) -> None:
        check(points)

    @settings(max_examples=60)
    @given(rows(SMALL, SMALL, SMALL), SCALES, st.sampled_from([0.0, 0.1, 1e15]))
    def test_scaled_and_shifted_lattices(self, points: Points, scale: float, offset: float) -> None:
        check(points * scale + offset * min(scale, 1.0))

    @settings(max_examples=60)
    @given(rows(*[st.one_of(SMALL, STEPS, ULPS)] * 3))
    def test_mixed_kinds_of_doubles(self, points: Points) -> None:
        check(points)

    @pytest.mark.slow
    @pytest.mark.parametrize("family", [*SPACE])
    def test_small_sets_of_every_family(self, family: str) -> None:
        for seed in range(4):
            rng = np.random.default_rng([seed, 38])
            check(SPACE[family](int(rng.integers(4, 10)), rng))


def on_sphere(n: int, rng: np.random.Generator) -> Points:
    points = rng.normal(size=(n, 3))
    return points / np.linalg.norm(points, axis=1, keepdims=True)


def lattice(n: int) -> Points:
    side = round(n ** (1 / 3))
    return np.indices((side, side, side)).reshape(3, -1).T.astype(np.float64)


def two_lines(n: int, rng: np.random.Generator) -> Points:
    along = rng.random(n // 2)
    zero, one = np.zeros(n // 2), np.ones(n // 2)
    return np.vstack((np.stack((along, zero, zero), 1), np.stack((zero, along, one), 1)))


def clouds() -> dict[str, Points]:
    rng = np.random.default_rng(38)
    tilt = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    turn = np.linspace(0, 6, 60)
    grid = lattice(1331)
    uniform = rng.random((1500, 3))
    return {
        "uniform": uniform,
        "ball": on_sphere(1000, rng) * rng.random((1000, 1)) ** (1 / 3),
        "sphere": on_sphere(1200, rng),
        "integers": grid,
        "tenths": grid * 0.1,
        "far tenths": grid * 0.1 + (450000, 5200000, 100),
        "tilted lattice": grid @ tilt,
        "moment curve": np.stack((turn, turn**2, turn**3), axis=1),
        "clusters": rng.normal(size=(9, 1, 3)) + rng.normal(size=(9, 120, 3)) * 1e-7,
        "two lines": two_lines(80, rng),
        "slab": uniform * (1, 1, 1e-12),
        "ulps": 1 + rng.integers(0, 10, (800, 3)) * 2.0**-52,
        "denormal": rng.integers(0, 30, (800, 3)) * 2.0**-1074,
        "tiny": uniform * 2.0**-500,
        "huge": uniform * 2.0**500,
        "heights": np.column_stack((uniform[:, :2], np.round(uniform[:, 2], 2) * 0.1)),
    }


CLOUDS = {name: points.reshape(-1, 3) for name, points in clouds().items()}


def by_cgal(points: Points) -> Found:
    cells = Delaunay_triangulation_3()
    cells.insert([Point_3(*map(float, row)) for row in points])
    return {
        tuple(sorted((p.x(), p.y(), p.z()) for p in (cell.vertex(k).point() for k in range(4))))
        for cell in cells.finite_cells()
    }


class TestAgainstCGAL:
    @pytest.mark.slow
    @pytest.mark.parametrize("name", CLOUDS)
    def test_sets_are_the_same(self, name: str) -> None:
        points = CLOUDS[name]
        tetra = liftmesh.tetrahedralize(points)
        assert positions(points, tetra.simplices) == by_cgal(points)
        assert_whole(tetra)


class TestOneResult:
    @pytest.mark.parametrize("name", ["uniform", "integers", "ulps", "sphere"])
    def test_rows_in_any_order(self, name: str, monkeypatch) -> None:
        """The list is the same too, whatever the secret of the process."""
        points = np.unique(CLOUDS[name], axis=0)
        tetra = liftmesh.tetrahedralize(points)
        for seed in range(2):
            monkeypatch.setattr(module, "_SECRET", seed)
            order = np.random.default_rng(seed).permutation(len(points))
            other = liftmesh.tetrahedralize(points[order], threads=2)
            np.testing.assert_array_equal(order[other.simplices], tetra.simplices)
            np.testing.assert_array_equal(other.neighbors, tetra.neighbors)
            np.testing.assert_array_equal(order[other.convex_hull], tetra.convex_hull)

    def test_every_order_of_five(self) -> None:
        points = np.vstack((CUBE[[0, 1, 2, 4, 7]], CUBE[:1]))[:5]
        expected = positions(points, liftmesh.tetrahedralize(points).simplices)
        for order in permutations(range(5)):
            some = points[list(order)]
            assert positions(some, liftmesh.tetrahedralize(some).simplices) == expected

    def test_canonical_order(self) -> None:
        points = np.random.default_rng(1).integers(0, 4, (60, 3)).astype(float)
        tetra = liftmesh.tetrahedralize(points, order="canonical")
        assert_whole(tetra)
        rank = np.unique(points, axis=0, return_inverse=True)[1].reshape(-1)
        ranks = rank[tetra.simplices]
        assert (ranks[:, 0] == ranks.min(axis=1)).all()
        assert (ranks[:, 1] == np.sort(ranks, axis=1)[:, 1]).all()
        assert sorted(ranks.tolist()) == ranks.tolist()
        hull = rank[tetra.convex_hull]
        assert sorted(hull.tolist()) == hull.tolist()

    @settings(max_examples=40)
    @given(rows(SMALL, SMALL, SMALL), st.integers(-1000, 1000))
    def test_powers_of_two_change_nothing(self, points: Points, exponent: int) -> None:
        try:
            tetra = liftmesh.tetrahedralize(points)
        except liftmesh.DegenerateInputError:
            return
        scaled = liftmesh.tetrahedralize(np.ldexp(points, exponent))
        np.testing.assert_array_equal(scaled.simplices, tetra.simplices)

    def test_steps_of_denormals_beside_huge_numbers(self) -> None:
        """Where squares of distances underflow, nothing may be taken for exact."""
        rng = np.random.default_rng(6)
        points = rng.integers(0, 4, (40, 3)) * 2.0**-1074
        points = np.vstack((points, rng.normal(size=(3, 3)) * [[1e147], [1e-120], [1e94]]))
        assert_whole(liftmesh.tetrahedralize(points))


MANY = 16_500  # so many that the last round is shared by two threads
SHARED = {
    "uniform": lambda rng: rng.random((MANY, 3)),
    "lattice": lambda _: np.indices((26, 26, 26)).reshape(3, -1).T * 0.1,
    "sphere": lambda rng: sphere(MANY, rng),
    "clusters": lambda rng: rng.integers(0, 2, (MANY, 1)) * 9.0 + rng.random((MANY, 3)) ** 4,
}


class TestThreads:
    @pytest.mark.parametrize("name", SHARED)
    def test_the_list_is_the_same(self, name: str) -> None:
        """Whatever stretches of the curve threads have, and which points are put off."""
        points = SHARED[name](np.random.default_rng(3))
        alone, *others = (liftmesh.tetrahedralize(points, threads=k) for k in (1, 2))
        for other in others:
            np.testing.assert_array_equal(other.simplices, alone.simplices)
            np.testing.assert_array_equal(other.neighbors, alone.neighbors)
            np.testing.assert_array_equal(other.convex_hull, alone.convex_hull)
        assert alone.verify(threads=2) == alone.verify(threads=1)

    @pytest.mark.slow
    @pytest.mark.parametrize(
        ("prepare", "call", "delay"),
        [
            ("", "liftmesh.tetrahedralize(points, threads=1)", 0.02),
            ("", "liftmesh.tetrahedralize(points, threads=2)", 0.3),
            ("tetra = liftmesh.tetrahedralize(points)", "tetra.verify(threads=1)", 0.1),
        ],
    )
    def test_ctrl_c_stops_a_run(self, prepare: str, call: str, delay: float) -> None:
        points = "rng.random((250_000, 3))"
        program = LONG_RUN.format(points=points, prepare=prepare, call=call)
        assert seconds_to_stop(program, delay) < 1.0


class TestRows:
    def test_duplicates_keep_the_lowest_row(self) -> None:
        points = np.vstack((CUBE, CUBE[[3, 3, 0]] * (1, 1, -1)))
        points[10] = (-0.0, 0.0, -0.0)
        points[8:10] = CUBE[3]
        tetra = liftmesh.tetrahedralize(points)
        assert tetra.duplicates.tolist() == [[8, 3], [9, 3], [10, 0]]
        assert tetra.simplices.max() == 7
        assert tetra.verify().n_duplicates == 3

    def test_many_copies_of_few_points(self) -> None:
        points = np.tile(CUBE, (2000, 1))
        tetra = liftmesh.tetrahedralize(points)
        assert len(tetra.duplicates) == len(points) - 8
        assert tetra.simplices.max() == 7

    def test_rows_that_are_not_finite(self) -> None:
        points = np.vstack((CUBE, [[np.nan, 0, 0], [0, 0, np.inf]]))
        with pytest.raises(liftmesh.NonFiniteError, match="row 8 is not finite") as caught:
            liftmesh.tetrahedralize(points)
        assert caught.value.row == 8
        tetra = liftmesh.tetrahedralize(points, nonfinite="skip")
        assert tetra.skipped.tolist() == [8, 9]
        certificate = tetra.verify()
        assert (certificate.n_skipped, bool(certificate)) == (2, True)

    @pytest.mark.parametrize("dtype", [np.float32, np.int16, np.int64, ">f8"])
    def test_other_types_of_numbers(self, dtype) -> None:
        points = np.random.default_rng(2).integers(-9, 9, (50, 3))
        expected = liftmesh.tetrahedralize(points.astype(np.float64)).simplices
        found = liftmesh.tetrahedralize(np.asfortranarray(points.astype(dtype)))
        np.testing.assert_array_equal(found.simplices, expected)

    def test_clouds_and_files(self, tmp_path) -> None:
        cloud = liftmesh.Cloud(CUBE * 3)
        cloud_file = tmp_path / "cube.ply"
        liftmesh.write(cloud_file, cloud)
        for given_as in (cloud, cloud_file, str(cloud_file)):
            assert len(liftmesh.tetrahedralize(given_as).simplices) == 6


DEGENERATE = {
    "nothing": (np.empty((0, 3)), "0 rows hold 0 distinct points: a tetrahedron needs four"),
    "one point": (np.ones((5, 3)), "5 rows hold 1 distinct point"),
    "a line": (
        np.arange(6.0)[:, None] * (1, 2, 3),
        "6 distinct points lie on one line, that of rows",
    ),
    "a plane": (
        CUBE[:, [0, 1, 0]] * (1, 3, 5),
        "4 distinct points lie on one plane, that of rows 0, 4 and 6",
    ),
    "a thin slab": (CUBE * (1, 1, 0) + (0.1, 0.2, 0.3), "4 distinct points lie on one plane"),
}


class TestRefusals:
    @pytest.mark.parametrize(("points", "message"), DEGENERATE.values(), ids=DEGENERATE)
    def test_what_spans_no_space(self, points: Points, message: str) -> None:
        with pytest.raises(liftmesh.DegenerateInputError, match=message):
            liftmesh.tetrahedralize(points)
        with pytest.raises(liftmesh.DegenerateInputError, match=message):
            liftmesh.convex_hull(points)

    def test_points_without_z(self) -> None:
        with pytest.raises(liftmesh.InputError, match="two columns: tetrahedra need z"):
            liftmesh.tetrahedralize(np.zeros((5, 2)))

    def test_more_rows_than_numbers(self) -> None:
        rows = np.broadcast_to(np.zeros(3), (2**29 // 7 + 1, 3))
        with pytest.raises(liftmesh.InputError, match="76,695,845 rows are more than"):
            liftmesh.tetrahedralize(rows)

    @pytest.mark.parametrize(
        "options", [{"order": "random"}, {"nonfinite": 1}, {"threads": 0}, {"progress": 3}]
    )
    def test_options(self, options) -> None:
        with pytest.raises(liftmesh.InputError):
            liftmesh.tetrahedralize(CUBE, **options)

    def test_an_exception_of_progress_ends_the_run(self) -> None:
        def stop(_: float) -> None:
            raise KeyError("stop")

        points = np.random.default_rng(0).random((60_000, 3))
        with pytest.raises(KeyError, match="stop"):
            liftmesh.tetrahedralize(points, progress=stop)
        told: list[float] = []
        liftmesh.tetrahedralize(points[:100], progress=told.append)
        assert told[-1] == 1.0


class TestFindSimplex:
    def test_against_every_tetrahedron(self) -> None:
        rng = np.random.default_rng(5)
        points = rng.integers(0, 4, (40, 3)).astype(float)
        self.check(points, rng.integers(-1, 9, (600, 3)) / 2)

    def test_around_a_vertex_of_very_many(self) -> None:
        """And of queries in no order, as one is far from all others."""
        rng = np.random.default_rng(6)
        points = np.vstack([sphere(120, rng), np.zeros((1, 3)), [[1e9, 0, 0]]])
        middles = points[rng.integers(0, 121, 60)] / 2  # on the edges, but of the last row
        self.check(points, np.vstack([np.zeros((70, 3)), middles, np.zeros((9, 3)), [[9e8, 0, 0]]]))

    def check(self, points: Points, queries: Points) -> None:
        tetra = liftmesh.tetrahedralize(points)
        corners = tetra.points[tetra.simplices]
        inside = np.ones((len(queries), len(corners)), dtype=bool)
        for k in range(4):
            four = [corners[None, :, i] for i in range(4)]
            four[k] = queries[:, None]
            inside &= liftmesh.orient3d(*four) >= 0
        expected = np.where(inside.any(axis=1), inside.argmax(axis=1), -1)
        np.testing.assert_array_equal(tetra.find_simplex(queries), expected)
        one_by_one = [int(tetra.find_simplex(query)) for query in queries[:50]]
        assert one_by_one == expected[:50].tolist()

    def test_queries_beyond_all_bounds(self) -> None:
        tetra = liftmesh.tetrahedralize(CUBE)
        queries = [[1e308, 0.5, 0.5], [5e-324, 0.5, 0.5], [-5e-324, 0.5, 0.5], [np.inf, 0, 0]]
        found = tetra.find_simplex([queries])
        assert found.shape == (1, 4)
        assert (found[0] >= 0).tolist() == [False, True, False, False]
        with pytest.raises(liftmesh.InputError, match="points in space need"):
            tetra.find_simplex([0, 0])


def test_copies() -> None:
    tetra = liftmesh.tetrahedralize(CUBE)
    tetra.find_simplex(CUBE)
    other = pickle.loads(pickle.dumps(tetra))
    np.testing.assert_array_equal(other.simplices, tetra.simplices)
    assert not other.simplices.flags.writeable
    damaged = liftmesh.Tetrahedralization(
        CUBE, tetra.simplices, tetra.neighbors + 90, tetra.convex_hull, tetra.duplicates,
        tetra.skipped,
    )  # fmt: skip
    with pytest.raises(liftmesh.InputError, match="damaged"):
        pickle.loads(pickle.dumps(damaged))


class TestConvexHull:
    @pytest.mark.parametrize("family", SPACE)
    def test_meshes_are_watertight_and_hold_every_point(self, family: str) -> None:
        points = SPACE[family](60, np.random.default_rng(4))
        try:
            hull = liftmesh.convex_hull(points)
        except liftmesh.DegenerateInputError:
            return
        a, b, c = np.moveaxis(hull.points[hull.faces], 1, 0)[:, :, None]
        assert (liftmesh.orient3d(a, b, c, points) <= 0).all()
        ends = np.concatenate([hull.faces[:, [k, (k + 1) % 3]] for k in range(3)])
        edges = {*map(tuple, ends.tolist())}
        assert len(edges) == len(ends)
        assert {(head, tail) for tail, head in edges} == edges
        assert len(hull.vertices) - len(ends) // 2 + len(hull.faces) == 2

    @pytest.mark.slow
    def test_objects_of_other_libraries(self) -> None:
        hull = liftmesh.convex_hull(np.vstack(([[0.5, 0.5, 0.5]], CUBE)))
        assert hull.vertices.tolist() == [1, 2, 3, 4, 5, 6, 7, 8]
        mesh = hull.to_trimesh()
        assert mesh.is_watertight
        assert mesh.is_winding_consistent
        assert mesh.volume == pytest.approx(1)
        assert hull.to_open3d().is_watertight()
        assert pickle.loads(pickle.dumps(hull)).faces.tolist() == hull.faces.tolist()
