"""Clouds with heights for the tests of surfaces, and the account that every surface must give."""

from __future__ import annotations

import numpy as np

POLICIES = ["first", "last", "lowest", "highest", "mean"]


def terrain(n=300, *, seed=1, offset=(4.5e5, 5.2e6, 100.0)):
    rng = np.random.default_rng(seed)
    return rng.random((n, 3)) * (500.0, 400.0, 30.0) + np.asarray(offset)


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
    assert report.rows == len(surface.vertices)
    assert report.rows == report.used + report.duplicates + report.overhangs + report.skipped
    assert report.triangles == len(surface.faces)
    used = np.unique(surface.faces)
    assert len(used) == report.used
    assert np.array_equal(np.union1d(used, report.left_out), np.arange(report.rows))
    assert (np.diff(report.left_out) > 0).all()
    assert len(report.left_out) == len(report.representatives) == report.rows - report.used
    representatives = report.representatives[report.representatives >= 0]
    assert np.isin(representatives, used).all()
    assert report.skipped == np.count_nonzero(report.representatives < 0)
