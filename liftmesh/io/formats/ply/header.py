"""The header of a PLY file: its encoding, elements and properties, and what its comments state.

The format is Greg Turk's "The PLY Polygon File Format" (1994): a text header lists elements
(vertex, face, and any other), each with a count and named properties; a property is a scalar, or a
list whose length precedes it in every row. Both families of type names are in use, Turk's own
(uchar, float) and the explicit ones (uint8, float32).

A property is one word of ASCII. An attribute of another name is written under a valid one, and so
is one that would be read as something else: a second x, or red, green and blue beside each other.
A comment ``property scalar_field_1 "scalar field #1"`` states the old name as a JSON string, and
reading gives it back. Another comment states the depth of colours, where their values would tell
another: those of 16 bits that are all dark would be read as colours of 8 bits.
"""

from __future__ import annotations

import re
import unicodedata
from collections import Counter
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np

from liftmesh._typing import Array
from liftmesh.base.colors import stated_depth
from liftmesh.errors import FormatError
from liftmesh.io.columns import ALPHA, COLOR, NORMAL, POSITION
from liftmesh.io.markup import ascii_string, parsed_or_none
from liftmesh.io.options import check_columns, most_columns
from liftmesh.io.text_tables import is_count, quoted

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

EDGE = ("vertex1", "vertex2")  # the ends of an edge


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
        if not is_count(count):
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


_OLD_NAME = re.compile(r'property (\S+) (".*")')
_OTHER = re.compile(r"[^A-Za-z0-9_]+")
_LONGEST = 1000
_KEPT = 60  # characters of a longer name
_STATED_DEPTHS = {f"color_depth {depth}": depth for depth in (16, 32, 64)}


def property_names(attributes: Collection[str], columns: Collection[str]) -> dict[str, str]:
    """Choose a property for each attribute."""
    meant = {*columns, *_with_a_meaning(attributes, columns)}
    # A made name may complete no group either: it is never that of a column.
    taken = {*columns, *POSITION, *NORMAL, *COLOR, ALPHA, *filter(_is_valid, attributes)}
    properties: dict[str, str] = {}
    numbers: Counter[str] = Counter()
    for name in attributes:
        is_kept = _is_valid(name) and name not in meant
        properties[name] = name if is_kept else _free(_valid(name), taken, numbers)
        taken.add(properties[name])
    return properties


def name_statements(properties: Mapping[str, str]) -> list[str]:
    """Comments that state the old names of properties, where they differ."""
    changed = ((name, new) for name, new in properties.items() if name != new)
    return [f"property {new} {ascii_string(name)}" for name, new in changed]


def old_names(
    comments: Iterable[str], properties: Collection[str]
) -> tuple[dict[str, str], list[str]]:
    """Return the old names that comments state of some properties, and the other comments."""
    names: dict[str, str] = {}
    used = set(properties) - {*POSITION, *_with_a_meaning(properties, ())}
    others: list[str] = []
    known = set(properties)
    for comment in comments:
        match = _OLD_NAME.fullmatch(comment)
        name = (
            parsed_or_none(match[2])
            if match and match[1] in known and match[1] not in names
            else None
        )
        if match is None or not isinstance(name, str) or name in used:
            others.append(comment)
        else:
            names[match[1]] = name
            used.add(name)
    return names, others


def _with_a_meaning(attributes: Collection[str], columns: Collection[str]) -> set[str]:
    """The names that a reader would take for normals or colours, with the properties there are."""
    known = {*attributes, *columns}
    meant = [name for group in (NORMAL, COLOR) if known.issuperset(group) for name in group]
    return {*meant, *([ALPHA] if known.issuperset(COLOR) else [])}


def _is_valid(name: str) -> bool:
    is_word = name.isascii() and name.isprintable() and " " not in name
    return is_word and 0 < len(name) <= _LONGEST


def _valid(name: str) -> str:
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode("ascii")
    return _OTHER.sub("_", plain)[:_KEPT].strip("_") or "attribute"


def _free(name: str, taken: Collection[str], numbers: Counter[str]) -> str:
    """Number a name if it is taken, from the last of its numbers on."""
    candidate = name
    while candidate in taken:
        numbers[name] += 1
        candidate = f"{name}_{numbers[name]}"
    return candidate


def depth_statement(colors: Array | None) -> list[str]:
    """Comments that state the depth of colours as they are written: one, or none."""
    depth = stated_depth(colors)
    return [] if depth is None else [f"color_depth {depth}"]


def depth_of_comments(
    comments: Iterable[str], color: np.dtype | None
) -> tuple[int | None, list[str]]:
    """Return the depth that comments state of colours of a type, and the other comments."""
    depth: int | None = None
    others: list[str] = []
    for comment in comments:
        stated = _STATED_DEPTHS.get(comment)
        is_of_type = color is not None and color.kind == "u" and stated == 8 * color.itemsize
        if stated is None or not is_of_type:
            others.append(comment)
        else:
            depth = stated
    return depth, others
