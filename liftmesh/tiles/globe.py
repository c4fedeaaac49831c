"""`write_quantized_mesh`: a terrain as tiles of the globe, for viewers as CesiumJS.

Tiles are those of TMS over longitude and latitude: level 0 has two, and each tile four below it. A
tile of the finest level is made of the faces that touch it, any other one of the vertices of those
below it. Positions are rounded to steps of the tile before anything is triangulated, so faces do
not fold. Each side is decided once for both tiles of a level that have it, from what is on it
alone; and all tiles have one scale of heights. So neighbours of a level have the same numbers on
their common side. Those of different levels need not: viewers hang skirts from them.

Beyond its hull the terrain goes on as high as it is there, so that tiles are whole. Where a tile
bends with the earth more than a viewer permits, it is divided by a grid.

*A file* is in the format quantized-mesh-1.0: a header and a mesh of 16-bit numbers. Positions are
shares of the tile and of its range of heights, as whole numbers to 32767. Each is stored as the
difference from the one before, with the sign in the last bit. Vertices are in the order in which
faces use them first; a corner is stored as the difference from the number of vertices that were
used before it.

The header tells viewers what may be seen: a sphere around the vertices, and the point that is
behind the horizon when all of them are. The latter is on the way from the middle of the earth to
that of the sphere. In coordinates where the earth is a sphere of radius 1, a vertex at distance m
from the middle, off that way by an angle a, is hidden with it if it is at 1 / cos(a + acos(1 / m))
(K. Ring, "Computing the horizon occlusion point", 2013).

Source: github.com/CesiumGS/quantized-mesh.
"""

from __future__ import annotations

import json
import math
import os
import struct
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from liftmesh._typing import Array, Floats, Integers, Progress
from liftmesh.base.cloud import Cloud
from liftmesh.base.frozen import FrozenResult
from liftmesh.base.interruption import check
from liftmesh.base.options import as_count, as_folder, as_positive, check_progress, refused
from liftmesh.crs.transformation import transform
from liftmesh.crs.units import system_of
from liftmesh.errors import InputError, Option
from liftmesh.io.atomic import replacing
from liftmesh.terrain.surface_data import SurfaceData, as_cloud
from liftmesh.tiles.simplified import (
    Sides,
    corners_of,
    deviation,
    few_points,
    inside_of,
    side_of,
    simplified,
)
from liftmesh.tiles.staging import staged
from liftmesh.tiles.terrain_parts import WholeTerrain, part_of_cloud

if TYPE_CHECKING:
    from liftmesh.terrain.surface import Surface

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
    corners = number[tile.faces].ravel()
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


_LAYER = "layer.json"
_PLANE, _SPACE = "EPSG:4326", "EPSG:4978"
_COARSEST = 77067.34  # metres: what viewers take the error of level 0 to be; half of it below
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
    surface: Surface,
    folder: str | os.PathLike[str],
    *,
    max_error: float,
    zoom: int | None = None,
    progress: Progress | None = None,
) -> QuantizedMeshResult:
    """Write a terrain as tiles of the globe in the format quantized-mesh-1.0.

    Parameters
    ----------
    surface : Surface
        Over x and y, in a known coordinate system, with heights in metres.
    folder : path
        Where to write ``layer.json`` and a file for each tile, ``level/column/row.terrain``. It is
        made if it does not exist; files of these names are replaced, when all new ones are
        complete.
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
    finest hold the tiles that meet the surface, and level 0 both.

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
    globe = _Globe.of(_degrees(surface), finest, bound)
    errors, triangles = [0.0] * (finest + 1), [0] * (finest + 1)
    ranges = [globe.tiles(level) for level in range(finest + 1)]
    counts = [len(columns) * len(rows) for columns, rows in ranges]
    if max(counts) > _MOST_TILES:
        raise InputError(
            f"{max(counts):,} tiles in level {finest}: give a larger {Option('max_error')}, or a "
            f"smaller {Option('zoom')} than {finest}"
        )
    done = 0
    with staged(root, _LAYER) as stage:
        for level in reversed(range(finest + 1)):
            for column, row in globe.begin(level):
                check()
                tile, error = globe.tile(column, row)
                path = stage / str(level) / str(column) / f"{row}.terrain"
                path.parent.mkdir(parents=True, exist_ok=True)
                with replacing(path) as stream:
                    stream.write(encoded(tile))
                errors[level] = max(errors[level], error)
                triangles[level] += len(tile.faces)
                done += 1
                if progress is not None:
                    progress(done / sum(counts))
        with replacing(stage / _LAYER) as stream:
            stream.write(json.dumps(_layer(globe, ranges), indent=1).encode())
    return QuantizedMeshResult(root / _LAYER, tuple(errors), tuple(counts), tuple(triangles))


def _degrees(surface: object) -> Surface:
    """Return a surface with longitude and latitude for x and y."""
    if not isinstance(surface, SurfaceData):
        raise refused("surface", surface, "give a Surface, as triangulate makes them")
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
    corners = corners_of(surface)  # type: ignore[arg-type]  # the only one there is
    place = np.full(len(surface.vertices), -1, dtype=np.int32)
    place[np.unique(surface.faces)] = np.arange(len(corners), dtype=np.int32)
    moved = transform(corners.points, surface.crs, _PLANE)[0]
    moved[:, 2] = corners.points[:, 2]
    return part_of_cloud(Cloud(moved), place[surface.faces])


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

    def __init__(self, terrain: WholeTerrain, bounds: Floats, finest: int, bound: float) -> None:
        self.bounds = bounds  # in degrees
        self._terrain, self._finest, self._bound = terrain, finest, bound
        low, high = (float(each) for each in terrain.box[:, 2])
        self._low = float(np.nextafter(np.float32(low), np.float32(-np.inf)))
        self._high = float(np.nextafter(np.float32(high), np.float32(np.inf)))
        self._level = finest + 1
        self._sides: dict[tuple[int, int, int], Floats] = {}
        self._tiles: dict[tuple[int, int], Floats] = {}
        self._sides_below, self._tiles_below = self._sides, self._tiles

    @classmethod
    def of(cls, surface: Surface, finest: int, bound: float) -> _Globe:
        """Lay the steps of the finest level over a surface."""
        cloud, scale = as_cloud(surface), 2.0**finest * STEPS / 180
        points = np.column_stack([(cloud.points[:, :2] + [180, 90]) * scale, cloud.points[:, 2]])
        steps = part_of_cloud(replace(cloud, points=points, edges=None), surface.faces)
        degrees = cloud.points[:, :2]
        bounds = np.stack([degrees.min(axis=0), degrees.max(axis=0)])
        return cls(WholeTerrain(steps, "hull"), bounds, finest, bound)

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

    def tile(self, column: int, row: int) -> tuple[QuantizedTile, float]:
        """Make a tile; return also how far the surface is from it."""
        origin, scale = np.array([column, row]) * STEPS, 2.0 ** (self._finest - self._level)
        (left, low), (right, high) = ((origin + each * STEPS) * scale for each in (0, 1))
        box = (float(left), float(low), float(right), float(high))
        part = self._terrain.part(box)
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
        tile = self._of(origin, places, stored, surface.faces)
        if part is None:
            return tile, 0.0
        at = np.column_stack([(places[:, :2] + origin) * scale, stored])
        return tile, deviation(part_of_cloud(Cloud(at), surface.faces), part, box)

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
