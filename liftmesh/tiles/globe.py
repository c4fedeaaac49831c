"""`write_quantized_mesh`: a terrain as tiles of the globe, for viewers as CesiumJS.

Tiles are those of TMS over longitude and latitude: level 0 has two, and each tile four below it. A
tile of the finest level is made of the faces that touch it, any other one of the vertices of those
below it. Positions are rounded to steps of the tile before anything is triangulated, so faces do
not fold. Each side is decided once for both tiles of a level that have it, from what is on it
alone; and all tiles have one scale of heights. So neighbours of a level have the same numbers on
their common side. Those of different levels need not: viewers hang skirts from them.

Gaps of the terrain are filled with triangles, and beyond its hull it goes on as high as it is
there, so that tiles are whole. Where a tile bends with the earth more than a viewer permits, it is
divided by a grid. How far the surface is from all tiles is found in the end, cell by cell.
"""

from __future__ import annotations

import json
import math
import os
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Floats, Progress
from liftmesh.base.cloud import Cloud
from liftmesh.base.frozen import FrozenResult
from liftmesh.base.interruption import check
from liftmesh.base.options import as_count, as_folder, as_positive, check_progress, refused
from liftmesh.crs.units import system_of
from liftmesh.errors import InputError, Option
from liftmesh.io.atomic import replacing
from liftmesh.terrain.surface_data import SurfaceData
from liftmesh.tiles.quantized_mesh import STEPS, QuantizedTile, encoded
from liftmesh.tiles.simplified import (
    Deviation,
    Sides,
    corners_of,
    few_points,
    inside_of,
    side_of,
    simplified,
)
from liftmesh.tiles.staging import staged
from liftmesh.tiles.terrain_parts import (
    Kept,
    MovedTiles,
    Terrain,
    WholeTerrain,
    on_globe,
    part_of_cloud,
)
from liftmesh.tiles.tiled_data import TiledSurfaceData

if TYPE_CHECKING:
    from liftmesh.terrain.surface import Surface
    from liftmesh.tiles.surface_raster import Bounds
    from liftmesh.tiles.tiled import TiledSurface

_LAYER = "layer.json"
_PLANE, _SPACE = "EPSG:4326", "EPSG:4978"
_COARSEST = 77067.34  # metres: what viewers take the error of level 0 to be; half of it below
_ZERO = np.array([180.0, 90.0])  # degrees from the first tile's corner to the meridian and equator
_FINEST = 22
_MOST_TILES = 1 << 16
_RADIUS = 6378137.0
_SHARES = 256


@dataclass(frozen=True, slots=True, eq=False)
class QuantizedMeshResult(FrozenResult):
    """What :func:`write_quantized_mesh` has written.

    Attributes
    ----------
    path : pathlib.Path
        The file ``layer.json``.
    errors : tuple of float
        Of each level from 0, in metres: the largest distance along z of the surface from the tiles
        as they are stored, at vertices and between them.
    n_tiles, n_triangles : tuple of int
        Of each level.

    See Also
    --------
    write_quantized_mesh : Returns it.

    Examples
    --------
    >>> QuantizedMeshResult(Path("layer.json"), (0.5,), (2,), (4,)).n_tiles
    (2,)
    """

    path: Path
    errors: tuple[float, ...]
    n_tiles: tuple[int, ...]
    n_triangles: tuple[int, ...]


def write_quantized_mesh(
    surface: Surface | TiledSurface,
    folder: str | os.PathLike[str],
    *,
    max_error: float,
    zoom: int | None = None,
    progress: Progress | None = None,
) -> QuantizedMeshResult:
    """Write a terrain as tiles of the globe in the format quantized-mesh-1.0.

    Parameters
    ----------
    surface : Surface or TiledSurface
        Over x and y, in a known coordinate system, with heights in metres. One in tiles is read
        part by part, and gives the same bytes.
    folder : path
        Where to write ``layer.json`` and a file for each tile, ``level/column/row.terrain``. It is
        made if it does not exist; files of these names, and all tiles of an earlier layer there,
        are replaced when all new ones are complete.
    max_error : float
        The vertical distance of the vertices of the surface from tiles of the finest level, at
        most, in metres, but for the steps of 16 bits. Tiles of the level above are within twice
        that of the vertices of these, and so on.
    zoom : int, optional
        The finest level, to 22. By default that of which viewers expect an error of `max_error`:
        level 17 for 0.6 m, where a tile is 0.0014 degrees wide.
    progress : callable, optional
        Called with the fraction of tiles that is done.

    Returns
    -------
    QuantizedMeshResult
        The file, and the error, tiles and triangles of each level.

    Raises
    ------
    InputError
        An option is invalid; the surface is not over x and y, states no coordinate system, or
        heights in another unit than metres; or there would be more than 65,536 tiles in a level.
    MissingDependencyError
        pyproj is not installed.
    OSError
        A file cannot be written.

    See Also
    --------
    write_tileset : Tiles of the surface's own plane.

    Notes
    -----
    Tiles are in longitude and latitude (EPSG:4326), numbered as by TMS, from the south. Heights
    stay as they are: viewers take them for heights above the ellipsoid, so heights above the sea
    are shown as much too low as the geoid is high. Beyond the hull of the surface, tiles continue
    at the height that it has there: terrain around it has to come from elsewhere. Levels above the
    finest hold the tiles that meet the surface, and level 0 both. Holes are filled.

    Neighbours on one level have the same numbers along their common side, heights included, since
    all tiles have one range of heights; its steps are a 32,767th of it. Positions are rounded to a
    32,767th of a tile. `QuantizedMeshResult.errors` are of tiles so rounded, and of heights above
    the ellipsoid, along which a straight side of 1 km sinks by 2 cm. Colours and values are left
    out. Files are not compressed: they need no header ``Content-Encoding``.

    Examples
    --------
    >>> import liftmesh, tempfile
    >>> points = [[4e5, 5e6, 20], [4.001e5, 5e6, 25], [4e5, 5.0001e6, 30]]
    >>> hill = liftmesh.triangulate(points, crs="EPSG:25832")
    >>> found = write_quantized_mesh(hill, tempfile.mkdtemp(), max_error=1, zoom=3)
    >>> found.path.name, found.n_tiles
    ('layer.json', (2, 1, 1, 1))
    """
    bound = as_positive("max_error", max_error)
    expected = math.ceil(math.log2(max(_COARSEST / bound, 1)))
    finest = min(expected, _FINEST) if zoom is None else as_count("zoom", zoom, 0, _FINEST)
    check_progress(progress)
    root = Path(as_folder("folder", folder))
    _check(surface)
    globe = _Globe.of(surface, finest, bound)
    triangles = [0] * (finest + 1)
    ranges = [globe.tiles(level) for level in range(finest + 1)]
    counts = [len(columns) * len(rows) for columns, rows in ranges]
    if max(counts) > _MOST_TILES:
        raise InputError(
            f"{max(counts):,} tiles in level {finest}: give a larger {Option('max_error')}, or a "
            f"smaller {Option('zoom')} than {finest}"
        )
    done = 0
    with staged(root, _LAYER, ".terrain") as stage:
        for level in reversed(range(finest + 1)):
            for column, row in globe.begin(level):
                check()
                tile = globe.tile(column, row)
                path = stage / str(level) / str(column) / f"{row}.terrain"
                path.parent.mkdir(parents=True, exist_ok=True)
                with replacing(path) as stream:
                    stream.write(encoded(tile))
                triangles[level] += len(tile.faces)
                done += 1
                if progress is not None:
                    progress(done / sum(counts))
        errors = globe.errors()
        with replacing(stage / _LAYER) as stream:
            stream.write(json.dumps(_layer(globe, ranges), indent=1).encode())
    return QuantizedMeshResult(root / _LAYER, tuple(errors), tuple(counts), tuple(triangles))


def _check(surface: object) -> None:
    """Raise unless a surface has a place on the globe."""
    if not isinstance(surface, SurfaceData | TiledSurfaceData):
        raise refused("surface", surface, "give a Surface or a TiledSurface, as made of clouds")
    if surface.frame.name != "xy":
        raise InputError(
            f"tiles are of a surface over x and y: triangulate with {Option('plane', 'xy')}"
        )
    if surface.crs is None:
        raise InputError(
            "the surface states no coordinate system, so its place on the globe is unknown: give "
            f"triangulate {Option('crs', ...)}"
        )
    system = system_of(surface)
    unit = None if system is None else system.units[2]
    if unit is not None and unit.metres != 1.0:
        raise InputError(
            f"heights are in {unit.name}, but tiles in metres: read the points with "
            f"{Option('dst_crs', ...)} a system that names metres for heights"
        )


class _Steps:
    """Moves points to the steps of a level, and notes between which degrees they are."""

    def __init__(self, crs: str, level: int) -> None:
        self._crs, self._scale = crs, 2.0**level * STEPS / 180
        self._chosen: dict[str, Any] = {}
        self.bounds = np.array([[np.inf] * 2, [-np.inf] * 2])

    def __call__(self, points: Floats) -> Floats:
        degrees = on_globe(points, self._crs, _PLANE, self._chosen)[:, :2]
        self.bounds[0] = np.minimum(self.bounds[0], degrees.min(axis=0))
        self.bounds[1] = np.maximum(self.bounds[1], degrees.max(axis=0))
        return np.column_stack([(degrees + _ZERO) * self._scale, points[:, 2]])


def _moved(surface: Surface, move: _Steps) -> WholeTerrain:
    """Move a surface in memory; heights go on in its gaps, and beyond its hull."""
    points, place = corners_of(surface).points, np.full(len(surface.vertices), -1, np.int32)
    place[np.unique(surface.faces)] = np.arange(len(points), dtype=np.int32)
    there = part_of_cloud(Cloud(move(points)), place.take(surface.faces, axis=0))
    around = replace(there, mask=None, faces=there.triangulation.simplices)
    return WholeTerrain(there, "hull", around)


def _layer(globe: _Globe, ranges: list[tuple[range, range]]) -> dict[str, Any]:
    """Return what ``layer.json`` says."""
    (west, south), (east, north) = globe.bounds.tolist()
    return {
        "tilejson": "2.1.0",
        "format": "quantized-mesh-1.0",
        "version": "1.0.0",
        "scheme": "tms",
        "projection": _PLANE,
        "tiles": ["{z}/{x}/{y}.terrain"],
        "bounds": [west, south, east, north],
        "minzoom": 0,
        "maxzoom": len(ranges) - 1,
        "available": [
            [{"startX": x[0], "startY": y[0], "endX": x[-1], "endY": y[-1]}] for x, y in ranges
        ],
    }


class _Globe:
    """The tiles of one level after another, from the finest up.

    Coordinates are steps: of the finest level for the surface, of the tile's own level for tiles.
    """

    def __init__(self, terrain: Terrain, bounds: Floats, finest: int, bound: float) -> None:
        self.bounds = bounds  # in degrees
        self._terrain, self._finest, self._bound = Kept(terrain), finest, bound
        low, high = (float(each) for each in terrain.box[:, 2])
        self._low = float(np.nextafter(np.float32(low), np.float32(-np.inf)))
        self._high = float(np.nextafter(np.float32(high), np.float32(np.inf)))
        self._level = finest + 1
        self._sides: dict[tuple[int, int, int], Floats] = {}
        self._tiles: dict[tuple[int, int], Floats] = {}
        self._sides_below, self._tiles_below = self._sides, self._tiles
        self._made: dict[tuple[int, int, int], Deviation] = {}

    @classmethod
    def of(cls, surface: Surface | TiledSurface, finest: int, bound: float) -> _Globe:
        """Lay the steps of the finest level over a surface."""
        move = _Steps(str(surface.crs), finest)
        terrain: Terrain = (
            MovedTiles(surface, move)
            if isinstance(surface, TiledSurfaceData)
            else _moved(surface, move)
        )
        return cls(terrain, move.bounds, finest, bound)

    def tiles(self, level: int) -> tuple[range, range]:
        """Return the columns and rows of the tiles of a level that meet the surface."""
        width = STEPS * 2.0 ** (self._finest - level)
        (left, low), (right, high) = (self._terrain.box[:, :2] / width).tolist()
        columns, rows = (
            range(max(math.floor(first), 0), min(max(math.ceil(last), math.floor(first) + 1), most))
            for first, last, most in ((left, right, 2 << level), (low, high, 1 << level))
        )
        return (range(2), range(1)) if level == 0 else (columns, rows)

    def begin(self, level: int) -> list[tuple[int, int]]:
        """Go up to a level; return its tiles."""
        self._level = level
        self._sides_below, self._tiles_below = self._sides, self._tiles
        self._sides, self._tiles = {}, {}
        columns, rows = self.tiles(level)
        return [(column, row) for column in columns for row in rows]

    def _box(self, column: int, row: int) -> Bounds:
        """Return where a tile of this level is, in steps of the finest."""
        width = STEPS * 2.0 ** (self._finest - self._level)
        return column * width, row * width, (column + 1) * width, (row + 1) * width

    def tile(self, column: int, row: int) -> QuantizedTile:
        """Make a tile."""
        origin, scale = np.array([column, row]) * STEPS, 2.0 ** (self._finest - self._level)
        part = self._terrain.part(self._box(column, row)) if scale == 1 else None
        sides = Sides(
            south=self._side(0, row, column, 0, part),
            east=self._side(1, column + 1, row, STEPS, part),
            north=self._side(0, row + 1, column, STEPS, part),
            west=self._side(1, column, row, 0, part),
        )
        lines = self._grid(origin, sides)
        inside = self._inside(origin, part, lines)
        bound = self._bound * scale
        wide = self._width(row)
        surface = simplified(
            Cloud(inside * wide),
            Sides(*(Cloud(each.points * wide) for each in sides)),
            bound,
            [line * wide for line in lines],
        ).surface
        vertices = surface.vertices / wide
        self._tiles[column, row] = vertices + np.append(origin, 0)
        heights = (vertices[:, 2] - self._low) / (self._high - self._low)
        places = np.rint(np.column_stack([vertices[:, :2], heights * STEPS])).astype(np.int64)
        stored = self._low + places[:, 2] / STEPS * (self._high - self._low)
        at = np.column_stack([(places[:, :2] + origin) * scale, stored])
        few = part_of_cloud(Cloud(at), surface.faces)
        self._made[self._level, column, row] = Deviation(few)
        return self._of(origin, places, stored, surface.faces)

    def errors(self) -> list[float]:
        """Return how far the surface is from the tiles of each level, reading it once more."""
        found = [0.0] * (self._finest + 1)
        for column, row in self.begin(self._finest):
            check()
            box = self._box(column, row)
            if (part := self._terrain.part(box)) is None:
                continue
            for level in range(self._finest + 1):
                up = self._finest - level
                tile = self._made[level, column >> up, row >> up]
                found[level] = max(found[level], tile.of(part, box))
        return found

    def _of(self, origin: Any, places: Any, stored: Floats, faces: Any) -> QuantizedTile:
        width = 180 / 2.0**self._level

        def on_globe(shares: Floats, heights: Floats) -> Floats:
            return geocentric((origin / STEPS + shares) * width - [180, 90], heights)

        middle = np.array([self._low / 2 + self._high / 2])
        return QuantizedTile(
            places,
            faces,
            self._low,
            self._high,
            on_globe(np.array([[0.5, 0.5]]), middle)[0],
            on_globe(places[:, :2] / STEPS, stored),
        )

    def _width(self, row: int) -> Floats:
        """Return what makes a step to the east as long as it is there, without rounding any."""
        latitude = math.radians((row + 0.5) * 180 / 2.0**self._level - 90)
        return np.array([max(round(math.cos(latitude) * _SHARES), 1) / _SHARES, 1, 1])

    def _inside(self, origin: Any, part: Surface | None, lines: list[Floats]) -> Floats:
        """Return the points inside a tile, on its steps, each once and none on the grid."""
        if self._level == self._finest:
            points = np.empty((0, 3)) if part is None else corners_of(part).points
        else:
            column, row = (origin // STEPS * 2).tolist()
            below = [self._tiles_below.get((column + k, row + m)) for k in (0, 1) for m in (0, 1)]
            found = [each for each in below if each is not None]
            points = np.concatenate([np.empty((0, 3)), *found]) / [2, 2, 1]
        points = points - np.append(origin, 0)
        points[:, :2] = np.rint(points[:, :2])
        points = points[np.lexsort(points.T[::-1])]
        for line in lines:
            taken = (points[:, None, :2] == line[:, :2]).all(axis=2).any(axis=1)
            points = points[~taken]
        return inside_of([Cloud(points)], (0, 0, STEPS, STEPS)).points

    def _side(self, axis: int, line: int, cell: int, at: int, part: Surface | None) -> Cloud:
        """Return a side of a tile, which two tiles of a level may have."""
        key = (axis, line, cell)
        if key not in self._sides:
            self._sides[key] = self._new_side(axis, line, cell, part)
        along = self._sides[key]
        columns = [np.full(len(along), float(at)), along[:, 1]]
        columns.insert(axis, along[:, 0])
        return Cloud(np.column_stack(columns))

    def _new_side(self, axis: int, line: int, cell: int, part: Surface | None) -> Floats:
        """Return the steps along a side, and heights there."""
        scale = 2.0 ** (self._finest - self._level)
        count = self._divisions
        grid = np.rint(np.arange(count + 1) * (STEPS / count))
        places = np.empty((len(grid), 2))
        places[:, axis] = (cell * STEPS + grid) * scale
        places[:, 1 - axis] = line * STEPS * scale
        fixed = np.column_stack([grid, self._terrain.heights(places)])
        if self._level == self._finest:
            ends = np.column_stack([places, fixed[:, 1]])[[0, -1]]
            found = side_of(part, ends, self._bound, beyond=True).points
            points = np.column_stack([found[:, axis] - cell * STEPS, found[:, 2]])
        else:
            below = [self._sides_below.get((axis, 2 * line, 2 * cell + k)) for k in (0, 1)]
            halves = [
                each / [2, 1] + [k * STEPS / 2, 0]
                for k, each in enumerate(below)
                if each is not None
            ]
            points = np.concatenate([fixed[[0, -1]], *halves])
        points[:, 0] = np.rint(points[:, 0])
        points = np.concatenate([fixed[[0, -1]], points])
        points = points[np.unique(points[:, 0], return_index=True)[1]]
        points = few_points(np.column_stack([points[:, :1], points]), 0, self._bound * scale)[:, 1:]
        points = np.concatenate([fixed, points])
        side: Floats = points[np.unique(points[:, 0], return_index=True)[1]]
        return side

    @property
    def _divisions(self) -> int:
        """Into how many parts a side is divided, so that it bends with the earth."""
        error = _COARSEST / 2.0**self._level
        across = math.pi / 2.0**self._level / math.sqrt(8 * error / _RADIUS)
        return int(2 ** max(0, math.ceil(math.log2(across))))

    def _grid(self, origin: Any, sides: Sides) -> list[Floats]:
        """Return the lines of the grid that divides a tile."""
        count, scale = self._divisions, 2.0 ** (self._finest - self._level)
        steps = np.rint(np.arange(count + 1) * (STEPS / count))
        lines = []
        for axis, (first, last) in ((0, (sides.west, sides.east)), (1, (sides.south, sides.north))):
            for at in steps[1:-1]:
                line = np.full((count + 1, 3), at)
                line[:, axis] = steps
                line[:, 2] = self._terrain.heights((line[:, :2] + origin) * scale)
                for end, side in ((0, first), (-1, last)):
                    line[end, 2] = np.interp(at, side.points[:, 1 - axis], side.points[:, 2])
                lines.append(line)
        return lines


def geocentric(degrees: Floats, heights: Floats) -> Floats:
    """Return the places of longitudes, latitudes and heights above the ellipsoid, in metres."""
    longitude, latitude = np.radians(degrees).T
    flattening = 1 / 298.257223563
    square = flattening * (2 - flattening)
    normal = _RADIUS / np.sqrt(1 - square * np.sin(latitude) ** 2)
    across = (normal + heights) * np.cos(latitude)
    along = (normal * (1 - square) + heights) * np.sin(latitude)
    return np.column_stack([across * np.cos(longitude), across * np.sin(longitude), along])
