"""What the comparison with triangle says of a mesh."""

from __future__ import annotations

import numpy as np
import pytest
from benchmark.tasks import refine as bench_refine
from gmsh_apart import apart


def test_angles_and_lengths_of_a_mesh() -> None:
    points = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    assert bench_refine.smallest_angles(points, triangles) == pytest.approx([45, 45])
    assert bench_refine.areas(points, triangles).tolist() == [2, 2]
    shares = [bench_refine.near(points, triangles, lambda _, w=w: w) for w in (2.5, 1.2, 9)]
    assert shares == [1, 0.8, 0]  # the diagonal is more than twice as long as 1.2


@pytest.mark.parametrize("name", ["liftmesh", "Gmsh"])
@pytest.mark.parametrize("spread", bench_refine.SPREADS.values())
def test_squares_have_about_as_many_triangles_as_asked(name: str, spread: float) -> None:
    scale = bench_refine.unit_length(3000, spread)
    points, triangles = apart(bench_refine.MESHERS[name], scale, spread)
    assert 0.5 < len(triangles) / 3000 < 1.5
    assert bench_refine.areas(points, triangles).sum() == pytest.approx(1)
    share = bench_refine.near(points, triangles, lambda p: bench_refine.lengths(scale, spread, p))
    assert share > 0.98
