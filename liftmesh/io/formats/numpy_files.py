"""NumPy's file formats: one array of points (NPY), or points with all their data (NPZ).

Nothing is unpickled: a file cannot execute code.
"""

from __future__ import annotations

import re
import zipfile
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Any, BinaryIO, Protocol

import numpy as np
from numpy.lib import format as npy

from liftmesh._typing import Array, Floats
from liftmesh.base.arrays import as_rows3
from liftmesh.base.cloud import Cloud, is_crs
from liftmesh.base.colors import confirmed_depth, stated_depth
from liftmesh.errors import FormatError, InputError
from liftmesh.io import metadata
from liftmesh.io.columns import CloudBuilder, checked_edges, checked_faces
from liftmesh.io.formats.numpy_arrays import (
    Layout,
    array_parts,
    check_content,
    open_archive,
    read_array,
)
from liftmesh.io.streams import remaining
from liftmesh.io.text_tables import shortened

_POINTS = ("points", "vertices", "xyz")
_FACES = ("faces", "triangles")
_EDGES = "edges"
_CRS = "crs"
_METADATA = "metadata"
_DEPTH = "color_depth"
_RESERVED = {*_POINTS, *_FACES, _EDGES, "colors", "normals"}


def read_npy(stream: BinaryIO, name: str) -> Cloud:
    """Read points from an NPY file."""
    return _points_alone(read_array(stream, name), name)


def read_npy_chunks(stream: BinaryIO, name: str, rows: int) -> Iterator[Cloud]:
    """Read points from an NPY file in chunks."""
    layout = Layout.read(stream, name)
    layout.check_size(remaining(stream), name)
    _check_layout(layout, name)
    for number, part in enumerate(array_parts(stream, layout, name, rows)):
        yield _points_alone(part, name, number * rows)


def read_npz(stream: BinaryIO, name: str, *, max_bytes: int | None = None) -> Cloud:
    """Read a cloud or mesh from an NPZ file."""
    with open_archive(stream, name) as members:
        check_content(members.values(), max_bytes, name)
        arrays = {key: member.whole() for key, member in members.items()}
    return _Roles(arrays, name).cloud(arrays)


def read_npz_chunks(
    stream: BinaryIO, name: str, rows: int, *, max_bytes: int | None = None
) -> Iterator[Cloud]:
    """Read the points of an NPZ file, with all their data, in chunks."""
    with open_archive(stream, name) as members:
        roles = _Roles({key: member.layout for key, member in members.items()}, name)
        needed = roles.row_arrays
        check_content([members[key] for key in (*needed, *roles.scalars)], max_bytes, name)
        _check_layout(members[needed[0]].layout, name)
        scalars = {key: members[key].whole() for key in roles.scalars}
        streams = [members[key].parts(rows) for key in needed]
        for number, parts in enumerate(zip(*streams, strict=True)):
            yield roles.cloud(dict(zip(needed, parts, strict=True)) | scalars, number * rows)


def write_npz(stream: BinaryIO, cloud: Cloud, *, compressed: bool = False) -> None:
    """Write a cloud or mesh as NPZ: every array in its own type."""
    crs = None if cloud.crs is None else np.array(cloud.crs)
    entries = metadata.storable(cloud.metadata)
    depth = stated_depth(cloud.colors)
    parts = {
        "colors": cloud.colors,
        _DEPTH: None if depth is None else np.array(depth, np.uint8),
        "normals": cloud.normals,
        "faces": cloud.faces,
        _EDGES: cloud.edges,
        _CRS: crs,
        _METADATA: np.array(metadata.as_text(entries)) if entries else None,
    }
    check_npz(cloud)
    arrays = {key: values for key, values in parts.items() if values is not None}
    _write_arrays(stream, {"points": cloud.points, **arrays, **cloud.attributes}, compressed)


def check_npz(cloud: Cloud) -> None:
    """Raise for an attribute that an archive cannot hold."""
    states = {
        _CRS: cloud.crs is not None,
        _METADATA: bool(metadata.storable(cloud.metadata)),
        _DEPTH: stated_depth(cloud.colors) is not None,
    }
    taken = _RESERVED | {key for key, is_stated in states.items() if is_stated}
    for key, values in cloud.attributes.items():
        leads_out = ".." in re.split(r"[/\\]", key) or key.startswith(("/", "\\"))
        if key in taken or not _is_name(key) or values.dtype.hasobject or leads_out:
            raise FormatError(f"attribute {key!r} of type {values.dtype}: rename or convert it")


def _is_name(key: str) -> bool:
    """Whether an archive can hold a name: one without NUL, and without half a character."""
    return "\0" not in key and key.encode(errors="replace") == key.encode(errors="surrogatepass")


def _write_arrays(stream: BinaryIO, arrays: Mapping[str, Array], compressed: bool) -> None:
    """Write arrays like ``numpy.savez``, which interprets some names as its own options."""
    method = zipfile.ZIP_DEFLATED if compressed else zipfile.ZIP_STORED
    archive = zipfile.ZipFile(stream, "w", method)
    try:
        for name, values in arrays.items():
            _write_array(archive, f"{name}.npy", np.asanyarray(values))
        archive.close()
    finally:
        archive.fp = None  # else, after an error, it would try again to finish the file


def _write_array(archive: zipfile.ZipFile, name: str, values: Array) -> None:
    member = archive.open(name, "w", force_zip64=True)
    try:
        npy.write_array(member, values, allow_pickle=False)
    except BaseException:
        # The stream may be closed already: one in memory is when it cannot grow.
        with suppress(OSError, ValueError):
            member.close()
        raise
    member.close()


def _check_layout(layout: Layout, name: str) -> None:
    """Raise where an array cannot be points, before any of its values is read."""
    if layout.dtype.names is None:
        _check_shape(layout.shape, name)
    shape = (0, *layout.shape[1:]) if layout.shape else ()
    _points_alone(layout.array(np.empty(0, np.uint8), shape, name), name)


def _points_alone(array: Array, name: str, first: int = 0) -> Cloud:
    if array.dtype.names is None:
        return Cloud(_points(array, name, first))
    types = {each: array.dtype[each] for each in array.dtype.names}
    numeric = all(each.kind in "biuf" for each in types.values())
    if array.ndim != 1 or not numeric or not {"x", "y"} <= types.keys():
        raise FormatError(f"{name}: a structured array needs numeric fields x and y: {array.dtype}")
    builder = CloudBuilder(types, len(array))
    builder.fill(slice(None), {each: array[each] for each in types})
    return builder.cloud()


def _check_shape(shape: tuple[int, ...], name: str) -> None:
    if len(shape) != 2 or shape[1] not in (2, 3):
        raise FormatError(
            f"{name}: the points have shape {shape}, not (n, 2) or (n, 3): save "
            "array[:, :3] as points, and further columns by name with numpy.savez"
        )


def _points(array: Array, name: str, first: int = 0) -> Floats:
    """Rows of three coordinates; ``first`` is the row of the file that the array begins with."""
    _check_shape(array.shape, name)
    try:
        return as_rows3(array)
    except InputError as error:
        counted = f" (rows counted from row {first} of the file)" if first else ""
        raise FormatError(f"{name}: the points cannot be used: {error}{counted}") from error


class _Shaped(Protocol):
    """An array, or the layout of one."""

    @property
    def shape(self) -> tuple[int, ...]: ...
    @property
    def dtype(self) -> np.dtype: ...


class _Roles:
    """Roles of the arrays of an archive: points, faces, attributes and so on."""

    def __init__(self, arrays: Mapping[str, _Shaped], name: str) -> None:
        self._name = name
        self._alone = len(arrays) == 1 and not arrays.keys() & set(_POINTS)
        self._points = self._key_of_points(arrays)
        shape = arrays[self._points].shape
        count = shape[0] if shape else 0
        self._faces = next((each for each in _FACES if each in arrays), None)
        self.crs, self.metadata = (
            key if key in arrays and _is_text(arrays[key]) else None for key in (_CRS, _METADATA)
        )
        self._edges = _EDGES if _EDGES in arrays and _are_edges(arrays[_EDGES]) else None
        self.depth = _DEPTH if _DEPTH in arrays and _is_count(arrays[_DEPTH]) else None
        self._check(arrays, "colors", (3, 4), count)
        self._check(arrays, "normals", (3,), count)
        known = {self._points, self._faces, self._edges, *self.scalars, "colors", "normals"}
        rest = {key: arrays[key].shape for key in arrays if key not in known}
        fits = {
            key: key not in _RESERVED and len(shape) > 0 and shape[0] == count
            for key, shape in rest.items()
        }
        self._attributes = [key for key in rest if fits[key]]
        self._skipped = tuple(f"{key} {shape}" for key, shape in rest.items() if not fits[key])
        special = [key for key in ("colors", "normals") if key in arrays and not self._alone]
        self.row_arrays = [self._points, *special, *self._attributes]

    def cloud(self, arrays: Mapping[str, Array], first: int = 0) -> Cloud:
        """Make a cloud of all arrays, or of their rows from ``first`` on."""
        if self._alone:
            return _points_alone(arrays[self._points], self._name, first)
        points = _points(arrays[self._points], self._name, first)
        faces = arrays.get(self._faces) if self._faces else None
        edges = arrays.get(self._edges) if self._edges else None
        return Cloud(
            points,
            colors=arrays.get("colors"),
            color_depth=self._stated_depth(arrays),
            normals=arrays.get("normals"),
            attributes={key: arrays[key] for key in self._attributes},
            faces=None if faces is None else checked_faces(faces, len(points), self._name),
            metadata=self._described(arrays),
            crs=None if self.crs is None else _crs(arrays[self.crs]),
            edges=None if edges is None else checked_edges(edges, len(points), self._name),
        )

    def _described(self, arrays: Mapping[str, Array]) -> dict[str, Any]:
        """Return the metadata that the archive states; a text that states none is skipped."""
        entries = None if self.metadata is None else metadata.parsed(str(arrays[self.metadata]))
        is_other = self.metadata is not None and entries is None
        skipped = (*self._skipped, *([f"{_METADATA} ()"] if is_other else []))
        return metadata.noted(entries or {}, not_read=skipped)

    def _stated_depth(self, arrays: Mapping[str, Array]) -> int | None:
        stated = None if self.depth is None else int(arrays[self.depth])
        return confirmed_depth(arrays.get("colors"), stated)

    @property
    def scalars(self) -> list[str]:
        """The arrays that hold a text or a number."""
        return [key for key in (self.crs, self.metadata, self.depth) if key is not None]

    def _key_of_points(self, arrays: Mapping[str, _Shaped]) -> str:
        if self._alone:
            return next(iter(arrays))
        key = next((each for each in _POINTS if each in arrays), None)
        if key is None:
            listed = shortened(", ".join(sorted(arrays))) or "none"
            raise FormatError(f"{self._name}: no array is named points: there are {listed}")
        return key

    def _check(
        self, arrays: Mapping[str, _Shaped], key: str, widths: tuple[int, ...], count: int
    ) -> None:
        if key not in arrays or self._alone:
            return
        shape, dtype = arrays[key].shape, arrays[key].dtype
        if len(shape) != 2 or shape[0] != count or shape[1] not in widths:
            raise FormatError(f"{self._name}: {key} have shape {shape} for {count} points")
        if dtype.kind not in "iuf":
            raise FormatError(f"{self._name}: {key} of type {dtype} are not numbers")


def _crs(array: Array) -> str | None:
    crs = str(array)
    return crs if is_crs(crs) else None


def _are_edges(array: _Shaped) -> bool:
    return len(array.shape) == 2 and array.shape[1] == 2 and array.dtype.kind in "iu"


def _is_count(array: _Shaped) -> bool:
    return array.shape == () and array.dtype == np.uint8


def _is_text(array: _Shaped) -> bool:
    return array.shape == () and array.dtype.kind == "U"
