"""Where levels cross the sides of faces; contours smoothed within a tolerance of height.

A contour passes each face along one segment, from a point on one side to a point on another. Every
point is moved along its own side, where heights are linear: to where they differ from the level by
the tolerance, and half the way to an end of the side, at most. So a segment stays in its face, and
heights along it, which are linear, too, stay within the tolerance: no line leaves it. Those of two
levels do not meet, as the tolerance is less than half of their distance. Those of one level do not
meet, either: their segments are in different faces, and their points inside different sides. All
this holds up to the rounding of coordinates, as for contours themselves.

Within these bounds each point comes near to where it was between its neighbours, but on the line
through these: so straight lines stay, and bends are spread over more points, round by round.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftmesh._typing import Floats, Integers, Mask
from liftmesh.base.options import as_positive
from liftmesh.errors import InputError, Option

_ROUNDS = 12


@dataclass(frozen=True)
class LevelLines:
    """Contours, with the place of the level of each."""

    points: Floats
    starts: Integers
    closed: Mask
    levels: Integers

    @property
    def rings(self) -> tuple[Integers, Integers]:
        """The first and the last points of closed lines, which are the same."""
        return self.starts[:-1][self.closed], self.starts[1:][self.closed] - 1


def crossings(ends: Floats, levels: Floats) -> Floats:
    """Compute where levels cross sides, (..., 2, 3), with the bits that the kernel has."""
    u, v = ends[..., 0, :], ends[..., 1, :]
    is_swapped = (v[..., 0] < u[..., 0]) | ((v[..., 0] == u[..., 0]) & (v[..., 1] < u[..., 1]))
    u, v = (np.where(is_swapped[..., None], *pair) for pair in ((v, u), (u, v)))
    low, high = u[..., 2], v[..., 2]
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        share = (levels - low) / (high - low)
        halved = (levels / 2 - low / 2) / (high / 2 - low / 2)
        share = np.where(np.isfinite(high - low), share, halved)
        points = np.stack([_between(u[..., k], v[..., k], share) for k in (0, 1)], axis=-1)
    points = np.where((high == levels)[..., None], v[..., :2], points)
    result: Floats = np.where((low == levels)[..., None], u[..., :2], points)
    return result


def _between(begin: Floats, end: Floats, share: Floats) -> Floats:
    at = begin + share * (end - begin)
    at = np.where(np.isfinite(at), at, (begin / 2 + share * (end / 2 - begin / 2)) * 2)
    kept: Floats = np.clip(at, np.minimum(begin, end), np.maximum(begin, end)) + 0.0
    return kept


def check_tolerance(tolerance: float, levels: Floats) -> None:
    """Raise if contours that are smoothed so could cross."""
    most = as_positive("smooth", tolerance, "a positive height")
    gap = float(np.diff(levels).min(initial=np.inf))
    if not most < gap / 2:
        raise InputError(
            f"{Option('smooth', most)} is not below half of {gap!r}, the least distance of "
            "levels, so lines could cross: give a smaller one"
        )


def smoothed(lines: LevelLines, sides: Floats, levels: Floats, tolerance: float) -> Floats:
    """Return other points of contours, given all sides of the faces, (m, 2, 3)."""
    points = _relaxed(lines, _ways_of(lines, sides, levels, tolerance))
    while (is_same := _repeated(points, lines)).any():  # by rounding
        points = np.where(is_same[:, None], lines.points, points)
    return points


def _ways_of(lines: LevelLines, sides: Floats, levels: Floats, most: float) -> Floats:
    """Find the part of a side on which each point may be, (n, 2, 2); of length 0 if it stays.

    Those stay at which a level crosses several sides: vertices, mostly.
    """
    side, level = _crossed(sides, levels)
    places = crossings(sides[side], levels[level])
    own = np.repeat(lines.levels, np.diff(lines.starts))
    at = _only(np.concatenate([places, lines.points]), np.concatenate([level, own]), len(side))
    ways = np.stack([lines.points, lines.points], axis=1)
    moved = np.flatnonzero(at >= 0)
    found, height = sides[side[at[moved]]], levels[level[at[moved]]]
    least, greatest = found[..., 2].min(axis=1), found[..., 2].max(axis=1)
    ways[moved, 0] = crossings(found, np.maximum(height - most, height / 2 + least / 2))
    ways[moved, 1] = crossings(found, np.minimum(height + most, height / 2 + greatest / 2))
    return ways


def _crossed(sides: Floats, levels: Floats) -> tuple[Integers, Integers]:
    """List the sides that levels cross, and the level of each crossing."""
    heights = sides[..., 2]
    first = np.searchsorted(levels, heights.min(axis=1), side="right")
    counts = np.searchsorted(levels, heights.max(axis=1), side="right") - first
    side = np.repeat(np.arange(len(sides)), counts)
    return side, np.arange(len(side)) - np.repeat(np.cumsum(counts) - counts - first, counts)


def _only(points: Floats, level: Integers, count: int) -> Integers:
    """Find the only one of the first points that is where each later one is, or -1."""
    order = np.lexsort((points[:, 1], points[:, 0], level))
    step = np.ones(len(order), dtype=np.bool_)
    step[1:] = (points[order[1:]] != points[order[:-1]]).any(axis=1)
    step[1:] |= level[order[1:]] != level[order[:-1]]
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.cumsum(step) - 1
    crossing = np.full(place.max(initial=0) + 1, -1)
    crossing[place[:count]] = np.arange(count)
    crossing[np.bincount(place[:count], minlength=len(crossing)) != 1] = -1
    return crossing[place[count:]]


@dataclass(frozen=True)
class _Thread:
    """Points of lines, those before and after, and where between these they were, as shares."""

    points: Integers
    before: Integers
    after: Integers
    shares: Floats

    @classmethod
    def of(cls, lines: LevelLines, remainder: int) -> _Thread:
        """Take every second point of each line, but no end of an open one."""
        starts, ends = lines.starts[:-1], lines.starts[1:] - 1
        place = np.arange(len(lines.points))
        before, after = place - 1, place + 1
        before[starts] = ends - 1
        is_inner = np.ones(len(place), dtype=np.bool_)
        is_inner[ends] = False
        is_inner[starts[~lines.closed]] = False
        is_inner &= (place - np.repeat(starts, np.diff(lines.starts))) % 2 == remainder
        points, before, after = place[is_inner], before[is_inner], after[is_inner]
        one, other = (
            np.hypot(*(lines.points[points] - lines.points[each]).T) for each in (before, after)
        )
        return cls(points, before, after, one / (one + other))


def _relaxed(lines: LevelLines, ways: Floats) -> Floats:
    """Bring points near to the line between their neighbours, again and again."""
    points = lines.points.copy()
    starts, ends = lines.rings
    with np.errstate(all="ignore"):  # a point stays where the numbers are too large or too small
        threads = [_Thread.of(lines, remainder) for remainder in (0, 1)]
        for thread in threads * _ROUNDS:
            begin, end = ways[thread.points, 0], ways[thread.points, 1]
            before, after = points[thread.before], points[thread.after]
            wanted = before + thread.shares[:, None] * (after - before)
            along = end - begin
            share = ((wanted - begin) * along).sum(axis=1) / (along**2).sum(axis=1)
            moved = begin + np.clip(share, 0, 1)[:, None] * along
            moved = np.clip(moved, np.minimum(begin, end), np.maximum(begin, end))
            is_known = np.isfinite(moved).all(axis=1)[:, None]
            points[thread.points] = np.where(is_known, moved, points[thread.points])
            points[ends] = points[starts]
    return np.asarray(points + 0.0)


def _repeated(points: Floats, lines: LevelLines) -> Mask:
    """Find the points that have moved and are where the one before or after is."""
    is_same = (points[1:] == points[:-1]).all(axis=1)
    is_same[lines.starts[1:-1] - 1] = False  # of two lines
    result = np.zeros(len(points), dtype=np.bool_)
    result[1:] |= is_same
    result[:-1] |= is_same
    starts, ends = lines.rings
    result[starts] = result[ends] = result[starts] | result[ends]
    return np.asarray(result & (points != lines.points).any(axis=1))
