"""The same set of triangles as CGAL's, at forty thousand points and more.

CGAL breaks ties by the same rule and evaluates denormal numbers exactly too, so the very same
coordinates go to both programs. Triangles are compared as coordinate triples.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from clouds import FAMILIES
from meshes import assert_same_triangles, triangle_rows
from reference import cgal_triangles

import liftmesh

pytestmark = pytest.mark.slow

N = 40_000  # 200 squared: the lattices have exactly as many points
AT_SCALE = [
    "uniform",
    "gaussian",
    "kuzmin",
    "clusters",
    "lattice",
    "tenth-lattice",
    "utm-lattice",
    "tilted-lattice",
    "hexagonal",
    "circle",
    "line-singularity",
    "two-columns",
    "parabola",
    "spiral",
    "near-collinear",
    "ulp-lattice",
    "ulp-noise",
    "denormal",
    "denormal-lattice",
    "smallest-steps",
    "far-offset",
    "far-lattice",
    "collinear-runs",
    "small-integers",
    "huge",
    "tiny",
    "huge-lattice",
]


@pytest.mark.parametrize("family", AT_SCALE)
def test_same_triangles_as_cgal(family: str, tmp_path: Path) -> None:
    points = FAMILIES[family](N, np.random.default_rng(23))
    actual = triangle_rows(points, liftmesh.delaunay(points).simplices)
    assert_same_triangles(actual, cgal_triangles(points, tmp_path), family)


@pytest.mark.parametrize("shift", [(450_000.0, 5_200_000.0), (-1e8, 1e-3), (1e15, -1e15)])
@pytest.mark.parametrize("family", ["clusters", "hexagonal"])
def test_same_triangles_as_cgal_after_a_shift(
    family: str, shift: tuple[float, float], tmp_path: Path
) -> None:
    points = FAMILIES[family](N, np.random.default_rng(29)) + shift
    actual = triangle_rows(points, liftmesh.delaunay(points).simplices)
    assert_same_triangles(actual, cgal_triangles(points, tmp_path), f"{family} + {shift}")


@pytest.mark.campaign
def test_same_triangles_as_cgal_at_a_quarter_of_a_million(tmp_path: Path) -> None:
    points = FAMILIES["uniform"](250_000, np.random.default_rng(31))
    actual = triangle_rows(points, liftmesh.delaunay(points).simplices)
    assert_same_triangles(actual, cgal_triangles(points, tmp_path))


def test_denormals_are_their_scaled_copy_for_both_programs(tmp_path: Path) -> None:
    denormal = FAMILIES["denormal"](20_000, np.random.default_rng(37))
    scaled = denormal * 2.0**1000
    expected = cgal_triangles(scaled, tmp_path) * 2.0**-1000
    assert_same_triangles(cgal_triangles(denormal, tmp_path), expected, "CGAL")
    assert_same_triangles(
        triangle_rows(denormal, liftmesh.delaunay(denormal).simplices), expected, "liftmesh"
    )
