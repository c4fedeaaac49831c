"""Parts of a tiled surface: the faces that touch a box, as a surface of their own.

By heredity (ARCHITECTURE.md), the triangulation of the corners of some faces has all these faces;
what else it has is masked. What a surface answers at a point depends on the faces that contain the
point, and on nothing else. So within the box, the part answers as the whole.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Floats, Integers
from liftmesh.planar.delaunay import delaunay
from liftmesh.terrain.plane import resolve_plane
from liftmesh.terrain.report import Report
from liftmesh.terrain.surface import Surface
from liftmesh.tiles.surface_files import vertices_name
from liftmesh.tiles.tiled import mapped

if TYPE_CHECKING:
    from liftmesh.tiles.tiled_surface import TiledSurface

_BLOCK = 1 << 19  # triangles that are looked at at once


def part_of(
    tiled: TiledSurface, box: tuple[float, float, float, float], most: int, threads: int | None
) -> Surface | int:
    """Make a surface of the faces that touch a box.

    Parameters
    ----------
    tiled : TiledSurface
        The whole.
    box : tuple of float
        xmin, ymin, xmax and ymax.
    most : int
        How many faces it may have.
    threads : int, optional
        As for `delaunay`.

    Returns
    -------
    Surface or int
        The part, with the rows of its corners in ascending order as vertices; or how many faces
        there are, if that is none or too many. Then the count may end with those that are too many.

    Raises
    ------
    FormatError
        A file is damaged.
    OSError
        A file cannot be read.
    """
    held: list[Integers] = []
    corners: list[Any] = []
    count = 0
    for vertices, triangles in _touching(tiled, box):
        count += len(triangles)
        if count > most:
            return count
        held.append(triangles)
        corners.append(vertices)
    if not count:
        return 0
    rows = np.concatenate([each["row"] for each in corners])
    rows, first = np.unique(rows, return_index=True)
    points = np.concatenate([_points_of(each) for each in corners])[first]
    faces = np.searchsorted(rows, np.concatenate(held)).astype(np.int32)
    return _surface(points, faces, tiled.crs, threads)


def _touching(
    tiled: TiledSurface, box: tuple[float, float, float, float]
) -> Iterator[tuple[Any, Integers]]:
    """Yield the faces whose own boxes touch a box, by rows, with their corners."""
    for shard in tiled.manifest["shards"]:
        west, south, _, east, north, _ = shard["extent"]
        if west > box[2] or south > box[3] or east < box[0] or north < box[1]:
            continue
        vertices: Any = mapped(tiled.directory / vertices_name(shard["file"]))
        triangles = mapped(tiled.directory / shard["file"])
        rows, xs, ys = (np.ascontiguousarray(vertices[name]) for name in ("row", "x", "y"))
        for begin in range(0, len(triangles), _BLOCK):
            block = np.array(triangles[begin : begin + _BLOCK])
            places = np.searchsorted(rows, block)
            touches = _overlaps(xs[places], box[0], box[2])
            touches &= _overlaps(ys[places], box[1], box[3])
            if touches.any():
                yield vertices[np.unique(places[touches])], block[touches]


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
    solved = delaunay(frame.planar(points), order="canonical", threads=threads)
    # Both lists begin each triangle at its lexicographically least corner, and no two triangles
    # have the same directed edge.
    ours, theirs = (
        each[:, 0].astype(np.int64) << 32 | each[:, 1] for each in (solved.simplices, faces)
    )
    mask = ~np.isin(ours, theirs)
    if len(mask) - np.count_nonzero(mask) != len(faces):
        raise RuntimeError("faces are no part of the triangulation of their corners: a bug")
    return Surface(
        vertices=points,
        faces=solved.simplices[~mask],
        triangulation=solved,
        frame=frame,
        report=_report(len(points), len(faces)),
        crs=crs,
        mask=mask if mask.any() else None,
    )


def _report(rows: int, faces: int) -> Report:
    none: dict[str, Any] = {
        "left_out": np.empty(0, np.int32),
        "representatives": np.empty(0, np.int32),
    }
    return Report(rows, rows, 0, 0, 0, faces, "error", {}, **none)
