"""Where the parts of a cloud overlap: files, and the flight lines of a survey.

Strips flown obliquely overlap in little of the boxes around them. So the plane is divided into
square cells, twice as wide as rows are apart, and a row overlaps if its cell holds rows of another
part. Cells of a border count though files only touch.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from liftmesh._typing import Array, Floats, Indices

_BLOCK = 1 << 18  # rows at a time
_DENSE = 4  # cells for each row that a table may have
_FAR = 10  # times the longest side of a box: what is unlikely of tiles of one survey


@dataclass(frozen=True, slots=True)
class Overlap:
    """Rows in cells that others have, too."""

    cell: float  # the width of a cell
    rows: list[int]  # of each part, rows in cells of earlier parts
    lines: int  # flight lines
    between: int  # rows in cells of several flight lines


def overlap_of(points: Floats, sizes: Sequence[int], lines: Array | None) -> Overlap:
    """Count where parts of a cloud, and flight lines, overlap."""
    ends = np.cumsum(sizes, dtype=np.intp).tolist()
    parts = [slice(end - size, end) for end, size in zip(ends, sizes, strict=True)]
    cell = _width(points, parts)
    grid = _Grid(points, cell)
    seen, rows = np.zeros(grid.count, np.bool_), []
    for part in parts:
        rows.append(sum(int(np.count_nonzero(seen[each])) for each, _ in grid.cells(part)))
        for each, _ in grid.cells(part):
            seen[each] = True
    count, between = (0, 0) if lines is None else _between(grid, lines)
    return Overlap(cell, rows, count, between)


def distances_of(points: Floats, sizes: Sequence[int]) -> list[float]:
    """Return how far each part of a cloud is from those before it; 0 where that is not far."""
    ends = np.cumsum(sizes, dtype=np.intp).tolist()
    parts = [points[end - size : end, :2] for end, size in zip(ends, sizes, strict=True)]
    boxes = {k: _box(each) for k, each in enumerate(parts) if np.isfinite(each).all(axis=1).any()}
    far, least, most = [0.0] * len(parts), np.full(2, np.inf), np.full(2, -np.inf)
    with np.errstate(over="ignore"):
        longest = max((float((high - low).max()) for low, high in boxes.values()), default=0.0)
        for k, (low, high) in boxes.items():
            step = np.maximum(np.maximum(low - most, least - high), 0)
            distance = math.hypot(*step.tolist()) if least[0] <= most[0] else 0.0
            far[k] = distance if distance > _FAR * longest > 0 else 0.0
            least, most = np.minimum(least, low), np.maximum(most, high)
    return far


def _between(grid: _Grid, lines: Array) -> tuple[int, int]:
    """Count the flight lines, and the rows in cells of several."""
    values, numbers = np.unique(lines, return_inverse=True)
    if len(values) < 2:
        return len(values), 0
    owner, mixed = np.zeros(grid.count, np.int32), np.zeros(grid.count, np.bool_)
    everything = slice(0, len(lines))
    for cells, rows in grid.cells(everything):
        owner[cells] = numbers[rows]
    for cells, rows in grid.cells(everything):
        mixed[cells[owner[cells] != numbers[rows]]] = True
    between = sum(int(np.count_nonzero(mixed[cells])) for cells, _ in grid.cells(everything))
    return len(values), between


class _Grid:
    """Numbers the cells of rows: by place, or if these are too many, those that hold any."""

    def __init__(self, points: Floats, cell: float) -> None:
        self._points = points
        self._cell = cell
        low, high = _box(points)
        self._low = low
        with np.errstate(over="ignore", invalid="ignore"):
            across, down = np.floor((high - low) / cell) + 1
        self._width = across
        self._known: Array | None = None
        self.count = 1
        if across * down <= _DENSE * len(points) + _BLOCK:
            self.count = max(int(across * down), 1)
        else:
            self._known = np.unique(np.concatenate([k for k, _ in self._keys(slice(None))]))
            self.count = max(len(self._known), 1)

    def cells(self, part: slice) -> Iterator[tuple[Indices, Indices]]:
        """Yield the cells of finite rows of a part, and these rows, in blocks."""
        for keys, rows in self._keys(part):
            if self._known is None:
                yield keys.astype(np.intp), rows
            else:
                yield np.searchsorted(self._known, keys), rows

    def _keys(self, part: slice) -> Iterator[tuple[Floats, Indices]]:
        begin, end, _ = part.indices(len(self._points))
        for start in range(begin, end, _BLOCK):
            plane = self._points[start : min(start + _BLOCK, end), :2]
            rows = np.flatnonzero(np.isfinite(plane).all(axis=1))
            places = np.floor((plane[rows] - self._low) / self._cell)
            yield places[:, 1] * self._width + places[:, 0], rows + start


def _blocks(points: Floats) -> Iterator[Floats]:
    yield from (points[k : k + _BLOCK, :2] for k in range(0, len(points), _BLOCK))


def _box(points: Floats) -> tuple[Floats, Floats]:
    """Return the least and the largest finite coordinates."""
    low, high = np.full(2, np.inf), np.full(2, -np.inf)
    for plane in _blocks(points):
        rows = np.isfinite(plane).all(axis=1)
        if rows.any():
            low = np.minimum(low, plane[rows].min(axis=0))
            high = np.maximum(high, plane[rows].max(axis=0))
    return (low, high) if low[0] <= high[0] else (np.zeros(2), np.zeros(2))


def _width(points: Floats, parts: Sequence[slice]) -> float:
    """Return twice the distance of rows that fill the boxes of their parts evenly."""
    area = longest = 0.0
    for each in parts:
        plane = points[each]
        low, high = _box(plane)
        with np.errstate(over="ignore"):
            width, height = high - low
            area += float(width * height)
        longest = max(longest, float(width), float(height))
    count = max(len(points), 1)
    cell = 2 * math.sqrt(area / count) or 2 * longest / count
    return cell if 0 < cell < math.inf else 1.0
