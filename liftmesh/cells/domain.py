"""Domains, to which cells are clipped: a box, a polygon, or several, with holes.

The kernel takes rings of corners with the inside to their left: outer rings counter-clockwise,
holes clockwise. It decides by these coordinates exactly, and relies on rings that do not cross.
shapely looks at that.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from liftmesh._typing import Floats, Integers, Mask, Rows
from liftmesh.base.arrays import as_numbers
from liftmesh.crs.comparison import common_system, crs_of
from liftmesh.errors import InputError, Option
from liftmesh.optional import load
from liftmesh.predicates import orient2d

_KINDS = ("Polygon", "MultiPolygon")
_WIDENED = 0.1  # of the longer side of the points' box, on each side
_LEADING = ("give a box (xmin, ymin, xmax, ymax), a polygon or multipolygon of shapely, or the "
            "corners of a polygon")  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class Domain:
    """Rings around an area, which is to their left."""

    corners: Floats  # of all rings, each once
    starts: Rows  # of rings, and the end; edge j leads from corner j to the next one of its ring
    is_hole: Mask
    text: str  # what it is, in words
    # Corners on an edge of another ring, between its ends, each with that edge.
    touches: Rows = field(default_factory=lambda: np.empty((0, 2), dtype=np.int32))
    crs: str | None = None  # WKT or "EPSG:n"

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """xmin, ymin, xmax, ymax."""
        left, low = self.corners.min(axis=0).tolist()
        right, high = self.corners.max(axis=0).tolist()
        return left, low, right, high

    @property
    def following(self) -> Rows:
        """The corner after each, in its ring."""
        return following_corners(self.starts).astype(np.int32)


def following_corners(starts: Rows | Integers) -> Integers:
    """Find the corner after each, in rings of the corners from starts[i] to starts[i + 1]."""
    following = np.arange(1, starts[-1] + 1)
    full = np.diff(starts) > 0
    following[starts[1:][full] - 1] = starts[:-1][full]
    return following


def as_domain(given: Any, points: Floats, crs: str | None = None) -> Domain:
    """Convert the option ``domain``."""
    return replace(_rings_of(given, points), crs=common_system(crs, crs_of(given)))


def _rings_of(given: Any, points: Floats) -> Domain:
    if given is None or (isinstance(given, str) and given == "bounds"):
        return _around(points)
    if isinstance(given, Domain):
        return given
    if isinstance(getattr(given, "domain", None), Domain):
        raise InputError(
            f"{Option('domain')} is cells: give what they are clipped to, cells.domain"
        )
    if isinstance(given, Mapping) or hasattr(given, "__geo_interface__"):
        return _of_shape(given)
    array = as_numbers("domain", given, _LEADING)
    if array.shape == (4,):
        return _box(array)
    if array.ndim == 2 and array.shape[1] == 2 and len(array) >= 3:
        _check_finite(array)
        return _of_shape(load("shapely", extra="shapes").Polygon(array))
    raise InputError(f"{Option('domain')} is an array of the shape {array.shape}: {_LEADING}")


def _around(points: Floats) -> Domain:
    least, most = points.min(axis=0), points.max(axis=0)
    with np.errstate(over="ignore"):
        margin = float((most - least).max()) * _WIDENED or 1.0
        box = np.concatenate([least - margin, most + margin])
    if not np.isfinite(box).all() or (box[:2] >= box[2:]).any():
        raise InputError(
            f"the box of the points, from {tuple(least.tolist())} to {tuple(most.tolist())}, "
            f"cannot be widened by {margin!r} in float64: give a domain"
        )
    said = f"the points' box, widened by {margin!r} on each side (a tenth of its longer side)"
    return _box(box, said)


def _box(bounds: Floats, said: str | None = None) -> Domain:
    _check_finite(bounds)
    left, low, right, high = (bounds + 0.0).tolist()
    if not (left < right and low < high):
        raise InputError(
            f"{Option('domain')} is the box {(left, low, right, high)}, which has no area: give "
            "xmin, ymin, xmax, ymax"
        )
    corners = np.array([[left, low], [right, low], [right, high], [left, high]])
    text = said or f"the box {(left, low, right, high)}"
    return Domain(corners, np.array([0, 4], dtype=np.int32), np.zeros(1, dtype=np.bool_), text)


def _of_shape(given: Any) -> Domain:
    shapely = load("shapely", extra="shapes")
    shape = given if isinstance(given, shapely.Geometry) else _converted(given)
    if shape.geom_type == "LinearRing":
        shape = shapely.Polygon(shape)
    if shape.geom_type not in _KINDS:
        raise InputError(f"{Option('domain')} is a {shape.geom_type}: {_LEADING}")
    if shape.is_empty:
        raise InputError(f"{Option('domain')} is empty: give a polygon with an area")
    _check_finite(shapely.get_coordinates(shape))
    reason = _flaw(shape, shapely)
    if reason:
        raise InputError(
            f"{Option('domain')} is no valid polygon: {reason}; shapely.make_valid may repair it, "
            "or give another"
        )
    return _of_rings(shape, shapely)


def _flaw(shape: Any, shapely: Any) -> str:
    """Say why a polygon is not valid, and where; nothing if it is."""
    try:
        return "" if shape.is_valid else str(shapely.is_valid_reason(shape))
    except shapely.errors.GEOSException as error:  # of coordinates whose products overflow
        return f"GEOS cannot tell ({error})"


def _converted(given: Any) -> Any:
    try:
        shapes = shapes_of(given)
    except Exception as error:  # of whatever kind the interface makes
        raise InputError(
            f"{Option('domain')} cannot be converted to a polygon ({error}): {_LEADING}"
        ) from error
    return shapes[0] if len(shapes) == 1 and shapes[0] is not None else unite(shapes)


def shapes_of(given: Any) -> Sequence[Any]:
    """Return the geometries of a geometry, a feature, or a collection of features."""
    shapely = load("shapely", extra="shapes")
    held = given if isinstance(given, Mapping) else given.__geo_interface__
    features = held["features"] if held["type"] == "FeatureCollection" else [held]
    held = [each["geometry"] if each["type"] == "Feature" else each for each in features]
    return [None if each is None else shapely.geometry.shape(each) for each in held]


def unite(shapes: Sequence[Any]) -> Any:
    """Join polygons, which may touch or overlap, to one domain."""
    shapely = load("shapely", extra="shapes")
    if not len(shapes):
        raise InputError("a domain is made of polygons, and there are none")
    for row, shape in enumerate(shapes):
        kind = getattr(shape, "geom_type", "nothing")
        if kind not in _KINDS:
            raise InputError(f"a domain is made of polygons, and geometry {row} is {kind}")
        _check_finite(shapely.get_coordinates(shape))
        if reason := _flaw(shape, shapely):
            raise InputError(f"polygon {row} of the domain is not valid: {reason}")
    return shapely.union_all(shapes)


def _of_rings(shape: Any, shapely: Any) -> Domain:
    rings, holes = [], []
    for part in shapely.get_parts(shape):
        for number, ring in enumerate((part.exterior, *part.interiors)):
            corners = shapely.get_coordinates(ring)[:-1] + 0.0
            corners = corners[(corners != np.roll(corners, -1, axis=0)).any(axis=1)]
            rings.append(_turning(corners, clockwise=number > 0))
            holes.append(number > 0)
    starts = np.cumsum([0, *map(len, rings)], dtype=np.int32)
    parts = len(shapely.get_parts(shape))
    text = f"a {shape.geom_type.lower()} of {starts[-1]:,} corners" + (
        f" in {parts} parts" if parts > 1 else ""
    )
    return Domain(np.concatenate(rings), starts, np.array(holes), text, _touches(rings, shapely))


def _turning(corners: Floats, *, clockwise: bool) -> Floats:
    """Return a ring that turns as it should; its least corner tells how it does."""
    least = int(np.lexsort(corners.T[::-1])[0])
    three = np.roll(corners, 1 - least, axis=0)[:3]
    turns_clockwise = bool(orient2d(*three[:, None])[0] < 0)
    return corners if turns_clockwise == clockwise else corners[::-1]


def _touches(rings: list[Floats], shapely: Any) -> Rows:
    """Find corners inside edges of other rings; within one ring a valid polygon has none."""
    if len(rings) == 1:
        return np.empty((0, 2), dtype=np.int32)
    corners = np.concatenate(rings)
    ends = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    edges = shapely.linestrings(np.stack([corners, ends], axis=1))
    corner, edge = shapely.STRtree(edges).query(shapely.points(corners), predicate="intersects")
    is_end = (corners[corner] == corners[edge]).all(axis=1)
    is_end |= (corners[corner] == ends[edge]).all(axis=1)
    is_on = orient2d(corners[edge], ends[edge], corners[corner]) == 0
    touches: Rows = np.stack([corner, edge], axis=1)[is_on & ~is_end].astype(np.int32)
    return touches


def _check_finite(coordinates: Floats) -> None:
    if not np.isfinite(coordinates).all():
        raise InputError(
            f"{Option('domain')} has a coordinate that is not finite: give finite numbers"
        )
