"""The sides of the cells of disks: between which disks each one runs, and from where to where.

A side is an arc of a hyperbola (`apollonius_arcs.py`). It ends where three cells meet, in the
centre of the circle that touches their disks, or not at all.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from liftmesh._typing import Floats, Indices, Integers, Rows
from liftmesh.base.options import shown
from liftmesh.disks.arcs import Arcs, Box, TooManyPointsError
from liftmesh.disks.vertices import differences_of, vertices_of
from liftmesh.errors import InputError

if TYPE_CHECKING:
    from liftmesh.disks.graph import ApolloniusGraph

_COINCIDENT = 2.0**-44  # of the numbers involved: what rounding may put between equal vertices


class Sides(NamedTuple):
    """The sides of all cells."""

    pairs: Rows
    ends: Rows


def sides(simplices: Rows, neighbors: Rows, hull: Rows) -> Sides:
    """List the sides of all cells."""
    left = np.repeat(np.arange(len(simplices)), 3)
    right = neighbors.reshape(-1)
    edges = simplices[:, [1, 2, 2, 0, 0, 1]].reshape(-1, 2)
    once = right < left
    bare = _named(hull)[~np.isin(_named(hull), _named(edges[right < 0]))]
    lines = np.stack([bare >> 32, bare & 0xFFFFFFFF], axis=1)
    lines = lines[lines[:, 0] < lines[:, 1]]
    ends = np.stack([left, right], axis=1)[once]
    return Sides(
        np.concatenate([edges[once], lines]).astype(np.int32),
        np.concatenate([ends, np.full((len(lines), 2), -1)]).astype(np.int32),
    )


def _named(pairs: Rows) -> Integers:
    named: Integers = pairs[:, 0].astype(np.int64) << 32 | pairs[:, 1].astype(np.int64)
    return named


def arcs_of(found: Sides, disks: Floats, vertices: Floats) -> Arcs:
    """Describe sides as arcs."""
    is_turned = disks[found.pairs[:, 1], 2] < disks[found.pairs[:, 0], 2]
    rows = np.where(is_turned[:, None], found.pairs[:, ::-1], found.pairs)
    # Counter-clockwise about the first disk, a side starts at the triangle on its right.
    ends = np.where(is_turned[:, None], found.ends, found.ends[:, ::-1])
    near, far = rows.T
    relative, power = differences_of(disks, far, near)
    focus, axis, difference = disks[near, :2], relative[:, :2], relative[:, 2]
    turns = np.full((len(near), 2), (-np.pi, np.pi))
    for k in range(2):
        has_end = ends[:, k] >= 0
        step = vertices[ends[has_end, k]] - focus[has_end]
        along = axis[has_end]
        cross, dot = along[:, 0] * step[:, 1] - along[:, 1] * step[:, 0], (along * step).sum(1)
        turns[has_end, k] = np.arctan2(cross, dot)
    return Arcs(rows, ends, focus, axis, difference, power, turns)


def coinciding(found: Sides, centers: Floats, vertices: Floats) -> Floats:
    """Give one position to vertices that only rounding keeps apart."""
    bounded = (found.ends >= 0).all(axis=1)
    one, other = found.ends[bounded].T
    near = centers[found.pairs[bounded, 0]]
    size = np.abs(near).max(axis=1) + np.abs(vertices[one] - near).max(axis=1)
    apart = np.abs(vertices[one] - vertices[other]).max(axis=1)
    equal = apart <= _COINCIDENT * size
    place = _first_of(len(vertices), one[equal], other[equal])
    merged: Floats = vertices[place]
    return merged


def _first_of(count: int, one: Rows, other: Rows) -> Indices:
    """Name each of so many things after the first of those that pairs connect it with."""
    first = np.arange(count)
    while True:
        least = np.minimum(first[one], first[other])
        named = first.copy()
        np.minimum.at(named, one, least)
        np.minimum.at(named, other, least)
        named = named[named]
        if np.array_equal(named, first):
            return first
        first = named


class Traced(NamedTuple):
    """The sides of all cells that come near a box, as polylines."""

    rows: Rows
    ends: Rows
    starts: Integers
    points: Floats
    box: Box

    @property
    def segments(self) -> Indices:
        """The points from which a segment leads to the next one, (s,) intp."""
        is_start = np.ones(len(self.points), dtype=np.bool_)
        is_start[self.starts[1:] - 1] = False
        return np.flatnonzero(is_start)


def traced(graph: ApolloniusGraph, box: Box, tolerance: float) -> Traced:
    """Follow the sides of all cells as far as a box sees them."""
    largest = max(np.abs(graph.centers).max(initial=0), graph.radii.max(initial=0), *map(abs, box))
    scale = int(np.frexp(largest)[1])  # no square overflows, and no product of such underflows

    def scaled(values: Floats) -> Floats:
        return np.ldexp(values, -scale)

    disks = scaled(np.column_stack([graph.centers, graph.radii]))
    found = sides(graph.simplices, graph.neighbors, graph.convex_hull)
    vertices = vertices_of(disks, graph.simplices, scaled(graph.circles))
    vertices = coinciding(found, disks[:, :2], vertices)
    left, low, right, high = scaled(np.array(box)).tolist()
    limits = left, low, right, high
    arcs = arcs_of(found, disks, vertices).near(limits)
    try:
        starts, points = arcs.polylines(vertices, limits, float(np.ldexp(tolerance, -scale)))
    except TooManyPointsError as error:
        (most,) = error.args
        raise InputError(
            f"tolerance is {shown(tolerance)}, by which arcs have more than {most:,} points: give "
            "a larger one"
        ) from error
    return Traced(arcs.rows, arcs.ends, starts, np.ldexp(points, scale), box)


def pieces_in(found: Traced) -> Iterator[tuple[tuple[int, int], Floats]]:
    """Cut off what of polylines is outside of their box."""
    first = found.segments
    start, end = found.points[first], found.points[first + 1]
    low, high = shares_in(start, end, found.box)
    left = np.flatnonzero(low < high)
    if not len(left):
        return
    first, low, high = first[left], low[left], high[left]
    start, end = start[left], end[left]
    step = end - start
    start, end = (
        np.where(share[:, None] == whole, at, start + share[:, None] * step)
        for share, whole, at in ((low, 0.0, start), (high, 1.0, end))
    )
    side = (np.searchsorted(found.starts, first, side="right") - 1).tolist()
    goes_on = (np.diff(first) == 1) & (np.diff(side) == 0) & (high[:-1] == 1) & (low[1:] == 0)
    bounds = np.flatnonzero(np.concatenate([[True], ~goes_on, [True]]))
    pairs = np.sort(found.rows, axis=1).tolist()
    for one, next_one in zip(bounds[:-1].tolist(), bounds[1:].tolist(), strict=True):
        a, b = pairs[side[one]]
        yield (a, b), np.concatenate([start[one:next_one], end[next_one - 1 : next_one]])


def shares_in(start: Floats, end: Floats, box: Box) -> tuple[Floats, Floats]:
    """Return from which to which share of each segment it is in a box (Liang and Barsky)."""
    first, last = np.zeros(len(start)), np.ones(len(start))
    step = end - start
    for axis in range(2):
        low, high = box[axis] - start[:, axis], box[axis + 2] - start[:, axis]
        with np.errstate(all="ignore"):
            enter, leave = np.sort([low / step[:, axis], high / step[:, axis]], axis=0)
        is_level = step[:, axis] == 0
        is_apart = is_level & ((low > 0) | (high < 0))
        first = np.where(is_level, first, np.maximum(first, enter))
        last = np.where(is_level, np.where(is_apart, -1, last), np.minimum(last, leave))
    return first, last
