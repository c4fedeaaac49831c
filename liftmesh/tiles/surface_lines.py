"""Contours of tiled surfaces: line for line those of `Surface.contours`.

A level crosses a face by one side and leaves it by another. Such steps are collected from one shard
after the other; sides, named by the rows of their ends, join them to lines, also across shards.
Memory is that of the lines, some 200 bytes a point, whatever the number of faces. The rules for the
point on a side, and for the first point and the order of lines, are those of the kernel
(`_core/surface/contours.hpp`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats, Integers, Progress
from liftmesh.base.options import check_progress, part_of
from liftmesh.terrain.contours import Contours, wanted_levels
from liftmesh.terrain.crossings import LevelLines, check_tolerance, crossings, smoothed
from liftmesh.terrain.filled import FilledContours, fill
from liftmesh.tiles.tiled_data import TiledSurfaceData, box_of, faces_of, vertices_of

_BLOCK = 1 << 18  # triangles that are looked at at once


def contour_lines(
    tiled: TiledSurfaceData,
    levels: ArrayLike | None,
    interval: float | None,
    contour_base: float,
    index_every: int,
    smooth: float | None = None,
) -> Contours:
    """Compute lines of equal height, reading one shard after the other."""
    low, high = map(Fraction, box_of(tiled)[2::3])
    wanted, is_index = wanted_levels(
        levels, interval, contour_base, index_every, lambda: (low, high)
    )
    if smooth is not None:
        check_tolerance(smooth, wanted)
    lines = _lines(_Steps.of(tiled, wanted))
    starts = np.cumsum([0, *(len(line.points) for line in lines)], dtype=np.int64)
    places = np.array([line.level for line in lines], dtype=np.int64)
    points = np.concatenate([np.empty((0, 2)), *(line.points for line in lines)])
    closed = np.array([line.is_closed for line in lines], dtype=np.bool_)
    if smooth is not None:
        sides = _crossed_sides(tiled, wanted)
        points = smoothed(LevelLines(points, starts, closed, places), sides, wanted, smooth)
    return Contours(points, starts, wanted[places], closed, is_index[places], tiled.crs)


def _crossed_sides(tiled: TiledSurfaceData, levels: Floats) -> Floats:
    """Return the ends of the sides that levels cross, (m, 2, 3), each side once."""
    names, ends = [np.empty((0, 2), dtype=np.int64)], [np.empty((0, 2, 3))]
    for rows, corners in _blocks(tiled):
        for pair in ([0, 1], [1, 2], [2, 0]):
            heights = np.sort(corners[:, pair, 2], axis=1)
            low, high = np.searchsorted(levels, heights, side="right").T
            names.append(np.sort(rows[low < high][:, pair], axis=1))
            ends.append(corners[low < high][:, pair])
    first = np.unique(np.concatenate(names), axis=0, return_index=True)[1]
    found: Floats = np.concatenate(ends)[first]
    return found


def _blocks(tiled: TiledSurfaceData) -> Iterator[tuple[Integers, Floats]]:
    """Yield the rows of the corners of some faces, (m, 3), and where these are, (m, 3, 3)."""
    for vertices, faces in zip(vertices_of(tiled), faces_of(tiled), strict=True):
        rows = np.ascontiguousarray(vertices["row"])
        corners = np.stack([vertices[name] for name in ("x", "y", "z")], axis=1) + 0.0
        for begin in range(0, len(faces), _BLOCK):
            block = np.array(faces[begin : begin + _BLOCK])
            yield rows[block], corners[block]


def filled_contours(
    tiled: TiledSurfaceData,
    levels: ArrayLike | None,
    interval: float | None,
    contour_base: float,
    progress: Progress | None = None,
) -> FilledContours:
    """Compute the parts of the plane between levels, from the lines and the hull."""
    check_progress(progress)
    low, high = map(Fraction, box_of(tiled)[2::3])
    wanted, _ = wanted_levels(levels, interval, contour_base, 1, lambda: (low, high))
    lines = contour_lines(tiled, wanted, None, contour_base, 1)
    return fill(lines, _rim(tiled), wanted, (low, high), part_of(progress, 0.5, 1.0))


def _rim(tiled: TiledSurfaceData) -> Floats:
    """Return the sides of the hull, (h, 2, 3)."""
    hull = np.asarray(tiled.convex_hull)
    order = np.argsort(hull)
    corners = np.empty((len(hull), 3))
    for vertices in vertices_of(tiled):
        place = np.minimum(np.searchsorted(hull[order], vertices["row"]), len(hull) - 1)
        found = hull[order[place]] == vertices["row"]
        some = [vertices[name][found] for name in ("x", "y", "z")]
        corners[order[place[found]]] = np.stack(some, axis=1) + 0.0
    return np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)


@dataclass(frozen=True)
class _Steps:
    """Faces that levels cross: the sides where they enter and leave."""

    levels: Integers
    sides: Integers
    points: Floats

    @classmethod
    def of(cls, tiled: TiledSurfaceData, levels: Floats) -> _Steps:
        steps = [cls(np.empty(0, np.int64), np.empty((0, 2, 2), np.int64), np.empty((0, 2, 2)))]
        steps += _steps_of_shards(tiled, levels)
        parts = zip(*((each.levels, each.sides, each.points) for each in steps), strict=True)
        return cls(*(np.concatenate(part) for part in parts))


def _steps_of_shards(tiled: TiledSurfaceData, levels: Floats) -> Iterator[_Steps]:
    for rows, corners in _blocks(tiled):
        yield _steps(rows, corners, levels)


def _steps(triangles: Integers, corners: Floats, levels: Floats) -> _Steps:
    """Find the steps of all levels through some faces, given the corners of each."""
    heights = corners[:, :, 2]
    first = np.searchsorted(levels, heights.min(axis=1), side="right")
    end = np.searchsorted(levels, heights.max(axis=1), side="right")
    counts = np.maximum(end - first, 0)
    face = np.repeat(np.arange(len(triangles)), counts)
    level = np.arange(len(face)) - np.repeat(np.cumsum(counts) - counts - first, counts)
    above = heights[face] >= levels[level][:, None]
    alone = np.where(above[:, 1] == above[:, 2], 0, np.where(above[:, 0] == above[:, 2], 1, 2))
    is_above = above[np.arange(len(face)), alone]
    one, other = (alone + 1) % 3, (alone + 2) % 3
    opposite = np.where(is_above[:, None], np.stack([other, one], 1), np.stack([one, other], 1))
    ends = np.stack([(opposite + 1) % 3, (opposite + 2) % 3], axis=2)
    sides = np.sort(triangles[face[:, None, None], ends], axis=2)
    points = crossings(corners[face[:, None, None], ends], levels[level][:, None])
    return _Steps(level, sides, points)


@dataclass(frozen=True)
class _Line:
    level: int
    points: Floats
    is_closed: bool


def _lines(steps: _Steps) -> list[_Line]:
    """Join steps to lines, by level and then in lexicographic order."""
    follows, levels, points = _joined(steps)
    lines = []
    for nodes, is_closed in _chains(follows):
        line = points[nodes]
        is_new = np.r_[True, (line[1:] != line[:-1]).any(axis=1)]
        line = line[is_new]
        if is_closed:
            line = _from_least(line)
        if len(line) > 1:
            lines.append(_Line(int(levels[nodes[0]]), line, is_closed))
    return sorted(lines, key=lambda line: (line.level, _Sequence(line.points)))


class _Sequence:
    """Compares lines point by point; most differ in the first."""

    __slots__ = ("first", "points")

    def __init__(self, points: Floats) -> None:
        self.points = points
        self.first = tuple(points[0].tolist())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Sequence) and np.array_equal(self.points, other.points)

    __hash__ = None  # type: ignore[assignment]

    def __lt__(self, other: _Sequence) -> bool:
        if self.first != other.first:
            return self.first < other.first
        return bool(self.points.tolist() < other.points.tolist())


def _from_least(line: Floats) -> Floats:
    """Let a closed line begin and end at its least point, by x, then y, then the next point."""
    if len(line) > 1 and (line[0] == line[-1]).all():
        line = line[:-1]
    following = np.roll(line, -1, axis=0)
    least = np.lexsort((following[:, 1], following[:, 0], line[:, 1], line[:, 0]))[0]
    line = np.roll(line, -least, axis=0)
    return np.concatenate((line, line[:1])) if len(line) > 1 else line


def _joined(steps: _Steps) -> tuple[Integers, Integers, Floats]:
    """Number the crossings; return the next of each, or itself, and their levels and points."""
    count = len(steps.levels)
    level = np.concatenate((steps.levels, steps.levels))
    a, b = np.concatenate((steps.sides[:, 0], steps.sides[:, 1])).T
    order = np.lexsort((b, a, level))
    level, a, b = level[order], a[order], b[order]
    is_new = np.ones(2 * count, dtype=np.bool_)
    is_new[1:] = (level[1:] != level[:-1]) | (a[1:] != a[:-1]) | (b[1:] != b[:-1])
    number = np.empty(2 * count, dtype=np.int64)
    number[order] = np.cumsum(is_new) - 1
    first = order[is_new]
    points = np.concatenate((steps.points[:, 0], steps.points[:, 1]))[first]
    follows = np.arange(len(first))
    follows[number[:count]] = number[count:]
    return follows, level[is_new], points


def _chains(follows: Integers) -> Iterator[tuple[Integers, bool]]:
    """Yield the chains of a list of successors, and whether they are closed."""
    count = len(follows)
    if count == 0:
        return
    rounds = count.bit_length()
    ends, least = follows, np.arange(count)
    for _ in range(rounds):
        least = np.minimum(least, least[ends])
        ends = ends[ends]
    is_closed = follows[ends] != ends
    follows = np.where(is_closed & (follows == least), np.arange(count), follows)  # cut before it
    left = (follows != np.arange(count)).astype(np.int64)
    ends = follows
    for _ in range(rounds):
        left = left + left[ends]
        ends = ends[ends]
    order = np.lexsort((-left, ends))
    begins = np.flatnonzero(np.r_[True, ends[order][1:] != ends[order][:-1]])
    for begin, end in zip(begins, np.r_[begins[1:], count], strict=True):
        nodes = order[begin:end]
        yield nodes, bool(is_closed[nodes[0]])
