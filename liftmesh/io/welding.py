"""Merging of equal rows of coordinates.

Rows are sorted by a hash of their coordinates, and neighbours in this order compared. If different
rows share a hash, the coordinates themselves are sorted: a collision costs one more sort. The hash
depends on a secret of the process, so that no file gives very many different rows one hash; the
result does not depend on it. Many rows are first distributed by bits of their hashes, so that no
step takes long: between steps Python hears signals.
"""

from __future__ import annotations

import os
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Floats, Integers, Mask

_PART = 1 << 20  # rows sorted at once
_FACTORS = tuple(int.from_bytes(os.urandom(8), "little") | 1 for _ in range(3))

Hashes = NDArray[np.uint64]


def weld(points: Floats) -> tuple[Integers, Integers]:
    """Find the equal rows of an array."""
    rows = np.arange(len(points))
    first = rows.copy()
    hashes = _hashes(points)
    for part in _parts(hashes, rows[~np.isnan(points).any(axis=1)]):
        _find_first(points, hashes, part, first)
    kept = first == rows
    return np.flatnonzero(kept), (np.cumsum(kept) - 1)[first]


def _hashes(points: Floats) -> Hashes:
    """Hash rows; equal rows have equal hashes."""
    hashes = np.zeros(len(points), dtype=np.uint64)
    for axis, factor in enumerate(_FACTORS):
        hashes += (points[:, axis] + 0.0).view(np.uint64)  # + 0.0 turns -0.0 into 0.0
        hashes *= np.uint64(factor)
        hashes ^= hashes >> np.uint64(32)
    return hashes


def _parts(hashes: Hashes, rows: Integers) -> Iterator[Integers]:
    """Distribute rows by the bits of their hashes until few are left in a part, or all agree."""
    waiting = [rows]
    while waiting:
        rows = waiting.pop()  # a row is in one part only: splits take no more memory
        bit = _first_that_differs(hashes[rows]) if len(rows) > _PART else -1
        if bit < 0:
            yield rows
            continue
        upper = (hashes[rows] >> np.uint64(bit)) & np.uint64(1) == 1
        waiting += [rows[upper], rows[~upper]]


def _first_that_differs(hashes: Hashes) -> int:
    """Find the highest bit in which some hashes differ; -1 if all are equal."""
    return int(np.bitwise_or.reduce(hashes ^ hashes[0])).bit_length() - 1


def _find_first(points: Floats, hashes: Hashes, rows: Integers, first: Integers) -> None:
    """Set the first row that is equal to each of some rows; all rows equal to one are given."""
    order = rows[np.argsort(hashes[rows])]
    alike = hashes[order[1:]] == hashes[order[:-1]]
    equal = _equal_to_next(points, order)
    if not np.array_equal(alike, equal):
        order = rows[np.lexsort(points[rows].T)]
        equal = _equal_to_next(points, order)
    begins = np.flatnonzero(np.concatenate([[True], ~equal]))[: len(rows)]
    lowest = np.minimum.reduceat(order, begins) if len(rows) else order
    first[order] = np.repeat(lowest, np.diff(begins, append=len(rows)))


def _equal_to_next(points: Floats, order: Integers) -> Mask:
    placed = points[order]
    equal: Mask = (placed[1:] == placed[:-1]).all(axis=1)
    return equal
