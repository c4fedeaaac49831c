"""One array in NumPy's NPY layout: a short header, then the values.

``numpy.load`` allocates the memory that a header asks for before it reads the file. Here the
header is compared with the size of the file first. NumPy parses the header itself, a short text:
so memory that its parser runs out of is the file's fault, not the machine's. While the stream is
read, it is not, and neither is a failing disk: these errors are passed on.
"""

from __future__ import annotations

import io
import math
import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np
from numpy.lib import format as npy

from liftmesh._typing import Array
from liftmesh.errors import FormatError
from liftmesh.io.streams import Source, read_into, read_most, remaining
from liftmesh.io.text_tables import shortened

_LONGEST_HEADER = 10_000  # what NumPy takes from a file that is not trusted

# A header as NumPy writes it of an array of numbers.
_USUAL = re.compile(
    r"\{'descr': '[^'\\]*', 'fortran_order': (?:True|False), 'shape': \([\d, ]*\), \}\s*"
)

# What any header consists of: strings, whole numbers, truth values and brackets. Python 2 wrote
# some numbers with an L.
_TOKEN = re.compile(
    r"""\s*("(?:[^"\\]|\\[\\'"nrtxuU])*"|'(?:[^'\\]|\\[\\'"nrtxuU])*'|"""
    r"""-?\d+(?!\w)|-?\d+(?=L\b)|True|False|[][(){},:])(?:(?<=\d)L)?"""
)

# The length of the header, and what parses both.
_VERSIONS = {
    (1, 0): (struct.Struct("<H"), npy.read_array_header_1_0),
    (2, 0): (struct.Struct("<I"), npy.read_array_header_2_0),
}


def read_array(stream: BinaryIO, name: str) -> Array:
    """Read one array from a file; its values are never unpickled."""
    layout = Layout.read(stream, name)
    layout.check_size(remaining(stream), name)
    return array_of(stream, layout, name)


@dataclass(frozen=True, slots=True)
class Layout:
    """Shape, order and type of an array, from the header of an NPY file."""

    shape: tuple[int, ...]
    by_columns: bool
    dtype: np.dtype

    @classmethod
    def read(cls, stream: Source, name: str) -> Layout:
        """Read the header and leave the stream at the first value."""
        try:
            layout = cls(*_header(stream))
        except (OSError, MemoryError):  # of the stream
            raise
        except SystemError as error:  # what Python makes of memory that it runs out of
            raise MemoryError from error
        except Exception as error:  # the header is a Python literal: its parser raises many kinds
            raise FormatError(
                f"{name}: not an NPY file, or its header is invalid: {error}"
            ) from error
        if layout.dtype.hasobject:
            raise FormatError(f"{name}: the array holds Python objects: save it as numbers")
        lengths = all(type(length) is int and length >= 0 for length in layout.shape)
        if not lengths or not layout.dtype.itemsize:
            raise FormatError(
                f"{name}: the header says shape {shortened(str(layout.shape))} of {layout.dtype}"
            )
        return layout

    @property
    def size(self) -> int:
        """Size of the values in bytes."""
        return math.prod(self.shape) * self.dtype.itemsize

    @property
    def what(self) -> str:
        """Description of the array for messages."""
        return f"{self.dtype} array of shape {shortened(str(self.shape))}"

    def check_size(self, left: int, name: str) -> None:
        """Raise if fewer bytes are left than the values take, before memory is allocated."""
        if self.size > left:
            raise FormatError(
                f"{name}: {self.what} should take {self.size} bytes, but {left} are left: the file "
                "is truncated, or its header is wrong"
            )

    @property
    def is_by_rows(self) -> bool:
        """Whether the values of a row are contiguous, so that rows can be read in parts."""
        return len(self.shape) > 0 and (len(self.shape) == 1 or not self.by_columns)

    def array(self, data: Array, shape: tuple[int, ...], name: str) -> Array:
        """Build an array of the given shape on its bytes."""
        count = math.prod(shape)
        flat = np.frombuffer(data, self.dtype, count) if len(data) else np.empty(count, self.dtype)
        try:
            return flat.reshape(shape, order="F" if self.by_columns else "C")
        except ValueError as error:  # more axes than NumPy allows, or an empty and a huge one
            raise FormatError(
                f"{name}: the header says shape {shortened(str(shape))}: {error}"
            ) from error


def _header(stream: Source) -> tuple[tuple[int, ...], bool, np.dtype]:
    version = npy.read_magic(io.BytesIO(read_most(stream, npy.MAGIC_LEN)))
    if version not in _VERSIONS:
        raise ValueError(f"version {version} of the layout is not supported")
    length, parse = _VERSIONS[version]
    begin = read_most(stream, length.size)
    size = length.unpack(begin)[0] if len(begin) == length.size else 0
    if size > _LONGEST_HEADER:
        raise ValueError(
            f"the header takes {size:,} bytes, more than {_LONGEST_HEADER:,}: save only the fields "
            "you need"
        )
    text = _plain_text(read_most(stream, size).decode("latin-1")).encode("latin-1")
    try:
        return parse(io.BytesIO(length.pack(len(text)) + text), max_header_size=len(text))
    except MemoryError as error:  # the parser's own limit: its message, if any, is about stacks
        raise ValueError("nested too deeply") from error


def _plain_text(text: str) -> str:
    """Return the header without what Python and NumPy warn of, such as the L of Python 2."""
    if _USUAL.fullmatch(text):
        return text
    at, parts = 0, []
    while (found := _TOKEN.match(text, at)) is not None:
        parts.append(found[1])
        at = found.end()
    if text[at:].strip():
        raise ValueError(f"unexpected {shortened(text[at:])!r}")
    return " ".join(parts)


def array_of(stream: Source, layout: Layout, name: str) -> Array:
    """Read the values of an array, once their size has been checked."""
    return layout.array(_read_values(stream, layout.size, name, layout.what), layout.shape, name)


def split(array: Array, rows: int) -> Iterator[Array]:
    """Split an array into parts of some rows."""
    return (array[start : start + rows] for start in range(0, len(array), rows))


def array_parts(stream: Source, layout: Layout, name: str, rows: int) -> Iterator[Array]:
    """Read an array some rows at a time; read it whole, then split it, if not stored by rows."""
    if not layout.is_by_rows:
        yield from split(array_of(stream, layout, name), rows)
        return
    total, *rest = layout.shape
    row = math.prod(rest) * layout.dtype.itemsize
    for start in range(0, total, rows):
        count = min(rows, total - start)
        data = _read_values(stream, count * row, name, layout.what)
        yield layout.array(data, (count, *rest), name)


def _read_values(stream: Source, size: int, name: str, what: str) -> Array:
    """Read bytes into memory that the array will own: there is no second copy of the values."""
    values = np.empty(size, np.uint8)
    view, start = values.data, 0
    while start < size:
        count = read_into(stream, view[start:])
        if not count:
            raise FormatError(f"{name}: {what}: the values end too early: the file is truncated")
        start += count
    return values
