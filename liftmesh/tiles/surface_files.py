"""What the folder of a tiled surface has besides triangles: vertices and faces of shards.

Beside each shard of triangles, ``tile-00007.npy``, are its vertices, ``tile-00007-vertices.npy``:
records of row, x, y, z and the values of the row, by ascending row; and the same triangles as faces
between these, ``tile-00007-faces.npy``. So a shard is a mesh by itself; a vertex that several
shards share is in each of them. Triangles alone have no such files.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh.tiles.context import label
from liftmesh.tiles.node import overhangs_apart

if TYPE_CHECKING:
    from liftmesh.tiles.context import Done, RunContext


def vertices_name(shard: str) -> str:
    """Name the file of the vertices of a shard."""
    return f"{shard.partition('.')[0]}-vertices.npy"


def faces_name(shard: str) -> str:
    """Name the file of the faces of a shard."""
    return f"{shard.partition('.')[0]}-faces.npy"


def extent_in_manifest(done: Done) -> dict[str, Any]:
    """Say how many vertices a shard has, and where they are."""
    if not done.vertices:
        return {}
    return {"vertices": done.vertices, "extent": list(done.extent)}


def about_surface(
    context: RunContext, identity: Mapping[str, Any], done: Sequence[Done], parts: int
) -> dict[str, Any]:
    """Say what was found of a surface."""
    if "surface" not in identity:
        return {}
    apart = [context.scratch / f"run-{number:05d}-apart.npy" for number in range(parts)]
    tiles = [context.scratch / f"{label(each.name)}-heights.npy" for each in done if each.name < 0]
    within = sum(each.overhangs for each in done)
    boxes = np.array([each.extent for each in done if each.vertices])
    extent = [*boxes[:, :3].min(axis=0).tolist(), *boxes[:, 3:].max(axis=0).tolist()]
    found = {"overhangs": within + overhangs_apart(apart, tiles), "extent": extent}
    return {"surface": {**identity["surface"], **found}}
