"""Which samples of a raster are read: every k-th of both directions, in the window of a box.

Where the axes of the raster are those of the plane, the box ends at exact columns and rows, found
by bisection of the centres of pixels; of rotated rasters the window surrounds the box. Samples are
decoded in pieces, so that blocks between them, if they are worth it, are not decoded at all.
"""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from liftmesh.io.selection import Selection
    from liftmesh.raster.sidecars import Transform

_BLOCK = 1 << 20  # samples decoded at a time
_CALL = 1 << 14  # samples whose decoding takes as long as a call


class Window(NamedTuple):
    """Rows and columns that are read, and the number of samples left out, by reason."""

    rows: range
    columns: range
    outside: int
    between: int

    @property
    def samples(self) -> int:
        """The number of samples that are read."""
        return len(self.rows) * len(self.columns)


def window_of(transform: Transform, width: int, height: int, selection: Selection | None) -> Window:
    """Find the samples to read."""
    step = 1 if selection is None else selection.every
    rows, columns = range(height), range(width)
    if selection is not None and selection.bbox is not None:
        rows, columns = _in_box(transform, rows, columns, selection.bbox)
    inside = len(rows) * len(columns)
    rows, columns = _stepping(rows, step), _stepping(columns, step)
    between = inside - len(rows) * len(columns)
    return Window(rows, columns, width * height - inside, between)


def _in_box(
    place: Transform, rows: range, columns: range, box: tuple[float, float, float, float]
) -> tuple[range, range]:
    if place.b == place.d == 0 and place.a and place.e:
        columns = _between(columns, lambda k: place.a * (k + 0.5) + place.c, box[0], box[2])
        rows = _between(rows, lambda k: place.e * (k + 0.5) + place.f, box[1], box[3])
        return rows, columns
    determinant = place.a * place.e - place.b * place.d
    corners = [(x - place.c, y - place.f) for x in box[::2] for y in box[1::2]]
    if not determinant or not all(map(math.isfinite, (determinant, *box))):
        return rows, columns
    across = [(place.e * x - place.b * y) / determinant for x, y in corners]
    down = [(place.a * y - place.d * x) / determinant for x, y in corners]
    return _around(rows, down), _around(columns, across)


def _between(all_of: range, center: Callable[[int], float], low: float, high: float) -> range:
    """Bisect for the centres from low to high, which increase or decrease."""
    if center(0) > center(len(all_of)):
        first = bisect_left(all_of, -high, key=lambda k: -center(k))
        return all_of[first : bisect_right(all_of, -low, key=lambda k: -center(k))]
    return all_of[bisect_left(all_of, low, key=center) : bisect_right(all_of, high, key=center)]


def _around(all_of: range, places: list[float]) -> range:
    """Take what lies between the places, and two more on either side, for rounding."""
    low, high = (min(max(each, -4), len(all_of) + 4) for each in (min(places), max(places)))
    return all_of[max(math.floor(low) - 2, 0) : max(math.ceil(high) + 2, 0)]


def _stepping(some: range, step: int) -> range:
    return range(some.start + -some.start % step, some.stop, step)


class Band(NamedTuple):
    """Consecutive rows of a window, and the rows and columns of it that are decoded at once."""

    rows: range
    down: list[range]
    across: list[range]


def bands_of(window: Window, block: tuple[int, int]) -> Iterator[Band]:
    """Split a window into bands of at most about a million samples."""
    pieces = _columns_of(window.columns, block)
    width = max((each[-1] + 1 - each.start for each in pieces), default=1)
    apart = _pays(window.rows.step, block[0], width)
    taken = 1 if apart else window.rows.step
    count = max(_BLOCK // max(taken * width, len(window.columns)), 1)
    for first in range(0, len(window.rows), count):
        rows = window.rows[first : first + count]
        yield Band(rows, [rows[k : k + 1] for k in range(len(rows))] if apart else [rows], pieces)


def _columns_of(columns: range, block: tuple[int, int]) -> list[range]:
    """Split columns where blocks between them are left out, and where they are very many."""
    apart = _pays(columns.step, block[1], block[0])
    count = 1 if apart else max(_BLOCK // columns.step, 1)
    return [columns[first : first + count] for first in range(0, len(columns), count)]


def _pays(step: int, size: int, across: int) -> bool:
    """Whether not decoding what lies between two samples is worth a call for each."""
    return (step - size) * across > _CALL
