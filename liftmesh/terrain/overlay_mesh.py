"""Surfaces over the overlay of two triangulations, which the kernel computes.

`_core/surface/overlay_mesh.hpp` triangulates what faces of both have in common. What is missing in
the convex hull, as beyond borders that rounding has bent, follows from the rim alone: all sides of
it are constraints, so nothing sees across them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Integers, Mask, Progress, Rows
from liftmesh.base.arrays import pair_keys, pairs_of_keys
from liftmesh.base.options import as_threads
from liftmesh.errors import CrossingError
from liftmesh.planar.constrained import constrained_delaunay
from liftmesh.planar.constrained_triangulation import (
    Bits,
    ConstrainedTriangulation,
    Pieces,
    bits_of,
)
from liftmesh.terrain.measures import touching
from liftmesh.terrain.surface_data import SurfaceData, kernel_surface

_TAILS, _HEADS = [1, 2, 0], [2, 0, 1]  # of the sides opposite the corners
_FILLER = 8  # above the bits of sides


class OverlayMesh(NamedTuple):
    """The part that both surfaces have, with rows by x, then y."""

    points: Floats
    rises: Floats  # of the first surface over the second
    faces: Rows
    triangulation: ConstrainedTriangulation | None  # of which they are; None if it needs none
    mask: Mask | None  # of triangles beyond the rim
    crossings: int  # rows that are neither's
    displacement: float


def overlay_mesh(
    surface: SurfaceData,
    other: SurfaceData,
    threads: int | None,
    progress: Progress | None,
) -> OverlayMesh | None:
    """Lay two surfaces over each other; None if they have nothing in common, or are too near.

    Rounded crossings may come together, or cross what is near.
    """
    pair = touching(surface.triangulation, other.triangulation)
    if pair is None:
        return None
    limit = as_threads(threads, len(surface.faces) + len(other.faces))
    found = kernel_surface(surface).overlay(kernel_surface(other), *pair, *limit, progress)
    if found is None or not len(found[2]):
        return None
    points, rises, simplices, neighbors, bits, crossings, displacement = found
    rim, count = _Rim.of(simplices, neighbors), len(simplices)
    if not (bits != rim.bits(count)).any():
        return OverlayMesh(points, rises, simplices, None, None, crossings, displacement)
    if (filler := _Filler.of(points, rim)) is None:
        return None
    if len(filler.simplices):
        simplices, neighbors, bits = filler.join(simplices, neighbors, bits, rim)
    simplices, neighbors, bits = _kernel.canonical_order(
        None, simplices, neighbors, bits, len(points), *limit
    )
    mask = bits >= _FILLER if len(simplices) > count else None
    bits = bits & np.uint8(_FILLER - 1)
    solved = ConstrainedTriangulation(
        points,
        simplices,
        neighbors,
        filler.hull,
        np.empty((0, 2), dtype=np.int32),
        np.empty(0, dtype=np.int32),
        bits,
        _pieces(simplices, neighbors, bits),
        len(simplices),
    )
    faces = simplices if mask is None else simplices[~mask]
    return OverlayMesh(points, rises, faces, solved, mask, crossings, displacement)


def _pieces(simplices: Rows, neighbors: Rows, bits: Bits) -> Pieces:
    """Return the sides that are constraints, each of which is an input edge."""
    keys = []
    for k in range(3):
        chosen = np.flatnonzero(bits >> k & 1)
        tails, heads = simplices[chosen, _TAILS[k]], simplices[chosen, _HEADS[k]]
        once = (tails < heads) | (neighbors[chosen, k] < 0)  # the triangle beyond has it as well
        lesser, greater = np.minimum(tails, heads), np.maximum(tails, heads)
        keys.append(pair_keys(lesser[once], greater[once]))
    ends = pairs_of_keys(np.sort(np.concatenate(keys)))
    rows = np.stack(ends, axis=1).astype(np.int32)
    numbers = np.arange(len(rows) + 1, dtype=np.int32)
    none = np.full(len(rows), -1, dtype=np.int32)
    return Pieces(rows, numbers, numbers[:-1], rows, none, none, numbers[:0], 0, 0, 0.0)


class _Rim(NamedTuple):
    """The sides of triangles beyond which there are none, seen from these."""

    triangles: Integers
    opposite: Integers  # their corners opposite
    ends: Rows  # (r, 2)

    @classmethod
    def of(cls, simplices: Rows, neighbors: Rows) -> _Rim:
        """Find it."""
        triangles, opposite = np.divmod(np.flatnonzero(neighbors.ravel() < 0), 3)
        following = np.stack([opposite + 1, opposite + 2], axis=1) % 3
        return cls(triangles, opposite, simplices[triangles[:, None], following])

    def bits(self, count: int) -> Bits:
        """Return these sides of so many triangles."""
        bits = np.zeros(count, dtype=np.uint8)
        np.bitwise_or.at(bits, self.triangles, (1 << self.opposite).astype(np.uint8))
        return bits


class _Filler(NamedTuple):
    """Triangles beyond a rim, in the convex hull."""

    simplices: Rows
    neighbors: Rows  # among them; -1 for others
    inner: Integers  # the side of the rim that each of their sides is, (f, 3); -1 for none
    hull: Rows

    @classmethod
    def of(cls, points: Floats, rim: _Rim) -> _Filler | None:
        """Triangulate; None if sides of the rim meet."""
        rows, ends = np.unique(rim.ends, return_inverse=True)
        ends = ends.reshape(-1, 2).astype(np.int32)
        try:
            solved = constrained_delaunay(points[rows], ends)
        except CrossingError:
            return None
        tails, heads = solved.simplices[:, _TAILS], solved.simplices[:, _HEADS]
        within, beyond = _places(ends, tails, heads), _places(ends, heads, tails)
        regions = solved.regions
        is_beyond = np.zeros(int(regions.max()) + 1, dtype=np.bool_)
        is_beyond[regions[(beyond >= 0).any(axis=1)]] = True
        folds = is_beyond[regions[(within >= 0).any(axis=1)]].any()
        if folds or np.count_nonzero(within >= 0) != len(ends):
            return None
        chosen = np.flatnonzero(is_beyond[regions])
        names = np.full(solved.nsimplex + 1, -1, dtype=np.int32)
        names[chosen] = np.arange(len(chosen), dtype=np.int32)
        neighbors = names[solved.neighbors[chosen]]
        neighbors[beyond[chosen] >= 0] = -1
        simplices = rows.take(solved.simplices[chosen], axis=0)
        return cls(simplices, neighbors, beyond[chosen], rows[solved.convex_hull])

    def join(
        self, simplices: Rows, neighbors: Rows, bits: Bits, rim: _Rim
    ) -> tuple[Rows, Rows, Bits]:
        """Put these triangles after those that have the rim, and flag them."""
        count = np.int32(len(simplices))
        triangle, k = np.nonzero(self.inner >= 0)
        side = self.inner[triangle, k]
        own = np.where(self.neighbors < 0, self.neighbors, self.neighbors + count)
        own[triangle, k] = rim.triangles[side]
        neighbors = np.concatenate([neighbors, own])
        neighbors[rim.triangles[side], rim.opposite[side]] = count + triangle
        return (
            np.concatenate([simplices, self.simplices]),
            neighbors,
            np.concatenate([bits, bits_of(self.inner >= 0) | np.uint8(_FILLER)]),
        )


def _places(ends: Array, tails: Array, heads: Array) -> Integers:
    """Return which of some directed sides others are; -1 for none."""
    known, sought = pair_keys(*ends.T), pair_keys(tails, heads)
    order = np.argsort(known)
    place = np.minimum(np.searchsorted(known, sought, sorter=order), len(known) - 1)
    return np.where(known[order[place]] == sought, order[place], -1)
