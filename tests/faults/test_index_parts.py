"""Parts of the index of `find_simplex` that one thread makes: no handler or fork waits for ever."""

from __future__ import annotations

import pytest
from children import output

SETUP = """
    import copy, os, signal, threading, time, warnings
    import numpy as np, liftmesh
    warnings.simplefilter("ignore", DeprecationWarning)  # Python's, of any fork with threads

    angles = np.linspace(0, 2 * np.pi, 400_000)
    rim = np.column_stack([np.cos(angles), np.sin(angles)])
    wheel = liftmesh.delaunay(np.vstack([rim, [0, 0]]))
    asked = np.random.default_rng(0).uniform(-0.5, 0.5, (50_000, 2))
    expected = copy.copy(wheel).find_simplex(asked)
"""


def test_a_handler_may_need_what_it_interrupts() -> None:
    program = """
    begun, answers = [], []

    def handler(*_):
        if len(begun) < 8:
            begun.append(None)
            answers.append(np.array_equal(wheel.find_simplex(asked[:500]), expected[:500]))

    signal.signal(signal.SIGALRM, handler)
    signal.setitimer(signal.ITIMER_REAL, 0.002, 0.002)
    right = np.array_equal(wheel.find_simplex(asked), expected)
    signal.setitimer(signal.ITIMER_REAL, 0)
    print(right, all(answers), len(answers) == len(begun) > 0)
"""
    assert output(SETUP + program) == "True True True\n"


@pytest.mark.slow
def test_a_handler_amid_the_making_makes_one_of_its_own() -> None:
    # Signals are looked for every 50 ms. So the making must take longer, and the call begin with
    # it: calls that are ended early have paid for it, and left it unmade.
    program = """
    class Ended(Exception):
        pass

    def end(*_):
        raise Ended

    def ends_early(wheel):
        signal.setitimer(signal.ITIMER_REAL, 0.002)
        try:
            wheel.find_simplex(asked)
        except Ended:
            return True
        return False

    def interrupted(directions):
        angles = np.random.default_rng(1).uniform(0, 2 * np.pi, directions)
        wheel = liftmesh.delaunay(np.vstack([np.c_[np.cos(angles), np.sin(angles)], [0, 0]]))
        expected = copy.copy(wheel).find_simplex(asked[:16])
        wheel.find_simplex(asked[:1])
        signal.signal(signal.SIGALRM, end)
        until = time.process_time() + 0.5
        ended = [ends_early(wheel)]
        while ended[-1] and time.process_time() < until:
            ended.append(ends_early(wheel))
        answers = []

        def handler(*_):
            if len(answers) < 3:
                answers.append(None)
                at = len(answers) - 1
                answers[at] = np.array_equal(wheel.find_simplex(asked[:16]), expected)

        signal.signal(signal.SIGALRM, handler)
        signal.setitimer(signal.ITIMER_REAL, 0.002, 0.002)
        right = np.array_equal(wheel.find_simplex(asked[:16]), expected)
        signal.setitimer(signal.ITIMER_REAL, 0)
        return all(ended), right, all(answers), len(answers) > 1

    for directions in (1_500_000, 3_000_000, 6_000_000):  # on a fast machine, more
        found = interrupted(directions)
        if found[-1]:
            break
    print(*found)
"""
    assert output(SETUP + program) == "True True True True\n"


@pytest.mark.slow
def test_a_child_makes_what_a_thread_of_its_parent_was_making() -> None:
    # The first part is made ahead: Python 3.11 holds a lock while it computes a cached property.
    program = """
    wheel.find_simplex(asked[:1])
    found = []
    thread = threading.Thread(target=lambda: found.append(wheel.find_simplex(asked)))
    thread.start()
    children = []
    while not children or (thread.is_alive() and len(children) < 12):
        time.sleep(0.005)
        child = os.fork()
        if child == 0:
            signal.alarm(60)
            os._exit(not np.array_equal(wheel.find_simplex(asked[:5000]), expected[:5000]))
        children.append(child)
    thread.join()
    codes = {os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) for child in children}
    print(np.array_equal(found[0], expected), codes)
"""
    assert output(SETUP + program) == "True {0}\n"
