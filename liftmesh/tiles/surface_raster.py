"""Rasters of tiled surfaces, window by window: bit for bit those of `Surface.raster`.

The raster is cut into windows. For each, the faces that touch the centres of its pixels are read,
or with natural neighbours those whose circles do. A window with too many faces is cut again, so
memory is bounded: by the faces of two large shards, and by the pixels of a window where these go to
a file.

By heredity (ARCHITECTURE.md), the triangulation of the corners of some faces has all these faces;
what else it has is masked. What a surface answers at a point depends on the faces that contain the
point, or by natural neighbours on those that have it inside their circles, and on nothing else:
these have the same part of it in the triangulation of any of the points that holds their corners.
So within a window, some faces answer as the whole.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Integers, Progress, Rows
from liftmesh.base.arrays import pair_keys
from liftmesh.base.options import Interpolation, as_switch, check_progress
from liftmesh.errors import FormatError, InputError, Option
from liftmesh.io.streams import at_home
from liftmesh.io.write import WriteResult, written_file
from liftmesh.planar.delaunay import delaunay
from liftmesh.raster import writer
from liftmesh.raster.fill import filled_block
from liftmesh.raster.pixels import centres_of
from liftmesh.raster.raster import Raster, check_name, written_system
from liftmesh.terrain.frame import resolve_plane
from liftmesh.terrain.rasters import RasterOptions, RasterPlan, longest_sides
from liftmesh.terrain.report import bare_report
from liftmesh.terrain.sampling import faces_at
from liftmesh.terrain.surface import Surface
from liftmesh.tiles.schema import cloud_from
from liftmesh.tiles.tiled_data import TiledSurfaceData, box_of, shard_faces, shard_vertices

Bounds: TypeAlias = tuple[float, float, float, float]
Window: TypeAlias = tuple[range, range]

_SIDE = 1024  # pixels of a window, a multiple of the blocks of a file
_FACES = 1 << 16  # which a window may have at least
_FEWEST = 256  # pixels of a window, if circles count: many may have one pixel inside
_BLOCK = 1 << 19  # triangles that are looked at at once
_CIRCLES = 1 << 15  # faces that have one box around their circles


def rasterize(
    tiled: TiledSurfaceData,
    resolution: float | Sequence[float] | None,
    progress: Progress | None,
    options: RasterOptions,
) -> Raster:
    """Compute a raster in memory."""
    check_progress(progress)
    windows = _Windows(tiled, _plan(tiled, resolution, options))
    plan = windows.plan
    values = np.empty((plan.layout.rows, plan.layout.columns), plan.kind)
    for (down, across), block in windows.values(progress):
        values[down.start : down.stop, across.start : across.stop] = block
    return plan.raster(values, tiled.crs)


def save_raster(
    tiled: TiledSurfaceData,
    path: str | os.PathLike[str],
    resolution: float | Sequence[float] | None,
    progress: Progress | None,
    options: RasterOptions,
    *,
    cog: bool,
    compress: str | None,
) -> WriteResult:
    """Write a raster as GeoTIFF, window by window."""
    check_progress(progress)
    target = Path(at_home(path))
    check_name(target)
    is_cog = as_switch("cog", cog)
    windows = _Windows(tiled, _plan(tiled, resolution, {"dtype": np.float32, **options}))
    plan = windows.plan
    writer.write_windows(
        target,
        (plan.layout.rows, plan.layout.columns),
        plan.kind,
        windows.values(progress),
        plan.layout.transform,
        written_system(tiled.crs, plan.named),
        unit=plan.unit,
        cog=is_cog,
        compress=compress,
    )
    return written_file(target, "geotiff")


def _plan(
    tiled: TiledSurfaceData, resolution: float | Sequence[float] | None, options: RasterOptions
) -> RasterPlan:
    west, south, low, east, north, high = box_of(tiled)
    plan = RasterPlan.of(tiled, resolution, lambda: (west, south, east, north), options)
    check_in_tiles(plan.interpolation)
    if plan.quantity == "height":
        plan.check_range(np.array([low, high]))
    return plan


def check_in_tiles(interpolation: Interpolation) -> None:
    """Raise for an interpolation that a part of a surface does not have."""
    if interpolation == "c1":
        raise InputError(
            f"{Option('interpolation', 'c1')} needs all vertices at once, and a surface in tiles "
            f"has some: give {Option('interpolation', 'sibson')}, or triangulate in memory"
        )


class Parts:
    """Makes parts of a surface that answer in a box as the whole does."""

    def __init__(
        self, tiled: TiledSurfaceData, interpolation: Interpolation, threads: int | None
    ) -> None:
        self._tiled, self._threads = tiled, threads
        is_linear = interpolation == "linear"
        self._near = partial(touching, tiled) if is_linear else Circles(tiled).near
        self._fewest = 1 if is_linear else _FEWEST
        largest = max(shard["triangles"] for shard in tiled.manifest["shards"])
        self._most = max(_FACES, 2 * largest)

    def around(self, places: Floats) -> Surface | int:
        """Make the part for the box of places; return the number of faces if 0, or too many."""
        low, high = places.min(axis=0), places.max(axis=0)
        is_wide = len(places) > self._fewest and (low < high).any()
        box = (*low.tolist(), *high.tolist())
        return part_of(
            self._tiled, self._near(box), self._most if is_wide else 1 << 31, self._threads
        )


class _Windows:
    """Computes the values of a raster, some pixels at a time."""

    def __init__(self, tiled: TiledSurfaceData, plan: RasterPlan) -> None:
        self.plan = plan
        self._parts = Parts(tiled, plan.interpolation, plan.threads)

    def values(self, progress: Progress | None) -> Iterator[tuple[Window, Array]]:
        """Yield windows, block of rows by block of rows, and their values."""
        rows, columns = self.plan.layout.rows, self.plan.layout.columns
        done = 0
        for top in range(0, rows, _SIDE):
            for left in range(0, columns, _SIDE):
                down = range(top, min(top + _SIDE, rows))
                across = range(left, min(left + _SIDE, columns))
                yield (down, across), self._filled(down, across)
                done += len(down) * len(across)
                if progress is not None:
                    progress(done / (rows * columns))

    def _filled(self, down: range, across: range) -> Array:
        """Compute a window, with what is around it if it is filled from there."""
        reach = self.plan.reach
        if reach is None:
            return self._of(down, across)
        high = reach.around(down, self.plan.layout.rows, reach.rows)
        wide = reach.around(across, self.plan.layout.columns, reach.columns)
        block = filled_block(self._of(high, wide), reach)
        top, left = down.start - high.start, across.start - wide.start
        return block[top : top + len(down), left : left + len(across)]

    def _of(self, down: range, across: range) -> Array:
        centres = centres_of(self.plan.layout.transform, down, across)
        surface = self._parts.around(centres.reshape(-1, 2))
        if not isinstance(surface, int):
            return self._at(centres, surface)
        if surface == 0:
            return self._at(centres, None)
        axis = int(len(across) > len(down))
        halves = [self._of(*each) for each in _halves(down, across, axis)]
        return np.concatenate(halves, axis=axis)

    def _at(self, centres: Floats, surface: Surface | None) -> Array:
        """Compute the values at centres; without a face, these are NaN."""
        plan = self.plan
        values = np.empty(centres.shape[:2], plan.kind)
        if plan.quantity == "height":
            values[...] = np.nan
            if surface is not None:
                found = surface.sample(centres, plan.interpolation, threads=plan.threads)
                values[...] = plan.less(centres, found)
        elif plan.quantity == "longest-edge":
            values[...] = np.nan
            if surface is not None:
                values[...] = longest_sides(surface)[faces_at(surface, centres, plan.threads)]
        else:
            gradients = np.full(centres.shape, np.nan)
            if surface is not None:
                gradients = surface.gradient(centres, threads=plan.threads)
            values[...] = plan.of_gradients(gradients)
        plan.finish(values)
        return values


def _halves(down: range, across: range, axis: int) -> list[Window]:
    if axis:
        middle = len(across) // 2
        return [(down, across[:middle]), (down, across[middle:])]
    middle = len(down) // 2
    return [(down[:middle], across), (down[middle:], across)]


def part_of(
    tiled: TiledSurfaceData,
    near: Iterator[tuple[Any, Rows]],
    most: int,
    threads: int | None,
    *,
    with_values: bool = False,
) -> Surface | int:
    """Make a surface of some faces; the values of their corners are left out unless wanted."""
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
    points = np.concatenate([points_of(each) for each in corners])[first]
    begins = np.cumsum([0, *(len(each) for each in corners)])
    parts = [place[faces + begin] for faces, begin in zip(held, begins, strict=False)]
    try:
        found = _surface(points, np.concatenate(parts), tiled.crs, threads)
    except InputError as error:  # a folder whose manifest was made to fit
        raise FormatError(
            f"{tiled.folder}: the shards hold no faces of a triangulation ({error}): tile the "
            "source again"
        ) from error
    if not with_values:
        return found
    cloud = cloud_from(np.concatenate(corners)[first], tiled.schema)
    return replace(found, colors=cloud.colors, normals=cloud.normals, attributes=cloud.attributes)


def touching(tiled: TiledSurfaceData, box: Bounds) -> Iterator[tuple[Any, Rows]]:
    """Yield the faces whose own boxes touch a box, and their corners."""
    for shard in tiled.manifest["shards"]:
        west, south, _, east, north, _ = shard["box"]
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


def mesh_of(tiled: TiledSurfaceData, shard: Mapping[str, Any]) -> tuple[Any, Rows]:
    """Map a shard."""
    return shard_vertices(tiled, shard), shard_faces(tiled, shard)


def apart(vertices: Any, faces: Rows) -> tuple[Any, Rows]:
    """Take some faces and their corners out of a shard."""
    is_corner = np.zeros(len(vertices), dtype=np.bool_)
    is_corner[faces.reshape(-1)] = True
    number = np.cumsum(is_corner, dtype=np.int32) - np.int32(1)
    return vertices[is_corner], number.take(faces, axis=0)


def _overlaps(along: Floats, low: float, high: float) -> Array:
    """Whether the corners of each triangle reach into a range."""
    a, b, c = along.T
    least, greatest = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    overlaps: Array = (least <= high) & (greatest >= low)
    return overlaps


def points_of(vertices: Array) -> Floats:
    """Return where the vertices of a shard are."""
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
        report=bare_report(len(points), len(faces)),
        crs=crs,
        mask=mask if mask.any() else None,
    )


def _names(triangles: Array) -> Integers:
    """Name triangles by their least corner and the next: no others have this directed edge."""
    first, every = np.argmin(triangles, axis=1), np.arange(len(triangles))
    return pair_keys(triangles[every, first], triangles[every, (first + 1) % 3])


class Circles:
    """Knows how far the circles of a surface reach: 32 bytes for each block of faces."""

    def __init__(self, tiled: TiledSurfaceData) -> None:
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
            held = [
                _reaching(points, faces[i * _CIRCLES : (i + 1) * _CIRCLES], window) for i in blocks
            ]
            reaching = np.concatenate(held)
            if len(reaching):
                yield apart(vertices, reaching)

    def _read(self, shard: Mapping[str, Any]) -> tuple[Any, Floats, Rows]:
        """Return the vertices of a shard, where they are, and its faces."""
        vertices, faces = mesh_of(self._tiled, shard)
        return vertices, np.stack([vertices["x"], vertices["y"]], axis=1), faces


def _boxes(points: Floats, faces: Rows) -> Floats:
    begins = range(0, len(faces), _CIRCLES)
    return np.concatenate([_kernel.reach_of(points, faces[i : i + _CIRCLES]) for i in begins])


def _reaching(points: Floats, faces: Rows, window: Floats) -> Rows:
    reaching: Rows = faces[_kernel.find_reaching(points, faces, window)]
    return reaching
