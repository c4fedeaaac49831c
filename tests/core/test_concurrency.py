"""Long calls leave the interpreter free, run side by side, and stop at Ctrl-C."""

from __future__ import annotations

import itertools
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from clouds import FAMILIES
from stopped import LONG_RUN, assert_another_thread_runs, seconds_to_stop

import liftmesh

CIRCLE = "np.exp(1j * rng.uniform(0, 2 * np.pi, 8_000_000)).view(float).reshape(-1, 2)"
UNIFORM = "rng.random((8_000_000, 2))"
MILLION_COPIES_AND_MORE = "np.repeat(rng.random((3_000_000, 2)), 3, axis=0)"
DENORMAL = "rng.integers(0, 2**20, (8_000_000, 2)) * 2.0**-1074"
TWO_COLUMNS = "np.column_stack((rng.integers(0, 2, 500_000), rng.random(500_000)))"
ONE_COLUMN = "np.column_stack((np.zeros(6_000_000), rng.random(6_000_000)))"


@pytest.mark.parametrize("family", ["uniform", "circle"])
def test_another_thread_runs_during_a_large_call(family: str) -> None:
    points = FAMILIES[family](1_000_000, np.random.default_rng(0))
    assert_another_thread_runs(lambda: liftmesh.delaunay(points))


def test_another_thread_runs_during_point_location() -> None:
    rng = np.random.default_rng(0)
    triangulation = liftmesh.delaunay(rng.random((200_000, 2)))
    queries = rng.random((1_000_000, 2))
    assert_another_thread_runs(lambda: triangulation.find_simplex(queries))


def test_threads_at_once_give_what_one_gives() -> None:
    names = ["uniform", "lattice", "circle", "utm-lattice", "clusters", "denormal", "parabola"]
    clouds = [FAMILIES[name](30_000, np.random.default_rng(1)) for name in names] * 2
    one_by_one = [liftmesh.delaunay(points) for points in clouds]
    with ThreadPoolExecutor(max_workers=6) as pool:
        at_once = list(pool.map(liftmesh.delaunay, clouds))
    for expected, actual in zip(one_by_one, at_once, strict=True):
        np.testing.assert_array_equal(actual.simplices, expected.simplices)
        np.testing.assert_array_equal(actual.neighbors, expected.neighbors)


def test_threads_share_one_triangulation() -> None:
    rng = np.random.default_rng(2)
    points = rng.random((20_000, 2))
    queries = rng.random((8, 5000, 2))
    expected = [liftmesh.delaunay(points).find_simplex(part) for part in queries]
    shared = liftmesh.delaunay(points)
    with ThreadPoolExecutor(max_workers=8) as pool:
        actual = list(pool.map(shared.find_simplex, queries))
    np.testing.assert_array_equal(actual, expected)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("points", "delay"),
    [
        (UNIFORM, 0.02),
        (UNIFORM, 0.2),
        (UNIFORM, 1.0),
        (CIRCLE, 0.5),
        (MILLION_COPIES_AND_MORE, 0.3),
        (DENORMAL, 0.7),
        (ONE_COLUMN, 0.3),
    ],
    ids=["start", "ordering", "merging", "circle", "copies", "denormal", "one column"],
)
@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_stops_a_long_run_within_a_second(points: str, delay: float, threads: int) -> None:
    call = f"liftmesh.delaunay(points, threads={threads})"
    program = LONG_RUN.format(points=points, prepare="", call=call)
    assert seconds_to_stop(program, delay) < 1.0


@pytest.mark.slow
@pytest.mark.parametrize("delay", [0.3, 1.5])
@pytest.mark.parametrize("threads", [1, 2])
def test_ctrl_c_stops_a_long_run_with_weights(delay: float, threads: int) -> None:
    program = LONG_RUN.format(
        points=UNIFORM,
        prepare="weights = rng.random(8_000_000) * 2e-7",
        call=f"liftmesh.regular(points, weights=weights, threads={threads})",
    )
    assert seconds_to_stop(program, delay) < 1.0


@pytest.mark.slow
def test_rows_that_others_spoil_meanwhile_leave_names_of_rows() -> None:
    points = np.random.default_rng(4).random((4_000_000, 2))
    told = []

    def spoil(share: float) -> None:
        told.append(share)
        points[:1_000_000] = np.nan  # counted as finite by now, and read again later

    spoilt = liftmesh.delaunay(points, nonfinite="skip", threads=1, progress=spoil)
    assert told[0] < 0.3
    assert spoilt.simplices.min() >= 0
    assert spoilt.simplices.max() < len(points)


SPOILT = {
    "NaN": lambda rows: np.full_like(rows, np.nan),
    "infinite": lambda rows: rows * np.array([np.inf, -np.inf]),
    "moved": lambda rows: 1 - rows[:, ::-1],
    "far": lambda rows: rows * 1e300 - 1e299,
    "small": lambda rows: rows * 1e-9,
    "one place": lambda rows: np.full_like(rows, 0.5),
}


@pytest.mark.slow
@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("kind", SPOILT)
def test_rows_that_a_thread_writes_all_the_time_are_each_read_once(kind: str, threads: int) -> None:
    sound = np.random.default_rng(4).random((70_000, 2))  # enough for two threads
    spoilt = SPOILT[kind](sound)
    points = sound.copy()
    done = threading.Event()

    def write() -> None:
        for first in itertools.cycle(range(7)):
            points[first::7] = sound[first::7] if done.is_set() else spoilt[first::7]
            points[first::3] = sound[first::3]
            if done.is_set():
                break

    writer = threading.Thread(target=write)
    writer.start()
    try:
        found = [liftmesh.delaunay(points, nonfinite="skip", threads=threads) for _ in range(6)]
    finally:
        done.set()
        writer.join()
    for each in found:
        assert each.simplices.min() >= 0
        assert each.simplices.max() < len(points)
        rows = np.concatenate((each.simplices.ravel(), each.duplicates[:, 0], each.skipped))
        np.testing.assert_array_equal(np.unique(rows), np.arange(len(points)))


@pytest.mark.slow
def test_ctrl_c_stops_long_walks_within_a_second() -> None:
    program = LONG_RUN.format(
        points=TWO_COLUMNS,
        prepare="tri = liftmesh.delaunay(points); queries = rng.random((10_000_000, 2))",
        call="tri.find_simplex(queries)",
    )
    assert seconds_to_stop(program, 0.3) < 1.0


@pytest.mark.slow
def test_ctrl_c_stops_long_clipping_within_a_second() -> None:
    prepare = "; ".join(
        [
            "from liftmesh.cells.voronoi import clip",
            "from liftmesh.cells.domain import as_domain",
            "from liftmesh.cells.dual import dual_of",
            "domain = as_domain((0, 0, 1, 1), points)",
            "dual = dual_of(points)",
        ]
    )
    program = LONG_RUN.format(
        points="rng.random((2_000_000, 2))",
        prepare=prepare,
        call="[clip(dual, domain) for _ in range(9)]",
    )
    assert seconds_to_stop(program, 0.3) < 1.0
