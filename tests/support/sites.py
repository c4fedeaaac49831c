"""Families of disks and of weighted points, and what the members of the family are called by."""

from __future__ import annotations

from typing import Any

import numpy as np

import liftmesh
from liftmesh import ApolloniusGraph
from liftmesh._typing import Floats, Reals

Disks = np.ndarray


ON_A_CIRCLE = np.array(
    [(3, 4), (4, 3), (5, 0), (0, 5), (-3, 4), (-4, 3), (-5, 0), (0, -5), (3, -4), (-4, -3)]
)


def graph_of(disks: Disks) -> ApolloniusGraph:
    return liftmesh.apollonius(disks[:, :2], disks[:, 2])


def triangles(graph: ApolloniusGraph) -> set[tuple[int, ...]]:
    return {tuple(row) for row in graph.simplices.tolist()}


def on_lattice(rng: np.random.Generator, n: int) -> Disks:
    size, radius = rng.choice([2, 3, 5, 40]), rng.choice([1, 2, 6, 20])
    return np.c_[rng.integers(0, size, (n, 2)), rng.integers(0, radius, n)].astype(float)


def in_a_row(rng: np.random.Generator, n: int) -> Disks:
    return np.c_[rng.integers(0, 9, n), np.zeros(n), rng.integers(0, 3, n)].astype(float)


def anywhere(rng: np.random.Generator, n: int) -> Disks:
    return np.c_[rng.random((n, 2)), rng.random(n) * rng.choice([0.01, 0.3, 1])]


def touching_a_circle(rng: np.random.Generator, n: int) -> Disks:
    """Return disks that touch one circle of radius 5, some of them at the same point."""
    times = rng.integers(1, 6, n)
    centers = ON_A_CIRCLE[rng.integers(0, len(ON_A_CIRCLE), n)] * times[:, None]
    return np.c_[centers, 5.0 * times - 5]


def beside_a_large_one(rng: np.random.Generator, n: int) -> Disks:
    small = np.c_[rng.integers(-60, 60, (n - 1, 2)), rng.integers(0, 5, n - 1)]
    return np.vstack([[0, 0, rng.integers(10, 60)], small]).astype(float)


def between_two_large_ones(rng: np.random.Generator, n: int) -> Disks:
    """Return disks whose edges come in two pieces: which one another disk takes is to be told."""
    gap, radius = rng.integers(1, 4), rng.integers(5, 40)
    small = np.c_[rng.integers(-3, 4, n), rng.integers(-12, 13, n), rng.integers(0, 3, n) * 0.5]
    large = [[-radius - gap, 0, radius], [radius + gap, 0, radius]]
    return np.vstack([large, small[: max(n - 2, 1)]]).astype(float)


Sites = tuple[Reals, Reals]  # points and weights


Generator = np.random.Generator


SETS = 60


def integers(rng: Generator, n: int, top: int) -> Floats:
    return rng.integers(0, top, n).astype(float)


def uniform(rng: Generator, n: int) -> Sites:
    return rng.random((n, 2)), rng.random(n) * float(rng.choice([0.01, 0.1, 1]))


def lattice_of_equals(rng: Generator, n: int) -> Sites:
    return rng.integers(0, 4, (n, 2)).astype(float), np.full(n, 2.0)


def lattice(rng: Generator, n: int) -> Sites:
    return rng.integers(0, 5, (n, 2)).astype(float), integers(rng, n, rng.choice([2, 4, 9]))


def wide_lattice(rng: Generator, n: int) -> Sites:
    return rng.integers(0, 9, (n, 2)).astype(float), integers(rng, n, rng.choice([4, 9, 40]))


def line_and_point(rng: Generator, n: int) -> Sites:
    steps = rng.permutation(2 * n)[: n - 1]
    slope = rng.integers(-1, 2)
    line = np.c_[steps, slope * steps] if rng.random() < 0.7 else np.c_[0 * steps, steps]
    apart = rng.integers(-3, 12, (1, 2))
    return np.r_[line, apart].astype(float), integers(rng, n, rng.choice([2, 6, 30]))


def columns(rng: Generator, n: int) -> Sites:
    points = np.c_[rng.integers(0, 2, n) * 3, rng.integers(0, 8, n)]
    turned = points if rng.random() < 0.5 else points[:, ::-1].copy()
    return turned.astype(float), integers(rng, n, rng.choice([1, 3, 9]))


def circle(rng: Generator, n: int) -> Sites:
    steps = np.arange(-25, 26)
    x, y = (axis.ravel() for axis in np.meshgrid(steps, steps))
    on_circle = np.c_[x, y][x * x + y * y == 625]
    points = on_circle[rng.permutation(len(on_circle))[:n]].astype(float)
    return points, integers(rng, len(points), rng.choice([1, 2, 100]))


def under_a_few(rng: Generator, n: int) -> Sites:
    weights = integers(rng, n, 5)
    weights[rng.integers(0, n, 3)] += 1000
    return rng.integers(0, 20, (n, 2)).astype(float), weights


def hull_alone(rng: Generator, n: int) -> Sites:
    points, weights = rng.integers(1, 20, (n, 2)), rng.integers(-2000, -1500, n)
    corners = np.array([(0, 0), (21, 0), (0, 21), (21, 21)])[:n]
    points[:4], weights[:4] = corners, 0
    return points.astype(float), weights.astype(float)


def slivers(rng: Generator, n: int) -> Sites:
    return rng.random((n, 2)) * [1, 1e-9], rng.random(n) * float(rng.choice([1e-3, 1e-1]))


def far_away(rng: Generator, n: int) -> Sites:
    return 2.0**30 + rng.integers(0, 6, (n, 2)) / 8, rng.integers(0, 9, n) / 64


def nearly_on_a_circle(rng: Generator, n: int) -> Sites:
    angles = rng.random(n) * 7
    return np.c_[np.cos(angles), np.sin(angles)], rng.integers(0, 4, n) * 2.0**-53


def exponents(rng: Generator, n: int) -> Sites:
    return (
        rng.choice([-1.0, 1.0], (n, 2)) * 2.0 ** rng.integers(-1074, 1023, (n, 2)),
        2.0 ** rng.integers(-1074, 1023, n),
    )


def denormals(rng: Generator, n: int) -> Sites:
    return rng.integers(0, 9, (n, 2)) * 5e-324, integers(rng, n, 3) * 5e-324


def giants(rng: Generator, n: int) -> Sites:
    return rng.integers(-4, 4, (n, 2)) * 4e307, integers(rng, n, 3) * 8e307


def nearly_on_one_plane(rng: Generator, n: int) -> Sites:
    """Lifted: the weights take off the square, and a slope up to 1e15, and are rounded."""
    points = rng.random((n, 2)) + rng.choice([0, 0, 1, 1e3, 1e6, 2.0**40])
    x, y = points.T
    return points, x * x + y * y + 10.0 ** rng.integers(0, 16) * (x - 0.3 * y)


def nearly_on_a_line_and_one_heavy(rng: Generator, n: int) -> Sites:
    """Rounding alone bends the line, and the weight of the last point exceeds that by far."""
    points = rng.random((n, 1)) * rng.normal(size=2) + rng.choice([0, 0, 1])
    weights = np.zeros(n)
    points[-1], weights[-1] = 3 * rng.normal(size=2), 10.0 ** rng.integers(-2, 16)
    return points, weights


def cluster_and_far_point(rng: Generator, n: int) -> Sites:
    """Determinants in the cluster underflow, and the range is too wide to be scaled."""
    unit = 2.0 ** rng.integers(-272, -256)
    on_lattice = rng.random() < 0.5
    near = rng.integers(1, 30, (n, 2)).astype(float) if on_lattice else rng.random((n, 2))
    points = near * unit
    weights = [(points**2).sum(axis=1), integers(rng, n, 4) * unit * unit, np.zeros(n)]
    far = 2.0 ** rng.integers(90, 500)
    points[-1] = far, rng.choice([0, far])
    return points, np.r_[weights[rng.integers(3)][:-1], 0]


FAMILIES = [
    *(uniform, lattice_of_equals, lattice, wide_lattice, line_and_point, columns, circle),
    *(under_a_few, hull_alone, slivers, far_away, nearly_on_a_circle),
    *(exponents, denormals, giants),
    *(nearly_on_one_plane, nearly_on_a_line_and_one_heavy, cluster_and_far_point),
]


FORM = [[2.0, 0.5], [0.5, 1.25]]


MEMBERS = ["weights", "radii", "metric", "farthest"]


def options(values: Floats, member: str) -> dict[str, Any]:
    if member == "farthest":
        return {"furthest_site": True}
    return {member: FORM if member == "metric" else values}
