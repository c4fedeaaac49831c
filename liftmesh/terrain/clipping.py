"""Surfaces cut along polygons: the part inside, the part outside, and one pasted into another.

Only the faces that a polygon's border touches are cut (`cutting.py`); all others are inside or
outside as a whole, as one of their corners tells. What is cut keeps its plane: the sides of all
faces stay, and what triangulates the parts of a face is inside of it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Array, Floats, Integers, Mask, Rows
from liftmesh.base.arrays import pair_keys, used_rows
from liftmesh.base.options import as_switch
from liftmesh.errors import InputError
from liftmesh.io.metadata import LIFTED
from liftmesh.io.tags import MARKERS
from liftmesh.terrain.boundary import mask_of
from liftmesh.terrain.breaklines import check_exact, extended, in_space
from liftmesh.terrain.cutting import Layer, Overlay
from liftmesh.terrain.measures import scale_of, valid_shapes
from liftmesh.terrain.profile import LineCrossings
from liftmesh.terrain.refinement import STEINER
from liftmesh.terrain.surface_data import HIDDEN, SurfaceData, as_cloud, plane_system
from liftmesh.vector.polygons import contains, polygons_in

if TYPE_CHECKING:
    from liftmesh.terrain.surface import Surface
    from liftmesh.vector.polygons import Polygon


def clip(surface: Surface, polygon: object, *, invert: bool = False) -> Surface:
    """Cut the faces along a polygon, and keep what is inside: the same surface, bounded by it.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud, over the plane "xy", "xz" or "yz".
    polygon : object
        As for `trim`, and valid; of several, what they cover together.
    invert : bool, default False
        Keep what is outside instead.

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
    check_exact(surface.frame)
    polygons = polygons_in(plane_system(surface), polygon)
    check_polygons(polygons)
    return _Cut.of(surface, polygons).part(inverse=is_inverse)


def check_polygons(polygons: list[Polygon]) -> None:
    """Raise for polygons that are not valid."""
    rings = (ring for rings in polygons for ring in rings)
    valid_shapes(polygons, scale_of(*rings))


@dataclass(frozen=True, slots=True, eq=False)
class _Cut:
    """A surface of which some faces were cut along polygons."""

    surface: Surface
    polygons: list[Polygon]
    whole: Integers  # faces that are not cut
    overlay: Overlay | None  # of those that are

    @classmethod
    def of(cls, surface: Surface, polygons: list[Polygon]) -> _Cut:
        """Cut the faces that the border touches; with neighbours whose sides these would bend."""
        tails, heads = sides_of(polygons)
        is_cut = np.zeros(surface.triangulation.nsimplex, dtype=np.bool_)
        touched: Array = LineCrossings(surface).passages(tails, heads)[1]
        overlay = None
        while len(touched):
            is_cut[touched] = True
            layer = Layer.of(surface, np.flatnonzero(is_cut))
            overlay = Overlay.of([layer], polygons)
            bent = layer.sides[~overlay.whole_sides(0) & (layer.owners < 0).any(axis=1)]
            touched = _faces_with(surface, layer.rows[bent], ~is_cut & ~mask_of(surface))
        whole = np.flatnonzero(~is_cut & ~mask_of(surface))
        return cls(surface, polygons, whole, overlay)

    def part(self, *, inverse: bool) -> Surface:
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
    surface: Surface, faces: list[Rows], edges: list[Rows], added: AddedRows | None
) -> Surface:
    """Make a surface of faces between its own rows, and others that were added."""
    from liftmesh.terrain.meshes import as_surface  # noqa: PLC0415 - makes surfaces

    joined = np.concatenate(faces)
    if not len(joined):
        raise InputError("no face is left: give a polygon over the faces")
    cloud = replace(as_cloud(surface), faces=None, edges=None)
    if added is not None:
        flags = np.ones(len(added.points), dtype=np.uint8)
        cloud = extended(cloud, surface.frame, added.points, flags, STEINER)
    own = getattr(surface.triangulation, "constraints", np.empty((0, 2), dtype=np.int32))
    used = used_rows(len(cloud), joined)
    place = np.full(len(cloud), -1, dtype=np.int32)
    place[used] = np.arange(len(used), dtype=np.int32)
    lines = np.concatenate([own, *edges])
    lines = place[lines[(lines >= 0).all(axis=1)]]
    mesh = replace(
        cloud.select(used),
        faces=place[joined],
        edges=lines[(lines >= 0).all(axis=1)] if len(lines) else None,
        metadata={k: v for k, v in cloud.metadata.items() if k not in (LIFTED, MARKERS)},
        attributes={k: v[used] for k, v in cloud.attributes.items() if k != HIDDEN},
    )
    return as_surface(mesh, plane=surface.frame.name)


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
    near = np.flatnonzero(among & (is_end[corners].sum(axis=1) > 1))
    ends = np.sort(np.stack([corners[near], corners[near][:, [1, 2, 0]]], axis=2), axis=2)
    keys = pair_keys(*np.sort(sides, axis=1).T)
    return near[np.isin(pair_keys(ends[..., 0], ends[..., 1]), keys).any(axis=1)]
