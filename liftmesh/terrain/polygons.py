"""Polygons with holes, from GeoJSON and objects of other libraries; which points are inside.

A point is inside a polygon if a ray from it in the direction of x crosses its rings an odd number
of times, so holes need no mark; of several polygons, which may overlap, it has to be inside one.
The rule is half-open: an edge has its lower end, not its upper one. On which side of an edge a
point is, exact orientation decides; one exactly on an edge is inside if what is just to its right
is. So polygons that share edges share no point.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeAlias, TypeVar

import numpy as np

from liftmesh._typing import Array, Floats, Indices
from liftmesh.arrays import as_pairs, as_reals
from liftmesh.choices import shown
from liftmesh.errors import InputError
from liftmesh.predicates import orient2d
from liftmesh.terrain.geojson_tree import coordinates_of

_FEW, _NEAR = 64, 16  # points of a strip, and edges near each of them
_PAIRS = 1 << 20  # of edges and points that are compared at once
_LONG = 1 << 12  # points that are compared with one edge alone
_ROUNDING = 2.0**-48  # of the ends of an edge, in a point between them
_SMALLEST = 2.0**-1070
_NAME = "name"  # the property that regions have their names from
_SHOWN = 12  # names in a message

Polygon: TypeAlias = list[Floats]
T = TypeVar("T")


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """What is measured by itself: a feature of GeoJSON, or a row of a table.

    Attributes
    ----------
    name : str or int
        Its property ``name``, or the one asked for, or its number, from 0.
    polygons : list of list of (k, 2) ndarray of float64
        Its polygons, each as its rings.
    """

    name: str | int
    polygons: list[Polygon]


def as_polygons(polygon: object) -> list[Polygon]:
    """Convert what is given to polygons, each as its rings.

    Parameters
    ----------
    polygon : object
        GeoJSON as a dict, an object with ``__geo_interface__``, or an array of corners.

    Returns
    -------
    list of list of (k, 2) ndarray of float64
        For each polygon its rings, closed or not.

    Raises
    ------
    InputError
        It holds no polygon, or a corner is not finite.

    Examples
    --------
    >>> triangle = {"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [0, 1]]]}
    >>> [[ring.shape for ring in each] for each in as_polygons(triangle)]
    [[(3, 2)]]
    """
    return _found(_polygons(getattr(polygon, "__geo_interface__", polygon)))


def as_regions(polygon: object, by: str = _NAME) -> list[Region]:
    """Convert what is given to regions: the features of a collection, or all in one.

    Parameters
    ----------
    polygon : object
        As for `as_polygons`.
    by : str
        The property with the names. If it is another than ``name``, numbers are names, too.

    Returns
    -------
    list of Region
        Features without a polygon are left out, and so are their numbers.

    Raises
    ------
    InputError
        As for `as_polygons`; or no feature has the property, which is another than ``name``.

    Examples
    --------
    >>> triangle = {"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [0, 1]]]}
    >>> field = {"type": "Feature", "properties": {"name": "A 7"}, "geometry": triangle}
    >>> other = {"type": "Feature", "properties": {}, "geometry": triangle}
    >>> both = {"type": "FeatureCollection", "features": [field, other]}
    >>> [each.name for each in as_regions(both)]
    ['A 7', 1]
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
        raise InputError(f"by is {shown(by)}: give the name of a property")
    rest = f" and {len(names) - _SHOWN} more" if len(names) > _SHOWN else ""
    raise InputError(
        f"no polygon has the property {by!r}, but {', '.join(map(repr, names[:_SHOWN]))}{rest}: "
        "give by= one of these"
        if names
        else f"no polygon has the property {by!r}, nor any other: by= is for features and tables"
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


def contains(polygons: list[Polygon], points: Floats) -> Array:
    """Tell which points are inside one of several polygons.

    Parameters
    ----------
    polygons : list of list of (k, 2) ndarray of float64
        As from `as_polygons`.
    points : (n, 2) ndarray of float64
        The points.

    Returns
    -------
    (n,) ndarray of bool
        True inside.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    >>> contains([[square, square / 4 + 0.5]], np.array([[0.2, 0.2], [0.7, 0.7], [3.0, 1.0]]))
    array([ True, False, False])
    """
    order = np.argsort(points[:, 1], kind="stable")
    lined = np.ascontiguousarray(points[order])
    is_inside = np.zeros(len(points), dtype=np.bool_)
    for rings in polygons:
        heights = np.concatenate([ring[:, 1] for ring in rings])
        first, last = np.searchsorted(lined[:, 1], (heights.min(), heights.max()))
        if first < last:
            is_inside[first:last] |= _is_in(rings, lined[first:last])
    found = np.empty_like(is_inside)
    found[order] = is_inside
    return found


def _is_in(rings: Polygon, lined: Floats) -> Array:
    """Tell which points, by ascending y, are inside one polygon.

    Strips of points are halved until few edges are near many of them.
    """
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
    found = _compared(low[~passes], high[~passes], first, last, strip)
    found[order] += counts
    return found


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


def _polygons(described: object) -> list[Polygon]:
    """Convert the polygons of a tree of GeoJSON, in which nothing else counts; or one ring."""
    if not isinstance(described, Mapping):
        return [[_ring(described)]]
    try:
        found = [list(rings) for rings in coordinates_of(described, "Polygon")]
    except (TypeError, RecursionError) as error:
        raise InputError("the polygon is no GeoJSON: give type and coordinates") from error
    return [[_ring(ring) for ring in rings] for rings in found]


def _found(polygons: list[T]) -> list[T]:
    if not polygons:
        raise InputError("there is no polygon in what is given: give Polygon or MultiPolygon")
    return polygons


def _ring(corners: Any) -> Floats:
    """Convert a ring to planar corners; heights, which GeoJSON allows, are left out."""
    try:
        array = as_reals(corners)
    except (TypeError, ValueError, OverflowError) as error:
        raise InputError(f"a ring of the polygon cannot be read: {shown(corners)}") from error
    if array.ndim != 2 or array.shape[1] not in (2, 3) or len(array) < 3:
        raise InputError(f"a ring needs three corners x, y or more, not the shape {array.shape}")
    if not np.isfinite(array).all():
        raise InputError("a corner of the polygon is not finite")
    return as_pairs(array[:, :2])
