"""The check of the bound of `simplify`, held against rational numbers."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from hypothesis.extra.numpy import arrays

import liftmesh
from liftmesh._typing import Floats
from liftmesh.terrain import simplification as module
from liftmesh.terrain.simplification import deviation

TRIANGLE = [[0, 0], [12, 0], [0, 12]]


def exact_distance(corners: list[list[float]], point: list[float]) -> Fraction:
    """Solve for the plane z = z_c + p (x - x_c) + q (y - y_c) by Cramer's rule."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = ([*map(Fraction, each)] for each in corners)
    x, y, z = map(Fraction, point)
    whole = (ax - cx) * (by - cy) - (bx - cx) * (ay - cy)
    p = ((az - cz) * (by - cy) - (bz - cz) * (ay - cy)) / whole
    q = ((ax - cx) * (bz - cz) - (bx - cx) * (az - cz)) / whole
    return abs(z - cz - p * (x - cx) - q * (y - cy))


def checked(points: Floats, heights: Floats, samples: Floats, bound: float) -> None:
    """Compare the check with rational numbers."""
    tri = liftmesh.delaunay(points)
    found = deviation(tri, heights, np.ascontiguousarray(samples[:, :2]), samples[:, 2], bound)
    corners = np.column_stack([tri.points, heights])[
        tri.simplices[tri.find_simplex(samples[:, :2])]
    ]
    exact = [exact_distance(*each) for each in zip(corners.tolist(), samples.tolist(), strict=True)]
    assert found.beyond == sum(each > Fraction(bound) for each in exact)
    assert math.isinf(found.largest) or Fraction(found.largest) >= max(exact)
    assert (found.largest <= bound) == (max(exact) <= Fraction(bound))


@settings(max_examples=60)
@given(
    st.integers(-40, 40),
    st.integers(-40, 40),
    arrays(np.int64, 3, elements=st.integers(-9, 9)),
    arrays(np.int64, (20, 3), elements=st.integers(0, 4)),
    st.integers(0, 24),
)
def test_lattices_of_every_step_are_compared_exactly(
    planar: int, vertical: int, corners: Floats, samples: Floats, bound: int
) -> None:
    """Heights are multiples of a twelfth of the planes': many are exactly at the bound."""
    scale, step = math.ldexp(1, planar), math.ldexp(1, vertical)
    points = np.array(TRIANGLE) * scale
    numbers = samples * (scale, scale, 4 * step)
    checked(points, corners * step, numbers, bound * step / 4)


@pytest.mark.parametrize("offset", [0.0, 505010.32, 2.0**40, 1e15])
@pytest.mark.parametrize("shift", [-1e-9, 0.0, 1e-12])
def test_samples_an_ulp_from_the_bound(offset: float, shift: float) -> None:
    rng = np.random.default_rng(3)
    x, y = (each.ravel() for each in np.meshgrid(np.arange(9.0), np.arange(9.0)))
    points = np.column_stack([x, y])[[0, 8, 72, 80, 40, 12, 30]] * 33.37 + offset
    heights = rng.integers(0, 50, len(points)).astype(float)
    planar = np.column_stack([x, y]) * 33.37 + offset
    tri = liftmesh.delaunay(points)
    corners = np.column_stack([tri.points, heights])[tri.simplices[tri.find_simplex(planar)]]
    at = [
        exact_distance(*each)
        for each in zip(corners.tolist(), [[*row, 0.0] for row in planar.tolist()], strict=True)
    ]
    z = np.array([float(each) for each in at]) + 0.25 + shift
    z = np.where(rng.random(len(z)) < 0.5, z, np.nextafter(z, -np.inf))
    checked(points, heights, np.column_stack([planar, z]), 0.25)


@pytest.mark.parametrize("size", [5e-324, 1e-300, 1.0, 1e150, 1e300])
def test_every_exponent(size: float) -> None:
    rng = np.random.default_rng(7)
    points = np.array(TRIANGLE) * size
    heights = rng.integers(-8, 9, 3) * size
    samples = np.column_stack([rng.integers(0, 5, (40, 2)), rng.integers(-8, 9, 40)]) * size
    for bound in (0.0, size, 3 * size):
        checked(points, heights, samples, bound)


def test_integers_decide_on_rasters_and_nothing_else() -> None:
    """Rational numbers are left for samples of other surfaces, whose corners are at once within."""
    corners = np.array([[[0, 0, 3], [9, 1, 7], [2, 8, 4]]]) * np.full((500, 1, 1), 33.0)
    rng = np.random.default_rng(5)
    raster = rng.integers(0, 300, (500, 3)) * 1.0
    exact = [exact_distance(*each) for each in zip(corners.tolist(), raster.tolist(), strict=True)]
    for bound in (0.0, 40.0, 100.25):
        expected = [each <= Fraction(bound) for each in exact]
        assert module._within(corners, raster, bound).tolist() == expected
    assert not module._within(corners + 0.1, raster, 1e9).any()
    assert module._is_corner(corners + 0.1, (corners + 0.1)[:, 1]).all()
    assert not module._is_corner(corners, raster).any()
