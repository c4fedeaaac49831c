"""Voids of rasters, filled from the nearest pixels.

A pixel without a value gets that of the nearest pixel with one, of several the least, if it is not
farther than a distance, from centre to centre. So it depends on the pixels within that distance
alone, not on the block it is computed in. Distances are counted in sides of pixels: where these are
square, as whole numbers.

The nearest is found in two steps (Rosenfeld, Pfaltz 1966): first in each column, then among the
columns to both sides, until none can be nearer. SciPy's distance transform names one of the nearest
pixels, and does not say which of several.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from liftmesh._typing import Array, Floats, Mask
from liftmesh.base.arrays import as_decimal
from liftmesh.base.options import as_positive
from liftmesh.errors import InputError

_TOGETHER = 1 << 22  # pixels that are filled at a time
_NONE = 1 << 30  # rows between pixels and those with values, if there are none


class Reach(NamedTuple):
    """How far pixels are filled from."""

    rows: int
    columns: int
    down: float  # the squares of the sides of a pixel, in those of the shorter one
    across: float
    most: float  # the square of the distance

    @classmethod
    def of(cls, distance: float, transform: Sequence[float], name: str) -> Reach:
        """Count a distance in pixels."""
        given = as_decimal(as_positive(name, distance))
        a, b, _, d, e, _ = transform
        if a * b + d * e != 0:
            raise InputError(
                "the rows and columns of pixels are not at right angles: fill a raster whose "
                "transform has no shear"
            )
        across, down = (as_decimal(np.hypot(*side)) for side in ((a, d), (b, e)))
        unit = min(across, down)
        given = min(given, _NONE * unit)
        squares = (float((each / unit) ** 2) for each in (down, across, given))
        return cls(int(given / down), int(given / across), *squares)

    def around(self, pixels: range, count: int, margin: int) -> range:
        """Widen a range of so many rows, or columns, by a margin."""
        return range(max(pixels.start - margin, 0), min(pixels.stop + margin, count))


def filled(values: Array, reach: Reach) -> Array:
    """Fill the voids of a raster, some rows at a time."""
    rows, columns = values.shape
    count = max(_TOGETHER // columns, reach.rows, 1)
    found = np.empty_like(values)
    for first in range(0, rows, count):
        some = range(first, min(first + count, rows))
        wide = reach.around(some, rows, reach.rows)
        block = filled_block(values[wide.start : wide.stop], reach)
        found[some.start : some.stop] = block[some.start - wide.start :][: len(some)]
    return found


def filled_block(values: Array, reach: Reach) -> Array:
    """Fill the voids of a block from its own pixels."""
    has_value = ~np.isnan(values)
    found: Array = values.copy()
    if has_value.all() or not has_value.any():
        return found
    gap, near = _in_columns(values, has_value)
    rows, columns = np.nonzero(~has_value & _may_be_filled(gap, reach))
    square, best = gap[rows, columns] * reach.down, near[rows, columns]
    best[square > reach.most] = np.nan
    square[square > reach.most] = np.inf
    open_ones = np.arange(len(rows))
    for step in range(1, min(reach.columns, values.shape[1] - 1) + 1):
        aside = step * step * reach.across
        open_ones = open_ones[square[open_ones] >= aside]
        for move in (-step, step):
            beside = columns[open_ones] + move
            is_in = (beside >= 0) & (beside < values.shape[1])
            some, at = open_ones[is_in], (rows[open_ones[is_in]], beside[is_in])
            other, value = gap[at] * reach.down + aside, near[at]
            is_nearer = (other < square[some]) | ((other == square[some]) & (value < best[some]))
            is_nearer &= other <= reach.most
            square[some[is_nearer]], best[some[is_nearer]] = other[is_nearer], value[is_nearer]
    found[rows, columns] = best
    return found


def _in_columns(values: Array, has_value: Array) -> tuple[Floats, Array]:
    """Find the nearest value in the column of each pixel: the square of the rows to it, and it."""
    number = np.arange(len(values))[:, None]
    above = np.maximum.accumulate(np.where(has_value, number, -_NONE), axis=0)
    below = np.minimum.accumulate(np.where(has_value, number, _NONE)[::-1], axis=0)[::-1]
    up, down = number - above, below - number
    last = len(values) - 1
    upper, lower = (
        np.take_along_axis(values, np.clip(each, 0, last), axis=0) for each in (above, below)
    )
    near = np.where(up < down, upper, np.where(down < up, lower, np.fmin(upper, lower)))
    return np.minimum(up, down).astype(np.float64) ** 2, near


def _may_be_filled(gap: Floats, reach: Reach) -> Mask:
    """Tell which pixels have one with a value in the rectangle around them."""
    columns = gap.shape[1]
    margin = min(reach.columns, columns)
    near = np.pad(gap <= reach.rows**2, ((0, 0), (margin + 1, margin)))
    count = np.cumsum(near, axis=1, dtype=np.int32)
    return count[:, -columns:] > count[:, :columns]
