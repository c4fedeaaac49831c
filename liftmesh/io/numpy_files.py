"""NumPy's own files: one array of points (NPY), or points with all that belongs to them (NPZ).

Nothing is unpickled: a file cannot run code.
"""

from __future__ import annotations

import io
import re
import zipfile
import zlib
from collections.abc import Mapping
from contextlib import suppress
from typing import BinaryIO

import numpy as np
from numpy.lib import format as npy

from liftmesh._typing import Array, Floats
from liftmesh.arrays import as_rows3
from liftmesh.cloud import Cloud
from liftmesh.errors import FormatError, InputError
from liftmesh.io.columns import Sheet
from liftmesh.io.faces import checked_faces
from liftmesh.io.format import Format
from liftmesh.io.npy_array import read_array
from liftmesh.io.streams import remaining
from liftmesh.io.text_tables import shortened

_POINTS = ("points", "vertices", "xyz")
_FACES = ("faces", "triangles")
_RESERVED = {*_POINTS, *_FACES, "colors", "normals"}

# Deflate shrinks nothing more than 1,032-fold.
_DENSEST = 1100

# What zipfile raises for files that are damaged, encrypted, or compressed in an unknown way.
_BROKEN = (
    zipfile.BadZipFile, zlib.error, EOFError, ValueError, OSError, NotImplementedError,
    RuntimeError, OverflowError,
)  # fmt: skip


def read_npy(stream: BinaryIO, name: str) -> Cloud:
    """Read points from an NPY file.

    Parameters
    ----------
    stream : binary stream
        Seekable, at the first byte of the file.
    name : str
        The file's name for messages.

    Returns
    -------
    Cloud
        Of an (n, 2) or (n, 3) array of numbers; of a structured array with fields x and y, all
        fields as if they were columns of a PLY file.

    Raises
    ------
    FormatError
        The file is broken, or the array is of another shape or type.
    """
    return _points_alone(read_array(stream, name), name)


def read_npz(stream: BinaryIO, name: str) -> Cloud:
    """Read a cloud or mesh from an NPZ file.

    Parameters
    ----------
    stream : binary stream
        Seekable, at the first byte of the file.
    name : str
        The file's name for messages.

    Returns
    -------
    Cloud
        ``points`` (or ``vertices``, or the only array there is) as float64; ``faces``, ``colors``
        and ``normals``; other arrays of n rows as attributes. Arrays that fit nowhere are named in
        ``metadata["skipped"]``.

    Raises
    ------
    FormatError
        The file is broken, or has no array of points.
    """
    arrays = _members(stream, name)
    key = next((each for each in _POINTS if each in arrays), None)
    if key is None and len(arrays) == 1:
        return _points_alone(next(iter(arrays.values())), name)
    if key is None:
        raise FormatError(f"{name}: no array is called points: there are {_listed(arrays)}")
    return _cloud(_points(arrays.pop(key), name), arrays, name)


def write_npz(stream: BinaryIO, cloud: Cloud, *, compressed: bool = False) -> None:
    """Write a cloud or mesh as NPZ: every array in its own type.

    Parameters
    ----------
    stream : binary stream
        Where to write.
    cloud : Cloud
        ``points``, and if it has them ``colors``, ``normals``, ``faces`` and each attribute by its
        name.
    compressed : bool
        Deflate the arrays.

    Raises
    ------
    FormatError
        An attribute has the name of one of these, or one that would be unpacked elsewhere, or holds
        Python objects.
    """
    parts = {"colors": cloud.colors, "normals": cloud.normals, "faces": cloud.faces}
    arrays = {key: values for key, values in parts.items() if values is not None}
    for key, values in cloud.attributes.items():
        leads_out = ".." in re.split(r"[/\\]", key) or key.startswith(("/", "\\"))
        if key in _RESERVED or values.dtype.hasobject or leads_out:
            raise FormatError(f"attribute {key!r} of type {values.dtype}: rename or convert it")
    _write_arrays(stream, {"points": cloud.points, **arrays, **cloud.attributes}, compressed)


def _write_arrays(stream: BinaryIO, arrays: Mapping[str, Array], compressed: bool) -> None:
    """Do what ``numpy.savez`` does, which takes some names for its own options."""
    method = zipfile.ZIP_DEFLATED if compressed else zipfile.ZIP_STORED
    archive = zipfile.ZipFile(stream, "w", method)
    try:
        for name, values in arrays.items():
            _write_array(archive, f"{name}.npy", np.asanyarray(values))
        archive.close()
    finally:
        archive.fp = None  # or it would still end the file, and complain of what is missing


def _write_array(archive: zipfile.ZipFile, name: str, values: Array) -> None:
    member = archive.open(name, "w", force_zip64=True)
    try:
        npy.write_array(member, values, allow_pickle=False)
    except BaseException:
        # The stream may be no more: one in memory that finds no room to grow is closed.
        with suppress(OSError, ValueError):
            member.close()
        raise
    member.close()


def _members(stream: BinaryIO, name: str) -> dict[str, Array]:
    try:
        size = remaining(stream)
        with zipfile.ZipFile(stream) as archive:
            members = [each for each in archive.infolist() if each.filename.endswith(".npy")]
            _check_sizes(members, size, name)
            return {
                each.filename.removesuffix(".npy"): _member(archive, each, name) for each in members
            }
    except FormatError:
        raise
    except _BROKEN as error:
        raise FormatError(f"{name}: not a whole NPZ file: {error}") from error


def _check_sizes(members: list[zipfile.ZipInfo], size: int, name: str) -> None:
    """Refuse sizes that lie, and members that share their bytes to become many times as large."""
    names: set[str] = set()
    for each in members:
        where = f"{name}: {shortened(each.filename)}"
        if each.file_size > _DENSEST * (each.compress_size + 1):
            raise FormatError(
                f"{where}: {each.file_size} bytes cannot come of {each.compress_size}"
            )
        size -= each.compress_size
        if size < 0:
            raise FormatError(f"{where}: the members hold more bytes than the file")
        if each.filename in names:
            raise FormatError(f"{where}: the file holds two arrays of this name")
        names.add(each.filename)


def _member(archive: zipfile.ZipFile, info: zipfile.ZipInfo, name: str) -> Array:
    where = f"{name}: {shortened(info.filename)}"
    return read_array(io.BytesIO(archive.read(info)), where)


def _listed(arrays: Mapping[str, Array]) -> str:
    return shortened(", ".join(sorted(arrays))) or "none"


def _points_alone(array: Array, name: str) -> Cloud:
    if array.dtype.names is None:
        return Cloud(_points(array, name))
    types = {each: array.dtype[each] for each in array.dtype.names}
    numeric = all(each.kind in "biuf" for each in types.values())
    if array.ndim != 1 or not numeric or not {"x", "y"} <= types.keys():
        raise FormatError(f"{name}: a structured array needs numeric fields x and y: {array.dtype}")
    sheet = Sheet(types, len(array))
    for each in types:
        sheet.columns[each][:] = array[each]
    return sheet.cloud(None, {})


def _points(array: Array, name: str) -> Floats:
    if array.ndim != 2 or array.shape[1] not in (2, 3):
        raise FormatError(
            f"{name}: the points have shape {array.shape}, not (n, 2) or (n, 3): save "
            "array[:, :3] as points, and further columns by name with numpy.savez"
        )
    try:
        return as_rows3(array)
    except InputError as error:
        raise FormatError(f"{name}: the points cannot be used: {error}") from error


def _cloud(points: Floats, arrays: Mapping[str, Array], name: str) -> Cloud:
    faces = next((arrays[each] for each in _FACES if each in arrays), None)
    rest = {key: values for key, values in arrays.items() if key not in _RESERVED}
    fitting = {key: v for key, v in rest.items() if v.ndim and len(v) == len(points)}
    skipped = tuple(f"{key} {v.shape}" for key, v in rest.items() if key not in fitting)
    return Cloud(
        points,
        colors=_rows(arrays, "colors", (3, 4), len(points), name),
        normals=_rows(arrays, "normals", (3,), len(points), name),
        attributes=fitting,
        faces=None if faces is None else checked_faces(faces, len(points), name),
        metadata={"skipped": skipped} if skipped else {},
    )


def _rows(
    arrays: Mapping[str, Array], key: str, widths: tuple[int, ...], rows: int, name: str
) -> Array | None:
    values = arrays.get(key)
    if values is None:
        return None
    if values.ndim != 2 or len(values) != rows or values.shape[1] not in widths:
        raise FormatError(f"{name}: {key} have shape {values.shape} for {rows} points")
    if values.dtype.kind not in "iuf":
        raise FormatError(f"{name}: {key} of type {values.dtype} are no numbers")
    return values


NPY = Format(
    name="npy",
    suffixes=(".npy",),
    read=read_npy,
    write=None,
    description="one NumPy array of points",
)

NPZ = Format(
    name="npz",
    suffixes=(".npz",),
    read=read_npz,
    write=write_npz,
    description="NumPy arrays by name: points, faces, colors, normals, attributes",
)
