"""Policies for rows at equal planar positions.

The triangulation keeps the first row at each position. Rows equal in height too are plain
duplicates: merged and counted. Rows at another height are overhangs, as on walls, in trees or in
two passes of a scanner, and a policy chooses the row that is used as the vertex. All rows remain
vertices of the surface; the others appear in no face. A *group* is all rows at one shared position.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftmesh._typing import Array, Floats, Integers, Mask, Reals, Rows
from liftmesh.base.arrays import pair_keys, pairs_of_keys
from liftmesh.base.options import OnDuplicate, check_option
from liftmesh.errors import DuplicateHeightError, Option


@dataclass(frozen=True, slots=True, eq=False)
class Choice:
    """The row that is used as the vertex at each shared planar position."""

    kept: Rows  # of each group, the row that the triangulation kept, increasing
    chosen: Rows  # of each group, the row that is the vertex
    left_out: Rows  # the other rows of all groups, increasing
    representatives: Rows  # of each of these, the chosen row of its group
    overhanging: Mask  # whether it is at another height than its representative
    moved: Rows  # chosen rows whose height changes, by the policy "mean"
    new_heights: Floats


def choose_rows(
    duplicates: Rows,  # pairs (row, kept row), the kept one being the first at its position
    heights: Floats,
    planar: Reals,
    policy: str,
    names: Integers | None = None,  # of rows in messages, if not their numbers
    ranks: Array | None = None,  # of rows: those of the highest rank in a group are candidates
) -> Choice:
    """Choose the row that is used as the vertex at each shared planar position."""
    check_option("on_duplicate", policy, OnDuplicate)
    groups = _Groups.of(duplicates, heights)
    candidates = groups if ranks is None else groups.highest(ranks)
    if policy == "error":
        _refuse_overhangs(candidates, planar, names)
    chosen = candidates.chosen(policy)
    moved, new_heights = candidates.means() if policy == "mean" else (chosen[:0], heights[:0])
    representatives = groups.spread(chosen)
    left = groups.rows != representatives
    left_out, representatives = _sorted_pairs(groups.rows[left], representatives[left])
    return Choice(
        kept=groups.firsts(),
        chosen=chosen,
        left_out=left_out,
        representatives=representatives,
        overhanging=heights[left_out] != heights[representatives],
        moved=moved,
        new_heights=new_heights,
    )


def _refuse_overhangs(groups: _Groups, planar: Reals, names: Integers | None) -> None:
    """Raise for the first row at another height than the first row of its group."""
    firsts = groups.spread(groups.starts)
    unequal = np.flatnonzero(groups.heights != groups.heights[firsts])
    if not len(unequal):
        return
    other = unequal[np.argmin(groups.rows[unequal])]
    pair = [firsts[other], other]
    kept, row = groups.rows[pair].tolist()
    one, two = groups.heights[pair].tolist()
    x, y = planar[kept].tolist()
    low, high = (kept, row) if names is None else names[[kept, row]].tolist()
    raise DuplicateHeightError(
        f"rows {low} and {high} share the planar position ({x!r}, {y!r}) at the heights "
        f"{one!r} and {two!r}: give "
        f"{Option('on_duplicate', 'first')}, 'last', 'lowest', 'highest' or 'mean' to choose the "
        "vertex",
        rows=(low, high),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Groups:
    """The rows of all groups, one group after the other, rows increasing within each."""

    rows: Rows
    heights: Floats
    starts: Integers

    @classmethod
    def of(cls, duplicates: Rows, heights: Floats) -> _Groups:
        kept, others = _sorted_pairs(duplicates[:, 1], duplicates[:, 0])
        begins = np.flatnonzero(np.diff(kept, prepend=-1))
        rows = np.insert(others, begins, kept[begins])
        return cls(rows, heights[rows], begins + np.arange(len(begins)))

    def highest(self, ranks: Array) -> _Groups:
        """Return the groups with the rows of the highest rank in each."""
        own = ranks[self.rows]
        kept = own == self.spread(np.maximum.reduceat(own, self.starts)) if len(own) else own > 0
        before = np.cumsum(kept) - kept
        return _Groups(self.rows[kept], self.heights[kept], before[self.starts])

    def firsts(self) -> Rows:
        return self.rows[self.starts]

    def lasts(self) -> Rows:
        lasts: Rows = self.rows[self.starts + self.lengths() - 1]
        return lasts

    def lengths(self) -> Integers:
        return np.diff(self.starts, append=len(self.rows))

    def spread(self, values: Array) -> Array:
        """Repeat the value of each group for all its rows."""
        return np.repeat(values, self.lengths())

    def chosen(self, policy: str) -> Rows:
        return {
            "first": self.firsts,
            "last": self.lasts,
            "lowest": lambda: self._at_extreme(np.minimum),
            "highest": lambda: self._at_extreme(np.maximum),
            "mean": self.firsts,  # raised to the mean afterwards
            "error": self.firsts,  # whose heights are all equal
        }[policy]()

    def _at_extreme(self, extreme: np.ufunc) -> Rows:
        """Return the first row of extreme height in each group."""
        reached = self.heights == self.spread(extreme.reduceat(self.heights, self.starts))
        beyond = np.iinfo(self.rows.dtype).max
        chosen: Rows = np.minimum.reduceat(np.where(reached, self.rows, beyond), self.starts)
        return chosen

    def means(self) -> tuple[Rows, Floats]:
        """Compute the means of groups with several heights; return their first rows and means."""
        labels = self.spread(np.arange(len(self.starts)))
        ordered = self.heights[np.lexsort((self.heights, labels))]
        distinct = np.ones(len(ordered), dtype=np.bool_)
        distinct[1:] = ordered[1:] != ordered[:-1]
        distinct[self.starts] = True
        several = np.add.reduceat(distinct.astype(np.int64), self.starts) > 1
        keep = distinct & self.spread(several)
        counted = np.add.reduceat(keep.astype(np.int64), self.starts)[several]
        starts = np.cumsum(counted) - counted
        return self.firsts()[several], _means(ordered[keep], starts)


def _sorted_pairs(first: Rows, second: Rows) -> tuple[Rows, Rows]:
    """Sort pairs of rows lexicographically, each packed into one integer for speed."""
    keys = pair_keys(first, second)
    keys.sort()
    rows, others = pairs_of_keys(keys)
    return rows.astype(np.int32), others.astype(np.int32)


def _means(heights: Floats, starts: Integers) -> Floats:
    """Compute the mean of each run of increasing heights, clipped to the run's range."""
    counts = np.diff(starts, append=len(heights))
    lows, highs = heights[starts], heights[starts + counts - 1]
    scales = np.where(np.maximum(-lows, highs) > 2.0**960, 2.0**-40, 1.0)
    sums = np.add.reduceat(heights * np.repeat(scales, counts), starts)
    return np.clip(sums / counts / scales, lows, highs)
