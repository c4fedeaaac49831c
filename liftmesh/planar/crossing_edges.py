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
from fractions import Fraction
from itertools import count, pairwise
from typing import Any, TypeAlias

import numpy as np

from liftmesh._typing import Array, Integers, Reals, Rows
from liftmesh.base.arrays import pair_keys, widened
from liftmesh.base.options import counted
from liftmesh.errors import CrossingError, InputError, Option
from liftmesh.planar.constraints import Constraints, match_rows

Exact: TypeAlias = tuple[Fraction, Fraction]
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
    known = _Points(points)
    places = [_rounded(known.crossing(*each)) for each in rows[:_MOST_PLACES].tolist()]
    named = [
        f"{given.named(e)} from {known.named(a)} to {known.named(b)} and {given.named(f)} from "
        f"{known.named(c)} to {known.named(d)}, at {place}"
        for (e, f), (a, b, c, d), place in zip(
            pairs[:_NAMED].tolist(), rows[:_NAMED].tolist(), places[:_NAMED], strict=True
        )
    ]
    rest = f"; and {len(pairs) - _NAMED:,} more" if len(pairs) > _NAMED else ""
    return CrossingError(
        f"{counted(len(pairs), 'pair')} of edges cross where no row is: {'; '.join(named)}{rest}. "
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
    most = 0
    for number in count():
        split.built = build(split.points, split.edges)
        *_, zero_length, _, crossings = split.built
        if not len(crossings):
            break
        if number == 0:
            most = _GROWTH * len(crossings) + _ALLOWANCE
        if number == _MOST_ROUNDS or len(crossings) > most:
            raise _unending(split, given, crossings[0], number)
        _insert(split, crossings, points, edges)
        if number == 0:  # later, ends of parts may be at one position
            split.zero_length = zero_length
    return split


def _unending(split: Split, given: Constraints, pair: Rows, rounds: int) -> InputError:
    """Name a place where edges still cross."""
    e, f = split.origins[pair].tolist()
    place = _rounded(_Points(split.points).crossing(*split.edges[pair].ravel().tolist()))
    return InputError(
        f"edges still cross after {counted(rounds, 'round')} of {Option('crossing', 'split')}, as "
        f"{given.named(e)} and {given.named(f)} do at {place}: too many edges are nearer to each "
        "other than float64 can tell apart; move them, or leave some out"
    )


def _insert(split: Split, crossings: Rows, points: Reals, edges: Rows) -> None:
    """Put a row at each crossing, and split both edges there."""
    known = _Points(split.points)
    exact = [known.crossing(*each) for each in split.edges[crossings].reshape(-1, 4).tolist()]
    places = np.array([_rounded(each) for each in exact])
    rows, added = match_rows(widened(split.points), places)
    split.points = np.concatenate([widened(split.points), places[added]])
    at: dict[int, list[tuple[Exact, int]]] = defaultdict(list)
    for pair, place, row in zip(crossings.tolist(), exact, rows.tolist(), strict=True):
        for edge in pair:
            at[edge].append((place, row))
    given, placed = _Points(points), _Points(split.points)
    parts, origins = [], []
    for edge, several in at.items():
        tail, head = split.edges[edge].tolist()
        origin = int(split.origins[edge])
        is_reversed = known.at(head) < known.at(tail)
        chain = [tail, *(row for _, row in sorted(several, reverse=is_reversed)), head]
        chain = [row for k, row in enumerate(chain) if k == 0 or row != chain[k - 1]]
        parts += list(pairwise(chain))
        origins += [origin] * (len(chain) - 1)
        a, b = map(given.at, edges[origin].tolist())
        far = max(_distance(placed.at(row), a, b) for _, row in several)
        split.displacement = max(split.displacement, far)
    kept = np.ones(len(split.edges), dtype=np.bool_)
    kept[list(at)] = False
    split.edges = np.concatenate([split.edges[kept], np.array(parts, dtype=np.int32)])
    split.origins = np.concatenate([split.origins[kept], np.array(origins, dtype=np.int32)])


class _Points:
    """Exact positions of rows."""

    def __init__(self, points: Array) -> None:
        self._points = points

    def at(self, row: int) -> Exact:
        x, y = self._points[row].tolist()
        return Fraction(x), Fraction(y)

    def named(self, row: int) -> str:
        return f"row {row} {tuple(self._points[row].tolist())}"

    def crossing(self, *rows: int) -> Exact:
        """Return where two edges cross."""
        a, b, c, d = map(self.at, rows)
        above, below = _turn(c, d, a), _turn(c, d, b)
        share = above / (above - below)
        return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])


def _turn(a: Exact, b: Exact, c: Exact) -> Fraction:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _rounded(place: Exact) -> tuple[float, float]:
    return float(place[0]), float(place[1])


def _distance(p: Exact, a: Exact, b: Exact) -> float:
    """Return the distance of a point from a line, rounded."""
    x, y = b[0] - a[0], b[1] - a[1]
    return _root(_turn(a, b, p) ** 2 / (x * x + y * y))


def _root(value: Fraction) -> float:
    """Return the square root of what may be out of the range of float64."""
    shift = (value.numerator.bit_length() - value.denominator.bit_length()) // 2
    return math.ldexp(math.sqrt(value / Fraction(4) ** shift), shift)


def origins_of(indptr: Rows, members: Rows, origins: Rows) -> tuple[Rows, Rows]:
    """Return the input edges of each piece, ascending and once, for those of parts of edges."""
    piece = np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))
    keys: Integers = np.unique(pair_keys(piece, origins[members]))
    starts = np.searchsorted(keys, np.arange(len(indptr)) << 32)
    return starts.astype(np.int32), (keys & 0xFFFFFFFF).astype(np.int32)
