"""Volumes between two surfaces in rationals, and pairs of grids as two epochs have them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.random import Generator
from oracles.surfaces import ExactSurface, Point, turn

if TYPE_CHECKING:
    import liftmesh

TURNS = ((1, 0), (1, 2), (3, 4), (2, 1), (1, 1), (1, 3), (math.cos(0.3), math.sin(0.3)))
KINDS = ("shifted", "shifted by halves", "beside", "at a corner", "turned otherwise", "flat")


class Exact(NamedTuple):
    """What is between two surfaces; and the largest distance, where both have faces."""

    cut: Fraction
    fill: Fraction
    area: Fraction
    largest: Fraction


def exact_earthwork(first: liftmesh.Surface, second: liftmesh.Surface) -> Exact:
    """Each face of one clipped by each of the other."""
    one, two = exactly(first), exactly(second)
    cut, fill, area, largest = (Fraction(0) for _ in range(4))
    for number, other in overlapping(first, second):
        polygon = [one.points[row] for row in one.faces[number]]
        cutter = [two.points[row] for row in two.faces[other]]
        for k in range(3):
            polygon = list(kept(polygon, cutter[k - 1], cutter[k]))
        rise = [(p, two.height_in(other, p) - one.height_in(number, p)) for p in polygon]
        common = sum(turn(*(point for point, _ in fan)) / 2 for fan in fans(rise))
        if common == 0:
            continue
        area += common
        largest = max(largest, *(abs(height) for _, height in rise))
        fill += sum(under_roof(list(clipped(fan, 1))) for fan in fans(rise))
        cut -= sum(under_roof(list(clipped(fan, -1))) for fan in fans(rise))
    return Exact(cut, fill, area, largest)


def exactly(surface: liftmesh.Surface) -> ExactSurface:
    heights = surface.frame.heights(surface.vertices)
    return ExactSurface(surface.triangulation.points, heights, surface.faces)


def overlapping(first: liftmesh.Surface, second: liftmesh.Surface) -> Iterator[tuple[int, int]]:
    """Faces whose boxes touch."""
    one, two = (each.triangulation.points[each.faces] for each in (first, second))
    low, high = two.min(axis=1), two.max(axis=1)
    for number, corners in enumerate(one):
        touches = (low <= corners.max(axis=0)) & (high >= corners.min(axis=0))
        for other in np.flatnonzero(touches.all(axis=1)).tolist():
            yield number, other


def kept(polygon: list[Point], tail: Point, head: Point) -> Iterator[Point]:
    """Keep what is to the left of a line."""
    for k, q in enumerate(polygon):
        p = polygon[k - 1]
        at_p, at_q = turn(tail, head, p), turn(tail, head, q)
        if at_p * at_q < 0:
            share = at_p / (at_p - at_q)
            yield p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])
        if at_q >= 0:
            yield q


def clipped(corners, sign: int):
    """Keep what is on one side of zero, by Sutherland and Hodgman."""
    for k, (point, height) in enumerate(corners):
        before, other = corners[k - 1]
        if height * other < 0:
            share = other / (other - height)
            yield (
                tuple(p + share * (q - p) for p, q in zip(before, point, strict=True)),
                Fraction(0),
            )
        if height * sign >= 0:
            yield point, height


def fans(polygon: list) -> Iterator[list]:
    for k in range(1, len(polygon) - 1):
        yield [polygon[0], polygon[k], polygon[k + 1]]


def under_roof(polygon) -> Fraction:
    """The volume of the prism under a convex polygon, triangle by triangle."""
    total = Fraction(0)
    for (a, za), (b, zb), (c, zc) in fans(polygon):
        total += turn(a, b, c) / 2 * (za + zb + zc) / 3
    return total


def error(found: liftmesh.CutFillResult, exact: Exact) -> float:
    """The largest relative error: of volumes, to the area times the largest distance."""
    errors = [abs(Fraction(found.area) - exact.area) / exact.area]
    for value, true in ((found.cut, exact.cut), (found.fill, exact.fill)):
        wrong = abs(Fraction(value) - true)
        errors.append(wrong / (exact.area * exact.largest) if wrong else wrong)
    return float(max(errors))


def grid_pair(rng: Generator) -> Iterable[np.ndarray]:
    """Two grids of one lattice: shifted, turned, rounded, and moved together."""
    step, count = rng.choice([0.1, 0.3, 0.7, 1 / 3, 1, 10]), rng.integers(2, 5)
    kind, turned = KINDS[rng.integers(len(KINDS))], TURNS[rng.integers(len(TURNS))]
    offset, is_diamond = rng.choice([0, 0, 0, 1.4, 4.5e5]), rng.random() < 0.3
    apart, slope = 10.0 ** rng.integers(-9, 1), rng.normal(size=2) * 10.0 ** rng.integers(-3, 3)
    shape, offset = (10.0 ** -rng.choice([3, 8, 15]), 0) if kind == "flat" else (1, offset)
    for number in range(2):
        grid = np.mgrid[:count, :count].reshape(2, -1).T * step
        grid = np.vstack([grid, grid + step / 2]) if is_diamond else grid
        grid = grid + number * shift(kind, step, count, rng)
        c, s = turned[::-1] if number and kind == "turned otherwise" else turned
        planar = grid @ np.array([[c, s], [-s, c]])
        if rng.random() < 0.5:
            planar = np.round(planar, rng.choice([1, 2, 3, 6, 15]))
        heights = grid @ slope + (number + rng.normal(size=len(grid)) * rng.integers(2)) * apart
        yield np.column_stack([planar * (1, shape) + offset, heights])


def shift(kind: str, step: float, count: int, rng: Generator) -> np.ndarray:
    if kind == "shifted by halves":
        return rng.integers(-count, count + 1, 2) * step / 2
    side = (count - 1) * step
    if kind == "beside":
        return np.array([side, 0])
    if kind == "at a corner":
        return np.full(2, side * rng.choice([1, 1 - 1e-9, 1 - 1e-15]))
    return rng.uniform(-0.05, 0.05, 2) * step
