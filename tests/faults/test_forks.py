"""Forked processes: a fork during a run is refused in the child, and harms nobody."""

from __future__ import annotations

from pathlib import Path

import begun_threads
import pytest
from children import output

from liftmesh.base.options import VARIABLE

FORK_AMID = """
    warnings.simplefilter("ignore", DeprecationWarning)  # Python's, of any fork with threads

    way, threads = os.environ["WAY"], int(os.environ["THREADS"])
    points = np.random.default_rng(0).random((1_500_000, 2))
    few = points[:100_000]
    expected = liftmesh.delaunay(few).simplices
    simplices = liftmesh.delaunay(points).simplices
    parent, child = os.getpid(), None

    def fork(*_):
        global child
        if child is None:
            child = os.fork()

    if way == "signal":
        signal.signal(signal.SIGPROF, fork)
        signal.setitimer(signal.ITIMER_PROF, 0.1)  # of the processor: amid the run
    runs = {
        "delaunay": lambda: liftmesh.delaunay(points, threads=threads, progress=fork).simplices,
        "verify": lambda: bool(liftmesh.verify(points, simplices, threads=threads, progress=fork)),
        "signal": lambda: liftmesh.delaunay(points, threads=threads).simplices,
    }
    try:
        found = np.array_equal(runs[way](), True if way == "verify" else simplices)
    except RuntimeError as error:
        found = str(error)
    if os.getpid() != parent:  # nothing is left of the run, and threads are to be had again
        right = np.array_equal(liftmesh.delaunay(few).simplices, expected)
        _, most = begun(lambda: liftmesh.delaunay(points))
        os._exit(0 if "forked during a run" in str(found) and right and most == 2 else 1)
    print(found, os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("way", "threads"), [("delaunay", 1), ("delaunay", 3), ("verify", 3), ("signal", 3)]
)
def test_a_fork_amid_a_run_leaves_the_run_to_the_parent(
    way: str, threads: int, tmp_path: Path
) -> None:
    given = {"WAY": way, "THREADS": str(threads), VARIABLE: "3", "OPENBLAS_NUM_THREADS": "1"}
    assert begun_threads.output(FORK_AMID, tmp_path, **given) == "True 0\n"


def test_a_fork_amid_a_computed_property_leaves_the_child_its_own() -> None:
    program = """
        import os, signal, sys, threading, warnings
        import numpy as np, liftmesh
        from liftmesh import Triangulation
        warnings.simplefilter("ignore", DeprecationWarning)  # Python's, of any fork with threads

        started, forked = threading.Event(), threading.Event()
        kind = type(vars(Triangulation)["edges"])

        class Slow:
            @kind
            def edges(self):
                started.set()
                forked.wait(60)
                return 1

        first, second = Slow(), Slow()
        thread = threading.Thread(target=lambda: first.edges)
        thread.start()
        started.wait(60)
        child = os.fork()
        forked.set()
        if child == 0:
            signal.alarm(20)  # would be its end
            os._exit(second.edges + first.edges - 2)
        thread.join()
        print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), vars(first))
    """
    assert output(program) == "0 {'edges': 1}\n"


def test_results_travel_between_processes_that_were_spawned() -> None:
    program = """
        import multiprocessing, sys, types
        import numpy as np, liftmesh

        # What is pickled must be found by its name in the other process: the library's own is.
        context = multiprocessing.get_context("spawn")
        sys.modules["__main__"].__spec__ = None
        clouds = [np.random.default_rng(k).random((9000, 2)) for k in range(3)]
        with context.Pool(1) as pool:
            found = pool.map(liftmesh.delaunay, clouds)
            pairs = [(cloud, each.simplices) for cloud, each in zip(clouds, found)]
            proofs = pool.starmap(liftmesh.verify, pairs)
        expected = [liftmesh.delaunay(cloud) for cloud in clouds]
        print(all(np.array_equal(a.simplices, b.simplices) for a, b in zip(found, expected)))
        print(all(p == e.verify() for p, e in zip(proofs, expected)))
    """
    assert output(program) == "True\nTrue\n"


def test_python_threads_share_arrays() -> None:
    program = """
        import sys
        from concurrent.futures import ThreadPoolExecutor
        import numpy as np, liftmesh

        points = np.random.default_rng(0).random((60_000, 2))
        tri = liftmesh.delaunay(points)
        proof = tri.verify()
        jobs = [
            lambda: np.array_equal(liftmesh.delaunay(points).simplices, tri.simplices),
            lambda: np.array_equal(liftmesh.delaunay(points, threads=3).simplices, tri.simplices),
            lambda: liftmesh.verify(points, tri.simplices) == proof,
            lambda: liftmesh.verify(points, tri.simplices, threads=3) == proof,
            lambda: tri.find_simplex(points).min() >= 0,
        ]
        sys.setswitchinterval(1e-5)
        with ThreadPoolExecutor(5) as pool:
            print(all(pool.map(lambda job: job(), jobs * 6)))
    """
    assert output(program) == "True\n"
