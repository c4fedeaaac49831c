"""What can be written: a Cloud, or any object with vertices and faces."""

from __future__ import annotations

from typing import Any

import numpy as np

from liftmesh._typing import Array
from liftmesh.arrays import as_rows3
from liftmesh.cloud import Cloud
from liftmesh.errors import UnsupportedTypeError
from liftmesh.io.faces import checked_faces


def as_mesh(mesh: object, name: str) -> Cloud:
    """Turn what a caller wants written into a checked Cloud.

    Accepted are a :class:`liftmesh.Cloud`, an (n, 2) or (n, 3) array, an object with
    ``to_cloud()``, and one with ``vertices`` and ``faces`` and, if it has them, ``colors``,
    ``normals`` and ``attributes``.

    Raises
    ------
    UnsupportedTypeError
        The object is none of these.
    InputError
        An array is no list of points.
    FormatError
        A face refers to a vertex that is not there.
    """
    cloud = _as_cloud(mesh)
    if cloud.faces is not None:
        checked_faces(cloud.faces, len(cloud), name)
    return cloud


def _as_cloud(mesh: Any) -> Cloud:
    if isinstance(mesh, Cloud):
        return mesh
    if isinstance(mesh, np.ndarray):
        return Cloud(as_rows3(mesh))
    if hasattr(mesh, "to_cloud"):
        cloud: Cloud = mesh.to_cloud()
        return cloud
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        return _from_parts(mesh)
    raise UnsupportedTypeError(
        f"an object of type {type(mesh).__name__} cannot be written: "
        "give a liftmesh.Cloud, an (n, 3) array, or an object with vertices and faces"
    )


def _from_parts(mesh: Any) -> Cloud:
    return Cloud(
        np.asarray(mesh.vertices, dtype=np.float64),
        colors=_optional(getattr(mesh, "colors", None)),
        normals=_optional(getattr(mesh, "normals", None)),
        attributes=dict(getattr(mesh, "attributes", None) or {}),
        faces=_optional(mesh.faces),
    )


def _optional(values: Any) -> Array | None:
    return None if values is None else np.asarray(values)
