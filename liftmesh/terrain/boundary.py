"""The boundary of a surface: faces left out of it, its rings, and solids that close it.

A trimmed surface is a mask over the same triangles: nothing is triangulated again, and masks
compose. Long thin triangles along the hull, and those across bays, go without opening the gaps in
the middle if trimming begins at the boundary.

The walls of a solid stand on the rings of the boundary. Where two parts of the surface touch in a
vertex only, four walls would meet in one line there, and no program agrees on what is inside: such
vertices are refused, or the faces at them left out. Under a surface that is not trimmed a flat base
needs no more corners than the rim has, since the triangulation of these fills a convex region. A
corner may be at the height of the base: on the rim it is a corner of the base, too.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.arrays import used_rows
from liftmesh.base.cloud import Cloud
from liftmesh.base.options import Pinched, as_number, as_positive, as_switch, check_option
from liftmesh.errors import DataWarning, InputError, Option
from liftmesh.optional import load
from liftmesh.planar.alpha import radii_of
from liftmesh.planar.delaunay import delaunay
from liftmesh.terrain.measures import planar_areas
from liftmesh.terrain.surface_data import AnySurface, SurfaceData, ordered_corners, slope_scale
from liftmesh.vector.polygons import contains, polygons_in

_LEAST_WALL = 1.0  # mm
_SLIVER = 10  # times longer than wide


def trim(
    surface: AnySurface,
    *,
    max_edge: float | None = None,
    boundary_only: bool = False,
    max_radius: float | None = None,
    polygon: object = None,
) -> AnySurface:
    """Make a copy without some of the faces; vertices and triangulation stay as they are.

    Parameters
    ----------
    surface : Surface
        The surface to copy.
    max_edge : float, optional
        Leave out faces with a side that is longer in the plane.
    boundary_only : bool, default False
        Leave out only those that such a side connects with the outside: faces whose long side
        is on the boundary, then those whose long side has become part of it, and so on. Gaps
        inside stay closed.
    max_radius : float, optional
        Leave out faces whose circumcircle has a larger radius: what is left is the alpha shape
        of the points for this alpha.
    polygon : object, optional
        Leave out faces whose centroid is outside: a polygon with holes, or several, which may
        overlap, as GeoJSON (a dict or a file), a GeoPackage or a shapefile, any object with
        ``__geo_interface__`` as those of shapely, or an array of shape (k, 2). Coordinates are
        those of the plane.

    Returns
    -------
    Surface
        Shares everything with this one but ``faces`` and ``mask``. Faces that were left out
        before stay so.

    Raises
    ------
    InputError
        A length is not positive, the polygon is none or known to be in another coordinate
        system, nothing is asked for, or no face is left.
    FormatError
        A file of a polygon is invalid.
    MissingDependencyError
        Polygons of a shapefile that have several rings need shapely.
    OSError
        It cannot be opened.

    See Also
    --------
    Surface.boundary : The rings around the faces that are left.
    Surface.replace : Other changes.

    Examples
    --------
    >>> import liftmesh
    >>> points = [[0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1], [9, 2, 1]]
    >>> surface = liftmesh.triangulate(points)
    >>> surface.trim(max_edge=2), surface.trim(max_radius=1).mask.tolist()
    (<Surface of 2 triangles over 5 vertices>, [False, False, True, True])
    """
    left_out = mask_of(surface).copy()
    corners = surface.triangulation.points.take(surface.triangulation.simplices, axis=0)
    inwards = as_switch("boundary_only", boundary_only)
    if max_edge is None and max_radius is None and polygon is None:
        raise InputError(
            f"nothing is asked for: give {Option('max_edge')}, {Option('max_radius')} or a polygon"
        )
    if inwards and max_edge is None:
        raise InputError(f"{Option('boundary_only')} needs {Option('max_edge')}")
    if max_radius is not None:
        left_out |= radii_of(surface.triangulation, is_up=True) > _length("max_radius", max_radius)
    if polygon is not None:
        left_out |= ~contains(polygons_in(surface.crs, polygon), centroids(corners))
    if max_edge is not None:
        is_long = _sides(corners) > _length("max_edge", max_edge)
        left_out = _from_rim(surface, is_long, left_out) if inwards else left_out | is_long.any(1)
    return masked(surface, left_out)


def boundary(surface: SurfaceData) -> list[Rows]:
    """Return the boundary of the faces as closed rings.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud.

    Returns
    -------
    list of (k,) ndarray of int32
        Rows of the vertices, the first not repeated. Faces are to the left: outer rings turn
        counter-clockwise, those around gaps clockwise. No ring visits a vertex twice; two may
        share some. Each begins at its lexicographically least vertex, and they are in the order
        of these.

    See Also
    --------
    Surface.trim : Leave out faces.
    Surface.solid : Close the faces by walls and a base.

    Examples
    --------
    >>> import liftmesh
    >>> liftmesh.triangulate([[0, 0, 1], [1, 0, 1], [0, 1, 1], [1, 1, 1]]).boundary()
    [array([0, 1, 3, 2], dtype=int32)]
    """
    solved = surface.triangulation
    rows, starts = _kernel.rings(
        solved.points,
        np.ascontiguousarray(solved.simplices),
        np.ascontiguousarray(solved.neighbors),
        None if surface.mask is None else surface.mask.view(np.uint8),
    )
    return np.split(rows, starts[1:-1])


def mask_of(surface: SurfaceData) -> Array:
    """Return which triangles of the triangulation are left out."""
    if surface.mask is None:
        return np.zeros(surface.triangulation.nsimplex, dtype=np.bool_)
    return surface.mask


def masked(surface: AnySurface, left_out: Array) -> AnySurface:
    """Make a copy that leaves out faces; without any, its faces are the triangulation's own."""
    if left_out.all():
        raise InputError("no face is left: give larger limits, or a polygon over the faces")
    simplices = surface.triangulation.simplices
    if not left_out.any():
        return replace(surface, faces=simplices, mask=None)
    return replace(surface, faces=simplices[~left_out], mask=left_out)


def _from_rim(surface: SurfaceData, is_long: Array, left_out: Array) -> Array:
    """Leave out faces with a long side on the boundary, from there inwards."""
    flags = left_out.view(np.uint8)
    neighbors = np.ascontiguousarray(surface.triangulation.neighbors)
    _kernel.leave_out_from_rim(neighbors, is_long.view(np.uint8), flags)
    return flags.view(np.bool_)


def _sides(corners: Floats) -> Floats:
    """Compute the lengths of the sides opposite each corner, (m, 3)."""
    with np.errstate(over="ignore"):
        across = np.roll(corners, 1, axis=1) - np.roll(corners, -1, axis=1)
        lengths: Floats = np.hypot(across[..., 0], across[..., 1])
    return lengths


def centroids(corners: Floats) -> Floats:
    """Compute centroids; the order of the corners changes no bit."""
    a, b, c = np.moveaxis(ordered_corners(corners), 1, 0)
    middles: Floats = a / 3 + b / 3 + c / 3
    return middles


def _length(name: str, value: Any) -> float:
    return as_number(name, value, "a positive length", lambda length: length > 0)


def closed_solid(
    surface: SurfaceData,
    base_height: float | None = None,
    *,
    thickness: float | None = None,
    pinched: Pinched = "error",
    longest: float | None = None,
    z_factor: float | None = None,
    base_mm: float | None = None,
    thickness_mm: float | None = None,
) -> Cloud:
    """Close the faces by walls and a base.

    Parameters
    ----------
    surface : Surface
        What is closed.
    base_height : float, optional
        The height of a flat base, below all faces; they may touch it in single corners.
    thickness : float, optional
        In place of it: the base is the surface itself, lower by so much.
    pinched : {"error", "trim"}, default "error"
        Where faces touch in a vertex only, which no solid can: refuse, or leave out all faces
        at such vertices.
    longest : float, optional
        Scale the solid to this length in x or y, whichever is longer, in millimetres to print
        it, and move it: it begins at 0 in all directions. Without it, it stays in its place.
    z_factor : float, optional
        With ``longest``: what heights are multiplied by before, as for `slopes_at`.
    base_mm : float, optional
        With ``longest``, in place of a height: the flat base is so many millimetres of the print
        below the lowest vertex.
    thickness_mm : float, optional
        With ``longest``: `thickness` in millimetres of the print.

    Returns
    -------
    Cloud
        A closed mesh: the rows of the faces, then those of the base. Faces are
        counter-clockwise from outside. Colours and named values are not part of it.

    Raises
    ------
    InputError
        There is not one of `base_height`, `thickness`, `base_mm` and `thickness_mm`, a number is
        none that it can be, the surface reaches its base, or faces touch in a vertex only.

    Warns
    -----
    DataWarning
        With ``longest``: the thinnest wall, measured upright above a flat base and across the faces
        of a shell, has less than 1 mm. A face that is steep for no longer than the wall is thick
        makes no thin wall; and faces along the boundary that are ten times longer there than wide,
        with those behind them, do not count.

    See Also
    --------
    Surface.trim : Fewer faces.
    Surface.boundary : The rings that the walls stand on.
    write : Write it to a file, as STL or 3MF.

    Examples
    --------
    >>> import liftmesh
    >>> hill = liftmesh.triangulate([[0, 0, 1], [4, 0, 1], [0, 4, 1], [4, 4, 1], [2, 2, 4]])
    >>> block = hill.solid(base_height=0)
    >>> block.points.shape, block.faces.shape
    ((9, 3), (14, 3))
    """
    bases = {"base_height": base_height, "thickness": thickness}
    bases |= {"base_mm": base_mm, "thickness_mm": thickness_mm}
    return solid_and_wall(surface, bases, pinched, longest, z_factor)[0]


def solid_and_wall(
    surface: SurfaceData,
    bases: Mapping[str, float | None],
    pinched: Pinched,
    longest: float | None,
    z_factor: float | None,
) -> tuple[Cloud, float | None]:
    """Close the faces; return also the thinnest wall in millimetres, if it is scaled to them."""
    check_option("pinched", pinched, Pinched)
    base, value = _base(bases)
    scale = None if longest is None else as_positive("longest", longest, "a positive length")
    for name in ("z_factor", *(each for each in bases if each.endswith("_mm"))):
        if scale is None and {**bases, "z_factor": z_factor}[name] is not None:
            raise InputError(
                f"{Option(name)} goes with {Option('longest')}, which says how large the print is"
            )
    surface = _unpinched(surface, pinched)
    top = used_rows(len(surface.vertices), surface.faces)
    heights = surface.frame.heights(surface.vertices[top])
    rise = None if scale is None else _rise(surface, top, scale, z_factor)
    depth = value / rise[1] if rise is not None and base.endswith("_mm") else value
    is_flat = base.startswith("base")
    flat = depth if base == "base_height" else heights.min() - depth
    lower = np.full(len(top), flat) if is_flat else heights - depth
    parts = _Parts(surface, top, heights, lower, is_flat=is_flat)
    parts.check()
    points = parts.points() if rise is None else parts.scaled(*rise)
    solid = Cloud(points, faces=parts.faces(), crs=surface.crs if rise is None else None)
    return solid, None if rise is None else _warned(parts.thinnest(points, rise[1]))


def _warned(wall: float) -> float:
    """Warn of a wall that most printers cannot make."""
    if wall < _LEAST_WALL:
        warnings.warn(
            f"the thinnest wall has {wall:.2g} mm, less than the 1 mm that printers need: give "
            f"more for {Option('base_mm')} or {Option('thickness_mm')}, or a larger "
            f"{Option('longest')}",
            DataWarning,
            stacklevel=5,
        )
    return wall


def _apart(corners: Floats, gap: float) -> Floats:
    """Compute the distances of faces, (m, 3, 3), from copies that are so much lower.

    It is that of the copy's way up from all differences of two points of the face: a hexagon.
    """
    a, b, c = np.moveaxis(corners, 1, 0)
    normals = np.cross(b - a, c - a)
    lengths = np.sqrt((normals * normals).sum(axis=1))
    normals /= np.where(lengths > 0, lengths, np.inf)[:, None]
    up, upright = np.array([0, 0, gap]), gap * normals[:, 2]
    foot = up - upright[:, None] * normals
    is_inside, found = np.ones(len(a), np.bool_), np.full(len(a), np.inf)
    hexagon = [b - a, c - a, c - b, a - b, a - c, b - c]
    for tail, head in zip(hexagon, [*hexagon[1:], hexagon[0]], strict=True):
        side = head - tail
        is_inside &= (normals * np.cross(side, foot - tail)).sum(axis=1) >= 0
        share = ((up - tail) * side).sum(axis=1) / (side * side).sum(axis=1)
        apart = tail + np.clip(share, 0, 1)[:, None] * side - up
        found = np.minimum(found, np.sqrt((apart * apart).sum(axis=1)))
    return np.where(is_inside, upright, found)


def _rise(
    surface: SurfaceData, top: Rows, longest: float, z_factor: float | None
) -> tuple[float, float]:
    """Return the millimetres of a unit in the plane, and of a unit of heights."""
    planar = surface.triangulation.points[top]
    with np.errstate(all="ignore"):
        scale = longest / (planar.max(axis=0) - planar.min(axis=0)).max()
        millimetres = float(scale), float(scale * slope_scale(surface, z_factor)[0])
    if not np.isfinite(millimetres).all() or min(millimetres) <= 0:
        raise InputError("the solid is beyond the largest double: give a smaller length")
    return millimetres


@dataclass(frozen=True, slots=True)
class _Parts:
    """The rows of a surface that are corners of faces, their heights, and those below them."""

    surface: SurfaceData
    top: Rows
    heights: Floats
    lower: Floats
    is_flat: bool

    def check(self) -> None:
        """Raise unless the surface is above its base, but for single corners."""
        gap = self.heights - self.lower
        worst = int(np.argmin(gap))
        if gap[worst] > 0:
            return
        if gap[worst] < 0 or not self.is_flat:
            raise InputError(
                f"the surface reaches its base: row {self.top[worst]} has the height "
                f"{self.heights[worst]}, the base {self.lower[worst]}: give a lower one"
            )
        touching = (gap == 0)[self._above()].sum(axis=1)
        if touching.max() > (2 if self._is_convex() else 1):
            rows = self.surface.faces[np.argmax(touching)].tolist()
            raise InputError(
                f"the face of the rows {rows} touches the base along a side: give a lower base"
            )

    def faces(self) -> Rows:
        """Return the faces of the surface, of the walls and of the base."""
        rings = [np.searchsorted(self.top, ring) for ring in boundary(self.surface)]
        kept, own = self._kept(), self._own()
        below = np.arange(len(self.top))  # where they touch
        below[own] = len(self.top) + np.arange(len(own))
        walls = np.concatenate([_wall(ring, below[ring]) for ring in rings])
        has_area = (walls[:, 0] != walls[:, 2]) & (walls[:, 1] != walls[:, 2])
        parts = [self._above(), walls[has_area], below[self._base(kept)]]
        return np.concatenate(parts).astype(np.int32)

    def points(self) -> Floats:
        """Return the rows of the surface, then those of the base, where they are."""
        frame, own = self.surface.frame, self._own()
        upper = self.surface.vertices[self.top]
        lower = frame.raised(upper[own], self.heights[own], self.lower[own])
        return np.concatenate([upper, lower])

    def thinnest(self, points: Floats, rise: float) -> float:
        """Return the thinnest wall: upright, or between the faces of a shell and those below.

        It is exact between a face and its own copy, where small ones have no foot of the
        perpendicular; between others it is that of vertices. A triangulation has long thin faces
        along its hull, which are as steep as they are thin: they do not count.
        """
        gap = float((self.heights - self.lower).min()) * rise
        if self.is_flat:
            return gap
        top = points[: len(self.top)]
        near, _ = load("scipy.spatial").KDTree(top - (0, 0, gap)).query(top)
        apart = _apart(top[self._above()], gap)[~self._slivers()]
        return float(min(near.min(), apart.min(initial=np.inf)))

    def _slivers(self) -> Array:
        """Tell which faces are along the boundary, and far longer there than wide."""
        tri, gone = self.surface.triangulation, mask_of(self.surface)
        corners = tri.points.take(tri.simplices, axis=0)
        is_long = _sides(corners) ** 2 > _SLIVER * 2 * planar_areas(corners)[:, None]
        return _from_rim(self.surface, is_long, gone.copy())[~gone]

    def scaled(self, scale: float, rise: float) -> Floats:
        """Return them in the plane of the surface, scaled, from 0 on."""
        planar = self.surface.triangulation.points[self.top]
        low = planar.min(axis=0)
        with np.errstate(all="ignore"):
            upper, lower = (
                np.column_stack([(planar - low) * scale, (each - self.lower.min()) * rise])
                for each in (self.heights, self.lower)
            )
        points: Floats = np.concatenate([upper, lower[self._own()]])
        if not np.isfinite(points).all():
            raise InputError("the solid is beyond the largest double: give a smaller length")
        return points

    def _above(self) -> Array:
        return np.searchsorted(self.top, self.surface.faces)

    def _own(self) -> Array:
        """Return which corners have a row of the base below them, and do not touch it."""
        kept = self._kept()
        return kept[self.heights[kept] > self.lower[kept]]

    def _is_convex(self) -> bool:
        return self.is_flat and self.surface.mask is None

    def _kept(self) -> Array:
        """Return which corners the base has: those of the rim, if they fill it, or all."""
        if not self._is_convex():
            return np.arange(len(self.top))
        return np.unique(np.searchsorted(self.top, np.concatenate(boundary(self.surface))))

    def _base(self, kept: Array) -> Array:
        """Return the faces of the base, counter-clockwise from below."""
        if not self._is_convex():
            return self._above()[:, ::-1]
        rim = self.surface.triangulation.points[self.top[kept]]
        return kept[delaunay(rim, order="canonical").simplices][:, ::-1]


def _wall(above: Array, below: Array) -> Array:
    """Return two faces for each side of a ring that has the surface on its left."""
    then_above, then_below = np.roll(above, -1), np.roll(below, -1)
    return np.concatenate(
        [
            np.column_stack([below, then_below, then_above]),
            np.column_stack([below, then_above, above]),
        ]
    )


def _base(bases: Mapping[str, Any]) -> tuple[str, float]:
    """Return which base is asked for, and its height, or how much lower it is."""
    given = [name for name, value in bases.items() if value is not None]
    if len(given) != 1:
        raise InputError(f"give one of {', '.join(str(Option(name)) for name in bases)}")
    name = given[0]
    if name == "base_height":
        return name, as_number(name, bases[name], "a finite height")
    return name, as_positive(name, bases[name], "a positive length")


def _unpinched(surface: AnySurface, pinched: Pinched) -> AnySurface:
    """Return a surface whose faces touch in sides only: itself, or without some faces."""
    while len(rows := _pinched_rows(surface)):
        if pinched == "error":
            place = surface.triangulation.points[rows[0]].tolist()
            others = f", and at {len(rows) - 1:,} more" if len(rows) > 1 else ""
            raise InputError(
                f"faces touch in a vertex only at row {rows[0]}, {place}{others}, where no solid "
                f"can be closed: give {Option('pinched', 'trim')} to leave out the faces there"
            )
        flags = np.zeros(surface.triangulation.npoints, dtype=np.bool_)
        flags[rows] = True
        at_them = flags.take(surface.triangulation.simplices, axis=0).any(axis=1)
        surface = masked(surface, mask_of(surface) | at_them)
    return surface


def _pinched_rows(surface: SurfaceData) -> Rows:
    """Return the rows that rings share, ascending."""
    rows, counts = np.unique(np.concatenate(boundary(surface)), return_counts=True)
    return rows[counts > 1]
