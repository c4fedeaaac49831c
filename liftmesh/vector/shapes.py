"""Lines and polygons of whatever is not a plain array: files, GeoJSON, objects of other libraries.

Objects count by what they offer: ``__geo_interface__``, as those of shapely and geopandas do, or
the discretised curves of a ``trimesh.path.Path2D``. Heights are left out.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from liftmesh._typing import Floats
from liftmesh.base.options import shown
from liftmesh.errors import FormatError, InputError
from liftmesh.vector.files import read_features
from liftmesh.vector.geojson import geometries, planar_corners
from liftmesh.vector.polygons import Polygon, as_polygons

_DEPTH = {"LineString": 1, "LinearRing": 1, "MultiLineString": 2, "Polygon": 2, "MultiPolygon": 3}


def lines_in(given: Any) -> list[Floats] | None:
    """Return lines, and the rings of polygons, as lines that end where they begin.

    None for what is no shape.
    """
    if isinstance(given, str | os.PathLike):
        path = Path(given)
        try:
            return _lines(read_features(path, "lines"))
        except InputError as error:
            raise FormatError(f"{path}: {error.message.marked}") from error
    if _is_path(given):
        return [planar_corners(each, "a line", "a line", 2) for each in given.discrete]
    described = getattr(given, "__geo_interface__", given)
    return _lines(described) if isinstance(described, Mapping) else None


def areas_in(given: Any) -> tuple[list[Polygon], bool] | None:
    """Return polygons, each as its rings; None for what is no shape.

    Or, where there is no polygon, lines that end where they begin, and True: of these nothing says
    which are holes.
    """
    if isinstance(given, str | os.PathLike):
        path = Path(given)
        try:
            return _areas(read_features(path, "polygons"))
        except InputError as error:
            raise FormatError(f"{path}: {error.message.marked}") from error
    if _is_path(given):
        return [each for area in given.polygons_full for each in as_polygons(area)], False
    described = getattr(given, "__geo_interface__", given)
    return _areas(described) if isinstance(described, Mapping) else None


def _is_path(given: Any) -> bool:
    """Whether this is a path of trimesh, whose attributes are costly to look up."""
    return hasattr(type(given), "discrete") and hasattr(type(given), "polygons_full")


def _lines(tree: Any) -> list[Floats]:
    try:
        lines = [
            planar_corners(each, "a line", "a line", 2)
            for kind, coordinates, _ in geometries(tree)
            for each in _flat(coordinates, _DEPTH.get(kind, 0))
        ]
    except (TypeError, AttributeError, RecursionError) as error:
        raise InputError(f"no GeoJSON ({shown(tree)}): a line has type and coordinates") from error
    if not lines:
        raise InputError("there is no line in what is given: give LineString or Polygon")
    return lines


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
