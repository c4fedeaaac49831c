"""The header of an E57 file: where its XML is, which describes everything else.

The file consists of pages, each with a checksum at its end. The XML is parsed before libE57 sees
it, since its parser opens what a document type or an attribute of a schema instance names, on the
disk and the network, and its tree takes quadratic time where elements have very many children.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import BinaryIO
from xml.parsers import expat  # opens nothing, and document types are refused

from liftmesh.errors import FormatError
from liftmesh.io.streams import remaining

_HEADER = struct.Struct("<8s2I4Q")  # signature, version, size, XML: place and size, page
_SIGNATURE = b"ASTM-E57"
_CHECKSUM = 4  # bytes at the end of a page
_PAGE = 1024  # bytes, of every file of this version
_MOST_STEPS = 500  # of the tree of libE57 for an element, of about 40 ns
_FREE_STEPS = 1_000_000


def check_header(stream: BinaryIO, name: str) -> int:
    """Raise for a file that is not E57, or whose XML could do harm."""
    there = remaining(stream)
    head = stream.read(_HEADER.size)
    if len(head) < _HEADER.size or not head.startswith(_SIGNATURE):
        raise FormatError(f"{name}: not an E57 file, which begins with ASTM-E57")
    _, major, _, size, place, length, page = _HEADER.unpack(head)
    if major != 1:
        raise FormatError(f"{name}: E57 of version {major} cannot be read: only 1 is known")
    if size != there:
        raise FormatError(
            f"{name}: the header states {size:,} bytes, but the file has {there:,}: it is "
            "truncated, or damaged"
        )
    if page != _PAGE or place >= size or length > size or place % _PAGE >= _PAGE - _CHECKSUM:
        raise FormatError(f"{name}: the header places the description outside of the file")
    text = _description(stream, place, length)
    if not text.startswith(b"<?xml") or b"\0" in text:
        raise FormatError(f"{name}: the description at byte {place} is no XML of UTF-8")
    _Xml(name).check(text)
    return there


@dataclass(slots=True)
class _Element:
    """An open element: its children, the elements below it, and the most children of one."""

    kind: str
    children: int = 0
    nodes: int = 1
    widest: int = 1

    def steps(self, child: _Element) -> int:
        """Return what its latest child is compared with: earlier names, or types all through."""
        each = {"uniform": child.nodes * child.widest, "free": 0}.get(self.kind, 1)
        return self.children * each


class _Xml:
    """Parses the XML, and counts the steps of the tree that libE57 makes of it."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._open = [_Element("")]
        self._elements = self._spaces = self._steps = 0

    def check(self, text: bytes) -> None:
        """Raise for anything but plain elements."""
        parser = expat.ParserCreate("UTF-8", namespace_separator=" ")
        parser.XmlDeclHandler = self._declared
        parser.StartDoctypeDeclHandler = self._typed
        parser.StartNamespaceDeclHandler = self._spaced
        parser.StartElementHandler = self._begun
        parser.EndElementHandler = self._ended
        try:
            parser.Parse(text, True)
        except expat.ExpatError as error:
            raise self._error(f"is damaged: {error}") from error

    def _declared(self, version: str, encoding: str | None, _: int) -> None:
        if version != "1.0" or (encoding or "UTF-8").upper() != "UTF-8":
            raise self._error(f"is XML {version} in {encoding}, and E57 has 1.0 in UTF-8")

    def _typed(self, *_: object) -> None:
        raise self._error("declares a document type, which E57 has not")

    def _spaced(self, *_: object) -> None:
        self._spaces += 1
        self._steps += self._spaces

    def _begun(self, _: str, attributes: Mapping[str, str]) -> None:
        if foreign := next((each for each in attributes if " " in each), None):
            space, _, local = foreign.rpartition(" ")
            raise self._error(f"has the attribute {local} of {space[:99]!r}, and E57 has no such")
        kind = attributes.get("type", "")
        if kind == "Vector":
            kind = "free" if attributes.get("allowHeterogeneousChildren") == "1" else "uniform"
        self._open.append(_Element(kind))
        self._elements += 1

    def _ended(self, _: str) -> None:
        child, parent = self._open.pop(), self._open[-1]
        parent.children += 1
        parent.nodes += child.nodes
        parent.widest = max(parent.widest, child.widest, parent.children)
        self._steps += len(self._open) + parent.steps(child)
        if self._steps > _FREE_STEPS + _MOST_STEPS * self._elements:
            raise self._error("has too many elements beside or within one another")

    def _error(self, cause: str) -> FormatError:
        return FormatError(f"{self._name}: the XML {cause}")


def _description(stream: BinaryIO, place: int, length: int) -> bytes:
    """Return the XML without the checksums of pages."""
    stream.seek(place)
    first = _PAGE - place % _PAGE
    pages = 1 + -(-max(length + _CHECKSUM - first, 0) // (_PAGE - _CHECKSUM))
    data = stream.read(first + (pages - 1) * _PAGE)
    starts = [0, *range(first, len(data), _PAGE)]
    parts = [data[k : (first if k == 0 else k + _PAGE) - _CHECKSUM] for k in starts]
    return b"".join(parts)[:length]
