"""Objects of no particular library: arrays, and what offers points under the usual names."""

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
        Anything.

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
    """Whether NumPy may make an array of an object.

    Parameters
    ----------
    source : object
        Anything.

    Returns
    -------
    bool
        True where it offers one of NumPy's protocols, or a length.

    Examples
    --------
    >>> is_array_like(memoryview(b"")), is_array_like(1)
    (True, False)
    """
    return any(hasattr(source, name) for name in _ARRAY_LIKE)


def from_array(source: Any) -> Cloud:
    """Make a cloud of rows of coordinates.

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
        Another shape, or other values.

    Examples
    --------
    >>> from_array([[1, 2]]).points
    array([[1., 2., 0.]])
    """
    return Cloud(arrays.as_rows3(source))


def has_to_cloud(source: object) -> bool:
    """Whether an object makes its cloud itself.

    Parameters
    ----------
    source : object
        Anything.

    Returns
    -------
    bool
        True where it has a method ``to_cloud``.

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
        Such as a `Surface`, or an object of a package that knows liftmesh.

    Returns
    -------
    Cloud
        What it gives.

    Raises
    ------
    UnsupportedTypeError
        It gives no `Cloud`.

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
        f"to_cloud() of a {qualified_name(source)} gives a {qualified_name(cloud)}: "
        "it must give a liftmesh.Cloud"
    )


def has_parts(source: object) -> bool:
    """Whether an object looks like a mesh.

    Parameters
    ----------
    source : object
        Anything.

    Returns
    -------
    bool
        True where it has ``vertices`` and ``faces``.

    Examples
    --------
    >>> import trimesh
    >>> has_parts(trimesh.creation.box())
    True
    """
    return hasattr(source, "vertices") and hasattr(source, "faces")


def from_parts(source: Any) -> Cloud:
    """Make a cloud of an object that looks like a mesh.

    Parameters
    ----------
    source : object
        With ``vertices`` and ``faces`` and, if it has them, ``colors``, ``normals`` and
        ``attributes``.

    Returns
    -------
    Cloud
        Its arrays.

    Raises
    ------
    InputError
        They do not fit together.

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
    """Name the type of an object in full.

    Parameters
    ----------
    source : object
        Anything.

    Returns
    -------
    str
        Module and name, as a message shows it.

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
