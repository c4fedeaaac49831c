"""GeoJSON: geometries, which are read, and lines, which are written one by one.

GeoJSON by itself is in degrees (RFC 7946). Coordinates of another system have its name in the
member ``crs``, as GeoJSON had it before, and as GDAL writes and reads it: the number of the system
if it has one, or else its whole text.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from types import MappingProxyType
from typing import Any, BinaryIO, TypeAlias

import numpy as np

from liftmesh._typing import Floats
from liftmesh.base.arrays import as_pairs, as_reals
from liftmesh.base.options import shown
from liftmesh.crs.description import urn_of
from liftmesh.errors import InputError

Geometry: TypeAlias = tuple[str, Any, Mapping[str, Any]]

_PARTS = {"FeatureCollection": "features", "GeometryCollection": "geometries"}
_NONE: Mapping[str, Any] = MappingProxyType({})


def geometries(tree: object, properties: Mapping[str, Any] = _NONE) -> Iterator[Geometry]:
    """Yield the geometries of a tree, in its order."""
    if not isinstance(tree, Mapping):
        raise TypeError(f"no object of GeoJSON: {tree!r:.60}")
    kind = tree.get("type")
    if kind in _PARTS:
        for part in tree.get(_PARTS[kind]) or ():
            if part is not None:  # a feature that was taken as it was parsed
                yield from geometries(part, properties)
    elif kind == "Feature":
        held = tree.get("properties")
        mine = held if isinstance(held, Mapping) else _NONE
        yield from geometries(tree.get("geometry") or _NONE, mine)
    elif isinstance(kind, str):
        yield kind, tree.get("coordinates") or (), properties


def coordinates_of(tree: object, kind: str) -> Iterator[Any]:
    """Yield the coordinates of all geometries of one kind, those of a Multi one by one."""
    for own_kind, coordinates, _ in geometries(tree):
        parts = (
            [coordinates] if own_kind == kind else coordinates if own_kind == f"Multi{kind}" else ()
        )
        yield from (part for part in parts if part)


def planar_corners(corners: Any, part: str, whole: str, fewest: int) -> Floats:
    """Convert the corners of a line or ring; heights, which GeoJSON allows, are left out."""
    return as_pairs(_corners(corners, part, whole, fewest)[:, :2])


def spatial_corners(corners: Any, part: str, whole: str, fewest: int) -> Floats:
    """Convert the corners of a line or ring, (c, 3), with NaN as the heights that are missing."""
    array = _corners(corners, part, whole, fewest)
    if array.shape[1] == 2:
        return np.column_stack([array, np.full(len(array), np.nan)])
    if np.isinf(array[:, 2]).any():
        raise InputError(f"a height of {whole} is not finite")
    return array


def _corners(corners: Any, part: str, whole: str, fewest: int) -> Floats:
    """Convert corners, with heights if they have some."""
    try:
        array = as_reals(corners)
    except (TypeError, ValueError, OverflowError) as error:
        name = part if part == whole else f"{part} of {whole}"
        raise InputError(f"{name} cannot be read: {shown(corners)}") from error
    if array.ndim != 2 or array.shape[1] not in (2, 3) or len(array) < fewest:
        count = {2: "two", 3: "three"}[fewest]
        raise InputError(f"{part} needs {count} corners x, y or more, not the shape {array.shape}")
    if not np.isfinite(array[:, :2]).all():
        raise InputError(f"a corner of {whole} is not finite")
    return array


def write_features(
    stream: BinaryIO,
    features: Iterable[tuple[Mapping[str, Any], Mapping[str, Any]]],
    crs: str | None,
) -> None:
    """Write a collection of features, each with its properties and its geometry."""
    stream.writelines(each.encode() for each in _texts(features, crs))


def crs_member(crs: str | None) -> str:
    """Return the member that names a coordinate system, with the comma and line end after it."""
    if crs is None:
        return ""
    system = {"type": "name", "properties": {"name": urn_of(crs)}}
    return f'"crs": {json.dumps(system)},\n'


def _texts(
    features: Iterable[tuple[Mapping[str, Any], Mapping[str, Any]]], crs: str | None
) -> Iterator[str]:
    yield f'{{"type": "FeatureCollection",\n{crs_member(crs)}"features": ['
    for number, (properties, geometry) in enumerate(features):
        feature = {"type": "Feature", "properties": properties, "geometry": geometry}
        yield ("," if number else "") + "\n" + json.dumps(feature)
    yield "\n]}\n"
