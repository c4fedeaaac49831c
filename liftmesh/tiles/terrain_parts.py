"""Parts of a terrain: the faces that touch a box, of a surface in memory or of one in tiles."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias

import numpy as np

from liftmesh._typing import Floats, Rows
from liftmesh.base.arrays import used_rows
from liftmesh.base.cloud import Cloud
from liftmesh.base.options import Extrapolation, refused
from liftmesh.crs.description import crs_name
from liftmesh.crs.transformation import TransformationError, transform
from liftmesh.crs.units import system_of
from liftmesh.errors import InputError, Option
from liftmesh.planar.delaunay import delaunay
from liftmesh.terrain.surface_data import SurfaceData, as_cloud, bounds_of_faces
from liftmesh.terrain.triangulate import as_surface, triangulate
from liftmesh.tiles.surface_parts import halves
from liftmesh.tiles.surface_raster import Bounds, apart, mesh_of, part_of, points_of, touching
from liftmesh.tiles.tiled_data import TiledSurfaceData, box_of

if TYPE_CHECKING:
    from liftmesh.terrain.surface import Surface
    from liftmesh.tiles.tiled import TiledSurface

AnyTerrain: TypeAlias = "Surface | TiledSurface"
_ALL = 1 << 31  # faces
_KEPT = 1 << 20  # faces of parts
_BLOCK = 1 << 15  # faces that are moved at once
_NO_ROWS = np.empty((0, 3), np.int64)


class Terrain(Protocol):
    """What tiles are made of."""

    crs: str | None
    box: Floats  # (2, 3): least and greatest coordinates
    beyond: bool  # whether there are heights beyond the faces

    def heights(self, places: Floats) -> Floats:
        """Return the heights at places, (n, 2); NaN where there are none."""

    def part(self, box: Bounds) -> Surface | None:
        """Return the faces that touch a box, with the values of their corners; None for none."""


class WholeTerrain:
    """A surface in memory; the one around it, if there is one, has heights in its gaps, too."""

    def __init__(
        self, surface: Surface, extrapolate: Extrapolation | None, around: Surface | None = None
    ) -> None:
        self._surface, self._extrapolate, self._around = surface, extrapolate, around or surface
        self.crs, self.beyond = surface.crs, extrapolate is not None
        self._cloud = replace(as_cloud(surface), edges=None)
        corners = surface.triangulation.points.take(surface.faces, axis=0)
        self._low, self._high = corners.min(axis=1), corners.max(axis=1)
        left, low, right, high = bounds_of_faces(surface)
        heights = surface.vertices[used_rows(len(surface.vertices), surface.faces), 2]
        self.box = np.array([[left, low, heights.min()], [right, high, heights.max()]])

    def heights(self, places: Floats) -> Floats:
        """Return the heights at places."""
        found: Floats = self._around.sample(places, extrapolate=self._extrapolate)
        return found

    def part(self, box: Bounds) -> Surface | None:
        """Return the faces that touch a box."""
        touches = (self._low <= box[2:]) & (self._high >= box[:2])
        is_near = touches.all(axis=1)
        if is_near.all():
            return self._surface
        faces = self._surface.faces[is_near]
        if not len(faces):
            return None
        used = used_rows(len(self._cloud), faces)
        place = np.empty(len(self._cloud), dtype=np.int32)
        place[used] = np.arange(len(used), dtype=np.int32)
        return part_of_cloud(self._cloud.select(used), place.take(faces, axis=0))


class Kept:
    """A terrain whose last parts are kept: those of one level of tiles are asked for by others."""

    def __init__(self, terrain: Terrain) -> None:
        self.crs, self.box, self.beyond = terrain.crs, terrain.box, terrain.beyond
        self.heights, self._part = terrain.heights, terrain.part
        self._parts: dict[Bounds, Surface | None] = {}
        self._held = 0  # faces

    def part(self, box: Bounds) -> Surface | None:
        """Return the faces that touch a box."""
        if box not in self._parts:
            self._parts[box] = part = self._part(box)
            self._held += _faces_of(part)
            while self._held > _KEPT and len(self._parts) > 1:
                self._held -= _faces_of(self._parts.pop(next(iter(self._parts))))
        return self._parts[box]


def _faces_of(part: Surface | None) -> int:
    return 0 if part is None else len(part.faces)


class TiledTerrain:
    """A surface in tiles, which is read part by part."""

    beyond = False

    def __init__(self, tiled: TiledSurface) -> None:
        self._tiled, self.crs = tiled, tiled.crs
        self.box = np.reshape(box_of(tiled), (2, 3))

    def heights(self, places: Floats) -> Floats:
        """Return the heights at places."""
        return self._tiled.sample(places)

    def part(self, box: Bounds) -> Surface | None:
        """Return the faces that touch a box."""
        near = touching(self._tiled, box)
        part = part_of(self._tiled, near, _ALL, None, with_values=True)
        return None if isinstance(part, int) else part


class MovedTiles:
    """A surface in tiles whose positions are moved, block by block, before they are asked for.

    Its faces have no gaps before that, and end at the hull. Where this is bent, and beyond, heights
    are those of triangles between corners of the hull, and of the hull.
    """

    crs: str | None = None
    beyond = True

    def __init__(self, tiled: TiledSurface, move: Callable[[Floats], Floats]) -> None:
        self._tiled, self._move = tiled, move
        self._blocks: list[tuple[Mapping[str, Any], int]] = []
        boxes, rim = [], []
        shards = tiled.manifest["shards"]
        move(points_of(min((mesh_of(tiled, each)[0][:1] for each in shards), key=_row_of)))
        for shard in shards:
            vertices, faces = mesh_of(tiled, shard)
            points = points_of(vertices)
            moved = move(points)
            for begin in range(0, len(faces), _BLOCK):
                corners = moved[np.unique(faces[begin : begin + _BLOCK])]
                self._blocks.append((shard, begin))
                boxes.append([corners.min(axis=0), corners.max(axis=0)])
            rim.append(points[delaunay(points[:, :2]).convex_hull])
        self._boxes = np.array(boxes)
        self.box = np.stack([self._boxes[:, 0].min(axis=0), self._boxes[:, 1].max(axis=0)])
        corners = np.concatenate(rim)
        ring = move(corners[delaunay(corners[:, :2]).convex_hull])
        self._around = triangulate(ring, breaklines=[np.concatenate([ring, ring[:1]])])

    def heights(self, places: Floats) -> Floats:
        """Return the heights at places."""
        found = np.full(len(places), np.nan)
        waiting = [np.arange(len(places))]
        while waiting:
            rows = waiting.pop()
            low, high = places[rows].min(axis=0).tolist(), places[rows].max(axis=0).tolist()
            most = _BLOCK if len(rows) > 1 else _ALL
            part = self._part((*low, *high), most)
            if not isinstance(part, int):
                found[rows] = part.sample(places[rows])
            elif part:
                waiting += halves(rows, places)
        beyond = np.isnan(found)
        found[beyond] = self._around.sample(places[beyond], extrapolate="hull")
        return found

    def part(self, box: Bounds) -> Surface | None:
        """Return the faces that touch a box."""
        part = self._part(box, _ALL)
        return None if isinstance(part, int) else part

    def _part(self, box: Bounds, most: int) -> Surface | int:
        """Return the faces that touch a box, or how many there are if 0, or too many."""
        low, high = np.reshape(box, (2, 2))
        rows, points, corners = [np.empty(0, np.int64)], [np.empty((0, 3))], [_NO_ROWS]
        near = (self._boxes[:, 0, :2] <= high) & (self._boxes[:, 1, :2] >= low)
        for number in np.flatnonzero(near.all(axis=1)):
            shard, begin = self._blocks[number]
            vertices, faces = mesh_of(self._tiled, shard)
            vertices, faces = apart(vertices, np.array(faces[begin : begin + _BLOCK]))
            moved = self._move(points_of(vertices))
            ends = moved[faces, :2]
            touches = (ends.min(axis=1) <= high) & (ends.max(axis=1) >= low)
            used = faces[touches.all(axis=1)]
            rows.append(vertices["row"])
            points.append(moved)
            corners.append(rows[-1][used])
            if sum(map(len, corners)) > most:
                return most + 1
        faces = np.concatenate(corners)
        if not len(faces):
            return 0
        names, first = np.unique(np.concatenate(rows), return_index=True)
        used = np.unique(faces)
        cloud = Cloud(np.concatenate(points)[first][np.searchsorted(names, used)])
        return part_of_cloud(cloud, np.searchsorted(used, faces).astype(np.int32))


def _row_of(vertex: Any) -> int:
    return int(vertex["row"][0])


def part_of_cloud(cloud: Cloud, faces: Rows) -> Surface:
    """Make a surface of some faces of another one."""
    return as_surface(replace(cloud, faces=faces, metadata={}), triangulation="own")


def terrain_of(surface: object, extrapolate: Extrapolation | None) -> Kept:
    """Check a surface that tiles are to be made of."""
    if isinstance(surface, TiledSurfaceData):
        if extrapolate is not None:
            raise refused("extrapolate", extrapolate, "which needs a surface in memory", mark=", ")
        made: Terrain = TiledTerrain(surface)  # type: ignore[arg-type]  # the only one there is
    elif isinstance(surface, SurfaceData):
        if surface.frame.name != "xy":
            raise InputError(
                f"a tileset is of a surface over x and y: triangulate with {Option('plane', 'xy')}"
            )
        made = WholeTerrain(surface, extrapolate)  # type: ignore[arg-type]  # as above
    else:
        raise refused("surface", surface, "give a Surface or a TiledSurface, as made of clouds")
    return Kept(made)


def on_globe(points: Floats, crs: str, target: str, chosen: dict[str, Any] | None = None) -> Floats:
    """Transform coordinates to a system of the globe."""
    try:
        return transform(points, crs, target, chosen)[0]
    except TransformationError as error:
        why = "there is no exact transformation, or it needs a grid that is not installed"
        if error.place is not None:
            why = f"{error.place} has no place there"
        raise InputError(
            f"the place on the globe is not known: from {crs_name(crs)} {why}: read the points "
            f"with {Option('src_crs', ...)} the system that they are in, as EPSG:25832"
        ) from error


def check_metres(surface: AnyTerrain) -> None:
    """Raise if coordinates are in other units than metres."""
    system = system_of(surface)
    units = [] if system is None else [each for each in system.units if each is not None]
    if any(each.metres != 1.0 for each in units):
        names = " and ".join(dict.fromkeys(each.name for each in units))
        raise InputError(
            f"coordinates are in {names}, but tilesets in metres: read the points with "
            f"{Option('dst_crs', ...)} a system of metres"
        )
