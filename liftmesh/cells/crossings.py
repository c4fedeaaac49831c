"""Exact crossings of polylines with a domain; which cell contains a ring that nothing crosses.

The domain counts as moved by (e, e^2), with e positive and infinitesimal. So no corner of it lies
on a polyline, no point of a polyline on an edge, and no edge along a segment: every sign is 1 or
-1. Where it is 0 without the move, that of the first term in e decides.

At a crossing, the share of a segment, and that of an edge, is a quotient whose divisor the move
leaves alone. So it is (q0, q1, q2), for q0 + q1 e + q2 e^2, and the order along a segment or an
edge is that of these triples.

A ring of the domain that no polyline crosses is in one cell. From a place on the ring one goes
straight to a segment of a polyline. The first segment on the way has the ring on one of its sides,
and the cell of that side is the one. Where the way meets a point of a polyline, it could be that of
several segments: another way is tried.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Floats, Indices, Mask, Rows
from liftmesh.base.frozen import cached_property
from liftmesh.cells.rings import Exact, as_exact, between, turn
from liftmesh.disks.sides import Traced, shares_in
from liftmesh.optional import load
from liftmesh.predicates import orient2d

if TYPE_CHECKING:
    from liftmesh.cells.domain import Domain


_FEW = 16  # edges of a domain that need no index
_ROUNDING = 2.0**-49  # of a product, in what a determinant may be off
_VAGUE = 2.0**-30  # what the share of an edge may be off before it is computed exactly
Signs = NDArray[np.int8]
Share = tuple[Fraction, Fraction, Fraction]


class Crossings(NamedTuple):
    """Where segments cross edges, in the order along the segments."""

    segment: Indices
    edge: Rows  # of the domain
    enters: Mask  # whether the segment comes into the domain there
    from_left: Mask  # whether the edge comes from the left side of the segment
    points: Floats  # rounded
    along_edges: Indices  # the crossings by edge, and in the order along these
    # (t, 4): a corner or an edge of the domain, the other being -1, and the segment twice, where
    # nothing but the move decided: see `resolve_ties`.
    ties: Indices


def crossings(start: Floats, end: Floats, domain: Domain) -> Crossings:
    """Find all crossings of segments with the edges of a domain."""
    first, last = domain.corners, domain.corners[domain.following]
    segment, edge = _near(start, end, first, last)
    a, b, u, v = start[segment], end[segment], first[edge], last[edge]
    along = v - u, b - a
    of_ends = [orient2d(u, v, each) for each in (a, b)]
    of_edge = [orient2d(a, b, each) for each in (u, v)]
    ties = _ties(segment, edge, of_ends, of_edge, domain)
    of_ends = [_moved(sign, -along[0]) for sign in of_ends]
    of_edge = [_moved(sign, along[1]) for sign in of_edge]
    crosses = (of_ends[0] != of_ends[1]) & (of_edge[0] != of_edge[1])
    segment, edge = segment[crosses], edge[crosses].astype(np.int32)
    a, b, u, v = start[segment], end[segment], first[edge], last[edge]
    order = _ordered(segment, _Shares(u, v, a, b, -1))
    of_edges = _Shares(a, b, u, v, 1)
    along_edges = _ordered(edge, of_edges)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    points = of_edges.points()
    return Crossings(
        segment[order],
        edge[order],
        (of_ends[0][crosses] < 0)[order],
        (of_edge[0][crosses] > 0)[order],
        points[order],
        rank[along_edges],
        ties,
    )


def lies_inside(points: Floats, domain: Domain) -> Mask:
    """Tell which points are inside a domain, as if it was moved."""
    first, last = domain.corners, domain.corners[domain.following]
    right = np.stack([np.full(len(points), first[:, 0].max()), points[:, 1]], axis=1)
    point, edge = _near(points, np.maximum(points, right), first, last)
    u, v, a = first[edge], last[edge], points[point]
    side = _moved(orient2d(u, v, a), u - v)
    rises = (u[:, 1] < a[:, 1]) & (v[:, 1] >= a[:, 1]) & (side > 0)
    falls = (v[:, 1] < a[:, 1]) & (u[:, 1] >= a[:, 1]) & (side < 0)
    winding = np.bincount(point, rises.astype(np.int8) - falls, minlength=len(points))
    inside: Mask = winding > 0
    return inside


def _near(start: Floats, end: Floats, first: Floats, last: Floats) -> tuple[Indices, Indices]:
    """Return the pairs of segments and edges whose boxes meet."""
    low, high = np.minimum(start, end), np.maximum(start, end)
    least, most = np.minimum(first, last), np.maximum(first, last)
    if len(first) > _FEW:
        seen = np.flatnonzero(
            (high >= least.min(axis=0)).all(axis=1) & (low <= most.max(axis=0)).all(axis=1)
        )
        shapely = load("shapely", extra="shapes")
        tree = shapely.STRtree(shapely.box(*least.T, *most.T))
        segment, edge = tree.query(shapely.box(*low[seen].T, *high[seen].T))
        return seen[segment], edge
    by_edge = [
        np.flatnonzero((high >= least[k]).all(axis=1) & (low <= most[k]).all(axis=1))
        for k in range(len(first))
    ]
    edges = np.repeat(np.arange(len(first)), [len(each) for each in by_edge])
    return np.concatenate(by_edge), edges


def _moved(sign: Signs, along: Floats) -> Signs:
    """Decide the signs that are 0: those of orient(p, p + along, u) once u is moved."""
    x, y = along.T
    return np.where(sign != 0, sign, np.where(y != 0, -np.sign(y), np.sign(x))).astype(np.int8)


def _ties(
    segment: Indices, edge: Indices, of_ends: list[Signs], of_edge: list[Signs], domain: Domain
) -> Indices:
    """List corners on the lines of segments, and edges on whose lines segments end."""
    on_edge = (of_ends[0] == 0) | (of_ends[1] == 0)
    corner_on = of_edge[0] == 0, of_edge[1] == 0
    of_segments = [segment[on] for on in (on_edge, *corner_on)]
    edges = edge[on_edge], *(np.full(np.count_nonzero(on), -1) for on in corner_on)
    corners = np.full(len(edges[0]), -1), edge[corner_on[0]], domain.following[edge[corner_on[1]]]
    named = np.concatenate(of_segments)
    rows = np.stack([np.concatenate(corners), np.concatenate(edges), named, named], axis=1)
    ties: Indices = np.unique(rows, axis=0)
    return ties


def _ordered(group: NDArray[np.integer], shares: _Shares) -> Indices:
    """Order crossings by group, then by share: by exact ones where these may be equal."""
    value, error = shares.rounded
    order = np.lexsort((value - error, group))
    low, high, of = (value - error)[order], (value + error)[order], group[order]
    starts = np.flatnonzero(np.concatenate([[True], of[1:] != of[:-1]])) if len(of) else of
    bounds = [*starts.tolist(), len(order)]
    for first, last in pairwise(bounds):
        if last - first < 2:
            continue
        reached = np.maximum.accumulate(high[first : last - 1])
        apart = np.flatnonzero(low[first + 1 : last] > reached) + 1
        pieces = [first, *(first + apart).tolist(), last]
        for begin, stop in pairwise(pieces):
            if stop - begin > 1:
                order[begin:stop] = sorted(order[begin:stop].tolist(), key=shares.exact)
    return order


@dataclass(frozen=True, eq=False)
class _Shares:
    """Which shares of the ways from r to s are before the lines of p and q."""

    p: Floats
    q: Floats
    r: Floats
    s: Floats
    moved: int  # 1 if the ways are edges of the domain, or else -1

    @cached_property
    def rounded(self) -> tuple[Floats, Floats]:
        """The shares, and what they may be off."""
        with np.errstate(all="ignore"):
            (x, y), (u, v) = (self.q - self.p).T, (self.s - self.r).T
            across = (self.r - self.p).T
            first, second = x * across[1], y * across[0]
            divisor, terms = x * v - y * u, np.abs(x * v) + np.abs(y * u)
            value = (second - first) / divisor
            off = np.abs(first) + np.abs(second) + terms * np.maximum(np.abs(value), 1)
            error = off / np.abs(divisor) * _ROUNDING
        vague = ~np.isfinite(value + error)
        return np.where(vague, 0.5, value), np.where(vague, 1.0, error)

    def exact(self, k: int) -> Share:
        """Return one share."""
        p, q, r, s = (as_exact(each[k]) for each in (self.p, self.q, self.r, self.s))
        x, y = q[0] - p[0], q[1] - p[1]
        divisor = x * (s[1] - r[1]) - y * (s[0] - r[0])
        return -turn(p, q, r) / divisor, self.moved * y / divisor, -self.moved * x / divisor

    def points(self) -> Floats:
        """Return the crossings, on the ways but for rounding."""
        value, error = self.rounded[0].copy(), self.rounded[1]
        for k in np.flatnonzero(~(error < _VAGUE)).tolist():
            value[k] = float(self.exact(k)[0])
        with np.errstate(over="ignore"):
            points = self.r + value[:, None] * (self.s - self.r)
        inside: Floats = np.clip(points, np.minimum(self.r, self.s), np.maximum(self.r, self.s))
        return inside


_NEAREST = 8  # segments to which ways are tried
_HALF = Fraction(1, 2)


def cell_at(lines: Traced, domain: Domain, begin: int, end: int, default: int) -> int:
    """Find the cell of the ring of some corners; it is the default if no polyline is near."""
    segments = lines.segments
    start, end_of = lines.points[segments], lines.points[segments + 1]
    low, high = shares_in(start, end_of, lines.box)
    seen = np.flatnonzero((low < high) & (start != end_of).any(axis=1))
    segments, start, end_of = segments[seen], start[seen], end_of[seen]
    share = (low[seen] + high[seen]) / 2
    for place, k in _ways(start + share[:, None] * (end_of - start), domain.corners[begin:end]):
        a, b = as_exact(start[k]), as_exact(end_of[k])
        target = between(a, b, Fraction(float(share[k])))
        side = _first_side(start, end_of, place, target)
        if side is not None:
            line = int(np.searchsorted(lines.starts, segments[side[0]], side="right")) - 1
            return int(lines.rows[line, side[1]])
    return default


def _ways(targets: Floats, corners: Floats) -> Iterator[tuple[Exact, int]]:
    """Yield places on the ring, each with some of the targets: those next to the first place."""
    distance = np.hypot(*(targets - corners[0]).T)
    nearest = np.argsort(distance, kind="stable")[:_NEAREST].tolist()
    for first, last in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        a, b = as_exact(first), as_exact(last)
        for k in nearest:
            yield a, k
            yield between(a, b, _HALF), k


def _first_side(start: Floats, end: Floats, place: Exact, target: Exact) -> tuple[int, int] | None:
    """Return the first segment on a way, and on which of its sides that begins."""
    best: tuple[Fraction, int, int] | None = None
    for k in _near_way(start, end, place, target).tolist():
        a, b = as_exact(start[k]), as_exact(end[k])
        before, after = turn(a, b, place), turn(a, b, target)
        sides = turn(place, target, a), turn(place, target, b)
        if before * after > 0 or sides[0] * sides[1] > 0:
            continue
        if before == 0 or sides[0] == 0 or sides[1] == 0:
            return None
        share = before / (before - after)
        if best is None or share < best[0]:
            best = share, k, int(before < 0)
    return None if best is None else best[1:]


def _near_way(start: Floats, end: Floats, place: Exact, target: Exact) -> Indices:
    """Return the segments whose boxes meet that of a way."""
    ends = np.array([[float(x) for x in each] for each in (place, target)])
    margin = np.abs(ends).max() * 2.0**-50  # more than the rounding of both
    low, high = ends.min(axis=0) - margin, ends.max(axis=0) + margin
    near = (np.maximum(start, end) >= low).all(axis=1)
    near &= (np.minimum(start, end) <= high).all(axis=1)
    return np.flatnonzero(near)
