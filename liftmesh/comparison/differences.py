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

*Proofs* are in rational numbers without rounding. The in-circle determinant of counter-clockwise a,
b, c and a point d is computed with `fractions` from the unchanged doubles. It is positive if and
only if d lies strictly inside the circle through a, b and c, that is, if and only if the lifted d
lies strictly below their plane (Lemma 4.2): then no lower facet has the corners a, b, c.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from itertools import islice
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Floats, Indices, Integers, Mask, Rows
from liftmesh.base.arrays import pair_keys, starts_of_runs
from liftmesh.base.frozen import cached_property
from liftmesh.optional import load
from liftmesh.predicates import incircle, orient2d

if TYPE_CHECKING:
    from liftmesh.planar.triangulation import Triangulation


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
    csgraph, sparse = load("scipy.sparse.csgraph"), load("scipy.sparse")
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


Claim = Literal["wrong facet", "broken cell", "right triangle", "wrong triangle"]

_SENTENCES: dict[Claim, str] = {
    "wrong facet": (
        "trimesh's facet {rows} is wrong: row {row} lies strictly inside its circle, "
        "in-circle determinant {value} > 0"
    ),
    "broken cell": (
        "trimesh's facet {rows} has an empty circle, but trimesh's facets overlap or leave a gap "
        "among the cocircular points around it"
    ),
    "right triangle": (
        "liftmesh's triangle {rows} is correct and missing from trimesh's hull: none of the other "
        "{tested:,} points lies strictly inside its circle; determinants across its edges: {values}"
    ),
    "wrong triangle": (
        "liftmesh's triangle {rows} is wrong: row {row} lies strictly inside its circle, "
        "in-circle determinant {value} > 0"
    ),
}


@dataclass(frozen=True, slots=True)
class Proof:
    """An exact statement about one triangle."""

    claim: Claim
    rows: tuple[int, int, int]  # counter-clockwise
    determinants: tuple[tuple[int, Fraction], ...]  # of the row inside, or of those across edges
    tested: int  # other points, all exactly

    def __str__(self) -> str:
        row, value = self.determinants[0] if self.determinants else (-1, Fraction(0))
        values = ", ".join(f"{_short(value)} (row {row})" for row, value in self.determinants)
        return _SENTENCES[self.claim].format(
            rows=self.rows, row=row, value=_short(value), values=values, tested=self.tested
        )


def _short(value: Fraction) -> str:
    """Format a number exactly if that is short, otherwise its leading digits."""
    exact = str(value)
    if len(exact) <= 12:
        return exact
    return f"{Decimal(value.numerator) / Decimal(value.denominator):.5e}"


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """The data for proofs."""

    triangulation: Triangulation
    rows: Rows
    lower: Rows
    cells: Cells
    differences: Differences

    def proofs(self, limit: int) -> list[Proof]:
        """Prove the first differences: liftmesh's errors if any, then half of each kind."""
        faults = list(islice(self._faults(), limit))
        limit -= len(faults)
        for_wrong = limit - min(limit // 2, len(self.differences.missing))
        wrong = list(islice(self._wrong(), for_wrong))
        return [*faults, *wrong, *islice(self._missing(), limit - len(wrong))]

    def _faults(self) -> Iterator[Proof]:
        """Refute triangles of liftmesh that are not Delaunay."""
        simplices, points = self.triangulation.simplices, self.triangulation.points
        for index, _ in self.cells.violations:
            proof = refute(points, self.rows, simplices[index], claim="wrong triangle")
            if proof is not None:  # pragma: no branch - there is always one
                yield proof

    def _wrong(self) -> Iterator[Proof]:
        """Refute facets of trimesh: by a point inside their circle, or by their cell."""
        facets = self.lower[self.differences.wrong]
        for facet, cell in zip(facets, self.differences.wrong_cell, strict=True):
            proof = refute(self.triangulation.points, self.rows, facet) if cell < 0 else None
            yield proof or broken_cell(facet)

    def _missing(self) -> Iterator[Proof]:
        """Confirm triangles of liftmesh that trimesh lacks."""
        simplices, points = self.triangulation.simplices, self.triangulation.points
        for index in self.differences.missing:
            proof = confirm(points, self.rows, simplices[index], self._apexes(int(index)))
            if proof is not None:
                yield proof

    def _apexes(self, index: int) -> list[int]:
        """Return the rows opposite the edges of a triangle that have a neighbour."""
        neighbors = self.triangulation.neighbors[index]
        edge = np.flatnonzero(neighbors >= 0)
        triangle = np.full(len(edge), index, dtype=np.intp)
        apexes = opposite_rows(self.triangulation.simplices, triangle, edge, neighbors[edge])
        return [int(row) for row in apexes]


def incircle_determinant(points: Floats, rows: Sequence[int]) -> Fraction:
    """Compute the exact in-circle determinant of four rows."""
    (ax, ay), (bx, by), (cx, cy), (dx, dy) = (map(Fraction, points[row].tolist()) for row in rows)
    ax, ay, bx, by, cx, cy = ax - dx, ay - dy, bx - dx, by - dy, cx - dx, cy - dy
    a, b, c = ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy
    return a * (bx * cy - by * cx) - b * (ax * cy - ay * cx) + c * (ax * by - ay * bx)


def refute(
    points: Floats, rows: Rows, triangle: Rows, *, claim: Claim = "wrong facet"
) -> Proof | None:
    """Prove that a triangle is not Delaunay by a point strictly inside its circle."""
    inside = rows[_signs(points, rows, triangle) > 0]
    if len(inside) == 0:
        return None
    corners = _as_tuple(triangle)
    witness = int(inside[_deepest(points, inside, triangle)])
    determinant = incircle_determinant(points, (*corners, witness))
    return Proof(claim, corners, ((witness, determinant),), len(rows) - 3)


def confirm(points: Floats, rows: Rows, triangle: Rows, apexes: Sequence[int]) -> Proof | None:
    """Prove that a triangle is Delaunay: no row lies strictly inside its circle."""
    if (_signs(points, rows, triangle) > 0).any():
        return None
    corners = _as_tuple(triangle)
    determinants = tuple((row, incircle_determinant(points, (*corners, row))) for row in apexes)
    return Proof("right triangle", corners, determinants, len(rows) - 3)


def broken_cell(triangle: Rows) -> Proof:
    """Return the proof that a facet is Delaunay, but its cell is not covered exactly once."""
    return Proof("broken cell", _as_tuple(triangle), (), 0)


def _signs(points: Floats, rows: Rows, triangle: Rows) -> NDArray[np.int8]:
    """Return the exact in-circle signs of the rows; check that the triangle is oriented."""
    a, b, c = points[triangle]
    if orient2d(a, b, c) <= 0:
        message = f"triangle {_as_tuple(triangle)} is not counter-clockwise"
        raise AssertionError(message)
    return incircle(a, b, c, points[rows])


def _deepest(points: Floats, inside: Rows, triangle: Rows) -> int:
    """Return the index of the row with the largest rounded determinant; any choice is valid."""
    with np.errstate(all="ignore"):
        corners = points[triangle] - points[inside][:, None, :]
        (ax, bx, cx), (ay, by, cy) = corners[..., 0].T, corners[..., 1].T
        a, b, c = (corners**2).sum(axis=2).T
        depth = a * (bx * cy - by * cx) - b * (ax * cy - ay * cx) + c * (ax * by - ay * bx)
    return int(np.argmax(np.nan_to_num(depth)))


def _as_tuple(triangle: Rows) -> tuple[int, int, int]:
    a, b, c = triangle.tolist()
    return a, b, c
