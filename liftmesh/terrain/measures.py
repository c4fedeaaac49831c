"""Areas of a surface, volumes between it and a level, and cut and fill between two surfaces.

Each face is measured from its corners in lexicographic order, and the faces are summed exactly,
rounded once: so no bit depends on the order of the rows. A prism between a face and a level that it
crosses is cut along the line where they meet.

Of two surfaces the kernel lays the triangulations over each other (`_core/surface/overlay.hpp`); it
begins with a face of each that touch, which are found here.

Polygons are measured as triangles, which shapely makes of their own corners: laid over two surfaces
as these are over each other, so each common part of three triangles is counted once. A level is
then a surface of two triangles.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.display import card_of
from liftmesh.base.options import as_number, as_switch
from liftmesh.errors import InputError, Option
from liftmesh.io.metadata import Provenance
from liftmesh.io.read import check_grounds
from liftmesh.optional import load
from liftmesh.planar.delaunay import delaunay
from liftmesh.predicates import orient2d
from liftmesh.terrain.surface_data import (
    SurfaceData,
    check_planes,
    corner_order,
    kernel_surface,
    metres_of,
    plane_system,
    slope_scale,
)
from liftmesh.vector.polygons import Polygon, polygons_in, regions_in

if TYPE_CHECKING:
    from liftmesh.planar.triangulation import Triangulation

_MOST_EXPONENT = 64
_FARTHEST = 2.0**64  # shapely crosses lines to 2**-104 of their length
_FEW = 1024  # vertices that are located first
_SPREAD = 32  # faces of each surface whose middles are
_LARGEST = np.finfo(np.float64).max
_SCALED = 2.0**400
Measured: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class VolumeResult:
    """Volumes between a surface and a level, as `Surface.volume` returns them.

    Attributes
    ----------
    above : float
        Of what is under the surface and above the level.
    below : float
        Of what is under the level and above the surface.
    area : float
        The area of the faces in the plane.
    level : float
        The level.
    cubic_metres : float or None
        How many cubic metres a unit of the volumes has; None if the coordinate system does not say
        the units of x, y and z, which may differ.

    See Also
    --------
    Surface.volume, Surface.volume_by_polygon
    CutFillResult : Between two surfaces.

    Examples
    --------
    >>> import liftmesh
    >>> wedge = liftmesh.triangulate([[0, 0, -2], [2, 0, 2], [0, 3, -2], [2, 3, 2]])
    >>> found = wedge.volume()
    >>> found.above, found.below, found.net
    (3.0, 3.0, 0.0)
    """

    above: float
    below: float
    area: float
    level: float
    cubic_metres: float | None = None
    _repr_html_ = card_of

    @property
    def net(self) -> float:
        """What is above less what is below."""
        return self.above - self.below


@dataclass(frozen=True, slots=True)
class CutFillResult:
    """The volumes between two surfaces, as `Surface.cut_and_fill` returns them.

    Attributes
    ----------
    cut : float
        Where the second surface is below the first.
    fill : float
        Where it is above.
    area : float
        The area in the plane on which both have faces.
    cubic_metres : float or None
        As in `VolumeResult`.

    See Also
    --------
    Surface.cut_and_fill, Surface.cut_and_fill_by_polygon
    VolumeResult : Between a surface and a level.

    Examples
    --------
    >>> import liftmesh
    >>> level = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0]])
    >>> slope = liftmesh.triangulate([[0, 0, -1], [4, 0, 3], [0, 4, -1], [4, 4, 3]])
    >>> found = level.cut_and_fill(slope)
    >>> found.cut, found.fill, found.net
    (2.0, 18.0, 16.0)
    """

    cut: float
    fill: float
    area: float
    cubic_metres: float | None = None
    _repr_html_ = card_of

    @property
    def net(self) -> float:
        """The fill less the cut."""
        return self.fill - self.cut


def area_of(surface: SurfaceData, *, planar: bool = False, z_factor: float | None = None) -> float:
    """Compute the area of the faces.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud.
    planar : bool, default False
        Measure their projections to the plane instead.
    z_factor : float, optional
        As for `slopes_at`.

    Returns
    -------
    float
        In square units of x, which y shares.

    Raises
    ------
    InputError
        The area is beyond the largest double, the factor is not positive, or `planar` is
        neither True nor False.

    See Also
    --------
    Surface.volume : Between the faces and a level.

    Examples
    --------
    >>> import liftmesh
    >>> roof = liftmesh.triangulate([[0, 0, 0], [3, 0, 4], [0, 2, 0], [3, 2, 4]])
    >>> roof.area(), roof.area(planar=True)
    (10.0, 6.0)
    """
    is_planar = as_switch("planar", planar)
    corners, heights = faces_of(surface)
    rise, _ = slope_scale(surface, z_factor)
    with np.errstate(all="ignore"):
        areas = planar_areas(corners) if is_planar else _inclined(corners, heights * rise)
        return _total("area", areas)


def volume_of(surface: SurfaceData, level: float = 0.0, *, within: object = None) -> VolumeResult:
    """Compute the volumes between the faces and a level.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud.
    level : float, default 0
        A height above the plane.
    within : object, optional
        As for `cut_and_fill`.

    Returns
    -------
    VolumeResult
        What is above the level, and what is below; only where there are faces.

    Raises
    ------
    InputError
        The level is no finite number, or a volume is beyond the largest double; or the polygon
        is invalid, or has no area in common with the faces.
    FormatError
        A file of a polygon is invalid.
    MissingDependencyError
        shapely is not installed.
    OSError
        A file of a polygon cannot be opened.

    See Also
    --------
    Surface.volume_by_polygon : In each of several polygons.
    Surface.stage_storage : At many levels.
    Surface.cut_and_fill : Between two surfaces.

    Examples
    --------
    >>> import liftmesh
    >>> hill = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0], [2, 2, 6]])
    >>> hill.volume().above, hill.volume(3).above
    (32.0, 4.0)
    """
    at = as_number("level", level, "a finite height")
    if within is not None:
        measure = partial(_level_within, surface, at)
        return VolumeResult(*_in_all(surface, within, measure), at, cubic_metres_of(surface))
    corners, heights = faces_of(surface)
    with np.errstate(all="ignore"):
        areas = planar_areas(corners)
        parts = prisms(areas, np.sort(heights - at, axis=1))
    above, below = (_total("volume", each) for each in parts)
    return VolumeResult(above, below, _total("area", areas), at, cubic_metres_of(surface))


def volumes_by_polygon(
    surface: SurfaceData, within: object, level: float = 0.0, *, by: str = "name"
) -> dict[str | int, VolumeResult]:
    """Compute the volumes between the faces and a level in each of several polygons.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud.
    within : object
        As for `cut_and_fill_by_polygon`.
    level : float, default 0
        A height above the plane.
    by : str, default "name"
        As for `cut_and_fill_by_polygon`.

    Returns
    -------
    dict of str or int to VolumeResult
        As from `volume_of`, for each polygon; zeros where it has no area in common with the faces.

    Raises
    ------
    InputError
        As for `volume_of`, or two polygons have one name, or none has the property.
    FormatError, MissingDependencyError, OSError
        As for `volume_of`.

    See Also
    --------
    Surface.volume : In all of them together.
    Surface.cut_and_fill_by_polygon : Between two surfaces.

    Examples
    --------
    >>> import liftmesh
    >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 4], [0, 4, 0], [4, 4, 4]])
    >>> found = slope.volume_by_polygon([[1, 1], [3, 1], [3, 3], [1, 3]])
    >>> round(found[0].above, 9)
    8.0
    """
    at, unit = as_number("level", level, "a finite height"), cubic_metres_of(surface)
    volumes = _in_each(surface, within, partial(_level_within, surface, at), by)
    return {name: VolumeResult(*each, at, unit) for name, each in volumes}


def cut_and_fill(
    surface: SurfaceData, other: SurfaceData, *, within: object = None
) -> CutFillResult:
    """Compute the volumes between this surface and another one.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud.
    other : Surface
        What this one becomes, over the same plane. The surfaces need not have the same points,
        nor cover the same area.
    within : object, optional
        Measure inside of it alone, cut at its border: as for `trim`, and valid. Of several,
        what they cover together; it needs ``pip install 'liftmesh[shapes]'``.

    Returns
    -------
    CutFillResult
        What is to be cut, and to be filled; only where both have faces.

    Raises
    ------
    InputError
        The surfaces are over different planes or in different coordinate systems, have no area
        in common, or are one of ground and one of a file without any, of which all rows were
        read; the polygon is invalid; coordinates differ by more than doubles can hold once they
        are scaled; or a volume is beyond the largest double.
    FormatError
        A file of a polygon is invalid.
    MissingDependencyError
        shapely is not installed.
    OSError
        A file of a polygon cannot be opened.

    See Also
    --------
    Surface.cut_and_fill_by_polygon : In each of several polygons.
    Surface.volume : Between the faces and a level.

    Notes
    -----
    Which faces overlap, and how, is decided exactly. Volumes have an error of at most 1e-12 of
    the area times the largest distance of the surfaces; only where all that they have in common
    is below 1e-16 of the squares of the sides of its faces may it be larger.
    Where both surfaces are exchanged, so are cut and fill, to the bit; neither the order of the
    points changes a bit, nor a shift or a power of two that rounds no coordinate.

    A polygon that reaches beyond the hull of either surface is cut there, and its new corners
    are rounded to doubles. That error comes on top, and a shift changes bits: at an offset of
    4.5e5 it is about 1e-10 of an area of some units. Subtract the offset where this matters.

    Examples
    --------
    >>> import liftmesh
    >>> flat = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0]])
    >>> hill = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0], [2, 2, 6]])
    >>> round(flat.cut_and_fill(hill).fill, 9), round(hill.cut_and_fill(flat).cut, 9)
    (32.0, 32.0)
    """
    check_pair(surface, other)
    if within is not None:
        fill, cut, area = _in_all(surface, within, partial(_between_within, surface, other))
        return CutFillResult(cut, fill, area, cubic_metres_of(surface))
    _check_range(surface, other)
    pair = touching(surface.triangulation, other.triangulation)
    fill, cut, area = 0.0, 0.0, 0.0
    if pair is not None:
        fill, cut, area = kernel_surface(surface).between(kernel_surface(other), *pair)
        check_measured(("volume", fill), ("volume", cut), ("area", area))
    if not area > 0:
        raise InputError("the surfaces have no area in common")
    return CutFillResult(cut, fill, area, cubic_metres_of(surface))


def cut_and_fill_by_polygon(
    surface: SurfaceData, other: SurfaceData, within: object, *, by: str = "name"
) -> dict[str | int, CutFillResult]:
    """Compute the volumes between this surface and another one in each of several polygons.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud.
    other : Surface
        As for `cut_and_fill`.
    within : object
        As for `cut_and_fill`. Each feature of GeoJSON and each row of a table is measured by
        itself, whatever others cover.
    by : str, default "name"
        The property or column that has the names of polygons.

    Returns
    -------
    dict of str or int to CutFillResult
        By the property or column `by` where it is a text, or any number if it is not ``name``,
        as text; else by the number of the polygon, from 0; zeros for a polygon that has no area
        in common with the faces.

    Raises
    ------
    InputError
        The surfaces are over different planes or in different coordinate systems, a polygon is
        invalid, two have one name, none has the property, or a volume is beyond the largest
        double.
    FormatError, MissingDependencyError, OSError
        As for `cut_and_fill`.

    See Also
    --------
    Surface.cut_and_fill : In all of them together.
    Surface.volume_by_polygon : Between the faces and a level.

    Examples
    --------
    >>> import liftmesh
    >>> flat = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0]])
    >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 4], [0, 4, 0], [4, 4, 4]])
    >>> lot = {"type": "Polygon", "coordinates": [[[0, 0], [2, 0], [2, 2], [0, 2]]]}
    >>> lots = [{"type": "Feature", "properties": {"name": "A 7"}, "geometry": lot}]
    >>> found = flat.cut_and_fill_by_polygon(
    ...     slope, {"type": "FeatureCollection", "features": lots}
    ... )
    >>> round(found["A 7"].fill, 9)
    4.0
    """
    check_pair(surface, other)
    unit = cubic_metres_of(surface)
    volumes = _in_each(surface, within, partial(_between_within, surface, other), by)
    return {name: CutFillResult(cut, fill, area, unit) for name, (fill, cut, area) in volumes}


def cubic_metres_of(surface: SurfaceData) -> float | None:
    """Return how many cubic metres a unit of volume has."""
    metres = metres_of(surface)
    return None if metres is None else math.prod(metres)


def check_measured(*totals: tuple[str, float]) -> None:
    """Raise for what was measured and is no double."""
    for name, total in totals:
        if not math.isfinite(total):
            raise InputError(f"the {name} is beyond the largest double: scale the coordinates")


def _total(name: str, parts: Floats) -> float:
    """Sum what faces have, rounded once."""
    try:
        total = math.fsum(parts.tolist())
    except (OverflowError, ValueError):
        total = math.inf
    check_measured((name, total))
    return total


def faces_of(surface: SurfaceData) -> tuple[Floats, Floats]:
    """Return the corners of the faces by x, then y, (m, 3, 2), and their heights, (m, 3)."""
    faces = surface.faces
    planar = surface.triangulation.points.take(faces, axis=0)
    order = corner_order(planar)
    heights = surface.frame.heights(surface.vertices)[np.take_along_axis(faces, order, axis=1)]
    return np.take_along_axis(planar, order[..., None], axis=1), heights


def planar_areas(corners: Floats) -> Floats:
    """Compute the areas of projections to the plane."""
    return _turns(corners) / 2


def _turns(corners: Floats) -> Floats:
    """Compute twice the planar areas."""
    (bx, by), (cx, cy) = (np.moveaxis(corners[:, k] - corners[:, 0], -1, 0) for k in (1, 2))
    turns: Floats = np.abs(bx * cy - by * cx)
    return turns


def _inclined(corners: Floats, heights: Floats) -> Floats:
    """Compute the areas in space: half the lengths of cross products."""
    (bx, by), (cx, cy) = (np.moveaxis(corners[:, k] - corners[:, 0], -1, 0) for k in (1, 2))
    bz, cz = heights[:, 1] - heights[:, 0], heights[:, 2] - heights[:, 0]
    x, y = by * cz - bz * cy, bz * cx - bx * cz
    normals = np.stack([x, y, _turns(corners)])
    scale = np.frexp(np.abs(normals).max(axis=0))[1]  # squares of larger numbers are no doubles
    x, y, turns = np.ldexp(normals, -scale)
    areas: Floats = np.ldexp(np.sqrt(x * x + y * y + turns**2) / 2, scale)
    return areas


def prisms(areas: Floats, heights: Floats) -> tuple[Floats, Floats]:
    """Compute the volumes of prisms above and below zero, heights ascending in each row."""
    low, middle, high = heights.T
    whole = areas * ((low + middle + high) / 3)
    with np.errstate(divide="ignore", invalid="ignore"):
        under = areas * (-low / 3) * (low / (low - middle)) * (low / (low - high))
        over = areas * (high / 3) * (high / (high - low)) * (high / (high - middle))
    one_below, one_above = (low < 0) & (middle >= 0), (middle < 0) & (high > 0)
    above = np.select([low >= 0, one_below, one_above], [whole, whole + under, over], 0.0)
    below = np.select([high <= 0, one_above, one_below], [-whole, over - whole, under], 0.0)
    return np.maximum(above, 0), np.maximum(below, 0)


def check_pair(surface: SurfaceData, other: SurfaceData) -> None:
    """Raise for what are no surfaces, or not over one plane in one system."""
    for each in (surface, other):
        if not hasattr(each, "triangulation") or not hasattr(each, "frame"):
            remedy = "triangulate it, or as_surface"
            if hasattr(each, "iter_meshes"):  # in tiles
                remedy = "take a raster with the option minus, or clip a part of it"
            raise InputError(f"a {type(each).__name__} is no surface in memory: {remedy}")
    check_planes(surface, other)
    files = ("the file of this surface", surface), ("the file of the other surface", other)
    check_grounds((name, Provenance(each.metadata).selection) for name, each in files)


def _check_range(*surfaces: SurfaceData) -> None:
    """Raise where coordinates are lost once the largest are near to 1, as the kernel scales them.

    It does not scale what is below 2**400, nor are the products of those beyond the doubles.
    """
    sizes = np.concatenate([np.abs(each.triangulation.points).ravel() for each in surfaces])
    sizes = sizes[np.isfinite(sizes)]  # of other rows there are no faces
    most = float(sizes.max(initial=0))
    scaled = -math.frexp(most)[1] + 1
    if most < _SCALED or (np.ldexp(np.ldexp(sizes, scaled), -scaled) == sizes).all():
        return
    least = float(sizes[sizes > 0].min())
    raise InputError(
        f"coordinates between {least:g} and {most:g} differ too much in size for areas in doubles: "
        "leave out those far away, or round those near 0"
    )


def touching(one: Triangulation, two: Triangulation) -> tuple[int, int] | None:
    """Return a face of each triangulation that touch; None if none do."""
    if (one.max_bound < two.min_bound).any() or (two.max_bound < one.min_bound).any():
        return None
    pair = _of_middles(one, two) or _of_a_vertex(one, two)
    if pair is None:
        turned = _of_a_vertex(two, one)
        pair = None if turned is None else (turned[1], turned[0])
    return pair or _of_crossing_sides(one, two)


def _of_middles(one: Triangulation, two: Triangulation) -> tuple[int, int] | None:
    """Find a face with its middle inside, and the face of the other there: they overlap."""
    for first, second in ((one, two), (two, one)):
        faces = np.arange(0, len(first.simplices), len(first.simplices) // _SPREAD + 1)
        a, b, c = (first.points[first.simplices[faces, k]] for k in range(3))
        middles = a / 3 + b / 3 + c / 3
        sides = [orient2d(*ends, middles) > 0 for ends in ((a, b), (b, c), (c, a))]
        places = np.where(np.all(sides, axis=0), second.find_simplex(middles), -1)
        if len(inside := np.flatnonzero(places >= 0)):
            face, other = int(faces[inside[0]]), int(places[inside[0]])
            return (face, other) if first is one else (other, face)
    return None


def _of_a_vertex(one: Triangulation, two: Triangulation) -> tuple[int, int] | None:
    """Find a vertex of one in the other: a face at it, and the face that contains it."""
    rows = np.flatnonzero(one.vertex_to_simplex >= 0)
    for some in (rows[:_FEW], rows[_FEW:]):
        place = two.find_simplex(one.points[some])
        inside = np.flatnonzero(place >= 0)
        if len(inside):
            return int(one.vertex_to_simplex[some[inside[0]]]), int(place[inside[0]])
    return None


def _of_crossing_sides(one: Triangulation, two: Triangulation) -> tuple[int, int] | None:
    """Find sides of the hulls that cross, where no vertex of one is in the other."""
    for (faces, tails, heads), (others, starts, ends) in product(_chains(one), _chains(two)):
        near, far = _overlapping(tails, heads, starts, ends)
        (tail, head), (start, end) = (
            [each.view(np.float64).reshape(-1, 2)[chosen] for each in sides]
            for sides, chosen in (((tails, heads), near), ((starts, ends), far))
        )
        apart = orient2d(tail, head, start) * orient2d(tail, head, end) > 0
        apart |= orient2d(start, end, tail) * orient2d(start, end, head) > 0
        if not apart.all():
            pair = int(np.argmin(apart))
            return int(faces[near[pair]]), int(others[far[pair]])
    return None


def _overlapping(tails: Array, heads: Array, starts: Array, ends: Array) -> tuple[Array, Array]:
    """Pair the sides of two chains that overlap in lexicographic order, as those do that touch.

    Sides of a chain follow each other, so there are little more pairs than sides.
    """
    first = np.searchsorted(ends, tails)
    counts = np.searchsorted(starts, heads, side="right") - first
    before = np.cumsum(counts) - counts
    sides = np.repeat(np.arange(len(tails)), counts)
    return sides, np.arange(len(sides)) + np.repeat(first - before, counts)


def _chains(tri: Triangulation) -> Iterator[tuple[Array, Array, Array]]:
    """Yield the lower and the upper hull: faces at their sides, and lesser and greater ends.

    Ends are complex numbers, which have a lexicographic order, and the sides are in this order.
    """
    faces, corner = np.nonzero(tri.neighbors < 0)
    tails, heads = (
        np.ascontiguousarray(tri.points[tri.simplices[faces, (corner + step) % 3]])
        .view(np.complex128)
        .ravel()
        for step in (1, 2)
    )
    for low, high in ((tails, heads), (heads, tails)):
        chosen = np.flatnonzero(low < high)
        chosen = chosen[np.argsort(low[chosen])]
        yield faces[chosen], low[chosen], high[chosen]


def _in_all(
    surface: SurfaceData, within: object, measure: Callable[[list[Polygon]], Measured]
) -> Measured:
    """Measure what polygons cover together."""
    totals = measure(polygons_in(plane_system(surface), within))
    if not totals[2] > 0:
        raise InputError("the polygon has no area in common with the faces")
    return totals


def _in_each(
    surface: SurfaceData, within: object, measure: Callable[[list[Polygon]], Measured], by: str
) -> Iterator[tuple[str | int, Measured]]:
    """Measure each region by itself."""
    seen = set()
    for region in regions_in(plane_system(surface), within, by):
        if region.name in seen:
            raise InputError(
                f"two polygons have the name {region.name!r}: give each its own, or "
                f"{Option('by', ...)} a property that differs"
            )
        seen.add(region.name)
        try:
            yield region.name, measure(region.polygons)
        except InputError as error:
            error.within(f"polygon {region.name!r}")
            raise


def _level_within(surface: SurfaceData, level: float, polygons: list[Polygon]) -> Measured:
    """Measure the volumes between a level and a surface in polygons."""
    solved = surface.triangulation
    low, high = solved.min_bound, solved.max_bound
    with np.errstate(over="ignore"):
        room = (high - low).max()
        (left, bottom), (right, top) = np.clip([low - room, high + room], -_LARGEST, _LARGEST)
    square = delaunay([[left, bottom], [right, bottom], [left, top], [right, top]])
    flat = _kernel.Relief(
        square.points, square.simplices, square.neighbors, np.full(4, float(level)), None
    )
    below, above, area = _measured(
        (kernel_surface(surface), solved), (flat, square), _triangles(surface, polygons)
    )
    return above, below, area


def _between_within(surface: SurfaceData, other: SurfaceData, polygons: list[Polygon]) -> Measured:
    """Measure the volumes between two surfaces in polygons."""
    _check_range(surface, other)
    first = kernel_surface(surface), surface.triangulation
    second = kernel_surface(other), other.triangulation
    parts = _triangles(surface, polygons, other.triangulation)
    if first[1].nsimplex >= second[1].nsimplex:
        return _measured(first, second, parts)
    below, above, area = _measured(second, first, parts)
    return above, below, area


def _measured(
    first: tuple[Any, Triangulation], second: tuple[Any, Triangulation], parts: Floats
) -> Measured:
    """Measure in triangles, the finer surface first."""
    middles = parts.mean(axis=1)
    faces, others = (_faces_at(solved, middles) for _, solved in (first, second))
    inside = (faces >= 0) & (others >= 0)
    chosen = (np.ascontiguousarray(each[inside]) for each in (parts, faces, others))
    above, below, area = first[0].between_within(second[0], *chosen)
    check_measured(("volume", above), ("volume", below), ("area", area))
    return above, below, area


def _faces_at(solved: Triangulation, points: Floats) -> Rows:
    return np.asarray(solved.find_simplex(points), dtype=np.int32)


def _triangles(surface: SurfaceData, polygons: list[Polygon], *others: Triangulation) -> Floats:
    """Return triangles that fill the polygons as far as triangulations reach, (t, 3, 2)."""
    shapely = load("shapely", extra="shapes")
    used = [each.points[each.vertex_to_simplex >= 0] for each in (surface.triangulation, *others)]
    _check_reach(polygons, used)
    scale = scale_of(*used)
    shapes = valid_shapes(polygons, scale)
    area = shapely.union_all(shapes)
    hulls = [shapely.MultiPoint(each).convex_hull for each in _scaled(used, scale)]
    for hull in sorted(hulls, key=lambda each: shapely.get_coordinates(each).tolist()):
        area = area.intersection(hull)  # in an order of their own: corners are rounded here
    pieces = shapely.get_parts(shapely.constrained_delaunay_triangles(_polygonal(shapely, area)))
    corners = shapely.get_coordinates(pieces).reshape(-1, 4, 2)[:, :3]
    (bx, by), (cx, cy) = (np.moveaxis(corners[:, k] - corners[:, 0], -1, 0) for k in (1, 2))
    turns = bx * cy - by * cx
    with np.errstate(over="ignore"):
        check_measured(("area", float(np.ldexp(np.abs(turns).sum() / 2, 2 * scale))))
    corners[turns < 0] = corners[turns < 0, ::-1]
    return np.ascontiguousarray(np.ldexp(corners, scale))


def valid_shapes(polygons: list[Polygon], scale: int) -> list[Any]:
    """Convert polygons to shapely's, divided by a power of two, and see that they are valid."""
    shapely = load("shapely", extra="shapes")
    shapes = [
        shapely.Polygon(*_scaled([each[0]], scale), _scaled(each[1:], scale)) for each in polygons
    ]
    for number, shape in enumerate(shapes):
        if not shape.is_valid:
            reason = shapely.is_valid_reason(shape)
            raise InputError(f"polygon {number} is not valid: {reason}")
    return shapes


def _check_reach(polygons: list[Polygon], used: list[Floats]) -> None:
    """Raise for a polygon so far beyond the faces that shapely has no digits left for them."""
    near = max(np.abs(each).max(initial=0) for each in used)
    for number, rings in enumerate(polygons):
        far = float(max(np.abs(each).max(initial=0) for each in rings))
        if far / _FARTHEST > near:
            raise InputError(
                f"polygon {number} reaches as far as {far:g}, and the faces only {near:g}: cut it "
                "nearer to them"
            )


def scale_of(*points: Floats) -> int:
    """Return the power of two of coordinates whose products shapely may lose, and 0 of others."""
    exponent = int(np.frexp(max(np.abs(each).max(initial=0) for each in points))[1])
    return exponent if abs(exponent) > _MOST_EXPONENT else 0


def _scaled(parts: list[Any], scale: int) -> list[Any]:
    """Divide coordinates by a power of two."""
    return parts if not scale else [np.ldexp(each, -scale) for each in parts]


def _polygonal(shapely: Any, area: Any) -> Any:
    """Leave out points and lines, in which areas may touch."""
    parts = shapely.get_parts(area)
    parts = shapely.get_parts(parts)  # of collections, too
    return shapely.MultiPolygon([each for each in parts if each.geom_type == "Polygon"])
