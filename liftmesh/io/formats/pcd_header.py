"""The header of a PCD file: lines of a keyword and its values, up to that of DATA."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, BinaryIO

import numpy as np

from liftmesh.errors import FormatError
from liftmesh.io.limits import check_columns
from liftmesh.io.text_tables import is_number, quoted

_LONGEST = 1 << 19  # characters of a line
_KINDS = {"F": "f", "I": "i", "U": "u"}
_BYTES = {"F": (4, 8), "I": (1, 2, 4, 8), "U": (1, 2, 4, 8)}
_KNOWN = ("VERSION", "FIELDS", "COLUMNS", "SIZE", "TYPE", "COUNT", "WIDTH", "HEIGHT", "VIEWPOINT",
          "POINTS", "DATA")  # fmt: skip
_DATA = ("ascii", "binary", "binary_compressed")


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
    found = reading.lines_by_keyword()
    names = found.get("FIELDS") or found.get("COLUMNS") or []
    check_columns(len(names), max_bytes, name, f"a header of {len(names):,} fields")
    width, height = (_count(found, key, name, 1) for key in ("WIDTH", "HEIGHT"))
    return Header(
        fields=_fields(found, names, name),
        points=_count(found, "POINTS", name, width * height),
        width=width,
        height=height,
        viewpoint=_viewpoint(found, name),
        data=found["DATA"][0].lower(),
        lines=reading.number,
    )


class _Reading:
    """Reads lines; ``number`` is the current one."""

    def __init__(self, stream: BinaryIO, name: str) -> None:
        self._stream = stream
        self._name = name
        self.number = 0

    def lines_by_keyword(self) -> dict[str, list[str]]:
        found: dict[str, list[str]] = {}
        while "DATA" not in found:
            keyword, values = self._line()
            if keyword in found or keyword not in _KNOWN:
                raise self._error(f"unknown or repeated header line {quoted(keyword)}")
            found[keyword] = values
        if len(found["DATA"]) != 1 or found["DATA"][0].lower() not in _DATA:
            raise self._error(f"unknown data {quoted(' '.join(found['DATA']))}: known are {_DATA}")
        return found

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


def _fields(found: dict[str, list[str]], names: list[str], name: str) -> tuple[Field, ...]:
    listed = [found.get(key, []) for key in ("SIZE", "TYPE")]
    counts = found.get("COUNT") or ["1"] * len(names)
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
    if not is_known or not (count.isascii() and count.isdigit() and 0 < len(count) < 10):
        raise FormatError(
            f"{file}: the field {quoted(name)} has the type {quoted(kind)}, the size "
            f"{quoted(size)} and the count {quoted(count)}: known are F of 4 or 8 bytes, I and U "
            "of 1, 2, 4 or 8"
        )
    if not int(count):
        raise FormatError(f"{file}: the field {quoted(name)} has no values")
    return Field(name, np.dtype(f"<{_KINDS[kind]}{size}"), int(count))


def _count(found: dict[str, list[str]], key: str, name: str, usual: int) -> int:
    values = found.get(key, [str(usual)])
    text = values[0] if len(values) == 1 else ""
    if not (text.isascii() and text.isdigit() and len(text) < 19):
        raise FormatError(f"{name}: {key} is {quoted(' '.join(values))}: expected a count")
    return int(text)


def _viewpoint(found: dict[str, list[str]], name: str) -> tuple[float, ...]:
    values: Any = found.get("VIEWPOINT", ["0", "0", "0", "1", "0", "0", "0"])
    if len(values) != 7 or not all(map(is_number, values)):
        raise FormatError(f"{name}: VIEWPOINT is {quoted(' '.join(values))}: expected 7 numbers")
    return tuple(map(float, values))
