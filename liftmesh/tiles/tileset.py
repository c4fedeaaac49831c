"""`write_tileset`: a terrain as a pyramid of simplified tiles, in GLB with a tileset of 3D Tiles.

Level 0 is one tile, and each tile has four below it, of half its side and half its error. Borders
are decided first, and once: for each side of a tile of the finest level, from the points of the
surface along that side alone, within the error of that level. Every tile of every level has all the
border points on its sides. So where tiles meet, of one level or of different ones, both have the
same vertices bit for bit, and there is no crack to hide behind skirts.

A side is simplified by the method of Douglas and Peucker (1973), by vertical distance: the farthest
point, of several the one with the least coordinate, divides it. Inside, `simplify` keeps within the
error of a level of all vertices, with the borders as lines that stay. A tile of the finest level is
made of the faces that touch it, any other one of the vertices of the four below it. So memory is
that of a tile, of those below the tiles above it, and of a million faces that were read before.

How far the surface is from a tile is found on all of it: their difference is linear in what two
faces have in common, so it is largest at a vertex of the surface, or where sides cross.

Files are written to a hidden folder, and put in their places when all are there.

Source: OGC 3D Tiles 1.1, 22-025r4.
"""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Floats, Progress
from liftmesh.base.frozen import FrozenResult
from liftmesh.base.interruption import check
from liftmesh.base.options import Extrapolation, as_count, as_folder, as_positive, check_progress
from liftmesh.errors import InputError, Option
from liftmesh.io.atomic import replacing
from liftmesh.io.axes import chosen_origin
from liftmesh.io.write import write
from liftmesh.raster.pixels import bounds_of
from liftmesh.terrain.surface_data import as_cloud
from liftmesh.tiles.simplified import (
    Deviation,
    Sides,
    Simplified,
    check_filled,
    corners_of,
    inside_of,
    joined,
    side_of,
    simplified,
    with_skirt,
)
from liftmesh.tiles.staging import staged
from liftmesh.tiles.terrain_parts import Terrain, check_metres, on_globe, terrain_of

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.io.format import Origin
    from liftmesh.terrain.surface import Surface
    from liftmesh.tiles.surface_raster import Bounds
    from liftmesh.tiles.tiled import TiledSurface

_MOST_LEVELS = 6
_SPACE = "EPSG:4978"  # geocentric, as viewers of 3D Tiles have it
TILESET = "tileset.json"


@dataclass(frozen=True, slots=True, eq=False)
class TilesetResult(FrozenResult):
    """What :func:`write_tileset` has written.

    Attributes
    ----------
    path : pathlib.Path
        The file ``tileset.json``.
    errors : tuple of float
        Of each level from 0: the largest vertical distance of the surface from the tiles, at
        vertices and between them.
    n_triangles : tuple of int
        Of each level, in all tiles; walls of skirts are not counted.
    origin : (float, float, float)
        The place on the map that is zero in the tiles.

    See Also
    --------
    write_tileset : Returns it.

    Examples
    --------
    >>> TilesetResult(Path("tileset.json"), (0.5,), (2,), (0.0, 0.0, 0.0)).errors
    (0.5,)
    """

    path: Path
    errors: tuple[float, ...]
    n_triangles: tuple[int, ...]
    origin: Origin


def write_tileset(
    surface: Surface | TiledSurface,
    folder: str | os.PathLike[str],
    *,
    max_error: float,
    levels: int = 4,
    bounds: Sequence[float] | None = None,
    extrapolate: Extrapolation | None = None,
    skirts: float | None = None,
    progress: Progress | None = None,
) -> TilesetResult:
    """Write a terrain as a pyramid of simplified tiles whose borders agree bit for bit.

    Parameters
    ----------
    surface : Surface or TiledSurface
        Over x and y, in metres or without units, and with faces over all of the bounds. One in
        tiles is read part by part, and gives the same bytes.
    folder : path
        Where to write ``tileset.json`` and a GLB file for each tile, ``level/column/row.glb``. It
        is made if it does not exist; files of these names, and all tiles of an earlier tileset
        there, are replaced when all new ones are complete.
    max_error : float
        The vertical distance of the vertices of the surface from tiles of the finest level, at
        most, in the units of heights. Tiles of the level above are within twice that of the
        vertices of these, and so on.
    levels : int, default 4
        From 1 to 6; the finest has 4 ** (levels - 1) tiles.
    bounds : sequence of float, optional
        xmin, ymin, xmax and ymax of level 0; by default those of the faces.
    extrapolate : {"nearest", "hull"}, optional
        As for `Surface.sample`: the heights of the corners of tiles that no face contains. By
        default these are an error. It needs a surface in memory.
    skirts : float, optional
        How deep walls hang from the border of each tile, in the units of heights. Borders agree
        without them; they hide what viewers make of tiles of different levels side by side.
    progress : callable, optional
        Called with the fraction of tiles that is done.

    Returns
    -------
    TilesetResult
        The file, and the error and the triangles of each level.

    Raises
    ------
    InputError
        An option is invalid, the surface does not fill the bounds or is not over x and y, or its
        units are not metres.
    FormatError
        A file of a surface in tiles is damaged.
    MissingDependencyError
        The coordinate system needs pyproj, or GLB trimesh.
    OSError
        A file cannot be read or written.

    See Also
    --------
    simplify : One surface within a distance.
    tile_surface : Surfaces that memory does not hold.

    Notes
    -----
    Vertices keep their colours, normals and named values; points that the border adds have those of
    the nearest vertex. The error of a level is the largest distance of the whole surface from its
    tiles, not of vertices alone. So it is often several times `max_error`: between vertices, sides
    of faces go other ways. Coordinates are rounded to single precision after that, relative to the
    origin: by 1 mm on a terrain of 30 km.

    ``geometricError`` of a tile is its own error, and at least that of the tiles below. Where the
    surface states its coordinate system, the root has the transformation to geocentric
    coordinates, exact at the middle: on the scale of a terrain of 10 km, the curvature of the
    earth is 2 m at its border.

    Examples
    --------
    >>> import liftmesh, tempfile
    >>> hill = liftmesh.triangulate([[0, 0, 0], [8, 0, 0], [0, 8, 0], [8, 8, 0], [3, 4, 5]])
    >>> found = write_tileset(hill, tempfile.mkdtemp(), max_error=0.5, levels=2)
    >>> found.path.name, found.n_triangles
    ('tileset.json', (8, 14))
    """
    count = as_count("levels", levels, 1, _MOST_LEVELS)
    bound = as_positive("max_error", max_error)
    depth = None if skirts is None else as_positive("skirts", skirts)
    check_progress(progress)
    root = Path(as_folder("folder", folder))
    terrain = terrain_of(surface, extrapolate)
    check_metres(surface)
    box = bounds_of(terrain.box[:, :2].ravel() if bounds is None else bounds)
    pyramid = _Pyramid.of(terrain, box, count, bound, depth)
    place = _transform(terrain.crs, pyramid.origin)
    with staged(root, TILESET, ".glb") as stage:
        top = pyramid.tile(stage, 0, 0, 0, progress)[1]
        low, high = top.pop("_box")
        tileset = {
            "asset": {"version": "1.1", "generator": "liftmesh"},
            "geometricError": max(float(np.linalg.norm(high - low)), top["geometricError"]),
            "root": top | ({} if place is None else {"transform": place}),
        }
        with replacing(stage / TILESET) as stream:
            stream.write(json.dumps(tileset, indent=1).encode())
    errors, triangles = tuple(pyramid.errors), tuple(pyramid.triangles)
    return TilesetResult(root / TILESET, errors, triangles, pyramid.origin)


def _transform(crs: str | None, origin: Origin) -> list[float] | None:
    """Return the matrix to geocentric coordinates, column by column; None without a system."""
    if crs is None:
        return None
    steps = np.array([origin] * 4) + np.vstack([np.zeros(3), np.eye(3)])
    at = on_globe(steps, crs, _SPACE)
    columns = np.column_stack([np.vstack([at[1:] - at[0], at[0]]), [0, 0, 0, 1]])
    return [float(each) for each in columns.ravel()]


@dataclass(slots=True)
class _Pyramid:
    """The tiles of all levels, each made after those below it."""

    terrain: Terrain
    lines: tuple[Floats, Floats]  # the grid of the finest level: x of its columns, y of its rows
    corners: Floats  # heights at the crossings of these, by row and column
    levels: int
    bound: float
    skirt: float | None
    origin: Origin
    errors: list[float]
    triangles: list[int]
    sides: dict[tuple[int, int, int], Cloud] = field(default_factory=dict)
    done: int = field(default=0)

    @classmethod
    def of(
        cls, terrain: Terrain, box: Sequence[float], levels: int, bound: float, skirt: float | None
    ) -> _Pyramid:
        parts = 2 ** (levels - 1)
        x, y = (np.linspace(box[k], box[k + 2], parts + 1) for k in (0, 1))
        places = np.stack(np.meshgrid(x, y), axis=2)
        corners = terrain.heights(places.reshape(-1, 2)).reshape(places.shape[:2])
        if np.isnan(corners).any():
            missing = places[np.isnan(corners)][0].tolist()
            raise InputError(
                f"the surface does not fill its bounds: it has no face at {missing}; give "
                f"{Option('bounds')} inside, or {Option('extrapolate', 'hull')}"
            )
        origin = chosen_origin("center", terrain.box)
        assert origin is not None  # noqa: S101 - for the type checker
        nothing: list[float] = [0.0] * levels
        return cls(terrain, (x, y), corners, levels, bound, skirt, origin, nothing, [0] * levels)

    def tile(
        self, folder: Path, level: int, column: int, row: int, progress: Progress | None
    ) -> tuple[Simplified, dict[str, Any]]:
        """Write a tile after those below it; return it, and what the tileset says of it."""
        check()
        below = [
            self.tile(folder, level + 1, 2 * column + k, 2 * row + m, progress)
            for m in (0, 1)
            for k in (0, 1)
            if level + 1 < self.levels
        ]
        parts = [each for each, _ in below]
        made = self._of(parts, level, column, row) if below else self._finest(column, row)
        error = self._error(made, level, column, row)
        mesh = as_cloud(made.surface) if self.skirt is None else with_skirt(made, self.skirt)
        name = f"{level}/{column}/{row}.glb"
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        write(folder / name, replace(mesh, edges=None), origin=self.origin)
        self.errors[level] = max(self.errors[level], error)
        self.triangles[level] += len(made.surface.faces)
        self.done += 1
        if progress is not None:
            progress(self.done / ((4**self.levels - 1) // 3))
        return made, self._said(name, error, mesh, [each for _, each in below])

    def _finest(self, column: int, row: int) -> Simplified:
        """Make a tile of the faces that touch it."""
        box = self._box(column, row)
        part = self.terrain.part(box)
        if part is not None and not self.terrain.beyond:
            check_filled(part, box)
        sides = Sides(
            south=self._side(0, row, column, part),
            east=self._side(1, column + 1, row, part),
            north=self._side(0, row + 1, column, part),
            west=self._side(1, column, row, part),
        )
        clouds = [sides.ring()] if part is None else [corners_of(part)]
        return simplified(inside_of(clouds, box), sides, self.bound)

    def _side(self, axis: int, line: int, cell: int, part: Surface | None) -> Cloud:
        """Return a side of a tile of the finest level, which two tiles have."""
        key = (axis, line, cell)
        if key in self.sides:
            return self.sides.pop(key)
        ends = np.empty((2, 3))
        ends[:, axis] = self.lines[axis][cell : cell + 2]
        ends[:, 1 - axis] = self.lines[1 - axis][line]
        at = (line, slice(cell, cell + 2)) if axis == 0 else (slice(cell, cell + 2), line)
        ends[:, 2] = self.corners[at]
        self.sides[key] = side_of(part, ends, self.bound, beyond=self.terrain.beyond)
        return self.sides[key]

    def _of(self, below: list[Simplified], level: int, column: int, row: int) -> Simplified:
        """Make a tile of the four below it, by row and column."""
        width = 2 ** (self.levels - 1 - level)
        left, right = self.lines[0][[column * width, (column + 1) * width]].tolist()
        low, high = self.lines[1][[row * width, (row + 1) * width]].tolist()
        a, b, c, d = (each.sides for each in below)
        sides = Sides(
            south=_after(a.south, b.south),
            east=_after(b.east, d.east),
            north=_after(c.north, d.north),
            west=_after(a.west, c.west),
        )
        surfaces = [each.surface for each in below]
        inside = inside_of([corners_of(each) for each in surfaces], (left, low, right, high))
        return simplified(inside, sides, self.bound * width)

    def _error(self, made: Simplified, level: int, column: int, row: int) -> float:
        """Return how far the surface is from a tile, cell by cell of the finest level."""
        width = 2 ** (self.levels - 1 - level)
        found, few = 0.0, Deviation(made.surface)
        for i in range(column * width, (column + 1) * width):
            for j in range(row * width, (row + 1) * width):
                box = self._box(i, j)
                if (part := self.terrain.part(box)) is not None:
                    found = max(found, few.of(part, box))
        return found

    def _box(self, column: int, row: int) -> Bounds:
        """Return a cell of the finest level."""
        x, y = self.lines
        return float(x[column]), float(y[row]), float(x[column + 1]), float(y[row + 1])

    def _said(
        self, name: str, error: float, mesh: Cloud, below: list[dict[str, Any]]
    ) -> dict[str, Any]:
        """Return what the tileset says of a tile, and its box."""
        boxes = np.array(
            [[mesh.points.min(axis=0), mesh.points.max(axis=0)]]
            + [each.pop("_box") for each in below]
        )
        low, high = boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)
        tile = {
            "boundingVolume": {"box": _box(low - self.origin, high - self.origin)},
            "geometricError": max([error, *(each["geometricError"] for each in below)]),
            "refine": "REPLACE",
            "content": {"uri": name},
            "_box": (low, high),
        }
        return tile | ({"children": below} if below else {})


def _after(one: Cloud, two: Cloud) -> Cloud:
    """Join two sides that share a corner."""
    return joined([one, two.select(slice(1, None))])


def _box(low: Floats, high: Floats) -> list[float]:
    """Return the middle of a box and its half axes."""
    half = np.maximum((high - low) / 2, 1e-3)
    return [float(each) for each in (*(low + high) / 2, *np.diag(half).ravel())]
