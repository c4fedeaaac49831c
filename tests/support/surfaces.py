"""Clouds with heights for the tests of surfaces, and the account that every surface must give."""

from __future__ import annotations

from fractions import Fraction

import hypothesis.strategies as st
import numpy as np
from clouds import FAMILIES
from meshes import hard_queries
from oracles.surfaces import ExactSurface

import liftmesh
from liftmesh.raster.pixels import Layout

POLICIES = ["first", "last", "lowest", "highest", "mean"]


def terrain(n=300, *, seed=1, offset=(4.5e5, 5.2e6, 100.0)):
    rng = np.random.default_rng(seed)
    return rng.random((n, 3)) * (500.0, 400.0, 30.0) + np.asarray(offset)


def hills(seed=1):
    """A jittered grid, 64 by 32, of dyadic coordinates, of which none is on the kerbs."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.arange(65.0), np.arange(33.0))
    planar = np.column_stack([x.ravel(), y.ravel()]) + rng.integers(-24, 25, (x.size, 2)) / 64
    points = np.column_stack([planar, rng.integers(0, 256, x.size) / 64])
    across = points[:, 1] - points[:, 0] / 4
    return points[(across != 8) & (across != 12)]


def plane_area(surface):
    corners = surface.triangulation.points[surface.faces]
    (ax, ay), (bx, by) = np.moveaxis(corners[:, 1:] - corners[:, :1], 0, -1)
    return float((ax * by - ay * bx).sum() / 2)


def layered(n=200, *, seed=2):
    """Few planar positions, few heights: duplicates, overhangs and single rows."""
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.integers(0, 9, (n, 2)), rng.integers(0, 4, n)]).astype(float)


def triangles_of(points, faces):
    """The triangles as a set of sorted coordinate triples."""
    return {tuple(sorted(map(tuple, points[face].tolist()))) for face in faces}


def planar_groups(points):
    groups = {}
    for row, (x, y, _) in enumerate(points.tolist()):
        groups.setdefault((x, y), []).append(row)
    return groups


def assert_accounted(surface):
    report = surface.report
    assert report.n_rows == len(surface.vertices)
    assert (
        report.n_rows == report.n_used + report.n_duplicates + report.n_overhangs + report.n_skipped
    )
    assert report.n_triangles == len(surface.faces)
    used = np.unique(surface.faces)
    assert len(used) == report.n_used
    assert np.array_equal(np.union1d(used, report.left_out), np.arange(report.n_rows))
    assert (np.diff(report.left_out) > 0).all()
    assert len(report.left_out) == len(report.representatives) == report.n_rows - report.n_used
    representatives = report.representatives[report.representatives >= 0]
    assert np.isin(representatives, used).all()
    assert report.n_skipped == np.count_nonzero(report.representatives < 0)


def distances(surface: liftmesh.Surface, points: np.ndarray) -> list[Fraction]:
    """Vertical distances in rational numbers; a point is in the triangle that its signs choose."""
    corners = surface.vertices[surface.faces]
    low, high = corners[..., :2].min(axis=1), corners[..., :2].max(axis=1)
    exact = [[[*map(Fraction, row)] for row in each] for each in corners.tolist()]

    def distance(p: np.ndarray) -> Fraction:
        near = np.flatnonzero(((low <= p[:2]) & (p[:2] <= high)).all(axis=1))
        place = [*map(Fraction, p.tolist())]
        return min((_above(exact[k], place) for k in near.tolist()), default=Fraction(10**30))

    return [*map(distance, points)]


def _above(triangle: list[list[Fraction]], p: list[Fraction]) -> Fraction:
    def turn(a: list[Fraction], b: list[Fraction], c: list[Fraction]) -> Fraction:
        return (a[0] - c[0]) * (b[1] - c[1]) - (a[1] - c[1]) * (b[0] - c[0])

    a, b, c = triangle
    parts = turn(b, c, p), turn(c, a, p), turn(a, b, p)
    if min(parts) < 0:
        return Fraction(10**30)
    height = sum(w * q[2] for w, q in zip(parts, triangle, strict=True)) / sum(parts)
    return abs(p[2] - height)


SMALL = st.integers(0, 5).map(float)
LATTICE = st.lists(st.tuples(SMALL, SMALL, st.integers(-9, 9).map(float)), min_size=3, max_size=18)


def exactly(surface: liftmesh.Surface) -> ExactSurface:
    heights = surface.frame.heights(surface.vertices)
    return ExactSurface(surface.triangulation.points, heights, surface.faces)


def with_heights(planar: np.ndarray, seed: int = 5) -> np.ndarray:
    heights = np.random.default_rng(seed).normal(size=len(planar)) * 100
    return np.column_stack([planar, heights])


def family_surface(family: str, n: int = 16) -> tuple[liftmesh.Surface, np.ndarray]:
    rng = np.random.default_rng(43)
    surface = liftmesh.triangulate(with_heights(FAMILIES[family](n, rng)), on_duplicate="lowest")
    return surface, hard_queries(surface.triangulation, rng)


def covering(surface: liftmesh.Surface, rows: int, columns: int, *, turned: bool) -> Layout:
    """Pixels that cover a surface and some of what is around it."""
    solved = surface.triangulation
    low, high = solved.min_bound, solved.max_bound
    span = np.maximum(high - low, np.abs(high) * 1e-6) * 1.2
    width, height = span[0] / columns, -span[1] / rows
    x, y = low[0] - span[0] / 12, high[1] + span[1] / 12
    tilt = (height * 0.3, width * 0.2) if turned else (0.0, 0.0)
    return Layout((width, tilt[0], x, tilt[1], height, y), rows, columns)


def raster(surface: liftmesh.Surface, layout: Layout, **options) -> liftmesh.Raster:
    shape = (layout.rows, layout.columns)
    return surface.raster(transform=layout.transform, shape=shape, **options)


LIMITS = st.floats(0.5, 6).filter(lambda each: abs(each * each - round(each * each)) > 1e-6)


def meadow(n: int = 400, seed: int = 1) -> np.ndarray:
    """Points with a pond in the middle and a bay at the side."""
    points = np.random.default_rng(seed).random((n, 3)) * (100, 100, 10)
    pond = np.hypot(*(points[:, :2] - 50).T) < 18
    bay = (np.abs(points[:, 1] - 50) < 14) & (points[:, 0] > 70)
    return points[~pond & ~bay]


def drawn(points) -> liftmesh.Surface | None:
    try:
        return liftmesh.triangulate(points, on_duplicate="highest")
    except liftmesh.DegenerateInputError:
        return None


def trimmed(surface: liftmesh.Surface, **options) -> liftmesh.Surface | None:
    try:
        return surface.trim(**options)
    except liftmesh.InputError:  # no face is left
        return None


def rotated(points: np.ndarray, degrees: float, offset: tuple[float, float, float]) -> np.ndarray:
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + offset
