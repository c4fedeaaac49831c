"""Faces of a tiled surface whose circles reach a box: what natural neighbours in it depend on.

The neighbours of a point come from the faces that have it inside their circles. These have the same
part of it in the triangulation of any of the points that holds their corners (ARCHITECTURE.md). So
the faces whose circles reach a box answer in it as the whole.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Floats, Rows
from liftmesh.tiles.windows import apart, mesh_of

if TYPE_CHECKING:
    from liftmesh.tiles.tiled_surface import TiledSurface
    from liftmesh.tiles.windows import Bounds

_CIRCLES = 1 << 15  # faces that have one box around their circles


class Circles:
    """Knows how far the circles of a surface reach: 32 bytes for each block of faces."""

    def __init__(self, tiled: TiledSurface) -> None:
        self._tiled = tiled
        self._shards = tiled.manifest["shards"]
        self._boxes = [_boxes(*self._read(shard)[1:]) for shard in self._shards]

    def near(self, box: Bounds) -> Iterator[tuple[Any, Rows]]:
        """Yield the faces whose circles may have a point of a box inside, shard by shard."""
        window = np.array([box])
        for shard, boxes in zip(self._shards, self._boxes, strict=True):
            meet = (boxes[:, :2] <= window[:, 2:]) & (boxes[:, 2:] >= window[:, :2])
            blocks = np.flatnonzero(meet.all(axis=1))
            if not len(blocks):
                continue
            vertices, points, faces = self._read(shard)
            held = [_reaching(points, faces[i * _CIRCLES : (i + 1) * _CIRCLES], window) for i in blocks]
            found = np.concatenate(held)
            if len(found):
                yield apart(vertices, found)

    def _read(self, shard: Mapping[str, Any]) -> tuple[Any, Floats, Rows]:
        """Return the vertices of a shard, where they are, and its faces."""
        vertices, faces = mesh_of(self._tiled, shard)
        return vertices, np.stack([vertices["x"], vertices["y"]], axis=1), faces


def _boxes(points: Floats, faces: Rows) -> Floats:
    begins = range(0, len(faces), _CIRCLES)
    return np.concatenate([_kernel.reach_of(points, faces[i : i + _CIRCLES]) for i in begins])


def _reaching(points: Floats, faces: Rows, window: Floats) -> Rows:
    found: Rows = faces[_kernel.find_reaching(points, faces, window)]
    return found
