"""Formats read and written through trimesh: GLB and glTF.

The origin of single precision (`io.origin`) is the translation of the node, so that every viewer
shows the mesh in its place, and stands in the ``extras`` of the scene as well, where it is exact
whatever happens to the nodes.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from liftmesh._typing import Array
from liftmesh.base.cloud import Cloud
from liftmesh.base.colors import kept_depth
from liftmesh.io.formats.gltf.file import File
from liftmesh.io.formats.gltf.names import lost_values, names_note, value_columns, value_keys
from liftmesh.io.metadata import NOTE, as_extras, storable
from liftmesh.io.objects.trimesh import to_mesh, to_points
from liftmesh.io.origin import TOLERANCE, needed_origin, without_origin
from liftmesh.optional import load

if TYPE_CHECKING:
    from liftmesh.io.format import Origin


def write_glb(stream: BinaryIO, cloud: Cloud) -> Origin | None:
    """Write a mesh, or points, as GLB with 8-bit colours."""
    file, origin = _file(cloud, "glb")
    stream.write(file.glb())
    return origin


def write_gltf(stream: BinaryIO, cloud: Cloud) -> Origin | None:
    """Write a mesh, or points, as a glTF file that contains its buffers; see :func:`write_glb`."""
    file, origin = _file(cloud, "gltf")
    stream.write(file.gltf())
    return origin


def _file(cloud: Cloud, kind: str) -> tuple[File, Origin | None]:
    origin = needed_origin(cloud.points, kind)
    shown = Cloud(
        without_origin(cloud.points, origin),
        colors=cloud.colors,
        color_depth=kept_depth(cloud.colors),
        normals=_squarable(cloud.normals),
        faces=cloud.faces,
    )
    geometry = to_mesh(shown) if _has_faces(cloud) else to_points(shown)
    file = File.of(load("trimesh").Scene(geometry).export(file_type="glb"))
    if origin is not None:
        file.place(origin)
    values = value_columns(cloud.attributes)
    names = value_keys(values)
    for name, key in names.items():
        file.add(key, values[name])
    if extras := _extras(cloud, origin, names_note(values, names)):
        file.tree["scenes"][0]["extras"] = extras
    return file, origin


def _extras(cloud: Cloud, origin: Origin | None, names: dict[str, list[str]]) -> dict[str, Any]:
    """What the scene says of itself: metadata, crs, and liftmesh's own note."""
    note = {"origin": None if origin is None else list(origin), "attributes": names}
    own = {key: value for key, value in note.items() if value}
    crs = {} if cloud.crs is None else {"crs": cloud.crs}
    return as_extras(storable(cloud.metadata)) | crs | ({NOTE: own} if own else {})


def renamed(cloud: Cloud) -> dict[str, str]:
    """The attributes whose names are not just written with an underscore and in capitals."""
    names = value_keys(value_columns(cloud.attributes))
    return {name: key for name, key in names.items() if key != f"_{name.upper()}"}


def _has_faces(cloud: Cloud) -> bool:
    return cloud.faces is not None and len(cloud.faces) > 0


def lost(cloud: Cloud, _options: Mapping[str, Any]) -> tuple[str, ...]:
    """Points are written without normals; those of meshes get the length 1, but for zeros."""
    names = lost_values(cloud.attributes)
    if cloud.normals is None:
        return tuple(names)
    if not _has_faces(cloud) or not _are_unit(cloud.normals):
        return (*names, "normals")
    return (*names, *lost_values({"normals": cloud.normals}))


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
    return bool(((np.abs(lengths - 1.0) <= TOLERANCE) | (normals == 0).all(axis=1)).all())


def check(cloud: Cloud) -> None:
    """Raise for coordinates that single precision cannot hold, and for names that are one."""
    needed_origin(cloud.points, "glTF")
    value_columns(cloud.attributes)
