"""Objects of other libraries that hold a cloud, made by these libraries, and read by liftmesh.

`MAKERS` lists for each adapter of the registry what it is given: an adapter without an entry fails
a test. Tables get those parts of a cloud that they can hold. Objects report no losses: what each
keeps stands in the table of formats.md, and nothing else may be lost.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import geopandas as gpd
import laspy
import numpy as np
import open3d as o3d
import pandas as pd
import polars as pl
import trimesh as trimesh_library
import xarray as xr
from conversions.passages import Arrival, Passage
from laspy.vlrs.known import WktCoordinateSystemVlr

from liftmesh import Cloud, DataWarning, InputError, Surface, as_cloud, triangulate
from liftmesh.base.colors import stated_depth
from liftmesh.io.columns import ALPHA, COLOR, NORMAL, POSITION
from liftmesh.io.format import DOUBLE, fits_whole
from liftmesh.io.formats.text.columns import meaning
from liftmesh.io.metadata import NOTE
from liftmesh.io.objects import open3d, trimesh

Array = np.ndarray[Any, np.dtype[Any]]

STEP = 1 / 1024  # of LAS coordinates
_NOT_OF_POLARS = {"float16", np.dtype(np.longdouble).name}
_VALUES = {*NORMAL, *COLOR, ALPHA}
_PARTS = {*POSITION, *_VALUES}


@dataclass(frozen=True)
class MeshLike:
    """An object of no library, with the usual names."""

    vertices: Array
    faces: Array | None
    colors: Array | None
    normals: Array | None
    attributes: dict[str, Array]


@dataclass(frozen=True)
class CloudLike:
    """An object of no library that says which cloud it is."""

    cloud: Cloud

    def to_cloud(self) -> Cloud:
        return self.cloud


@dataclass(frozen=True)
class ArrayLike:
    """An object of no library that NumPy makes an array of."""

    values: Array

    def __array__(self, dtype: Any = None, copy: Any = None) -> Array:
        return np.array(self.values, dtype=dtype)


def table_columns(cloud: Cloud) -> dict[str, Array]:
    """What a table holds of a cloud: one column for each number of a row.

    Columns have no depth of colours: what the values tell must be true.
    """
    _check_depth(cloud)
    found = dict(zip(POSITION, cloud.points.T, strict=True))
    if cloud.normals is not None:
        found |= zip(NORMAL, cloud.normals.T, strict=True)
    if cloud.colors is not None:
        found |= zip((*COLOR, ALPHA), cloud.colors.T, strict=False)
    flat = {name: each for name, each in cloud.attributes.items() if each.ndim == 1}
    if "" in flat or any(name in _PARTS or meaning(name).part in _VALUES for name in flat):
        raise InputError("an attribute has the name of a column, or none")
    return found | {name: _native(each) for name, each in flat.items()}


def _check_depth(cloud: Cloud) -> None:
    if stated_depth(cloud.colors) is not None:
        raise InputError("the values of the colours tell another depth")


def _native(values: Array) -> Array:
    return values.astype(values.dtype.newbyteorder("="))


def to_pandas(cloud: Cloud) -> pd.DataFrame:
    columns = table_columns(cloud)
    try:
        return pd.DataFrame({k: each for k, each in columns.items() if each.dtype.itemsize <= 8})
    except UnicodeEncodeError as error:
        raise InputError("pandas has no such name") from error


def to_geopandas(cloud: Cloud) -> gpd.GeoDataFrame:
    """Points with the values of a table; shapely has no signalling NaNs."""
    values = {k: each for k, each in to_pandas(cloud).items() if k not in POSITION}
    places = gpd.points_from_xy(*cloud.points.T)
    if not np.isfinite(cloud.points).all():
        raise InputError("points of shapely are finite, or empty")
    if {k.lower() for k in values} & {*POSITION, "geometry"}:
        raise InputError("such columns are those of the geometries")
    if cloud.crs not in (None, "EPSG:25832"):
        raise InputError("pyproj writes other systems its own way")
    return gpd.GeoDataFrame(values, geometry=places, crs=cloud.crs)


def to_grid(cloud: Cloud) -> xr.DataArray:
    """A grid of heights, of rows on a lattice in its order."""
    (x, across), (y, along) = (np.unique(each, return_inverse=True) for each in cloud.points.T[:2])
    in_order = bool((np.diff(along * len(x) + across) > 0).all())
    if not len(cloud) or not in_order or not np.isfinite(cloud.points).all():
        raise InputError("a grid has the rows of a lattice, in its order")
    if np.signbit(cloud.points[cloud.points == 0]).any():
        raise InputError("negative zeros are equal to others")
    heights = np.full((len(y), len(x)), np.nan)
    heights[along, across] = cloud.points[:, 2]
    grid = xr.DataArray(heights, coords={"y": y, "x": x}, dims=("y", "x"))
    stated = {} if cloud.crs is None else {"crs_wkt": cloud.crs}
    return grid.assign_coords(spatial_ref=xr.DataArray(0, attrs=stated))


def to_polars(cloud: Cloud) -> pl.DataFrame:
    columns = table_columns(cloud)
    held = {k: each for k, each in columns.items() if each.dtype.kind in "biufU"}
    held = {k: each for k, each in held.items() if each.dtype.name not in _NOT_OF_POLARS}
    if _PARTS & columns.keys() - held.keys():
        raise InputError("polars has no such colours")
    try:
        return pl.DataFrame(
            {
                k: pl.Series(k, each.tolist() if each.dtype.kind == "U" else each)
                for k, each in held.items()
            }
        )
    except UnicodeEncodeError as error:
        raise InputError("polars has no such name") from error


def to_structured(cloud: Cloud) -> Array:
    columns = table_columns(cloud)
    table = np.empty(len(cloud), [(name, each.dtype) for name, each in columns.items()])
    for name, each in columns.items():
        table[name] = each
    return table


def to_named_rows(cloud: Cloud) -> Cloud:
    """Rows of numbers whose columns the caller names."""
    columns = {k: each for k, each in table_columns(cloud).items() if _are_doubles(each)}
    colors = cloud.colors
    if colors is not None and colors.dtype != np.float64 and not _are_plain(colors):
        raise InputError("as floats, these colours would be others")
    if any("," in name or "=" in name or name in {"", "-"} for name in columns):
        raise InputError("columns= takes no such name")
    return as_cloud(np.column_stack([*columns.values()]).astype(np.float64), columns=[*columns])


def _are_doubles(values: Array) -> bool:
    """Whether doubles hold all values."""
    if values.dtype.kind in "iu":
        return fits_whole(values, DOUBLE)
    return values.dtype.kind == "b" or values.dtype.str[1:] in {"f2", "f4", "f8"}


def _are_plain(colors: Array) -> bool:
    """Whether colours are whole numbers that nobody takes for shares of 1."""
    return colors.dtype.str[1:] in {"u1", "u2"} and int(colors.max(initial=0)) > 1


def to_laspy(cloud: Cloud) -> laspy.LasData:
    """LAS: multiples of a step, and dimensions of its own besides the known ones."""
    _check_las(cloud)
    header = laspy.LasHeader(point_format=0 if cloud.colors is None else 2, version="1.4")
    header.scales = np.full(3, STEP)
    extra = {k: each for k, each in cloud.attributes.items() if _is_dimension(header, k, each)}
    header.add_extra_dims([laspy.ExtraBytesParams(k, each.dtype) for k, each in extra.items()])
    table = laspy.LasData(header)
    table.x, table.y, table.z = cloud.points.T
    for name, each in extra.items():
        table[name] = each
    if cloud.crs is not None:
        header.vlrs.append(WktCoordinateSystemVlr(cloud.crs))
    if cloud.colors is not None:
        for name, each in zip(COLOR, cloud.colors.T, strict=False):
            table[name] = each
    return table


def _check_las(cloud: Cloud) -> None:
    """Refuse coordinates, colours and a crs that LAS cannot hold."""
    with np.errstate(all="ignore"):
        steps = np.rint(cloud.points / STEP)
    if not len(cloud) or not np.array_equal(steps * STEP, cloud.points) or _has_odd_steps(steps):
        raise InputError("LAS holds whole multiples of its scale, of 32 bits")
    _check_depth(cloud)
    if cloud.colors is not None and cloud.colors.dtype.str[1:] not in {"u1", "u2"}:
        raise InputError("LAS holds colours of 16 bits")
    if cloud.crs is not None and (not cloud.crs.isascii() or cloud.crs != cloud.crs.strip()):
        raise InputError("LAS holds the crs as plain text")


def _has_odd_steps(steps: Array) -> bool:
    return bool(np.abs(steps).max() >= 2**31 or np.signbit(steps[steps == 0]).any())


def _is_dimension(header: Any, name: str, values: Array) -> bool:
    known = {each.lower() for each in header.point_format.dimension_names} | _PARTS
    if name.lower() in known:
        raise InputError("LAS has a dimension of this name")
    is_name = name.isascii() and name.isidentifier() and len(name) < 32
    is_number = values.dtype.kind in "iuf" and values.dtype.name not in {
        "float16",
        np.dtype(np.longdouble).name,
    }
    return is_name and is_number and values.ndim == 1


def to_surface(cloud: Cloud) -> Surface:
    """Triangulate, also where the faces that the cloud has fold over."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DataWarning)
        return triangulate(replace(cloud, edges=None), nonfinite="skip")


def to_scene(cloud: Cloud) -> trimesh_library.Scene:
    if not isinstance(cloud.metadata.get("name", ""), str):
        raise InputError("trimesh takes the name of a geometry from its metadata")
    return trimesh_library.Scene(trimesh.to_mesh(_of_trimesh(cloud)))


def _of_trimesh(cloud: Cloud) -> Cloud:
    """Refuse entries of the metadata that are something else in those of trimesh."""
    if not {"crs", NOTE}.isdisjoint(cloud.metadata):
        raise InputError("the metadata of trimesh hold the crs, and liftmesh's note")
    return cloud


def to_legacy_points(cloud: Cloud) -> o3d.geometry.PointCloud:
    mesh = open3d.to_legacy(replace(cloud, faces=None))
    points = o3d.geometry.PointCloud(mesh.vertices)
    points.colors, points.normals = mesh.vertex_colors, mesh.vertex_normals
    return points


def to_tensor_points(cloud: Cloud) -> o3d.t.geometry.PointCloud:
    mesh = open3d.to_tensor(replace(cloud, faces=None))
    points = o3d.t.geometry.PointCloud()
    for name in mesh.vertex:
        points.point[name] = mesh.vertex[name]
    return points


def to_mesh_like(cloud: Cloud) -> MeshLike:
    _check_depth(cloud)
    return MeshLike(cloud.points, cloud.faces, cloud.colors, cloud.normals, dict(cloud.attributes))


# What each adapter of the registry is given. The others refuse whatever they accept.
MAKERS: dict[str, dict[str, Callable[[Cloud], Any]]] = {
    "cloud": {"Cloud": lambda cloud: cloud},
    "table": {
        "pandas.DataFrame": to_pandas,
        "polars.DataFrame": to_polars,
        "geopandas.GeoDataFrame": to_geopandas,
        "structured array": to_structured,
        "laspy.LasData": to_laspy,
    },
    "array": {"array": lambda cloud: cloud.points, "array with columns=": to_named_rows},
    "grid": {"xarray.DataArray": to_grid},
    "trimesh": {
        "trimesh.Trimesh": lambda cloud: trimesh.to_mesh(_of_trimesh(cloud)),
        "trimesh.PointCloud": lambda cloud: trimesh.to_points(_of_trimesh(cloud)),
    },
    "trimesh scene": {"trimesh.Scene": to_scene},
    "open3d": {
        "Open3D TriangleMesh": open3d.to_legacy,
        "Open3D PointCloud": to_legacy_points,
        "Open3D tensor TriangleMesh": open3d.to_tensor,
        "Open3D tensor PointCloud": to_tensor_points,
        "Open3D Tensor": lambda cloud: o3d.core.Tensor(np.array(cloud.points)),
    },
    "own mesh": {"Surface": to_surface},
    "object with to_cloud()": {"object with to_cloud()": CloudLike},
    "object with vertices and faces": {"object with vertices": to_mesh_like},
    "array-like": {"array-like object": lambda cloud: ArrayLike(cloud.points)},
}
REFUSING = {"path", "another table"}

# What surfaces become.
OUTPUTS: dict[str, Callable[[Surface], Any]] = {
    "Surface.to_trimesh()": lambda surface: trimesh.to_mesh(_of_trimesh(surface.to_cloud())),
    "Surface.to_open3d()": Surface.to_open3d,
    "Surface.to_open3d_t()": Surface.to_open3d_t,
}


def objects() -> Iterator[Passage]:
    """Every way through an object."""
    for makers in MAKERS.values():
        for name, make in makers.items():
            yield Passage(name, partial(_through_object, make))
    for name, convert in OUTPUTS.items():
        yield Passage(name, partial(_through_surface, convert))


def _through_object(make: Callable[[Cloud], Any], cloud: Cloud) -> Arrival:
    made = make(cloud)
    back = as_cloud(made)
    if isinstance(made, laspy.LasData):
        own = {*made.point_format.dimension_names} - cloud.attributes.keys()
        others = {name: each for name, each in back.attributes.items() if name not in own}
        back = replace(back, attributes=others)
    if isinstance(made, Surface):
        cloud = replace(cloud, faces=made.faces, metadata=_of_new_faces(cloud, back))
    return Arrival(back, sent=cloud)


def _of_new_faces(cloud: Cloud, back: Cloud) -> dict[str, Any]:
    """Return the metadata, but what told how the faces before were made, where it is gone."""
    told = {"triangulated_by"} - back.metadata.keys()
    return {key: value for key, value in cloud.metadata.items() if key not in told}


def _through_surface(convert: Callable[[Surface], Any], cloud: Cloud) -> Arrival:
    surface = to_surface(cloud)
    return Arrival(as_cloud(convert(surface)), sent=surface.to_cloud())
