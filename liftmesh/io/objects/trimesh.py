"""trimesh: conversion from point clouds, meshes and scenes, and to the first two.

trimesh merges vertices and drops rows unless given ``process=False``, keeps colours as 8-bit RGBA,
and invents a grey for objects without colours, so colours are read only if some are defined.
Vertex normals are read only if the mesh holds them; accessing them would compute them. Output is
copied: trimesh edits meshes in place and makes the arrays of normals it is given read-only.

All meshes and point clouds of a scene are put in their places, and joined in one cloud, which has
one set of values for all rows. So what some geometries have and others have not, or have in another
form, is not kept, but named.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Floats, Rows
from liftmesh.base import arrays
from liftmesh.base.cloud import Cloud, is_crs
from liftmesh.base.colors import as_uint8, with_alpha
from liftmesh.base.interruption import preserve_signals
from liftmesh.io.columns import checked_faces, faces_of, narrowed
from liftmesh.io.metadata import NOTE, Provenance, Unread, user_entries
from liftmesh.optional import load

if TYPE_CHECKING:
    import trimesh


# What trimesh notes of the file and of its own work, or older versions did; and our note in glTF.
_OWN = ("_ply_raw", "processed", "file_path", "file_name", "from_gltf_primitive", NOTE)

_VISUALS = {"face": ("colors of faces",), "texture": ("texture",)}

_NAME = "the scene"  # in messages


def to_cloud(source: Any) -> Cloud:
    """Convert a trimesh point cloud or mesh to a cloud."""
    named: Mapping[str, Any] = getattr(source, "vertex_attributes", None) or {}
    described = of_metadata(source.metadata)
    if unread := _unread(source):
        own = ("metadata not_read",) if "not_read" in user_entries(described["metadata"]) else ()
        described["metadata"]["not_read"] = Unread((*unread, *own))
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


def scene_to_cloud(scene: trimesh.Scene) -> Cloud:
    """Combine all meshes and point clouds of a scene into one cloud."""
    placed = [(scene.geometry[key], matrix) for matrix, key in _nodes(scene)]
    held = [(each, matrix) for each, matrix in placed if _holds_points(each)]
    parts = [transformed(to_cloud(each), matrix) for each, matrix in held]
    named = _joined_values([part.attributes for part in parts])
    colors, normals = ([getattr(part, key) for part in parts] for key in ("colors", "normals"))
    described = of_metadata(scene.metadata)
    stated = {part.crs for part in parts}
    if described["crs"] is None and len(stated) == 1:
        described["crs"] = stated.pop()
    common = _common([user_entries(part.metadata) for part in parts])
    described["metadata"] = {**common, **described["metadata"]}
    lines = len(placed) - len(parts)
    skipped = (*([f"{lines} lines"] if lines else []), *_lost(parts, named, described))
    if skipped:
        own = ("metadata not_read",) if "not_read" in user_entries(described["metadata"]) else ()
        described["metadata"]["not_read"] = Unread((*skipped, *own))
    return Cloud(
        np.concatenate([part.points for part in parts]) if parts else np.zeros((0, 3)),
        colors=_joined(colors),
        normals=_joined(normals),
        attributes=named,
        faces=_joined_faces(parts),
        **described,
    )


def to_mesh(cloud: Cloud) -> trimesh.Trimesh:
    """Convert a cloud with faces to a trimesh mesh.

    Parameters
    ----------
    cloud : Cloud
        Points with faces, as `Surface.to_cloud` makes them.

    Returns
    -------
    trimesh.Trimesh
        Unprocessed: every vertex in its place, used or not, with 8-bit RGBA colours, normals
        and vertex attributes. Coordinates are copied: edits do not affect the cloud.

    Raises
    ------
    InputError
        A colour is outside its range.

    See Also
    --------
    Surface.to_cloud, Surface.to_open3d, Surface.to_matplotlib

    Examples
    --------
    >>> import liftmesh
    >>> liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]]).to_trimesh().faces.shape
    (1, 3)
    """
    library = load("trimesh", extra="trimesh")
    with preserve_signals():
        mesh: trimesh.Trimesh = library.Trimesh(**_of_mesh(cloud))
    return mesh


def to_points(cloud: Cloud) -> trimesh.PointCloud:
    """Convert the rows of a cloud to a trimesh point cloud."""
    library = load("trimesh", extra="trimesh")
    with preserve_signals():
        points: trimesh.PointCloud = library.PointCloud(**_of_points(cloud))
    return points


def arguments_of(cloud: Cloud) -> dict[str, Any]:
    """Return what makes a mesh of trimesh; a point cloud if there are no faces."""
    return _of_points(cloud) if cloud.faces is None else _of_mesh(cloud)


def _of_points(cloud: Cloud) -> dict[str, Any]:
    colors = None if cloud.colors is None else with_alpha(as_uint8(cloud.colors))
    return {"vertices": cloud.points.copy(), "colors": colors, "metadata": _metadata(cloud)}


def _of_mesh(cloud: Cloud) -> dict[str, Any]:
    shared = _of_points(cloud)
    colors = shared.pop("colors")
    return {
        **shared,
        "faces": faces_of(cloud),
        "vertex_colors": colors,
        "vertex_normals": _copied(cloud.normals),
        "vertex_attributes": {name: values.copy() for name, values in cloud.attributes.items()},
        "process": False,
    }


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


def _rotated(normals: Array, matrix: Floats, determinant: float) -> Array | None:
    if determinant == 0:
        return None
    if np.array_equal(np.abs(matrix) @ np.ones(3), np.ones(3)) and set(matrix.flat) <= {-1, 0, 1}:
        turned: Floats = normals @ matrix.T  # between axes: no number is rounded
        return turned
    inverse = np.linalg.inv(matrix)
    if not np.isfinite(inverse).all():
        return None
    # A power of two, so that no square overflows and no bit changes.
    inverse = np.ldexp(inverse, -np.frexp(np.abs(inverse).max())[1])
    rotated: Floats = normals @ inverse
    lengths = np.sqrt((rotated * rotated).sum(axis=1, keepdims=True))
    np.divide(rotated, lengths, out=rotated, where=lengths > 0)
    return rotated


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


def _metadata(cloud: Cloud) -> dict[str, Any]:
    crs = {} if cloud.crs is None else {"crs": cloud.crs}
    return {**cloud.metadata, **crs}


def _copied(normals: Array | None) -> Array | None:
    """A copy of the normals; None if there are none, which trimesh cannot look at."""
    return None if normals is None or not len(normals) else np.array(normals)


def _nodes(scene: trimesh.Scene) -> Iterator[tuple[Floats, Any]]:
    for node in scene.graph.nodes_geometry:
        yield scene.graph[node]


def _holds_points(geometry: Any) -> bool:
    """Whether a geometry is a mesh or a point cloud, not a path."""
    return hasattr(geometry, "vertices") and not hasattr(geometry, "entities")


def _joined(parts: Sequence[Array | None]) -> Array | None:
    known = [each for each in parts if each is not None]
    return np.concatenate(known) if known and len(known) == len(parts) else None


def _joined_values(parts: Sequence[Mapping[str, Array]]) -> dict[str, Array]:
    """Join the named values that all parts have, in one type and shape."""
    joined: dict[str, Array] = {}
    for name in parts[0] if parts else ():
        values = [part[name] for part in parts if name in part]
        forms = {(each.dtype, each.shape[1:]) for each in values}
        if len(values) == len(parts) and len(forms) == 1:
            joined[name] = np.concatenate(values)
    return joined


def _common(parts: Sequence[Mapping[Any, Any]]) -> dict[Any, Any]:
    """Return the entries that are the same in all mappings."""
    first, *others = parts or [{}]
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


def _joined_faces(parts: list[Cloud]) -> Rows | None:
    joined: list[Rows] = []
    start = 0
    for part in parts:
        if part.faces is not None and len(part.faces):
            joined.append(checked_faces(part.faces, len(part), _NAME) + np.int32(start))
        start += len(part)
    return np.concatenate(joined) if joined else None


def _lost(
    parts: Sequence[Cloud], kept: Mapping[str, Array], described: Mapping[str, Any]
) -> list[str]:
    """Name what geometries have and their union has not, with the number of geometries."""
    lost: Counter[str] = Counter()
    for part in parts:
        lost.update(Provenance(part.metadata).lost)
        lost.update(name for name in part.attributes if name not in kept)
        if part.crs not in (None, described["crs"]):
            lost["crs"] += 1
        lost.update(
            f"metadata {key}"
            for key, value in user_entries(part.metadata).items()
            if not _is_same(described["metadata"].get(key), value)
        )
    for name in ("colors", "normals"):
        count = sum(getattr(part, name) is not None for part in parts)
        lost[name] = count if count < len(parts) else 0
    return [
        f"{what} of {count} of {len(parts)} geometries" for what, count in lost.items() if count
    ]
