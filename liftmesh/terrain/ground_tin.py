"""Ground by progressive densification of a triangulation (TIN).

The lowest row of each cell of a grid is ground to begin with. Each round triangulates the ground
found so far, and of the rows over each facet takes the lowest that is near enough to the facet and
sees it under small angles from the facet's corners. So the surface grows up from below, and facets
become smaller, down to a spacing of 1 m; what then lies near the surface is ground, too. Beyond the
hull of the ground, its facets go on as they are up to slopes of 45 degrees, and level if steeper.

Axelsson also takes rows whose mirror image beyond the nearest corner is near enough. That finds the
edges of terraces (of 14 % of the ground that are lost, all but 2.5), and a fourth of all roofs,
trees and shrubs on steep slopes with them, where a larger angle takes a twelfth: it is left out.

Every choice is made by coordinates, so the order of the rows does not matter.

Source: P. Axelsson, DEM generation from laser scanner data using adaptive TIN models, International
Archives of Photogrammetry and Remote Sensing 33 (B4), 2000, 110-117.
"""

from __future__ import annotations

import math
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from liftmesh._typing import Array, Floats, Integers, Mask
from liftmesh.errors import DegenerateInputError
from liftmesh.planar.delaunay import delaunay
from liftmesh.terrain.frame import resolve_plane
from liftmesh.terrain.report import bare_report
from liftmesh.terrain.sampling import gradients_at, weights_at
from liftmesh.terrain.surface_data import SurfaceData

_FINEST = 1.0  # metres between rows that join
_MOST_ROUNDS = 100
_INWARDS = 1e-6  # of the way to the middle of the hull, where a facet is


class TinOptions(NamedTuple):
    """Side of cells, thresholds of rows that join, and of rows at the end; metres and degrees."""

    cell: float
    distance: float
    angle: float
    threshold: float


def tin_ground(points: Floats, options: TinOptions) -> Mask:
    """Tell which points, in metres, are ground."""
    ground, left = _began(points, options.cell), points
    if ground is None:
        return np.zeros(len(points), np.bool_)
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        for _ in range(_MOST_ROUNDS):
            seen = _Seen.of(ground, left)
            joins = seen.joining(left, options)
            if not len(joins):
                break
            ground = np.concatenate([ground, left[joins]])
            left = left[seen.is_apart]
        is_ground: Mask = np.abs(_Seen.of(ground, points).above) <= options.threshold
    return is_ground


def _began(points: Floats, cell: float) -> Floats | None:
    """Take the lowest points of cells, which are halved until these are not on a line."""
    while len(points):
        ground = points[_seeds(points, cell)]
        with suppress(DegenerateInputError):
            delaunay(ground[:, :2])
            return ground
        if cell < _FINEST:
            break
        cell /= 2
    return None


def _slopes_within(surface: SurfaceData, places: Floats) -> Floats:
    """Return the slopes of the facets at places of the hull; of steep ones, none."""
    corners = surface.triangulation.points[surface.triangulation.convex_hull]
    middle = np.array([math.fsum(each) for each in corners.T]) / len(corners)
    slopes = gradients_at(surface, places + (middle - places) * _INWARDS)
    slopes[~((slopes**2).sum(axis=1) <= 1)] = 0  # NaN, too
    return slopes


def _surface(ground: Floats) -> SurfaceData:
    solved = delaunay(ground[:, :2])
    faces = solved.simplices
    report = bare_report(len(ground), len(faces))
    return SurfaceData(ground, faces, solved, resolve_plane("xy", ground), report)


def _seeds(points: Floats, cell: float) -> Integers:
    """Choose the lowest point of each cell, of several the lexicographically least."""
    x, y, z = points.T
    across, down = (np.floor((each - each.min()) / cell) for each in (x, y))
    return _firsts((across, down), (z, x, y))


def _firsts(keys: tuple[Array, ...], order: tuple[Array, ...]) -> Integers:
    """Return the first row in an order of each group of rows with the same keys."""
    rows = np.lexsort((*reversed(order), *reversed(keys)))
    is_first = np.zeros(len(rows), np.bool_)
    is_first[:1] = True
    for each in keys:
        is_first[1:] |= np.diff(each[rows]) != 0
    return rows[is_first]


class _Seen(NamedTuple):
    """What points see of the ground: how high they are above it, and the corners of their facet."""

    above: Floats
    distance: Floats  # from the facet
    corners: tuple[Floats, Floats, Floats]  # vectors to the corners of the facet
    facet: tuple[Integers, Integers]

    @classmethod
    def of(cls, ground: Floats, points: Floats) -> _Seen:
        surface = _surface(ground)
        places = points[:, :2]
        weights = weights_at(surface, places, extrapolate="hull")
        slopes, beyond = gradients_at(surface, places), np.zeros(len(points))
        outside = np.flatnonzero(np.isnan(slopes[:, 0]))
        nearest = np.stack([(weights @ each)[outside] for each in ground.T[:2]], axis=1)
        slopes[outside] = _slopes_within(surface, nearest)
        beyond[outside] = (slopes[outside] * (places[outside] - nearest)).sum(axis=1)
        above = points[:, 2] - weights @ ground[:, 2] - beyond
        distance = np.abs(above) / np.sqrt(1 + (slopes**2).sum(axis=1))
        last = weights.indptr[1:] - 1
        rows = [weights.indices[np.minimum(weights.indptr[:-1] + k, last)] for k in range(3)]
        within = surface.triangulation.find_simplex(places)
        is_inside = np.diff(weights.indptr) == 3
        low, high = np.minimum(rows[0], rows[1]), np.maximum(rows[0], rows[1])
        facet = np.where(is_inside, -1, low), np.where(is_inside, within, high)
        first, second, third = (ground[each] - points for each in rows)
        return cls(above, distance, (first, second, third), facet)

    @property
    def is_apart(self) -> Mask:
        """Whether points are so far from all corners that they may join."""
        apart: Mask = np.min([np.hypot(*each[:, :2].T) for each in self.corners], axis=0) >= _FINEST
        return apart

    def joining(self, points: Floats, options: TinOptions) -> Integers:
        """Choose the lowest point over each facet of those within the thresholds."""
        fits = self.is_apart & (self.distance <= options.distance)
        steepest = np.sin(np.radians(options.angle))
        for each in self.corners:
            fits &= self.distance <= steepest * np.sqrt((each**2).sum(axis=1))
        rows = np.flatnonzero(fits)
        x, y, _ = points[rows].T
        return rows[_firsts(tuple(each[rows] for each in self.facet), (self.above[rows], x, y))]
