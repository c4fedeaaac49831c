"""Open3D: conversion from legacy and tensor clouds and meshes, and to both types of mesh.

The legacy classes hold float64 coordinates and colours from 0 to 1 in C++ vectors that are moved
when they are reassigned, and accept only writable arrays: everything is copied both ways. The
tensor classes hold any named array of one row per point: positions become Float64 (Open3D's own
conversion would make them Float32), unless Float32 is asked for, as ``RaycastingScene`` needs, and
indices Int64. A flat attribute of n values gets the shape
{n, 1}, which Open3D's writers require. Integer colours become Float32 from 0 to 1, because tensor
meshes otherwise turn into legacy ones with colours up to 255.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Array, Floats
from liftmesh.base import arrays
from liftmesh.base.cloud import Cloud
from liftmesh.base.colors import as_float, is_opaque
from liftmesh.base.options import refused
from liftmesh.errors import FormatError, InputError
from liftmesh.io.columns import faces_of, narrowed
from liftmesh.io.format import Origin, needed_origin
from liftmesh.io.metadata import Unread, noted
from liftmesh.optional import load

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    import open3d as o3d


# What only legacy objects have and clouds do not hold. Normals of triangles follow from these.
_REST = {
    "covariances": "covariances",
    "triangle_uvs": "texture coordinates",
    "triangle_material_ids": "materials of triangles",
    "textures": "textures",
}
_OF_TRIANGLES = ("indices", "normals")


def to_cloud(source: Any) -> Cloud:
    """Convert an Open3D point cloud, mesh or tensor of rows to a cloud."""
    if type(source).__name__ == "Tensor":
        return Cloud(arrays.as_rows3(_numpy(source)))
    if hasattr(source, "vertex"):
        return _from_tensors(source.vertex, source.triangle)
    if hasattr(source, "point"):
        return _from_tensors(source.point, {})
    return _from_legacy(source)


def to_legacy(cloud: Cloud) -> o3d.geometry.TriangleMesh:
    """Convert a cloud with faces to a legacy Open3D mesh.

    Parameters
    ----------
    cloud : Cloud
        Points with faces, as `Surface.to_cloud` makes them.

    Returns
    -------
    open3d.geometry.TriangleMesh
        Every vertex in its place, with RGB colours from 0 to 1 and normals. Legacy meshes have
        no named values: `to_tensor` keeps them.

    Raises
    ------
    InputError
        A colour is outside its range.
    MissingDependencyError
        Open3D, or a system library it needs, is not installed.

    See Also
    --------
    Surface.to_open3d_t : A tensor mesh, which keeps named values.

    Examples
    --------
    >>> import liftmesh
    >>> liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]]).to_open3d()
    TriangleMesh with 3 points and 1 triangles.
    """
    library = load("open3d", extra="open3d")
    vectors = library.utility.Vector3dVector
    indices = library.utility.Vector3iVector(_writable(faces_of(cloud), np.int32))
    mesh: o3d.geometry.TriangleMesh = library.geometry.TriangleMesh(
        vectors(_writable(cloud.points, np.float64)), indices
    )
    if cloud.colors is not None:
        mesh.vertex_colors = vectors(_writable(as_float(cloud.colors)[:, :3], np.float64))
    if cloud.normals is not None:
        mesh.vertex_normals = vectors(_writable(cloud.normals, np.float64))
    return mesh


def to_tensor(
    cloud: Cloud, dtype: object = "float64", origin: ArrayLike | None = None
) -> o3d.t.geometry.TriangleMesh:
    """Convert a cloud with faces to a tensor Open3D mesh.

    Parameters
    ----------
    cloud : Cloud
        Points with faces, as `Surface.to_cloud` makes them.
    dtype : {"float64", "float32"}, or a type of NumPy or Open3D
        Of positions and normals. ``RaycastingScene`` needs Float32.
    origin : (3,) array_like, optional
        Subtracted from the positions before they are rounded; add it to what Open3D returns.

    Returns
    -------
    open3d.t.geometry.TriangleMesh
        Every vertex in its place, indices Int64, with RGB colours from 0 to 1, normals and
        named values as vertex attributes.

    Raises
    ------
    InputError
        A colour is outside its range, an attribute has a type that tensors do not support, or
        Float32 would move a vertex by more than a millionth of the cloud's size: the message
        gives the origin to subtract.
    MissingDependencyError
        Open3D, or a system library it needs, is not installed.

    See Also
    --------
    Surface.to_open3d : A legacy mesh.

    Examples
    --------
    >>> import liftmesh
    >>> mesh = liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]]).to_open3d_t()
    >>> mesh.triangle["indices"].shape
    SizeVector[1, 3]
    """
    precision = _precision(dtype)
    cloud = replace(cloud, points=_positions(cloud, precision, origin))
    library = load("open3d", extra="open3d")
    mesh: o3d.t.geometry.TriangleMesh = library.t.geometry.TriangleMesh()
    for name, values in {**_named_columns(cloud, precision), **_tensor_colors(cloud)}.items():
        mesh.vertex[name] = library.core.Tensor(values)
    mesh.triangle["indices"] = library.core.Tensor(faces_of(cloud).astype(np.int64))
    return mesh


def _from_legacy(source: Any) -> Cloud:
    if hasattr(source, "vertices"):
        faces = np.array(source.triangles, dtype=np.int32).reshape(-1, 3)
        names = ("vertices", "vertex_colors", "vertex_normals")
    else:
        faces, names = None, ("points", "colors", "normals")
    points, colors, normals = (np.array(getattr(source, name)) for name in names)
    return Cloud(
        points=arrays.as_rows3(points),
        colors=colors if len(colors) else None,
        normals=normals if len(normals) else None,
        faces=faces,
        metadata=_unread(what for name, what in _REST.items() if len(getattr(source, name, ()))),
    )


def _from_tensors(rows: Mapping[str, Any], triangles: Mapping[str, Any]) -> Cloud:
    named = {name: _numpy(tensor) for name, tensor in rows.items()}
    return Cloud(
        points=arrays.as_rows3(named.pop("positions", np.zeros((0, 3)))),
        colors=_tensor_shades(named),
        normals=named.pop("normals", None),
        attributes={name: _flat(values) for name, values in named.items()},
        faces=narrowed(_numpy(triangles["indices"])) if "indices" in triangles else None,
        metadata=_unread(
            f"{name} of triangles" for name, _ in triangles.items() if name not in _OF_TRIANGLES
        ),
    )


def _unread(names: Iterable[str]) -> dict[str, Any]:
    """The metadata that name what a cloud does not hold."""
    return noted({}, not_read=Unread(names))


def _tensor_shades(named: dict[str, Array]) -> Array | None:
    """Remove and return the colours, with the alpha that `to_tensor` keeps beside them."""
    colors, alpha = named.pop("colors", None), named.get("alpha")
    if colors is None or alpha is None or alpha.shape != (len(colors), 1):
        return colors
    if alpha.dtype != colors.dtype or colors.shape[1:] != (3,) or not _are_shares(alpha):
        return colors
    return np.concatenate([colors, named.pop("alpha")], axis=1)


def _are_shares(values: Array) -> bool:
    return values.dtype.kind == "f" and bool(((values >= 0) & (values <= 1)).all())


def _numpy(tensor: Any) -> Array:
    values: Array = tensor.cpu().numpy()
    return values


def _flat(values: Array) -> Array:
    """Flatten an attribute with a single channel."""
    return values[:, 0] if values.ndim == 2 and values.shape[1] == 1 else values


def _writable(values: Array, dtype: type) -> Array:
    """Make values contiguous and writable, as Open3D's vectors require."""
    return np.require(values, dtype=dtype, requirements=["C", "W"])


def _precision(dtype: object) -> np.dtype[Any]:
    """The floating-point type of positions, given by its name, NumPy's or Open3D's."""
    name = str(dtype).lower() if type(dtype).__name__ in {"str", "Dtype"} else dtype
    with suppress(TypeError, ValueError):
        precision: np.dtype[Any] = np.dtype(name)  # type: ignore[call-overload]
        if precision in (np.float32, np.float64):
            return precision
    raise refused("dtype", dtype, "give 'float32' or 'float64'")


def _positions(cloud: Cloud, precision: np.dtype[Any], origin: ArrayLike | None) -> Floats:
    """Subtract an origin; raise if single precision is too coarse for what is left."""
    points = cloud.points if origin is None else cloud.points - _origin(origin)
    if precision == np.float32 and _needed(points) is not None:
        needed = _needed(cloud.points) or _needed(points)
        raise InputError(
            f"Float32 is too coarse for these coordinates: give origin={needed}, which is "
            "subtracted, or dtype='float64'"
        )
    return points


def _needed(points: Floats) -> Origin | None:
    finite = points[np.isfinite(points).all(axis=1)]
    try:
        return needed_origin(finite, "Float32")
    except FormatError as error:
        raise InputError(
            "Float32 is too coarse for these coordinates, whatever their origin: "
            "give dtype='float64'"
        ) from error


def _origin(origin: ArrayLike) -> Floats:
    with suppress(TypeError, ValueError, OverflowError):
        values = arrays.as_reals(origin)
        if values.shape == (3,) and np.isfinite(values).all():
            return values
    raise refused("origin", origin, "give three finite numbers x, y, z")


def _named_columns(cloud: Cloud, precision: np.dtype[Any]) -> dict[str, Array]:
    taken = {"positions", "normals", "colors", "alpha"} & cloud.attributes.keys()
    if taken:
        raise InputError(
            f"an attribute is named {min(taken)!r}, which is reserved in Open3D meshes: rename it"
        )
    for name in cloud.attributes:
        if name.encode(errors="replace") != name.encode(errors="surrogatepass"):
            raise InputError(f"an attribute is named {name!r}, half a character: rename it")
    named = {name: _column(name, values) for name, values in cloud.attributes.items()}
    with np.errstate(under="ignore"):
        named["positions"] = cloud.points.astype(precision, copy=False)
        if cloud.normals is not None:
            narrow = precision == np.float32
            normals = cloud.normals.astype(precision) if narrow else cloud.normals
            named["normals"] = _column("normals", normals)
    return named


def _tensor_colors(cloud: Cloud) -> dict[str, Array]:
    """RGB as floats, and alpha unless it is opaque everywhere."""
    if cloud.colors is None:
        return {}
    single = cloud.colors.dtype.kind in "ui" or cloud.colors.dtype == np.float32
    colors = as_float(cloud.colors).astype(np.float32 if single else np.float64)
    if is_opaque(colors):
        return {"colors": colors[:, :3]}
    return {"colors": colors[:, :3], "alpha": colors[:, 3:]}


def _column(name: str, values: Array) -> Array:
    """Convert an attribute to a type and shape that tensors support, without loss."""
    if values.dtype.kind not in "biuf" or values.dtype.itemsize > 8:
        raise InputError(
            f"attribute {name!r} has the type {values.dtype}, which Open3D tensors do not support: "
            "convert it to integers or floats of at most 64 bits"
        )
    dtype = np.dtype(np.float32) if values.dtype == np.float16 else values.dtype
    native = np.require(values, dtype.newbyteorder("="), "A")  # fields of records are not aligned
    return native[:, None] if native.ndim == 1 else native
