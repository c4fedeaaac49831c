"""Polygons with holes, from GeoJSON and objects of other libraries; which points are inside.

A point is inside a polygon if a ray from it in the direction of x crosses its rings an odd number
of times, so holes need no mark; of several polygons, which may overlap, it has to be inside one.
The rule is half-open: an edge has its lower end, not its upper one. On which side of an edge a
point is, exact orientation decides; one exactly on an edge is inside if what is just to its right
is. So polygons that share edges share no point.

Objects count by what they offer: ``__geo_interface__``, as those of shapely and geopandas do, or
the discretised curves of a ``trimesh.path.Path2D``. Heights are left out.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, TypeAlias, TypeVar

import numpy as np

from liftmesh._typing import Array, Floats, Indices
from liftmesh.base.options import refused, shown
from liftmesh.errors import FormatError, InputError, Option
from liftmesh.io.objects.plain import is_of
from liftmesh.io.streams import at_home
from liftmesh.optional import load
from liftmesh.predicates import orient2d
from liftmesh.vector.files import check_system, read_features, read_shapes
from liftmesh.vector.geojson import coordinates_of, geometries, planar_corners

_FEW, _NEAR = 64, 16  # points of a strip, and edges near each of them
_PAIRS = 1 << 20  # of edges and points that are compared at once
_LONG = 1 << 12  # points that are compared with one edge alone
_ROUNDING = 2.0**-48  # of the ends of an edge, in a point between them
_SMALLEST = 2.0**-1070
_NAME = "name"  # the property that regions have their names from
_SHOWN = 12  # names in a message
Polygon: TypeAlias = list[Floats]
_is_polygon = is_of("shapely", {"Polygon", "MultiPolygon"})
T = TypeVar("T")


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """What is measured by itself: a feature of GeoJSON, or a row of a table."""

    name: str | int
    polygons: list[Polygon]


def polygons_in(crs: str | None, polygon: object) -> list[Polygon]:
    """Convert what is given to polygons, and see that they are in the system of a surface."""
    return [each for region in regions_in(crs, polygon) for each in region.polygons]


def regions_in(crs: str | None, polygon: object, by: str = _NAME) -> list[Region]:
    """Convert what is given to regions, and see that they are in the system of a surface."""
    if not isinstance(polygon, str | os.PathLike):
        check_system(crs, polygon, "the polygon")
        return as_regions(polygon, by)
    path = Path(at_home(polygon))
    shapes = read_shapes(path, "polygons", crs)
    try:
        return as_regions(shapes, by)
    except InputError as error:
        raise FormatError(f"{path}: {error.message.marked}") from error


def as_polygons(polygon: object) -> list[Polygon]:
    """Convert what is given to polygons, each as its rings."""
    return _found(_polygons(getattr(polygon, "__geo_interface__", polygon)))


def as_regions(polygon: object, by: str = _NAME) -> list[Region]:
    """Convert what is given to regions: the features of a collection, or all in one.

    If another property than ``name`` has the names, numbers are names, too.
    """
    described: Any = getattr(polygon, "__geo_interface__", polygon)
    kind = described.get("type") if isinstance(described, Mapping) else None
    if kind != "FeatureCollection" and by == _NAME:
        return [Region(0, as_polygons(polygon))]
    features = [described] if kind == "Feature" else ()
    if kind == "FeatureCollection":
        features = described.get("features") or ()
    is_list = isinstance(features, list | tuple)
    if not (is_list and all(isinstance(each, Mapping) for each in features)):
        raise InputError("the polygon is no GeoJSON: give features as a list of objects")
    _check_there(by, features)
    return _found(
        [
            Region(_name_of(each, by, number), polygons)
            for number, each in enumerate(features)
            if (polygons := _polygons(each))
        ]
    )


def _check_there(by: str, features: Sequence[Mapping[str, Any]]) -> None:
    """Raise if no feature has a property that is asked for."""
    names = [*dict.fromkeys(str(key) for each in features for key in _properties(each))]
    if by == _NAME or by in names:
        return
    if not isinstance(by, str):
        raise refused("by", by, "give the name of a property")
    rest = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    raise InputError(
        f"no polygon has the property {by!r}, but {', '.join(map(repr, names[:_SHOWN]))}{rest}: "
        f"give {Option('by', ...)} one of these"
        if names
        else f"no polygon has the property {by!r}, nor any other: {Option('by', ...)} is for "
        "features and tables"
    )


def _name_of(feature: Mapping[str, Any], by: str, number: int) -> str | int:
    name: Any = _properties(feature).get(by)
    is_number = isinstance(name, int | float | np.integer | np.floating)
    if is_number and by != _NAME and math.isfinite(name):
        name = str(int(name) if name == int(name) else name)
    return name if isinstance(name, str) and name else number


def _properties(feature: Mapping[str, Any]) -> Mapping[str, Any]:
    found = feature.get("properties")
    return found if isinstance(found, Mapping) else {}


def _polygons(described: object) -> list[Polygon]:
    """Convert the polygons of a tree of GeoJSON, in which nothing else counts; or one ring."""
    if not isinstance(described, Mapping):
        return [[_ring(described)]]
    try:
        polygons = [list(rings) for rings in coordinates_of(described, "Polygon")]
    except (TypeError, RecursionError) as error:
        raise InputError("the polygon is no GeoJSON: give type and coordinates") from error
    return [[_ring(ring) for ring in rings] for rings in polygons]


def _found(polygons: list[T]) -> list[T]:
    if not polygons:
        raise InputError("there is no polygon in what is given: give Polygon or MultiPolygon")
    return polygons


def _ring(corners: Any) -> Floats:
    return planar_corners(corners, "a ring", "the polygon", 3)


def contains(polygons: list[Polygon], points: Floats) -> Array:
    """Tell which points are inside one of several polygons."""
    order = np.argsort(points[:, 1], kind="stable")
    lined = np.ascontiguousarray(points[order])
    is_inside = np.zeros(len(points), dtype=np.bool_)
    for rings in polygons:
        heights = np.concatenate([ring[:, 1] for ring in rings])
        first, last = np.searchsorted(lined[:, 1], (heights.min(), heights.max()))
        if first < last:
            is_inside[first:last] |= _is_in(rings, lined[first:last])
    in_given_order = np.empty_like(is_inside)
    in_given_order[order] = is_inside
    return in_given_order


def _is_in(rings: Polygon, lined: Floats) -> Array:
    """Tell which points, by ascending y, are inside one polygon."""
    tails = np.concatenate(rings)
    heads = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    rises = (tails[:, 1] < heads[:, 1])[:, None]
    low, high = np.where(rises, tails, heads), np.where(rises, heads, tails)
    first, last = (np.searchsorted(lined[:, 1], each[:, 1]) for each in (low, high))
    is_inside = np.zeros(len(lined), dtype=np.bool_)
    strips = [(0, len(lined), np.flatnonzero(first < last))]
    while strips:
        begin, end, edges = strips.pop()
        own = edges[(first[edges] < end) & (last[edges] > begin)]
        bounds = np.clip([first[own] - begin, last[own] - begin], 0, end - begin)
        left_of = _left_of(low[own], high[own], bounds, lined[begin:end])
        if left_of is None:
            middle = (begin + end) // 2
            strips += [(begin, middle, own), (middle, end, own)]
        else:
            is_inside[begin:end] = left_of % 2 == 1
    return is_inside


def _left_of(low: Floats, high: Floats, bounds: Indices, strip: Floats) -> Indices | None:
    """Count the edges to the left of which points are; None if too many pairs are near."""
    passes = bounds[1] - bounds[0] == len(strip)
    order = np.argsort(strip[:, 0])
    points = strip[order]
    left, right = _extents(low[passes], high[passes], strip[[0, -1], 1])
    near = np.searchsorted(points[:, 0], left), np.searchsorted(points[:, 0], right, side="right")
    pairs = (near[1] - near[0]).sum() + np.diff(bounds[:, ~passes], axis=0).sum()
    if len(strip) > _FEW and pairs > _NEAR * (len(low) + len(strip)):
        return None
    counts = len(left) - np.cumsum(np.bincount(near[0], minlength=len(points) + 1))[:-1]
    counts += _compared(low[passes], high[passes], *near, points)
    first, last = bounds[:, ~passes]
    counts_in_order = _compared(low[~passes], high[~passes], first, last, strip)
    counts_in_order[order] += counts
    return counts_in_order


def _compared(low: Floats, high: Floats, first: Indices, last: Indices, points: Floats) -> Indices:
    """Count the edges to the left of which points are, each compared with a range of these."""
    counts, number = np.zeros(len(points), dtype=np.intp), last - first
    for k in np.flatnonzero(number > _LONG).tolist():
        own = slice(first[k], last[k])
        counts[own] += orient2d(low[k], high[k], points[own]) > 0
        number[k] = 0
    total = np.cumsum(number)
    blocks = np.searchsorted(total, np.arange(0, total[-1] if len(total) else 0, _PAIRS))
    for i, j in pairwise([*blocks.tolist(), len(low)]):
        edge = np.repeat(np.arange(i, j), number[i:j])
        shift = first[i:j] - total[i:j] + number[i:j] + (total[i - 1] if i else 0)
        place = np.arange(len(edge)) + np.repeat(shift, number[i:j])
        is_left = orient2d(low[edge], high[edge], points[place]) > 0
        counts += np.bincount(place[is_left], minlength=len(points))
    return counts


def _extents(low: Floats, high: Floats, heights: Floats) -> tuple[Floats, Floats]:
    """Bound the x that edges have between two heights."""
    with np.errstate(all="ignore"):
        across = high - low
        share = (heights[:, None] - low[:, 1]) / across[:, 1]
        x = low[:, 0] + np.clip(share, 0, 1) * across[:, 0]
        margin = _ROUNDING * (np.abs(low[:, 0]) + np.abs(high[:, 0])) + _SMALLEST
        least, most = x.min(axis=0) - margin, x.max(axis=0) + margin
    ends = np.stack([low[:, 0], high[:, 0]])
    is_vague = ~(np.isfinite(across).all(axis=1) & np.isfinite(least) & np.isfinite(most))
    return np.where(is_vague, ends.min(axis=0), least), np.where(is_vague, ends.max(axis=0), most)


Shapes = TypeVar("Shapes")
_DEPTH = {"LineString": 1, "LinearRing": 1, "MultiLineString": 2, "Polygon": 2, "MultiPolygon": 3}


def lines_in(given: Any) -> list[Floats] | None:
    """Return lines, and the rings of polygons, as lines that end where they begin.

    None for what is no shape.
    """
    return _taken(given, "lines", _some_lines)


def areas_in(given: Any) -> tuple[list[Polygon], bool] | None:
    """Return polygons, each as its rings; None for what is no shape.

    Or, where there is no polygon, lines that end where they begin, and True: of these nothing says
    which are holes.
    """
    return _taken(given, "polygons", _areas)


def _taken(given: Any, what: str, take: Callable[[Any], Shapes]) -> Shapes | None:
    """Take shapes from GeoJSON, or from what is as good."""
    if isinstance(given, str | os.PathLike):
        path = Path(given)
        try:
            return take(read_features(path, what))
        except InputError as error:
            raise FormatError(f"{path}: {error.message.marked}") from error
    if hasattr(type(given), "discrete") and hasattr(type(given), "entities"):
        return take({"type": "MultiLineString", "coordinates": list(_lines_of_path(given))})
    described = _rings_of_shapely(given) or getattr(given, "__geo_interface__", given)
    return take(described) if isinstance(described, Mapping) else None


def _rings_of_shapely(given: Any) -> dict[str, Any] | None:
    """Describe polygons of shapely as their own interface does, in a tenth of its time."""
    if not _is_polygon(given) or given.is_empty:
        return None
    shapely = load("shapely", extra="shapes")
    polygons = [
        [shapely.get_coordinates(ring) for ring in (part.exterior, *part.interiors)]
        for part in shapely.get_parts(given)
    ]
    return {"type": "MultiPolygon", "coordinates": polygons}


def _lines_of_path(path: Any) -> Iterator[Any]:
    """Yield the lines of a path of trimesh: those that close themselves, then other entities."""
    yield from path.discrete
    closed = {entity for each in path.paths for entity in each}
    for number, entity in enumerate(path.entities):
        if number not in closed and len(entity.points) > 1:
            yield entity.discrete(path.vertices, scale=path.scale)


def _some_lines(tree: Any) -> list[Floats]:
    if not (lines := _lines(tree)):
        raise InputError("there is no line in what is given: give LineString or Polygon")
    return lines


def _lines(tree: Any) -> list[Floats]:
    try:
        return [
            planar_corners(each, "a line", "a line", 2)
            for kind, coordinates, _ in geometries(tree)
            for each in _flat(coordinates, _DEPTH.get(kind, 0))
        ]
    except (TypeError, AttributeError, RecursionError) as error:
        raise InputError(f"no GeoJSON ({shown(tree)}): a line has type and coordinates") from error


def _areas(tree: Any) -> tuple[list[Polygon], bool]:
    lines = _lines(tree)
    if any(kind.endswith("Polygon") for kind, *_ in geometries(tree)):
        return as_polygons(tree), False
    closed = [[line] for line in lines if len(line) > 3 and (line[0] == line[-1]).all()]
    if not closed:
        raise InputError("there is no polygon in what is given, nor a line that closes itself")
    return closed, True


def _flat(coordinates: Any, depth: int) -> Iterator[Any]:
    """Yield the lines in coordinates of some depth."""
    if depth == 1 and len(coordinates):
        yield coordinates
    elif depth > 1:
        for each in coordinates:
            yield from _flat(each, depth - 1)
