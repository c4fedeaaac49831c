"""One array in NumPy's NPY layout: a short header, then the values.

``numpy.load`` allocates the memory that a header asks for before it reads the file. Here the
header is compared with the size of the file first.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np
from numpy.lib import format as npy

from liftmesh._typing import Array
from liftmesh.errors import FormatError
from liftmesh.io.streams import read_exactly
from liftmesh.io.text_tables import shortened


def read_array(stream: BinaryIO, name: str) -> Array:
    """Read one array; its values are never unpickled.

    Raises
    ------
    FormatError
        The header is invalid or promises more bytes than there are, or the values are Python
        objects.
    """
    layout = Layout.read(stream, name)
    data = read_exactly(stream, layout.size, name, layout.what)
    return layout.array(data, layout.shape, name)


@dataclass(frozen=True, slots=True)
class Layout:
    """Shape, order and type of an array, from the header of an NPY file."""

    shape: tuple[int, ...]
    by_columns: bool
    dtype: np.dtype

    @classmethod
    def read(cls, stream: BinaryIO, name: str) -> Layout:
        """Read the header and leave the stream at the first value."""
        try:
            layout = cls(*_header(stream))
        except MemoryError:
            raise
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

    @property
    def is_by_rows(self) -> bool:
        """Whether the values of a row are contiguous, so that rows can be read in parts."""
        return len(self.shape) > 0 and (len(self.shape) == 1 or not self.by_columns)

    def array(self, data: bytes, shape: tuple[int, ...], name: str) -> Array:
        """Build an array of the given shape from its bytes."""
        count = math.prod(shape)
        flat = np.frombuffer(bytearray(data), self.dtype, count) if data else None
        flat = np.empty(count, self.dtype) if flat is None else flat
        try:
            return flat.reshape(shape, order="F" if self.by_columns else "C")
        except ValueError as error:  # more axes than NumPy allows, or an empty and a huge one
            raise FormatError(
                f"{name}: the header says shape {shortened(str(shape))}: {error}"
            ) from error


def _header(stream: BinaryIO) -> tuple[tuple[int, ...], bool, np.dtype]:
    version = npy.read_magic(stream)
    if version == (1, 0):
        return npy.read_array_header_1_0(stream)
    if version == (2, 0):
        return npy.read_array_header_2_0(stream)
    raise ValueError(f"version {version} of the layout is not supported")


def array_parts(stream: BinaryIO, layout: Layout, name: str, rows: int) -> Iterator[Array]:
    """Read an array some rows at a time; read it whole, then split it, if not stored by rows."""
    if not layout.is_by_rows:
        array = layout.array(
            _read_values(stream, layout.size, name, layout.what), layout.shape, name
        )
        yield from (array[start : start + rows] for start in range(0, len(array), rows))
        return
    total, *rest = layout.shape
    row = math.prod(rest) * layout.dtype.itemsize
    for start in range(0, total, rows):
        count = min(rows, total - start)
        data = _read_values(stream, count * row, name, layout.what)
        yield layout.array(data, (count, *rest), name)


def _read_values(stream: BinaryIO, size: int, name: str, what: str) -> bytes:
    data = stream.read(size)
    if len(data) != size:
        raise FormatError(f"{name}: {what}: the values end too early: the file is truncated")
    return data
