"""Polygons of any size, as files hold them: validated and split into triangles."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from liftmesh._typing import Array, Integers, Rows
from liftmesh.errors import FormatError

_ROWS = 1 << 18  # rows copied at a time: Ctrl-C takes effect in between


@dataclass(frozen=True, slots=True)
class Ragged:
    """Rows of different lengths: row i holds the next ``sizes[i]`` of ``values``."""

    sizes: Integers
    values: Array

    @classmethod
    def uniform(cls, rows: Array) -> Ragged:
        """Copy an (m, k) array: m rows of k values."""
        copy = np.empty(rows.shape, rows.dtype)
        for start in range(0, len(rows), _ROWS):
            copy[start : start + _ROWS] = rows[start : start + _ROWS]
        return cls(np.broadcast_to(np.int64(rows.shape[1]), len(rows)), copy.reshape(-1))

    @classmethod
    def empty(cls, dtype: np.dtype) -> Ragged:
        """Return an instance without rows."""
        return cls(np.empty(0, dtype=np.int64), np.empty(0, dtype))

    @classmethod
    def joined(cls, parts: Sequence[Ragged]) -> Ragged:
        """Concatenate the rows of all parts."""
        if len(parts) == 1:
            return parts[0]
        return cls(
            np.concatenate([each.sizes for each in parts]),
            np.concatenate([each.values for each in parts]),
        )

    def starts(self) -> Integers:
        """Return the index of the first value of each row."""
        return np.cumsum(self.sizes) - self.sizes

    def row_of(self, position: int) -> int:
        """Return the row to which the value at ``position`` belongs."""
        return int(np.searchsorted(np.cumsum(self.sizes), position, side="right"))


def triangulated(
    faces: Ragged, vertices: int, name: str, where: Callable[[int], str] = "face {}".format
) -> Rows:
    """Split polygons into triangle fans around their first vertex, in order.

    Parameters
    ----------
    faces : Ragged
        Vertices of each face, counted from 0.
    vertices : int
        Number of vertices.
    where : callable, optional
        Describes face number i in messages.

    Raises
    ------
    FormatError
        A face refers to a vertex that does not exist.
    """
    if not _within(faces.values, vertices):
        wrong = np.argmax((faces.values < 0) | (faces.values >= vertices))
        face, vertex = faces.row_of(int(wrong)), int(faces.values[wrong])
        raise FormatError(f"{name}: {where(face)} {_outside(vertex, vertices)}")
    return _fans(faces).astype(np.int32, copy=False)


def _fans(faces: Ragged) -> Array:
    if np.all(faces.sizes == 3):
        return faces.values.reshape(-1, 3)
    fans = np.maximum(faces.sizes - 2, 0)
    first = np.repeat(faces.starts(), fans)
    step = np.arange(len(first)) - np.repeat(np.cumsum(fans) - fans, fans)
    corners = np.stack([first, first + step + 1, first + step + 2], axis=1)
    return np.asarray(faces.values[corners])


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
        raise FormatError(f"{name}: face {row} {_outside(int(faces[row, corner]), vertices)}")
    return faces.astype(np.int32, copy=False)


def _within(indices: Array, vertices: int) -> bool:
    """Whether every index is that of a vertex, computed without a mask as large as the mesh."""
    return indices.size == 0 or bool(indices.min() >= 0 and indices.max() < vertices)


def _outside(vertex: int, vertices: int) -> str:
    return f"refers to vertex {vertex} (counted from 0), but there are {vertices} vertices"
