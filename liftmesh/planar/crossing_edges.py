"""Edges that cross where no row is: named in an error, or split at new rows.

A crossing has rational coordinates, and the new row is the nearest float64 of each. The parts of
both edges then bend by that rounding, and may cross others: so the crossings are sought again,
until there are none. Where many edges lie within a few units in the last place, there would be more
in each round: then an error names a place. The result is exact for the rounded points.
Displacements are distances of the rows from the edges that the caller gave, so they tell of all
rounds together.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np

from liftmesh._typing import Array, Integers, Reals, Rows
from liftmesh.base.arrays import pair_keys, widened
from liftmesh.base.options import counted
from liftmesh.errors import CrossingError, InputError, Option
from liftmesh.planar.constraints import Constraints, match_rows

Build: TypeAlias = Callable[[Reals, Rows], Any]  # of the kernel: its last item are the crossings

_MOST_ROUNDS = 64
_GROWTH, _ALLOWANCE = 4, 200  # crossings of a round, by those of the first
_NAMED, _MOST_PLACES = 10, 10_000


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
    places = [_crossing(each) for each in _ends(points, rows[:_MOST_PLACES])]
    named = [
        f"{given.named(e)} from {_named(points, a)} to {_named(points, b)} and {given.named(f)} "
        f"from {_named(points, c)} to {_named(points, d)}, at {place}"
        for (e, f), (a, b, c, d), place in zip(
            pairs[:_NAMED].tolist(), rows[:_NAMED].tolist(), places[:_NAMED], strict=True
        )
    ]
    rest = f"; and {len(pairs) - _NAMED:,} more" if len(pairs) > _NAMED else ""
    return CrossingError(
        f"{counted(len(pairs), 'pair')} of edges cross{'es' * (len(pairs) == 1)} where no row is: "
        f"{'; '.join(named)}{rest}. "
        f"Add their crossings as points, or {remedy}",
        crossings=pairs,
        rows=rows,
        places=np.array(places).reshape(-1, 2),
    )


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


def split_crossings(points: Reals, given: Constraints, build: Build) -> Split:
    """Build, insert what crosses, and build again until nothing does."""
    edges = given.edges
    split = Split(points, edges, np.arange(len(edges), dtype=np.int32))
    number = most = 0
    while True:
        split.built = build(split.points, split.edges)
        *_, zero_length, _, crossings = split.built
        if not len(crossings):
            return split
        if number == 0:
            most = _GROWTH * len(crossings) + _ALLOWANCE
        if number == _MOST_ROUNDS or len(crossings) > most:
            raise _unending(split, given, crossings[0], number)
        _insert(split, crossings, points, edges)
        if number == 0:  # later, ends of parts may be at one position
            split.zero_length = zero_length
        number += 1


def _unending(split: Split, given: Constraints, pair: Rows, rounds: int) -> InputError:
    """Name a place where edges still cross."""
    e, f = split.origins[pair].tolist()
    (ends,) = _ends(split.points, split.edges[pair].reshape(1, 4))
    place = _crossing(ends)
    return InputError(
        f"edges still cross after {counted(rounds, 'round')} of {Option('crossing', 'split')}, as "
        f"{given.named(e)} and {given.named(f)} do at {place}: too many edges are nearer to each "
        "other than float64 can tell apart; move them, or leave some out"
    )


def _insert(split: Split, crossings: Rows, points: Reals, edges: Rows) -> None:
    """Put a row at each crossing, and split both edges there."""
    ends = _ends(split.points, split.edges[crossings].reshape(-1, 4))
    places = np.array([_crossing(each) for each in ends])
    rows, added = match_rows(widened(split.points), places)
    split.points = np.concatenate([widened(split.points), places[added]])
    at: dict[int, list[int]] = defaultdict(list)
    for pair, row in zip(crossings.tolist(), rows.tolist(), strict=True):
        for edge in pair:
            at[edge].append(row)
    parts, origins = [], []
    for edge, several in at.items():
        tail, head = split.edges[edge].tolist()
        # Rounding keeps the order of crossings along both axes, or makes them equal.
        toward = np.where(split.points[tail] <= split.points[head], 1, -1)
        x, y = (split.points[several] * toward).T
        chain = [tail, *np.array(several)[np.lexsort((y, x))].tolist(), head]
        chain = [row for k, row in enumerate(chain) if k == 0 or row != chain[k - 1]]
        parts += list(pairwise(chain))
        origins += [split.origins[edge]] * (len(chain) - 1)
        line = points[edges[split.origins[edge]]].ravel().tolist()
        far = max(_distance([*line, *each]) for each in split.points[several].tolist())
        split.displacement = max(split.displacement, far)
    kept = np.ones(len(split.edges), dtype=np.bool_)
    kept[list(at)] = False
    split.edges = np.concatenate([split.edges[kept], np.array(parts, dtype=np.int32)])
    split.origins = np.concatenate([split.origins[kept], np.array(origins, dtype=np.int32)])


def _ends(points: Array, rows: Rows) -> list[list[float]]:
    """Return the coordinates of the ends of pairs of edges."""
    ends: list[list[float]] = points[rows].reshape(len(rows), 8).tolist()
    return ends


def _named(points: Array, row: int) -> str:
    return f"row {row} {tuple(points[row].tolist())}"


def _integers(coordinates: list[float]) -> tuple[list[int], int]:
    """Return coordinates times a power of two that makes integers of all, and that power."""
    ratios = [each.as_integer_ratio() for each in coordinates]
    scale = max(under for _, under in ratios)
    return [over * (scale // under) for over, under in ratios], scale


def _crossing(ends: list[float]) -> tuple[float, float]:
    """Return where two edges cross: Python rounds the quotient of integers once."""
    (ax, ay, bx, by, cx, cy, dx, dy), scale = _integers(ends)
    above = (dx - cx) * (ay - cy) - (dy - cy) * (ax - cx)
    below = (dx - cx) * (by - cy) - (dy - cy) * (bx - cx)
    whole = above - below
    x, y = ax * whole + above * (bx - ax), ay * whole + above * (by - ay)
    return x / (whole * scale), y / (whole * scale)


def _distance(line_and_point: list[float]) -> float:
    """Return the distance of a point from a line, rounded."""
    (ax, ay, bx, by, px, py), scale = _integers(line_and_point)
    turn = (bx - ax) * (py - ay) - (by - ay) * (px - ax)
    over, under = turn * turn, ((bx - ax) ** 2 + (by - ay) ** 2) * scale * scale
    shift = (over.bit_length() - under.bit_length()) // 2  # the square may be out of range
    over, under = over << max(-2 * shift, 0), under << max(2 * shift, 0)
    return math.ldexp(math.sqrt(over / under), shift)


def origins_of(indptr: Rows, members: Rows, origins: Rows) -> tuple[Rows, Rows]:
    """Return the input edges of each piece, ascending and once, for those of parts of edges."""
    piece = np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))
    keys: Integers = np.unique(pair_keys(piece, origins[members]))
    starts = np.searchsorted(keys, np.arange(len(indptr)) << 32)
    return starts.astype(np.int32), (keys & 0xFFFFFFFF).astype(np.int32)
