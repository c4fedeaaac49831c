"""as_cloud(): anything that holds points becomes the `Cloud` that liftmesh works on."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from liftmesh import arrays
from liftmesh._typing import Array
from liftmesh.cloud import Cloud
from liftmesh.errors import UnsupportedTypeError
from liftmesh.io.registry import broken_adapters, find_adapter, qualified_name

_ARRAY_LIKE = ("__array__", "__array_interface__", "__dlpack__", "__buffer__", "__len__")


def as_cloud(source: Any) -> Cloud:
    """Make a cloud of anything that holds points.

    Parameters
    ----------
    source : object
        A `Cloud`; an array-like of shape (n, 2) or (n, 3); a ``trimesh.PointCloud`` or
        ``trimesh.Trimesh``; an Open3D point cloud, mesh or tensor, legacy or tensor based; what an
        installed adapter accepts; an object with a method ``to_cloud()``, such as a `Surface`; or
        one with ``vertices`` and ``faces`` and, if it has them, ``colors``, ``normals`` and
        ``attributes``.

    Returns
    -------
    Cloud
        One row a point, in the order of ``source``; rows of two coordinates get z = 0. Float64
        coordinates are shared with ``source`` where that is safe.

    Raises
    ------
    InputError
        An array has the wrong shape or type, or colours or attributes do not fit the points.
    UnsupportedTypeError
        Nothing turns the object into a cloud, or it is a path.

    Examples
    --------
    >>> as_cloud([[0.0, 0.0, 5.0], [1.0, 0.0, 6.0], [0.0, 1.0, 7.0]]).points.shape
    (3, 3)
    """
    if isinstance(source, Cloud):
        return source
    if isinstance(source, np.ndarray | list | tuple):
        return Cloud(arrays.as_rows3(source))
    if isinstance(source, str | os.PathLike):
        raise UnsupportedTypeError(f"{source!r} is a path, not a cloud: liftmesh.read it first")
    adapter = find_adapter(source)
    if adapter is not None:
        return adapter.to_cloud(source)
    if hasattr(source, "to_cloud"):
        return _converted(source)
    if hasattr(source, "vertices") and hasattr(source, "faces"):
        return _from_parts(source)
    if any(hasattr(source, name) for name in _ARRAY_LIKE):
        return Cloud(arrays.as_rows3(source))
    raise _unsupported(source)


def _converted(source: Any) -> Cloud:
    cloud = source.to_cloud()
    if isinstance(cloud, Cloud):
        return cloud
    raise UnsupportedTypeError(
        f"to_cloud() of a {qualified_name(source)} gives a {qualified_name(cloud)}: "
        "it must give a liftmesh.Cloud"
    )


def _from_parts(source: Any) -> Cloud:
    return Cloud(
        arrays.as_rows3(source.vertices),
        colors=_optional(source, "colors"),
        normals=_optional(source, "normals"),
        attributes=dict(getattr(source, "attributes", None) or {}),
        faces=_optional(source, "faces"),
    )


def _optional(source: Any, name: str) -> Array | None:
    values = getattr(source, name, None)
    return None if values is None else np.asarray(values)


def _unsupported(source: object) -> UnsupportedTypeError:
    message = (
        f"a {qualified_name(source)} is no point cloud: give an array of shape (n, 2) or (n, 3), "
        "a trimesh or Open3D point cloud or mesh, or an object with vertices and faces"
    )
    broken = broken_adapters()
    if broken:
        message += f"; adapters that cannot be loaded: {'; '.join(broken)}"
    return UnsupportedTypeError(message)
