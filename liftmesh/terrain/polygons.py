"""Polygons with holes, from GeoJSON and objects of other libraries; which points are inside.

A point is inside a polygon if a ray from it in the direction of x crosses its rings an odd number
of times, so holes need no mark; of several polygons, which may overlap, it has to be inside one.
The rule is half-open: an edge has its lower end, not its upper one. On which side of an edge a
point is, exact orientation decides; one exactly on an edge is inside if what is just to its right
is. So polygons that share edges share no point.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias, TypeVar

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.arrays import as_pairs, as_reals
from liftmesh.choices import shown
from liftmesh.errors import InputError
from liftmesh.predicates import orient2d
from liftmesh.terrain.geojson_tree import coordinates_of

Polygon: TypeAlias = list[Floats]
T = TypeVar("T")


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """What is measured by itself: a feature of GeoJSON, or a row of a table.

    Attributes
    ----------
    name : str or int
        Its property ``name``, or its number, from 0.
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


def as_regions(polygon: object) -> list[Region]:
    """Convert what is given to regions: the features of a collection, or all in one.

    Parameters
    ----------
    polygon : object
        As for `as_polygons`.

    Returns
    -------
    list of Region
        Features without a polygon are left out, and so are their numbers.

    Raises
    ------
    InputError
        As for `as_polygons`.

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
    is_collection = isinstance(described, Mapping) and described.get("type") == "FeatureCollection"
    if not is_collection:
        return [Region(0, as_polygons(polygon))]
    features = described.get("features") or ()
    is_list = isinstance(features, list | tuple)
    if not (is_list and all(isinstance(each, Mapping) for each in features)):
        raise InputError("the polygon is no GeoJSON: give features as a list of objects")
    return _found(
        [
            Region(_name_of(each, number), polygons)
            for number, each in enumerate(features)
            if (polygons := _polygons(each))
        ]
    )


def _name_of(feature: Mapping[str, Any], number: int) -> str | int:
    properties = feature.get("properties")
    name = properties.get("name") if isinstance(properties, Mapping) else None
    return name if isinstance(name, str) and name else number


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
        is_inside[first:last] |= _is_in(rings, lined[first:last])
    found = np.empty_like(is_inside)
    found[order] = is_inside
    return found


def _is_in(rings: Polygon, lined: Floats) -> Array:
    """Tell which points, by ascending y, are inside one polygon."""
    is_inside = np.zeros(len(lined), dtype=np.bool_)
    for ring in rings:
        for tail, head in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            low, high = (tail, head) if tail[1] < head[1] else (head, tail)
            first, last = np.searchsorted(lined[:, 1], (low[1], high[1]))
            if first < last:
                is_inside[first:last] ^= orient2d(low, high, lined[first:last]) > 0
    return is_inside


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
