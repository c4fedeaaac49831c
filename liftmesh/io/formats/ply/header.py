"""The header of a PLY file: its encoding, elements and properties.

The format is Greg Turk's "The PLY Polygon File Format" (1994): a text header lists elements
(vertex, face, and any other), each with a count and named properties; a property is a scalar, or a
list whose length precedes it in every row. Both families of type names are in use, Turk's own
(uchar, float) and the explicit ones (uint8, float32).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import BinaryIO

import numpy as np

from liftmesh.errors import FormatError
from liftmesh.io.limits import check_columns, most_columns
from liftmesh.io.text_tables import quoted

# The last three rows are not part of the format, but other programs write them.
TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1",
    "short": "i2", "int16": "i2", "ushort": "u2", "uint16": "u2",
    "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
    "int64": "i8", "long": "i8",
    "uint64": "u8", "ulong": "u8",
    "float16": "f2",
}  # fmt: skip

# The byte order of each encoding; text has none.
ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}

LONGEST_LINE = 1 << 16


@dataclass(frozen=True, slots=True)
class Property:
    """A named value of each row; a list if ``length``, the type of the list's length, is set."""

    name: str
    dtype: np.dtype
    length: np.dtype | None = None


@dataclass(frozen=True, slots=True)
class Element:
    """A table of ``rows`` rows."""

    name: str
    rows: int
    properties: tuple[Property, ...] = ()

    @property
    def is_table(self) -> bool:
        """Whether every row has the same shape: no property is a list."""
        return all(each.length is None for each in self.properties)


@dataclass(frozen=True, slots=True)
class Header:
    """Contents of the header of a PLY file; ``lines`` is its number of lines."""

    encoding: str
    elements: tuple[Element, ...]
    comments: tuple[str, ...]
    obj_info: tuple[str, ...]
    lines: int


def read_header(stream: BinaryIO, name: str, max_bytes: int | None = None) -> Header:
    """Read the header and leave the stream at the first byte of the body."""
    return _HeaderReader(stream, name, max_bytes).read()


class _HeaderReader:
    """Parses the header line by line; ``number`` is the current line."""

    def __init__(self, stream: BinaryIO, name: str, max_bytes: int | None) -> None:
        self._stream = stream
        self._name = name
        self._max_bytes = max_bytes
        self._most = most_columns(max_bytes)
        self.number = 0
        self._encoding = ""
        self._elements: dict[str, tuple[int, dict[str, Property]]] = {}
        self._columns = 0
        self._comments: dict[str, list[str]] = {"comment": [], "obj_info": []}

    def read(self) -> Header:
        if self._line(first=True) != "ply":
            raise FormatError(f"{self._name}: not a PLY file: its first line is not 'ply'")
        while (line := self._line()) != "end_header":
            self._take(line)
        if not self._encoding:
            raise self._error("the header has no format line")
        return Header(
            self._encoding,
            tuple(Element(k, n, tuple(p.values())) for k, (n, p) in self._elements.items()),
            tuple(self._comments["comment"]),
            tuple(self._comments["obj_info"]),
            self.number,
        )

    def _line(self, *, first: bool = False) -> str:
        raw = self._stream.readline(8 if first else LONGEST_LINE)
        self.number += 1
        if not raw.endswith(b"\n") and not first:
            raise self._error("the header does not end: there is no complete end_header line")
        return raw.decode("utf-8", "replace").strip()

    def _take(self, line: str) -> None:
        keyword, _, rest = line.partition(" ")
        if keyword in self._comments:
            self._comments[keyword].append(rest.strip())
        elif keyword == "format":
            self._take_format(rest.split())
        elif keyword == "element":
            self._take_element(rest.split())
        elif keyword == "property":
            self._take_property(rest.split())
        elif line:
            raise self._error(f"unknown header line {quoted(line)}")

    def _take_format(self, words: list[str]) -> None:
        if len(words) != 2 or words[0] not in ORDERS or words[1] != "1.0":
            raise self._error(
                f"unknown format {quoted(' '.join(words))}: known are {[*ORDERS]} 1.0"
            )
        self._encoding = words[0]

    def _take_element(self, words: list[str]) -> None:
        if not self._encoding:
            raise self._error("an element precedes the format line")
        count = words[-1] if len(words) == 2 else ""
        if not (count.isascii() and count.isdigit() and len(count) < 19):
            raise self._error("an element line needs a name and a count")
        self._columns += 1
        if self._columns > self._most:
            self._refuse_columns()
        if words[0] in self._elements:
            raise self._error(f"element {quoted(words[0])} occurs twice")
        self._elements[words[0]] = (int(count), {})

    def _take_property(self, words: list[str]) -> None:
        if not self._elements:
            raise self._error("a property precedes the first element")
        element = next(reversed(self._elements))
        _, properties = self._elements[element]
        added = self._property(words)
        self._columns += 1
        if self._columns > self._most:
            self._refuse_columns()
        if added.name in properties:
            raise self._error(f"property {quoted(added.name)} of {element} occurs twice")
        properties[added.name] = added

    def _refuse_columns(self) -> None:
        """Raise for too many elements and properties, when those to come have been counted."""
        where = f"{self._name}: line {self.number}"
        while (line := self._line()) != "end_header":
            self._columns += line.startswith(("element ", "property "))
        what = f"a header of {self._columns:,} elements and properties"
        check_columns(self._columns, self._max_bytes, where, what)

    def _property(self, words: list[str]) -> Property:
        if len(words) == 4 and words[0] == "list":
            length = self._type(words[1])
            if length.kind not in "iu":
                raise self._error(f"the length of a list cannot be of type {words[1]}")
            return Property(words[3], self._type(words[2]), length)
        if len(words) == 2:
            return Property(words[1], self._type(words[0]))
        raise self._error("a property line needs a type and a name")

    def _type(self, word: str) -> np.dtype:
        if word not in TYPES:
            raise self._error(f"unknown type {quoted(word)}")
        return np.dtype(ORDERS[self._encoding] + TYPES[word])

    def _error(self, cause: str) -> FormatError:
        return FormatError(f"{self._name}: line {self.number}: {cause}")
