"""GeoJSON, GeoPackages and shapefiles: points and surfaces, and lies about them."""

from __future__ import annotations

import json
import struct
from typing import Any

from files import shapes
from fuzz.structure.case import Case, in_order, quarters, told
from fuzz.structure.parts import Chance, Part, damaged
from fuzz.structure.trees import lie

_FORMS = ("<B", "<H", "<I", ">H", ">I", "<d", "<Q")
_SHAPE_WORDS = [b"\0\0\x27\x0a", b"\x1f\0\0\0", b"\x0b\0\0\0", b"\0\0\0\0"]


def geojson(chance: Chance) -> Case:
    """Make a collection of features; in three of four some of its values are others."""
    points = quarters(chance, chance.randint(1, 6))
    places: list[Any] = [("Point", each) for each in points.tolist()]
    if chance.one_in(3):
        places = [("MultiPoint", points.tolist())]
    is_more = chance.one_in(3)
    places += [("LineString", [[0, 0], [1, 1]])] * is_more
    tree = {
        "type": "FeatureCollection",
        "features": [
            {
                "type": "Feature",
                "properties": {"id": k, "name": "a", "height": 1.5},
                "geometry": {"type": kind, "coordinates": held},
            }
            for k, (kind, held) in enumerate(places)
        ],
    }
    if chance.one_in(2):
        tree["crs"] = {"type": "name", "properties": {"name": "EPSG:25832"}}
    if chance.one_in(4):
        return Case("geojson", json.dumps(tree).encode(), in_order(points), others=is_more)
    for _ in range(chance.choice((1, 1, 2, 4))):
        if tree:
            lie(tree, chance)
    return Case("geojson", json.dumps(tree).encode())


def geopackage(chance: Chance) -> Case:
    """Make a layer of points or a surface; in three of four some numbers are others."""
    points = quarters(chance, chance.randint(3, 9))
    held = [shapes.point(*each) for each in points.tolist()]
    if chance.one_in(3):
        held = [shapes.surface([points[:3].tolist()], chance.choice((1015, 1016)))]
        points = points[:3]
    is_honest = chance.one_in(4)
    if not is_honest and chance.one_in(2):
        at = chance.randrange(len(held))
        held[at] = damaged(held[at], chance, _FORMS)
    columns = {"id": list(range(len(held))), "name": ["a"] * len(held)}
    data = shapes.geopackage(held, columns, srs=chance.choice((0, 25832)))
    if is_honest:
        return Case("gpkg", data, in_order(points))
    return Case("gpkg", damaged(data, chance, _FORMS) if chance.one_in(2) else data)


def shapefile(chance: Chance) -> Case:
    """Make points, or a surface of some parts."""
    points = quarters(chance, chance.randint(3, 7))
    rows = points.tolist()
    parts: list[Part] = []
    if chance.one_in(2):
        kind = 11
        for each in rows:
            parts += [_head(36), Part(11, "<i"), *(Part(value, "<d") for value in (*each, 0.0))]
    else:
        kind = 31
        record = shapes.shp_patches([(chance.choice((0, 1)), rows)])
        counts = [Part(value, "<I") for value in struct.unpack_from("<4I", record, 32)]
        parts += [_head(4 + len(record)), Part(31, "<i"), Part(record[:32]), *counts]
        numbers = struct.unpack_from(f"<{(len(record) - 48) // 8}d", record, 48)
        parts += [Part(value, "<d") for value in numbers]
    size = 100 + sum(len(each.encode()) for each in parts)
    head = [Part(shapes.shp(0, [])[:24]), Part(size // 2, ">i"), Part(1000, "<i"), Part(kind, "<i")]
    return told("shp", [*head, Part(bytes(64)), *parts], _SHAPE_WORDS, points, chance)


def _head(size: int) -> Part:
    return Part(struct.pack(">2i", 1, size // 2))
