"""From polylines between cells and a domain to the rings of all cells.

Each polyline has a cell on its left and one on its right. It is cut where it crosses the edges of
the domain, and the parts inside are sides of both cells. The rings of the domain are cut there,
too: between two crossings they run through one cell. Of each cell, one part starts where another
ends, so the parts are linked to rings. Nothing is decided by coordinates but by `crossings.py`.

A ring of the domain that nothing crosses is in one cell, which `crossings.py` finds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from liftmesh._typing import Array, Floats, Indices, Integers, Mask, Rows
from liftmesh.cells.crossings import Crossings, cell_at, crossings, lies_inside
from liftmesh.cells.rings import DomainCorners, Exact, Rings, as_exact, between, resolve_ties, turn
from liftmesh.errors import InputError
from liftmesh.io.columns import places

if TYPE_CHECKING:
    from liftmesh.cells.domain import Domain
    from liftmesh.disks.sides import Traced


class _Stations(NamedTuple):
    """Points along polylines or rings of the domain, crossings among them."""

    points: Floats
    source: Rows  # the first two columns of the `sources` of `Rings`
    place: Integers  # numbers vertices and crossings, where parts of a cell are linked; else -1


class _Parts(NamedTuple):
    """Sides of cells: of which cell, from which station to which, and what is beyond."""

    cell: Rows
    first: Integers
    last: Integers
    beyond: Rows


@dataclass(frozen=True, slots=True, eq=False)
class PolylineCorners(DomainCorners):
    """Corners of cells between polylines."""

    # A corner is a point of these, whose number is its second source; or where a segment, numbered
    # as its start is, crosses an edge.
    lines: Traced

    def at(self, cell: int, edge: int, other: int) -> Exact:  # noqa: ARG002 - one for all cells
        """Compute a corner."""
        points = self.lines.points
        if edge < 0:
            return as_exact(points[other])
        start, end = self.ends(edge)
        if other < 0:
            return start
        a, b = as_exact(points[other]), as_exact(points[other + 1])
        first, last = turn(a, b, start), turn(a, b, end)
        share = first / (first - last) if first != last else Fraction(0)
        return between(start, end, share)


def overlay_cells(lines: Traced, domain: Domain, default: int) -> tuple[Rings, PolylineCorners]:
    """Clip all cells between polylines to a domain; without polylines near, it is in one cell."""
    segment = lines.segments
    crossed = crossings(lines.points[segment], lines.points[segment + 1], domain)
    crossed = crossed._replace(segment=segment[crossed.segment])
    of_lines, parts = _cut_lines(lines, crossed, domain)
    of_domain, border = _cut_domain(lines, crossed, domain, default, len(of_lines.points))
    stations = _Stations(*_joined([of_lines, of_domain]))
    sides = _Parts(*_joined([*parts, border]))
    rings = _linked(stations, sides, len(of_lines.points))
    exact = PolylineCorners(domain, lines)
    line = np.searchsorted(lines.starts, segment[crossed.ties[:, 2]], side="right") - 1
    ties = np.concatenate([crossed.ties[:, :2], lines.rows[line]], axis=1).astype(np.int32)
    return _as_found(resolve_ties(rings, exact, ties), crossed), exact


def _as_found(rings: Rings, crossed: Crossings) -> Rings:
    """Round crossings in one way, whether a cell was taken apart or not."""
    width = int(crossed.segment.max(initial=0)) + 1
    edge, segment, _ = rings.sources.astype(np.int64).T
    own = np.flatnonzero((edge >= 0) & (segment >= 0))
    names = crossed.edge.astype(np.int64) * width + crossed.segment
    order = np.argsort(names)
    place = order[np.searchsorted(names[order], edge[own] * width + segment[own])]
    rings.points[own] = crossed.points[place]
    return rings


def _cut_lines(
    lines: Traced, crossed: Crossings, domain: Domain
) -> tuple[_Stations, tuple[_Parts, _Parts]]:
    """Put crossings between the points of polylines, and return the parts inside the domain."""
    count, before = len(lines.points), crossed.segment + 1
    vertex = int(lines.ends.max(initial=-1)) + 1
    place = np.full(count, -1)
    place[lines.starts[:-1]], place[lines.starts[1:] - 1] = lines.ends.T
    source = np.stack([np.full(count, -1), np.arange(count)], axis=1)
    stations = _Stations(
        np.insert(lines.points, before, crossed.points, axis=0),
        np.insert(source, before, np.stack([crossed.edge, crossed.segment], axis=1), axis=0).astype(
            np.int32
        ),
        np.insert(place, before, vertex + np.arange(len(before))),
    )
    starts = lines.starts + np.searchsorted(crossed.segment, lines.starts)
    at = before + np.arange(len(before))  # the station of each crossing
    bounds = np.sort(np.concatenate([starts[:-1], starts[1:] - 1, at]))
    of_bound = np.searchsorted(starts, bounds, side="right") - 1
    within = np.flatnonzero(of_bound[:-1] == of_bound[1:])
    first, last, line_of = bounds[within], bounds[within + 1], of_bound[within]
    inside = _are_inside(lines, crossed, domain, (first, last, line_of, at))
    first, last, rows = first[inside], last[inside], lines.rows[line_of[inside]]
    left, right = rows.T
    return stations, (_Parts(left, first, last, right), _Parts(right, last, first, left))


def _are_inside(
    lines: Traced,
    crossed: Crossings,
    domain: Domain,
    pieces: tuple[Integers, Integers, Integers, Integers],
) -> Mask:
    """Whether the pieces between ends and crossings are inside, which alternate along a line."""
    first, last, line_of, at = pieces
    inside = np.zeros(len(first), dtype=np.bool_)
    number = np.full(int(last.max(initial=-1)) + 1, -1)
    number[at] = np.arange(len(at))
    begins, ends = number[first], number[last]
    has_begin, has_end = begins >= 0, ends >= 0
    inside[has_begin] = crossed.enters[begins[has_begin]]
    alone = has_end & ~has_begin
    inside[alone] = ~crossed.enters[ends[alone]]
    both = has_begin & has_end
    _check_alternate(crossed, begins[both], ends[both])
    whole = ~has_begin & ~has_end
    inside[whole] = lies_inside(lines.points[lines.starts[line_of[whole]]], domain)
    return inside


def _check_alternate(crossed: Crossings, begins: Integers, ends: Integers) -> None:
    wrong = np.flatnonzero(crossed.enters[begins] == crossed.enters[ends])
    if len(wrong):
        x, y = crossed.points[begins[wrong[0]]].tolist()
        raise InputError(
            f"the rings of the domain cross or overlap at ({x!r}, {y!r}): give a valid polygon"
        )


def _cut_domain(
    lines: Traced, crossed: Crossings, domain: Domain, default: int, offset: int
) -> tuple[_Stations, _Parts]:
    """Put crossings between the corners of the domain; each part between two is in one cell."""
    vertex = int(lines.ends.max(initial=-1)) + 1
    line = np.searchsorted(lines.starts, crossed.segment, side="right") - 1
    rows = np.where(crossed.from_left[:, None], lines.rows[line], lines.rows[line, ::-1])
    order = crossed.along_edges
    edges = crossed.edge[order]
    stations: list[Integers] = []  # of a corner its number, of a crossing what is below -1
    cells, firsts, lasts, count = [], [], [], offset
    for ring in range(len(domain.starts) - 1):
        begin, end = domain.starts[ring : ring + 2].tolist()
        own = order[np.searchsorted(edges, begin) : np.searchsorted(edges, end)]
        chain, at = _around(begin, end, crossed.edge[own], own)
        if len(own):
            after, before = rows[own, 1], rows[np.roll(own, -1), 0]
            for k in np.flatnonzero(after != before).tolist():
                raise _too_thin(after[k], before[k], crossed.points[own[k]])
            cells.append(after)
        else:
            cells.append([cell_at(lines, domain, begin, end, default)])
        firsts.append(count + at[:-1])
        lasts.append(count + at[1:])
        stations.append(chain)
        count += len(chain)
    named = np.concatenate(stations)
    is_corner = named >= 0
    crossing, corner = np.where(is_corner, 0, -2 - named), np.where(is_corner, named, 0)
    if len(crossed.points):
        points = np.where(is_corner[:, None], domain.corners[corner], crossed.points[crossing])
        source = np.stack([crossed.edge[crossing], crossed.segment[crossing]], axis=1)
    else:
        points, source = domain.corners[corner], np.zeros((len(named), 2), dtype=np.int64)
    source[is_corner] = np.stack([named, np.full(len(named), -1)], axis=1)[is_corner]
    place = vertex + np.where(is_corner, len(crossed.points) + named, crossing)
    cell = np.concatenate(cells).astype(np.int32)
    parts = _Parts(cell, np.concatenate(firsts), np.concatenate(lasts), np.full_like(cell, -1))
    return _Stations(points, source.astype(np.int32), place), parts


def _around(begin: int, end: int, edges: Rows, own: Indices) -> tuple[Integers, Integers]:
    """Return corners and crossings of a ring, from a crossing round to it, and where these are."""
    corners = np.arange(begin, end)
    if not len(own):
        return np.append(corners, begin), np.array([0, len(corners)])
    chain = np.insert(corners, edges - begin + 1, -2 - own)
    at = edges - begin + 1 + np.arange(len(own))
    first = int(at[0])
    chain = np.concatenate([chain[first:], chain[: first + 1]])
    return chain, np.append(at - first, len(chain) - 1)


def _too_thin(row: np.int32, other: np.int32, point: Floats) -> InputError:
    x, y = point.tolist()
    return InputError(
        f"the cells of rows {row} and {other} are thinner near ({x!r}, {y!r}) than float64 can "
        "tell apart: move the disks nearer to the origin, or leave one of them out"
    )


def _joined(several: Sequence[tuple[Array, ...]]) -> list[Array]:
    return [np.concatenate(each) for each in zip(*several, strict=True)]


def _linked(stations: _Stations, parts: _Parts, offset: int) -> Rings:
    """Link the sides of each cell to rings: first those with stations of the domain, the last."""
    follower = _followers(stations, parts)
    order, lengths = cycles(follower)
    of_domain = np.maximum(parts.first, parts.last)[order] >= offset
    starts = np.concatenate([[0], np.cumsum(lengths)])
    is_cut = np.add.reduceat(of_domain, starts[:-1]) > 0 if len(lengths) else of_domain
    by_cut = np.argsort(~is_cut, kind="stable")
    order = order[places(starts[:-1][by_cut], lengths[by_cut])]
    lengths = lengths[by_cut]
    sides = np.abs(parts.last - parts.first)[order]  # stations but for the last
    step = np.repeat(np.sign(parts.last - parts.first)[order], sides)
    along = np.arange(sides.sum()) - np.repeat(np.cumsum(sides) - sides, sides)
    taken = np.repeat(parts.first[order], sides) + step * along
    beyond = np.repeat(parts.beyond[order], sides)
    ring = np.repeat(np.repeat(np.arange(len(lengths)), lengths), sides)
    starts = np.concatenate([[0], np.cumsum(np.bincount(ring, minlength=len(lengths)))])
    cells = parts.cell[order][np.cumsum(lengths) - lengths]
    sources = np.concatenate([stations.source[taken], beyond[:, None]], axis=1)
    rings = Rings(sources, stations.points[taken], starts, cells, int(np.count_nonzero(is_cut)))
    return _without_points(rings)


def _followers(stations: _Stations, parts: _Parts) -> Indices:
    """Return the side of the same cell that starts where each ends."""
    width = int(stations.place.max(initial=0)) + 1
    start = parts.cell.astype(np.int64) * width + stations.place[parts.first]
    end = parts.cell.astype(np.int64) * width + stations.place[parts.last]
    by_start = np.argsort(start)
    if not np.array_equal(start[by_start], np.sort(end)):
        k = int(np.flatnonzero(start[by_start] != np.sort(end))[0])
        part = by_start[k]
        raise _too_thin(parts.cell[part], parts.beyond[part], stations.points[parts.first[part]])
    follower: Indices = by_start[np.searchsorted(start[by_start], end)]
    return follower


def cycles(follower: Indices) -> tuple[Indices, Integers]:
    """Return a permutation cycle by cycle, and the lengths of these."""
    following, seen = follower.tolist(), bytearray(len(follower))
    order: list[int] = []
    lengths: list[int] = []
    for first in range(len(following)):
        if seen[first]:
            continue
        k, count = first, len(order)
        while not seen[k]:
            seen[k] = 1
            order.append(k)
            k = following[k]
        lengths.append(len(order) - count)
    return np.array(order, dtype=np.intp), np.array(lengths, dtype=np.int64)


def _without_points(rings: Rings) -> Rings:
    """Leave out sides that have no length, and rings of which fewer than three are left."""
    equal = (rings.points == rings.points[rings.following]).all(axis=1)
    kept = np.bincount(rings.ring_of, ~equal, minlength=len(rings.cells))
    whole = kept >= 3
    corner = ~equal & whole[rings.ring_of]
    starts = np.concatenate([[0], np.cumsum(kept[whole])]).astype(np.int64)
    cut = int(np.count_nonzero(whole[: rings.cut]))
    return Rings(rings.sources[corner], rings.points[corner], starts, rings.cells[whole], cut)
