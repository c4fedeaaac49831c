"""Attributes as the columns that every PLY reader understands.

Of PLY's eight types, readers in wide use agree on uint8, uint16, int32, float and double only: one
skips int8, int16 and uint32, another cannot open a file that has int16, and 64-bit integers
are no part of the format. So values are written in the type they have if it is one of the five,
and otherwise in the smallest of them that holds every value exactly.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from liftmesh._typing import Array
from liftmesh.errors import FormatError

PORTABLE = {"u1": "uint8", "u2": "uint16", "i4": "int32", "f4": "float", "f8": "double"}

_WIDER = {"b1": "u1", "i1": "i4", "i2": "i4", "f2": "f4"}
_EXACT = 1 << 53


def portable(values: Array, what: str) -> Array:
    """Convert an array, if need be, to a portable type that holds every value.

    Raises
    ------
    FormatError
        The values are no numbers, or integers that a double cannot hold.
    """
    code = values.dtype.str[1:]
    if code in PORTABLE:
        return values
    if code in _WIDER:
        return values.astype(_WIDER[code])
    if values.dtype.kind in "iu":
        return _integers(values, what)
    converted = values.astype(np.float64) if values.dtype.kind == "f" else values
    if values.dtype.kind != "f" or not np.array_equal(converted, values, equal_nan=True):
        raise FormatError(f"{what} of type {values.dtype} cannot be written as PLY: convert it")
    return converted


def _integers(values: Array, what: str) -> Array:
    low, high = (int(values.min()), int(values.max())) if values.size else (0, 0)
    limits = np.iinfo(np.int32)
    if limits.min <= low and high <= limits.max:
        return values.astype(np.int32)
    if low >= -_EXACT and high <= _EXACT:
        return values.astype(np.float64)
    raise FormatError(
        f"{what} reaches from {low} to {high}: PLY has no type for integers beyond 2**53; "
        "write NPZ, or split it in two"
    )


def scalar_columns(attributes: Mapping[str, Array]) -> dict[str, Array]:
    """Spread (n, k) attributes over columns name_0, name_1 and so on.

    Raises
    ------
    FormatError
        A name cannot be a PLY property, or two columns get one name.
    """
    columns: dict[str, Array] = {}
    for name, values in attributes.items():
        _check_name(name)
        width = math.prod(values.shape[1:])  # which numpy cannot tell where there are no rows
        flat = portable(np.asarray(values).reshape(len(values), width), f"attribute {name!r}")
        names = [name] if values.ndim == 1 else [f"{name}_{k}" for k in range(flat.shape[1])]
        taken = columns.keys() & set(names)
        if taken:
            raise FormatError(f"two attributes are called {min(taken)!r}: rename one")
        columns |= dict(zip(names, flat.T, strict=True))
    return columns


def _check_name(name: str) -> None:
    if not name.isascii() or not name.isprintable() or not name or " " in name:
        raise FormatError(
            f"attribute {name!r} cannot be a PLY property: "
            "rename it to ASCII letters without spaces"
        )
