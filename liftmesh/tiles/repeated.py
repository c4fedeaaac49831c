"""Positions at which very many rows are, and the list of all duplicates.

Equal rows share a tile, so one position that is repeated often enough would make a tile of any
size. Such positions show in the sample. When a chunk is sorted by tile, only its first row at each
of them goes into a tile; the others are duplicates of that one. The list of duplicates is merged
from those of chunks and tiles in stretches of rows, without holding it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from liftmesh._typing import Array, Floats, Integers

_OFTEN = 100  # of a sample with 2,000 points for each tile
_STRETCH = 1 << 22  # rows


def positions_of(rows: Floats) -> Array:
    """Return x and y as one number for each row, where 0 and -0 are equal."""
    found: Array = np.ascontiguousarray(rows + 0.0).view(np.complex128).reshape(-1)
    return found


def frequent(sample: Floats) -> tuple[Floats, Floats]:
    """Find positions that are often in a sample."""
    found, first, counts = np.unique(positions_of(sample), return_index=True, return_counts=True)
    often = found[counts >= _OFTEN]
    is_other = ~np.isin(positions_of(sample), often)
    is_other[first] = True
    return often.view(np.float64).reshape(-1, 2), sample[is_other]


def set_apart(
    rows: Floats, repeated: Floats, heights: Floats | None = None, policy: str = "first"
) -> tuple[Integers, Integers, Integers]:
    """Replace all rows but the first at each of some positions by NaN."""
    firsts = np.full(len(repeated), -1, dtype=np.int64)
    if not len(repeated):
        return firsts, firsts, firsts
    positions, sought = positions_of(rows), positions_of(repeated)
    at = np.minimum(np.searchsorted(sought, positions), len(sought) - 1)
    found = np.flatnonzero(sought[at] == positions)
    which = at[found]
    present, first = np.unique(which, return_index=True)
    firsts[present] = found[first]
    is_apart = np.ones(len(found), dtype=np.bool_)
    is_apart[first] = False
    if heights is not None and len(found):
        is_apart[_needed(which, heights[found], policy)] = False
    rows[found[is_apart]] = np.nan
    return found[is_apart], which[is_apart], firsts


def _needed(which: Integers, heights: Floats, policy: str) -> Integers:
    """Find the rows of a chunk that decide what a policy makes of each position."""
    if policy == "first":
        return np.empty(0, dtype=np.int64)
    if policy == "last":
        last = np.unique(which[::-1], return_index=True)[1]
        return len(which) - 1 - last
    order = np.lexsort((heights, which))  # and by row
    at, height = which[order], heights[order]
    is_new = np.r_[True, at[1:] != at[:-1]]
    is_level = is_new | np.r_[True, height[1:] != height[:-1]]
    levels: Integers = order[is_level]
    if policy == "lowest":
        levels = order[is_new]
    elif policy == "highest":
        levels = levels[np.r_[which[levels][1:] != which[levels][:-1], True]]
    return levels


def merged(files: Sequence[Path], apart: Sequence[Path], rows: int) -> Iterator[Integers]:
    """Merge lists of duplicates."""
    lowest: dict[int, int] = {}
    named = np.array(sorted({row for path in apart for row in _kept(path)}), dtype=np.int64)
    for begin in range(0, rows, _STRETCH):
        found = _stretch(files, begin)
        lowest |= dict(found[np.isin(found[:, 0], named)].tolist())
        others = _stretch(apart, begin)
        known, place = np.unique(others[:, 1], return_inverse=True)
        others[:, 1] = np.array([lowest.get(row, row) for row in known.tolist()] or [0])[place]
        both = np.concatenate((found, others))
        yield both[np.argsort(both[:, 0])]


def _kept(path: Path) -> list[int]:
    """List the rows that duplicates of a chunk name, a stretch at a time."""
    pairs = np.load(path, mmap_mode="r")
    stretches = (pairs[i : i + _STRETCH, 1] for i in range(0, len(pairs), _STRETCH))
    return sorted({row for each in stretches for row in np.unique(each).tolist()})


def _stretch(files: Sequence[Path], begin: int) -> Integers:
    """Read the pairs of a stretch of rows from lists in their order."""
    found = [np.empty((0, 2), dtype=np.int64)]
    for path in files:
        pairs = np.load(path, mmap_mode="r")
        first, last = np.searchsorted(pairs[:, 0], (begin, begin + _STRETCH))
        found.append(np.array(pairs[first:last]))
    return np.concatenate(found)
