"""One tile in the format quantized-mesh-1.0: a header and a mesh of 16-bit numbers.

Positions are shares of the tile and of its range of heights, as whole numbers to 32767. Each is
stored as the difference from the one before, with the sign in the last bit. Vertices are in the
order in which faces use them first; a corner is stored as the difference from the number of
vertices that were used before it.

The header tells viewers what may be seen: a sphere around the vertices, and the point that is
behind the horizon when all of them are. The latter is on the way from the middle of the earth to
that of the sphere. In coordinates where the earth is a sphere of radius 1, a vertex at distance m
from the middle, off that way by an angle a, is hidden with it if it is at 1 / cos(a + acos(1 / m))
(K. Ring, "Computing the horizon occlusion point", 2013).

Source: github.com/CesiumGS/quantized-mesh.
"""

from __future__ import annotations

import struct
from typing import NamedTuple

import numpy as np

from liftmesh._typing import Array, Floats, Integers

STEPS = 32767
_HEADER = struct.Struct("<3d2f4d3d")
_AXES = np.array([6378137.0, 6378137.0, 6356752.3142451793])  # of WGS 84
_FARTHEST = 1e6  # of the point behind the horizon, for tiles that a horizon never hides
_WIDE = 1 << 16  # vertices that 16 bits number


class QuantizedTile(NamedTuple):
    """What a tile holds."""

    places: Integers  # (n, 3): u, v and height, from 0 to 32767
    faces: Integers  # (m, 3), counter-clockwise
    low: float  # the heights that 0 and 32767 stand for, in single precision
    high: float
    centre: Floats  # of the tile, geocentric
    positions: Floats  # (n, 3) of the vertices, geocentric


def encoded(tile: QuantizedTile) -> bytes:
    """Return the bytes of a tile."""
    _, first = np.unique(tile.faces.ravel(), return_index=True)
    order = tile.faces.ravel()[np.sort(first)]
    number = np.empty(len(tile.places), dtype=np.int64)
    number[order] = np.arange(len(order))
    places = tile.places[order]
    kind, width = ("<u2", 2) if len(places) <= _WIDE else ("<u4", 4)
    parts = [_header(tile), struct.pack("<I", len(places))]
    parts += [_zigzag(column).astype("<u2").tobytes() for column in places.T]
    parts.append(bytes(-sum(map(len, parts)) % width))
    corners = number.take(tile.faces, axis=0).ravel()
    parts += [struct.pack("<I", len(tile.faces)), _high_water(corners).astype(kind).tobytes()]
    for axis, at in ((0, 0), (1, 0), (0, STEPS), (1, STEPS)):  # west, south, east, north
        on = np.flatnonzero(places[:, axis] == at)
        on = on[np.argsort(places[on, 1 - axis])]
        parts += [struct.pack("<I", len(on)), on.astype(kind).tobytes()]
    return b"".join(parts)


def _zigzag(column: Integers) -> Array:
    steps = np.diff(column, prepend=0)
    return (steps << 1) ^ (steps >> 63)


def _high_water(corners: Integers) -> Array:
    """Count corners down from the vertices used before, the next new one being 0."""
    used = np.maximum.accumulate(np.concatenate([[-1], corners]))[:-1] + 1
    return used - corners


def _header(tile: QuantizedTile) -> bytes:
    low, high = tile.positions.min(axis=0), tile.positions.max(axis=0)
    middle = low / 2 + high / 2
    radius = float(np.linalg.norm(tile.positions - middle, axis=1).max())
    horizon = _horizon(tile.positions / _AXES, middle / _AXES)
    return _HEADER.pack(*tile.centre, tile.low, tile.high, *middle, radius, *horizon)


def _horizon(points: Floats, middle: Floats) -> Floats:
    """Return the point that is hidden when all points are, where the earth is a unit sphere."""
    ahead = middle / max(float(np.linalg.norm(middle)), 1e-9)
    away = np.linalg.norm(points, axis=1)
    angle = np.arccos(np.clip(points @ ahead / away, -1, 1)) + np.arccos(1 / np.maximum(away, 1))
    cosine = np.cos(np.minimum(angle, np.pi / 2)).min()
    point: Floats = ahead * min(1 / max(float(cosine), 1e-12), _FARTHEST)
    return point
