"""Planar points: those of clouds and meshes, their distinct positions, and how near these are.

The segment from a point to its nearest neighbour is an edge of every Delaunay triangulation: the
circle with this diameter lies inside the circle around the point through the neighbour, so no other
point is in it or on it. So the shortest edge at a vertex leads to its nearest neighbour (M. I.
Shamos and D. Hoey, "Closest-point problems", 1975), however different the distances are. On a line,
neighbours follow each other.

Arrays are processed in pieces, between which a signal is handled.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liftmesh import _kernel
from liftmesh._typing import Floats, Mask, Reals, Rows
from liftmesh.base.arrays import as_coordinates, lower_to
from liftmesh.base.options import as_threads


def rows_of(points: Any, *, has_heights: bool = False) -> Any:
    """Return the points of a cloud or mesh; a table may lack heights. Arrays stay as they are."""
    if isinstance(points, np.ndarray):
        is_record = points.dtype.names is not None
    else:
        is_record = not isinstance(points, list | tuple)
    if not is_record:
        return points
    from liftmesh.io import registry  # noqa: PLC0415 - arrays do without

    return registry.rows_of(points, has_heights=has_heights)


_PIECE = 1 << 15  # of so many triangles, the points fit the cache


@dataclass(frozen=True, slots=True, eq=False)
class Positions:
    """The distinct positions of planar points."""

    count: int
    collinear: bool  # or fewer than three
    duplicates: Rows  # (k, 2): rows whose position an earlier row has, each with the first such row
    # The median distance to the nearest other position: infinite if it exceeds float64, None for
    # fewer than two.
    spacing: float | None


def find_positions(points: ArrayLike) -> Positions:
    """Find the distinct positions of points that are finite, and their spacing, at every scale."""
    rows = as_coordinates(points)[:, :2]
    run = (rows, True, *as_threads(None, len(rows)), None)
    status, _, count, simplices, _, _, duplicates, skipped = _kernel.delaunay(*run)
    is_first = np.ones(len(rows), dtype=np.bool_)
    is_first[duplicates[:, 0]] = False
    is_first[skipped] = False
    with np.errstate(all="ignore"):
        if status == "ok":
            nearest = _shortest_edges(rows, simplices)[is_first]
        else:
            nearest = _gaps_on_line(rows, is_first)
        return Positions(count, status != "ok", duplicates, _median(nearest))


def edges_around(cycle: Rows) -> Rows:
    """Return the edges of a closed cycle of rows, from each to the next."""
    return np.stack([cycle, np.roll(cycle, -1)], axis=1)


def pieces(length: int, size: int = _PIECE) -> Iterator[slice]:
    """Cut an array into pieces."""
    return (slice(start, start + size) for start in range(0, length, size))


def _shortest_edges(rows: Reals, simplices: Rows) -> Floats:
    """Return the length of the shortest edge at each row; infinite for those without a triangle."""
    shortest = np.full(len(rows), np.inf)
    points = as_complex(rows)
    for piece in pieces(len(simplices)):
        corners = simplices[piece].reshape(-1)
        a, b, c = points.take(corners, axis=0).reshape(-1, 3).T
        ab, bc, ca = np.abs(a - b), np.abs(b - c), np.abs(c - a)
        at_corners = np.stack([np.minimum(ab, ca), np.minimum(ab, bc), np.minimum(bc, ca)], axis=1)
        lower_to(shortest, corners, at_corners.reshape(-1))
    return shortest


def as_complex(rows: Reals) -> NDArray[np.complex128]:
    """Return x + iy of each row: one gather fetches both, and the absolute value is scaled."""
    numbers = np.empty(len(rows), dtype=np.complex128)
    for piece in pieces(len(rows)):
        numbers.real[piece], numbers.imag[piece] = rows[piece].T
    return numbers


def _gaps_on_line(rows: Reals, is_first: Mask) -> Floats:
    """Return the distance from each of some collinear positions to the nearer one beside it."""
    x, y = rows[is_first].T.astype(np.float64)
    if len(x) < 2:
        return np.empty(0)
    is_falling = y[x.argmax()] < y[x.argmin()]
    x, y = _sorted(x), _sorted(-y if is_falling else y)
    gaps = np.hypot(np.diff(x), np.diff(y))
    nearest: Floats = np.minimum(np.append(gaps, np.inf), np.insert(gaps, 0, np.inf))
    return nearest


def _sorted(values: Floats) -> Floats:
    """Sort in pieces, then merge them."""
    values = values.copy()
    for piece in pieces(len(values), 1 << 20):
        values[piece].sort()
    values.sort(kind="stable")
    return values


def _median(values: Floats) -> float | None:
    """Compute the median of values that are not negative, without overflow."""
    if len(values) == 0:
        return None
    places = (len(values) - 1) // 2, len(values) // 2
    low, high = np.partition(values, places)[list(places)].tolist()
    return float(low if low == high else low + (high - low) / 2)
