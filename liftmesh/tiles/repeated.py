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
    """Return x and y as one number for each row, where 0 and -0 are equal.

    Parameters
    ----------
    rows : (n, 2) ndarray of float64
        Points.

    Returns
    -------
    (n,) ndarray of complex128
        Ordered as the points, by x, then y.
    """
    found: Array = np.ascontiguousarray(rows + 0.0).view(np.complex128).reshape(-1)
    return found


def frequent(sample: Floats) -> tuple[Floats, Floats]:
    """Find positions that are often in a sample.

    Parameters
    ----------
    sample : (n, 2) ndarray of float64
        Finite points.

    Returns
    -------
    positions : (h, 2) ndarray of float64
        The frequent ones, ascending.
    others : (k, 2) ndarray of float64
        The sample, with each of them once.
    """
    found, first, counts = np.unique(positions_of(sample), return_index=True, return_counts=True)
    often = found[counts >= _OFTEN]
    is_other = ~np.isin(positions_of(sample), often)
    is_other[first] = True
    return often.view(np.float64).reshape(-1, 2), sample[is_other]


def set_apart(rows: Floats, repeated: Floats) -> tuple[Integers, Integers, Integers]:
    """Replace all rows but the first at each of some positions by NaN.

    Parameters
    ----------
    rows : (n, 2) ndarray of float64
        Points, which are changed.
    repeated : (h, 2) ndarray of float64
        Ascending positions.

    Returns
    -------
    apart : (k,) ndarray of int64
        The rows that were replaced, ascending.
    which : (k,) ndarray of int64
        The position of each.
    firsts : (h,) ndarray of int64
        The first row at each position; -1 where there is none.
    """
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
    rows[found[is_apart]] = np.nan
    return found[is_apart], which[is_apart], firsts


def merged(files: Sequence[Path], apart: Sequence[Path], rows: int) -> Iterator[Integers]:
    """Merge lists of duplicates.

    Parameters
    ----------
    files : sequence of Path
        Lists of tiles, (k, 2) int64 by ascending row, with the lowest row at each position.
    apart : sequence of Path
        Lists of chunks, with the lowest row at each position in the chunk.
    rows : int
        The number of rows of the source.

    Yields
    ------
    (k, 2) ndarray of int64
        Duplicates by ascending row, each with the lowest row at its position.
    """
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
