"""Files of the formats that liftmesh only reads, written by other libraries, or by hand."""

from __future__ import annotations

import gzip
import json
import sqlite3
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import open3d as o3d
import rasterio
from conversions.objects import to_geopandas, to_structured, to_tensor_points
from conversions.passages import Arrival, Passage, without_others
from files.e57 import Scan, e57
from files.geotiff import geotiff
from files.shapes import dbf, geopackage as package, point, shp_points
from pye57 import libe57
from pyproj import CRS

from liftmesh import Cloud, InputError, read
from liftmesh.base.colors import as_uint8, stated_depth
from liftmesh.io.registry import FORMATS

Array = np.ndarray[Any, np.dtype[Any]]


def npy(cloud: Cloud, path: Path) -> None:
    """A structured array, of the numbers that it takes."""
    table = to_structured(_with_numbers(cloud))
    if not all(name.isascii() for name in table.dtype.names or ()):
        raise InputError("NumPy warns of such names")
    np.save(path, table)


def pcd(cloud: Cloud, path: Path) -> None:
    """As Open3D writes it: fields of scalars, colours in 8 bits."""
    colors = None if cloud.colors is None else as_uint8(cloud.colors)[:, :3]
    points = to_tensor_points(replace(_with_numbers(cloud), colors=colors, color_depth=None))
    for name in [*points.point]:
        if points.point[name].dtype in (o3d.core.bool, o3d.core.Dtype.Bool):
            raise InputError("PCD has no type for it")
        is_field = name.isprintable() and name.isascii() and " " not in name and name
        if name == "alpha" or not is_field:
            raise InputError("PCD has no such field")
    with o3d.utility.VerbosityContextManager(o3d.utility.VerbosityLevel.Error):
        if not o3d.t.io.write_point_cloud(str(path), points):
            raise InputError("Open3D does not write this")


def pts(cloud: Cloud, path: Path) -> None:
    columns = [cloud.points, *_column(cloud, "intensity"), *_eight_bits(cloud)]
    path.write_text(f"{len(cloud)}\n" + _lines(columns))


def xyzrgb(cloud: Cloud, path: Path) -> None:
    columns = [cloud.points, *_eight_bits(cloud)]
    if len(columns) == 1:
        raise InputError("XYZRGB has colours")
    path.write_text(_lines(columns))


def xyzn(cloud: Cloud, path: Path) -> None:
    if cloud.normals is None:
        raise InputError("XYZN has normals")
    path.write_text(_lines([cloud.points, cloud.normals.astype(np.float64)]))


def ele(cloud: Cloud, path: Path) -> None:
    """The triangles in an .ele file, beside their points, in space as TetGen's."""
    values = _column(cloud, "attribute_1")
    rows = _lines([np.arange(len(cloud))[:, None], cloud.points, *values])
    path.with_suffix(".node").write_text(f"{len(cloud)} 3 {len(values)} 0\n{rows}")
    faces = np.zeros((0, 3), np.int32) if cloud.faces is None else cloud.faces
    rows = _lines([np.arange(len(faces))[:, None], faces])
    path.write_text(f"{len(faces)} 3 0\n{rows}")


def raster(cloud: Cloud, path: Path) -> None:
    """A GeoTIFF of pixels of size 1, for rows on a lattice in the order of its samples."""
    x, y, z = cloud.points.T
    places = np.stack([y, x], axis=1)
    is_small = len(cloud) and np.abs(places).max() < 100 and np.array_equal(places, places.round())
    steps = np.diff(places @ [1000, 1]) if is_small else np.zeros(1)
    if not (steps > 0).all() or not np.isfinite(z).all() or (z == -9999).any() or not is_small:
        raise InputError("a raster has the rows of a lattice, in its order")
    if np.signbit(places[places == 0]).any():
        raise InputError("a raster has no negative zeros")
    low, high = places.min(axis=0).astype(int), places.max(axis=0).astype(int)
    heights = np.full(high - low + 1, -9999.0)
    heights[tuple((places - low).astype(int).T)] = z
    transform = rasterio.Affine(1, 0, low[1] - 0.5, 0, 1, low[0] - 0.5)
    path.write_bytes(geotiff(heights, transform=transform, nodata=-9999))


def scan(cloud: Cloud, path: Path) -> None:
    """A scan of E57, of the types that libE57 writes."""
    values = dict(zip(("cartesianX", "cartesianY", "cartesianZ"), cloud.points.T, strict=True))
    for each in _eight_bits(cloud):
        values |= dict(zip(("colorRed", "colorGreen", "colorBlue"), each.T, strict=True))
    for name, each in _with_numbers(cloud).attributes.items():
        if each.ndim > 1 or (each.dtype == np.uint64 and (each > 1 << 62).any()):
            raise InputError("E57 has no such values")
        native = each.dtype.newbyteorder("=")
        values[name] = each.astype(_STORED.get(native.name, native))
    crs = cloud.crs or ""
    if not set(crs) <= _IN_XML or crs != crs.strip():
        raise InputError("XML has no such characters, or no such blanks")
    try:
        path.write_bytes(e57(Scan(values), crs=crs))
    except (libe57.E57Exception, UnicodeEncodeError, TypeError) as error:  # of half a character
        raise InputError("E57 has no such field or text") from error


def _features(cloud: Cloud) -> tuple[list[list[float]], dict[str, list[Any]]]:
    """Places, and the values of columns, None where there is none."""
    _eight_bits(cloud)
    frame = to_geopandas(cloud)
    columns = {str(k): frame[k].to_list() for k in frame.columns if k != "geometry"}
    if any(each in ("geom", "fid") for each in map(str.lower, columns)):
        raise InputError("such columns are those of the geometries")
    return cloud.points.tolist(), columns


def geojson(cloud: Cloud, path: Path) -> None:
    """A feature for each point; NaN as Python writes it."""
    places, columns = _features(cloud)
    names = [*columns]
    features = [
        {
            "type": "Feature",
            "properties": dict(zip(names, values, strict=True)),
            "geometry": {"type": "Point", "coordinates": place},
        }
        for place, *values in zip(places, *columns.values(), strict=True)
    ]
    name = cloud.crs and {"type": "name", "properties": {"name": cloud.crs}}
    tree = {"type": "FeatureCollection", "crs": name, "features": features}
    try:
        path.write_text(json.dumps(tree))
    except TypeError as error:
        raise InputError("JSON does not hold this") from error


def geopackage(cloud: Cloud, path: Path) -> None:
    """A row for each point, by the SQLite of Python."""
    places, columns = _features(cloud)
    if len({each.lower() for each in columns}) < len(columns):
        raise InputError("SQLite tells columns apart by more than case")
    held = [point(*each) for each in places]
    srs = 0 if cloud.crs is None else 25832
    try:
        path.write_bytes(package(held, columns, srs=srs))
    except (sqlite3.Error, OverflowError, ValueError) as error:
        raise InputError("SQLite does not hold this") from error


def shapefile(cloud: Cloud, path: Path) -> None:
    """A record for each point, and numbers as text beside it."""
    places, columns = _features(cloud)
    held: dict[str, tuple[str, int, list[str]]] = {}
    for name, values in columns.items():
        if not name.isprintable() or not 0 < len(name.encode("utf-8", "replace")) < 11:
            raise InputError("dBase has no such names")
        if all(isinstance(each, bool) for each in values):
            held[name] = ("L", 1, ["T" if each else "F" for each in values])
        else:
            held[name] = ("N", 32, [*map(repr, values)])
    path.write_bytes(shp_points(places))
    if cloud.crs:
        path.with_suffix(".prj").write_text(CRS(cloud.crs).to_wkt())
    if held:
        path.with_suffix(".dbf").write_bytes(dbf(held, len(places)))
        path.with_suffix(".cpg").write_text("UTF-8")


_IN_XML = {chr(k) for k in (9, 10, *range(32, 0xD800), *range(0xE000, 0xFFFE))}
_STORED = {"bool": "u1", "float16": "f4"} | dict.fromkeys(
    ("int32", "uint32", "int64", "uint64"), "q"
)

MAKERS: dict[str, Callable[[Cloud, Path], None]] = {
    "npy": npy, "pcd": pcd, "pts": pts, "xyzrgb": xyzrgb, "xyzn": xyzn, "ele": ele,
    "raster": raster, "e57": scan, "geojson": geojson, "geopackage": geopackage,
    "shapefile": shapefile,
}  # fmt: skip


def read_only() -> Iterator[Passage]:
    """Every format that is read but not written."""
    for each in FORMATS:
        if each.read is not None and each.write is None:
            yield Passage(each.name, partial(_through_file, each.name))
            if each.gzip:
                yield Passage(f"{each.name}.gz", partial(_through_gzip, each.name))


def _through_file(kind: str, cloud: Cloud) -> Arrival:
    with tempfile.TemporaryDirectory() as folder:
        path = _made(kind, cloud, folder)
        back = without_others(read(path, format=kind), cloud)
        return Arrival(back, cloud, data=path.read_bytes())


def _through_gzip(kind: str, cloud: Cloud) -> Arrival:
    with tempfile.TemporaryDirectory() as folder:
        path = _made(kind, cloud, folder)
        compressed = path.with_name(f"{path.name}.gz")
        compressed.write_bytes(gzip.compress(path.read_bytes(), 1))
        return Arrival(read(compressed), cloud)


def _made(kind: str, cloud: Cloud, folder: str) -> Path:
    path = Path(folder) / f"cloud.{kind}"
    MAKERS[kind](cloud, path)
    return path


def _with_numbers(cloud: Cloud) -> Cloud:
    kinds = {name: each.dtype.str[1:] for name, each in cloud.attributes.items()}
    if any(kind[0] not in "biuf" or kind == "f16" for kind in kinds.values()):
        raise InputError("the attributes are no numbers")
    return cloud


def _column(cloud: Cloud, name: str) -> list[Array]:
    values = cloud.attributes.get(name)
    is_number = values is not None and values.ndim == 1 and values.dtype.kind in "biuf"
    return [values.astype(np.float64)[:, None]] if values is not None and is_number else []


def _eight_bits(cloud: Cloud) -> list[Array]:
    """Colours of 8 or 16 bits as whole numbers."""
    colors = cloud.colors
    if colors is None:
        return []
    if colors.dtype.str[1:] not in {"u1", "u2"} or int(colors[:, :3].max(initial=0)) < 2:
        raise InputError("as numbers, these colours would be others")
    if stated_depth(colors[:, :3]) is not None:
        raise InputError("the values of the colours tell another depth")
    return [colors[:, :3]]


def _lines(columns: list[Array]) -> str:
    rows = zip(*(column.tolist() for column in columns), strict=True)
    return "".join(" ".join(repr(value) for part in row for value in part) + "\n" for row in rows)
