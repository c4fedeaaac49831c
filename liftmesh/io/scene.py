"""A trimesh scene as one Cloud: every mesh and point cloud in its place."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from liftmesh._typing import Array, Rows
from liftmesh.cloud import Cloud
from liftmesh.errors import FormatError
from liftmesh.io.faces import checked_faces


def scene_cloud(scene: Any, name: str) -> Cloud:
    """Put the geometries of a scene together.

    Colours are kept if every geometry has them. Of a scene with faces all faces are kept; lines are
    passed over and counted in ``metadata["skipped"]``.

    Raises
    ------
    FormatError
        The scene has no vertices.
    """
    parts = list(_placed(scene))
    solid = [(points, each) for points, each in parts if _is_surface(each) or _is_cloud(each)]
    if not sum(len(points) for points, _ in solid):
        raise FormatError(f"{name}: the file holds no vertices")
    points = np.concatenate([points for points, _ in solid])
    skipped = len(parts) - len(solid)
    metadata = {**scene.metadata, **({"skipped": (f"{skipped} lines",)} if skipped else {})}
    return Cloud(
        points, colors=_colors(solid), faces=_faces(solid, len(points), name), metadata=metadata
    )


def _placed(scene: Any) -> Iterator[tuple[Array, Any]]:
    for node in scene.graph.nodes_geometry:
        matrix, key = scene.graph[node]
        geometry = scene.geometry[key]
        points = np.array(geometry.vertices, dtype=np.float64).reshape(len(geometry.vertices), -1)
        if not np.array_equal(matrix, np.eye(4)):
            points = points @ matrix[:3, :3].T + matrix[:3, 3]
        yield points, geometry


def _is_surface(geometry: Any) -> bool:
    return hasattr(geometry, "faces")


def _is_cloud(geometry: Any) -> bool:
    return not hasattr(geometry, "entities") and hasattr(geometry, "colors")


def _faces(parts: list[tuple[Array, Any]], count: int, name: str) -> Rows | None:
    found: list[Array] = []
    start = 0
    for points, geometry in parts:
        if _is_surface(geometry) and len(geometry.faces):
            faces = checked_faces(np.asarray(geometry.faces), len(points), name)
            found.append(faces.astype(np.int64) + start)
        start += len(points)
    return checked_faces(np.concatenate(found), count, name) if found else None


def _colors(parts: list[tuple[Array, Any]]) -> Array | None:
    colors = [_own_colors(geometry) for _, geometry in parts]
    known = [each for each in colors if each is not None]
    return np.concatenate(known) if len(known) == len(colors) else None


def _own_colors(geometry: Any) -> Array | None:
    if not _is_surface(geometry):
        colors = np.asarray(geometry.colors)
        return colors if len(colors) == len(geometry.vertices) else None
    return np.array(geometry.visual.vertex_colors) if geometry.visual.kind == "vertex" else None
