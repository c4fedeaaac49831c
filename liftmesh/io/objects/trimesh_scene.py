"""Scenes of trimesh: all their meshes and point clouds in their places, joined in one cloud.

A cloud has one set of values for all rows. So what some geometries have and others have not, or
have in another form, is not kept, but named.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Array, Floats, Rows
from liftmesh.base.cloud import Cloud
from liftmesh.io.faces import checked_faces
from liftmesh.io.metadata import Unread, not_read, user_entries
from liftmesh.io.objects.trimesh import of_metadata, to_cloud, transformed

if TYPE_CHECKING:
    import trimesh

_NAME = "the scene"  # in messages


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
        own = ("metadata skipped",) if "skipped" in user_entries(described["metadata"]) else ()
        described["metadata"]["skipped"] = Unread((*skipped, *own))
    return Cloud(
        np.concatenate([part.points for part in parts]) if parts else np.zeros((0, 3)),
        colors=_joined(colors),
        normals=_joined(normals),
        attributes=named,
        faces=_joined_faces(parts),
        **described,
    )


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
    found: dict[str, Array] = {}
    for name in parts[0] if parts else ():
        values = [part[name] for part in parts if name in part]
        forms = {(each.dtype, each.shape[1:]) for each in values}
        if len(values) == len(parts) and len(forms) == 1:
            found[name] = np.concatenate(values)
    return found


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
    found: list[Rows] = []
    start = 0
    for part in parts:
        if part.faces is not None and len(part.faces):
            found.append(checked_faces(part.faces, len(part), _NAME) + np.int32(start))
        start += len(part)
    return np.concatenate(found) if found else None


def _lost(
    parts: Sequence[Cloud], kept: Mapping[str, Array], described: Mapping[str, Any]
) -> list[str]:
    """Name what geometries have and their union has not, with the number of geometries."""
    lost: Counter[str] = Counter()
    for part in parts:
        lost.update(not_read(part.metadata))
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
