"""Lower hulls of points in space: against exact integers, SciPy, and one engine against another."""

from __future__ import annotations

import io
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import permutations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from clouds import FAMILIES
from hull_oracle import assert_whole, coordinate_facets, expected_facets, facets
from hypothesis import given, settings, strategies as st
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import ConvexHull
from space_clouds import GENERAL, LARGER, LEAST, SPACE, ball, sphere, with_heights
from stopped import LONG_RUN, assert_another_thread_runs, seconds_to_stop

import liftmesh

Points = NDArray[np.float64]

METHODS = ["auto", "lf"]
SEEDS = 10
SIZES = {
    "any_magnitude": 60,
    "extremes": 200,
    "one_magnitude_in_z": 150,
    "steps_beside_a_tower": 150,
    "cap": 400,
    "flat strip": 500,
    "flat raster": 900,
}


def check(points: ArrayLike) -> None:
    """Both engines find, or refuse, exactly what the oracle says, row by row."""
    expected = expected_facets(points)
    for algorithm in METHODS:
        if not expected:
            with pytest.raises(liftmesh.DegenerateInputError):
                liftmesh.lower_hull(points, algorithm=algorithm)
            continue
        hull = liftmesh.lower_hull(points, algorithm=algorithm)
        assert facets(hull) == expected, (algorithm, np.asarray(points).tolist())
        assert_whole(hull)


# Small sets against the oracle


FINITE = st.floats(allow_nan=False, allow_infinity=False)
SMALL = st.integers(-2, 2).map(float)
STEPS = st.integers(-3, 3).map(lambda steps: steps * LEAST)
ULPS = st.integers(-2, 2).map(lambda steps: 1 + steps * 2.0**-52)
SCALES = st.sampled_from([2.0**-1070, 2.0**-537, 0.1, 1.0, 1 / 3, 2.0**300, 2.0**1020])
OFFSETS = st.sampled_from([0.0, 0.1, -1e8, 1e15])


def rows(*axes: st.SearchStrategy[float]) -> st.SearchStrategy[Points]:
    return st.lists(st.tuples(*axes), min_size=1, max_size=10).map(np.array)


@pytest.mark.slow
@pytest.mark.parametrize("family", SPACE)
def test_small_sets_of_every_family(family: str) -> None:
    for seed in range(SEEDS):
        rng = np.random.default_rng([seed, 1])
        check(SPACE[family](int(rng.integers(3, 12)), rng))


@pytest.mark.slow
@settings(max_examples=500)
@given(rows(SMALL, SMALL, SMALL))
def test_lattices(points: Points) -> None:
    check(points)


@pytest.mark.slow
@settings(max_examples=250)
@given(rows(SMALL, SMALL, SMALL), SCALES, SCALES, OFFSETS, OFFSETS)
def test_scaled_and_shifted_lattices(
    points: Points, xy_scale: float, z_scale: float, xy: float, z: float
) -> None:
    check(points * (xy_scale, xy_scale, z_scale) + (xy, -xy, z))


@pytest.mark.slow
@settings(max_examples=150)
@given(rows(FINITE, FINITE, FINITE))
def test_any_finite_doubles(points: Points) -> None:
    check(points)


@pytest.mark.slow
@settings(max_examples=250)
@given(rows(*[st.one_of(SMALL, STEPS, ULPS)] * 2, st.one_of(SMALL, STEPS, ULPS, FINITE)))
def test_mixed_kinds_of_doubles(points: Points) -> None:
    check(points)


@settings(max_examples=200)
@given(st.lists(st.tuples(SMALL, SMALL), min_size=3, max_size=10), st.integers(-3, 3), SMALL)
def test_planes_of_every_tilt(xy: list[tuple[float, float]], tilt: int, other: float) -> None:
    points = np.array(xy)
    check(with_heights(points, points @ [tilt, other]))


@pytest.mark.parametrize("algorithm", METHODS)
@pytest.mark.parametrize("family", SPACE)
def test_every_order_of_five_rows(family: str, algorithm: str) -> None:
    points = np.vstack((SPACE[family](4, np.random.default_rng(2))[:4], [[2.0, 3.0, -1.0]]))
    if not expected_facets(points):
        points[0] = (7.0, -5.0, 0.0)
        points[1] = (-5.0, 7.0, 0.0)
    expected = coordinate_facets(points, liftmesh.lower_hull(points, algorithm=algorithm).faces)
    for order in permutations(range(len(points))):
        shuffled = points[list(order)]
        faces = liftmesh.lower_hull(shuffled, algorithm=algorithm).faces
        assert coordinate_facets(shuffled, faces) == expected, order


# Larger sets


@pytest.mark.parametrize("family", LARGER)
def test_both_engines_find_the_same_facets(family: str) -> None:
    n = SIZES.get(family, 1460)
    points = LARGER[family](n, np.random.default_rng(3))
    hull = liftmesh.lower_hull(points)
    assert_whole(hull)
    assert facets(liftmesh.lower_hull(points, algorithm="lf")) == facets(hull)


@pytest.mark.parametrize("family", LARGER)
def test_the_set_is_the_same_for_every_order_of_many_rows(family: str) -> None:
    rng = np.random.default_rng(5)
    points = LARGER[family](SIZES.get(family, 1460), rng)
    expected = coordinate_facets(points, liftmesh.lower_hull(points).faces)
    for order in (np.lexsort(points.T), np.lexsort(points.T)[::-1], rng.permutation(len(points))):
        faces = liftmesh.lower_hull(points[order]).faces
        assert coordinate_facets(points[order], faces) == expected


@pytest.mark.parametrize("algorithm", METHODS)
@pytest.mark.parametrize("slope", [(0, 0), (2, -3), (0.5, 0.25)])
def test_every_position_of_a_plane_is_a_vertex(algorithm: str, slope: tuple[float, float]) -> None:
    rng = np.random.default_rng(6)
    xy = rng.integers(0, 20, (600, 2))
    hull = liftmesh.lower_hull(with_heights(xy, xy @ np.array(slope)), algorithm=algorithm)
    first = np.unique(xy, axis=0, return_index=True)[1]
    np.testing.assert_array_equal(np.unique(hull.faces), np.sort(first))
    np.testing.assert_array_equal(hull.above, np.setdiff1d(np.arange(600), first))


@pytest.mark.parametrize("name", GENERAL)
def test_lower_facets_of_scipy(name: str) -> None:
    generate, n = GENERAL[name]
    points = generate(n, np.random.default_rng(7))
    found = ConvexHull(points)
    theirs = found.simplices[found.equations[:, 2] < 0]
    hull = liftmesh.lower_hull(points)
    assert facets(hull) == {tuple(sorted(face)) for face in theirs.tolist()}
    assert_whole(hull)


@pytest.mark.parametrize("name", ["sphere", "ball", "gaussian", "cone"])
def test_lf_finds_the_lower_facets_of_scipy(name: str) -> None:
    points = GENERAL[name][0](1000, np.random.default_rng(8))
    found = ConvexHull(points)
    theirs = found.simplices[found.equations[:, 2] < 0]
    hull = liftmesh.lower_hull(points, algorithm="lf")
    assert facets(hull) == {tuple(sorted(face)) for face in theirs.tolist()}


@pytest.mark.parametrize("algorithm", METHODS)
@pytest.mark.parametrize("family", ["small-integers", "integer-circles", "duplicates", "lattice"])
@pytest.mark.parametrize("apex", ["origin", (3, -5)], ids=str)
def test_lifted_integers_give_the_triangulation(family: str, algorithm: str, apex: Any) -> None:
    points = FAMILIES[family](400, np.random.default_rng(9))
    hull = liftmesh.lower_hull(liftmesh.lift(points, apex), algorithm=algorithm)
    assert facets(hull) == {
        tuple(sorted(row)) for row in liftmesh.delaunay(points).simplices.tolist()
    }


@pytest.mark.slow
@pytest.mark.parametrize("family", ["lattice", "two-columns", "duplicates", "small-integers"])
def test_many_lifted_integers_give_the_triangulation(family: str) -> None:
    points = np.rint(FAMILIES[family](40_000, np.random.default_rng(19)) * 1000)
    hull = liftmesh.lower_hull(liftmesh.lift(points))
    assert facets(hull) == {
        tuple(sorted(row)) for row in liftmesh.delaunay(points).simplices.tolist()
    }


# What a result holds, and what is refused


def strided(points: Points) -> Points:
    wide = np.full((2 * len(points), 7), np.nan)
    wide[::2, 1:7:2] = points
    return wide[::2, 1:7:2]


FORMS: dict[str, Callable[[Points], Any]] = {
    "list": lambda p: p.tolist(),
    "integers": lambda p: p.astype(np.int64),
    "int8": lambda p: p.astype(np.int8),
    "float32": lambda p: p.astype(np.float32),
    "Fortran order": np.asfortranarray,
    "strided": strided,
    "reversed": lambda p: p[::-1].copy()[::-1],
    "read-only": lambda p: np.frombuffer(p.tobytes()).reshape(p.shape),
    "masked array without a masked row": np.ma.masked_array,
}


@pytest.mark.parametrize("algorithm", METHODS)
@pytest.mark.parametrize("form", FORMS)
def test_every_form_gives_the_same_rows_and_stays_as_it_was(form: str, algorithm: str) -> None:
    points = np.random.default_rng(10).integers(-9, 10, (150, 3)) * 1.0
    given_points = FORMS[form](points)
    before = np.array(given_points, copy=True)
    hull = liftmesh.lower_hull(given_points, algorithm=algorithm)
    expected = liftmesh.lower_hull(points, algorithm=algorithm)
    np.testing.assert_array_equal(hull.faces, expected.faces)
    np.testing.assert_array_equal(hull.neighbors, expected.neighbors)
    np.testing.assert_array_equal(hull.vertices, points)
    assert hull.vertices.dtype == np.float64
    np.testing.assert_array_equal(np.asarray(given_points), before)


def test_float32_is_widened_exactly() -> None:
    single = np.random.default_rng(11).random((2000, 3), dtype=np.float32)
    narrow, wide = liftmesh.lower_hull(single), liftmesh.lower_hull(single.astype(np.float64))
    np.testing.assert_array_equal(narrow.faces, wide.faces)


@pytest.mark.parametrize("algorithm", METHODS)
def test_the_lowest_and_then_the_first_row_of_a_position(algorithm: str) -> None:
    points = [[0, 0, 5], [4, 0, 0], [0, 0, -1], [0, 4, 0], [-0.0, 0, -1], [0, 4, 0], [0, 0, 2]]
    hull = liftmesh.lower_hull(points, algorithm=algorithm)
    assert facets(hull) == {(1, 2, 3)}
    assert hull.above.tolist() == [0, 4, 5, 6]
    assert hull.above.dtype == np.int32


def test_a_result_tells_how_it_was_found() -> None:
    points = np.random.default_rng(12).random((50, 3))
    fast, printed = liftmesh.lower_hull(points), liftmesh.lower_hull(points, algorithm="lf")
    assert fast.apex is None
    assert printed.apex is None
    assert fast.counters is None
    counters = printed.counters
    assert counters is not None
    rim = np.count_nonzero(printed.neighbors == -1)
    assert counters.calls == len(printed.faces) + rim
    assert counters.candidate_planes >= len(printed.faces)
    assert counters.points == counters.evaluations > counters.candidate_planes
    assert not any(counters.rejected.values())


@pytest.mark.parametrize("algorithm", METHODS)
def test_a_hull_becomes_a_mesh(algorithm: str, tmp_path) -> None:
    hull = liftmesh.lower_hull(sphere(300, np.random.default_rng(13)), algorithm=algorithm)
    mesh = hull.to_trimesh()
    np.testing.assert_array_equal(mesh.vertices, hull.vertices)
    np.testing.assert_array_equal(mesh.faces, hull.faces)
    assert (mesh.face_normals[:, 2] > 0).all()
    cloud = hull.to_cloud()
    np.testing.assert_array_equal(cloud.points, hull.vertices)
    np.testing.assert_array_equal(cloud.faces, hull.faces)
    assert cloud.metadata == {}
    for name in ("hull.ply", "hull.obj"):
        assert hull.save(tmp_path / name).path == tmp_path / name
        again = liftmesh.read(tmp_path / name)
        np.testing.assert_array_equal(again.points, hull.vertices)
        np.testing.assert_array_equal(again.faces, hull.faces)
    stream = io.BytesIO()
    hull.save(stream, format="ply")
    assert stream.getvalue() == (tmp_path / "hull.ply").read_bytes()


def test_two_runs_give_the_same_rows() -> None:
    points = ball(5000, np.random.default_rng(14))
    first, second = liftmesh.lower_hull(points), liftmesh.lower_hull(points.copy())
    np.testing.assert_array_equal(first.faces, second.faces)
    np.testing.assert_array_equal(first.neighbors, second.neighbors)


LINE = np.column_stack((np.arange(9.0), 2 * np.arange(9.0), np.random.default_rng(0).random(9)))
DEGENERATE = {
    "no row": (np.empty((0, 3)), "0 distinct"),
    "two points": ([[0, 0, 0], [1, 1, 1]], "2 distinct"),
    "two positions": ([[0, 0, 0], [1, 1, 1], [0, 0, 5], [1, 1, 9]], "2 distinct"),
    "one vertical line": (np.column_stack((np.zeros((9, 2)), np.arange(9.0))), "1 distinct"),
    "vertical wall": (
        np.repeat(LINE, 3, axis=0) + [[0, 0, 1], [0, 0, 2], [0, 0, 3]] * 9,
        "all 9 planar positions lie on one line",
    ),
    "collinear in the plane": (
        LINE,
        "on one line, from row 0 to row 8: points in a vertical plane have no lower facet",
    ),
    "along x": (LINE * (1, 0, 1), "line"),
    "along y": (LINE * (0, 1, 1), "line"),
    "denormal": (LINE * (LEAST, LEAST, 1), "line"),
    "huge": (LINE * (2.0**1019, 2.0**1019, 1), "line"),
}


@pytest.mark.parametrize("algorithm", METHODS)
@pytest.mark.parametrize(("points", "told"), DEGENERATE.values(), ids=DEGENERATE.keys())
def test_too_little_for_a_facet(points: ArrayLike, told: str, algorithm: str) -> None:
    with pytest.raises(liftmesh.DegenerateInputError, match=told):
        liftmesh.lower_hull(points, algorithm=algorithm)


@pytest.mark.parametrize("algorithm", METHODS)
@pytest.mark.parametrize("column", [0, 1, 2])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_rows_that_are_not_finite_are_named(column: int, value: float, algorithm: str) -> None:
    points = np.random.default_rng(15).random((9, 3))
    points[6, column] = value
    points[8] = np.nan
    with pytest.raises(liftmesh.NonFiniteError, match=rf"row 6\b.*{value}.*first$") as caught:
        liftmesh.lower_hull(points, algorithm=algorithm)
    assert caught.value.row == 6


def test_masked_rows_are_named() -> None:
    points = np.ma.masked_array(np.random.default_rng(16).random((9, 3)))
    points[4, 2] = np.ma.masked
    with pytest.raises(liftmesh.NonFiniteError, match=r"row 4\b"):
        liftmesh.lower_hull(points)


@pytest.mark.parametrize("algorithm", ["lfres", "lfres-indexed", "divide-and-conquer"])
def test_planar_methods_name_the_function_that_has_them(algorithm: Any) -> None:
    with pytest.raises(liftmesh.InputError, match=rf"'{algorithm}'.*liftmesh\.delaunay\(points"):
        liftmesh.lower_hull(np.eye(3), algorithm=algorithm)


@pytest.mark.parametrize("algorithm", ["LF", "quickhull", "", None, 1])
def test_an_unknown_method_names_the_choices(algorithm: Any) -> None:
    with pytest.raises(liftmesh.InputError, match=r"^algorithm is .*: give one of 'auto', 'lf'$"):
        liftmesh.lower_hull(np.eye(3), algorithm=algorithm)


def test_two_columns_are_refused_with_a_way_out() -> None:
    with pytest.raises(liftmesh.InputError, match=r"two columns.*delaunay.*lift"):
        liftmesh.lower_hull(np.random.default_rng(17).random((9, 2)))


@pytest.mark.parametrize(
    "points",
    [np.zeros((5, 4)), np.zeros(3), 5.0, "points", None, np.eye(3, dtype=bool), np.eye(3) * 1j],
    ids=["four columns", "one row", "number", "word", "nothing", "bool", "complex"],
)
def test_what_is_no_set_of_points(points: Any) -> None:
    with pytest.raises(liftmesh.LiftmeshError) as caught:
        liftmesh.lower_hull(points)
    assert isinstance(caught.value, (ValueError, TypeError))


def test_integers_that_no_double_holds_are_named() -> None:
    with pytest.raises(liftmesh.InputError, match=rf"row 2\b.*{2**53 + 1}"):
        liftmesh.lower_hull(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 2**53 + 1]]))


# Long runs


@pytest.mark.slow
@pytest.mark.parametrize(
    ("points", "algorithm", "delay"),
    [
        ("rng.integers(0, 10**6, (1_000_000, 2)) @ [[1, 0, 3 << 20], [0, 1, 7]]", "auto", 0.6),
        ("liftmesh.lift(rng.random((1_000_000, 2)))", "auto", 0.4),
        ("liftmesh.lift(rng.random((100_000, 2)))", "lf", 0.4),
    ],
    ids=["plane", "paraboloid", "lf"],
)
def test_ctrl_c_stops_a_long_run_within_a_second(points: str, algorithm: str, delay: float) -> None:
    call = f"liftmesh.lower_hull(points, algorithm={algorithm!r})"
    program = LONG_RUN.format(points=points, prepare="", call=call)
    assert seconds_to_stop(program, delay) < 1.0


def test_another_thread_runs_meanwhile() -> None:
    points = liftmesh.lift(np.random.default_rng(18).random((100_000, 2)))
    assert_another_thread_runs(lambda: liftmesh.lower_hull(points))


def test_threads_at_once_give_what_one_gives() -> None:
    clouds = [sphere(n, np.random.default_rng(n)) for n in range(400, 412)]
    jobs = [(points, algorithm) for points in clouds for algorithm in METHODS]
    with ThreadPoolExecutor(max_workers=4) as pool:
        at_once = list(pool.map(lambda job: liftmesh.lower_hull(job[0], algorithm=job[1]), jobs))
    for (points, algorithm), actual in zip(jobs, at_once, strict=True):
        expected = liftmesh.lower_hull(points, algorithm=algorithm)
        np.testing.assert_array_equal(actual.faces, expected.faces)


def test_the_path_of_a_file_is_read(tmp_path: Path) -> None:
    points = np.random.default_rng(20).random((50, 3))
    np.save(tmp_path / "cloud.npy", points)
    for path in (tmp_path / "cloud.npy", str(tmp_path / "cloud.npy")):
        found = liftmesh.lower_hull(path)
        np.testing.assert_array_equal(found.faces, liftmesh.lower_hull(points).faces)
