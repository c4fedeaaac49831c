"""Lines of files of shapes: read in the plane, and written as GeoJSON or GeoPackage."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path

from liftmesh._typing import Array, Floats
from liftmesh.errors import FormatError, InputError
from liftmesh.io.atomic import replacing
from liftmesh.io.write import WriteResult, written_file
from liftmesh.vector import geojson, geopackage
from liftmesh.vector.files import read_shapes

LINE_SUFFIXES = (".geojson", ".json", ".gpkg")


def lines_of(path: Path, crs: str | None) -> list[Floats]:
    """Read the lines of a file, which has to be in the system of a surface."""
    tree = read_shapes(path, "lines", crs)
    try:
        lines = [
            geojson.planar_corners(each, "a line", "a line", 2)
            for each in geojson.coordinates_of(tree, "LineString")
        ]
    except (TypeError, AttributeError, RecursionError) as error:
        raise FormatError(f"{path}: no GeoJSON: a line has type and coordinates") from error
    except InputError as error:
        raise FormatError(f"{path}: {error}") from error
    if not lines:
        raise FormatError(f"{path}: there is no LineString or MultiLineString in it")
    return lines


def write_lines(
    path: Path,
    points: Floats,
    starts: Array,  # where each line begins, and where the last ends
    columns: Mapping[str, Array],
    crs: str | None,
    layer: str,
) -> WriteResult:
    """Write lines with a value of each column, as the name of the file says."""
    is_package = path.suffix.lower() == ".gpkg"
    with replacing(path) as stream:
        if is_package:
            geopackage.write_lines(stream, points, starts, columns, crs, layer)
        else:
            rows = zip(*(values.tolist() for values in columns.values()), strict=True)
            properties = (dict(zip(columns, row, strict=True)) for row in rows)
            parts = (points[begin:end] for begin, end in pairwise(starts.tolist()))
            geojson.write_lines(stream, zip(properties, parts, strict=True), crs)
    return written_file(path, "geopackage" if is_package else "geojson")
