"""Some values of a large NPY file, read by where they are, and nothing else.

A tile reads from every run, so this has to be quick: headers are not parsed.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from liftmesh._typing import Array
from liftmesh.base.interruption import opened
from liftmesh.errors import FormatError
from liftmesh.tiles.store import mapped

_NPY_VERSION, _NPY_LENGTH = 6, 8  # the bytes of an NPY file where these of its header stand
_WORD = np.dtype(np.int64)


def values_of(path: Path, begin: int, end: int, kind: np.dtype[Any] = _WORD) -> Array:
    """Read some values of an NPY file that `save_array` has written."""
    values = np.empty(end - begin, dtype=kind)
    fill(values, path, begin)
    return values


def fill(values: Array, path: Path, begin: int) -> None:
    """Read values of an NPY file that `save_array` has written into an array."""
    rest = values.reshape(-1).view(np.uint8).data
    with opened(path, os.O_RDONLY) as file:
        begun = os.pread(file, _NPY_LENGTH + 4, 0)
        size = 2 if begun[_NPY_VERSION : _NPY_VERSION + 1] == b"\1" else 4
        length = int.from_bytes(begun[_NPY_LENGTH : _NPY_LENGTH + size], "little")
        at = _NPY_LENGTH + size + length + values.dtype.itemsize * begin
        while len(rest) and (count := os.preadv(file, [rest], at)):
            at, rest = at + count, rest[count:]
    if len(rest):
        raise FormatError(f"{path}: truncated: tile the source again")


def kind_of(path: Path) -> np.dtype[Any]:
    """Read the type of the values in an NPY file that `save_array` has written."""
    return mapped(path).dtype
