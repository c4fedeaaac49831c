"""What stands at the beginning of an E57 file: where its XML is, which describes all else.

The file consists of pages, each with a checksum at its end. The XML is looked at before libE57 sees
it, since its parser follows what a document type declares: other files, and entities that expand to
far more than their text.
"""

from __future__ import annotations

import struct
from typing import BinaryIO

from liftmesh.errors import FormatError
from liftmesh.io.streams import remaining

_HEADER = struct.Struct("<8s2I4Q")  # signature, version, size, XML: place and size, page
_SIGNATURE = b"ASTM-E57"
_CHECKSUM = 4  # bytes at the end of a page
_PAGE = 1024  # bytes, of every file of this version
_FORBIDDEN = (b"<!DOCTYPE", b"<!ENTITY")


def check_header(stream: BinaryIO, name: str) -> int:
    """Raise for a file that is not E57, or whose XML could do harm.

    Parameters
    ----------
    stream : binary stream
        The file, at its beginning.
    name : str
        The file for messages.

    Returns
    -------
    int
        The bytes of the file.

    Raises
    ------
    FormatError
        It is not E57, its header states what the file does not hold, or the XML has a document
        type.

    Examples
    --------
    >>> import io
    >>> check_header(io.BytesIO(b"ply"), "a.e57")
    Traceback (most recent call last):
    ...
    liftmesh.errors.FormatError: a.e57: not an E57 file, which begins with ASTM-E57
    """
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
    if page != _PAGE or place >= size or length > size:
        raise FormatError(f"{name}: the header places the description outside of the file")
    text = _description(stream, place, length)
    if not text.startswith(b"<?xml") or b"\0" in text:
        raise FormatError(f"{name}: the description at byte {place} is no XML of UTF-8")
    if any(word in text for word in _FORBIDDEN):
        raise FormatError(f"{name}: the XML declares a document type, which E57 has not")
    return there


def _description(stream: BinaryIO, place: int, length: int) -> bytes:
    """Return the XML without the checksums of pages."""
    stream.seek(place)
    first = _PAGE - place % _PAGE
    pages = 1 + -(-max(length + _CHECKSUM - first, 0) // (_PAGE - _CHECKSUM))
    data = stream.read(first + (pages - 1) * _PAGE)
    starts = [0, *range(first, len(data), _PAGE)]
    parts = [data[k : (first if k == 0 else k + _PAGE) - _CHECKSUM] for k in starts]
    return b"".join(parts)[:length]
