"""Edges that cross where no row is: named in an error, or split at new rows.

A crossing has rational coordinates, and the new row is the nearest float64 of each. The parts of
both edges then bend by that rounding, and may cross others: so the crossings are sought again,
until there are none. Edges that are the same line but for rounding would cross anew in each round,
one unit in the last place further out: so from the second round on, the end of a part that is near
is taken instead, within a bound that grows. Where many edges lie within a few such units, there may
still be more crossings in each round: then an error names a place. The result is exact for the
rounded points. Displacements are distances of the rows from the edges that the caller gave, so they
tell of all rounds together.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Integers, Progress, Reals, Rows
from liftmesh.base.arrays import distinct, pair_keys, widened
from liftmesh.base.options import Part, counted, part_of
from liftmesh.errors import CrossingError, Option
from liftmesh.planar.constraints import Constraints, match_rows

Build: TypeAlias = Callable[[Reals, Rows, Part | None], Any]  # its last item are the crossings

_MOST_ROUNDS = 64
_MOST_DOUBLINGS = 30  # of the bound, two in each round
_GROWTH, _ALLOWANCE = 4, 200  # crossings of a round, by those of the first
_NAMED, _MOST_PLACES = 10, 10_000
TOO_NEAR = (
    "edges there are nearer to each other than float64 can tell apart; move them, or leave some out"
)


def crossing_error(
    points: Array, given: Constraints, crossings: Rows, remedy: str
) -> CrossingError:
    """Name the crossings in an order that the order and direction of edges do not change."""
    edges = given.edges
    ends = np.sort(edges[crossings], axis=2)  # (c, 2, 2)
    is_later = pair_keys(*ends[:, 0].T) > pair_keys(*ends[:, 1].T)
    pairs = np.where(is_later[:, None], crossings[:, ::-1], crossings)
    rows = np.where(is_later[:, None, None], ends[:, ::-1], ends).reshape(-1, 4)
    order = np.lexsort((*pairs.T[::-1], *rows.T[::-1]))
    pairs, rows = pairs[order], rows[order]
    places = _places(points, rows[:_MOST_PLACES])
    shown = zip(pairs[:_NAMED], rows[:_NAMED], places[:_NAMED], strict=True)
    named = [_told(points, given, *each) for each in shown]
    rest = f"; and {len(pairs) - _NAMED:,} more" if len(pairs) > _NAMED else ""
    return CrossingError(
        f"{counted(len(pairs), 'pair')} of edges cross{'es' * (len(pairs) == 1)} where no row is: "
        f"{'; '.join(named)}{rest}. "
        f"Add their crossings as points, or {remedy}",
        crossings=pairs,
        rows=rows,
        places=places,
    )


def _told(points: Reals, given: Constraints, pair: Rows, rows: Rows, place: Floats) -> str:
    """Name two edges with the rows where they end, and where they cross."""
    e, f = map(given.named, pair.tolist())
    a, b, c, d = (_named(points, row) for row in rows.tolist())
    return f"{e} from {a} to {b} and {f} from {c} to {d}, at {tuple(place.tolist())}"


@dataclass(slots=True, eq=False)
class Split:
    """Edges that are split at crossings, with what became of them."""

    points: Reals  # with new rows
    edges: Rows
    origins: Rows  # the input edge of each
    displacement: float = 0.0  # the largest distance of a row from an input edge that it splits
    zero_length: Rows = field(default_factory=lambda: np.empty(0, dtype=np.int32))
    built: Any = None
    own: int = field(init=False)  # rows without new ones

    def __post_init__(self) -> None:
        self.own = len(self.points)


def split_crossings(
    points: Reals, given: Constraints, build: Build, progress: Progress | None
) -> Split:
    """Build, insert what crosses, and build again until nothing does."""
    edges = given.edges
    split = Split(points, edges, np.arange(len(edges), dtype=np.int32))
    number = most = 0
    while True:
        part = part_of(progress, 1 - 0.5**number, 1 - 0.5 ** (number + 1))  # half of what is left
        split.built = build(split.points, split.edges, part)
        *_, zero_length, _, crossings = split.built
        if not len(crossings):
            return split
        if number == 0:
            most = _GROWTH * len(crossings) + _ALLOWANCE
        if number == _MOST_ROUNDS or len(crossings) > most:
            raise _unending(split, given, crossings[0], number)
        _insert(split, crossings, points, edges, number)
        if part is not None:
            part(1.0)
        if number == 0:  # later, ends of parts may be at one position
            split.zero_length = zero_length
        number += 1


def _unending(split: Split, given: Constraints, pair: Rows, rounds: int) -> CrossingError:
    """Name a place where edges still cross."""
    places = _places(split.points, split.edges[pair].reshape(1, 4))
    pair = split.origins[pair]
    rows = given.edges[pair].reshape(1, 4)
    return CrossingError(
        f"edges still cross after {counted(rounds, 'round')} of {Option('crossing', 'split')}: "
        f"{_told(split.points, given, pair, rows[0], places[0])}: {TOO_NEAR}",
        crossings=pair[None],
        rows=rows,
        places=places,
    )


def _insert(split: Split, crossings: Rows, points: Reals, edges: Rows, number: int) -> None:
    """Put a row at each crossing, or take one near it, and split both edges there."""
    rows = split.edges[crossings].reshape(-1, 4)
    places = _places(split.points, rows)
    if number:
        places = _or_ends(places, split.points[rows], min(2 * number, _MOST_DOUBLINGS))
    taken, added = match_rows(widened(split.points), places)
    split.points = np.concatenate([widened(split.points), places[added]])
    edge, row = crossings.ravel(), np.repeat(taken, 2)
    far = distances(points[edges[split.origins[edge]]], split.points[row]).max()
    split.displacement = max(split.displacement, float(far))
    is_inside = (row[:, None] != split.edges[edge]).all(axis=1)
    _divide(split, edge[is_inside], row[is_inside])


def _divide(split: Split, edge: Integers, row: Integers) -> None:
    """Put parts between the rows of each edge in its place."""
    cut = distinct(edge)
    tail, head = split.edges[cut].T
    rank = np.repeat([0, 1, 2], [len(cut), len(edge), len(cut)])
    edge, row = np.concatenate([cut, edge, cut]), np.concatenate([tail, row, head])
    # Along the longer axis first: rounding keeps the order there, or makes places equal.
    ends = split.points[split.edges[edge]] / 2
    steps, places = ends[:, 1] - ends[:, 0], split.points[row]
    is_steep = np.abs(steps[:, 1]) > np.abs(steps[:, 0])
    steps = np.where(steps == 0, steps[:, ::-1], steps)  # turned around, the order is the same
    along = np.where(steps < 0, -places, places)
    along[is_steep] = along[is_steep, ::-1]
    order = np.lexsort([*along.T[::-1], rank, edge])
    edge, row = edge[order], row[order]
    is_part = (edge[1:] == edge[:-1]) & (row[1:] != row[:-1])
    parts = np.stack([row[:-1], row[1:]], axis=1)[is_part]
    kept = np.ones(len(split.edges), dtype=np.bool_)
    kept[cut] = False
    split.edges = np.concatenate([split.edges[kept], parts.astype(np.int32)])
    split.origins = np.concatenate([split.origins[kept], split.origins[edge[:-1][is_part]]])


def _or_ends(places: Floats, ends: Reals, doublings: int) -> Floats:
    """Replace places by the nearest end of both parts within so many doublings of an ulp."""
    gaps = np.abs(ends / 2 - places[:, None] / 2).max(axis=2)
    nearest = np.lexsort((ends[..., 1], ends[..., 0], gaps), axis=1)[:, :1]
    bound = np.ldexp(np.spacing(np.abs(ends).max(axis=(1, 2))), doublings - 1)
    is_near = np.take_along_axis(gaps, nearest, axis=1) <= bound[:, None]
    return np.where(is_near, np.take_along_axis(ends, nearest[..., None], axis=1)[:, 0], places)


def _places(points: Array, rows: Rows) -> Floats:
    """Return where pairs of edges cross, rounded once."""
    ends = points[rows].reshape(len(rows), 8).astype(np.float64)
    places = np.empty((len(rows), 2))
    _kernel.crossing_places(ends, places)
    open_ones = np.isnan(places[:, 0])
    if open_ones.any():
        places[open_ones] = [_crossing(each) for each in ends[open_ones].tolist()]
    return places


def distances(lines: Reals, places: Reals) -> Floats:
    """Return the distances of points, (k, 2), from lines through two points each, (k, 2, 2)."""
    found = np.empty(len(places))
    _kernel.distances(np.hstack([lines.reshape(-1, 4), places]).astype(np.float64), found)
    return found


def _named(points: Array, row: int) -> str:
    return f"row {row} {tuple(points[row].tolist())}"


def _crossing(ends: list[float]) -> tuple[float, float]:
    """Return where two edges cross: Python rounds the quotient of integers once."""
    ratios = [each.as_integer_ratio() for each in ends]
    scale = max(under for _, under in ratios)  # powers of two
    ax, ay, bx, by, cx, cy, dx, dy = (over * (scale // under) for over, under in ratios)
    above = (dx - cx) * (ay - cy) - (dy - cy) * (ax - cx)
    below = (dx - cx) * (by - cy) - (dy - cy) * (bx - cx)
    whole = above - below
    x, y = ax * whole + above * (bx - ax), ay * whole + above * (by - ay)
    return x / (whole * scale), y / (whole * scale)


def origins_of(indptr: Rows, members: Rows, origins: Rows) -> tuple[Rows, Rows]:
    """Return the input edges of each piece, ascending and once, for those of parts of edges."""
    piece = np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))
    keys: Integers = distinct(pair_keys(piece, origins[members]))
    starts = np.searchsorted(keys, np.arange(len(indptr)) << 32)
    return starts.astype(np.int32), (keys & 0xFFFFFFFF).astype(np.int32)
