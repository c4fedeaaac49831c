"""Cloud to PLY: doubles bit for bit, every attribute, the same bytes every time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, BinaryIO

import numpy as np

from liftmesh._typing import Array
from liftmesh.errors import FormatError
from liftmesh.io.columns import ALPHA, COLOR, NORMAL, POSITION
from liftmesh.io.digits import write_rows
from liftmesh.io.file_colors import eight_bit
from liftmesh.io.ply.portable import PORTABLE, portable, scalar_columns

if TYPE_CHECKING:
    from liftmesh.cloud import Cloud


_ENCODINGS = {"binary": "binary_little_endian", "ascii": "ascii"}
_COLORS = ("uint8", "exact")
_ROWS = 1 << 13  # a block that stays in the cache of one core


def write_ply(
    stream: BinaryIO,
    cloud: Cloud,
    *,
    encoding: str = "binary",
    colors: str = "uint8",
    comments: Sequence[str] = (),
) -> None:
    """Write a cloud, or a mesh, as PLY.

    Parameters
    ----------
    stream : binary stream
        Where to write.
    cloud : Cloud
        Coordinates are written as double. Attributes keep the types uint8, uint16, int32, float and
        double, and are written in the smallest of these that holds their values otherwise; an
        (n, k) attribute becomes properties name_0 to name_{k-1}.
    encoding : {"binary", "ascii"}
        Little-endian binary, or text of the digits that bring every value back.
    colors : {"uint8", "exact"}
        ``"uint8"`` rounds colours to eight bits, all that PLY readers in wide use understand;
        it loses nothing of colours that came from eight bits. ``"exact"`` keeps their type.
    comments : sequence of str
        Lines for the header: provenance, licence, coordinate system.

    Raises
    ------
    FormatError
        An option, an attribute or a colour cannot be written.
    """
    if encoding not in _ENCODINGS or colors not in _COLORS:
        raise FormatError(
            f"encoding={encoding!r}, colors={colors!r}: "
            f"encoding is one of {[*_ENCODINGS]}, colors one of {[*_COLORS]}"
        )
    columns = _columns(cloud, exact=colors == "exact")
    stream.write(_header(cloud, columns, _ENCODINGS[encoding], comments))
    if encoding == "ascii":
        _write_text(stream, cloud, columns)
    else:
        _write_binary(stream, cloud, columns)


def _columns(cloud: Cloud, *, exact: bool) -> dict[str, Array]:
    columns = dict(zip(POSITION, cloud.points.T, strict=True))
    if cloud.normals is not None:
        columns |= zip(NORMAL, portable(cloud.normals, "normals").T, strict=True)
    if cloud.colors is not None:
        color = portable(cloud.colors, "colors") if exact else eight_bit(cloud.colors)
        columns |= zip((*COLOR, ALPHA), color.T, strict=False)
    attributes = scalar_columns(cloud.attributes)
    taken = columns.keys() & attributes.keys()
    if taken:
        raise FormatError(f"attribute {min(taken)!r} has the name of a column of PLY: rename it")
    return columns | attributes


def _header(
    cloud: Cloud, columns: dict[str, Array], encoding: str, comments: Sequence[str]
) -> bytes:
    lines = ["ply", f"format {encoding} 1.0", *_remarks(comments)]
    lines.append(f"element vertex {len(cloud)}")
    lines += [f"property {PORTABLE[v.dtype.str[1:]]} {name}" for name, v in columns.items()]
    if cloud.faces is not None:
        lines.append(f"element face {len(cloud.faces)}")
        lines.append("property list uchar int vertex_indices")
    return "\n".join([*lines, "end_header", ""]).encode("ascii")


def _remarks(comments: Sequence[str]) -> Iterator[str]:
    yield "comment liftmesh"
    for comment in [comments] if isinstance(comments, str) else comments:
        if not comment.isascii() or not comment.isprintable():
            raise FormatError(f"comment {comment!r} cannot stand in a PLY header: one line, ASCII")
        yield f"comment {comment}"


def _write_text(stream: BinaryIO, cloud: Cloud, columns: dict[str, Array]) -> None:
    write_rows(stream, [*columns.values()])
    if cloud.faces is not None:
        write_rows(stream, [cloud.faces], prefix="3 ")


def _write_binary(stream: BinaryIO, cloud: Cloud, columns: dict[str, Array]) -> None:
    """Interleave columns block by block: the mesh is never in memory a second time."""
    little = [(name, values.dtype.newbyteorder("<")) for name, values in columns.items()]
    block = np.empty(min(len(cloud), _ROWS), np.dtype(little))
    for start in range(0, len(cloud), _ROWS):
        part = block[: len(cloud) - start]
        for name, values in columns.items():
            part[name] = values[start : start + len(part)]
        stream.write(part.tobytes())
    if cloud.faces is not None:
        _write_triangles(stream, cloud.faces)


def _write_triangles(stream: BinaryIO, faces: Array) -> None:
    block = np.empty(min(len(faces), _ROWS), [("size", "u1"), ("corners", "V12")])
    block["size"] = 3
    for start in range(0, len(faces), _ROWS):
        corners = np.ascontiguousarray(faces[start : start + _ROWS], dtype="<i4")
        part = block[: len(corners)]
        part["corners"] = corners.view("V12")[:, 0]  # as one item, which copies fastest
        stream.write(part.tobytes())
