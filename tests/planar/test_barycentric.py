"""Barycentric transforms: those of slivers are NaN, all others are accurate."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import scipy.spatial
from numpy.typing import NDArray

import liftmesh
from liftmesh.planar.triangulation import barycentric_transforms


def slivers(count: int) -> NDArray[np.float64]:
    """Draw triangles, one after the other, of every thinness, direction, scale and place."""
    rng = np.random.default_rng(131)
    flat = rng.normal(size=(count, 3, 2)) * np.exp2(rng.integers(-60, 1, (count, 1, 2)))
    turned = np.einsum("nij,nkj->nki", np.linalg.qr(rng.normal(size=(count, 2, 2)))[0], flat)
    scaled = turned * np.exp2(rng.integers(-30, 30, (count, 1, 1)))
    return scaled + rng.normal(size=(count, 1, 2)) * rng.choice([0, 1, 1e6], (count, 1, 1))


def test_transforms_of_slivers_are_none_where_scipys_are_none() -> None:
    corners = slivers(4000)
    names = np.arange(12_000, dtype=np.int32).reshape(-1, 3)
    theirs = scipy.spatial._qhull._get_barycentric_transforms(
        corners.reshape(-1, 2), names, np.finfo(float).eps
    )
    ours = barycentric_transforms(corners.reshape(-1, 2), names)
    missing, expected = np.isnan(ours).any(axis=(1, 2)), np.isnan(theirs).any(axis=(1, 2))
    assert 400 < expected.sum() < 3600
    assert not (expected & ~missing).any()
    assert (missing & ~expected).sum() < 0.01 * expected.sum()
    assert np.isnan(ours[missing]).all()


def test_transforms_that_are_given_are_accurate() -> None:
    corners = slivers(400)
    names = np.arange(1200, dtype=np.int32).reshape(-1, 3)
    ours = barycentric_transforms(corners.reshape(-1, 2), names)
    shown = np.flatnonzero(np.isfinite(ours).all(axis=(1, 2)))
    assert len(shown) > 50
    for name in shown:
        (ax, ay), (bx, by), (cx, cy) = (tuple(map(Fraction, p)) for p in corners[name].tolist())
        a, b, c, d = ax - cx, bx - cx, ay - cy, by - cy
        det = a * d - b * c
        exact = np.array([[d / det, -b / det], [-c / det, a / det]], dtype=float)
        assert np.abs(ours[name, :2] - exact).max() <= 1e-2 * np.abs(exact).max()


def test_a_sliver_of_a_triangulation_is_none() -> None:
    tri = liftmesh.delaunay([[-1, 0], [1, 0], [0, 1], [0, 2.0**-60]])
    thin = (tri.simplices != 2).all(axis=1)
    assert thin.sum() == 1
    assert np.isnan(tri.transform[thin]).all()
    assert np.isfinite(tri.transform[~thin]).all()
