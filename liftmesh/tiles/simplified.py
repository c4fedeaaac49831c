"""Simplified tiles: their borders, their interior, and how far they deviate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.arrays import pair_keys, pairs_of_keys, used_rows
from liftmesh.base.cloud import Cloud
from liftmesh.errors import InputError, Option
from liftmesh.terrain.breaklines import nearest_rows
from liftmesh.terrain.profile import LineCrossings, profile_along
from liftmesh.terrain.sampling import heights_at
from liftmesh.terrain.simplification import simplify
from liftmesh.terrain.surface_data import as_cloud
from liftmesh.terrain.triangulate import triangulate

if TYPE_CHECKING:
    from liftmesh.terrain.surface import Surface
    from liftmesh.tiles.surface_raster import Bounds


_TOUCHING = 1e-9  # the share of a side that is inside of a box which it only touches


class Sides(NamedTuple):
    """The points on the border of a tile, by ascending x or y, corners included."""

    south: Cloud
    east: Cloud
    north: Cloud
    west: Cloud

    def ring(self) -> Cloud:
        """Return the border counter-clockwise, each point once."""
        there = [each.select(slice(0, -1)) for each in (self.south, self.east)]
        back = [each.select(slice(None, 0, -1)) for each in (self.north, self.west)]
        return joined(there + back)


@dataclass(frozen=True, slots=True, eq=False)
class Simplified:
    """A tile: its faces, whose last rows are the border."""

    surface: Surface
    sides: Sides
    n_border: int


def simplified(
    inside: Cloud, sides: Sides, bound: float, lines: Sequence[Floats] = ()
) -> Simplified:
    """Simplify what is inside a border, which stays, as other lines do."""
    ring = sides.ring()
    closed = np.concatenate([ring.points, ring.points[:1]])
    rows = joined([inside, ring])
    whole = triangulate(rows, breaklines=[closed, *lines])
    kept = {name: whole.attributes[name] for name in rows.attributes}
    few = simplify(replace(whole, attributes=kept), max_error=bound, prune=False)
    return Simplified(replace(few, metadata={}), sides, len(ring))


def side_of(part: Surface | None, ends: Floats, bound: float, *, beyond: bool) -> Cloud:
    """Return the points of a surface along a line that is level or upright, few of them.

    ``ends`` are two rows of x, y and z.
    """
    axis = int(ends[0, 1] != ends[1, 1])
    points = ends
    if part is not None:
        found = profile_along(part, ends[:, :2])
        along = found.points[np.unique(found.points[:, axis], return_index=True)[1]]
        along[:, 1 - axis] = ends[0, 1 - axis]
        place = along[:, axis]
        is_whole = len(found.starts) == 2 and (place[[0, -1]] == ends[:, axis]).all()
        if not is_whole and not beyond:
            raise _gap(ends)
        between = along[(place > ends[0, axis]) & (place < ends[1, axis])]
        points = np.concatenate([ends[:1], between, ends[1:]])
    elif not beyond:
        raise _gap(ends)
    kept = few_points(points, axis, bound)
    if part is None:
        return Cloud(kept)
    cloud = replace(as_cloud(part), faces=None, edges=None)
    rows = nearest_rows(part.vertices[:, :2], kept[:, :2])
    return replace(cloud.select(rows), points=kept)


def _gap(ends: Floats) -> InputError:
    start, stop = ends[:, :2].tolist()
    return InputError(
        f"the surface does not fill its bounds: it has a gap along the line from {start} to "
        f"{stop}; give {Option('bounds')} inside, or {Option('extrapolate', 'hull')}"
    )


def few_points(points: Floats, axis: int, bound: float) -> Floats:
    """Keep the points of a side that others are within a distance of."""
    place, heights = points[:, axis], points[:, 2]
    kept, waiting = [0, len(points) - 1], [(0, len(points) - 1)]
    while waiting:
        first, last = waiting.pop()
        if last - first < 2:
            continue
        ends = [first, last]
        distances = np.abs(
            heights[first:last] - np.interp(place[first:last], place[ends], heights[ends])
        )
        farthest = int(np.argmax(distances))
        if distances[farthest] > bound:
            kept.append(first + farthest)
            waiting += [(first, first + farthest), (first + farthest, last)]
    few: Floats = points[np.sort(kept)]
    return few


def inside_of(clouds: Sequence[Cloud], box: Bounds) -> Cloud:
    """Return the points inside a box, each once."""
    rows = joined(clouds)
    x, y = rows.points[:, :2].T
    rows = rows.select((x > box[0]) & (x < box[2]) & (y > box[1]) & (y < box[3]))
    return rows.select(np.unique(rows.points[:, :2], axis=0, return_index=True)[1])


def corners_of(surface: Surface) -> Cloud:
    """Return the points that faces have."""
    cloud = replace(as_cloud(surface), faces=None, edges=None, metadata={})
    return cloud.select(used_rows(len(cloud), surface.faces))


def joined(clouds: Sequence[Cloud]) -> Cloud:
    """Put the rows of clouds one after the other, with the values that all have."""
    first = clouds[0]
    if len(clouds) == 1:
        return first

    def together(parts: list[Any]) -> Any:
        return None if any(each is None for each in parts) else np.concatenate(parts)

    names = [name for name in first.attributes if all(name in each.attributes for each in clouds)]
    return replace(
        first,
        points=together([each.points for each in clouds]),
        colors=together([each.colors for each in clouds]),
        normals=together([each.normals for each in clouds]),
        attributes={name: together([each.attributes[name] for each in clouds]) for name in names},
    )


class Deviation:
    """How far surfaces are from the faces of a tile, whose sides are listed once."""

    def __init__(self, few: Surface) -> None:
        self._few, self._ends = few, few.vertices[_sides(few.faces)[0]]

    def of(self, source: Surface, box: Bounds) -> float:
        """Return the largest vertical distance of the faces of a surface in a box of the tile."""
        low, high = np.reshape(box, (2, 2))
        rows = corners_of(source).points
        rows = rows[((rows[:, :2] >= low) & (rows[:, :2] <= high)).all(axis=1)]
        at_rows = np.abs(heights_at(self._few, rows[:, :2]) - rows[:, 2])
        one, other = self._ends[:, 0, :2], self._ends[:, 1, :2]
        near = (np.minimum(one, other) <= high) & (np.maximum(one, other) >= low)
        ends = self._ends[near.all(axis=1)]
        pieces = np.ascontiguousarray(ends[:, :, :2].swapaxes(0, 1))
        points, _, side = LineCrossings(source).met(*pieces)
        steps = (ends[:, 1] - ends[:, 0])[side]
        share = np.hypot(*(points[:, :2] - ends[side, 0, :2]).T) / np.hypot(*steps[:, :2].T)
        at_sides = np.abs(points[:, 2] - ends[side, 0, 2] - np.minimum(share, 1) * steps[:, 2])
        return float(np.nanmax(np.concatenate([at_rows, at_sides]), initial=0))


def _sides(faces: Rows) -> tuple[Array, Array]:
    """Return the sides of faces, (k, 2), and how many faces each has."""
    tails, heads = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    keys = pair_keys(np.minimum(tails, heads), np.maximum(tails, heads))
    sides, counts = np.unique(keys, return_counts=True)
    return np.stack(pairs_of_keys(sides), axis=1), counts


def check_filled(part: Surface, box: Bounds) -> None:
    """Raise if faces end inside a box, as at a hole."""
    sides, counts = _sides(part.faces)
    p, q = (part.vertices[sides[counts == 1, k], :2] for k in (0, 1))
    with np.errstate(divide="ignore", invalid="ignore"):  # NaN is of sides along the border
        shares = (np.reshape(box, (2, 1, 2)) - p) / (q - p)
    enters, leaves = shares.min(axis=0).max(axis=1), shares.max(axis=0).min(axis=1)
    is_in = np.minimum(leaves, 1) - np.maximum(enters, 0) > _TOUCHING
    if is_in.any():
        place = (p[is_in][0] / 2 + q[is_in][0] / 2).tolist()
        raise InputError(
            f"the surface does not fill its bounds: near {place} it has a hole, or ends; give "
            f"{Option('bounds')} beside it"
        )


def with_skirt(tile: Simplified, depth: float) -> Cloud:
    """Return a tile with walls that hang from its border, seen from outside."""
    mesh = as_cloud(tile.surface)
    top = np.arange(len(mesh) - tile.n_border, len(mesh), dtype=np.int32)
    lower = mesh.select(top)
    lower = replace(lower, points=lower.points - [0, 0, depth], faces=None, edges=None)
    whole = joined([replace(mesh, edges=None), lower])
    low, a, c = top + np.int32(tile.n_border), top, np.roll(top, -1)
    walls = [np.stack([a, low, c], axis=1), np.stack([c, low, np.roll(low, -1)], axis=1)]
    return replace(whole, faces=np.concatenate([tile.surface.faces, *walls]))
