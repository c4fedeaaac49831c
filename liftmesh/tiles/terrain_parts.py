"""Parts of a terrain: the faces that touch a box, of a surface in memory or of one in tiles."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Protocol, TypeAlias

import numpy as np

from liftmesh._typing import Floats, Rows
from liftmesh.base.arrays import used_rows
from liftmesh.base.options import Extrapolation, refused
from liftmesh.crs.units import system_of
from liftmesh.errors import InputError, Option
from liftmesh.terrain.surface_data import SurfaceData, as_cloud, bounds_of_faces
from liftmesh.terrain.triangulate import as_surface
from liftmesh.tiles.surface_raster import Bounds, part_of, touching
from liftmesh.tiles.tiled_data import TiledSurfaceData, box_of

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.terrain.surface import Surface
    from liftmesh.tiles.tiled import TiledSurface

AnyTerrain: TypeAlias = "Surface | TiledSurface"
_ALL = 1 << 31  # faces


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
    """A surface in memory."""

    def __init__(self, surface: Surface, extrapolate: Extrapolation | None) -> None:
        self._surface, self._extrapolate = surface, extrapolate
        self.crs, self.beyond = surface.crs, extrapolate is not None
        self._cloud = replace(as_cloud(surface), edges=None)
        corners = surface.triangulation.points[surface.faces]
        self._low, self._high = corners.min(axis=1), corners.max(axis=1)
        left, low, right, high = bounds_of_faces(surface)
        heights = surface.vertices[used_rows(len(surface.vertices), surface.faces), 2]
        self.box = np.array([[left, low, heights.min()], [right, high, heights.max()]])

    def heights(self, places: Floats) -> Floats:
        """Return the heights at places."""
        found: Floats = self._surface.sample(places, extrapolate=self._extrapolate)
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
        return part_of_cloud(self._cloud.select(used), place[faces])


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


def part_of_cloud(cloud: Cloud, faces: Rows) -> Surface:
    """Make a surface of some faces of another one."""
    return as_surface(replace(cloud, faces=faces, metadata={}), triangulation="own")


def terrain_of(surface: object, extrapolate: Extrapolation | None) -> Terrain:
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
    return made


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
