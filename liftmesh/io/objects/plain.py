"""Objects of no particular library: arrays, and objects with attributes of common names."""

from __future__ import annotations

from typing import Any

import numpy as np

from liftmesh import arrays
from liftmesh._typing import Array
from liftmesh.cloud import Cloud
from liftmesh.errors import UnsupportedTypeError

_ARRAY_LIKE = ("__array__", "__array_interface__", "__dlpack__", "__buffer__", "__len__")


def is_array(source: object) -> bool:
    """Whether an object is an array or a list of rows.

    Parameters
    ----------
    source : object
        Any object.

    Returns
    -------
    bool
        True for NumPy arrays, lists and tuples.

    Examples
    --------
    >>> is_array([[0, 1, 2]])
    True
    """
    return isinstance(source, np.ndarray | list | tuple)


def is_array_like(source: object) -> bool:
    """Whether NumPy may be able to convert an object to an array.

    Parameters
    ----------
    source : object
        Any object.

    Returns
    -------
    bool
        True if it supports one of NumPy's protocols, or has a length.

    Examples
    --------
    >>> is_array_like(memoryview(b"")), is_array_like(1)
    (True, False)
    """
    return any(hasattr(source, name) for name in _ARRAY_LIKE)


def from_array(source: Any) -> Cloud:
    """Convert rows of coordinates to a cloud.

    Parameters
    ----------
    source : array_like of shape (n, 2) or (n, 3)
        Real numbers.

    Returns
    -------
    Cloud
        The rows; a missing z is 0.

    Raises
    ------
    InputError
        The shape or the type of the values is wrong.

    Examples
    --------
    >>> from_array([[1, 2]]).points
    array([[1., 2., 0.]])
    """
    return Cloud(arrays.as_rows3(source))


def has_to_cloud(source: object) -> bool:
    """Whether an object converts itself to a cloud.

    Parameters
    ----------
    source : object
        Any object.

    Returns
    -------
    bool
        True if it has a method ``to_cloud``.

    Examples
    --------
    >>> has_to_cloud(1)
    False
    """
    return hasattr(source, "to_cloud")


def converted(source: Any) -> Cloud:
    """Call an object's own ``to_cloud()``.

    Parameters
    ----------
    source : object
        For example a `Surface`, or an object of a package that supports liftmesh.

    Returns
    -------
    Cloud
        The result.

    Raises
    ------
    UnsupportedTypeError
        The result is not a `Cloud`.

    Examples
    --------
    >>> import liftmesh
    >>> len(converted(liftmesh.triangulate([[0, 0], [1, 0], [0, 1]])))
    3
    """
    cloud = source.to_cloud()
    if isinstance(cloud, Cloud):
        return cloud
    raise UnsupportedTypeError(
        f"to_cloud() of a {qualified_name(source)} returns a {qualified_name(cloud)}: "
        "it must return a liftmesh.Cloud"
    )


def has_parts(source: object) -> bool:
    """Whether an object has the attributes of a mesh.

    Parameters
    ----------
    source : object
        Any object.

    Returns
    -------
    bool
        True if it has ``vertices`` and ``faces``.

    Examples
    --------
    >>> import trimesh
    >>> has_parts(trimesh.creation.box())
    True
    """
    return hasattr(source, "vertices") and hasattr(source, "faces")


def from_parts(source: Any) -> Cloud:
    """Convert an object with the attributes of a mesh to a cloud.

    Parameters
    ----------
    source : object
        Has ``vertices``, ``faces`` and optionally ``colors``, ``normals`` and ``attributes``.

    Returns
    -------
    Cloud
        The points with their values and faces.

    Raises
    ------
    InputError
        The lengths of the arrays differ.

    Examples
    --------
    >>> from types import SimpleNamespace
    >>> len(from_parts(SimpleNamespace(vertices=[[0, 0, 5]], faces=None)))
    1
    """
    return Cloud(
        arrays.as_rows3(source.vertices),
        colors=_optional(source, "colors"),
        normals=_optional(source, "normals"),
        attributes=dict(getattr(source, "attributes", None) or {}),
        faces=_optional(source, "faces"),
    )


def qualified_name(source: object) -> str:
    """Return the full name of an object's type.

    Parameters
    ----------
    source : object
        Any object.

    Returns
    -------
    str
        Module and name, for messages.

    Examples
    --------
    >>> from fractions import Fraction
    >>> qualified_name(Fraction(1, 2))
    'fractions.Fraction'
    """
    kind = type(source)
    return f"{kind.__module__}.{kind.__qualname__}"


def _optional(source: Any, name: str) -> Array | None:
    values = getattr(source, name, None)
    return None if values is None else np.asarray(values)
