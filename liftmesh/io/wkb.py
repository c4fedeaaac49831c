"""Geometries of well-known binary (WKB), of which x and y are read, as objects of GeoJSON.

Counts are compared with the bytes that are there, and collections may be nested only so deep.
"""

from __future__ import annotations

import struct
from typing import Any, TypeAlias

import numpy as np

from liftmesh.choices import shown

Geometry: TypeAlias = dict[str, Any]

_POINT, _LINE, _POLYGON, _COLLECTION = 1, 2, 3, 7
_KINDS = ("Point", "LineString", "Polygon", "MultiPoint", "MultiLineString", "MultiPolygon")
_DEEPEST = 32  # collections in collections
_Z, _M, _SRID = 0x80000000, 0x40000000, 0x20000000  # marks of another dialect (EWKB)


def geometry_of(data: bytes, begin: int = 0) -> Geometry:
    """Convert a geometry."""
    return _Reader(data, begin).geometry()


class _Reader:
    """A place in the bytes that moves as they are read."""

    def __init__(self, data: bytes, place: int) -> None:
        self._data, self._place = data, place

    def geometry(self, depth: int = 0) -> Geometry:
        """Read a geometry."""
        order, kind, width = self._head()
        if kind == _COLLECTION and depth < _DEEPEST:
            parts = [self.geometry(depth + 1) for _ in range(self._count(order))]
            return {"type": "GeometryCollection", "geometries": parts}
        if not _POINT <= kind <= len(_KINDS):
            raise ValueError(f"type {shown(kind)} of geometries is a curve, a surface or unknown")
        if kind > _POLYGON:
            several = [self._part(kind - _POLYGON) for _ in range(self._count(order))]
            return {"type": _KINDS[kind - 1], "coordinates": several}
        return {"type": _KINDS[kind - 1], "coordinates": self._simple(order, kind, width)}

    def _part(self, expected: int) -> list[Any]:
        order, kind, width = self._head()
        if kind != expected:
            raise ValueError(f"a Multi{_KINDS[expected - 1]} holds type {shown(kind)}")
        return self._simple(order, kind, width)

    def _simple(self, order: str, kind: int, width: int) -> list[Any]:
        if kind == _POLYGON:
            rings = range(self._count(order))
            return [self._corners(order, self._count(order), width) for _ in rings]
        if kind == _LINE:
            return self._corners(order, self._count(order), width)
        (point,) = self._corners(order, 1, width)
        return [] if np.isnan(point).all() else list(point)

    def _head(self) -> tuple[str, int, int]:
        """Read order of bytes, type, and how many numbers a corner has."""
        order = "<" if self._data[self._place] else ">"
        self._place += 1
        code = self._count(order)
        self._place += 4 if code & _SRID else 0
        extra, kind = divmod(code & 0x0FFFFFFF, 1000)
        return (
            order,
            kind,
            2 + (extra in (1, 3)) + (extra in (2, 3)) + sum(bool(code & mark) for mark in (_Z, _M)),
        )

    def _count(self, order: str) -> int:
        (count,) = struct.unpack_from(order + "I", self._data, self._place)
        self._place += 4
        return int(count)

    def _corners(self, order: str, count: int, width: int) -> list[list[float]]:
        found = np.frombuffer(self._data, order + "f8", count * width, self._place)
        self._place += found.nbytes
        return found.reshape(-1, width)[:, :2].tolist()  # type: ignore[no-any-return]
