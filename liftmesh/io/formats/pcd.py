"""PCD, the point clouds of PCL and Open3D: text, binary and compressed.

A header names the fields of a point, their types and how many values each has, in lines of a
keyword and its values, up to that of DATA; rows follow as text, as they are in memory, or
compressed, field by field. Colours are three bytes in the bits of one number, which is often a
float. Fields named ``_`` fill up rows.

The compression is LZF: a byte below 32 begins a run of so many bytes more one, copied as they are.
Any other begins a copy of what came before: three bits of length, or seven and a byte of more, and
thirteen of distance. A copy may reach into itself, which repeats it.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, BinaryIO

import numpy as np

from liftmesh._typing import Array, Floats
from liftmesh.base.cloud import Cloud
from liftmesh.errors import FormatError
from liftmesh.io.columns import NORMAL, POSITION, taken_points, taken_together, type_in_text
from liftmesh.io.options import check_columns, check_expanded, limit_of
from liftmesh.io.streams import read_exactly, remaining
from liftmesh.io.text_tables import (
    HASH,
    Lines,
    check_end,
    exact_values,
    is_count,
    is_number,
    number_table,
    promised,
    quoted,
)

_SIZES = struct.Struct("<II")
_NORMALS = ("normal_x", "normal_y", "normal_z")
_COLORS = ("rgb", "rgba")
_STRAIGHT = (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)

DENSEST = 264 / 3  # the longest copy, and the bytes that state it

_LONGEST = 1 << 19  # characters of a line
_KINDS = {"F": "f", "I": "i", "U": "u"}
_BYTES = {"F": (4, 8), "I": (1, 2, 4, 8), "U": (1, 2, 4, 8)}
_KNOWN = ("VERSION", "FIELDS", "COLUMNS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT", "VIEWPOINT",
          "POINTS", "DATA")  # fmt: skip
_DATA = ("ascii", "binary", "binary_compressed")


def read_pcd(stream: BinaryIO, name: str, *, max_bytes: int | None = None) -> Cloud:
    """Read a PCD file."""
    header = read_header(stream, name, max_bytes)
    if header.data == "ascii":
        columns = _text(stream, header, name)
    elif header.data == "binary":
        columns = _binary(stream, header, name)
    else:
        columns = _compressed(stream, header, name, max_bytes)
    return _cloud(columns, header, name)


@dataclass(frozen=True, slots=True)
class Field:
    """A field of a point: ``count`` values of a type."""

    name: str
    dtype: np.dtype
    count: int

    @property
    def size(self) -> int:
        """The bytes that it takes in a row."""
        return self.dtype.itemsize * self.count

    @property
    def layout(self) -> tuple[np.dtype, tuple[int, ...]]:
        """The type and shape of its values in a row."""
        return self.dtype, (self.count,) if self.count > 1 else ()


@dataclass(frozen=True, slots=True)
class Header:
    """What a header states; ``lines`` is its number of lines."""

    fields: tuple[Field, ...]
    points: int
    width: int
    height: int
    viewpoint: tuple[float, ...]
    data: str
    lines: int


def read_header(stream: BinaryIO, name: str, max_bytes: int | None) -> Header:
    """Read the header and leave the stream at the first byte of the points."""
    reading = _Reading(stream, name)
    lines = reading.lines_by_keyword()
    names = lines.get("FIELDS") or lines.get("COLUMNS") or []
    check_columns(len(names), max_bytes, name, f"a header of {len(names):,} fields")
    width, height = (_count(lines, key, name, 1) for key in ("WIDTH", "HEIGHT"))
    return Header(
        fields=_fields(lines, names, name),
        points=_count(lines, "POINTS", name, width * height),
        width=width,
        height=height,
        viewpoint=_viewpoint(lines, name),
        data=lines["DATA"][0].lower(),
        lines=reading.number,
    )


class _Reading:
    """Reads lines; ``number`` is the current one."""

    def __init__(self, stream: BinaryIO, name: str) -> None:
        self._stream = stream
        self._name = name
        self.number = 0

    def lines_by_keyword(self) -> dict[str, list[str]]:
        lines: dict[str, list[str]] = {}
        while "DATA" not in lines:
            keyword, values = self._line()
            if keyword in lines or keyword not in _KNOWN:
                raise self._error(f"unknown or repeated header line {quoted(keyword)}")
            lines[keyword] = values
        if len(lines["DATA"]) != 1 or lines["DATA"][0].lower() not in _DATA:
            raise self._error(f"unknown data {quoted(' '.join(lines['DATA']))}: known are {_DATA}")
        return lines

    def _line(self) -> tuple[str, list[str]]:
        """Return the keyword and the values of the next line that is no comment."""
        while raw := self._stream.readline(_LONGEST):
            self.number += 1
            text = raw.decode("latin-1").strip()
            if text and not text.startswith("#"):
                if not raw.endswith(b"\n"):
                    break
                keyword, *values = text.split()
                return keyword.upper(), values
        raise self._error("the header does not end: there is no complete DATA line")

    def _error(self, cause: str) -> FormatError:
        where = f"line {self.number}" if self.number > 1 else "not a PCD file"
        return FormatError(f"{self._name}: {where}: {cause}")


def _fields(lines: dict[str, list[str]], names: list[str], name: str) -> tuple[Field, ...]:
    listed = [lines.get(key, []) for key in ("SIZE", "TYPE")]
    counts = lines.get("COUNT") or ["1"] * len(names)
    if not names or any(len(each) != len(names) for each in (*listed, counts)):
        raise FormatError(f"{name}: SIZE, TYPE and COUNT need a value for each of the FIELDS")
    named = [each for each in names if each != "_"]
    if len({*named}) < len(named):
        raise FormatError(f"{name}: two fields of the header have one name")
    rows = zip(names, listed[0], listed[1], counts, strict=True)
    return tuple(_field(*row, name) for row in rows)


def _field(name: str, size: str, kind: str, count: str, file: str) -> Field:
    kind = kind.upper()
    is_known = size.isdigit() and kind in _BYTES and size in map(str, _BYTES[kind])
    if not is_known or not is_count(count, 9):
        raise FormatError(
            f"{file}: the field {quoted(name)} has the type {quoted(kind)}, the size "
            f"{quoted(size)} and the count {quoted(count)}: known are F of 4 or 8 bytes, I and U "
            "of 1, 2, 4 or 8"
        )
    if not int(count):
        raise FormatError(f"{file}: the field {quoted(name)} has no values")
    return Field(name, np.dtype(f"<{_KINDS[kind]}{size}"), int(count))


def _count(lines: dict[str, list[str]], key: str, name: str, usual: int) -> int:
    values = lines.get(key, [str(usual)])
    text = values[0] if len(values) == 1 else ""
    if not is_count(text):
        raise FormatError(f"{name}: {key} is {quoted(' '.join(values))}: expected a count")
    return int(text)


def _viewpoint(lines: dict[str, list[str]], name: str) -> tuple[float, ...]:
    values: Any = lines.get("VIEWPOINT", ["0", "0", "0", "1", "0", "0", "0"])
    if len(values) != 7 or not all(map(is_number, values)):
        raise FormatError(f"{name}: VIEWPOINT is {quoted(' '.join(values))}: expected 7 numbers")
    return tuple(map(float, values))


def _text(stream: BinaryIO, header: Header, name: str) -> dict[str, Array]:
    lines = Lines(stream, name, HASH, before=header.lines)
    width = sum(each.count for each in header.fields)
    parts: list[dict[str, Array]] = []
    for block in promised(lines, header.points, "points", name):
        table = number_table(block, name, width=width)
        parts.append(_columns_of(table, header, name, block.numbers))
    check_end(lines, name)
    if not parts:
        return _empty(header)
    return {key: np.concatenate([each[key] for each in parts]) for key in parts[0]}


def _columns_of(table: Floats, header: Header, name: str, lines: Array) -> dict[str, Array]:
    columns: dict[str, Array] = {}
    start = 0
    for each in header.fields:
        values = table[:, start : start + each.count]
        start += each.count
        if each.name == "_":
            continue
        if each.name in _COLORS and each.count == 1:
            columns[each.name] = _packed(values[:, 0], each, name, lines)
            continue
        flat = exact_values(
            values.reshape(-1),
            type_in_text(each.name, each.dtype),
            name,
            each.name,
            lambda k, width=each.count: int(lines[k // width]),  # type: ignore[misc]
        )
        columns[each.name] = flat.reshape(values.shape) if each.count > 1 else flat
    return columns


def _packed(values: Floats, field: Field, name: str, lines: Array) -> Array:
    """Colours in the bits of a number: a float as text, or a whole number even so."""
    if np.isnan(values).any():
        return values  # all that is left of some colours: they stay numbers
    is_float = field.dtype.kind == "f"
    if is_float and not np.all((values >= 1) & (values < 2.0**32) & (values == np.rint(values))):
        return values.astype(np.float32)
    dtype = np.dtype(np.uint32) if is_float else field.dtype
    return exact_values(values, dtype, name, field.name, lambda k: int(lines[k]))


def _binary(stream: BinaryIO, header: Header, name: str) -> dict[str, Array]:
    begin, size = stream.tell(), sum(each.size for each in header.fields)
    data = read_exactly(stream, header.points * size, name, "the points")
    if remaining(stream) >= size:
        raise FormatError(
            f"{name}: byte {begin + len(data)}: more rows follow than the header promises: "
            "correct its counts"
        )
    if not header.points:
        return _empty(header)
    rows = np.frombuffer(data, [(f"{k}", *each.layout) for k, each in enumerate(header.fields)])
    return {each.name: rows[f"{k}"] for k, each in enumerate(header.fields) if each.name != "_"}


def _compressed(
    stream: BinaryIO, header: Header, name: str, max_bytes: int | None
) -> dict[str, Array]:
    begin = stream.tell()
    small, size = _SIZES.unpack(read_exactly(stream, _SIZES.size, name, "two sizes"))
    needed = header.points * sum(each.size for each in header.fields)
    if size != needed:
        raise FormatError(
            f"{name}: byte {begin}: the compressed points state {size} bytes, but the header "
            f"{needed}"
        )
    limit = limit_of(max_bytes, int(DENSEST * min(small, remaining(stream))))
    check_expanded(size, limit, name, "its compressed data")
    packed = read_exactly(stream, small, name, "the compressed points")
    try:
        data = decompress(packed, size)
    except ValueError as error:
        raise FormatError(f"{name}: byte {begin}: {error}") from error
    return _field_by_field(data, header)


def decompress(data: bytes, size: int) -> bytes:
    """Decompress to ``size`` bytes."""
    out = bytearray()
    place, end = 0, len(data)
    try:
        while place < end and len(out) <= size:
            control = data[place]
            place += 1
            if control < 32:
                out += data[place : place + control + 1]
                place += control + 1
                continue
            length = control >> 5
            if length == 7:
                length += data[place]
                place += 1
            _copy(out, ((control & 31) << 8) + data[place] + 1, length + 2)
            place += 1
    except IndexError as error:
        raise ValueError("the compressed data end within a copy") from error
    if len(out) != size or place != end:
        raise ValueError(f"the compressed data do not expand to {size} bytes")
    return bytes(out)


def _copy(out: bytearray, distance: int, length: int) -> None:
    begin = len(out) - distance
    if begin < 0:
        raise ValueError("the compressed data refer to what is not there")
    if length <= distance:
        out += out[begin : begin + length]
    else:
        out += (bytes(out[begin:]) * (length // distance + 1))[:length]


def _field_by_field(data: bytes, header: Header) -> dict[str, Array]:
    columns: dict[str, Array] = {}
    start = 0
    for each in header.fields:
        values = np.frombuffer(data, each.dtype, header.points * each.count, start)
        start += values.nbytes
        if each.name != "_":
            columns[each.name] = values.reshape(-1, each.count) if each.count > 1 else values
    return columns


def _empty(header: Header) -> dict[str, Array]:
    named = (each for each in header.fields if each.name != "_")
    return {each.name: np.empty((0, *each.layout[1]), each.dtype) for each in named}


def _cloud(columns: dict[str, Array], header: Header, name: str) -> Cloud:
    shaped = (columns[each].ndim for each in POSITION if each in columns)
    if not {"x", "y"} <= columns.keys() or any(dimensions > 1 for dimensions in shaped):
        raise FormatError(f"{name}: the header has no fields x and y of one value")
    points = taken_points(columns, header.points)
    colors = _colors(columns)
    return Cloud(
        points,
        colors=colors,
        normals=_normals(columns),
        attributes={key: _native(values) for key, values in columns.items()},
        metadata=_described(header),
    )


def _normals(columns: dict[str, Array]) -> Array | None:
    for names in (_NORMALS, NORMAL):
        if (normals := taken_together(columns, names)) is not None:
            return _native(normals)
    return None


def _colors(columns: dict[str, Array]) -> Array | None:
    """Remove and return the colours that are packed into the bits of a number."""
    key = next((each for each in _COLORS if each in columns), None)
    if key is None or columns[key].ndim != 1 or columns[key].dtype.itemsize != 4:
        return None
    bits = np.ascontiguousarray(columns.pop(key)).view("<u4")
    shifts = (16, 8, 0, 24) if key == "rgba" else (16, 8, 0)
    return np.stack([(bits >> shift).astype(np.uint8) for shift in shifts], axis=1)


def _native(values: Array) -> Array:
    return np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("="))


def _described(header: Header) -> Mapping[str, Any]:
    entries: dict[str, Any] = {}
    if header.viewpoint != _STRAIGHT:
        entries["viewpoint"] = header.viewpoint
    if header.height > 1 and header.width * header.height == header.points:
        entries["grid"] = (header.width, header.height)
    return entries
