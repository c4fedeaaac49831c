"""What the comparison with triangle says of a mesh."""

from __future__ import annotations

import numpy as np
import pytest
from benchmark.tasks import refine as bench_refine

import liftmesh


def test_angles_and_lengths_of_a_mesh() -> None:
    points = np.array([[0.0, 0], [2, 0], [2, 2], [0, 2]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    assert bench_refine.smallest_angles(points, triangles) == pytest.approx([45, 45])
    assert bench_refine.areas(points, triangles).tolist() == [2, 2]
    shares = [bench_refine.near(points, triangles, lambda _, w=w: w) for w in (2.5, 1.2, 9)]
    assert shares == [1, 0.8, 0]  # the diagonal is more than twice as long as 1.2


def test_the_graded_mesh_has_about_as_many_triangles_as_asked() -> None:
    scale = bench_refine.unit_length(3000)
    mesh = liftmesh.refine(
        [bench_refine.SQUARE], size=lambda p: bench_refine.lengths(scale, p)
    ).triangulation
    assert 0.7 < mesh.nsimplex / 3000 < 1.4
    wanted = bench_refine.near(
        mesh.points, mesh.simplices, lambda p: bench_refine.lengths(scale, p)
    )
    assert wanted > 0.99
