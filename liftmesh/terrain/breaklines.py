"""Surfaces that follow lines: the rows and edges that lines become, and the faces that rings leave.

Corners of lines are rows after those of the cloud; equal ones are one row. Lines whose heights hold
come first. The surface of the cloud and of these gives the heights of all others: of the corners of
a line without heights, and of a draped line also where it crosses sides of faces, which it follows
so. Where it crosses a line whose heights hold, both are split later, and the row
there has the height of that line.

Rings are edges, so a triangle is in a polygon as a whole, and its centroid tells. Where a draped
ring leaves the hull, its last row is rounded to just beside it: slivers there are left out if a
triangle beside them is, and the sides that this leaves open become edges, too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Floats, Integers, Mask, Rows
from liftmesh.base.arrays import is_after, pair_keys, starts_of_runs
from liftmesh.base.options import Crossing, exhausted, part_of
from liftmesh.errors import CrossingError, InputError, Option
from liftmesh.optional import load
from liftmesh.planar.constrained import constrained_delaunay
from liftmesh.planar.constrained_triangulation import (
    ConstrainedTriangulation,
    with_rows,
    with_sides,
)
from liftmesh.planar.crossing_edges import TOO_NEAR
from liftmesh.planar.delaunay import Solution
from liftmesh.terrain.boundary import centroids, masked
from liftmesh.terrain.lines import Line, Lines, check_plain
from liftmesh.terrain.profile import HEADS, TAILS, LineCrossings, Met, between
from liftmesh.terrain.sampling import heights_at
from liftmesh.terrain.surface_data import AnySurface, SurfaceData, ordered_corners
from liftmesh.vector.polygons import contains

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.planar.triangulation import Triangulation
    from liftmesh.terrain.frame import Frame
    from liftmesh.terrain.lifting import Lifting

BREAKLINE = "breakline"  # the values that say which rows lines have become
OF_LINE, OF_AROUND = 1, 2  # such values: whose heights hold, and whose heights are the surface's
_NAMED = 10


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """A line, or parts of one, in space."""

    line: Line
    points: Floats  # (c, 3)
    joined: Mask  # (c,) whether each is joined to the one before


@dataclass(frozen=True, slots=True, eq=False)
class Network:
    """The rows and edges that lines become."""

    rows: Floats  # (r, 3), after those of the cloud
    holds: Mask  # of each row: whether its height does, or is that of the surface around
    edges: Rows  # (k, 2): among these rows
    line: Integers  # of each edge
    lines: list[Line]
    crossing: Crossing

    @classmethod
    def of(cls, chains: list[Chain], crossing: Crossing) -> Network:
        """Find equal corners, and number them in their order."""
        lines = [each.line for each in chains]
        counts = np.array([len(each.points) for each in chains], dtype=np.int64)
        points = np.concatenate([np.empty((0, 3)), *(each.points for each in chains)]) + 0.0
        holds = np.repeat(np.array([each.holds for each in lines], dtype=np.bool_), counts)
        keyed = np.column_stack([points, holds])
        order = np.lexsort(keyed.T[::-1])
        starts = starts_of_runs(keyed[order])
        first = np.empty(len(points), dtype=np.int64)
        first[order] = order[starts][np.cumsum(starts) - 1]
        own = np.unique(first)
        number = np.searchsorted(own, first)
        joined = np.concatenate([[False], *(each.joined for each in chains)])[1:]
        line = np.repeat(np.arange(len(lines)), counts)[joined]
        edges = np.stack([number[np.flatnonzero(joined) - 1], number[joined]], axis=1)
        return cls(points[own], holds[own], edges.astype(np.int32), line, lines, crossing)

    def edge_holds(self) -> Mask:
        """Whether the heights of each edge's line hold."""
        return np.array([each.holds for each in self.lines], dtype=np.bool_)[self.line]


def with_lines(
    lines: Lines, lifting: Lifting, algorithm: str, frame: Frame, build: Callable[..., AnySurface]
) -> AnySurface:
    """Make the surface that follows lines."""
    check_plain(lifting, algorithm)
    lines.check(frame, frame.planar(lifting.cloud.points))

    def built(chains: list[Chain], *, is_last: bool) -> AnySurface:
        network = Network.of(chains, lines.crossing)
        has_edges = len(network.edges) > 0
        source = Following(lifting.cloud, frame, network) if has_edges else lifting
        return build(source, is_last=is_last)

    firm, loose = ([each for each in lines.all() if each.holds == is_firm] for is_firm in (1, 0))
    chains = [_whole(each, each.densified(frame, lines.densify)) for each in firm]
    if loose:
        corners = [each.planar(frame, each.densified(frame, lines.densify)) for each in loose]
        chains += _laid(loose, corners, built(chains, is_last=False))
    surface = _bounded(built(chains, is_last=True), lines)
    counts = line_counts(surface, len(lifting.cloud))
    enclosing = {id(each) for rings in lines.boundary for each in rings}
    counts["lines_beyond"] = sum(
        each.line.draped and not each.joined.any() and id(each.line) not in enclosing
        for each in chains
    )
    return replace(surface, report=replace(surface.report, lines=counts))


def _whole(line: Line, points: Floats) -> Chain:
    return Chain(line, points, np.arange(len(points)) > 0)


def _laid(lines: list[Line], corners: list[Floats], surface: SurfaceData) -> Iterator[Chain]:
    """Give lines the heights of a surface, at their corners or wherever they cross sides."""
    draped = [k for k, line in enumerate(lines) if line.draped]
    parts = dict(zip(draped, _Drape(surface).parts([corners[k] for k in draped]), strict=True))
    for k, line in enumerate(lines):
        if line.draped:
            yield Chain(line, *parts[k])
            continue
        heights = heights_at(surface, corners[k])
        if np.isnan(heights).any():
            x, y = corners[k][np.isnan(heights)][0].tolist()
            raise InputError(
                f"{line.name} has no heights, and there are none around its corner ({x!r}, {y!r}), "
                "which is outside of all faces: give heights, or cut the line"
            )
        yield _whole(line, in_space(surface.frame, corners[k], heights))


def in_space(frame: Frame, planar: Floats, heights: Floats) -> Floats:
    """Return the places of coordinates in a plane of two axes, without rounding."""
    check_exact(frame)
    points = np.empty((len(planar), 3))
    for axis, values in zip(frame.axes, (*planar.T, heights), strict=True):
        (column,) = np.flatnonzero(axis)
        points[:, column] = values * axis[column]
    return points


def check_exact(frame: Frame) -> None:
    """Raise unless rows can be added in the plane."""
    if frame.name not in ("xy", "xz", "yz"):
        raise InputError(
            f"new rows need a plane whose coordinates are exact, not {frame.name!r}: give "
            f"{Option('plane')} 'xy', 'xz' or 'yz'"
        )


class _Drape(LineCrossings):
    """What lines meet of a surface, but for sides that lines are: those are split later."""

    def __init__(self, surface: SurfaceData) -> None:
        super().__init__(surface)
        tri = surface.triangulation
        pieces = getattr(tri, "constraints", np.empty((0, 2), dtype=np.int32))
        rim = np.stack([tri.convex_hull, np.roll(tri.convex_hull, -1)])
        at_rim = pair_keys(rim.min(axis=0), rim.max(axis=0))  # where lines would end before it
        self._pieces = np.setdiff1d(pair_keys(*pieces.T), at_rim)

    def parts(self, lines: list[Floats]) -> list[tuple[Floats, Mask]]:
        """Return what lines become, and which points are joined; in both directions the same."""
        if not lines:
            return []
        tails, heads = (np.concatenate([each[part] for each in lines]) for part in (TAILS, HEADS))
        swap = is_after(tails, heads)[:, None]
        points, piece = self.of(np.where(swap, heads, tails), np.where(swap, tails, heads))
        number = np.arange(len(points))
        points = points[np.lexsort([np.where(swap[piece, 0], -number, number), piece])]
        is_part = (np.bincount(piece) > 1)[piece]
        points, piece = points[is_part], piece[is_part]
        places = in_space(self._surface.frame, points[:, :2], points[:, 2])
        ends = np.searchsorted(piece, np.cumsum([len(each) - 1 for each in lines]))[:-1]
        joined = np.diff(piece, prepend=-1) == 0
        return list(zip(np.split(places, ends), np.split(joined, ends), strict=True))

    def _crossings(self, sides: Rows, piece: Rows, p: Floats, q: Floats) -> Met:
        if len(self._pieces):
            keys = pair_keys(*sides.T)
            place = np.minimum(np.searchsorted(self._pieces, keys), len(self._pieces) - 1)
            is_free = self._pieces[place] != keys
            sides, piece = sides[is_free], piece[is_free]
        return super()._crossings(sides, piece, p, q)


@dataclass(slots=True, eq=False)
class Following:
    """A cloud and what lines become, in place of what its points are lifted by."""

    cloud: Cloud
    frame: Frame
    network: Network
    points: Floats = field(init=False)  # the rows of both, then those at crossings
    _tri: Any = field(init=False)

    def __post_init__(self) -> None:
        self.points = np.concatenate([self.cloud.points, self.network.rows])

    def has_weight(self, rows: Rows) -> Mask:
        """Tell which rows have a weight: all, as none is asked for."""
        return np.ones(len(rows), dtype=np.bool_)

    def solve(self, planar: Floats, options: Mapping[str, Any]) -> Solution:
        """Triangulate the planar points."""
        edges = self.network.edges + np.int32(len(self.cloud))
        run: Any = {name: options[name] for name in ("nonfinite", "threads")}
        tri, progress = None, options["progress"]
        if self.network.crossing == "error":
            part, progress = part_of(progress, 0, 0.5), part_of(progress, 0.5, 1)
            try:
                tri = constrained_delaunay(planar, edges, **run, progress=part)
            except CrossingError as error:
                self._refuse(error, planar, edges)
        elif self.network.crossing != "split":  # pragma: no cover - mypy refuses
            exhausted(self.network.crossing)
        if tri is None:
            try:
                tri = constrained_delaunay(
                    planar, edges, crossing="split", **run, progress=progress
                )
            except CrossingError as error:
                raise self._unending(error) from error
            if len(tri.crossing_rows):
                rows = in_space(self.frame, tri.points[tri.crossing_rows], self._at_crossings(tri))
                self.points = np.concatenate([self.points, rows])
        self._tri = tri
        arrays = tri.points, tri.simplices, tri.neighbors, tri.convex_hull
        return Solution(*arrays, tri.duplicates, tri.skipped)

    @property
    def ranks(self) -> Array:
        """The rank of each row, of which the highest counts at a position: 2 if its line holds."""
        ranks = np.zeros(len(self.points), dtype=np.uint8)
        own = ranks[len(self.cloud) :]
        own[:] = 2
        own[: len(self.network.holds)] = 1 + self.network.holds
        return ranks

    def completed(self, hidden: Rows) -> Cloud:  # noqa: ARG002 - none are
        """Return the cloud with all rows."""
        rows = self.points[len(self.cloud) :]
        flags = np.where(self.ranks[len(self.cloud) :] == 2, OF_LINE, OF_AROUND).astype(np.uint8)
        return extended(self.cloud, self.frame, rows, flags)

    def triangulation(self, solution: Solution) -> ConstrainedTriangulation:
        """Make the triangulation of a solution, in which rows may have been replaced."""
        tri: ConstrainedTriangulation = self._tri
        if solution.simplices is tri.simplices:
            return tri
        names = np.arange(len(tri.points), dtype=np.int32)
        names[tri.simplices] = solution.simplices
        return with_rows(tri, tri.points, names, solution.duplicates, tri.convex_hull)

    def _refuse(self, error: CrossingError, planar: Floats, edges: Rows) -> None:
        """Raise if lines cross whose heights hold, and say both heights."""
        network = self.network
        firm = np.flatnonzero(network.edge_holds()[error.crossings].all(axis=1))
        named = []
        for k in firm[:_NAMED].tolist():
            pair = error.crossings[k]
            one, two = self._names(pair)
            place = error.places[k] if k < len(error.places) else planar[edges[pair[0], 0]]
            low, high = self._along(planar, edges[pair], np.stack([place, place])).tolist()
            x, y = place.tolist()
            named.append(f"{one} and {two} at ({x!r}, {y!r}), at the heights {low!r} and {high!r}")
        if not named:
            return
        rest = f"; and {len(firm) - _NAMED:,} more" if len(firm) > _NAMED else ""
        raise CrossingError(
            f"lines cross where they have no corner: {'; '.join(named)}{rest}. Give both a corner "
            f"there, or {Option('crossing', 'split')}, which takes the height of the first",
            crossings=error.crossings[firm],
            rows=error.rows[firm],
            places=error.places[firm[firm < len(error.places)]],
        ) from error

    def _names(self, edges: Rows) -> list[str]:
        return [self.network.lines[each].name for each in self.network.line[edges].tolist()]

    def _unending(self, error: CrossingError) -> CrossingError:
        """Name the lines that still cross after many splits."""
        (x, y), (one, two) = error.places[0].tolist(), self._names(error.crossings[0])
        return CrossingError(
            f"{one} and {two} still cross after many splits, at ({x!r}, {y!r}): {TOO_NEAR}",
            crossings=error.crossings,
            rows=error.rows,
            places=error.places,
        )

    def _along(self, planar: Floats, edges: Rows, places: Floats) -> Floats:
        """Return the heights of edges at places on them."""
        tails, heads = planar[edges[:, 0]] / 2, planar[edges[:, 1]] / 2
        steps = heads - tails
        axis = np.abs(steps).argmax(axis=1)[:, None]
        ahead, whole = (
            np.take_along_axis(each, axis, axis=1)[:, 0] for each in (places / 2 - tails, steps)
        )
        low, high = self._heights()[edges.T]
        return between(low, high, np.clip(ahead / whole, 0, 1))

    def _heights(self) -> Floats:
        return self.frame.heights(self.points)

    def _at_crossings(self, tri: ConstrainedTriangulation) -> Floats:
        """Return the heights where edges were split: those of lines that hold, then the first."""
        starts, members = tri.constraint_inputs
        rows = tri.constraints[np.repeat(np.arange(len(starts) - 1), np.diff(starts))]
        first = len(tri.points) - len(tri.crossing_rows)
        at, edge = rows.T.ravel(), np.tile(members, 2)
        at, edge = at[at >= first], edge[at >= first]
        order = np.lexsort([edge, self.network.line[edge], ~self.network.edge_holds()[edge], at])
        at, edge = at[order], edge[order]
        chosen = edge[starts_of_runs(at[:, None])]
        return self._along(tri.points, tri.input_edges[chosen], tri.points[first:])


def extended(
    cloud: Cloud, frame: Frame, rows: Floats, flags: Array, flag: str = BREAKLINE
) -> Cloud:
    """Add rows to a cloud, with the colours and values of the nearest of its own."""
    check_flag(cloud.attributes, flag)
    values = {flag: np.zeros(len(cloud), dtype=np.uint8), **cloud.attributes}
    nearest = np.empty(0, dtype=np.int64)
    if len(rows) and (len(values) > 1 or cloud.colors is not None or cloud.normals is not None):
        nearest = nearest_rows(frame.planar(cloud.points), frame.planar(rows))

    def longer(array: Array) -> Array:
        return np.concatenate([array, array[nearest]])

    named = {name: longer(each) for name, each in values.items() if name != flag}
    named[flag] = np.concatenate([values[flag], flags])
    colors, normals = cloud.colors, cloud.normals
    return replace(
        cloud,
        points=np.concatenate([cloud.points, rows]),
        colors=None if colors is None else longer(colors),
        normals=None if normals is None else longer(normals),
        attributes=named,
        faces=None,
    )


def check_flag(attributes: Mapping[str, Array], flag: str) -> None:
    """Raise where other values have the name of those that say which rows are new."""
    if flag in attributes and attributes[flag].dtype != np.uint8:
        raise InputError(
            f"the points have values named {flag!r}, the name of those that say which rows are "
            "new: rename them, or leave them out"
        )


def nearest_rows(points: Floats, places: Floats) -> Integers:
    """Return the nearest of some points to each place."""
    tree = load("scipy.spatial", extra="scipy").KDTree
    finite = np.flatnonzero(np.isfinite(points).all(axis=1))
    nearest: Integers = finite[tree(points[finite]).query(places)[1]]
    return nearest


def line_counts(surface: SurfaceData, first: int) -> dict[str, int]:
    """Count what lines have brought, whose rows begin with the first."""
    flags = surface.attributes.get(BREAKLINE, np.empty(0))[first:]
    heights = surface.frame.heights(surface.vertices)
    left, used = surface.report.left_out, surface.report.representatives
    left, used = left[left >= first], used[left >= first]
    is_beside = (flags[left - first] == OF_LINE) & (heights[left] != heights[used])
    heights, tri = heights.take(surface.faces, axis=0), surface.triangulation
    return {
        "rows": int(np.count_nonzero(flags)),
        "rows_from_around": int(np.count_nonzero(flags == OF_AROUND)),
        "rows_at_crossings": len(getattr(tri, "crossing_rows", ())),
        "rows_at_other_heights": int(np.count_nonzero(is_beside)),
        "edges": len(getattr(tri, "constraints", ())),
        "flat_triangles": int((heights[:, :1] == heights).all(axis=1).sum()),
    }


def _bounded(surface: AnySurface, lines: Lines) -> AnySurface:
    """Leave out the faces that are outside of the boundary, or in holes."""
    if not (lines.boundary or lines.holes):
        return surface
    tri = surface.triangulation
    shown = _shown(tri, lines, surface.frame)
    if isinstance(tri, ConstrainedTriangulation):  # else no ring meets a face
        is_open = (tri.neighbors >= 0) & ~tri.is_constrained
        if (shown[:, None] & ~shown[tri.neighbors] & is_open).any():
            return _without_slivers(surface, tri, shown, is_open)
    return masked(surface, ~shown)


def _shown(tri: Triangulation, lines: Lines, frame: Frame) -> Mask:
    """Tell which triangles are within the boundary and in no hole, as their centroids are.

    Where no constraint is between triangles they are alike, but for slivers at rings and the hull.
    So those with a vertex there are asked for, and all of a region where these differ.
    """
    at_rings = np.zeros(tri.npoints, dtype=np.bool_)
    at_rings[tri.convex_hull] = True
    regions = np.zeros(tri.nsimplex, dtype=np.int32)
    if isinstance(tri, ConstrainedTriangulation):
        at_rings[tri.constraints] = True
        regions = tri.regions
    is_asked = at_rings.take(tri.simplices, axis=0).any(axis=1)
    found = _within(tri.points.take(tri.simplices[is_asked], axis=0), lines, frame)
    of_region = regions[is_asked]
    shown, hidden = (
        np.bincount(of_region[each], minlength=regions.max() + 1) for each in (found, ~found)
    )
    is_shown = (shown > 0)[regions]
    is_mixed = ((shown > 0) == (hidden > 0))[regions]
    is_shown[is_mixed] = _within(tri.points.take(tri.simplices[is_mixed], axis=0), lines, frame)
    return is_shown


def _within(corners: Floats, lines: Lines, frame: Frame) -> Mask:
    """Tell which triangles have a centroid within the boundary, and in no hole."""
    middles = centroids(corners)
    found: Mask = np.ones(len(middles), dtype=np.bool_)
    if lines.boundary:
        found = contains(lines.rings(lines.boundary, frame), middles)
    if lines.holes:
        found &= ~contains(lines.rings(lines.holes, frame), middles)
    return found


def _without_slivers(
    surface: AnySurface, tri: ConstrainedTriangulation, shown: Mask, is_open: Mask
) -> AnySurface:
    """Leave out slivers where a ring leaves the hull."""
    with np.errstate(all="ignore"):  # the order of the rows changes no bit
        a, b, c = np.moveaxis(ordered_corners(tri.points.take(tri.simplices, axis=0)), 1, 0)
        (ax, ay), (bx, by) = (b - a).T, (c - a).T
        area = np.abs(ax * by - ay * bx)
    is_smaller = is_open & (area[:, None] < area[tri.neighbors])
    while True:  # no ring is between such triangles: the smaller one is a sliver
        differs = (shown[:, None] & ~shown[tri.neighbors] & is_smaller).any(axis=1)
        if not differs.any():
            break
        shown[differs] = False
    at_sliver = shown[:, None] & ~shown[tri.neighbors] & is_open
    if at_sliver.any():
        surface = replace(surface, triangulation=with_sides(tri, at_sliver))
    return masked(surface, ~shown)
