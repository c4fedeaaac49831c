"""Where the tiles are: a kd tree of cuts through a sample of the points.

A cut compares both coordinates: a point goes right if it is not before the cut, by the coordinate
across which the cut goes, then by the other. So equal points share a tile, however many there are.
Each cut goes through the middle of its part of the sample, across the axis along which fewer
edges of the sample's own triangulation lie: what crosses a cut is what the merge has to do.

As equal rows share a tile, one position that is repeated often enough would make a tile of any
size. Such positions show in the sample. When a chunk is sorted by tile, only its first row at each
of them goes into a tile; the others are duplicates of that one.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Integers, Rows
from liftmesh.base.frozen import cached_property
from liftmesh.errors import FormatError

_EVERYWHERE = (-np.inf, -np.inf, np.inf, np.inf)
_LEVELS = 5  # of cuts, below which the boxes of tiles count by themselves
_FEW = 16  # points of a sample whose spread says as much as their triangulation
_OFTEN = 100  # of a sample with 2,000 points for each tile


@dataclass(frozen=True)
class Plan:
    """A tree of cuts. Cut 0 is the root; a plan without cuts has one tile."""

    axes: Any
    at: Floats
    children: Rows
    repeated: Floats = field(default_factory=lambda: np.empty((0, 2)))

    @property
    def tiles(self) -> int:
        """The number of tiles."""
        return len(self.axes) + 1

    @cached_property
    def cells(self) -> dict[int, tuple[float, float, float, float]]:
        """The box of each cut and of each tile, ``~t``: x and y of its lower and upper corner."""
        cells = {0 if len(self.axes) else ~0: _EVERYWHERE}
        for cut, (axis, at, children) in enumerate(
            zip(self.axes.tolist(), self.at.tolist(), self.children.tolist(), strict=True)
        ):
            low, high = list(cells[cut]), list(cells[cut])
            low[2 + axis] = min(low[2 + axis], at[axis])
            high[axis] = max(high[axis], at[axis])
            for child, cell in zip(children, (low, high), strict=True):
                cells[child] = (cell[0], cell[1], cell[2], cell[3])
        return cells

    def around(self, boxes: Floats) -> Floats:
        """Find the boxes of all nodes from those of the tiles."""
        all_boxes = np.concatenate((np.empty((len(self.axes), 4)), boxes[::-1]))
        for cut in reversed(range(len(self.axes))):
            before, after = all_boxes[self.children[cut]]
            all_boxes[cut, :2] = np.minimum(before, after)[:2]
            all_boxes[cut, 2:] = np.maximum(before, after)[2:]
        return all_boxes

    def lines(self, bounds: Sequence[float]) -> Floats:
        """Return the ends of each cut within bounds, (cuts, 2, 2)."""
        cells = np.array([self.cells[cut] for cut in range(len(self.axes))]).reshape(-1, 2, 2)
        ends: Floats = np.clip(cells, bounds[:2], bounds[2:])
        every = np.arange(len(self.axes))
        ends[every, :, self.axes] = self.at[every, self.axes, None]
        return ends

    def above(self, name: int) -> list[int]:
        """List the cuts above a node, the nearest one first."""
        cuts: list[int] = []
        while name in self._above:
            name, _ = self._above[name]
            cuts.append(name)
        return cuts

    def others(self, name: int) -> list[int]:
        """List nodes that together have all tiles but those of a node; few of them are far away."""
        nodes: list[int] = []
        while name in self._above:
            parent, sibling = self._above[name]
            nodes += self._within(sibling, _LEVELS)
            name = parent
        return nodes

    @cached_property
    def _above(self) -> dict[int, tuple[int, int]]:
        """The cut above each node, and the node on its other side."""
        parents = {}
        for cut, (before, after) in enumerate(self.children.tolist()):
            parents[before], parents[after] = (cut, after), (cut, before)
        return parents

    def _within(self, name: int, levels: int) -> list[int]:
        """List the nodes that are some cuts below a node, or tiles before that."""
        nodes = [name]
        for _ in range(levels):
            nodes = [c for n in nodes for c in (self.children[n].tolist() if n >= 0 else [n])]
        return nodes

    def partition(self, rows: Floats, first: int) -> tuple[Integers, Integers, Floats, Integers]:
        """Sort rows by tile."""
        return _kernel.partition(rows, first, self.axes, self.at, self.children, self.tiles)

    def cut_again(self, tile: int, finer: Plan) -> Plan:
        """Cut a tile by another plan."""
        if not len(finer.axes):
            return self
        below = finer.children.copy()
        is_tile = below < 0
        numbers = np.r_[tile, np.arange(self.tiles, self.tiles + finer.tiles - 1)]
        below[is_tile] = ~numbers[~below[is_tile]]
        below[~is_tile] += len(self.axes)
        children = np.where(self.children == ~tile, len(self.axes), self.children)
        return replace(
            self,
            axes=np.concatenate((self.axes, finer.axes)),
            at=np.concatenate((self.at, finer.at)),
            children=np.concatenate((children, below)).astype(np.int32),
        )

    def extends(self, coarser: Plan) -> bool:
        """Whether this plan is another one, perhaps with tiles that were cut again."""
        cuts = len(coarser.axes)
        return (
            np.array_equal(self.axes[:cuts], coarser.axes)
            and np.array_equal(self.at[:cuts], coarser.at)
            and np.array_equal(self.repeated, coarser.repeated)
        )

    def as_dict(self) -> dict[str, Any]:
        """Return lists of numbers, for JSON."""
        return {
            "axes": self.axes.tolist(),
            "at": self.at.tolist(),
            "children": self.children.tolist(),
            "repeated": self.repeated.tolist(),
        }

    @classmethod
    def from_dict(cls, lists: Mapping[str, Any]) -> Plan:
        """Return the plan of such lists."""
        try:
            plan = cls(
                np.array(lists["axes"], dtype=np.uint8),
                np.array(lists["at"], dtype=np.float64).reshape(-1, 2),
                np.array(lists["children"], dtype=np.int32).reshape(-1, 2),
                np.array(lists.get("repeated", []), dtype=np.float64).reshape(-1, 2),
            )
        except (KeyError, TypeError, ValueError, OverflowError) as error:
            raise FormatError(f"no plan of tiles ({error}): tile the source again") from error
        if not plan.is_tree:
            raise FormatError("no plan of tiles (its cuts are no tree): tile the source again")
        return plan

    @property
    def is_tree(self) -> bool:
        """Whether each cut but the first, and each tile, is below one earlier cut."""
        cuts, below = len(self.axes), self.children.reshape(-1)
        names = np.arange(~cuts, cuts)
        return (
            self.axes.shape == (cuts,) == self.at.shape[:1] == self.children.shape[:1]
            and bool((self.axes < 2).all() and np.isfinite(self.at).all())
            and bool(np.isfinite(self.repeated).all())
            and bool(np.array_equal(np.sort(below), names[names != 0]) if cuts else True)
            and bool(((below < 0) | (below > np.repeat(np.arange(cuts), 2))).all())
        )


def planned(sample: Floats, tiles: int) -> Plan:
    """Cut a sample into tiles of nearly equal numbers of points."""
    axes: list[int] = []
    at: list[Floats] = []
    children: list[list[int]] = []
    tiles_so_far = 0
    waiting = [(sample + 0.0, tiles, (-1, 0))]
    while waiting:
        part, wanted, (parent, side) = waiting.pop(0)
        cut = _cut(part, wanted)
        if cut is None:
            name, tiles_so_far = ~tiles_so_far, tiles_so_far + 1
        else:
            name = len(axes)
            axis, middle, ordered = cut
            axes.append(axis)
            at.append(ordered[middle])
            children.append([0, 0])
            waiting.append((ordered[:middle], wanted // 2, (name, 0)))
            waiting.append((ordered[middle:], wanted - wanted // 2, (name, 1)))
        if parent >= 0:
            children[parent][side] = name
    return Plan.from_dict({"axes": axes, "at": at, "children": children})


def _cut(part: Floats, wanted: int) -> tuple[int, int, Floats] | None:
    """Return the axis of a cut, and its place among the points in the order of that axis."""
    if wanted < 2 or len(part) < 2:
        return None
    axis = _axis(part, wanted)
    ordered = part[np.lexsort((part[:, 1 - axis], part[:, axis]))]
    middle = len(part) * (wanted // 2) // wanted
    equal = (ordered == ordered[middle]).all(axis=1)
    begin = int(equal.argmax())
    if begin == 0:  # nothing is before these
        begin = int(len(equal) - equal[::-1].argmax())
    return (axis, begin, ordered) if begin < len(ordered) else None


def _axis(part: Floats, wanted: int) -> int:
    spread = np.ptp(part / 2, axis=0)
    widest = int(spread[1] > spread[0])
    if len(part) < _FEW:
        return widest
    status, _, _, simplices, *_ = _kernel.delaunay(
        np.ascontiguousarray(part), False, 1, False, None
    )
    if status != "ok":
        return widest
    crossings = [_crossings(part, simplices, axis, wanted) for axis in (0, 1)]
    return widest if crossings[0] == crossings[1] else int(crossings[1] < crossings[0])


def _crossings(part: Floats, simplices: Rows, axis: int, wanted: int) -> int:
    """Count the triangles with corners on both sides of the middle."""
    ordered = np.lexsort((part[:, 1 - axis], part[:, axis]))
    is_after = np.ones(len(part), dtype=np.bool_)
    is_after[ordered[: len(part) * (wanted // 2) // wanted]] = False
    corners = is_after.take(simplices, axis=0).sum(axis=1)
    return int(((corners > 0) & (corners < 3)).sum())


def positions_of(rows: Floats) -> Array:
    """Return x and y as one number for each row, where 0 and -0 are equal."""
    positions: Array = np.ascontiguousarray(rows + 0.0).view(np.complex128).reshape(-1)
    return positions


def frequent(sample: Floats) -> tuple[Floats, Floats]:
    """Find positions that are often in a sample."""
    distinct, first, counts = np.unique(positions_of(sample), return_index=True, return_counts=True)
    often = distinct[counts >= _OFTEN]
    is_other = ~np.isin(positions_of(sample), often)
    is_other[first] = True
    return often.view(np.float64).reshape(-1, 2), sample[is_other]


def set_apart(
    rows: Floats, repeated: Floats, heights: Floats | None = None, policy: str = "first"
) -> tuple[Integers, Integers, Integers]:
    """Replace all rows but the first at each of some positions by NaN."""
    firsts = np.full(len(repeated), -1, dtype=np.int64)
    if not len(repeated):
        return firsts, firsts, firsts
    positions, sought = positions_of(rows), positions_of(repeated)
    at = np.minimum(np.searchsorted(sought, positions), len(sought) - 1)
    repeats = np.flatnonzero(sought[at] == positions)
    which = at[repeats]
    present, first = np.unique(which, return_index=True)
    firsts[present] = repeats[first]
    is_apart = np.ones(len(repeats), dtype=np.bool_)
    is_apart[first] = False
    if heights is not None and len(repeats):
        is_apart[_needed(which, heights[repeats], policy)] = False
    rows[repeats[is_apart]] = np.nan
    return repeats[is_apart], which[is_apart], firsts


def _needed(which: Integers, heights: Floats, policy: str) -> Integers:
    """Find the rows of a chunk that decide what a policy makes of each position."""
    if policy == "first":
        return np.empty(0, dtype=np.int64)
    if policy == "last":
        last = np.unique(which[::-1], return_index=True)[1]
        return len(which) - 1 - last
    order = np.lexsort((heights, which))  # and by row
    at, height = which[order], heights[order]
    is_new = np.r_[True, at[1:] != at[:-1]]
    is_level = is_new | np.r_[True, height[1:] != height[:-1]]
    levels: Integers = order[is_level]
    if policy == "lowest":
        levels = order[is_new]
    elif policy == "highest":
        levels = levels[np.r_[which[levels][1:] != which[levels][:-1], True]]
    return levels
