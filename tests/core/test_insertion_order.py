"""The order in which a lower hull inserts points: not known beforehand, and not to be seen."""

from __future__ import annotations

import hashlib
import subprocess
import sys

import numpy as np
import pytest
from counted_calls import instructions
from numpy.typing import NDArray
from space_clouds import LARGER

import liftmesh
from liftmesh import _kernel

Points = NDArray[np.float64]

ROWS = 1500
PROCESS = """
import hashlib, sys
import numpy as np
from liftmesh.space import lower_hull as module
points = np.random.default_rng(11).integers(0, 60, (3000, 3)).astype(float)
hull = module.lower_hull(points)
arrays = hull.faces, hull.neighbors, hull.above
print(module._SECRET, hashlib.sha256(b"".join(a.tobytes() for a in arrays)).hexdigest())
"""


@pytest.mark.campaign
def test_points_made_for_a_known_order_are_as_quick_as_others() -> None:
    known, usual, unknown = instructions(
        *([name, ROWS] for name in ("known_order", "shuffled", "unknown_order"))
    )
    assert known > 10 * usual  # or else the points no longer aim at the order
    assert unknown < 5 * usual


def outcome(points: Points, secret: int) -> str:
    (status, _, _, *arrays), _ = _kernel.lower_hull(points, "auto", secret)
    assert status == "ok"
    return hashlib.sha256(b"".join(array.tobytes() for array in arrays)).hexdigest()


@pytest.mark.parametrize("family", LARGER)
def test_every_secret_gives_the_same_bytes(family: str) -> None:
    points = LARGER[family](1000, np.random.default_rng(7))
    assert len({outcome(points, secret) for secret in (0, 1, 2**33 + 5, 2**64 - 1)}) == 1


def test_every_process_has_a_secret_of_its_own_and_gives_the_same_bytes() -> None:
    lines = [
        subprocess.run(
            [sys.executable, "-c", PROCESS], capture_output=True, text=True, check=True, timeout=300
        ).stdout.split()
        for _ in range(3)
    ]
    secrets, sums = zip(*lines, strict=True)
    assert len(set(secrets)) == 3
    assert len(set(sums)) == 1


def test_facets_that_are_neighbours_are_close_in_the_list() -> None:
    hull = liftmesh.lower_hull(LARGER["bowl"](20_000, np.random.default_rng(7)))
    facet, side = np.nonzero(hull.neighbors >= 0)
    assert np.median(np.abs(hull.neighbors[facet, side] - facet)) < len(hull.faces) / 100
