"""Adaptive thinning, held against a copy in plain NumPy, and its picture."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from commands import liftmesh as run

import liftmesh
from liftmesh._typing import Floats
from liftmesh.paper.pictures import anisotropic


def loss(points: Floats, kept: list[int]) -> float:
    """Sum the squares of the vertical distances from the surface of some points."""
    surface = liftmesh.triangulate(points[kept])
    rows = surface.triangulation.find_simplex(points[:, :2])
    a, b, c = np.moveaxis(points[kept][surface.faces[rows]], 1, 0)
    normal = np.cross(b - a, c - a)
    return float(np.square(((points - a) * normal).sum(axis=1) / normal[:, 2]).sum())


def test_each_step_removes_the_row_that_costs_least() -> None:
    rng = np.random.default_rng(6)
    points = np.column_stack([rng.random((18, 2)) * 10, rng.random(18)])
    corners = {
        *liftmesh.scipy.Delaunay(points[:, :2], furthest_site=True).convex_hull.ravel().tolist()
    }
    kept = list(range(len(points)))
    for count in range(17, len(corners) + 1, -1):
        free = [row for row in kept if row not in corners]
        costs = [loss(points, [k for k in kept if k != row]) for row in free]
        kept.remove(free[int(np.argmin(costs))])
        found = liftmesh.thin(points, adaptive=count)
        np.testing.assert_array_equal(found.points, points[kept])
    with pytest.raises(liftmesh.InputError, match="corners, which stay"):
        liftmesh.thin(points, adaptive=3)


def test_rows_that_are_all_corners_of_the_hull_stay_or_are_refused() -> None:
    turns = np.arange(12) * np.pi / 6
    points = np.column_stack([np.rint(1000 * np.cos(turns)), np.rint(1000 * np.sin(turns)), turns])
    for count in (3, 11):
        with pytest.raises(liftmesh.InputError, match="hull alone has 12 corners"):
            liftmesh.thin(points, adaptive=count)
    for count in (12, 13, 10**400):
        assert len(liftmesh.thin(points, adaptive=count)) == 12


def test_the_order_of_rows_does_not_count() -> None:
    x, y = (each.ravel() for each in np.meshgrid(np.arange(12.0), np.arange(9.0)))
    points = np.column_stack([x, y, np.where(y > 4 + x / 5, 3, 0)])
    ways = points, points[::-1], np.random.default_rng(0).permutation(points)
    found = [liftmesh.thin(each, adaptive=20).points.tolist() for each in ways]
    assert {*map(tuple, found[0])} == {*map(tuple, found[1])} == {*map(tuple, found[2])}
    assert len(found[0]) == 20


def test_level_ground_keeps_rows_everywhere() -> None:
    x, y = (each.ravel() for each in np.meshgrid(np.arange(24.0), np.arange(24.0)))
    points = np.column_stack([x, y, np.full(len(x), 7.5)])
    found = liftmesh.thin(points, adaptive=80).points
    quarters = np.bincount((2 * (found[:, 0] > 11.5) + (found[:, 1] > 11.5)).astype(int))
    assert quarters.min() >= 10
    again = liftmesh.thin(np.random.default_rng(3).permutation(points), adaptive=80).points
    assert {*map(tuple, again.tolist())} == {*map(tuple, found.tolist())}


def test_triangles_along_an_edge_are_long_and_thin() -> None:
    points = anisotropic.thinned_image()
    surface = liftmesh.triangulate(points)
    a, b, c = np.moveaxis(points[surface.faces], 1, 0)
    sides = np.stack([np.hypot(*(p - q)[:, :2].T) for p, q in ((a, b), (b, c), (c, a))])
    u, v = (b - a)[:, :2], (c - a)[:, :2]
    area = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2
    crosses = np.ptp(points[surface.faces][:, :, 2], axis=1) > 0.25
    stretched = sides.max(axis=0) ** 2 / (2 * area)
    assert np.median(stretched[crosses]) > 5


def test_the_command_writes_the_rows_that_stay(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    liftmesh.write(tmp_path / "a.ply", rng.random((90, 3)))
    done = run("thin", "a.ply", "b.ply", "--adaptive", "30", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["thinning"] == {"n_rows": 90, "n_kept": 30, "adaptive": 30}
    assert len(liftmesh.read(tmp_path / "b.ply")) == 30
    assert (
        "b.ply: 12 rows"
        in run("thin", "a.ply", "b.ply", "--overwrite", "--random", "12", cwd=tmp_path).stdout
    )
    for words in ((), ("--adaptive", "2"), ("--adaptive", "30", "--cell", "1")):
        done = run("thin", "a.ply", "c.ply", *words, cwd=tmp_path)
        assert done.returncode != 0
        assert "--adaptive" in done.stderr
    assert not (tmp_path / "c.ply").exists()
