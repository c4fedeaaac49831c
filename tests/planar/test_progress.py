"""What a caller hears of a run: a share that never falls, from its own thread, at last 1.0."""

from __future__ import annotations

import gc
import io
import signal
import threading
from typing import get_args

import numpy as np
import pytest
from clouds import FAMILIES
from distributions import circle, uniform

import liftmesh
from liftmesh.base.options import Algorithm
from liftmesh.errors import DegenerateInputError, DuplicateHeightError, NonFiniteError
from liftmesh.terrain.triangulate import DONE_AFTER

RUNS = [liftmesh.delaunay, liftmesh.triangulate]


class Listener:
    """Keeps what it hears, and the threads that told it."""

    def __init__(self) -> None:
        self.told: list[float] = []
        self.threads: set[int] = set()

    def __call__(self, share: float) -> None:
        self.told.append(share)
        self.threads.add(threading.get_ident())

    def check(self, *, at_least: int = 1) -> None:
        """Hold what was heard of a run that ended well against the promise."""
        assert len(self.told) >= at_least
        self.check_shares()
        assert self.told[-1] == 1.0
        assert 1.0 not in self.told[:-1], "done before it was"

    def check_shares(self) -> None:
        """Hold what was heard so far against the promise."""
        assert all(type(share) is float for share in self.told)
        assert self.told == sorted(self.told)
        assert all(0.0 <= share <= 1.0 for share in self.told)
        assert self.threads <= {threading.get_ident()}


@pytest.fixture
def listener() -> Listener:
    return Listener()


@pytest.mark.parametrize("run", RUNS)
@pytest.mark.parametrize("n", [3, 100, 20_000])
@pytest.mark.parametrize("algorithm", get_args(Algorithm))
def test_every_method_ends_with_one(run, n, algorithm, listener):
    if algorithm in {"lf", "lfres"}:
        n = min(n, 300)
    run(uniform(n, np.random.default_rng(0)), algorithm=algorithm, progress=listener)
    listener.check()


@pytest.mark.slow
@pytest.mark.parametrize("threads", [1, 2, 5, None])
@pytest.mark.parametrize("run", RUNS)
def test_a_large_run_tells_how_far_it_is(run, threads, listener):
    n = 3_000_000 if threads == 1 else 1_500_000  # ten times the gap of tellings
    run(uniform(n, np.random.default_rng(0)), threads=threads, progress=listener)
    listener.check(at_least=2)
    if threads == 1:
        assert np.diff([0.0, *listener.told]).max() < 0.4


@pytest.mark.parametrize("kind", ["weights", "radii"])
@pytest.mark.parametrize("n", [3, 100, 800_000])
def test_weights_are_no_other_run(kind, n, listener):
    rng = np.random.default_rng(1)
    points, values = uniform(n, rng), rng.random(n) / n
    liftmesh.regular(points, **{kind: values}, progress=listener)
    listener.check(at_least=2 if n > 100 else 1)


@pytest.mark.parametrize("family", ["lattice", "circle", "two-columns", "clusters", "duplicates"])
@pytest.mark.parametrize("order", ["engine", "canonical"])
def test_whatever_the_points_and_the_order(family, order, listener):
    points = FAMILIES[family](400_000, np.random.default_rng(0))
    liftmesh.delaunay(points, order=order, progress=listener)
    listener.check()


def test_rows_that_are_left_out_count_as_work_done(listener):
    points = np.repeat(uniform(400_000, np.random.default_rng(0)), 3, axis=0)
    points[::5] = np.nan
    liftmesh.delaunay(points, nonfinite="skip", progress=listener)
    listener.check()


@pytest.mark.parametrize("name", ["cloud.ply", "cloud.obj", "cloud.npz"])
def test_reading_counts_and_so_does_each_stage(name, listener, tmp_path):
    points = np.random.default_rng(0).random((5000, 3))
    liftmesh.write(tmp_path / name, liftmesh.Cloud(points))
    for source in (tmp_path / name, str(tmp_path / name), points):
        listener.told.clear()
        liftmesh.triangulate(source, progress=listener)
        listener.check()
        assert {*DONE_AFTER.values(), 1.0} <= {round(share, 9) for share in listener.told}


def test_the_triangulation_is_most_of_a_surface(listener):
    points = np.column_stack((circle(300_000, np.random.default_rng(0)), np.zeros(300_000)))
    liftmesh.triangulate(points, plane="fit", on_duplicate="mean", progress=listener)
    listener.check(at_least=4)
    before = [share for share in listener.told if share < 0.1]
    after = [share for share in listener.told if share > 0.9]
    assert len(before) >= 2  # reading, and the plane
    assert len(after) >= 3  # the triangulation, the heights, and the end


@pytest.mark.parametrize("run", RUNS)
@pytest.mark.parametrize("n", [50, 500_000])
def test_a_run_in_another_thread_tells_that_one(run, n, listener):
    points = uniform(n, np.random.default_rng(0))
    thread = threading.Thread(
        target=run, args=[points], kwargs={"threads": 3, "progress": listener}
    )
    thread.start()
    thread.join()
    assert listener.threads == {thread.ident}
    assert listener.told[-1] == 1.0


def on_a_line(n: int) -> np.ndarray:
    return np.column_stack((np.arange(n), 2.0 * np.arange(n)))


def with_a_gap(n: int) -> np.ndarray:
    points = uniform(n, np.random.default_rng(0))
    points[-1, 1] = np.nan
    return points


@pytest.mark.parametrize("run", RUNS)
@pytest.mark.parametrize("n", [9, 1_500_000])
@pytest.mark.parametrize(
    ("make", "error"),
    [
        (on_a_line, DegenerateInputError),
        (lambda n: np.ones((n, 2)), DegenerateInputError),
        (with_a_gap, NonFiniteError),
    ],
    ids=["line", "equal", "not finite"],
)
def test_a_run_that_fails_never_says_that_it_is_done(run, n, make, error, listener):
    with pytest.raises(error):
        run(make(n), progress=listener)
    listener.check_shares()
    assert 1.0 not in listener.told


@pytest.mark.parametrize("algorithm", get_args(Algorithm))
def test_nor_does_gift_wrapping(algorithm, listener):
    with pytest.raises(DegenerateInputError):
        liftmesh.delaunay(on_a_line(500), algorithm=algorithm, progress=listener)
    assert listener.told == []


@pytest.mark.parametrize("run", RUNS)
@pytest.mark.parametrize(
    "options", [{"algorithm": "magic"}, {"nonfinite": "drop"}, {"threads": 0}, {"apex": "centre"}]
)
def test_nor_does_a_wrong_option(run, options, listener):
    with pytest.raises(liftmesh.InputError):
        run(np.eye(3), **options, progress=listener)
    assert 1.0 not in listener.told


def test_nor_do_heights_that_collide(listener):
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 1, 1.0]])
    with pytest.raises(DuplicateHeightError):
        liftmesh.triangulate(points, on_duplicate="error", progress=listener)
    listener.check_shares()
    assert 0.0 < listener.told[-1] < 1.0


def test_nor_does_a_broken_file(listener, tmp_path):
    (tmp_path / "cloud.ply").write_bytes(b"ply\n")
    for name in ("cloud.ply", "nowhere.ply"):
        with pytest.raises((liftmesh.FormatError, OSError)):
            liftmesh.triangulate(tmp_path / name, progress=listener)
    assert listener.told == []


NOT_OURS = [NonFiniteError("enough", row=0), OSError("enough"), StopIteration(), SystemExit(3)]


@pytest.mark.parametrize("raised", NOT_OURS, ids=repr)
@pytest.mark.parametrize("late", [False, True])
def test_what_it_raises_comes_out_as_it_is(raised, late):
    points = np.random.default_rng(0).random((1000, 3))
    before = points.tobytes()

    def progress(share: float) -> None:
        if share == 1.0 or not late:
            raise raised

    for run in RUNS:
        with pytest.raises(type(raised)) as caught:
            run(points, progress=progress)
        assert caught.value is raised
        assert points.tobytes() == before
    assert len(liftmesh.delaunay(points).simplices) > 1900


@pytest.mark.parametrize("raised", NOT_OURS, ids=repr)
@pytest.mark.parametrize("run", RUNS)
def test_amid_the_triangulation_too(run, raised):
    def progress(share: float) -> None:
        if share > 0.3:
            raise raised

    with pytest.raises(type(raised)) as caught:
        run(uniform(1_000_000, np.random.default_rng(0)), progress=progress)
    assert caught.value is raised


def test_a_run_may_be_told_of_amid_another():
    inner, outer = Listener(), Listener()
    few = uniform(20_000, np.random.default_rng(1))
    expected = liftmesh.delaunay(few).simplices

    def progress(share: float) -> None:
        outer(share)
        inner.told.clear()
        assert np.array_equal(liftmesh.delaunay(few, progress=inner).simplices, expected)
        inner.check()

    liftmesh.delaunay(uniform(1_000_000, np.random.default_rng(0)), progress=progress)
    outer.check(at_least=2)


def test_a_signal_handler_may_raise_where_there_is_progress(listener):
    def enough(*_args: object) -> None:
        raise ZeroDivisionError

    def run_on() -> None:
        points = uniform(1_000_000, np.random.default_rng(0))
        signal.setitimer(signal.ITIMER_PROF, 0.1)
        while True:
            listener.told.clear()
            liftmesh.delaunay(points, threads=2, progress=listener)

    gc.disable()  # nobody can catch what is raised in a callback of the collector
    previous = signal.signal(signal.SIGPROF, enough)
    try:
        with pytest.raises(ZeroDivisionError):
            run_on()
    finally:
        signal.signal(signal.SIGPROF, previous)
        gc.enable()
    listener.check_shares()


def test_the_surface_is_the_same_with_and_without():
    points = np.random.default_rng(0).random((50_000, 3))
    heard, silent = io.StringIO(), liftmesh.triangulate(points)
    surface = liftmesh.triangulate(points, progress=lambda share: print(share, file=heard))
    assert surface.faces.tobytes() == silent.faces.tobytes()
    assert heard.getvalue().endswith("\n1.0\n")
    assert list(surface.report.seconds) == list(silent.report.seconds)


@pytest.mark.parametrize("crossing", ["error", "split"])
def test_splitting_edges_tells_of_all_rounds(crossing, listener) -> None:
    ends = np.random.default_rng(4).random((60, 2, 2)) * 64
    if crossing == "split":
        rows = np.arange(120).reshape(-1, 2)
        liftmesh.constrained_delaunay(
            ends.reshape(-1, 2), rows, crossing=crossing, progress=listener
        )
        listener.check(at_least=2)
        listener.told.clear()
    cloud = np.random.default_rng(5).random((500, 3)) * (64, 64, 1)
    found = liftmesh.triangulate(
        cloud, soft_breaklines=list(ends), crossing=crossing, progress=listener
    )
    assert found.report.lines["rows_at_crossings"] > 100
    listener.check(at_least=6)
