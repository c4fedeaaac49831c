"""Parts of a tiled surface: the faces that concern a box, as a surface of their own.

By heredity (ARCHITECTURE.md), the triangulation of the corners of some faces has all these faces;
what else it has is masked. What a surface answers at a point depends on the faces that contain the
point, or by natural neighbours on those whose circles do (`circles.py`), and on nothing else. So
within the box, the part answers as the whole.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from liftmesh._typing import Array, Floats, Integers, Rows
from liftmesh.errors import FormatError, InputError
from liftmesh.planar.delaunay import delaunay
from liftmesh.terrain.frame import resolve_plane
from liftmesh.terrain.report import Report
from liftmesh.terrain.surface import Surface

if TYPE_CHECKING:
    from liftmesh.tiles.tiled_surface import TiledSurface

Bounds: TypeAlias = tuple[float, float, float, float]

_BLOCK = 1 << 19  # triangles that are looked at at once


def part_of(
    tiled: TiledSurface, near: Iterator[tuple[Any, Rows]], most: int, threads: int | None
) -> Surface | int:
    """Make a surface of some faces."""
    held: list[Rows] = []
    corners: list[Any] = []
    count = 0
    for vertices, faces in near:
        count += len(faces)
        if count > most:
            return count
        held.append(faces)
        corners.append(vertices)
    if not count:
        return 0
    rows = np.concatenate([each["row"] for each in corners])
    _, first, place = np.unique(rows, return_index=True, return_inverse=True)
    points = np.concatenate([_points_of(each) for each in corners])[first]
    begins = np.cumsum([0, *(len(each) for each in corners)])
    parts = [place[faces + begin] for faces, begin in zip(held, begins, strict=False)]
    try:
        return _surface(points, np.concatenate(parts), tiled.crs, threads)
    except InputError as error:  # a folder whose manifest was made to fit
        raise FormatError(
            f"{tiled.directory}: the shards hold no faces of a triangulation ({error}): tile the "
            "source again"
        ) from error


def touching(tiled: TiledSurface, box: Bounds) -> Iterator[tuple[Any, Rows]]:
    """Yield the faces whose own boxes touch a box, and their corners."""
    for shard in tiled.manifest["shards"]:
        west, south, _, east, north, _ = shard["extent"]
        if west > box[2] or south > box[3] or east < box[0] or north < box[1]:
            continue
        vertices, faces = mesh_of(tiled, shard)
        xs, ys = (np.ascontiguousarray(vertices[name]) for name in ("x", "y"))
        for begin in range(0, len(faces), _BLOCK):
            block = np.array(faces[begin : begin + _BLOCK])
            touches = _overlaps(xs[block], box[0], box[2])
            touches &= _overlaps(ys[block], box[1], box[3])
            if touches.any():
                yield apart(vertices, block[touches])


def mesh_of(tiled: TiledSurface, shard: Mapping[str, Any]) -> tuple[Any, Rows]:
    """Map a shard."""
    return tiled._vertices(shard), tiled._faces(shard)  # noqa: SLF001 - one of its parts


def apart(vertices: Any, faces: Rows) -> tuple[Any, Rows]:
    """Take some faces and their corners out of a shard."""
    is_corner = np.zeros(len(vertices), dtype=np.bool_)
    is_corner[faces.reshape(-1)] = True
    number = np.cumsum(is_corner, dtype=np.int32) - np.int32(1)
    return vertices[is_corner], number[faces]


def _overlaps(along: Floats, low: float, high: float) -> Array:
    """Whether the corners of each triangle reach into a range."""
    a, b, c = along.T
    least, greatest = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    found: Array = (least <= high) & (greatest >= low)
    return found


def _points_of(vertices: Array) -> Floats:
    return np.stack([vertices[name] for name in ("x", "y", "z")], axis=1)


def _surface(points: Floats, faces: Array, crs: str | None, threads: int | None) -> Surface:
    frame = resolve_plane("xy", points)
    solved = delaunay(frame.planar(points), threads=threads)
    mask = ~np.isin(_names(solved.simplices), _names(faces))
    if len(mask) - np.count_nonzero(mask) != len(faces):
        raise InputError("some are no part of the triangulation of their corners")
    return Surface(
        vertices=points,
        faces=solved.simplices[~mask],
        triangulation=solved,
        frame=frame,
        report=_report(len(points), len(faces)),
        crs=crs,
        mask=mask if mask.any() else None,
    )


def _names(triangles: Array) -> Integers:
    """Name triangles by their least corner and the next: no others have this directed edge."""
    first, every = np.argmin(triangles, axis=1), np.arange(len(triangles))
    following = triangles[every, (first + 1) % 3].astype(np.int64)
    names: Integers = triangles[every, first].astype(np.int64) << 32 | following
    return names


def _report(rows: int, faces: int) -> Report:
    none: dict[str, Any] = {
        "left_out": np.empty(0, np.int32),
        "representatives": np.empty(0, np.int32),
    }
    return Report(rows, rows, 0, 0, 0, faces, "error", {}, **none)
