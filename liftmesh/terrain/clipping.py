"""Surfaces cut along polygons: the part inside, the part outside, and one pasted into another.

Only the faces that a polygon's border touches are cut (`cutting.py`); all others are inside or
outside as a whole, as one of their corners tells. What is cut keeps its plane: the sides of all
faces stay, and what triangulates the parts of a face is inside of it.

To paste, both surfaces are cut along one polygon. Faces of each are then divided at the rows that
the other has on the border, so that both have the same rows there.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Generic, TypeAlias

import numpy as np

from liftmesh._typing import Array, Floats, Integers, Mask, Progress, Rows
from liftmesh.base.arrays import pair_keys, starts_of_runs, used_rows
from liftmesh.base.options import as_switch, check_progress, part_of
from liftmesh.errors import InputError
from liftmesh.io.metadata import LIFTED
from liftmesh.io.tags import MARKERS
from liftmesh.terrain.boundary import mask_of
from liftmesh.terrain.breaklines import check_exact, extended, in_space
from liftmesh.terrain.cutting import Layer, Overlay, along, along_sides
from liftmesh.terrain.measures import check_pair, scale_of, valid_shapes
from liftmesh.terrain.own_faces import fields_of
from liftmesh.terrain.profile import LineCrossings
from liftmesh.terrain.refinement import STEINER
from liftmesh.terrain.surface_data import (
    HIDDEN,
    AnySurface,
    OverPlane,
    SurfaceData,
    as_cloud,
    plane_system,
)
from liftmesh.vector.polygons import Polygon, contains, polygons_in

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_CUT = 0.9  # of the time
_MOST_ROUNDS = 8

Place: TypeAlias = tuple[float, ...]
Side: TypeAlias = tuple[Place, Place]


def clip(
    surface: AnySurface,
    polygon: object,
    *,
    invert: bool = False,
    progress: Progress | None = None,
) -> AnySurface:
    """Cut the faces along a polygon, and keep what is inside: the same surface, bounded by it.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud, over the plane "xy", "xz" or "yz".
    polygon : object
        As for `trim`, and valid; of several, what they cover together.
    invert : bool, default False
        Keep what is outside instead.
    progress : callable, optional
        As for `triangulate`.

    Returns
    -------
    Surface
        The rows in use, in their order, and after them those on the border, by x, then y. These
        have the heights of the faces, the colours and values of the nearest row, and a 1 in the
        values ``steiner``. Faces that the border does not touch stay as they are; others are cut,
        and the parts are in their planes. Breaklines stay.

    Raises
    ------
    InputError
        The polygon is invalid or none, or known to be in another coordinate system, no face is
        left, or the plane is another one.
    FormatError
        A file of a polygon is invalid.
    MissingDependencyError
        shapely is not installed.
    OSError
        A file of a polygon cannot be opened.

    See Also
    --------
    Surface.trim : Leaves out whole faces.
    Surface.volume : Measures inside of a polygon, without cutting.

    Notes
    -----
    Which sides cross is decided exactly. Where the border crosses a side, the row is the crossing,
    rounded once; its height is that along the side. So the parts inside and outside of one polygon
    have the same rows at the border, bit for bit. Each is a surface of its own: of the planar
    triangulation of its rows, with sides of faces as constraints where it needs them.

    Examples
    --------
    >>> import liftmesh
    >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 4], [0, 4, 0], [4, 4, 4]])
    >>> lot = [[1, 1], [3, 1], [3, 3], [1, 3]]
    >>> inside, outside = slope.clip(lot), slope.clip(lot, invert=True)
    >>> inside.bounds, inside.area(planar=True), outside.area(planar=True)
    ((1.0, 1.0, 3.0, 3.0), 4.0, 12.0)
    """
    is_inverse = as_switch("invert", invert)
    check_progress(progress)
    check_exact(surface.frame)
    polygons = polygons_over(surface, polygon)
    found = _Cut.of(surface, polygons, part_of(progress, 0.0, _CUT)).part(inverse=is_inverse)
    if progress is not None:
        progress(1.0)
    return found


def polygons_over(surface: OverPlane, polygon: object) -> list[Polygon]:
    """Convert valid polygons; no ring repeats its first corner."""
    found = polygons_in(plane_system(surface), polygon)
    valid_shapes(found, scale_of(*(ring for rings in found for ring in rings)))
    return [
        [ring[:-1] if (ring[0] == ring[-1]).all() else ring for ring in rings] for rings in found
    ]


@dataclass(frozen=True, slots=True, eq=False)
class _Cut(Generic[AnySurface]):
    """A surface of which some faces were cut along polygons."""

    surface: AnySurface
    polygons: list[Polygon]
    whole: Integers  # faces that are not cut
    overlay: Overlay | None  # of those that are

    @classmethod
    def of(
        cls, surface: AnySurface, polygons: list[Polygon], progress: Progress | None = None
    ) -> _Cut[AnySurface]:
        """Cut the faces that the border touches; with neighbours whose sides these would bend."""
        tails, heads = sides_of(polygons)
        is_cut = np.zeros(surface.triangulation.nsimplex, dtype=np.bool_)
        touched: Array = LineCrossings(surface).passages(tails, heads)[1]
        overlay, rounds = None, 0
        while len(touched):
            part = part_of(progress, 1 - 0.5**rounds, 1 - 0.5 ** (rounds + 1))
            rounds += 1
            is_cut[touched] = True
            layer = Layer.of(surface, np.flatnonzero(is_cut))
            overlay = Overlay.of([layer], polygons, part)
            bent = layer.sides[~overlay.whole_sides(0) & (layer.owners < 0).any(axis=1)]
            touched = _faces_with(surface, layer.rows[bent], ~is_cut & ~mask_of(surface))
        whole = np.flatnonzero(~is_cut & ~mask_of(surface))
        return cls(surface, polygons, whole, overlay)

    def between(self) -> list[Floats]:
        """Return the places of rows on each side of the polygons, between its ends."""
        if self.overlay is not None:
            return self.overlay.on_polygons(np.stack(sides_of(self.polygons), axis=1))
        return [np.empty((0, 2)) for _ in sides_of(self.polygons)[0]]

    def part(self, *, inverse: bool) -> AnySurface:
        """Make the surface of what is inside, or outside."""
        tri = self.surface.triangulation
        corners = tri.simplices[self.whole]
        shown = corners[contains(self.polygons, tri.points[corners[:, 0]]) != inverse]
        faces, edges, rows = [shown], [], None
        if self.overlay is not None:
            laid = self.overlay
            cut = laid.tri.simplices[(laid.faces(0) >= 0) & (laid.inside != inverse)]
            rows = added_rows(laid, cut, laid.heights(0))
            faces.append(rows.names[cut])
            edges.append(rows.names[laid.pieces(0, _breaklines(self.surface))])
        return surface_of(self.surface, faces, edges, rows)


@dataclass(frozen=True, slots=True, eq=False)
class AddedRows:
    """What rows of an overlay become: rows of its first surface, or new ones after these."""

    names: Rows
    points: Floats  # (r, 3)


def added_rows(laid: Overlay, used: Rows, heights: Floats) -> AddedRows:
    """Number the rows of triangles, by x, then y."""
    surface, first = laid.layers[0].surface, len(laid.layers[0].surface.vertices)
    names = np.full(len(laid.tri.points), -1, dtype=np.int32)
    names[laid.rows(0)] = laid.layers[0].rows
    new = np.setdiff1d(used_rows(len(names), used), laid.rows(0))
    new = new[np.lexsort(laid.tri.points[new].T[::-1])]
    names[new] = first + np.arange(len(new), dtype=np.int32)
    return AddedRows(names, in_space(surface.frame, laid.tri.points[new], heights[new]))


def surface_of(
    surface: AnySurface, faces: list[Rows], edges: list[Rows], added: AddedRows | None
) -> AnySurface:
    """Make a surface of faces between its own rows, and others that were added."""
    joined = np.concatenate(faces)
    if not len(joined):
        raise InputError("no face is left: give a polygon over the faces")
    cloud = replace(as_cloud(surface), faces=None, edges=None)
    if added is not None:
        flags = np.ones(len(added.points), dtype=np.uint8)
        cloud = extended(cloud, surface.frame, added.points, flags, STEINER)
    own = getattr(surface.triangulation, "constraints", np.empty((0, 2), dtype=np.int32))
    lines = np.concatenate([own, *edges])
    return _of_used(surface, cloud, joined, lines[(lines >= 0).all(axis=1)])


def _of_used(surface: AnySurface, cloud: Cloud, faces: Rows, lines: Rows) -> AnySurface:
    """Make such a surface of the rows of a cloud that faces use, with lines between these."""
    used = used_rows(len(cloud), faces)
    place = np.full(len(cloud), -1, dtype=np.int32)
    place[used] = np.arange(len(used), dtype=np.int32)
    lines = place[lines]
    mesh = replace(
        cloud.select(used),
        faces=place.take(faces, axis=0),
        edges=lines[(lines >= 0).all(axis=1)] if len(lines) else None,
        metadata={k: v for k, v in cloud.metadata.items() if k not in (LIFTED, MARKERS)},
        attributes={k: v[used] for k, v in cloud.attributes.items() if k != HIDDEN},
    )
    return type(surface)(**fields_of(mesh, surface.frame.name))


def sides_of(polygons: list[Polygon]) -> tuple[Floats, Floats]:
    """Return the ends of the sides of polygons."""
    rings = [ring for rings in polygons for ring in rings]
    heads = [np.roll(ring, -1, axis=0) for ring in rings]
    return np.concatenate(rings), np.concatenate(heads)


def _breaklines(surface: SurfaceData) -> Integers:
    """Return the keys of the edges that the surface has to have."""
    edges = getattr(surface.triangulation, "constraints", np.empty((0, 2), dtype=np.int32))
    return pair_keys(*edges.T)


def _faces_with(surface: SurfaceData, sides: Rows, among: Mask) -> Integers:
    """Return the faces that have one of some sides."""
    if not len(sides):
        return np.empty(0, dtype=np.intp)
    corners = surface.triangulation.simplices
    is_end = np.zeros(len(surface.triangulation.points), dtype=np.bool_)
    is_end[sides] = True
    near = np.flatnonzero(among & (is_end.take(corners, axis=0).sum(axis=1) > 1))
    ends = np.sort(np.stack([corners[near], corners[near][:, [1, 2, 0]]], axis=2), axis=2)
    keys = pair_keys(*np.sort(sides, axis=1).T)
    return near[np.isin(pair_keys(ends[..., 0], ends[..., 1]), keys).any(axis=1)]


def paste(surface: AnySurface, other: AnySurface, polygon: object) -> AnySurface:
    """Put another surface in the place of what is inside a polygon: one surface of both.

    Parameters
    ----------
    surface : Surface
        What stays outside, over the plane "xy", "xz" or "yz".
    other : Surface
        What comes inside, over the same plane. It has to reach as far as the polygon does, but
        where the first surface has no faces either.
    polygon : object
        As for `Surface.clip`.

    Returns
    -------
    Surface
        The faces of the other surface inside, cut along the border, and those of the first one
        outside. The border has the heights of the other surface, so there is no step: faces of the
        first one that the border cuts lean to it, all others stay. First come the rows of the first
        surface, then those of the other one with the border. Values stay that both have.

    Raises
    ------
    InputError
        The surfaces are over different planes or in different coordinate systems, the polygon is
        invalid, or the other surface has no face at a place of the border where the first one has;
        or the border runs along sides of faces of both, nearer to them than doubles can tell.
    FormatError, MissingDependencyError, OSError
        As for `Surface.clip`.

    See Also
    --------
    Surface.clip : One part alone.
    difference : How two surfaces differ.

    Examples
    --------
    >>> import liftmesh
    >>> site = liftmesh.triangulate([[0, 0, 0], [9, 0, 0], [0, 9, 0], [9, 9, 0]])
    >>> pad = liftmesh.triangulate([[2, 2, 1], [7, 2, 1], [2, 7, 1], [7, 7, 1]])
    >>> built = liftmesh.paste(site, pad, [[3, 3], [6, 3], [6, 6], [3, 6]])
    >>> built.sample([[4, 4], [0, 0]]).tolist(), built.area(planar=True)
    ([1.0, 0.0], 81.0)
    """
    check_pair(surface, other)
    check_exact(surface.frame)
    polygons = polygons_over(surface, polygon)
    return _pasted(surface, other, polygons, _MOST_ROUNDS)


def _pasted(
    surface: AnySurface, other: AnySurface, polygons: list[Polygon], rounds: int
) -> AnySurface:
    """Put what is inside of polygons in the place of that of the other surface.

    Where sides of faces are as near to the border as rounding, the two are cut at places of their
    own: then all of these become corners of the polygons, in so many rounds.
    """
    cut, pasted = _Cut.of(surface, polygons), _Cut.of(other, polygons)
    inside = pasted.part(inverse=False)
    try:
        outside = cut.part(inverse=True)
    except InputError:  # no face is left
        return inside
    sides = np.stack(sides_of(polygons), axis=1)
    own, others = cut.between(), pasted.between()
    both = [np.concatenate(each) for each in zip(own, others, strict=True)]
    side = np.repeat(np.arange(len(both)), [len(each) for each in both])
    joined = along_sides(sides, side, np.concatenate(both))
    try:
        return _joined(outside, inside, _chains(sides, joined, own), _chains(sides, joined, others))
    except InputError as error:
        if not _covers(other, sides[:, 0]):
            raise
        apart = error
    if rounds > 1:
        return _pasted(surface, other, _with_places(polygons, joined), rounds - 1)
    raise InputError(
        f"the border of the polygon that begins at {tuple(sides[0, 0].tolist())} runs along sides "
        "of faces, nearer to them than float64 can tell, and the two surfaces are cut at different "
        "places there: move it by some millionths of its size, or let its corners be vertices"
    ) from apart


def _covers(surface: SurfaceData, places: Floats) -> bool:
    """Whether there is a face at all of some places."""
    face = surface.triangulation.find_simplex(places)
    return bool((face >= 0).all() and not mask_of(surface)[face].any())


def _with_places(polygons: list[Polygon], joined: list[Floats]) -> list[Polygon]:
    """Put places on each side of polygons between its ends, as further corners."""
    between = iter(joined)

    def ring_with(ring: Floats) -> Floats:
        parts = [each for corner in ring for each in (corner[None], next(between))]
        found: Floats = np.concatenate(parts)
        return found[starts_of_runs(found)]

    return [[ring_with(ring) for ring in rings] for rings in polygons]


def _chains(sides: Floats, joined: list[Floats], own: list[Floats]) -> dict[Side, list[Place]]:
    """Return what is between the corners of one surface along polygons, in both directions."""
    chains: dict[Side, list[Place]] = {}
    for (tail, head), places, known in zip(sides, joined, own, strict=True):
        corners = {*_places(known), *_places(head[None])}
        last, inner = _places(tail[None])[0], []
        for place in _places(np.concatenate([places, head[None]])):
            if place not in corners:
                inner.append(place)
                continue
            chains[last, place], chains[place, last] = inner, inner[::-1]
            last, inner = place, []
    return chains


def _places(points: Floats) -> list[Place]:
    return [*map(tuple, (points + 0.0).tolist())]


def _joined(
    outside: AnySurface,
    inside: AnySurface,
    chains: dict[Side, list[Place]],
    inner_chains: dict[Side, list[Place]],
) -> AnySurface:
    """Join two surfaces along a border, which has the rows of both, and heights of the second."""
    count = len(outside.vertices)
    at_border = {place for side in chains for place in (*side, *chains[side])}
    own, others = (_places(each.triangulation.points) for each in (outside, inside))
    row_at = {place: row for row, place in enumerate(others) if place in at_border}
    added = [
        (place, row_at[u], row_at[v])
        for (u, v), inner in inner_chains.items()
        if u < v and u in row_at and v in row_at
        for place in inner
    ]
    second = _with_rows(inside, added)
    row_at.update({place: len(others) + k for k, (place, *_) in enumerate(added)})
    others += [place for place, *_ in added]
    rows = np.arange(len(others), dtype=np.int32)
    faces = _divided(inside.faces, others, rows, row_at, inner_chains)
    names = np.arange(count, dtype=np.int32)
    row_at = {place: count + row for place, row in row_at.items()}
    for row, place in enumerate(own):
        if place in at_border:
            if place not in row_at:
                raise InputError(
                    f"the surface to paste has no face at {place}, on the border, where the other "
                    "one has: give a polygon that it covers"
                )
            names[row] = row_at[place]
    outer = _divided(outside.faces, own, names, row_at, chains)
    none = np.empty((0, 2), np.int32)
    one, two = (getattr(each.triangulation, "constraints", none) for each in (outside, inside))
    return _of_used(
        outside,
        _concatenated(as_cloud(outside), second),
        np.concatenate([outer, faces + np.int32(count)]),
        np.concatenate([names[one], two + np.int32(count)]),
    )


def _with_rows(surface: SurfaceData, added: list[tuple[Place, int, int]]) -> Cloud:
    """Add rows on sides of faces."""
    if not added:
        return as_cloud(surface)
    places = np.array([place for place, *_ in added])
    ends = np.array([rows for _, *rows in added])
    heights = surface.frame.heights(surface.vertices)
    points = surface.triangulation.points
    found = along(points[ends], places, *heights[ends.T])
    flags = np.ones(len(added), dtype=np.uint8)
    rows = in_space(surface.frame, places, found)
    return extended(as_cloud(surface), surface.frame, rows, flags, STEINER)


def _divided(
    faces: Rows,
    places: list[Place],
    names: Rows,
    row_at: dict[Place, int],
    chains: dict[Side, list[Place]],
) -> Rows:
    """Name the rows of faces anew, and divide faces at the corners that the border has on sides."""
    is_border = np.array([place in row_at for place in places])
    is_near = is_border.take(faces, axis=0).sum(axis=1) > 1
    done = names[faces[~is_near]].tolist()
    pending = [[(int(names[row]), places[row]) for row in face] for face in faces[is_near].tolist()]
    while pending:
        a, b, c = pending.pop()
        for u, v, w in ((a, b, c), (b, c, a), (c, a, b)):
            inner = chains.get((u[1], v[1]), ())
            if inner:
                chain = [u, *((row_at[place], place) for place in inner), v]
                pending += [[one, two, w] for one, two in pairwise(chain)]
                break
        else:
            done.append([a[0], b[0], c[0]])
    return np.array(done, dtype=np.int32).reshape(-1, 3)


def _concatenated(one: Cloud, two: Cloud) -> Cloud:
    """Join the rows of two clouds, with the values that both have."""
    shared = [
        key
        for key, each in one.attributes.items()
        if key in two.attributes and two.attributes[key].shape[1:] == each.shape[1:]
    ]
    return replace(
        one,
        points=np.concatenate([one.points, two.points]),
        attributes={k: np.concatenate([one.attributes[k], two.attributes[k]]) for k in shared},
        colors=None,
        normals=None,
        faces=None,
        edges=None,
    )
