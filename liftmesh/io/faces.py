"""Faces as files hold them: checked, and split into triangles if they are polygons."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from liftmesh._typing import Array, Rows
from liftmesh.errors import FormatError
from liftmesh.io.ragged import Ragged, places, runs


def outside(vertex: int, vertices: int) -> str:
    """Say that a face refers to a vertex that does not exist, counted from 0."""
    return f"refers to vertex {vertex} (counted from 0), but there are {vertices} vertices"


def triangulated(
    faces: Ragged,
    vertices: int,
    name: str,
    where: Callable[[int], str] = "face {}".format,
    wrong_of: Callable[[int, int], str] = outside,
) -> Rows:
    """Split polygons into triangle fans around their first vertex, in order."""
    if not _within(faces.values, vertices):
        wrong = np.argmax((faces.values < 0) | (faces.values >= vertices))
        face, vertex = faces.row_of(int(wrong)), int(faces.values[wrong])
        raise FormatError(f"{name}: {where(face)} {wrong_of(vertex, vertices)}")
    size = int(faces.sizes[0]) if len(faces.sizes) else 0
    if size >= 3 and np.all(faces.sizes == size):
        return _fans_of_one_size(faces.values.reshape(-1, size))
    return _fans(faces)


def _fans_of_one_size(polygons: Array) -> Rows:
    count, size = polygons.shape
    if size == 3:
        return polygons.astype(np.int32, copy=False)
    triangles = np.empty((count, size - 2, 3), dtype=np.int32)
    triangles[:, :, 0] = polygons[:, :1]
    triangles[:, :, 1] = polygons[:, 1:-1]
    triangles[:, :, 2] = polygons[:, 2:]
    return triangles.reshape(-1, 3)


def _fans(faces: Ragged) -> Rows:
    many, ones = (int(np.count_nonzero(each)) for each in (faces.sizes >= 2, faces.sizes == 1))
    triangles = np.empty((len(faces.values) - 2 * many - ones, 3), dtype=np.int32)
    done = 0
    for rows, at in runs(faces.sizes):
        done += _fill(triangles[done:], faces.sizes[rows].astype(np.int64), faces.values[at])
    return triangles


def _fill(triangles: Rows, sizes: Array, corners: Array) -> int:
    """Write the fans of some faces to the first of ``triangles``; return their number."""
    if len(sizes) == 1:
        count = max(len(corners) - 2, 0)
        triangles[:count, 0] = corners[:1]
        triangles[:count, 1] = corners[1 : count + 1]
        triangles[:count, 2] = corners[2:]
        return count
    fans = np.maximum(sizes - 2, 0)
    starts = np.cumsum(sizes) - sizes
    second = places(starts + 1, fans)
    some = triangles[: len(second)]
    some[:, 0] = corners[np.repeat(starts, fans)]
    some[:, 1] = corners[second]
    some[:, 2] = corners[second + 1]
    return len(second)


def face_counts(faces: Ragged) -> dict[str, int]:
    """Count the polygons and degenerate faces, for a cloud's metadata."""
    counts = {
        "polygons": int((faces.sizes > 3).sum()),
        "degenerate_faces": int((faces.sizes < 3).sum()),
    }
    return {key: count for key, count in counts.items() if count}


def checked_faces(faces: Array, vertices: int, name: str) -> Rows:
    """Return (m, 3) faces as int32; raise if one refers to a vertex that does not exist."""
    if faces.dtype.kind not in "iu" or faces.ndim != 2 or faces.shape[1] != 3:
        raise FormatError(
            f"{name}: faces must be an (m, 3) array of integers, "
            f"not {faces.dtype} of shape {faces.shape}"
        )
    if not _within(faces, vertices):
        wrong = (faces < 0) | (faces >= vertices)
        row, corner = (int(each) for each in np.argwhere(wrong)[0])
        raise FormatError(f"{name}: face {row} {outside(int(faces[row, corner]), vertices)}")
    return faces.astype(np.int32, copy=False)


def narrowed(faces: Array) -> Array:
    """Return faces as int32; as they are if one is beyond it, for whoever checks them."""
    limits = np.iinfo(np.int32)
    fit = not faces.size or (faces.min() >= limits.min and faces.max() <= limits.max)
    return faces.astype(np.int32, copy=False) if fit else faces


def _within(indices: Array, vertices: int) -> bool:
    """Whether every index is that of a vertex, computed without a mask as large as the mesh."""
    return indices.size == 0 or bool(indices.min() >= 0 and indices.max() < vertices)
