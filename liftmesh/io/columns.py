"""Columns and faces of files, on their way to a cloud.

Files name their columns: x, y, z, red, nx and so on. A `CloudBuilder` owns the arrays of the future
cloud and provides each named column as a view of them, so that a reader fills the final arrays
directly, block by block.

Faces are rows of different lengths, checked, and split into triangles. A `Ragged` holds such rows
in one flat array: polygons of any size, and lists of a PLY file. Lengths keep the type in which a
file states them: rows of one byte each must not take eight bytes of memory for their lengths alone.
What is computed from them is computed in runs of few rows and values, for the same reason.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.lib.stride_tricks import as_strided

from liftmesh._typing import Array, Floats, Integers, Rows
from liftmesh.base.arrays import used_rows
from liftmesh.base.cloud import Cloud
from liftmesh.base.colors import confirmed_depth
from liftmesh.errors import FormatError

POSITION = ("x", "y", "z")
NORMAL = ("nx", "ny", "nz")
COLOR = ("red", "green", "blue")
ALPHA = "alpha"
PARTS = (*POSITION, *COLOR, ALPHA, *NORMAL)  # of a point


def type_in_text(name: str, dtype: np.dtype) -> np.dtype:
    """Return the type of a column of text; coordinates are doubles."""
    return np.dtype(np.float64) if name in POSITION and dtype.kind == "f" else dtype


def taken_together(columns: dict[str, Array], names: tuple[str, ...]) -> Array | None:
    """Remove and return columns that belong together, as one array; None if not all are there."""
    if not all(name in columns and columns[name].ndim == 1 for name in names):
        return None
    return np.stack([columns.pop(name) for name in names], axis=1)


def taken_points(columns: dict[str, Array], rows: int) -> Floats:
    """Remove and return the coordinates; those that are not there are 0."""
    points = np.zeros((rows, len(POSITION)))
    for position, name in enumerate(POSITION):
        if name in columns:
            points[:, position] = columns.pop(name)
    return points


def attribute_columns(attributes: Mapping[str, Array]) -> dict[str, Array]:
    """Return the attributes as columns of numbers; those of several columns are numbered."""
    columns: dict[str, Array] = {}
    for name, values in attributes.items():
        width = math.prod(values.shape[1:])
        if values.dtype.kind not in "biuf" or not width:
            raise FormatError(
                f"attribute {name!r} of type {values.dtype} and shape {values.shape} cannot be "
                "written as text: it has no numbers"
            )
        flat = exact_doubles(values).reshape(len(values), width)
        names = [name] if values.ndim == 1 else [f"{name}_{k}" for k in range(width)]
        taken = columns.keys() & {*names}
        if taken:
            raise FormatError(f"two attributes are named {min(taken)!r}: rename one")
        columns |= zip(names, flat.T, strict=True)
    return columns


def exact_doubles(values: Array) -> Array:
    """Floats as doubles, which text is read as: so their digits are those of the same number."""
    if values.dtype.kind != "f":
        return values
    with np.errstate(invalid="ignore"):  # NumPy warns of signalling NaNs in single precision
        doubles = values.astype(np.float64, copy=False)
    if values.dtype.itemsize > doubles.itemsize and not np.array_equal(
        doubles, values, equal_nan=True
    ):
        raise FormatError(f"values of type {values.dtype} cannot be written as text: convert them")
    return doubles


class CloudBuilder:
    """Arrays for ``rows`` points with the named columns: x and y, and any others."""

    def __init__(self, types: Mapping[str, np.dtype], rows: int) -> None:
        self.columns: dict[str, Array] = {}
        self.points = np.empty((rows, 3))
        self._share(self.points, POSITION)
        if "z" not in types:
            self.columns.pop("z").fill(0.0)
        self.normals = self._grouped(types, NORMAL, rows)
        color = (*COLOR, ALPHA) if ALPHA in types else COLOR
        self.colors = self._grouped(types, color, rows)
        others = [each for each in types if each not in self.columns]
        self.attributes = {each: np.empty(rows, types[each].newbyteorder("=")) for each in others}
        self.columns |= self.attributes

    @property
    def rows(self) -> int:
        """Number of rows allocated."""
        return len(self.points)

    def fill(self, rows: slice, columns: Mapping[str, Array]) -> None:
        """Set some rows of the named columns."""
        with np.errstate(invalid="ignore"):  # NumPy warns of signalling NaNs in single precision
            for name, values in columns.items():
                self.columns[name][rows] = values

    def shorten(self, rows: int) -> None:
        """Give back the memory of all but the first rows; columns cannot be filled any more."""
        self.columns = {}  # views of the arrays, which may move
        arrays = (self.points, self.normals, self.colors, *self.attributes.values())
        for array in arrays:
            if array is not None and rows < len(array):
                array.resize((rows, *array.shape[1:]), refcheck=False)

    def cloud(
        self,
        faces: Rows | None = None,
        metadata: Mapping[str, Any] = MappingProxyType({}),
        crs: str | None = None,
        color_depth: int | None = None,
        edges: Rows | None = None,
    ) -> Cloud:
        """Return the filled arrays as a cloud; the depth is what the file states."""
        return Cloud(
            self.points,
            colors=self.colors,
            normals=self.normals,
            attributes=self.attributes,
            faces=faces,
            metadata=metadata,
            crs=crs,
            color_depth=confirmed_depth(self.colors, color_depth),
            edges=edges,
        )

    def _grouped(
        self, types: Mapping[str, np.dtype], names: tuple[str, ...], rows: int
    ) -> Array | None:
        if not all(each in types for each in names):
            return None
        common = np.result_type(*(types[each].newbyteorder("=") for each in names))
        array = np.empty((rows, len(names)), common)
        self._share(array, names)
        return array

    def _share(self, array: Array, names: tuple[str, ...]) -> None:
        self.columns |= {each: array[:, position] for position, each in enumerate(names)}


def built_in_chunks(
    types: Mapping[str, np.dtype], total: int, blocks: Iterable[Mapping[str, Array]], rows: int
) -> Iterator[CloudBuilder]:
    """Fill builders of ``rows`` rows each from blocks of any size; the last may have fewer rows."""
    filled, done = 0, 0
    builder: CloudBuilder | None = None
    for block in blocks:
        size, taken = len(next(iter(block.values()))), 0
        while taken < size:
            builder = builder or CloudBuilder(types, min(rows, total - done))
            count = min(size - taken, builder.rows - filled)
            part = {name: values[taken : taken + count] for name, values in block.items()}
            builder.fill(slice(filled, filled + count), part)
            taken, filled = taken + count, filled + count
            if filled == builder.rows:
                yield builder
                done, filled, builder = done + filled, 0, None


_ROWS = 1 << 18  # rows copied at a time: Ctrl-C takes effect in between
_RUN = 1 << 16  # rows, and values, of a run


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


def checked_faces(
    faces: Array, vertices: int, name: str, kind: str = "face", shape: str = "(m, 3)"
) -> Rows:
    """Return (m, 3) faces as int32; raise if one refers to a vertex that does not exist."""
    is_wide = faces.ndim == 2 and shape.endswith(f" {faces.shape[1]})")
    if faces.dtype.kind not in "iu" or not is_wide:
        raise FormatError(
            f"{name}: {kind}s must be an {shape} array of integers, "
            f"not {faces.dtype} of shape {faces.shape}"
        )
    if not _within(faces, vertices):
        wrong = (faces < 0) | (faces >= vertices)
        row, corner = (int(each) for each in np.argwhere(wrong)[0])
        raise FormatError(f"{name}: {kind} {row} {outside(int(faces[row, corner]), vertices)}")
    return faces.astype(np.int32, copy=False)


def checked_edges(edges: Array, vertices: int, name: str) -> Rows:
    """Return (k, 2) edges as int32; raise if one refers to a vertex that does not exist."""
    return checked_faces(edges, vertices, name, "edge", "(k, 2)")


def face_counts(faces: Ragged) -> dict[str, int]:
    """Count the polygons and degenerate faces, for a cloud's metadata."""
    counts = {
        "polygons": int((faces.sizes > 3).sum()),
        "degenerate_faces": int((faces.sizes < 3).sum()),
    }
    return {key: count for key, count in counts.items() if count}


def faces_of(cloud: Cloud) -> Rows:
    """Return the faces of a cloud: an empty array if it has none."""
    return np.zeros((0, 3), dtype=np.int32) if cloud.faces is None else cloud.faces


def edges_of(cloud: Cloud) -> Rows:
    """Return the edges of a cloud: an empty array if it has none."""
    return np.zeros((0, 2), dtype=np.int32) if cloud.edges is None else cloud.edges


def with_used_rows(cloud: Cloud) -> tuple[Cloud, Rows]:
    """Leave out the rows in no face; return the others, too, by their numbers before."""
    faces = faces_of(cloud)
    used = used_rows(len(cloud), faces)
    if len(used) == len(cloud):
        return cloud, used
    names = np.full(len(cloud), -1, dtype=np.int32)
    names[used] = np.arange(len(used), dtype=np.int32)
    return replace(cloud.select(used), faces=names.take(faces, axis=0)), used


def narrowed(faces: Array) -> Array:
    """Return faces as int32; as they are if one is beyond it, for whoever checks them."""
    limits = np.iinfo(np.int32)
    fit = not faces.size or (faces.min() >= limits.min and faces.max() <= limits.max)
    return faces.astype(np.int32, copy=False) if fit else faces


def _within(indices: Array, vertices: int) -> bool:
    """Whether every index is that of a vertex, computed without a mask as large as the mesh."""
    return indices.size == 0 or bool(indices.min() >= 0 and indices.max() < vertices)


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


@dataclass(frozen=True, slots=True)
class Ragged:
    """Rows of different lengths: row i holds the next ``sizes[i]`` of ``values``."""

    sizes: Integers
    values: Array

    @classmethod
    def uniform(cls, rows: Array, length: np.dtype | None = None) -> Ragged:
        """Copy an (m, k) array: m rows of k values; ``length`` is the type of their lengths."""
        copy = np.empty(rows.shape, rows.dtype)
        for start in range(0, len(rows), _ROWS):
            copy[start : start + _ROWS] = rows[start : start + _ROWS]
        size = np.array(rows.shape[1], np.int64 if length is None else length.newbyteorder("="))
        return cls(np.broadcast_to(size, len(rows)), copy.reshape(-1))

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

    def row_of(self, position: int) -> int:
        """Return the row to which the value at ``position`` belongs."""
        ends = np.cumsum(self.sizes, dtype=np.int64)
        return int(np.searchsorted(ends, position, side="right"))


def runs(sizes: Integers) -> Iterator[tuple[slice, slice]]:
    """Divide rows into runs of few rows and values, or of one long row: the slices of both."""
    before = 0
    for start in range(0, len(sizes), _RUN):
        ends = np.cumsum(sizes[start : start + _RUN], dtype=np.int64)
        row, begin = 0, 0
        while row < len(ends):
            stop = max(int(np.searchsorted(ends, begin + _RUN, side="right")), row + 1)
            end = int(ends[stop - 1])
            yield slice(start + row, start + stop), slice(before + begin, before + end)
            row, begin = stop, end
        before += begin


def places(starts: Integers, sizes: Integers) -> Integers:
    """List ``starts[i]``, ``starts[i] + 1`` and so on, ``sizes[i]`` of them, for each i."""
    first = starts - (np.cumsum(sizes) - sizes)
    found: Integers = np.repeat(first, sizes)
    found += np.arange(len(found))
    return found


def gathered(values: Array, starts: Integers, sizes: Integers) -> Array:
    """Concatenate ``values[starts[i] : starts[i] + sizes[i]]`` for each i."""
    if len(sizes) and (sizes == sizes[0]).all():
        return _gathered_uniform(values, starts, int(sizes[0]))
    found = np.empty(int(sizes.sum()), values.dtype)
    for rows, at in runs(sizes):
        if rows.stop - rows.start == 1:
            start = int(starts[rows.start])
            found[at] = values[start : start + at.stop - at.start]
        else:
            found[at] = values[places(starts[rows], sizes[rows])]
    return found


def _gathered_uniform(values: Array, starts: Integers, size: int) -> Array:
    if len(starts) == 1:
        return np.array(values[int(starts[0]) : int(starts[0]) + size])
    if (even := _gathered_evenly(values, starts, size)) is not None:
        return even
    found = np.empty((len(starts), size), values.dtype)
    for row in range(0, len(starts), max(_RUN // max(size, 1), 1)):
        some = slice(row, row + max(_RUN // max(size, 1), 1))
        found[some] = values[starts[some, None] + np.arange(size)]
    flat: Array = found.reshape(-1)
    return flat


def _gathered_evenly(values: Array, starts: Integers, size: int) -> Array | None:
    """The same for starts at equal distances, as in lines of triangles; None for others."""
    step = int(starts[1] - starts[0])
    if step < size or starts[-1] + size > len(values) or (np.diff(starts) != step).any():
        return None
    (stride,) = values.strides
    rows = as_strided(values[int(starts[0]) :], (len(starts), size), (step * stride, stride))
    flat: Array = np.array(rows, order="C").reshape(-1)
    return flat
