"""Triangles that two triangulations differ in: cocircular ones, or really different.

Triangles are identical if they have the same corners, whichever corner comes first.

The points on one empty circle span a convex polygon, the Delaunay cell. Every triangulation of it
is Delaunay, so two correct triangulations differ only inside cells:

- A triangle of input points has an empty circle if and only if its corners belong to one cell.
- Triangles of one cell, all counter-clockwise, cover it exactly once if and only if their
  boundary, the sum of their directed edges in which opposite ones cancel, is the boundary of the
  cell. So two sets of triangles of a cell are both correct, or both wrong, if the difference of
  their boundaries is zero.

Both tests use integers and exact signs only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftmesh._typing import Floats, Indices, Integers, Mask, Rows
from liftmesh.base.arrays import pair_keys, starts_of_runs
from liftmesh.base.frozen import cached_property
from liftmesh.optional import load
from liftmesh.predicates import incircle


@dataclass(frozen=True, slots=True, eq=False)
class Differences:
    """Differences between two sets of triangles."""

    identical: int
    cocircular: int  # triangles of one set that the other replaces by as many in the same cell
    cells: int  # such cells
    missing: Indices  # of liftmesh's triangles, those really different
    wrong: Indices  # of trimesh's lower facets
    wrong_cell: Rows  # the cell that contains each of them; -1: its circle is not empty


def find_differences(triangles: Rows, cells: Cells, lower: Rows) -> Differences:
    """Compare trimesh's lower facets with liftmesh's triangles."""
    match = match_triangles(triangles, lower)
    first = first_of_each(match)
    ours, theirs = np.delete(np.arange(len(triangles)), match[first]), np.flatnonzero(~first)
    our_cell, their_cell = cells.labels[ours], _cells_of(cells, lower, match, theirs)
    inside = their_cell >= 0
    unbalanced = unbalanced_cells(
        cells.count, (triangles[ours], our_cell), (lower[theirs[inside]], their_cell[inside])
    )
    missing, wrong = unbalanced[our_cell], ~inside | unbalanced[their_cell]
    return Differences(
        identical=int(first.sum()),
        cocircular=int((~missing).sum()),
        cells=int(np.count_nonzero(np.bincount(our_cell[~missing]))),
        missing=ours[missing],
        wrong=theirs[wrong],
        wrong_cell=their_cell[wrong],
    )


def match_triangles(simplices: Rows, facets: Rows) -> Indices:
    """Find each facet among the triangles of a triangulation; -1 for none."""
    # Begun at its lowest row, a counter-clockwise triangle is identified by its first directed
    # edge: in a triangulation only one triangle lies to the left of it.
    if len(simplices) == 0 or len(facets) == 0:
        return np.full(len(facets), -1, dtype=np.intp)
    edge, apex = _first_edge(simplices)
    order = np.argsort(edge)
    wanted, wanted_apex = _first_edge(facets)
    place = np.searchsorted(edge, wanted, sorter=order).clip(max=len(edge) - 1)
    candidate = order[place]
    same = (edge[candidate] == wanted) & (apex[candidate] == wanted_apex)
    return np.where(same, candidate, -1)


def _first_edge(triangles: Rows) -> tuple[Integers, Rows]:
    """Return the edge that starts at the lowest row, as one integer, and the opposite corner."""
    every, lowest = np.arange(len(triangles)), np.argmin(triangles, axis=1)
    corner = [triangles[every, (lowest + k) % 3] for k in range(3)]
    return pair_keys(corner[0], corner[1]), corner[2]


def first_of_each(indices: Indices) -> Mask:
    """Mark the first occurrence of every index that is not negative."""
    first = np.full(indices.max(initial=-1) + 2, -1)
    # The last of repeated assignments wins: in reverse order, that is the first occurrence.
    first[indices[::-1]] = np.arange(len(indices))[::-1]
    mark: Mask = (first[indices] == np.arange(len(indices))) & (indices >= 0)
    return mark


def _cells_of(cells: Cells, lower: Rows, match: Indices, theirs: Indices) -> Rows:
    """Return the cell of each unmatched facet; a repeated facet has the cell of its match."""
    owners = cells.containing(lower[theirs])
    repeated = match[theirs] >= 0
    owners[repeated] = cells.labels[match[theirs[repeated]]]
    return owners


@dataclass(frozen=True, eq=False)
class Cells:
    """The cells of a triangulation."""

    simplices: Rows
    labels: Rows  # the cell of each triangle
    violations: Indices  # (v, 2), a triangle and a neighbour's apex strictly inside its circle

    @cached_property
    def count(self) -> int:
        """Number of cells."""
        return int(self.labels.max(initial=-1)) + 1

    @cached_property
    def _corners(self) -> Indices:
        """Sorted pairs (row, cell) of all cells of two or more triangles, as one integer each."""
        large = np.bincount(self.labels, minlength=self.count) > 1
        chosen = large[self.labels]
        rows = self.simplices[chosen].astype(np.int64).ravel()
        return np.unique(rows * self.count + np.repeat(self.labels[chosen], 3))

    def containing(self, triangles: Rows) -> Rows:
        """Find the cell of two or more triangles that has all corners of each; -1 for none."""
        low = np.searchsorted(self._corners, triangles * np.int64(self.count))
        high = np.searchsorted(self._corners, (triangles + np.int64(1)) * self.count)
        # Candidates are the cells of the corner with the fewest; all three must have the cell.
        every = np.arange(len(triangles))
        pivot = np.argmin(high - low, axis=1)
        counts = (high - low)[every, pivot]
        owner = np.repeat(every, counts)
        nth = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
        cell = self._corners[low[every, pivot][owner] + nth] % max(self.count, 1)
        shared = np.ones(len(owner), dtype=bool)
        for k in range(3):
            shared &= self._has(triangles[owner, k] * np.int64(self.count) + cell)
        owners = np.full(len(triangles), -1, dtype=np.int32)
        owners[owner[shared]] = cell[shared]
        return owners

    def _has(self, keys: Indices) -> Mask:
        """Whether each key (row, cell) is among the corners."""
        if len(self._corners) == 0:
            return np.zeros(len(keys), dtype=bool)
        place = np.searchsorted(self._corners, keys).clip(max=len(self._corners) - 1)
        is_there: Mask = self._corners[place] == keys
        return is_there


def find_cells(points: Floats, simplices: Rows, neighbors: Rows) -> Cells:
    """Merge triangles across all edges whose in-circle sign is exactly zero."""
    triangle, edge = np.nonzero(neighbors > np.arange(len(simplices))[:, None])
    other = neighbors[triangle, edge]
    apex = opposite_rows(simplices, triangle, edge, other)
    a, b, c = points[simplices[triangle].T]
    sign = incircle(a, b, c, points[apex])
    csgraph = load("scipy.sparse.csgraph", extra="scipy")
    sparse = load("scipy.sparse", extra="scipy")
    merged = sign == 0
    pairs = (np.ones(int(merged.sum()), dtype=bool), (triangle[merged], other[merged]))
    graph = sparse.coo_array(pairs, shape=(len(simplices), len(simplices)))
    _, labels = csgraph.connected_components(graph, directed=False)
    inside = sign > 0
    return Cells(simplices, labels, np.column_stack([triangle[inside], apex[inside]]))


def opposite_rows(simplices: Rows, triangle: Indices, edge: Indices, other: Rows) -> Rows:
    """Find the apexes of neighbours: the sum of their corners minus those of the common edge."""
    total = simplices[other].sum(axis=1, dtype=np.int64)
    common = simplices[triangle, (edge + 1) % 3].astype(np.int64)
    common += simplices[triangle, (edge + 2) % 3]
    apex: Rows = (total - common).astype(np.int32)
    return apex


def unbalanced_cells(cells: int, plus: tuple[Rows, Rows], minus: tuple[Rows, Rows]) -> Mask:
    """Find the cells in which two sets of triangles have different boundaries."""
    parts = [_directed_edges(*plus, 1), _directed_edges(*minus, -1)]
    cell, low, high, sign = (np.concatenate(column) for column in zip(*parts, strict=True))
    order = np.lexsort((high, low, cell))
    keys = np.column_stack([cell, low, high])[order]
    unbalanced = np.zeros(cells, dtype=bool)
    if len(keys):
        begin = np.flatnonzero(starts_of_runs(keys))
        total = np.add.reduceat(sign[order], begin)
        unbalanced[keys[begin[total != 0], 0]] = True
    return unbalanced


def _directed_edges(triangles: Rows, cell: Rows, weight: int) -> tuple[Rows, Rows, Rows, Rows]:
    """Return edges as (cell, lower row, higher row, sign of the direction)."""
    tail, head = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    sign = np.where(tail < head, weight, -weight).astype(np.int32)
    return np.repeat(cell, 3), np.minimum(tail, head), np.maximum(tail, head), sign
