"""In which cell a ring of the domain lies that no polyline crosses.

From a place on the ring one goes straight to a segment of a polyline. The first segment on the way
has the ring on one of its sides, and the cell of that side is the one. Where the way meets a point
of a polyline, it could be that of several segments: another way is tried.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Floats, Indices
from liftmesh.cells.exact import Exact, as_exact, turn
from liftmesh.disks.sides import shares_in

if TYPE_CHECKING:
    from liftmesh.cells.domain import Domain
    from liftmesh.disks.sides import Traced

_NEAREST = 8  # segments to which ways are tried
_HALF = Fraction(1, 2)


def cell_at(lines: Traced, domain: Domain, begin: int, end: int, default: int) -> int:
    """Find the cell of a ring."""
    segments = lines.segments
    start, end_of = lines.points[segments], lines.points[segments + 1]
    low, high = shares_in(start, end_of, lines.box)
    seen = np.flatnonzero((low < high) & (start != end_of).any(axis=1))
    segments, start, end_of = segments[seen], start[seen], end_of[seen]
    share = (low[seen] + high[seen]) / 2
    for place, k in _ways(start + share[:, None] * (end_of - start), domain.corners[begin:end]):
        a, b = as_exact(start[k]), as_exact(end_of[k])
        target = _between(a, b, Fraction(float(share[k])))
        found = _first_side(start, end_of, place, target)
        if found is not None:
            line = int(np.searchsorted(lines.starts, segments[found[0]], side="right")) - 1
            return int(lines.rows[line, found[1]])
    return default


def _ways(targets: Floats, corners: Floats) -> Iterator[tuple[Exact, int]]:
    """Yield places on the ring, each with some of the targets: those next to the first place."""
    distance = np.hypot(*(targets - corners[0]).T)
    nearest = np.argsort(distance, kind="stable")[:_NEAREST].tolist()
    for first, last in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        a, b = as_exact(first), as_exact(last)
        for k in nearest:
            yield a, k
            yield _between(a, b, _HALF), k


def _between(a: Exact, b: Exact, share: Fraction) -> Exact:
    return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])


def _first_side(start: Floats, end: Floats, place: Exact, target: Exact) -> tuple[int, int] | None:
    """Return the first segment on a way, and on which of its sides that begins."""
    best: tuple[Fraction, int, int] | None = None
    for k in _near_way(start, end, place, target).tolist():
        a, b = as_exact(start[k]), as_exact(end[k])
        before, after = turn(a, b, place), turn(a, b, target)
        sides = turn(place, target, a), turn(place, target, b)
        if before * after > 0 or sides[0] * sides[1] > 0:
            continue
        if before == 0 or sides[0] == 0 or sides[1] == 0:
            return None
        share = before / (before - after)
        if best is None or share < best[0]:
            best = share, k, int(before < 0)
    return None if best is None else best[1:]


def _near_way(start: Floats, end: Floats, place: Exact, target: Exact) -> Indices:
    """Return the segments whose boxes meet that of a way."""
    ends = np.array([[float(x) for x in each] for each in (place, target)])
    margin = np.abs(ends).max() * 2.0**-50  # more than the rounding of both
    low, high = ends.min(axis=0) - margin, ends.max(axis=0) + margin
    near = (np.maximum(start, end) >= low).all(axis=1)
    near &= (np.minimum(start, end) <= high).all(axis=1)
    return np.flatnonzero(near)
