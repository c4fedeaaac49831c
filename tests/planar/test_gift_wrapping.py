"""The paper's procedures against the default engine: the same triangles, whatever the apex is."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest
from clouds import FAMILIES
from commands import ROOT, TERRAIN, failed, interrupted, liftmesh as command
from hypothesis import given, settings, strategies as st
from meshes import assert_oracle_agrees, assert_same_triangles, triangle_rows
from numpy.typing import ArrayLike, NDArray
from stopped import LONG_RUN, assert_another_thread_runs, seconds_to_stop
from surfaces import layered, triangles_of

import liftmesh
from liftmesh.cli import exit_codes
from liftmesh.planar import lifting

Points = NDArray[np.float64]

METHODS = ["lf", "lfres", "lfres-indexed"]
PRINTED = ["lf", "lfres"]
ARRAYS = ["simplices", "neighbors", "convex_hull", "duplicates", "skipped", "coplanar"]
SEEDS = 12
SAME_POINT = "on a point"
VERTICES: list[Any] = [
    "origin",
    "median",
    SAME_POINT,
    (1e8, 1e8),
    (-0.1, 1 / 3),
    (1e300, -1e300),
    (5e-324, 0.0),
    (-np.finfo(np.float64).max, 1.0),
]
CIRCLE = "np.exp(1j * rng.uniform(0, 7, 200_000)).view(float).reshape(-1, 2)"
HILL = ROOT / "data" / "hill.csv"

FINITE = st.floats(allow_nan=False, allow_infinity=False)
SMALL = st.integers(-3, 3).map(float)
SIGNED_ZERO = st.sampled_from([0.0, -0.0, 1.0])
STEPS = st.integers(-4, 4).map(lambda steps: steps * 2.0**-1074)
ULPS = st.integers(-4, 4).map(lambda steps: 1 + steps * 2.0**-52)
MAGNITUDES = st.builds(np.ldexp, SMALL, st.sampled_from([-1074, -540, -52, 0, 52, 500, 1020]))
OFFSETS = st.sampled_from([0.0, 0.1, 450000.0, -1e8, 1e15])
SCALES = st.sampled_from([2.0**-1070, 2.0**-200, 0.1, 1.0, 1 / 3, 2.0**300, 2.0**1020])
ON_CIRCLE = [(5, 0), (4, 3), (3, 4), (0, 5), (-3, 4), (-4, 3), (-5, 0), (-4, -3), (0, -5), (3, -4)]
QS = st.sampled_from(VERTICES)


def rows(x: st.SearchStrategy[float], y: st.SearchStrategy[float]) -> st.SearchStrategy[Points]:
    """Up to sixteen rows, equal ones among them."""
    return st.lists(st.tuples(x, y), min_size=1, max_size=16).map(np.array)


def resolved(apex: Any, points: ArrayLike) -> Any:
    return np.asarray(points, dtype=np.float64)[0, :2] if apex is SAME_POINT else apex


def outcome(points: ArrayLike, **options: Any) -> dict[str, Any]:
    """Everything that must not depend on the engine: all arrays, or the error in its words."""
    try:
        result = liftmesh.delaunay(points, order="canonical", **options)
    except liftmesh.DegenerateInputError as error:
        return {"error": str(error)}
    return {name: getattr(result, name).tolist() for name in ARRAYS}


def check(points: ArrayLike, apex: Any = "origin", **options: Any) -> None:
    """All three procedures give what the default engine gives."""
    expected = outcome(points, **options)
    apex = resolved(apex, points)
    for algorithm in METHODS:
        assert outcome(points, algorithm=algorithm, apex=apex, **options) == expected, (
            algorithm,
            apex,
        )


def check_indexed(points: Points, about: str = "") -> None:
    """The indexed procedure gives what the default engine gives, on many points."""
    expected = liftmesh.delaunay(points, order="canonical")
    actual = liftmesh.delaunay(points, algorithm="lfres-indexed", order="canonical")
    for name in ARRAYS:
        np.testing.assert_array_equal(getattr(actual, name), getattr(expected, name), about + name)


@pytest.mark.parametrize("family", FAMILIES)
def test_small_sets_of_every_family(family: str) -> None:
    for seed in range(SEEDS):
        rng = np.random.default_rng([seed, 5])
        check(FAMILIES[family](int(rng.integers(3, 20)), rng), VERTICES[seed % len(VERTICES)])


@pytest.mark.slow
@settings(max_examples=500)
@given(rows(SMALL, SMALL), QS, OFFSETS, OFFSETS)
def test_lattices_with_offsets(points: Points, apex: Any, x: float, y: float) -> None:
    check(np.add(points, (x, y)), apex)


@settings(max_examples=200)
@given(rows(SMALL, SMALL), QS, SCALES, SCALES)
def test_lattices_of_every_scale(points: Points, apex: Any, x: float, y: float) -> None:
    check(points * (x, y), apex)


@pytest.mark.slow
@settings(max_examples=250)
@given(rows(SMALL, SIGNED_ZERO), QS, st.booleans())
def test_runs_on_lines_and_zeros_of_both_signs(points: Points, apex: Any, turned: bool) -> None:
    check(points[:, ::-1] if turned else points, apex)


@settings(max_examples=250)
@given(
    st.lists(st.sampled_from([*ON_CIRCLE, (0, 0), (1, 0)]), min_size=3, max_size=14), QS, OFFSETS
)
def test_cocircular_points(points: list[tuple[int, int]], apex: Any, offset: float) -> None:
    check(np.array(points) * 1.0 + offset, apex)


@settings(max_examples=250)
@given(rows(ULPS, st.one_of(ULPS, SMALL)), QS)
def test_neighbours_by_an_ulp(points: Points, apex: Any) -> None:
    check(points, apex)


@pytest.mark.slow
@settings(max_examples=250)
@given(rows(st.one_of(MAGNITUDES, STEPS), MAGNITUDES), QS)
def test_mixed_magnitudes(points: Points, apex: Any) -> None:
    check(points, apex)


@settings(max_examples=200)
@given(rows(FINITE, FINITE), st.one_of(QS, st.tuples(FINITE, FINITE)))
def test_any_finite_doubles_and_any_vertex(points: Points, apex: Any) -> None:
    check(points, apex)


@settings(max_examples=60)
@given(st.lists(st.tuples(st.integers(-3, 3), st.integers(-3, 3)), min_size=1, max_size=14), QS)
def test_integers_float32_and_strided_rows(points: list[tuple[int, int]], apex: Any) -> None:
    integers = np.array(points)
    wide = np.full((2 * len(points), 5), np.nan)
    wide[::2, 1:5:3] = integers
    expected = outcome(integers)
    for form in (points, integers, integers.astype(np.float32), wide[::2, 1:5:3]):
        for algorithm in METHODS:
            assert outcome(form, algorithm=algorithm, apex=resolved(apex, integers)) == expected


@settings(max_examples=120)
@given(rows(SMALL, st.one_of(SMALL, st.sampled_from([np.nan, np.inf]))))
def test_rows_that_are_not_finite_are_skipped_alike(points: Points) -> None:
    check(points, "median", nonfinite="skip")


@pytest.mark.parametrize("algorithm", METHODS)
def test_engine_order_is_the_same_set_and_what_the_oracle_says(algorithm: str) -> None:
    for family in ("small-integers", "integer-circles", "ulp-lattice", "duplicates"):
        points = FAMILIES[family](60, np.random.default_rng(4))
        found = liftmesh.delaunay(points, algorithm=algorithm, apex="median").simplices
        assert_oracle_agrees(points, found)


@pytest.mark.parametrize("algorithm", METHODS)
@pytest.mark.parametrize("apex", VERTICES, ids=str)
def test_a_few_hundred_points_at_every_vertex(algorithm: str, apex: Any) -> None:
    for family in ("uniform", "tenth-lattice", "clusters", "circle", "far-offset"):
        points = FAMILIES[family](250, np.random.default_rng(6))
        options = {"algorithm": algorithm, "apex": resolved(apex, points)}
        assert outcome(points, **options) == outcome(points), family


@pytest.fixture(scope="module")
def terrain() -> Points:
    return liftmesh.read(TERRAIN).points


@pytest.mark.slow
@pytest.mark.parametrize("apex", ["origin", "median"])
def test_the_terrain_thinned_to_3000_points(terrain: Points, apex: str) -> None:
    thinned = np.random.default_rng(0).permutation(terrain)[:3000]
    expected = liftmesh.delaunay(thinned, order="canonical")
    assert len(expected.simplices) > 5900
    for algorithm in METHODS:
        actual = liftmesh.delaunay(thinned, algorithm=algorithm, apex=apex, order="canonical")
        for name in ARRAYS:
            np.testing.assert_array_equal(getattr(actual, name), getattr(expected, name))


def test_the_whole_terrain_by_the_indexed_procedure(terrain: Points) -> None:
    check_indexed(terrain)


def grid(columns: int, lines: int) -> Points:
    return np.indices((columns, lines)).reshape(2, -1).T.astype(np.float64)


def large() -> Iterator[tuple[str, Points]]:
    rng = np.random.default_rng(8)
    yield "uniform", rng.random((200_000, 2))
    yield "uniform at 1e8", rng.random((50_000, 2)) * 1e-3 + (1e8, -1e8)
    yield "raster", grid(300, 300)
    yield "raster with holes", rng.permutation(grid(200, 200))[:30_000] * 30 + (5e5, 5.2e6)
    yield "clusters", FAMILIES["clusters"](5000, rng)
    yield "one far point", np.vstack((rng.random((5000, 2)), [[1e6, 1e7]]))
    yield "circle", FAMILIES["circle"](1000, rng)
    yield "lying strip", rng.random((6000, 2)) * (1e6, 1)
    yield "standing strip", rng.random((4000, 2)) * (1, 1e6)
    yield "slanted strip", rng.random((4000, 2)) * (1, 1e-5) @ [[0.6, 0.8], [-0.8, 0.6]]
    yield "two columns", FAMILIES["two-columns"](1500, rng)
    yield "two lines", FAMILIES["two-columns"](1500, rng)[:, ::-1]
    yield "few x", np.column_stack((rng.choice([0.0, 1.0, 5.0, 5.5], 3000), rng.random(3000)))
    yield "few y", np.column_stack((rng.random(3000), rng.choice([-1e-9, 0.0, 1e-9, 7.0], 3000)))
    yield "one line and a point", FAMILIES["short-line-and-apex"](1500, rng)
    yield "denormal", FAMILIES["denormal"](20_000, rng)
    yield "huge", FAMILIES["huge"](20_000, rng)
    yield "duplicates", rng.integers(0, 60, (20_000, 2)).astype(np.float64)


LARGE = dict(large())


@pytest.mark.parametrize("name", LARGE)
def test_many_points_by_the_indexed_procedure(name: str) -> None:
    check_indexed(LARGE[name], name)


# Errors


DEGENERATE = {
    "no row": np.empty((0, 2)),
    "two points": [[1.0, 2.0], [3.0, 4.0]],
    "two positions": [[1.0, 2.0], [3.0, 4.0], [1.0, 2.0]],
    "all equal": np.ones((50, 2)),
    "zeros of both signs": [[0.0, -0.0], [-0.0, 0.0], [-0.0, -0.0]],
    "horizontal": np.column_stack((np.arange(40.0), np.zeros(40))),
    "vertical": np.column_stack((np.zeros(40), np.arange(40.0)))[::-1],
    "oblique": np.arange(40.0)[:, None] * [3, -7] + [5, 11],
    "denormal": np.arange(40.0)[:, None] * [2.0**-1074, 2.0**-1074],
    "huge": np.linspace(-1, 1, 40)[:, None] * [1.7e308, 1.7e308],
}


@pytest.mark.parametrize("points", DEGENERATE.values(), ids=DEGENERATE.keys())
@pytest.mark.parametrize("apex", ["origin", "median", (1e300, 1e300)], ids=str)
def test_too_little_for_a_triangle_in_the_same_words(points: ArrayLike, apex: Any) -> None:
    assert "error" in outcome(points)
    check(points, apex)


@pytest.mark.parametrize("algorithm", METHODS)
def test_rows_that_are_not_finite_are_named(algorithm: str) -> None:
    points = np.random.default_rng(0).random((9, 2))
    points[7, 1] = np.nan
    points[8, 0] = np.inf
    with pytest.raises(liftmesh.NonFiniteError, match=r"row 7\b.*nan") as caught:
        liftmesh.delaunay(points, algorithm=algorithm, apex="median")
    assert caught.value.row == 7
    left = liftmesh.delaunay(points, algorithm=algorithm, apex="median", nonfinite="skip")
    assert left.skipped.tolist() == [7, 8]


@pytest.mark.parametrize("algorithm", ["auto", *METHODS])
@pytest.mark.parametrize(
    "apex",
    ["centre", "", None, 5, (1,), (1, 2, 3), (np.nan, 0), (0, np.inf), [[0, 0]], ("a", "b"), {}],
    ids=repr,
)
def test_what_is_no_vertex(algorithm: str, apex: Any) -> None:
    with pytest.raises(liftmesh.InputError, match=r"^apex is .*: give 'median', 'origin' or a "):
        liftmesh.delaunay([[0, 0], [1, 0], [0, 1]], algorithm=algorithm, apex=apex)


def test_divide_and_conquer_computes_no_median(monkeypatch: pytest.MonkeyPatch) -> None:
    def computed(_points: object) -> tuple[float, float]:
        raise AssertionError("the median is not needed")

    monkeypatch.setattr(lifting, "_median", computed)
    assert liftmesh.delaunay([[0, 0], [1, 0], [0, 1]], apex="median").nsimplex == 1
    with pytest.raises(AssertionError, match="not needed"):
        liftmesh.delaunay([[0, 0], [1, 0], [0, 1]], algorithm="lf", apex="median")


@pytest.mark.parametrize("algorithm", ["LF", "lf-res", "indexed", "", None, 3])
def test_an_unknown_method_names_the_choices(algorithm: Any) -> None:
    with pytest.raises(
        liftmesh.InputError, match=r"^algorithm is .*'lf', 'lfres', 'lfres-indexed'$"
    ):
        liftmesh.delaunay([[0, 0], [1, 0], [0, 1]], algorithm=algorithm)


@pytest.mark.parametrize("algorithm", METHODS)
def test_the_input_is_never_modified(algorithm: str) -> None:
    points = FAMILIES["duplicates"](200, np.random.default_rng(1))
    before = points.copy()
    points.flags.writeable = False
    liftmesh.delaunay(points, algorithm=algorithm, apex=points[0])
    assert points.tobytes() == before.tobytes()


# The other doors


@pytest.mark.parametrize("algorithm", METHODS)
@pytest.mark.parametrize("policy", ["first", "highest", "mean"])
def test_surfaces_by_every_method(algorithm: str, policy: str) -> None:
    cloud = layered()
    options = {"on_duplicate": policy, "algorithm": algorithm, "apex": "median"}
    expected, actual = (
        liftmesh.triangulate(cloud, on_duplicate=policy),
        liftmesh.triangulate(cloud, **options),
    )
    np.testing.assert_array_equal(actual.vertices, expected.vertices)
    assert sorted(map(sorted, actual.faces.tolist())) == sorted(
        map(sorted, expected.faces.tolist())
    )
    assert actual.report.n_used == expected.report.n_used
    assert actual.triangulation.counters is not None


@pytest.mark.parametrize("words", [("lf",), ("lfres", "median"), ("lfres-indexed", "1e8,-3.5")])
def test_the_command_line(words: tuple[str, ...], tmp_path) -> None:
    options = ["--algorithm", words[0], *(["--apex", words[1]] if len(words) > 1 else [])]
    done = command("triangulate", HILL, "by-algorithm.ply", *options, cwd=tmp_path)
    plain = command("triangulate", HILL, "plain.ply", cwd=tmp_path)
    assert (done.returncode, done.stderr, plain.returncode) == (0, "", 0)
    one, other = (liftmesh.read(tmp_path / name) for name in ("by-algorithm.ply", "plain.ply"))
    np.testing.assert_array_equal(one.points, other.points)
    assert len(one.faces) == len(other.faces)
    assert triangles_of(one.points, one.faces) == triangles_of(other.points, other.faces)
    sizes = [(tmp_path / name).stat().st_size for name in ("by-algorithm.ply", "plain.ply")]
    assert sizes[0] == sizes[1]


@pytest.mark.parametrize("apex", ["centre", "1", "1,2,3", ""])
def test_the_command_line_refuses_what_is_no_vertex(apex: str, tmp_path) -> None:
    done = command("triangulate", HILL, tmp_path / "m.ply", "--algorithm", "lf", "--apex", apex)
    failed(done, exit_codes.USAGE, "origin")
    assert list(tmp_path.iterdir()) == []


# Long runs


@pytest.mark.slow
@pytest.mark.parametrize(
    ("algorithm", "points", "apex"),
    [
        ("lf", "rng.random((100_000, 2))", "median"),
        ("lfres", "rng.random((100_000, 2))", "median"),
        ("lfres-indexed", CIRCLE, "median"),
        ("lfres", "rng.random((1_000_000, 2))", (1e300, -1e300)),
    ],
    ids=["lf", "lfres", "lfres-indexed", "first edge"],
)
def test_ctrl_c_stops_a_long_run_within_a_second(algorithm: str, points: str, apex: Any) -> None:
    call = f"liftmesh.delaunay(points, algorithm={algorithm!r}, apex={apex!r})"
    assert seconds_to_stop(LONG_RUN.format(points=points, prepare="", call=call), 0.4) < 1.0


def test_ctrl_c_stops_the_command_and_leaves_no_file(tmp_path) -> None:
    code, _, _ = interrupted("triangulate", TERRAIN, tmp_path / "m.ply", "--algorithm", "lfres")
    assert code == exit_codes.INTERRUPTED
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("algorithm", METHODS)
def test_another_thread_runs_meanwhile(algorithm: str) -> None:
    n = {"lf": 1500, "lfres": 1500, "lfres-indexed": 100_000}[algorithm]
    points = FAMILIES["uniform"](n, np.random.default_rng(0))
    assert_another_thread_runs(lambda: liftmesh.delaunay(points, algorithm=algorithm))


def test_threads_at_once_give_what_one_gives() -> None:
    clouds = [FAMILIES["uniform"](n, np.random.default_rng(n)) for n in range(300, 316)]
    jobs = [(points, algorithm) for points in clouds for algorithm in METHODS]
    with ThreadPoolExecutor(max_workers=4) as pool:
        at_once = list(pool.map(lambda job: liftmesh.delaunay(job[0], algorithm=job[1]), jobs))
    for (points, algorithm), actual in zip(jobs, at_once, strict=True):
        expected = liftmesh.delaunay(points, algorithm=algorithm)
        assert_same_triangles(
            triangle_rows(points, actual.simplices), triangle_rows(points, expected.simplices)
        )
        np.testing.assert_array_equal(actual.simplices, expected.simplices)
        assert actual.counters == expected.counters
