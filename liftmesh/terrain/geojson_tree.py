"""Geometries in a tree of GeoJSON, wherever collections and features hold them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any, TypeAlias

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
            yield from geometries(part, properties)
    elif kind == "Feature":
        held = tree.get("properties")
        mine = held if isinstance(held, Mapping) else _NONE
        yield from geometries(tree.get("geometry") or _NONE, mine)
    elif isinstance(kind, str):
        yield kind, tree.get("coordinates") or (), properties


def coordinates_of(tree: object, kind: str) -> Iterator[Any]:
    """Yield the coordinates of all geometries of one kind, those of a Multi one by one."""
    for found, coordinates, _ in geometries(tree):
        parts = [coordinates] if found == kind else coordinates if found == f"Multi{kind}" else ()
        yield from (part for part in parts if part)
