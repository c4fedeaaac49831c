"""trimesh: conversion from point clouds and meshes, and to them.

trimesh merges vertices and drops rows unless given ``process=False``, keeps colours as 8-bit RGBA,
and invents a grey for objects without colours, so colours are read only if some are defined.
Vertex normals are read only if the mesh holds them; accessing them would compute them. Output is
copied: trimesh edits meshes in place and makes the arrays of normals it is given read-only.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base import arrays
from liftmesh.base.cloud import Cloud, is_crs
from liftmesh.base.colors import as_uint8, with_alpha
from liftmesh.base.interruption import kept
from liftmesh.io.faces import narrowed
from liftmesh.io.metadata import NOTE, Unread, user_entries
from liftmesh.optional import load

if TYPE_CHECKING:
    from collections.abc import Mapping

    import trimesh


# What trimesh notes of the file and of its own work, or older versions did; and our note in glTF.
_OWN = ("_ply_raw", "processed", "file_path", "file_name", "from_gltf_primitive", NOTE)

_VISUALS = {"face": ("colors of faces",), "texture": ("texture",)}


def to_cloud(source: Any) -> Cloud:
    """Convert a trimesh point cloud or mesh to a cloud."""
    named: Mapping[str, Any] = getattr(source, "vertex_attributes", None) or {}
    described = of_metadata(source.metadata)
    if unread := _unread(source):
        own = ("metadata skipped",) if "skipped" in user_entries(described["metadata"]) else ()
        described["metadata"]["skipped"] = Unread((*unread, *own))
    return Cloud(
        points=arrays.as_rows3(np.asarray(source.vertices)),
        colors=_colors(source),
        normals=_normals(source),
        attributes={
            name: np.atleast_1d(values) for name, values in {**named, **_weights(source)}.items()
        },
        faces=_faces(source),
        **described,
    )


def transformed(cloud: Cloud, matrix: Floats) -> Cloud:
    """Transform the points and normals of a cloud."""
    if np.array_equal(matrix, np.eye(4)):
        return cloud
    linear = matrix[:3, :3]
    if np.array_equal(linear, np.eye(3)):  # without arithmetic that would round, or touch normals
        with np.errstate(over="ignore"):
            return replace(cloud, points=cloud.points + matrix[:3, 3])
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # infinities are results
        points = cloud.points @ linear.T + matrix[:3, 3]
        size = np.abs(linear).max()
        scaled = linear / size if np.isfinite(size) and size > 0 else np.zeros((3, 3))
        determinant = np.linalg.det(scaled)
        normals = None if cloud.normals is None else _rotated(cloud.normals, scaled, determinant)
    faces = cloud.faces
    if faces is not None and determinant < 0:
        faces = faces[:, ::-1]  # a mirrored mesh keeps its outside
    return replace(cloud, points=points, normals=normals, faces=faces)


def to_mesh(cloud: Cloud) -> trimesh.Trimesh:
    """Convert a cloud with faces to a trimesh mesh."""
    colors = None if cloud.colors is None else with_alpha(as_uint8(cloud.colors))
    library = load("trimesh")
    with kept():
        mesh: trimesh.Trimesh = library.Trimesh(
            vertices=cloud.points.copy(),
            faces=np.zeros((0, 3), dtype=np.int64) if cloud.faces is None else cloud.faces,
            vertex_colors=colors,
            vertex_normals=_copied(cloud.normals),
            vertex_attributes={name: values.copy() for name, values in cloud.attributes.items()},
            metadata=_metadata(cloud),
            process=False,
        )
    return mesh


def to_points(cloud: Cloud) -> trimesh.PointCloud:
    """Convert the rows of a cloud to a trimesh point cloud."""
    colors = None if cloud.colors is None else with_alpha(as_uint8(cloud.colors))
    library = load("trimesh")
    with kept():
        points: trimesh.PointCloud = library.PointCloud(
            cloud.points.copy(), colors=colors, metadata=_metadata(cloud)
        )
    return points


def of_metadata(metadata: Mapping[str, Any]) -> dict[str, Any]:
    """Split the metadata of an object into a cloud's metadata and its coordinate system."""
    rest = {key: value for key, value in metadata.items() if not _is_own(key, value)}
    crs = rest.get("crs")
    if not is_crs(crs):
        return {"metadata": rest, "crs": None}
    del rest["crs"]
    return {"metadata": rest, "crs": crs}


def _is_own(key: str, value: object) -> bool:
    """Whether trimesh has noted an entry, or we in glTF; of "processed" it says yes or no."""
    return key in _OWN and (key != "processed" or isinstance(value, bool))


def _unread(source: Any) -> tuple[str, ...]:
    """Name what a mesh has and a cloud does not hold."""
    visual = _VISUALS.get(str(getattr(source.visual, "kind", None)), ())
    named = getattr(source, "face_attributes", None) or {}
    return (*visual, *(f"values {name} of faces" for name in named))


def _weights(source: Any) -> dict[str, Array]:
    """The weights of a point cloud, if it holds any; accessing them would make ones."""
    held = getattr(source, "_data", {}).get("weights")
    return {} if held is None else {"weights": np.asarray(held)}


def _faces(source: Any) -> Array | None:
    faces = getattr(source, "faces", None)
    return None if faces is None else narrowed(np.asarray(faces))


def _metadata(cloud: Cloud) -> dict[str, Any]:
    crs = {} if cloud.crs is None else {"crs": cloud.crs}
    return {**cloud.metadata, **crs}


def _copied(normals: Array | None) -> Array | None:
    """A copy of the normals; None if there are none, which trimesh cannot look at."""
    return None if normals is None or not len(normals) else np.array(normals)


def _rotated(normals: Array, matrix: Floats, determinant: float) -> Array | None:
    if determinant == 0:
        return None
    inverse = np.linalg.inv(matrix)
    if not np.isfinite(inverse).all():
        return None
    # A power of two, so that no square overflows and no bit changes.
    inverse = np.ldexp(inverse, -np.frexp(np.abs(inverse).max())[1])
    rotated: Floats = normals @ inverse
    lengths = np.sqrt((rotated * rotated).sum(axis=1, keepdims=True))
    np.divide(rotated, lengths, out=rotated, where=lengths > 0)
    return rotated


def _colors(source: Any) -> Array | None:
    """Read the vertex colours if the object defines any."""
    if getattr(source.visual, "kind", None) != "vertex":
        return None
    colors = source.visual.vertex_colors
    return None if colors is None or len(colors) == 0 else np.asarray(colors)


def _normals(source: Any) -> Array | None:
    """Read the vertex normals if the mesh holds them, by the test of trimesh's own exporters."""
    held = "vertex_normals" in getattr(source, "_cache", ())
    return np.asarray(source.vertex_normals) if held else None
