"""One array in NumPy's NPY layout: a short header, then the values.

``numpy.load`` takes the memory that a header asks for before it looks at the file. Here the header
is compared with the file first.
"""

from __future__ import annotations

import math
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
        The header is broken or promises more than is there, or the values are Python objects.
    """
    try:
        shape, by_columns, dtype = _header(stream)
    except MemoryError:
        raise
    except Exception as error:  # the header is a Python literal: its parser raises many kinds
        raise FormatError(f"{name}: not an NPY file, or its header is broken: {error}") from error
    if dtype.hasobject:
        raise FormatError(f"{name}: the array holds Python objects: save it as numbers")
    shown = shortened(str(shape))
    if not all(type(length) is int and length >= 0 for length in shape) or not dtype.itemsize:
        raise FormatError(f"{name}: the header says shape {shown} of {dtype}")
    count = math.prod(shape)
    what = f"{dtype} array of shape {shown}"
    data = read_exactly(stream, count * dtype.itemsize, name, what)
    flat = np.frombuffer(bytearray(data), dtype, count) if data else np.empty(count, dtype)
    try:
        return flat.reshape(shape, order="F" if by_columns else "C")
    except ValueError as error:  # of more axes than there are, or of none and endless ones
        raise FormatError(f"{name}: the header says shape {shown}: {error}") from error


def _header(stream: BinaryIO) -> tuple[tuple[int, ...], bool, np.dtype]:
    version = npy.read_magic(stream)
    if version == (1, 0):
        return npy.read_array_header_1_0(stream)
    if version == (2, 0):
        return npy.read_array_header_2_0(stream)
    raise ValueError(f"version {version} of the layout is not known")
