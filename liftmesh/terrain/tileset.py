"""`write_tileset`: a terrain as a pyramid of simplified tiles, in GLB with a tileset of 3D Tiles.

Level 0 is one tile, and each tile has four below it, of half its side and half its error. Borders
are decided first, and once: for each side of a tile of the finest level, from the points of the
surface along that side alone, within the error of that level. Every tile of every level has all the
border points on its sides. So where tiles meet, of one level or of different ones, both have the
same vertices bit for bit, and there is no crack to hide behind skirts.

A side is simplified by the method of Douglas and Peucker (1973), by vertical distance: the farthest
point, of several the one with the least coordinate, divides it. Inside, `simplify` keeps within the
error of a level of all vertices of the surface, with the borders as lines that stay.

Source: OGC 3D Tiles 1.1, 22-025r4.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Floats, Progress
from liftmesh.base.frozen import FrozenResult
from liftmesh.base.interruption import check
from liftmesh.base.options import as_count, as_folder, as_positive, check_progress, refused
from liftmesh.crs.transformation import transform
from liftmesh.crs.units import system_of
from liftmesh.errors import InputError, Option
from liftmesh.io.atomic import replacing
from liftmesh.io.axes import chosen_origin
from liftmesh.io.write import write
from liftmesh.raster.pixels import bounds_of
from liftmesh.terrain.profile import profile_along
from liftmesh.terrain.simplification import simplify
from liftmesh.terrain.surface_data import SurfaceData, bounds_of_faces
from liftmesh.terrain.triangulate import triangulate

if TYPE_CHECKING:
    import os

    from liftmesh.io.format import Origin
    from liftmesh.terrain.surface import Surface

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
        Of each level from 0: the largest vertical distance of a vertex of the surface, or of one of
        its points on a border, from the tiles.
    n_triangles : tuple of int
        Of each level, in all tiles.
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
    surface: Surface,
    folder: str | os.PathLike[str],
    *,
    max_error: float,
    levels: int = 4,
    bounds: Sequence[float] | None = None,
    progress: Progress | None = None,
) -> TilesetResult:
    """Write a terrain as a pyramid of simplified tiles whose borders agree bit for bit.

    Parameters
    ----------
    surface : Surface
        Over x and y, in metres or without units, and with faces over all of the bounds.
    folder : path
        Where to write ``tileset.json``, which is written last, and a GLB file for each tile,
        ``level/column/row.glb``. It is made if it does not exist; files of these names are
        replaced.
    max_error : float
        The vertical distance that no vertex of the surface has from tiles of the finest level, in
        the units of heights; twice as much on each level above.
    levels : int, default 4
        From 1 to 6; the finest has 4 ** (levels - 1) tiles.
    bounds : sequence of float, optional
        xmin, ymin, xmax and ymax of level 0; by default those of the faces.
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
    MissingDependencyError
        The coordinate system needs pyproj, or GLB trimesh.
    OSError
        A file cannot be written.

    See Also
    --------
    simplify : One surface within a distance.
    tile_surface : Surfaces that memory does not hold.

    Notes
    -----
    ``geometricError`` of a tile is the distance that was found for it, and at least that of the
    tiles below. Where the surface states its coordinate system, the root has the transformation to
    geocentric coordinates, exact at the middle: on the scale of a terrain of 10 km, the curvature
    of the earth is 2 m at its border. Colours and other values are left out.

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
    check_progress(progress)
    root = Path(as_folder("folder", folder))
    _check_surface(surface)
    box = bounds_of(bounds_of_faces(surface) if bounds is None else bounds)
    pyramid = _Pyramid.of(surface, box, count, bound, root)
    place = _transform(surface.crs, pyramid.origin)
    tile = pyramid.tile(0, 0, 0, progress)
    tileset = {
        "asset": {"version": "1.1", "generator": "liftmesh"},
        "geometricError": tile["geometricError"],
        "root": tile | ({} if place is None else {"transform": place}),
    }
    with replacing(root / TILESET) as stream:
        stream.write(json.dumps(tileset, indent=1).encode())
    errors, triangles = tuple(pyramid.errors), tuple(pyramid.triangles)
    return TilesetResult(root / TILESET, errors, triangles, pyramid.origin)


def _check_surface(surface: Surface) -> None:
    if not isinstance(surface, SurfaceData):
        raise refused("surface", surface, "give a Surface, as triangulate makes them")
    if surface.frame.name != "xy":
        raise InputError(
            f"a tileset is of a surface over x and y: triangulate with {Option('plane', 'xy')}"
        )
    system = system_of(surface)
    units = [] if system is None else [each for each in system.units if each is not None]
    if any(each.metres != 1.0 for each in units):
        names = " and ".join(dict.fromkeys(each.name for each in units))
        raise InputError(
            f"coordinates are in {names}, but tilesets in metres: read the points with "
            f"{Option('dst_crs', ...)} a system of metres"
        )


def _transform(crs: str | None, origin: Origin) -> list[float] | None:
    """Return the matrix to geocentric coordinates, column by column; None without a system."""
    if crs is None:
        return None
    steps = np.array([origin] * 4) + np.vstack([np.zeros(3), np.eye(3)])
    at = transform(steps, crs, _SPACE)[0]
    columns = np.column_stack([np.vstack([at[1:] - at[0], at[0]]), [0, 0, 0, 1]])
    return [float(each) for each in columns.ravel()]


@dataclass(slots=True)
class _Pyramid:
    """The tiles of all levels, made from the root on."""

    surface: Surface
    lines: tuple[Floats, Floats]  # the grid of the finest level: x of its columns, y of its rows
    sides: tuple[list[list[Floats]], list[list[Floats]]]  # upright and level ones, by line
    levels: int
    bound: float
    folder: Path
    origin: Origin
    border: float  # the largest distance of a point that no border has
    errors: list[float]
    triangles: list[int]
    done: int = field(default=0)

    @classmethod
    def of(
        cls, surface: Surface, box: Sequence[float], levels: int, bound: float, folder: Path
    ) -> _Pyramid:
        parts = 2 ** (levels - 1)
        x, y = (np.linspace(box[k], box[k + 2], parts + 1) for k in (0, 1))
        origin = chosen_origin("center", surface.vertices)
        assert origin is not None  # noqa: S101 - for the type checker
        upright = [_side(surface, 0, each, y) for each in x]
        level = [_side(surface, 1, each, x) for each in y]
        _join_corners(upright, level)
        kept, border = zip(*(_thinned(lines, bound) for lines in (upright, level)), strict=True)
        nothing = [0.0] * levels
        return cls(
            surface, (x, y), kept, levels, bound, folder, origin, max(border), nothing, [0] * levels
        )

    def tile(self, level: int, column: int, row: int, progress: Progress | None) -> dict[str, Any]:
        """Write a tile and those below it, and return what the tileset says of them."""
        check()
        mesh, error = self._mesh(level, column, row)
        name = f"{level}/{column}/{row}.glb"
        (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
        write(self.folder / name, mesh.to_cloud(), origin=self.origin)
        self.errors[level] = max(self.errors[level], error)
        self.triangles[level] += len(mesh.faces)
        self.done += 1
        if progress is not None:
            progress(self.done / ((4**self.levels - 1) // 3))
        below = [
            self.tile(level + 1, 2 * column + k, 2 * row + m, progress)
            for m in (0, 1)
            for k in (0, 1)
            if level + 1 < self.levels
        ]
        low, high = mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)
        boxes = [each.pop("_box") for each in below]
        low, high = (
            pick([each, *(box[k] for box in boxes)], axis=0)
            for k, (pick, each) in enumerate(((np.min, low), (np.max, high)))
        )
        tile = {
            "boundingVolume": {"box": _box(low - self.origin, high - self.origin)},
            "geometricError": max([error, *(each["geometricError"] for each in below)]),
            "refine": "REPLACE",
            "content": {"uri": name},
            "_box": (low, high),
        }
        tile |= {"children": below} if below else {}
        if level == 0:
            del tile["_box"]
        return tile

    def _mesh(self, level: int, column: int, row: int) -> tuple[Surface, float]:
        """Triangulate a tile within the error of its level; return what was found."""
        width = 2 ** (self.levels - 1 - level)
        columns = slice(column * width, (column + 1) * width)
        rows = slice(row * width, (row + 1) * width)
        ring = self._ring(columns, rows)
        vertices = self.surface.vertices
        (left, low), (right, high) = ring[:, :2].min(axis=0), ring[:, :2].max(axis=0)
        x, y = vertices[:, 0], vertices[:, 1]
        inside = vertices[(x > left) & (x < right) & (y > low) & (y < high)]
        inside = inside[np.lexsort(inside.T[::-1])]  # so that no bit depends on the order of rows
        border = np.concatenate([ring, ring[:1]])
        whole = triangulate(np.concatenate([inside, ring]), breaklines=[border])
        few = simplify(whole, max_error=self.bound * width, prune=False)
        return few, max(few.metadata["simplification"]["error"], self.border)

    def _ring(self, columns: slice, rows: slice) -> Floats:
        """Return the border of a tile, counter-clockwise, the first point not repeated."""
        upright, level = self.sides
        south, north = (
            np.concatenate([side[:-1] for side in level[k][columns]] + [level[k][columns][-1][-1:]])
            for k in (rows.start, rows.stop)
        )
        west, east = (
            np.concatenate([side[:-1] for side in upright[k][rows]] + [upright[k][rows][-1][-1:]])
            for k in (columns.start, columns.stop)
        )
        return np.concatenate([south[:-1], east[:-1], north[:0:-1], west[:0:-1]])


def _side(surface: Surface, axis: int, at: float, ends: Floats) -> list[Floats]:
    """Return the points of the surface along a line of the grid, between each two crossings."""
    line = np.full((2, 2), at)
    line[:, 1 - axis] = ends[[0, -1]]
    along = _points(surface, line)
    points = along.copy()
    points[:, axis] = at
    place = points[:, 1 - axis]
    if not len(place) or place[0] > ends[0] or place[-1] < ends[-1]:
        raise InputError(
            f"the surface does not fill its bounds: along {'xy'[axis]} = {at} it ends; give "
            f"{Option('bounds')} inside"
        )
    heights = np.interp(ends, place, points[:, 2])
    sides = []
    for first, last, low, high in zip(ends, ends[1:], heights, heights[1:], strict=False):
        between = points[(place > first) & (place < last)]
        corners = np.full((2, 3), at)
        corners[:, 1 - axis], corners[:, 2] = (first, last), (low, high)
        sides.append(np.concatenate([corners[:1], between, corners[1:]]))
    return sides


def _points(surface: Surface, line: Floats) -> Floats:
    """Return the points along a line, one for each place, in ascending order."""
    found = profile_along(surface, line)
    if len(found.starts) != 2:
        raise InputError(
            f"the surface has gaps along the line from {line[0].tolist()} to {line[1].tolist()}: "
            f"give {Option('bounds')} beside them"
        )
    axis = int(line[0, 1] != line[1, 1])
    _, first = np.unique(found.points[:, axis], return_index=True)
    return found.points[first]


def _join_corners(upright: list[list[Floats]], level: list[list[Floats]]) -> None:
    """Give both lines through a corner of the grid the height that one of them has."""
    for i, sides in enumerate(upright):
        for j in range(len(level)):
            height = sides[j][0, 2] if j < len(sides) else sides[-1][-1, 2]
            if i < len(level[j]):
                level[j][i][0, 2] = height
            if i:
                level[j][i - 1][-1, 2] = height


def _thinned(lines: list[list[Floats]], bound: float) -> tuple[list[list[Floats]], float]:
    """Simplify all sides; return also the largest distance of a point that is left out."""
    found = [[_few(side, bound) for side in sides] for sides in lines]
    largest = max(distance for sides in found for _, distance in sides)
    return [[side for side, _ in sides] for sides in found], largest


def _few(side: Floats, bound: float) -> tuple[Floats, float]:
    """Keep the points of a side that others are within a distance of; return the largest."""
    axis = int(side[0, 1] != side[-1, 1])
    place, heights = side[:, axis], side[:, 2]
    kept, largest, waiting = [0, len(side) - 1], 0.0, [(0, len(side) - 1)]
    while waiting:
        first, last = waiting.pop()
        if last - first < 2:
            continue
        ends = [first, last]
        distances = np.abs(
            heights[first:last] - np.interp(place[first:last], place[ends], heights[ends])
        )
        farthest = int(np.argmax(distances))
        if distances[farthest] <= bound:
            largest = max(largest, float(distances[farthest]))
            continue
        kept.append(first + farthest)
        waiting += [(first, first + farthest), (first + farthest, last)]
    return side[np.sort(kept)], largest


def _box(low: Floats, high: Floats) -> list[float]:
    """Return the middle of a box and its half axes."""
    half = np.maximum((high - low) / 2, 1e-3)
    return [float(each) for each in (*(low + high) / 2, *np.diag(half).ravel())]
