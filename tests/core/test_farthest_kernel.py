"""Farthest-point triangulations of the kernel, held against an oracle on exact integers."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from regular_oracle import Site, regular
from sites import FAMILIES, SETS, exponents, giants

from liftmesh import _kernel
from liftmesh._typing import Floats, Reals, Rows

Generator = np.random.Generator


def run(points: Reals, threads: int = 1) -> tuple[str, Rows, Rows, Rows, Rows, Rows]:
    """Status, triangles, neighbours, hull, duplicates and hidden rows."""
    outcome, hidden = _kernel.farthest(points, False, threads, False, None)
    status, _, _, simplices, neighbors, hull, duplicates, _ = outcome
    return status, simplices, neighbors, hull, duplicates, hidden


def lowered(points: Floats) -> list[Site]:
    """Lift to -|p|^2, whose lower hull is the mirror image of the upper hull of |p|^2."""
    rows = [(Fraction(x), Fraction(y)) for x, y in points.tolist()]
    return [(x, y, -x * x - y * y) for x, y in rows]


def on_circle(rng: Generator, n: int) -> Floats:
    angles = rng.random(n) * 7
    return np.c_[np.cos(angles), np.sin(angles)]


def on_parabola(rng: Generator, n: int) -> Floats:
    x = rng.permutation(40)[:n].astype(float)
    return np.c_[x, x * x]


def on_flat_ellipse(rng: Generator, n: int) -> Floats:
    return on_circle(rng, n) * [1e-3, 1] + rng.integers(0, 3)


CONVEX = [on_circle, on_parabola, on_flat_ellipse]


@pytest.mark.parametrize("family", [*FAMILIES, *CONVEX])
def test_small_sets_are_the_oracles(family: Callable[..., tuple[Floats, Floats] | Floats]) -> None:
    for number in range(4 if family in (exponents, giants) else SETS // 2):
        rng = np.random.default_rng([29, number])
        made = family(rng, int(rng.integers(3, 13)))
        points = made[0] if isinstance(made, tuple) else made
        expected, left_out = regular(lowered(points))
        status, simplices, _, hull, duplicates, hidden = run(points)
        assert (status == "ok") == bool(expected), number
        if not expected:
            continue
        assert {frozenset(t) for t in simplices.tolist()} == expected, number
        assert len(simplices) == len(expected), number
        assert {*hidden.tolist(), *duplicates[:, 0].tolist()} == left_out, number
        assert {*hull.tolist()} == {*simplices.ravel().tolist()}, number


def lattice_polygon(radius: int) -> Floats:
    """The corners of the hull of the lattice points in a disc, and all of these points."""
    steps = np.arange(-radius, radius + 1)
    x, y = (axis.ravel() for axis in np.meshgrid(steps, steps))
    return np.c_[x, y][x * x + y * y <= radius * radius].astype(float)


def test_every_point_lies_in_every_circle() -> None:
    points = np.random.default_rng(30).permutation(lattice_polygon(400)) * [1, 3]
    _, simplices, _, hull, _, hidden = run(points)
    assert len(hull) == len(simplices) + 2 > 150
    assert len(hull) + len(hidden) == len(points)
    a, b, c = (points[corner][:, None] for corner in simplices.T)
    d = points[hull][None]
    lifted = [(u[..., 0], u[..., 1], (u * u).sum(axis=2)) for u in (a - d, b - d, c - d)]
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = lifted  # integers, and the products are below 2^53
    inside = az * (bx * cy - by * cx) + bz * (cx * ay - cy * ax) + cz * (ax * by - ay * bx)
    assert (inside >= 0).all()
    assert np.abs(inside).max() < 2.0**53


def test_points_of_one_circle_have_delaunays_triangles() -> None:
    rng = np.random.default_rng(31)
    steps = np.arange(-325, 326)
    x, y = (axis.ravel() for axis in np.meshgrid(steps, steps))
    points = rng.permutation(np.c_[x, y][x * x + y * y == 325**2].astype(float))
    assert len(points) > 50
    plain = _kernel.delaunay(points, False, 1, False, None)
    assert {*map(frozenset, run(points)[1].tolist())} == {*map(frozenset, plain[3].tolist())}


@pytest.mark.parametrize("family", ["disc", "square", "circle"])
def test_rows_in_any_order_and_threads(family: str) -> None:
    rng = np.random.default_rng(32)
    points = {
        "disc": on_circle(rng, 300_000) * np.sqrt(rng.random((300_000, 1))),
        "square": rng.integers(0, 2**20, (300_000, 2)) / 2.0**20,
        "circle": on_circle(rng, 150_000),
    }[family]
    once = run(points)
    for threads in (2, 5):
        for expected, found in zip(once[1:], run(points, threads)[1:], strict=True):
            np.testing.assert_array_equal(expected, found)
    order = rng.permutation(len(points))
    again = run(points[order])
    np.testing.assert_array_equal(as_sets(once[1]), as_sets(order[again[1]]))


def as_sets(triangles: Rows) -> Rows:
    return np.unique(np.sort(triangles, axis=1), axis=0)


def test_rows_at_corners_are_duplicates_and_others_hidden() -> None:
    points = np.array([(4, 4), (0, 0), (4, 0), (0, 0), (2, 2), (2, 2), (4, 0), (2, 0), (-0.0, 4)])
    _, simplices, _, hull, duplicates, hidden = run(points)
    assert {frozenset(t) for t in simplices.tolist()} == {
        frozenset({1, 2, 8}),
        frozenset({0, 2, 8}),
    }
    assert hull.tolist() == [1, 2, 0, 8]
    assert duplicates.tolist() == [[3, 1], [6, 2]]
    assert hidden.tolist() == [4, 5, 7]


@pytest.mark.parametrize("line", [[(0, 0), (1, 3), (2, 6)], [(1, 1)] * 9, [(0, 1), (1, 0)], []])
def test_no_triangle_without_three_corners(line: list[tuple[float, float]]) -> None:
    points = np.array(line, dtype=float).reshape(-1, 2)
    plain = _kernel.delaunay(points, False, 1, False, None)
    outcome, _ = _kernel.farthest(points, False, 1, False, None)
    assert outcome[0] == plain[0]
    assert outcome[2] == plain[2]
    assert len(outcome[3]) == 0


def test_rows_that_are_not_finite() -> None:
    points = np.random.default_rng(33).random((70_000, 2))
    points[[69_000, 12, 40_000]] = (np.inf, 0.5), (0.5, np.nan), (-np.inf, np.nan)
    outcome, _ = _kernel.farthest(points, False, 2, False, None)
    assert outcome[:2] == ("non-finite", 12)
    outcome, hidden = _kernel.farthest(points, True, 2, False, None)
    assert outcome[7].tolist() == [12, 40_000, 69_000]
    assert len(outcome[5]) + len(hidden) == 70_000 - 3
