"""Sites in whatever holds points: arrays, clouds, tables without heights, GeoPandas."""

from __future__ import annotations

from typing import Any

import numpy as np

from liftmesh.cloud import Cloud
from liftmesh.errors import InputError
from liftmesh.io.objects.kinds import is_table
from liftmesh.io.registry import as_cloud
from liftmesh.planar.meshes import rows_of
from liftmesh.planar.weights import named_values
from liftmesh.same_crs import common_system, system_of


def sites_of(points: Any, domain: Any = None) -> Any:
    """Return the points of anything, for arrays to be made of.

    Parameters
    ----------
    points : object
        As for `voronoi`.
    domain : object
        The domain, whose coordinate system must be that of the points if both have one.

    Returns
    -------
    array_like
        Rows of two or three columns.

    Raises
    ------
    InputError
        A geometry is no point, the columns of a table cannot be told, or the coordinate systems
        differ.

    Examples
    --------
    >>> sites_of([[0, 1]])
    [[0, 1]]
    """
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
    """Return weights or radii: values of the points, if a name is given.

    Parameters
    ----------
    points : object
        As for `power_diagram`.
    kind : {"weights", "radii"}
        What the values are.
    given : array_like or str
        The values, or their name.

    Returns
    -------
    array_like
        The values.

    Raises
    ------
    InputError
        There are none of that name.

    Examples
    --------
    >>> values_of([[0, 1]], "weights", [3])
    [3]
    """
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
