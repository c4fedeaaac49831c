"""trimesh: conversion from point clouds, meshes and scenes, and to meshes and point clouds.

trimesh merges vertices and drops rows unless given ``process=False``, keeps colours as 8-bit RGBA,
and invents a grey for objects without colours, so colours are read only if some are defined.
Vertex normals are read only if the mesh holds them; accessing them would compute them. Output is
copied: trimesh edits meshes in place and makes the arrays of normals it is given read-only.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh import arrays
from liftmesh._typing import Array, Floats, Rows
from liftmesh.cloud import Cloud, is_crs
from liftmesh.interruption import kept
from liftmesh.io.colors import as_uint8, with_alpha
from liftmesh.io.faces import checked_faces
from liftmesh.optional import load

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    import trimesh


# What trimesh notes of the file and of its own work, or older versions did.
_OWN = ("_ply_raw", "processed", "file_path", "file_name")


def to_cloud(source: Any) -> Cloud:
    """Convert a trimesh point cloud, mesh or scene to a cloud.

    Parameters
    ----------
    source : trimesh.PointCloud, trimesh.Trimesh or trimesh.Scene
        Vertices, with vertex colours, vertex normals, vertex attributes and metadata if any; the
        string ``metadata["crs"]`` is the coordinate system. For a scene see `from_scene`.

    Returns
    -------
    Cloud
        One row per vertex, in the order of ``source``; a mesh keeps its faces. Coordinates are
        shared with ``source``, not copied.

    Raises
    ------
    InputError
        Colours or an attribute do not have one row per vertex.
    FormatError
        A face of a scene refers to a vertex that does not exist.

    Examples
    --------
    >>> import trimesh
    >>> len(to_cloud(trimesh.PointCloud([[0, 0, 5], [1, 0, 6], [0, 1, 7]])))
    3
    """
    return from_scene(source, "the scene") if hasattr(source, "graph") else _geometry(source)


def from_scene(scene: trimesh.Scene, name: str) -> Cloud:
    """Combine all meshes and point clouds of a scene into one cloud.

    Parameters
    ----------
    scene : trimesh.Scene
        Geometries with their transformations.
    name : str
        Name of the scene for messages.

    Returns
    -------
    Cloud
        All vertices, transformed, and all faces, in the order of the scene. Colours, normals and
        named values are kept if every geometry has them, metadata if they are the same everywhere.
        Others are named, and lines counted, in ``metadata["skipped"]``.

    Raises
    ------
    FormatError
        A face refers to a vertex that does not exist.

    Examples
    --------
    >>> import trimesh
    >>> box = trimesh.creation.box()
    >>> len(from_scene(trimesh.Scene([box, box]), "boxes"))
    16
    """
    placed = [(scene.geometry[key], matrix) for matrix, key in _nodes(scene)]
    held = [(_geometry(each), matrix) for each, matrix in placed if _holds_points(each)]
    parts = [transformed(cloud, matrix) for cloud, matrix in held]
    described = _described(scene.metadata)
    common = _common(part.metadata for part in parts)
    cloud = Cloud(
        np.concatenate([part.points for part in parts]) if parts else np.zeros((0, 3)),
        colors=_joined([part.colors for part in parts]),
        normals=_joined([part.normals for part in parts]),
        attributes=_joined_attributes(parts),
        faces=_joined_faces(parts, name),
        metadata=common | described["metadata"],
        crs=described["crs"] or _common({"": part.crs} for part in parts).get(""),
    )
    lines = len(placed) - len(parts)
    skipped = (*([f"{lines} lines"] if lines else []), *_not_in(cloud, parts))
    return replace(cloud, metadata={**cloud.metadata, "skipped": skipped}) if skipped else cloud


def transformed(cloud: Cloud, matrix: Floats) -> Cloud:
    """Transform the points and normals of a cloud.

    Parameters
    ----------
    cloud : Cloud
        The cloud.
    matrix : (4, 4) ndarray of float64
        Affine transformation.

    Returns
    -------
    Cloud
        Faces are turned over if the matrix mirrors; normals are dropped if it is singular, or its
        inverse beyond double precision.

    Examples
    --------
    >>> transformed(Cloud(np.eye(3)), np.diag([2.0, 1.0, 1.0, 1.0])).points[0].tolist()
    [2.0, 0.0, 0.0]
    """
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
    """Convert a cloud with faces to a trimesh mesh.

    Parameters
    ----------
    cloud : Cloud
        Points and faces; colours become 8-bit RGBA, named values vertex attributes, the coordinate
        system ``metadata["crs"]``.

    Returns
    -------
    trimesh.Trimesh
        Every row as a vertex, in the same order, with its own copy of the coordinates.

    Raises
    ------
    InputError
        A colour is outside its range.
    MissingDependencyError
        trimesh is not installed.

    Examples
    --------
    >>> cloud = Cloud(np.eye(3), faces=np.array([[0, 1, 2]], dtype=np.int32))
    >>> to_mesh(cloud).vertices.shape
    (3, 3)
    """
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
    """Convert the rows of a cloud to a trimesh point cloud.

    Parameters
    ----------
    cloud : Cloud
        Points; colours become 8-bit RGBA. trimesh's point clouds do not hold normals and named
        values.

    Returns
    -------
    trimesh.PointCloud
        Every row, in the same order.

    Raises
    ------
    InputError
        A colour is outside its range.
    MissingDependencyError
        trimesh is not installed.

    Examples
    --------
    >>> to_points(Cloud(np.eye(3))).vertices.shape
    (3, 3)
    """
    colors = None if cloud.colors is None else with_alpha(as_uint8(cloud.colors))
    library = load("trimesh")
    with kept():
        points: trimesh.PointCloud = library.PointCloud(
            cloud.points.copy(), colors=colors, metadata=_metadata(cloud)
        )
    return points


def _copied(normals: Array | None) -> Array | None:
    """A copy of the normals; None if there are none, which trimesh cannot look at."""
    return None if normals is None or not len(normals) else np.array(normals)


def _geometry(source: Any) -> Cloud:
    """A mesh or a point cloud."""
    named: Mapping[str, Any] = getattr(source, "vertex_attributes", None) or {}
    return Cloud(
        points=arrays.as_rows3(np.asarray(source.vertices)),
        colors=_colors(source),
        normals=_normals(source),
        attributes={name: np.atleast_1d(values) for name, values in named.items()},
        faces=_faces(source),
        **_described(source.metadata),
    )


def _faces(source: Any) -> Array | None:
    """The faces as int32; as they are if one is beyond it, for whoever checks them."""
    faces = getattr(source, "faces", None)
    if faces is None:
        return None
    faces = np.asarray(faces)
    limits = np.iinfo(np.int32)
    fit = not faces.size or (faces.min() >= limits.min and faces.max() <= limits.max)
    return faces.astype(np.int32, copy=False) if fit else faces


def _common(parts: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """Return the entries that are the same in all mappings."""
    first, *others = [*parts] or [{}]
    return {
        key: value
        for key, value in first.items()
        if all(key in each and _is_same(each[key], value) for each in others)
    }


def _is_same(a: object, b: object) -> bool:
    """Whether two values are equal; those that cannot tell, such as arrays, are not."""
    if a is b:
        return True
    with suppress(Exception):  # of whatever class the values have
        return bool(type(a) is type(b) and a == b)
    return False


def _joined_attributes(parts: list[Cloud]) -> dict[str, Array]:
    """Join the named values that all parts have, with one type and width."""
    layouts = (
        {name: (each.dtype, each.shape[1:]) for name, each in part.attributes.items()}
        for part in parts
    )
    return {
        name: np.concatenate([part.attributes[name] for part in parts]) for name in _common(layouts)
    }


def _not_in(cloud: Cloud, parts: list[Cloud]) -> list[str]:
    """Name what some parts have, and the cloud made of them has not."""
    words = ("colors", "normals", "crs")
    lost = [
        word
        for word in words
        if getattr(cloud, word) is None and any(getattr(part, word) is not None for part in parts)
    ]
    named = {name: None for part in parts for name in part.attributes}
    lost += [f"attribute {name}" for name in named if name not in cloud.attributes]
    keys = {key: None for part in parts for key in part.metadata}
    return [*lost, *(f"metadata {key}" for key in keys if key not in cloud.metadata)]


def _metadata(cloud: Cloud) -> dict[str, Any]:
    crs = {} if cloud.crs is None else {"crs": cloud.crs}
    return {**cloud.metadata, **crs}


def _described(metadata: Mapping[str, Any]) -> dict[str, Any]:
    """Split metadata into a cloud's metadata and its coordinate system."""
    rest = {key: value for key, value in metadata.items() if key not in _OWN}
    crs = rest.get("crs")
    if not is_crs(crs):
        return {"metadata": rest, "crs": None}
    del rest["crs"]
    return {"metadata": rest, "crs": crs}


def _nodes(scene: trimesh.Scene) -> Iterator[tuple[Floats, Any]]:
    for node in scene.graph.nodes_geometry:
        yield scene.graph[node]


def _holds_points(geometry: Any) -> bool:
    """Whether a geometry is a mesh or a point cloud, not a path."""
    return hasattr(geometry, "vertices") and not hasattr(geometry, "entities")


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


def _joined(parts: list[Array | None]) -> Array | None:
    known = [each for each in parts if each is not None]
    return np.concatenate(known) if known and len(known) == len(parts) else None


def _joined_faces(parts: list[Cloud], name: str) -> Rows | None:
    found: list[Rows] = []
    start = 0
    for part in parts:
        if part.faces is not None and len(part.faces):
            found.append(checked_faces(part.faces, len(part), name) + np.int32(start))
        start += len(part)
    return np.concatenate(found) if found else None


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
