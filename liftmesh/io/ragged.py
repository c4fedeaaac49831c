"""Rows of different lengths in one flat array: polygons of any size, lists of a PLY file.

Lengths keep the type in which a file states them: rows of one byte each must not take eight bytes
of memory for their lengths alone. What is computed from them is computed in runs of few rows and
values, for the same reason.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import as_strided

from liftmesh._typing import Array, Integers

_ROWS = 1 << 18  # rows copied at a time: Ctrl-C takes effect in between
_RUN = 1 << 16  # rows, and values, of a run


@dataclass(frozen=True, slots=True)
class Ragged:
    """Rows of different lengths: row i holds the next ``sizes[i]`` of ``values``."""

    sizes: Integers
    values: Array

    @classmethod
    def uniform(cls, rows: Array, length: np.dtype | None = None) -> Ragged:
        """Copy an (m, k) array: m rows of k values; ``length`` is the type of their lengths."""
        copy = np.empty(rows.shape, rows.dtype)
        for start in range(0, len(rows), _ROWS):
            copy[start : start + _ROWS] = rows[start : start + _ROWS]
        size = np.array(rows.shape[1], np.int64 if length is None else length.newbyteorder("="))
        return cls(np.broadcast_to(size, len(rows)), copy.reshape(-1))

    @classmethod
    def empty(cls, dtype: np.dtype) -> Ragged:
        """Return an instance without rows."""
        return cls(np.empty(0, dtype=np.int64), np.empty(0, dtype))

    @classmethod
    def joined(cls, parts: Sequence[Ragged]) -> Ragged:
        """Concatenate the rows of all parts."""
        if len(parts) == 1:
            return parts[0]
        return cls(
            np.concatenate([each.sizes for each in parts]),
            np.concatenate([each.values for each in parts]),
        )

    def row_of(self, position: int) -> int:
        """Return the row to which the value at ``position`` belongs."""
        ends = np.cumsum(self.sizes, dtype=np.int64)
        return int(np.searchsorted(ends, position, side="right"))


def runs(sizes: Integers) -> Iterator[tuple[slice, slice]]:
    """Divide rows into runs of few rows and values, or of one long row: the slices of both."""
    before = 0
    for start in range(0, len(sizes), _RUN):
        ends = np.cumsum(sizes[start : start + _RUN], dtype=np.int64)
        row, begin = 0, 0
        while row < len(ends):
            stop = max(int(np.searchsorted(ends, begin + _RUN, side="right")), row + 1)
            end = int(ends[stop - 1])
            yield slice(start + row, start + stop), slice(before + begin, before + end)
            row, begin = stop, end
        before += begin


def places(starts: Integers, sizes: Integers) -> Integers:
    """List ``starts[i]``, ``starts[i] + 1`` and so on, ``sizes[i]`` of them, for each i."""
    first = starts - (np.cumsum(sizes) - sizes)
    found: Integers = np.repeat(first, sizes)
    found += np.arange(len(found))
    return found


def gathered(values: Array, starts: Integers, sizes: Integers) -> Array:
    """Concatenate ``values[starts[i] : starts[i] + sizes[i]]`` for each i."""
    if len(sizes) and (sizes == sizes[0]).all():
        return _gathered_uniform(values, starts, int(sizes[0]))
    found = np.empty(int(sizes.sum()), values.dtype)
    for rows, at in runs(sizes):
        if rows.stop - rows.start == 1:
            start = int(starts[rows.start])
            found[at] = values[start : start + at.stop - at.start]
        else:
            found[at] = values[places(starts[rows], sizes[rows])]
    return found


def _gathered_evenly(values: Array, starts: Integers, size: int) -> Array | None:
    """The same for starts at equal distances, as in lines of triangles; None for others."""
    step = int(starts[1] - starts[0])
    if step < size or starts[-1] + size > len(values) or (np.diff(starts) != step).any():
        return None
    (stride,) = values.strides
    rows = as_strided(values[int(starts[0]) :], (len(starts), size), (step * stride, stride))
    flat: Array = np.array(rows, order="C").reshape(-1)
    return flat


def _gathered_uniform(values: Array, starts: Integers, size: int) -> Array:
    if len(starts) == 1:
        return np.array(values[int(starts[0]) : int(starts[0]) + size])
    if (even := _gathered_evenly(values, starts, size)) is not None:
        return even
    found = np.empty((len(starts), size), values.dtype)
    for row in range(0, len(starts), max(_RUN // max(size, 1), 1)):
        some = slice(row, row + max(_RUN // max(size, 1), 1))
        found[some] = values[starts[some, None] + np.arange(size)]
    flat: Array = found.reshape(-1)
    return flat
