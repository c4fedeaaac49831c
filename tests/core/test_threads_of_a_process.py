"""Threads and the process they are in: signals, forks, limits of the system, many small runs."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap

import begun_threads
import pytest

from liftmesh.base.options import VARIABLE


def test_many_small_runs_begin_no_threads(tmp_path):
    program = """
        points = np.random.default_rng(0).random((20_000, 2))
        print(*begun(lambda: [liftmesh.delaunay(points[:1000]) for _ in range(500)]))
        print(*begun(lambda: [liftmesh.delaunay(points, threads=2) for _ in range(10)]))
    """
    assert begun_threads.output(program, tmp_path, **{VARIABLE: "8"}) == "0 0\n10 1\n"


@pytest.mark.slow
def test_ctrl_c_ends_a_run_of_several_threads_and_leaves_none_behind(tmp_path):
    program = """
        points = np.random.default_rng(0).random((3_000_000, 2))
        counter.forget_threads()
        signal.signal(signal.SIGPROF, signal.default_int_handler)  # that of Ctrl-C
        for delay in (0.05, 0.3, 0.5):
            began = time.process_time()
            signal.setitimer(signal.ITIMER_PROF, delay)
            try:
                while True:
                    liftmesh.delaunay(points, threads=2, progress=lambda _: None)
            except KeyboardInterrupt:
                seconds = time.process_time() - began - delay
            print(seconds, counter.threads_held())
        few = liftmesh.delaunay(points[:30_000], threads=2)
        print(counter.most_threads(), len(few.simplices))
    """
    *interruptions, last = begun_threads.output(program, tmp_path).splitlines()
    assert len(interruptions) == 3
    seconds, after = zip(*(map(float, line.split()) for line in interruptions), strict=True)
    assert max(seconds) < 1.0  # of the processor, for both threads
    assert not any(after)
    during, triangles = map(int, last.split())
    assert during == 1
    assert triangles > 59_000


@pytest.mark.slow
@pytest.mark.parametrize("way", ["os.fork", "multiprocessing", "amid a run"])
def test_a_forked_process_goes_on(way):
    program = """
        import hashlib, multiprocessing, os, sys, threading, warnings
        import numpy as np
        import liftmesh
        warnings.simplefilter("ignore", DeprecationWarning)  # Python's, of any fork with threads

        points = np.random.default_rng(0).random((100_000, 2))

        def digest(_=None):
            found = liftmesh.delaunay(points, threads=2), liftmesh.delaunay(points)
            return [hashlib.sha256(t.simplices.tobytes()).hexdigest() for t in found]

        def forked():
            child = os.fork()
            if child == 0:
                os._exit(0 if digest() == expected else 1)
            return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])

        expected = digest()
        if sys.argv[1] == "os.fork":
            print(forked(), digest() == expected)
        elif sys.argv[1] == "multiprocessing":
            with multiprocessing.get_context("fork").Pool(2) as pool:
                found = pool.map(digest, range(4))
            print(0 if found == [expected] * 4 else 1, digest() == expected)
        else:
            busy = threading.Event()
            large = np.random.default_rng(0).random((2_000_000, 2))
            run = lambda: liftmesh.delaunay(large, threads=2, progress=lambda _: busy.set())
            thread = threading.Thread(target=run)
            thread.start()
            busy.wait()
            print(forked(), digest() == expected)
            thread.join()
    """
    assert output(program, {VARIABLE: "2"}, way) == "0 True\n"


@pytest.mark.slow
def test_a_process_forked_amid_a_run_has_its_threads_to_itself(tmp_path):
    program = """
        warnings.simplefilter("ignore", DeprecationWarning)  # Python's, of any fork with threads

        points = np.random.default_rng(0).random((2_000_000, 2))

        busy = threading.Event()
        thread = threading.Thread(
            target=liftmesh.delaunay, args=[points], kwargs={"progress": lambda _: busy.set()}
        )
        thread.start()
        busy.wait()
        child = os.fork()
        if child == 0:
            os._exit(begun(lambda: liftmesh.delaunay(points))[1])
        print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
        thread.join()
    """
    assert begun_threads.output(program, tmp_path, **{VARIABLE: "3"}) == "2\n"


@pytest.mark.slow
def test_a_system_without_threads_to_give_gets_the_same_result(tmp_path):
    program = """
        import resource

        points = np.random.default_rng(0).random((1_500_000, 2))
        expected = liftmesh.delaunay(points, threads=1).simplices
        if os.getuid() == 0:
            os.setresuid(54_321, 54_321, 54_321)  # the limit is not for root
        _, hard = resource.getrlimit(resource.RLIMIT_NPROC)
        resource.setrlimit(resource.RLIMIT_NPROC, (0, hard))
        counter.forget_threads()
        found = liftmesh.delaunay(points, threads=4).simplices
        print(np.array_equal(found, expected), counter.most_threads())
        resource.setrlimit(resource.RLIMIT_NPROC, (hard, hard))
        found = liftmesh.delaunay(points).simplices  # the four are no longer counted
        print(np.array_equal(found, expected), counter.most_threads())
    """
    assert begun_threads.output(program, tmp_path, **{VARIABLE: "3"}) == "True 0\nTrue 2\n"


def output(program: str, environment: dict[str, str] | None = None, *words: str) -> str:
    """What a program prints in a process of its own, which must end well."""
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(program), *words],
        capture_output=True,
        text=True,
        env={**os.environ, **(environment or {})},
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout
