"""Geometries in a tree of GeoJSON, wherever collections and features hold them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any, TypeAlias

Geometry: TypeAlias = tuple[str, Any, Mapping[str, Any]]

_PARTS = {"FeatureCollection": "features", "GeometryCollection": "geometries"}
_NONE: Mapping[str, Any] = MappingProxyType({})


def geometries(tree: object, properties: Mapping[str, Any] = _NONE) -> Iterator[Geometry]:
    """Yield the geometries of a tree, in its order.

    Parameters
    ----------
    tree : object
        A collection, feature or geometry, as mappings and sequences.
    properties : mapping
        Those of geometries that are in no feature.

    Yields
    ------
    kind : str
        The type, as ``"MultiPoint"``.
    coordinates : object
        What it has as such; empty if it has none.
    properties : mapping
        Those of its feature.

    Raises
    ------
    TypeError
        A part is no object of GeoJSON.

    Examples
    --------
    >>> point = {"type": "Point", "coordinates": [1, 2]}
    >>> feature = {"type": "Feature", "properties": {"id": 7}, "geometry": point}
    >>> [*geometries({"type": "FeatureCollection", "features": [feature]})]
    [('Point', [1, 2], {'id': 7})]
    """
    if not isinstance(tree, Mapping):
        raise TypeError(f"no object of GeoJSON: {tree!r:.60}")
    kind = tree.get("type")
    if kind in _PARTS:
        for part in tree.get(_PARTS[kind]) or ():
            yield from geometries(part, properties)
    elif kind == "Feature":
        held = tree.get("properties")
        mine = held if isinstance(held, Mapping) else _NONE
        yield from geometries(tree.get("geometry") or _NONE, mine)
    elif isinstance(kind, str):
        yield kind, tree.get("coordinates") or (), properties


def coordinates_of(tree: object, kind: str) -> Iterator[Any]:
    """Yield the coordinates of all geometries of one kind, those of a Multi one by one.

    Parameters
    ----------
    tree : object
        As for `geometries`.
    kind : str
        ``"LineString"`` or ``"Polygon"``; what has no coordinates is passed over.

    Yields
    ------
    object
        The coordinates.

    Raises
    ------
    TypeError
        As for `geometries`.

    Examples
    --------
    >>> roads = {"type": "MultiLineString", "coordinates": [[[0, 1], [2, 3]], []]}
    >>> [*coordinates_of(roads, "LineString")]
    [[[0, 1], [2, 3]]]
    """
    for found, coordinates, _ in geometries(tree):
        parts = [coordinates] if found == kind else coordinates if found == f"Multi{kind}" else ()
        yield from (part for part in parts if part)
