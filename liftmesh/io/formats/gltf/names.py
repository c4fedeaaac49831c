"""Named values in glTF: attributes whose names begin with an underscore, of single precision.

``_INTENSITY`` is written for intensity, as glTF wants it. The scene's extras state the old name
and type of each, so that reading gives them back; without that a name loses its underscore.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping

import numpy as np

from liftmesh._typing import Array
from liftmesh.errors import FormatError
from liftmesh.io.whole_numbers import SINGLE, fit

_OTHER = re.compile(r"[^A-Z0-9_]+")
_WIDEST = 4


def value_columns(attributes: Mapping[str, Array]) -> dict[str, Array]:
    """Return what glTF can hold of attributes: vectors of more than four values are split."""
    found: dict[str, Array] = {}
    for name, values in attributes.items():
        if _reason(values):
            continue
        if values.ndim == 1 or (values.ndim == 2 and 2 <= values.shape[1] <= _WIDEST):
            found[name] = values
        else:
            flat = values.reshape(len(values), -1)
            split = {f"{name}_{k}": column for k, column in enumerate(flat.T)}
            twice = next((each for each in split if each in attributes or each in found), None)
            if twice is not None:
                raise FormatError(f"two attributes are named {twice!r}: rename one")
            found |= split
    return found


def _reason(values: Array) -> str:
    """Say why glTF cannot hold an attribute; an empty text if it can."""
    if values.dtype.kind not in "biuf":
        return "not numbers"
    if not values.size:
        return "no values"
    return "" if np.isfinite(_single(values)).all() else "not finite"


def lost_values(attributes: Mapping[str, Array]) -> list[str]:
    """Name the attributes that a file does not hold, or not in full."""
    found: list[str] = []
    for name, values in sorted(attributes.items()):
        if why := _reason(values):
            found.append(f"{name} ({why})")
        elif not _is_exact(values):
            found.append(f"double precision of {name}")
    return found


def value_keys(names: Mapping[str, Array]) -> dict[str, str]:
    """Choose the name of each attribute in the file."""
    found: dict[str, str] = {}
    numbers: Counter[str] = Counter()
    taken: set[str] = set()
    for name in names:
        base = key = f"_{_OTHER.sub('_', name.upper()).strip('_') or 'ATTRIBUTE'}"
        while key in taken:
            numbers[base] += 1
            key = f"{base}_{numbers[base]}"
        taken.add(key)
        found[name] = key
    return found


def names_note(attributes: Mapping[str, Array], names: Mapping[str, str]) -> dict[str, list[str]]:
    """State the old name and type of each attribute."""
    return {key: [name, attributes[name].dtype.name] for name, key in names.items()}


def _is_exact(values: Array) -> bool:
    """Whether single precision holds all values."""
    if values.dtype.kind in "iu":
        return fit(values, SINGLE)
    return np.array_equal(_single(values).astype(values.dtype), values)


def _single(values: Array) -> Array:
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        return values.astype(np.float32)
