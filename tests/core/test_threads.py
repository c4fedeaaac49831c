"""However many threads work on a run: one result, no more of them than may be, none left behind."""

from __future__ import annotations

import os
from pathlib import Path
from typing import get_args

import hypothesis.strategies as st
import numpy as np
import pytest
from begun_threads import output
from clouds import FAMILIES
from distributions import circle, clusters, denormal, lattice, two_columns, uniform
from hypothesis import given, settings
from meshes import bits
from numpy.typing import NDArray

import liftmesh
from liftmesh import _kernel
from liftmesh.base.options import MOST_THREADS, VARIABLE, Algorithm, as_threads
from liftmesh.errors import DegenerateInputError, InputError

Points = NDArray[np.float64]

SHARE = 1 << 15  # rows that one thread sorts into cells at a time
TASKS = Path("/proc/self/task")


def clustered_copies(n: int, rng: np.random.Generator) -> Points:
    few = clusters(n // 4, rng)
    return few[rng.integers(0, len(few), n)]


def one_off(n: int, rng: np.random.Generator) -> Points:
    points = np.column_stack((np.ones(n), rng.permutation(n)))
    points[n // 3, 0] = 2.0
    return points


def not_all_finite(n: int, rng: np.random.Generator) -> Points:
    points = uniform(n, rng)
    points[rng.integers(0, n, n // 10), rng.integers(0, 2, n // 10)] = np.nan
    points[:5000:7] = np.inf
    return points


def equal(n: int, rng: np.random.Generator) -> Points:
    return np.vstack((np.ones((n, 2)), rng.random((3, 2))))


class TestOneResult:
    """Bit for bit, whoever does the work."""

    @pytest.mark.parametrize(
        ("make", "n"),
        [
            (uniform, 60_000),
            (clustered_copies, 60_000),
            (lattice, 60_000),
            (two_columns, 60_000),
            (one_off, 60_000),
            (not_all_finite, 60_000),
            (denormal, 60_000),
            (equal, 60_000),
            (circle, 100_000),
        ],
    )
    def test_for_every_number_of_threads(self, make, n):
        points = make(n, np.random.default_rng(0))
        alone = bits(liftmesh.delaunay(points, nonfinite="skip", threads=1))
        for threads in (2, 3, 4, 5, 6, 7, 8, None):
            assert bits(liftmesh.delaunay(points, nonfinite="skip", threads=threads)) == alone

    @pytest.mark.parametrize(
        "n",
        [
            near + step
            for near in (
                *(_kernel.ROWS_PER_THREAD * k for k in (1, 2, 3, 5)),
                *(SHARE * k for k in (1, 2, 3)),
            )
            for step in (-1, 0, 1)
        ],
    )
    def test_where_the_work_is_shared_out_in_another_way(self, n):
        points = uniform(n, np.random.default_rng(n))
        alone = bits(liftmesh.delaunay(points, threads=1))
        for threads in (2, 3, 8, None):
            assert bits(liftmesh.delaunay(points, threads=threads)) == alone

    @given(st.sampled_from(sorted(FAMILIES)), st.integers(3, 900), st.integers(2, 8))
    @settings(max_examples=60)
    def test_for_few_points_by_every_method(self, family, n, threads):
        points = FAMILIES[family](n, np.random.default_rng(n))
        for algorithm in get_args(Algorithm) if n < 60 else ("auto", "lfres-indexed"):
            assert outcome(points, algorithm, threads) == outcome(points, algorithm, 1)

    @given(
        st.sampled_from(sorted(FAMILIES)),
        st.integers(2 * _kernel.ROWS_PER_THREAD, 5 * _kernel.ROWS_PER_THREAD),
        st.integers(2, 8),
    )
    @settings(max_examples=25)
    def test_for_every_family(self, family, n, threads):
        points = FAMILIES[family](n, np.random.default_rng(n))
        assert outcome(points, "auto", threads) == outcome(points, "auto", 1)

    def test_as_views_of_any_strides(self):
        rows = np.random.default_rng(3).random((30_000, 5)).astype(np.float32)
        for points in (rows[::-1, 3:], np.asfortranarray(rows[:, :2]), rows[::2, ::3]):
            alone = bits(liftmesh.delaunay(points, threads=1))
            assert bits(liftmesh.delaunay(points, threads=4)) == alone

    def test_in_canonical_order(self):
        points = lattice(30_000, np.random.default_rng(0))
        alone = bits(liftmesh.delaunay(points, order="canonical", threads=1))
        assert bits(liftmesh.delaunay(points, order="canonical", threads=4)) == alone

    def test_of_errors_too(self):
        points = uniform(100_000, np.random.default_rng(0))
        points[[99_000, 70_000, 31_000], 1] = np.nan
        for threads in (1, 2, 8):
            with pytest.raises(liftmesh.NonFiniteError, match="row 31000"):
                liftmesh.delaunay(points, threads=threads)
            with pytest.raises(DegenerateInputError, match="100,000 rows hold 1 distinct"):
                liftmesh.delaunay(np.zeros((100_000, 2)), threads=threads)
            with pytest.raises(DegenerateInputError, match="from row 0 to row 99999"):
                liftmesh.delaunay(np.arange(200_000.0).reshape(-1, 2), threads=threads)

    def test_of_surfaces(self):
        points = np.random.default_rng(1).random((30_000, 3))
        points[20_000:, :2] = points[:10_000, :2]
        alone = liftmesh.triangulate(points, on_duplicate="highest", threads=1)
        for threads in (2, 5, None):
            surface = liftmesh.triangulate(points, on_duplicate="highest", threads=threads)
            assert surface.faces.tobytes() == alone.faces.tobytes()
            assert surface.report.left_out.tobytes() == alone.report.left_out.tobytes()


def outcome(points: Points, algorithm: Algorithm, threads: int) -> list[bytes] | str:
    """What a run gives, or how it fails."""
    try:
        return bits(liftmesh.delaunay(points, algorithm=algorithm, threads=threads))
    except DegenerateInputError as error:
        return str(error)


class TestHowMany:
    """What counts as a number of threads, and how many there are then."""

    @pytest.mark.parametrize("threads", [0, -1, 1.5, 2.0, True, False, "2", 10**9, 1025, [2]])
    @pytest.mark.parametrize("n", [3, 100_000])
    def test_other_numbers_are_refused(self, threads, n):
        points = uniform(n, np.random.default_rng(0))
        for run in (liftmesh.delaunay, liftmesh.triangulate):
            with pytest.raises(InputError, match=r"threads is .*: give a whole number from 1 to"):
                run(points, threads=threads)

    @pytest.mark.parametrize("threads", [1, np.int64(1), np.uint8(1)])
    def test_whole_numbers_of_any_kind_are_taken(self, threads):
        assert as_threads(threads, 3) == (1, False)
        assert len(liftmesh.delaunay(np.eye(2, 3).T, threads=threads).simplices) == 1

    @pytest.mark.parametrize("value", ["abc", "0", "-2", "1.5", "1025", "two", "9" * 5000])
    def test_other_values_of_the_variable_are_refused(self, value, monkeypatch):
        monkeypatch.setenv(VARIABLE, value)
        points = uniform(2 * _kernel.ROWS_PER_THREAD, np.random.default_rng(0))
        said = f"{VARIABLE} is '{value[:20]}.*': give a whole number"
        with pytest.raises(InputError, match=said):
            liftmesh.delaunay(points)
        # Who says a number does not ask the environment, and few rows do not either.
        liftmesh.delaunay(points, threads=2)
        liftmesh.delaunay(points[:-1])

    def test_the_default_is_the_variable_or_the_cores_of_this_process(self, monkeypatch):
        monkeypatch.setenv(VARIABLE, "7")
        assert as_threads(None, 10**6) == (7, True)
        for unset in (
            lambda: monkeypatch.setenv(VARIABLE, ""),
            lambda: monkeypatch.delenv(VARIABLE),
        ):
            unset()
            expected = min(len(os.sched_getaffinity(0)), MOST_THREADS)
            assert as_threads(None, 10**6) == (expected, True)

    def test_few_rows_take_one_by_default(self):
        few = 2 * _kernel.ROWS_PER_THREAD - 1
        assert as_threads(None, few) == (1, True)

    @pytest.mark.parametrize("by", ["variable", "argument"])
    def test_a_run_takes_as_many_as_it_may(self, by, tmp_path):
        program = f"""
            points = np.random.default_rng(0).random((300_000, 2))
            for limit in (1, 2, 3, 6):
                os.environ["{VARIABLE}"] = str(limit) if "{by}" == "variable" else "4"
                threads = limit if "{by}" == "argument" else None
                print(*begun(lambda: liftmesh.delaunay(points, threads=threads)))
        """
        assert output(program, tmp_path).split() == ["0", "0", "1", "1", "2", "2", "5", "5"]

    def test_few_rows_take_few_whatever_is_asked(self, tmp_path):
        program = f"""
            few = np.random.default_rng(0).random((400, 2))
            for algorithm in {get_args(Algorithm)}:
                print(*begun(lambda: liftmesh.delaunay(few, algorithm=algorithm, threads=64)))
            few = np.random.default_rng(0).random((3 * {_kernel.ROWS_PER_THREAD}, 2))
            print(*begun(lambda: liftmesh.delaunay(few, threads=64)))
        """
        *none, last = output(program, tmp_path).splitlines()
        assert none == ["0 0"] * len(get_args(Algorithm))
        assert last == "2 2"

    @pytest.mark.parametrize("limit", [2, 4])
    def test_runs_at_once_share_the_limit(self, limit, tmp_path):
        program = """
            callers, gate = 8, Barrier(8)
            clouds = [np.random.default_rng(k).random((60_000, 2)) for k in range(callers)] * 2
            expected = [liftmesh.delaunay(points, threads=1).simplices for points in clouds]
            with ThreadPoolExecutor(callers) as pool:
                list(pool.map(lambda _: gate.wait(), range(callers)))  # all callers are there
                runs = lambda: found.extend(pool.map(liftmesh.delaunay, clouds))
                found = []
                most = begun(runs)[1]
            print(most, all(np.array_equal(a.simplices, b) for a, b in zip(found, expected)))
        """
        most, is_right = output(program, tmp_path, **{VARIABLE: str(limit)}).split()
        assert is_right == "True"
        assert 1 <= int(most) <= limit - 1


def threads_alive() -> set[str]:
    """Number the threads at one moment: those listed then, and not ending afterwards."""
    return {each.name for each in list(TASKS.iterdir()) if _alive(each)}


def _alive(thread: Path) -> bool:
    exiting = 0x4  # PF_EXITING: it was joined, maybe, and only the system has not put it away
    try:
        stat = (thread / "stat").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return False
    return not int(stat.rpartition(")")[2].split()[6]) & exiting


@pytest.mark.parametrize("run", [liftmesh.delaunay, liftmesh.triangulate])
@pytest.mark.parametrize("patience", [0.0, 0.06, 0.6])
def test_an_exception_of_progress_ends_a_run_and_harms_no_other(run, patience):
    points = uniform(1_000_000, np.random.default_rng(0))
    before = threads_alive()
    told = []

    def progress(share: float) -> None:
        told.append(share)
        if share >= patience:
            raise ZeroDivisionError(share)

    with pytest.raises(ZeroDivisionError) as caught:
        run(points, threads=2, progress=progress)
    assert caught.value.args == (told[-1],)
    assert patience <= told[-1] < 1.0
    assert max(told[:-1], default=-1.0) < patience
    assert threads_alive() <= before  # some of other tests may end meanwhile
    few = points[:50_000]
    again = [bits(liftmesh.delaunay(few, threads=threads)) for threads in (1, 2)]
    assert again[0] == again[1]
