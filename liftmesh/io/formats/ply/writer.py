"""PLY writer: exact doubles, every attribute, and the same bytes every time.

Of PLY's eight types, readers in wide use agree on uint8, uint16, int32, float and double only: one
skips int8, int16 and uint32, another cannot open a file with int16, and 64-bit integers are not
part of the format. So values keep their type if it is one of these five, and are otherwise written
in the smallest of them that holds every value exactly.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np

from liftmesh._typing import Array
from liftmesh.base.colors import as_uint8
from liftmesh.base.options import PlyColors, PlyEncoding, check_option
from liftmesh.errors import FormatError
from liftmesh.io.columns import ALPHA, COLOR, NORMAL, POSITION, edges_of
from liftmesh.io.formats.ply.header import (
    EDGE,
    LONGEST_LINE,
    depth_statement,
    name_statements,
    property_names,
)
from liftmesh.io.metadata import header_comments, plain_lines, storable
from liftmesh.io.text_tables import shortened, write_rows

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud


_ENCODINGS = {"binary": "binary_little_endian", "ascii": "ascii"}
_ROWS = 1 << 13  # a block that fits in the cache of one core


def write_ply(
    stream: BinaryIO,
    cloud: Cloud,
    *,
    encoding: PlyEncoding = "binary",
    colors: PlyColors = "uint8",
    comments: Sequence[str] = (),
) -> None:
    """Write a cloud, or a mesh, as PLY."""
    check_option("encoding", encoding, PlyEncoding)
    check_option("colors", colors, PlyColors)
    columns = _columns(cloud, exact=colors == "exact")
    numeric = _numeric(cloud.attributes)
    names = property_names(_names(numeric), columns)
    attributes = scalar_columns(numeric)
    columns |= {names[name]: values for name, values in attributes.items()}
    depth = depth_statement(cloud.colors if colors == "exact" else None)
    lines = _comments(cloud, [*depth, *name_statements(names)], comments)
    stream.write(_header(cloud, columns, _ENCODINGS[encoding], lines))
    if encoding == "ascii":
        _write_text(stream, cloud, columns)
    else:
        _write_binary(stream, cloud, columns)


def check_ply(cloud: Cloud) -> None:
    """Raise for what PLY cannot hold of a cloud."""
    numeric = _numeric(cloud.attributes)
    _names(numeric)
    scalar_columns(numeric)
    if cloud.normals is not None:
        portable(cloud.normals, "normals")


def _columns(cloud: Cloud, *, exact: bool) -> dict[str, Array]:
    columns = dict(zip(POSITION, cloud.points.T, strict=True))
    if cloud.normals is not None:
        columns |= zip(NORMAL, portable(cloud.normals, "normals").T, strict=True)
    if cloud.colors is not None:
        color = _exact_colors(cloud.colors) if exact else as_uint8(cloud.colors)
        columns |= zip((*COLOR, ALPHA), color.T, strict=False)
    return columns


def renamed_properties(cloud: Cloud) -> dict[str, str]:
    """Return the property of each attribute whose name PLY cannot hold."""
    properties = property_names(_names(_numeric(cloud.attributes)), _columns_of(cloud))
    return {name: new for name, new in properties.items() if name != new}


def _columns_of(cloud: Cloud) -> list[str]:
    """The properties of coordinates, normals and colours."""
    channels = 0 if cloud.colors is None else cloud.colors.shape[1]
    normals = () if cloud.normals is None else NORMAL
    return [*POSITION, *normals, *(*COLOR, ALPHA)[:channels]]


def _exact_colors(colors: Array) -> Array:
    """Colours in their own type: wider integers would come back with another full scale."""
    if colors.dtype.kind == "u" and colors.dtype.itemsize > 2:
        raise FormatError(
            f"colors of type {colors.dtype} cannot be written exactly as PLY: convert them to "
            "uint16 or to floats in [0, 1]"
        )
    return portable(colors, "colors")


def _header(
    cloud: Cloud, columns: dict[str, Array], encoding: str, comments: Iterable[str]
) -> bytes:
    lines = ["ply", f"format {encoding} 1.0", *comments]
    lines.append(f"element vertex {len(cloud)}")
    lines += [f"property {PORTABLE[v.dtype.str[1:]]} {name}" for name, v in columns.items()]
    if cloud.faces is not None:
        lines.append(f"element face {len(cloud.faces)}")
        lines.append("property list uchar int vertex_indices")
    if len(edges := edges_of(cloud)):
        lines.append(f"element edge {len(edges)}")
        lines += [f"property int {end}" for end in EDGE]
    return "\n".join([*lines, "end_header", ""]).encode("ascii")


def _comments(cloud: Cloud, stated: list[str], comments: Sequence[str]) -> Iterator[str]:
    entries = storable(cloud.metadata)
    infos = plain_lines(entries, "obj_info")
    for comment in header_comments(cloud.crs, entries, comments, stated):
        if not comment.isascii() or not comment.isprintable():
            raise FormatError(f"comment {comment!r} is not one line of ASCII, as PLY requires")
        if len(comment) > LONGEST_LINE // 2:
            raise FormatError(
                f"comment {shortened(comment)!r} has {len(comment):,} characters: a line of a PLY "
                f"header has at most {LONGEST_LINE // 2:,} here"
            )
        yield f"comment {comment}"
    yield from (f"obj_info {line}" for line in infos)


def _write_text(stream: BinaryIO, cloud: Cloud, columns: dict[str, Array]) -> None:
    write_rows(stream, [*columns.values()])
    if cloud.faces is not None:
        write_rows(stream, [cloud.faces], prefix="3 ")
    if len(edges := edges_of(cloud)):
        write_rows(stream, [edges])


def _write_binary(stream: BinaryIO, cloud: Cloud, columns: dict[str, Array]) -> None:
    """Interleave columns block by block, without a second copy of the mesh in memory."""
    little = [(name, values.dtype.newbyteorder("<")) for name, values in columns.items()]
    block = np.empty(min(len(cloud), _ROWS), np.dtype(little))
    for start in range(0, len(cloud), _ROWS):
        part = block[: len(cloud) - start]
        for name, values in columns.items():
            part[name] = values[start : start + len(part)]
        stream.write(part.tobytes())
    if cloud.faces is not None:
        _write_triangles(stream, cloud.faces)
    stream.write(edges_of(cloud).astype("<i4").tobytes())


def _write_triangles(stream: BinaryIO, faces: Array) -> None:
    block = np.empty(min(len(faces), _ROWS), [("size", "u1"), ("corners", "V12")])
    block["size"] = 3
    for start in range(0, len(faces), _ROWS):
        corners = np.ascontiguousarray(faces[start : start + _ROWS], dtype="<i4")
        part = block[: len(corners)]
        part["corners"] = corners.view("V12")[:, 0]  # copying single items is fastest
        stream.write(part.tobytes())


PORTABLE = {"u1": "uint8", "u2": "uint16", "i4": "int32", "f4": "float", "f8": "double"}

_WIDER = {"b1": "u1", "i1": "i4", "i2": "i4", "f2": "f4"}
_EXACT = 1 << 53


def portable(values: Array, what: str) -> Array:
    """Convert an array, if necessary, to a portable type that holds every value."""
    code = values.dtype.str[1:]
    if code in PORTABLE:
        return values
    if code in _WIDER:
        return values.astype(_WIDER[code])
    if values.dtype.kind in "iu":
        return _integers(values, what)
    converted = values.astype(np.float64) if values.dtype.kind == "f" else values
    if values.dtype.kind != "f" or not np.array_equal(converted, values, equal_nan=True):
        raise FormatError(f"{what} of type {values.dtype} cannot be written as PLY: convert it")
    return converted


def _integers(values: Array, what: str) -> Array:
    low, high = (int(values.min()), int(values.max())) if values.size else (0, 0)
    limits = np.iinfo(np.int32)
    if limits.min <= low and high <= limits.max:
        return values.astype(np.int32)
    if low >= -_EXACT and high <= _EXACT:
        return values.astype(np.float64)
    raise FormatError(
        f"{what} ranges from {low} to {high}: PLY has no type for integers beyond 2**53; "
        "write NPZ, or split it in two"
    )


def scalar_columns(attributes: Mapping[str, Array]) -> dict[str, Array]:
    """Split (n, k) attributes into columns name_0, name_1 and so on."""
    columns: dict[str, Array] = {}
    for name, values in attributes.items():
        flat = portable(values.reshape(len(values), _width(name, values)), f"attribute {name!r}")
        columns |= zip(_split(name, values), flat.T, strict=True)
    return columns


def _numeric(attributes: Mapping[str, Array]) -> dict[str, Array]:
    """The attributes that are numbers: PLY holds no others."""
    return {name: values for name, values in attributes.items() if values.dtype.kind in "biuf"}


def not_numeric(attributes: Mapping[str, Array]) -> list[str]:
    """Name the attributes that PLY leaves out: texts, dates, complex numbers, Python's objects."""
    return sorted(attributes.keys() - _numeric(attributes).keys())


def _width(name: str, values: Array) -> int:
    width = math.prod(values.shape[1:])  # reshape cannot infer it without rows
    if not width:
        raise FormatError(f"attribute {name!r} has the shape {values.shape}: it has no values")
    return width


def _split(name: str, values: Array) -> list[str]:
    """Name the columns of an attribute."""
    return [name] if values.ndim == 1 else [f"{name}_{k}" for k in range(_width(name, values))]


def _names(attributes: Mapping[str, Array]) -> list[str]:
    """Name the columns of all attributes."""
    names = Counter(each for name, values in attributes.items() for each in _split(name, values))
    twice = next((name for name, count in names.items() if count > 1), None)
    if twice is not None:
        raise FormatError(f"two attributes are named {twice!r}: rename one")
    return [*names]


def dropped_parts(cloud: Cloud, options: Mapping[str, Any]) -> tuple[str, ...]:
    """Attributes that are not numbers; colours beyond 8 bits unless they are written exactly."""
    names = (f"{name} (not numbers)" for name in not_numeric(cloud.attributes))
    return (*names, *(() if options.get("colors") == "exact" else ("deep_colors",)))
