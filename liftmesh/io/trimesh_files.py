"""Formats read and written through trimesh: GLB and glTF.

The origin of single precision (`io.origin`) stands in the ``extras`` of the scene.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import Any, BinaryIO

import numpy as np

from liftmesh._typing import Array
from liftmesh.cloud import Cloud
from liftmesh.errors import FormatError
from liftmesh.io.format import Format, Origin
from liftmesh.io.gltf_validation import checked_gltf
from liftmesh.io.objects.trimesh import from_scene, to_mesh, to_points
from liftmesh.io.origin import TOLERANCE, checked_origin, needed_origin, with_origin, without_origin
from liftmesh.optional import load


def read_glb(stream: BinaryIO, name: str) -> Cloud:
    """Read a GLB file: the triangles and points of all its meshes, transformed into the scene.

    Returns
    -------
    Cloud
        Vertices, with colours and normals if every mesh has them; several meshes are combined.

    Raises
    ------
    FormatError
        The file is invalid.
    """
    return _read_gltf(stream, name, "glb")


def read_gltf(stream: BinaryIO, name: str) -> Cloud:
    """Read a glTF file with buffers inside it or in the same folder; see :func:`read_glb`."""
    return _read_gltf(stream, name, "gltf")


def write_glb(stream: BinaryIO, cloud: Cloud) -> Origin | None:
    """Write a mesh, or points, as GLB with 8-bit colours.

    Parameters
    ----------
    cloud : Cloud
        The mesh or points; attributes are not written.

    Returns
    -------
    tuple of float, or None
        The origin that was subtracted, as recorded in the extras of the scene.

    Raises
    ------
    FormatError
        The coordinates do not fit single precision.
    """
    scene, origin = _scene(cloud, "glb")
    stream.write(scene.export(file_type="glb"))
    return origin


def write_gltf(stream: BinaryIO, cloud: Cloud) -> Origin | None:
    """Write a mesh, or points, as a glTF file that contains its buffers; see :func:`write_glb`."""
    scene, origin = _scene(cloud, "gltf")
    parts = scene.export(file_type="gltf", merge_buffers=True, embed_buffers=True)
    stream.write(parts["model.gltf"])
    return origin


def _read(stream: BinaryIO, name: str, kind: str) -> Cloud:
    """Read a file with trimesh; combine all geometries of the scene."""
    options: dict[str, Any] = {"file_type": kind, "process": False}
    # Without materials no image is opened, and vertex colours are kept unchanged.
    options |= {"resolver": checked_gltf(stream, name, kind), "skip_materials": True}
    trimesh = load("trimesh")
    try:
        with warnings.catch_warnings():
            # At text that is not a number NumPy only warns, and trimesh uses what came before.
            warnings.simplefilter("error", DeprecationWarning)
            scene = trimesh.load_scene(stream, **options)
        cloud = from_scene(scene, name)
    except (FormatError, MemoryError):
        raise
    except Exception as error:
        cause = f"{type(error).__name__}: {error}"
        raise FormatError(f"{name}: not a valid {kind} file: {cause[:300]}") from error
    if not len(cloud):
        raise FormatError(f"{name}: the file holds no vertices")
    return cloud


def _read_gltf(stream: BinaryIO, name: str, kind: str) -> Cloud:
    cloud = _read(stream, name, kind)
    stated = cloud.metadata.get("origin")
    return with_origin(cloud, None if stated is None else checked_origin(stated, name))


def _scene(cloud: Cloud, kind: str) -> tuple[Any, Origin | None]:
    origin = needed_origin(cloud.points, kind)
    shown = Cloud(
        without_origin(cloud.points, origin),
        colors=cloud.colors,
        normals=_squarable(cloud.normals),
        faces=cloud.faces,
    )
    geometry = to_mesh(shown) if _has_faces(cloud) else to_points(shown)
    metadata: dict[str, Any] = {} if origin is None else {"origin": list(origin)}
    if cloud.crs is not None:
        metadata["crs"] = cloud.crs
    return load("trimesh").Scene(geometry, metadata=metadata), origin


def _has_faces(cloud: Cloud) -> bool:
    return cloud.faces is not None and len(cloud.faces) > 0


def _lost_in_gltf(cloud: Cloud, _options: Mapping[str, Any]) -> tuple[str, ...]:
    """Points are written without normals, and normals of meshes with unit length."""
    kept = cloud.normals is None or (_has_faces(cloud) and _are_unit(cloud.normals))
    return () if kept else ("normals",)


def _squarable(normals: Array | None) -> Array | None:
    """Shorten or lengthen normals whose squares overflow or vanish; None if one is not finite."""
    if normals is None or not np.isfinite(normals).all():
        return None
    largest = np.abs(normals).max(axis=1, keepdims=True).astype(np.float64)
    is_extreme = (largest > 1e100) | ((largest > 0) & (largest < 1e-100))
    return normals / np.where(is_extreme, largest, 1.0) if is_extreme.any() else normals


def _are_unit(normals: Array) -> bool:
    with np.errstate(over="ignore", invalid="ignore"):
        lengths = np.sqrt((normals.astype(np.float64) ** 2).sum(axis=1))
    return bool((np.abs(lengths - 1.0) <= TOLERANCE).all())


_GLTF: dict[str, Any] = {
    "keeps": ("points", "faces", "colors", "alpha", "normals", "crs"),
    "needs": ("points", "finite"),
    "loses": _lost_in_gltf,
}

FORMATS = (
    Format(
        "glb", (".glb",), read_glb, write_glb, "binary glTF: single precision, colours", **_GLTF
    ),
    Format("gltf", (".gltf",), read_gltf, write_gltf, "glTF: single precision, colours", **_GLTF),
)
