"""The values of a point by name: which types they have in a cloud, and how a block gives them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from liftmesh._typing import Array
from liftmesh.io.columns import POSITION

_STORED = ("X", "Y", "Z")
WAVE_PACKETS = (
    "wavepacket_index", "wavepacket_offset", "wavepacket_size", "return_point_wave_location",
    "x_t", "y_t", "z_t",
)  # fmt: skip


def types_of(dimensions: Sequence[Any]) -> tuple[dict[str, np.dtype], tuple[str, ...]]:
    """Return the columns of a cloud with their types, and the extra bytes that cannot be one."""
    double = np.dtype(np.float64)
    types: dict[str, np.dtype] = dict.fromkeys(POSITION, double)
    refused = []
    for each in dimensions:
        if each.name in _STORED:
            continue
        if each.name in POSITION or not each.name:
            refused.append(f"extra bytes {each.name!r} (the name of a coordinate, or none)")
            continue
        if each.name in types:
            refused.append(f"extra bytes {each.name!r} (the name of another value)")
            continue
        kind = np.dtype(np.uint8) if each.dtype is None else each.dtype
        kind = double if each.is_scaled else kind.base
        types[each.name] = np.dtype((kind, (each.num_elements,))) if _is_vector(each) else kind
    return types, tuple(refused)


def _is_vector(dimension: Any) -> bool:
    return dimension.dtype is not None and dimension.num_elements > 1


class Block(Mapping[str, Array]):
    """Points of a file: each column is computed when it is asked for."""

    def __init__(self, record: Any, names: Sequence[str]) -> None:
        self._record = record
        self._names = names

    def __getitem__(self, name: str) -> Array:
        """Return a column: coordinates from their whole numbers, scales and offsets."""
        if name in POSITION:
            k = POSITION.index(name)
            with np.errstate(over="ignore", invalid="ignore"):
                values: Array = self._record.array[_STORED[k]] * self._record.scales[k]
                values += self._record.offsets[k]
            return values
        return np.asarray(self._record[name])

    def __contains__(self, name: object) -> bool:
        """Whether there is such a column."""
        return name in self._names

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    @property
    def rows(self) -> int:
        """The number of points."""
        return len(self._record.array)

    def taken(self, rows: Array) -> Block:
        """Return some of the points."""
        record = self._record
        array = record.array
        # As items of bytes: NumPy would copy structured ones value by value.
        taken = array.view(f"V{array.itemsize}").take(rows).view(array.dtype)
        part = type(record)(taken, record.point_format, record.scales, record.offsets)
        return Block(part, self._names)
