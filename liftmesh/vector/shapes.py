"""Lines and polygons from files, GeoJSON and objects of other libraries.

Objects count by what they offer: ``__geo_interface__``, as those of shapely and geopandas do, or
the discretised curves of a ``trimesh.path.Path2D``. Heights are left out.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, TypeVar

from liftmesh._typing import Floats
from liftmesh.base.options import shown
from liftmesh.errors import FormatError, InputError
from liftmesh.vector.files import read_features
from liftmesh.vector.geojson import geometries, planar_corners
from liftmesh.vector.polygons import Polygon, as_polygons

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
    described = getattr(given, "__geo_interface__", given)
    return take(described) if isinstance(described, Mapping) else None


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
