"""Rows without a vertex, judged by `verify` whatever the triangles look like, in little memory."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

import liftmesh

RNG = np.random.default_rng(12)
POINTS = RNG.random((60_000, 2))
WEIGHTS = RNG.random(60_000) * 1e-4
FOUND = liftmesh.regular(POINTS, weights=WEIGHTS)


def test_triangles_in_any_order() -> None:
    hidden = len(FOUND.hidden)
    assert 20_000 < hidden < 50_000
    listed = RNG.permutation(len(FOUND.simplices))
    for simplices in (FOUND.simplices, FOUND.simplices[listed], np.roll(FOUND.simplices, 1, 1)):
        for threads in (1, 3):
            judged = liftmesh.verify(POINTS, simplices, weights=WEIGHTS, threads=threads)
            assert judged.canonical
            assert (judged.n_hidden, judged.n_duplicates) == (hidden, 0)


@pytest.mark.parametrize("more", [0, 5])
def test_triangles_that_share_no_rows(more: int) -> None:
    """The rows of each triangle are its own; only merging them leaves rows without a vertex."""
    rows = np.concatenate([FOUND.simplices.ravel(), FOUND.hidden[:more]])
    simplices = np.arange(FOUND.simplices.size).reshape(-1, 3)
    judged = liftmesh.verify(POINTS[rows], simplices, weights=WEIGHTS[rows])
    assert judged.canonical
    assert judged.n_vertices == len(POINTS) - len(FOUND.hidden)
    assert (judged.n_hidden, judged.n_duplicates) == (more, judged.n_merged)


def test_a_row_that_is_not_hidden_is_found_among_many() -> None:
    weights = WEIGHTS.copy()
    weights[FOUND.hidden[777]] += 1e-3
    judged = liftmesh.verify(POINTS, FOUND.simplices, weights=weights)
    assert [(flaw.kind, flaw.count) for flaw in judged.flaws] == [("missing_vertices", 1)]
    assert judged.flaws[0].first[0].rows[-1] == FOUND.hidden[777]


PEAK = """
import numpy as np, liftmesh
def status(field):
    with open("/proc/self/status") as lines:
        return next(1024 * int(line.split()[1]) for line in lines if line.startswith(field))

rng = np.random.default_rng(1)
points, weights = rng.random((500_000, 2)), rng.random(500_000) * 7e-6
found = liftmesh.regular(points, weights=weights, threads=1)
assert 0.4 < len(found.hidden) / len(points) < 0.6
with open("/proc/self/clear_refs", "w") as peak:
    peak.write("5")
before = status("VmRSS")
assert liftmesh.verify(found, threads=1)
print((status("VmHWM") - before) / len(points))
"""


@pytest.mark.slow
def test_hidden_rows_take_little_memory() -> None:
    done = subprocess.run([sys.executable, "-c", PEAK], capture_output=True, text=True, check=True)
    # Bytes a row: 12 a triangle for its neighbours, and the index that locates rows.
    assert float(done.stdout) < 80
