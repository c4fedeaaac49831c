"""trimesh: point clouds and meshes in, meshes out.

trimesh merges vertices and drops rows unless told ``process=False``, keeps colours as 8-bit RGBA,
and makes up a grey for objects that have none, so colours are read only where some are defined.
Vertex normals are read where the mesh already holds them; asking for them would compute them. What
goes out is copied: trimesh edits meshes in place and locks the arrays of normals that it is given.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh import arrays
from liftmesh._typing import Array
from liftmesh.cloud import Cloud
from liftmesh.io.colors import as_uint8, with_alpha
from liftmesh.optional import load

if TYPE_CHECKING:
    from collections.abc import Mapping

    import trimesh


def to_cloud(source: trimesh.PointCloud | trimesh.Trimesh) -> Cloud:
    """Make a cloud of a trimesh point cloud or mesh.

    Parameters
    ----------
    source : trimesh.PointCloud or trimesh.Trimesh
        Vertices, with vertex colours, vertex normals, vertex attributes and metadata if any.

    Returns
    -------
    Cloud
        One row a vertex, in the order of ``source``; a mesh keeps its faces. Coordinates are
        shared with ``source``, not copied.

    Raises
    ------
    InputError
        Colours or an attribute do not have one row a vertex.

    Examples
    --------
    >>> import trimesh
    >>> len(to_cloud(trimesh.PointCloud([[0, 0, 5], [1, 0, 6], [0, 1, 7]])))
    3
    """
    attributes: Mapping[str, Any] = getattr(source, "vertex_attributes", None) or {}
    faces = getattr(source, "faces", None)
    return Cloud(
        points=arrays.as_rows3(np.asarray(source.vertices)),
        colors=_colors(source),
        normals=_normals(source),
        attributes={name: np.atleast_1d(values) for name, values in attributes.items()},
        faces=None if faces is None else np.asarray(faces, dtype=np.int32),
        metadata=source.metadata,
    )


def to_mesh(cloud: Cloud) -> trimesh.Trimesh:
    """Make a trimesh mesh of a cloud with faces.

    Parameters
    ----------
    cloud : Cloud
        Points and faces; colours become 8-bit RGBA, named values vertex attributes.

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
    mesh: trimesh.Trimesh = load("trimesh").Trimesh(
        vertices=cloud.points.copy(),
        faces=np.zeros((0, 3), dtype=np.int64) if cloud.faces is None else cloud.faces,
        vertex_colors=colors,
        vertex_normals=None if cloud.normals is None else np.array(cloud.normals),
        vertex_attributes={name: values.copy() for name, values in cloud.attributes.items()},
        metadata=dict(cloud.metadata),
        process=False,
    )
    return mesh


def _colors(source: Any) -> Array | None:
    """Read the colours of the vertices where the object defines some."""
    if getattr(source.visual, "kind", None) != "vertex":
        return None
    colors = source.visual.vertex_colors
    return None if colors is None or len(colors) == 0 else np.asarray(colors)


def _normals(source: Any) -> Array | None:
    """Read the vertex normals a mesh holds, by the test that trimesh's own exporters apply."""
    held = "vertex_normals" in getattr(source, "_cache", ())
    return np.asarray(source.vertex_normals) if held else None
