"""A short soak test, and whether it tells a leak from memory that varies."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from commands import ROOT
from process_state import MEGA, State
from soak.leaks import growth, leaks


def course(*resident: float, files: int = 5, threads: int = 1) -> list[State]:
    return [State(int(each * MEGA), files, threads) for each in resident]


def test_memory_that_varies_is_flat() -> None:
    samples = course(10, 90, 100, 104, 99, 108, 100, 101, 107, 100, 99.5, 120)
    assert growth(samples) == int(0.5 * MEGA)
    assert list(leaks(samples, MEGA)) == []


def test_memory_that_grows_is_not() -> None:
    samples = course(*(100 + k for k in range(20)))
    assert growth(samples) == 8 * MEGA
    assert list(leaks(samples, 8 * MEGA)) == []
    assert list(leaks(samples, 7 * MEGA)) == ["memory grew by 8.0 MB, more than 7.0"]


@pytest.mark.parametrize(
    ("last", "said"),
    [
        (course(100, files=6), "6 files are open, where there were 5"),
        (course(100, threads=3), "3 threads are there, where there were 1"),
    ],
)
def test_nor_are_files_and_threads_that_stay(last: list[State], said: str) -> None:
    assert list(leaks(course(*[100] * 9) + last, MEGA)) == [said]


# Its handlers of signals raise anywhere, also where coverage would never let go of a lock again.
UNCOUNTED = {name: value for name, value in os.environ.items() if "COVERAGE" not in name}


@pytest.mark.campaign
def test_a_short_soak_is_flat() -> None:
    words = ["--calls", "800", "--large", "5", "--rows", "40000"]
    done = subprocess.run(
        [sys.executable, str(ROOT / "scripts" / "soak"), *words],
        capture_output=True,
        text=True,
        env=UNCOUNTED,
        timeout=1200,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.endswith("\nflat\n")
    assert "Aborted" in done.stdout  # calls were aborted
    assert "FormatError" in done.stdout
