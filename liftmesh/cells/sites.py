"""Sites in whatever holds points: arrays, clouds, tables without heights, GeoPandas."""

from __future__ import annotations

from typing import Any

import numpy as np

from liftmesh.base.cloud import Cloud
from liftmesh.crs.comparison import common_system, system_of
from liftmesh.errors import InputError
from liftmesh.io.objects.plain import is_table
from liftmesh.io.registry import as_cloud
from liftmesh.planar.meshes import rows_of
from liftmesh.planar.weights import named_values


def sites_of(points: Any, domain: Any = None) -> Any:
    """Return the points of anything, for arrays to be made of."""
    common_system(system_of(points), system_of(domain))
    if _is_geometric(points):
        return _coordinates(points)
    if is_table(points):
        return as_cloud(points, flat=None).points
    listed = isinstance(points, list | tuple) or (isinstance(points, np.ndarray) and points.ndim)
    first = points[0] if listed and len(points) else points
    if hasattr(first, "geom_type"):
        raise InputError("the points are geometries of shapely: give shapely.get_coordinates of it")
    return rows_of(points)


def values_of(points: Any, kind: str, given: Any) -> Any:
    """Return weights or radii: values of the points, if a name is given."""
    if not isinstance(given, str):
        return given
    if _is_geometric(points):
        columns = [name for name in getattr(points, "columns", ()) if name != points.geometry.name]
        held = {name: np.asarray(points[name]) for name in columns}
        return named_values(Cloud(np.zeros((len(points), 3)), attributes=held), kind, given)
    cloud = as_cloud(points, flat=None) if is_table(points) else as_cloud(points)
    return named_values(cloud, kind, given)


def _is_geometric(points: Any) -> bool:
    """Whether this is a GeoSeries or a GeoDataFrame."""
    return hasattr(type(points), "geom_type") and hasattr(type(points), "union_all")


def _coordinates(points: Any) -> Any:
    shapes = points.geometry
    other = ~(shapes.geom_type == "Point").to_numpy()
    if other.any():
        row = int(other.argmax())
        kind = getattr(shapes.iloc[row], "geom_type", "nothing")
        raise InputError(f"row {row} is {kind}: give points, such as the centroids of polygons")
    return np.stack([shapes.x.to_numpy(), shapes.y.to_numpy()], axis=1)
