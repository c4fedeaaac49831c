"""What the algorithms of QGIS do with arrays: geometries as well-known binary, and messages.

Geometries are written in the form of ISO 13249-3, which QGIS reads bit for bit.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Floats
from liftmesh.base.cloud import Cloud
from liftmesh.errors import InputError, Message, Option
from liftmesh.planar.constrained import constrained_delaunay
from liftmesh.terrain.triangulate import as_surface

if TYPE_CHECKING:
    from liftmesh.cells.voronoi import Cells
    from liftmesh.terrain.contours import Contours
    from liftmesh.terrain.surface import Surface

_LINE, _POLYGON, _WITH_HEIGHTS = 2, 3, 1000
LABELS = {
    "boundary_only": "Only from outside inwards",
    "crossing": "Where lines cross",
    "dst_crs": "Reproject layer",
    "interval": "Interval",
    "level": "Level",
    "levels": "Interval",
    "max_edge": "Longest side",
    "max_error": "Largest error",
    "max_points": "Most vertices",
    "on_duplicate": "Points at one position",
    "smooth": "Smooth within",
    "contour_base": "Base",
}
"""What options of liftmesh are in QGIS."""


def worded(message: str) -> str:
    """Name options in a message as QGIS does."""
    parts = Message(message).parts
    return "".join(each if isinstance(each, str) else _labelled(each) for each in parts)


def _labelled(option: Option) -> str:
    label = f'"{LABELS.get(option.name, option.name)}"'
    return label if option.value in (None, ...) else f"{label} {option.value}"


def triangles(surface: Surface) -> Iterator[bytes]:
    """Yield the faces as polygons with heights."""
    return (_polygon([ring]) for ring in surface.vertices.take(surface.faces[:, [0, 1, 2, 0]], 0))


def lines(contours: Contours) -> Iterator[bytes]:
    """Yield the lines with their levels as heights."""
    for each in contours:
        corners = np.column_stack([each.points, np.full(len(each.points), each.level)])
        yield _head(_LINE, corners) + _corners(corners)


def cells(found: Cells) -> Iterator[tuple[int, bytes]]:
    """Yield the rows that have a cell in a box, and the cell: it is convex."""
    rows, starts = np.flatnonzero(np.diff(found.parts)).tolist(), found.ring_corners.tolist()
    for row, first, end in zip(rows, starts[:-1], starts[1:], strict=True):
        yield row, _polygon([found.corners[[*range(first, end), first]]])


def _polygon(rings: list[Floats]) -> bytes:
    return _head(_POLYGON, rings[0]) + _number(len(rings)) + b"".join(map(_corners, rings))


def _head(kind: int, corners: Floats) -> bytes:
    return _number(1, 1) + _number(kind + _WITH_HEIGHTS * (corners.shape[1] == 3))


def _corners(corners: Floats) -> bytes:
    return _number(len(corners)) + corners.astype("<f8").tobytes()


def _number(value: int, size: int = 4) -> bytes:
    return value.to_bytes(size, "little")


def surface_of_triangles(corners: Floats, crs: str | None) -> Surface:
    """Make a surface of triangles, (m, 3, 3)."""
    faces = np.arange(corners.shape[0] * 3, dtype=np.int32).reshape(-1, 3)
    return as_surface(Cloud(corners.reshape(-1, 3), faces=faces, crs=crs), triangulation="own")


def volumes(surface: Surface, level: float, polygons: list[list[Floats]] | None) -> list[float]:
    """Measure what is above a level, what is below, the difference and the area; in polygons."""
    if polygons is None:
        found = surface.volume(level)
        return [found.above, found.below, found.net, found.area]
    if not polygons:
        return [0.0] * 4
    tri = constrained_delaunay(np.empty((0, 2)), polygons=polygons, carve="holes")
    corners = np.column_stack([tri.points, np.full(tri.npoints, level)])
    plain = as_surface(Cloud(corners, faces=tri.simplices, crs=surface.crs), triangulation="own")
    try:
        between = plain.cut_and_fill(surface)
    except InputError as error:
        if "no area in common" not in error.message:
            raise
        return [0.0] * 4
    return [between.fill, between.cut, between.net, between.area]
