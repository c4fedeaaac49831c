"""The properties that must hold for any bytes given to a reader.

A reader returns a cloud or raises a FormatError whose message begins with the file's name; no other
exception may escape. A cloud that was read is consistent, and survives a round trip bit for bit:
as PLY in both encodings, and as OBJ and CSV as far as these can represent it. Only the payload of a
NaN does not survive a text format. Read in chunks, it has the same rows.
"""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from files import BESIDE, PLACE, stream_of
from numpy.typing import NDArray

from liftmesh import Cloud, FormatError, InputError, read, read_chunks, write

Array = NDArray[Any]


class FindError(AssertionError):
    """A property does not hold."""


def outcome(data: bytes, kind: str) -> Cloud | str:
    """Read bytes and check the properties; return the cloud, or the message of the error."""
    try:
        cloud = read(stream_of(data, kind), format=kind)
    except FormatError as error:
        message = str(error)
        name = PLACE if kind in BESIDE else "<stream>"
        demand(message.startswith(f"{name}: "), f"the message names no file: {message}")
        return message
    _check_consistent(cloud)
    _check_ply(cloud, encoding="binary")
    _check_ply(cloud, encoding="ascii")
    _check_obj(cloud)
    _check_csv(cloud)
    _check_chunks(cloud, data, kind)
    return cloud


def demand(condition: bool, what: str) -> None:
    """Raise a FindError unless the condition holds."""
    if not condition:
        raise FindError(what)


def _check_consistent(cloud: Cloud) -> None:
    demand(cloud.points.dtype == np.float64, "points are not float64")
    faces = cloud.faces
    if faces is not None and faces.size:
        demand(faces.dtype == np.int32 and faces.shape[1] == 3, "faces are not triples of int32")
        demand(faces.min() >= 0 and faces.max() < len(cloud), "a face refers to no vertex")


def _check_chunks(cloud: Cloud, data: bytes, kind: str) -> None:
    start = 0
    for chunk in read_chunks(stream_of(data, kind), rows=2, format=kind):
        part = cloud.select(slice(start, start + len(chunk)))
        demand(_same_bits(chunk.points, part.points), "chunks change points")
        _compare(chunk, part, ("colors", "normals"), "reading in chunks")
        demand([*chunk.attributes] == [*part.attributes], "chunks rename attributes")
        for name, values in part.attributes.items():
            demand(_same_bits(chunk.attributes[name], values), f"chunks change {name!r}")
        start += len(chunk)
    demand(start == len(cloud), f"chunks have {start} rows of {len(cloud)}")


def _check_ply(cloud: Cloud, *, encoding: str) -> None:
    back = _rewritten(cloud, "ply", encoding=encoding, colors="exact")
    if back is None:
        return
    same = _same_bits if encoding == "binary" else _same_values
    demand(same(back.points, cloud.points), f"PLY ({encoding}) changes points")
    _compare(back, cloud, ("colors", "normals", "faces"), f"PLY ({encoding})")
    demand([*back.attributes] == _columns(cloud), f"PLY ({encoding}) renames attributes")
    for name, values in cloud.attributes.items():
        if values.ndim == 1:
            kept = _same_values(back.attributes[name], values)
            demand(kept, f"PLY ({encoding}) changes attribute {name!r}")


def _columns(cloud: Cloud) -> list[str]:
    """Return the names of the columns that attributes become: several for an array of vectors."""
    return [
        column
        for name, values in cloud.attributes.items()
        if values.dtype.kind in "biuf"
        for column in (
            [name] if values.ndim == 1 else [f"{name}_{k}" for k in range(values.shape[1])]
        )
    ]


def _check_obj(cloud: Cloud) -> None:
    back = _rewritten(cloud, "obj")
    if back is None:
        return
    demand(_same_values(back.points, cloud.points), "OBJ changes points")
    names = ("normals", "faces") if _has_wide_colors(cloud) else ("colors", "normals", "faces")
    _compare(back, cloud, names, "OBJ")


READ_BACK: dict[str, dict[str, Any]] = {"csv": {"nodata": "none"}}
"""Options with which a format reads any values that it wrote: -9999 and the like among them."""


def _check_csv(cloud: Cloud) -> None:
    back = _rewritten(cloud, "csv")
    if back is None:
        return
    demand(_same_values(back.points, cloud.points), "CSV changes points")
    names = ("normals",) if _has_wide_colors(cloud) else ("colors", "normals")
    _compare(back, cloud, names, "CSV")
    demand([*back.attributes] == _columns(cloud), "CSV renames attributes")
    for name, values in cloud.attributes.items():
        if values.ndim == 1:
            with np.errstate(invalid="ignore"):  # of signalling NaNs in single precision
                kept = _same_values(back.attributes[name], values.astype(np.float64))
            demand(kept, f"CSV changes attribute {name!r}")


def _has_wide_colors(cloud: Cloud) -> bool:
    """Whether OBJ, which stores three floats, changes the form of the colours."""
    colors = cloud.colors
    return colors is not None and (colors.dtype != np.uint8 or colors.shape[1] != 3)


def _rewritten(cloud: Cloud, kind: str, **options: Any) -> Cloud | None:
    """Write and read back; return None if the format cannot represent the cloud."""
    stream = io.BytesIO()
    try:
        write(stream, cloud, format=kind, **options)
    except (FormatError, InputError):  # InputError: colours outside their range
        return None
    stream.seek(0)
    try:
        return read(stream, format=kind, **READ_BACK.get(kind, {}))
    except FormatError as error:
        raise FindError(f"{kind} that was written cannot be read: {error}") from error


def _compare(back: Cloud, cloud: Cloud, names: tuple[str, ...], what: str) -> None:
    for name in names:
        ours, theirs = getattr(back, name), getattr(cloud, name)
        if name == "faces":  # an empty list of faces and no list are the same
            ours, theirs = (None if a is None or not len(a) else a for a in (ours, theirs))
        demand((ours is None) == (theirs is None), f"{what} loses or invents {name}")
        if ours is not None:  # text read as doubles: round to the original's precision
            demand(_same_values(ours.astype(theirs.dtype), theirs), f"{what} changes {name}")


def _same_bits(a: Array, b: Array) -> bool:
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()


def _same_values(a: Array, b: Array) -> bool:
    """Equal as numbers, including signs of zeros; NaNs are equal whatever their payload."""
    if a.dtype.kind != "f" or b.dtype.kind != "f":
        return np.array_equal(a, b)
    signs = np.isnan(a) | (np.signbit(a) == np.signbit(b))
    return np.array_equal(a, b, equal_nan=True) and bool(np.all(signs))
