"""as_cloud(): anything that holds points becomes the `Cloud` that liftmesh works on."""

from __future__ import annotations

from typing import Any

import numpy as np

from liftmesh import arrays
from liftmesh.cloud import Cloud
from liftmesh.io.objects.registry import find_adapter, unsupported

_ARRAY_LIKE = ("__array__", "__array_interface__", "__dlpack__", "__buffer__", "__len__")


def as_cloud(source: Any) -> Cloud:
    """Make a cloud of anything that holds points.

    Parameters
    ----------
    source : object
        A `Cloud`; an array-like of shape (n, 2) or (n, 3); a ``trimesh.PointCloud`` or
        ``trimesh.Trimesh``; an Open3D point cloud, mesh or tensor, legacy or tensor based; or what
        an installed adapter accepts.

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
        No adapter accepts the object.

    Examples
    --------
    >>> as_cloud([[0.0, 0.0, 5.0], [1.0, 0.0, 6.0], [0.0, 1.0, 7.0]]).points.shape
    (3, 3)
    """
    if isinstance(source, Cloud):
        return source
    if isinstance(source, np.ndarray | list | tuple):
        return Cloud(arrays.as_rows3(source))
    adapter = find_adapter(source)
    if adapter is not None:
        return adapter.to_cloud(source)
    if any(hasattr(source, name) for name in _ARRAY_LIKE):
        return Cloud(arrays.as_rows3(source))
    raise unsupported(source)
