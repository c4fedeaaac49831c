"""Polygons as triangles: what is measured inside of them is cut exactly at their borders.

The triangles of a polygon, which shapely makes of its own corners, are laid over two surfaces as
these are over each other (`_core/surface/overlay.hpp`), so each common part of three triangles is
counted once. A level is a surface of two triangles.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Floats, Rows
from liftmesh.errors import InputError
from liftmesh.optional import load
from liftmesh.planar.delaunay import delaunay
from liftmesh.terrain.polygon_files import polygons_in, regions_in
from liftmesh.terrain.sampling import relief_of

if TYPE_CHECKING:
    from liftmesh.planar.triangulation import Triangulation
    from liftmesh.terrain.polygons import Polygon
    from liftmesh.terrain.surface import Surface


_MOST_EXPONENT = 64
_FARTHEST = 2.0**64  # shapely crosses lines to 2**-104 of their length
_LARGEST = np.finfo(np.float64).max
Measured: TypeAlias = tuple[float, float, float]


def in_all(
    surface: Surface, polygon: object, measure: Callable[[list[Polygon]], Measured]
) -> Measured:
    """Measure what polygons cover together.

    Parameters
    ----------
    surface : Surface
        The surface.
    polygon : object
        As for `Surface.trim`.
    measure : callable
        `level_within` or `between_within`, for polygons.

    Returns
    -------
    (float, float, float)
        What was measured.

    Raises
    ------
    InputError
        The polygons are invalid, or have no area in common with the faces.
    """
    found = measure(polygons_in(_system(surface), polygon))
    if not found[2] > 0:
        raise InputError("the polygon has no area in common with the faces")
    return found


def in_each(
    surface: Surface, polygon: object, measure: Callable[[list[Polygon]], Measured], by: str
) -> Iterator[tuple[str | int, Measured]]:
    """Measure each region by itself.

    Parameters
    ----------
    surface, polygon, measure
        As for `in_all`.
    by : str
        The property with the names.

    Yields
    ------
    (str or int, (float, float, float))
        The name of a region, and what was measured: zeros where there are no faces.

    Raises
    ------
    InputError
        Polygons are invalid, and the message names the region; or two regions have one name.
    """
    seen = set()
    for region in regions_in(_system(surface), polygon, by):
        if region.name in seen:
            raise InputError(
                f"two polygons have the name {region.name!r}: give each its own, or by= a property "
                "that differs"
            )
        seen.add(region.name)
        try:
            yield region.name, measure(region.polygons)
        except InputError as error:
            raise InputError(f"polygon {region.name!r}: {error}") from error


def check_measured(*totals: tuple[str, float]) -> None:
    """Raise for what was measured and is no double.

    Parameters
    ----------
    *totals : (str, float)
        What they are, and sums: infinite or NaN if they, or parts of them, are beyond the doubles.

    Raises
    ------
    InputError
        One is not finite.

    Examples
    --------
    >>> check_measured(("volume", 4.0), ("area", float("inf")))
    Traceback (most recent call last):
    liftmesh.errors.InputError: the area is beyond the largest double: scale the coordinates
    """
    for name, total in totals:
        if not math.isfinite(total):
            raise InputError(f"the {name} is beyond the largest double: scale the coordinates")


def level_within(surface: Surface, level: float, polygons: list[Polygon]) -> Measured:
    """Measure the volumes between a level and a surface in polygons.

    Parameters
    ----------
    surface : Surface
        The surface.
    level : float
        The level.
    polygons : list of list of (k, 2) ndarray of float64
        For each polygon its rings.

    Returns
    -------
    (float, float, float)
        Above the level, below it, and the area of the faces in the polygons.

    Raises
    ------
    InputError
        The polygons are invalid.
    """
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
        (relief_of(surface), solved), (flat, square), _triangles(surface, polygons)
    )
    return above, below, area


def between_within(surface: Surface, other: Surface, polygons: list[Polygon]) -> Measured:
    """Measure the volumes between two surfaces in polygons.

    Parameters
    ----------
    surface, other : Surface
        The surfaces.
    polygons : list of list of (k, 2) ndarray of float64
        For each polygon its rings.

    Returns
    -------
    (float, float, float)
        Where the second is above, where it is below, and the area that has faces of both.

    Raises
    ------
    InputError
        The polygons are invalid.
    """
    first = relief_of(surface), surface.triangulation
    second = relief_of(other), other.triangulation
    parts = _triangles(surface, polygons, other.triangulation)
    if first[1].nsimplex >= second[1].nsimplex:
        return _measured(first, second, parts)
    below, above, area = _measured(second, first, parts)
    return above, below, area


def _measured(
    first: tuple[Any, Triangulation], second: tuple[Any, Triangulation], parts: Floats
) -> Measured:
    """Measure in triangles, the finer surface first.

    Triangles that are slivers outside of a hull by rounding count nothing.
    """
    middles = parts.mean(axis=1)
    faces, others = (_faces_at(solved, middles) for _, solved in (first, second))
    inside = (faces >= 0) & (others >= 0)
    chosen = (np.ascontiguousarray(each[inside]) for each in (parts, faces, others))
    above, below, area = first[0].between_within(second[0], *chosen)
    check_measured(("volume", above), ("volume", below), ("area", area))
    return above, below, area


def _faces_at(solved: Triangulation, points: Floats) -> Rows:
    return np.asarray(solved.find_simplex(points), dtype=np.int32)


def _system(surface: Surface) -> str | None:
    """Return the system of the plane of a surface, if any is known."""
    return surface.crs if surface.frame.name == "xy" else None


def _triangles(surface: Surface, polygons: list[Polygon], *others: Triangulation) -> Floats:
    """Return triangles that fill the polygons as far as triangulations reach, (t, 3, 2)."""
    shapely = load("shapely", extra="shapes")
    used = [each.points[each.vertex_to_simplex >= 0] for each in (surface.triangulation, *others)]
    _check_reach(polygons, used)
    scale = _scale_of(*used)
    shapes = [
        shapely.Polygon(*_scaled([each[0]], scale), _scaled(each[1:], scale)) for each in polygons
    ]
    for number, shape in enumerate(shapes):
        if not shape.is_valid:
            reason = shapely.is_valid_reason(shape)
            raise InputError(f"polygon {number} is not valid: {reason}")
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


def _scale_of(*points: Floats) -> int:
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
