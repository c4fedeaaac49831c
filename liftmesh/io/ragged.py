"""Rows of differing length in two flat arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from liftmesh._typing import Array, Integers

_ROWS = 1 << 18  # copied at a time: Ctrl-C is heard in between


@dataclass(frozen=True, slots=True)
class Ragged:
    """Row i holds ``sizes[i]`` of the ``values``, which stand one row after the other."""

    sizes: Integers
    values: Array

    @classmethod
    def uniform(cls, rows: Array) -> Ragged:
        """Copy an (m, k) array: m rows of k values."""
        copy = np.empty(rows.shape, rows.dtype)
        for start in range(0, len(rows), _ROWS):
            copy[start : start + _ROWS] = rows[start : start + _ROWS]
        return cls(np.broadcast_to(np.int64(rows.shape[1]), len(rows)), copy.reshape(-1))

    @classmethod
    def empty(cls, dtype: np.dtype) -> Ragged:
        """Make no rows at all."""
        return cls(np.empty(0, dtype=np.int64), np.empty(0, dtype))

    @classmethod
    def joined(cls, parts: Sequence[Ragged]) -> Ragged:
        """Stack rows upon rows."""
        if len(parts) == 1:
            return parts[0]
        return cls(
            np.concatenate([each.sizes for each in parts]),
            np.concatenate([each.values for each in parts]),
        )

    def starts(self) -> Integers:
        """Locate the first value of each row."""
        return np.cumsum(self.sizes) - self.sizes

    def row_of(self, position: int) -> int:
        """Tell which row the value at ``position`` belongs to."""
        return int(np.searchsorted(np.cumsum(self.sizes), position, side="right"))
