"""Classification of two sets of triangles as identical, cocircular or really different."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftmesh._typing import Indices, Rows
from liftmesh.comparison.cells import Cells, unbalanced_cells
from liftmesh.comparison.matching import first_of_each, match_triangles


@dataclass(frozen=True, slots=True, eq=False)
class Differences:
    """Differences between two sets of triangles.

    Parameters
    ----------
    identical : int
        Triangles in both sets.
    cocircular : int
        Triangles of one set that the other replaces by as many in the same cell.
    cells : int
        Number of such cells.
    missing : (k,) ndarray of int
        Indices of liftmesh's triangles that are really different.
    wrong : (w,) ndarray of int
        Indices of trimesh's lower facets that are really different.
    wrong_cell : (w,) ndarray of int32
        The cell that contains each of them, or -1 if there is none: its circle is not empty.
    """

    identical: int
    cocircular: int
    cells: int
    missing: Indices
    wrong: Indices
    wrong_cell: Rows


def find_differences(triangles: Rows, cells: Cells, lower: Rows) -> Differences:
    """Compare trimesh's lower facets with liftmesh's triangles.

    Parameters
    ----------
    triangles : (m, 3) ndarray of int32
        liftmesh's triangles.
    cells : Cells
        Their cocircular cells.
    lower : (l, 3) ndarray of int32
        trimesh's lower facets, counter-clockwise.

    Returns
    -------
    Differences
        Complete: every triangle of either set is counted once.

    Examples
    --------
    >>> import liftmesh
    >>> from liftmesh.comparison.cells import find_cells
    >>> tri = liftmesh.delaunay([[0, 0], [1, 0], [0, 1], [1, 1]])
    >>> cells = find_cells(tri.points, tri.simplices, tri.neighbors)
    >>> find_differences(tri.simplices, cells, np.array([[0, 1, 3], [0, 3, 2]])).cocircular
    2
    """
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
