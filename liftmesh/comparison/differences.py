"""Classification of two sets of triangles as identical, cocircular or really different."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftmesh._typing import Indices, Rows
from liftmesh.comparison.cells import Cells, unbalanced_cells
from liftmesh.comparison.matching import first_of_each, match_triangles


@dataclass(frozen=True, slots=True, eq=False)
class Differences:
    """Differences between two sets of triangles."""

    identical: int
    cocircular: int
    cells: int
    missing: Indices
    wrong: Indices
    wrong_cell: Rows


def find_differences(triangles: Rows, cells: Cells, lower: Rows) -> Differences:
    """Compare trimesh's lower facets with liftmesh's triangles."""
    match = match_triangles(triangles, lower)
    first = first_of_each(match)
    ours, theirs = _others(match[first], len(triangles)), np.flatnonzero(~first)
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


def _others(indices: Indices, length: int) -> Indices:
    """Return all indices below ``length`` that are not given."""
    mark = np.ones(length, dtype=bool)
    mark[indices] = False
    return np.flatnonzero(mark)


def _cells_of(cells: Cells, lower: Rows, match: Indices, theirs: Indices) -> Rows:
    """Return the cell of each unmatched facet; a repeated facet has the cell of its match."""
    found = cells.containing(lower[theirs])
    repeated = match[theirs] >= 0
    found[repeated] = cells.labels[match[theirs[repeated]]]
    return found
