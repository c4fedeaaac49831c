"""Faces of surfaces and polygons overlaid, and cut where they cross.

The sides of the faces and of the polygons are constraints of one triangulation, which is split
where they cross: a row there is the crossing, rounded once. So each of its triangles is in one face
of each surface or in none, and inside of the polygons or not. What is where follows from the sides
alone: a side divides the face on its left from that on its right, however it was rounded. No
coordinate is compared for it.

A row on a side has its height along the side, any other one that of its face. Of sides that
rounding has brought together, that of the largest face counts. So faces keep their planes, and
borders are the same from whichever side they are cut, bit for bit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Integers, Mask, Progress, Rows
from liftmesh.base.arrays import pair_keys, starts_of_runs, used_rows
from liftmesh.base.frozen import cached_property
from liftmesh.planar.constrained import constrained_delaunay
from liftmesh.planar.constrained_triangulation import (
    ConstrainedTriangulation,
    bits_of,
    with_left,
)
from liftmesh.terrain.measures import planar_areas
from liftmesh.terrain.profile import between
from liftmesh.terrain.sampling import heights_at
from liftmesh.terrain.surface_data import SurfaceData, ordered_corners

if TYPE_CHECKING:
    from liftmesh.vector.polygons import Polygon

_TAILS, _HEADS = [1, 2, 0], [2, 0, 1]  # of the sides opposite the corners
_LARGE = 1e300  # coordinates whose differences may be beyond the doubles


@dataclass(frozen=True, slots=True, eq=False)
class Layer:
    """Faces of a surface, and their sides, between corners in lexicographic order."""

    surface: SurfaceData
    faces: Integers  # which of the simplices
    rows: Rows  # (c,) of the surface
    sides: Rows  # (s, 2) of these, the lesser one first
    owners: Integers  # (s, 2): the face to the left of the way there and back; -1 for none

    @classmethod
    def of(cls, surface: SurfaceData, faces: Integers) -> Layer:
        """Find corners and sides."""
        tri = surface.triangulation
        corners = tri.simplices[faces]
        rows = used_rows(len(tri.points), corners)
        rows = rows[np.lexsort(tri.points[rows].T[::-1])]
        place = np.empty(len(tri.points), dtype=np.int32)
        place[rows] = np.arange(len(rows), dtype=np.int32)
        tails, heads = (place[corners[:, ends]].ravel() for ends in (_TAILS, _HEADS))
        keys, side = np.unique(
            pair_keys(np.minimum(tails, heads), np.maximum(tails, heads)), return_inverse=True
        )
        owners = np.full((len(keys), 2), -1)
        owners[side, (tails > heads).astype(np.intp)] = np.repeat(faces, 3)
        sides = np.stack([keys >> 32, keys & 0xFFFFFFFF], axis=1).astype(np.int32)
        return cls(surface, faces, rows, sides, owners)

    @property
    def points(self) -> Floats:
        """The corners."""
        points: Floats = self.surface.triangulation.points[self.rows]
        return points

    @property
    def key(self) -> tuple[bytes, bytes]:
        """What orders layers: which rows the surface has before does not matter."""
        return self.points.tobytes(), self.sides.tobytes()

    def areas(self, faces: Integers) -> Floats:
        """Return the areas of faces, and 0 for none."""
        tri = self.surface.triangulation
        with np.errstate(all="ignore"):
            corners = tri.points.take(tri.simplices[self.faces], axis=0)
            areas = planar_areas(ordered_corners(corners))
        found = np.zeros(tri.nsimplex + 1)
        found[self.faces] = areas
        return found[faces]


@dataclass(frozen=True, eq=False)
class Overlay:
    """Layers and polygons laid over each other."""

    layers: Sequence[Layer]
    tri: ConstrainedTriangulation  # the whole of it
    inside: Mask  # of each triangle: whether it is inside of the polygons
    first_row: Sequence[int]  # of each layer, and of what comes after them
    first_side: Sequence[int]

    @classmethod
    def of(
        cls,
        layers: Sequence[Layer],
        polygons: list[Polygon] | None = None,
        progress: Progress | None = None,
    ) -> Overlay:
        """Lay them over each other."""
        rows = np.cumsum([0, *(len(each.rows) for each in layers)]).tolist()
        sides = np.cumsum([0, *(len(each.sides) for each in layers)]).tolist()
        edges = [each.sides + np.int32(first) for each, first in zip(layers, rows, strict=False)]
        options: dict[str, Any] = {"progress": progress}
        if polygons is not None:
            options |= {"polygons": polygons, "carve": "holes"}
        tri = constrained_delaunay(
            np.concatenate([each.points for each in layers]),
            np.concatenate(edges),
            crossing="split",
            **options,
        )
        whole = with_left(tri, np.ones(len(tri._whole[0]), dtype=np.bool_))  # noqa: SLF001
        inside = np.arange(whole.nsimplex) < tri.nsimplex
        return cls(layers, whole, inside, rows, sides)

    def faces(self, layer: int) -> Integers:
        """Return the face of a layer that each triangle is in; -1 for none."""
        tri = self.tri
        piece, _, there = self._owned(layer)
        owners = np.full((len(tri.constraints) + 1, 2), -1)  # the last of what is no piece
        for way in (0, 1):
            known = there[:, way] >= 0
            owners[piece[known], way] = there[known, way]
        place = self._place
        is_side: Any = (owners[place] >= 0).any(axis=2)
        is_back = tri.simplices[:, _TAILS] > tri.simplices[:, _HEADS]
        of_side = owners[place, is_back.astype(np.intp)]
        regions = _kernel.label_regions(np.ascontiguousarray(tri.neighbors), bits_of(is_side))
        triangle, k = np.nonzero(is_side)
        ends = tri.points[tri.constraints[place[triangle, k]]] / 2
        lengths = np.abs(ends[:, 1] - ends[:, 0]).max(axis=1)
        found = np.full(int(regions.max()) + 1, -1)
        region, face = _longest(regions[triangle], of_side[triangle, k], lengths)
        found[region] = face
        return found[regions]

    @cached_property
    def _place(self) -> Integers:
        """Which piece each side of a triangle is, (t, 3); -1 for none."""
        tri = self.tri
        tails, heads = tri.simplices[:, _TAILS], tri.simplices[:, _HEADS]
        place = np.full(tails.shape, -1)
        is_piece = tri.is_constrained
        keys = pair_keys(np.minimum(tails, heads)[is_piece], np.maximum(tails, heads)[is_piece])
        place[is_piece] = np.searchsorted(pair_keys(*tri.constraints.T), keys)
        return place

    def _owned(self, layer: int) -> tuple[Integers, Integers, Integers]:
        """Return pieces that are on sides of a layer, these sides, and the faces beside them.

        A face that rounding has left no room is on both sides of a piece, and counts on neither.
        """
        piece, side = self._pieces_of(layer)
        tri, owners = self.tri, self.layers[layer].owners
        turned = _are_turned(
            tri.points[tri.constraints[piece]], tri.points[self._ends(layer, side)]
        )
        there = np.where(turned[:, None], owners[side, ::-1], owners[side])
        several = np.flatnonzero((np.bincount(piece) > 1)[piece])
        keys = pair_keys(piece[several, None], there[several])
        is_shut = np.stack([np.isin(keys[:, k], keys[:, 1 - k]) for k in (0, 1)], axis=1)
        there[several] = np.where(is_shut, -1, there[several])
        return piece, side, there

    def _pieces_of(self, layer: int) -> tuple[Integers, Integers]:
        """Return pieces that are on sides of a layer, and these sides."""
        indptr, members = self.tri.constraint_inputs
        own = (members >= self.first_side[layer]) & (members < self.first_side[layer + 1])
        piece = np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))[own]
        return piece, members[own] - self.first_side[layer]

    def pieces(self, layer: int, keys: Integers) -> Rows:
        """Return what sides of a layer have become that are among some, by keys of their rows."""
        piece, side = self._pieces_of(layer)
        given = self.layers[layer]
        ends = np.sort(given.rows[given.sides], axis=1)
        found: Rows = self.tri.constraints[piece[np.isin(pair_keys(*ends.T), keys)[side]]]
        return found

    def on_polygons(self, sides: Floats) -> list[Floats]:
        """Return the places of rows on each side of the polygons, (k, 2, 2), in order."""
        indptr, members = self.tri.constraint_inputs
        piece = np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))
        own = members >= self.first_side[-1]
        side = np.repeat(members[own] - self.first_side[-1], 2)
        return along_sides(sides, side, self.tri.points[self.tri.constraints[piece[own]].ravel()])

    def _ends(self, layer: int, side: Integers) -> Rows:
        """Return the rows of the ends of sides."""
        ends: Rows = self.layers[layer].sides[side] + np.int32(self.first_row[layer])
        return ends

    def whole_sides(self, layer: int) -> Mask:
        """Tell which sides of a layer are in one piece."""
        piece, side = self._pieces_of(layer)
        ends = np.sort(self._names()[self._ends(layer, side)], axis=1)
        found = np.zeros(len(self.layers[layer].sides), dtype=np.bool_)
        found[side[(self.tri.constraints[piece] == ends).all(axis=1)]] = True
        return found

    def _names(self) -> Rows:
        """Return the row that triangles have at the position of each row."""
        names = np.arange(len(self.tri.points), dtype=np.int32)
        row, kept = self.tri.duplicates.T
        names[row] = kept
        return names

    def rows(self, layer: int) -> Rows:
        """Return the rows of the corners of a layer."""
        first = self.first_row[layer]
        return self._names()[first : first + len(self.layers[layer].rows)]

    def heights(self, layer: int) -> Floats:
        """Return the heights of a layer at all rows; NaN beyond its faces."""
        given, points = self.layers[layer], self.tri.points
        own = given.surface.frame.heights(given.surface.vertices)[given.rows]
        heights = np.full(len(points), np.nan)
        piece, side, there = self._owned(layer)
        order = np.argsort(given.areas(there).max(axis=1), kind="stable")  # the last one counts
        piece, side = piece[order], side[order]
        ends = self._ends(layer, side)
        for k in (0, 1):
            row = self.tri.constraints[piece, k]
            low, high = own[given.sides[side].T]
            heights[row] = along(points[ends], points[row], low, high)
        heights[self.rows(layer)] = own
        rest = np.flatnonzero(np.isnan(heights))
        heights[rest] = heights_at(given.surface, points[rest])
        return heights

    def heights_within(self, layer: int, faces: Integers) -> Floats:
        """Return the same, and heights of rows that rounding has moved out of faces they are in."""
        heights, given, rows = self.heights(layer), self.layers[layer].surface, self.tri.simplices
        is_open = np.isnan(heights)[rows] & (faces >= 0)[:, None]
        triangle, k = np.nonzero(is_open)
        if not len(triangle):
            return heights
        order = np.argsort(self.layers[layer].areas(faces[triangle]), kind="stable")
        row, face = rows[triangle, k][order], faces[triangle][order]  # the largest one counts
        corners = given.triangulation.simplices[face]
        to = given.triangulation.points[corners] - self.tri.points[row][:, None]
        turns = np.stack([_turn(to[:, i], to[:, j]) for i, j in ((1, 2), (2, 0), (0, 1))], axis=1)
        weights = np.maximum(turns, 0) + np.finfo(np.float64).tiny
        weights /= weights.sum(axis=1, keepdims=True)
        heights[row] = (weights * given.frame.heights(given.vertices)[corners]).sum(axis=1)
        return heights


def _longest(regions: Array, faces: Integers, lengths: Floats) -> tuple[Integers, Integers]:
    """Return regions, and the face that most of the border of each has, by length.

    All of it has, but for what rounding has folded back.
    """
    keys, group = np.unique(pair_keys(regions, faces + 1), return_inverse=True)
    order = np.lexsort([np.bincount(group, lengths), keys >> 32])
    region, face = keys[order] >> 32, (keys[order] & 0xFFFFFFFF) - 1
    is_last = np.append(region[1:] != region[:-1], np.ones(min(len(region), 1), dtype=np.bool_))
    return region[is_last], face[is_last]


def _are_turned(pieces: Floats, sides: Floats) -> Mask:
    """Tell which pieces, (k, 2, 2), run against the sides that they are of, but for rounding."""
    steps = pieces[:, 1] / 2 - pieces[:, 0] / 2
    ways = sides[:, 1] / 2 - sides[:, 0] / 2
    is_steep = np.abs(ways[:, 1]) > np.abs(ways[:, 0])
    steps[is_steep], ways[is_steep] = steps[is_steep, ::-1], ways[is_steep, ::-1]
    axis = np.where(steps[:, 0] == 0, 1, 0)  # the longer one, unless both ends are rounded to one
    rows = np.arange(len(steps))
    turned: Mask = (steps[rows, axis] > 0) != (ways[rows, axis] > 0)
    return turned


def _turn(one: Floats, two: Floats) -> Floats:
    found: Floats = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
    return found


def along_sides(sides: Floats, side: Integers, places: Floats) -> list[Floats]:
    """Return the places on each side, between its ends, in order and each once."""
    is_inner = (places[:, None] != sides[side]).any(axis=2).all(axis=1)
    side, places = side[is_inner], places[is_inner]
    steps = sides[side, 1] / 2 - sides[side, 0] / 2
    is_steep = np.abs(steps[:, 1]) > np.abs(steps[:, 0])
    ahead = places * np.where(steps < 0, -1, 1)
    ahead[is_steep] = ahead[is_steep, ::-1]
    order = np.lexsort([ahead[:, 1], ahead[:, 0], side])
    side, places = side[order], places[order]
    first = starts_of_runs(np.column_stack([side, places]))
    side, places = side[first], places[first]
    return np.split(places, np.searchsorted(side, np.arange(1, len(sides))))


def along(ends: Floats, places: Floats, low: Floats, high: Floats) -> Floats:
    """Interpolate between the ends of sides, (k, 2, 2), at places on them."""
    scale = np.where(np.abs(ends).max(axis=(1, 2)) > _LARGE, 0.5, 1.0)[:, None]
    tails, heads = ends[:, 0] * scale, ends[:, 1] * scale
    steps = heads - tails
    axis = np.abs(steps).argmax(axis=1)[:, None]
    ahead, whole = (
        np.take_along_axis(each, axis, axis=1)[:, 0] for each in (places * scale - tails, steps)
    )
    return between(low, high, np.clip(ahead / whole, 0, 1))
