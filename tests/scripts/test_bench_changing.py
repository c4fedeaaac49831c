"""The script that times points that come and go."""

from __future__ import annotations

import numpy as np
from benchmark.tasks.changing import IN_ORDER, changes

import liftmesh


def test_what_is_timed_is_what_is_said() -> None:
    points = np.random.default_rng(5).random((20 * IN_ORDER, 2))
    counts, seconds = changes(points, 2 * IN_ORDER)
    whole, rest = (len(liftmesh.delaunay(points[first:]).simplices) for first in (0, 2 * IN_ORDER))
    assert counts == [whole, whole, rest]
    assert sorted(seconds) == ["alone", "range", "removal"]
