"""Families of GeoJSON, GeoPackages and shapefiles.

Work grows where features are many and small, where each has properties of its own, where one shape
has very many parts, and where little text describes many objects.
"""

from __future__ import annotations

import json

import numpy as np
from files import shapes
from growth.families import named, random

_PLACE = '{"type": "Point", "coordinates": [%d, 2, 3]}'


def _places(n: int) -> list[list[float]]:
    return (random().random((max(n, 1), 3)) * 1000).tolist()


def _collection(features: str) -> bytes:
    return f'{{"type": "FeatureCollection", "features": [{features}]}}'.encode()


def points_in_json(n: int) -> bytes:
    """The ordinary file: points with two properties."""
    held = (
        {
            "type": "Feature",
            "properties": {"id": k, "name": f"tree {k}"},
            "geometry": {"type": "Point", "coordinates": place},
        }
        for k, place in enumerate(_places(n))
    )
    return _collection(", ".join(map(json.dumps, held)))


def points_of_few_digits(n: int) -> bytes:
    """Features without properties, of whole numbers."""
    one = '{"type":"Feature","properties":{},"geometry":{"type":"Point","coordinates":[1,2]}}'
    return _collection(",".join([one] * max(n, 1)))


def one_multipoint(n: int) -> bytes:
    """One geometry of very many places."""
    return json.dumps({"type": "MultiPoint", "coordinates": _places(n)}).encode()


def properties_of_their_own(n: int) -> bytes:
    """Features each of which has another property: refused beyond a number of values."""
    one = '{"type": "Feature", "properties": {"a%d": 1}, "geometry": %s}'
    return _collection(", ".join(one % (k, _PLACE % k) for k in range(max(n, 1))))


def properties_of_one_feature(n: int) -> bytes:
    """A feature with very many properties: refused beyond a number of them."""
    names = ", ".join(f'"a{k}": 1' for k in range(n))
    feature = f'{{"type": "Feature", "properties": {{{names}}}, "geometry": {_PLACE % 1}}}'
    return _collection(feature)


def empty_lists(n: int) -> bytes:
    """Lists of nothing, three bytes each: refused beyond a size."""
    return b'{"type": "MultiPoint", "coordinates": [%s[1, 2]]}' % (b"[]," * n)


def empty_objects(n: int) -> bytes:
    """Objects of nothing, three bytes each: refused beyond a size."""
    return b'{"type": "MultiPoint", "coordinates": [[1, 2]], "a": [%s{}]}' % (b"{}," * n)


def other_shapes(n: int) -> bytes:
    """Lines and points in turn, in one collection of geometries."""
    line = '{"type": "LineString", "coordinates": [[0, 0], [1, 1]]}'
    held = ", ".join(f"{line}, {_PLACE % k}" for k in range(max(n, 1)))
    return f'{{"type": "GeometryCollection", "geometries": [{held}]}}'.encode()


def nested_collections(n: int) -> bytes:
    """Collections in collections: refused as deep as Python goes."""
    begin = b'{"type": "GeometryCollection", "geometries": ['
    return begin * n + (_PLACE % 1).encode() + b"]}" * n


def long_text(n: int) -> bytes:
    """A property as long as the file, which is no number."""
    feature = '{"type": "Feature", "properties": {"a": "%s"}, "geometry": %s}'
    return _collection(feature % ("a" * n, _PLACE % 1))


GEOJSON = named(
    points_in_json,
    points_of_few_digits,
    one_multipoint,
    properties_of_their_own,
    properties_of_one_feature,
    empty_lists,
    empty_objects,
    other_shapes,
    nested_collections,
    long_text,
)


def points_in_sqlite(n: int) -> bytes:
    """The ordinary file: points with two columns."""
    held = [shapes.point(*each) for each in _places(n)]
    columns = {"id": range(len(held)), "name": [f"tree {k}" for k in range(len(held))]}
    return shapes.geopackage(held, columns)


def planar_points(n: int) -> bytes:
    """Points of 21 bytes, without columns."""
    return shapes.geopackage([shapes.point(1.0, 2.0)] * max(n, 1))


def multipoint_in_sqlite(n: int) -> bytes:
    """One geometry of very many points, over many pages."""
    return shapes.geopackage([shapes.multipoint(_places(n))])


def tin(n: int) -> bytes:
    """One surface of triangles that share no corner."""
    corners = np.array(_places(3 * max(n, 1))).reshape(-1, 3, 3)
    return shapes.geopackage([shapes.surface(corners.tolist())])


def equal_triangles(n: int) -> bytes:
    """Surfaces of the same triangle."""
    one = shapes.surface([[(0, 0, 0), (1, 0, 0), (0, 1, 0)]])
    return shapes.geopackage([one] * max(n, 1))


def short_values(n: int) -> bytes:
    """Columns of a byte or two a value."""
    columns = {f"a{k}": [k % 300] * max(n // 8, 1) for k in range(64)}
    columns |= {f"b{k}": ["ab"] * max(n // 8, 1) for k in range(64)}
    return shapes.geopackage([shapes.point(1.0, 2.0, 3.0)] * max(n // 8, 1), columns)


def no_shapes(n: int) -> bytes:
    """Rows without a geometry, and one with it."""
    return shapes.geopackage([None] * n + [shapes.point(1.0, 2.0, 3.0)])


GEOPACKAGE = named(
    points_in_sqlite,
    planar_points,
    multipoint_in_sqlite,
    tin,
    equal_triangles,
    short_values,
    no_shapes,
)


def shape_points(n: int) -> bytes:
    """The ordinary file: points with heights."""
    return shapes.shp_points(_places(n))


def null_shapes(n: int) -> bytes:
    """Records without a shape, and one with it."""
    (point,) = (shapes.shp_points([(1, 2, 3)])[112:],)
    return shapes.shp(11, [None] * n + [point])


def one_multipoint_shape(n: int) -> bytes:
    """One shape of very many points."""
    corners = np.array(_places(n))
    body = corners[:, :2].tobytes() + bytes(16) + corners[:, 2].tobytes()
    return shapes.shp(18, [bytes(32) + len(corners).to_bytes(4, "little") + body])


def strip_of_triangles(n: int) -> bytes:
    """One strip, in which each corner is in three triangles."""
    return shapes.shp(31, [shapes.shp_patches([(0, _places(n + 3))])])


def fans_of_triangles(n: int) -> bytes:
    """Fans of three triangles each."""
    places = _places(5 * max(n, 1))
    parts = [(1, places[k : k + 5]) for k in range(0, len(places), 5)]
    return shapes.shp(31, [shapes.shp_patches(parts)])


def holes_in_a_patch(n: int) -> bytes:
    """A ring with very many holes, which is left out, and a triangle."""
    ring = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 0)]
    return shapes.shp(31, [shapes.shp_patches([(2, ring), *[(3, ring)] * n, (2, ring)])])


SHAPEFILE = named(
    shape_points,
    null_shapes,
    one_multipoint_shape,
    strip_of_triangles,
    fans_of_triangles,
    holes_in_a_patch,
)
