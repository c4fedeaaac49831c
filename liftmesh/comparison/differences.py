"""Sorting the triangles of two sides into identical, cocircular and really different ones."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from liftmesh._typing import Indices, Rows
from liftmesh.comparison.cells import Cells, unbalanced_cells
from liftmesh.comparison.matching import first_of_each, match_triangles


@dataclass(frozen=True, slots=True, eq=False)
class Differences:
    """Where two sets of triangles differ.

    Parameters
    ----------
    identical : int
        Triangles of both sides.
    cocircular : int
        Triangles of one side that the other replaces by as many in the same cell.
    cells : int
        Number of such cells.
    missing : (k,) ndarray of int
        Indices of liftmesh's triangles that are really different.
    wrong : (w,) ndarray of int
        Indices of trimesh's lower facets that are really different.
    wrong_cell : (w,) ndarray of int32
        The cell that holds each of them, -1 for none: its circle is not empty.
    """

    identical: int
    cocircular: int
    cells: int
    missing: Indices
    wrong: Indices
    wrong_cell: Rows


def find_differences(triangles: Rows, cells: Cells, lower: Rows) -> Differences:
    """Hold trimesh's lower facets against liftmesh's triangles.

    Parameters
    ----------
    triangles : (m, 3) ndarray of int32
        liftmesh's triangles.
    cells : Cells
        Their cocircular cells.
    lower : (l, 3) ndarray of int32
        Lower facets of the other side, counter-clockwise.

    Returns
    -------
    Differences
        Complete: every triangle of either side is counted once.

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
    flawed = unbalanced_cells(
        cells.count, (triangles[ours], our_cell), (lower[theirs[inside]], their_cell[inside])
    )
    missing, wrong = flawed[our_cell], ~inside | flawed[their_cell]
    return Differences(
        identical=int(first.sum()),
        cocircular=int((~missing).sum()),
        cells=int(np.count_nonzero(np.bincount(our_cell[~missing]))),
        missing=ours[missing],
        wrong=theirs[wrong],
        wrong_cell=their_cell[wrong],
    )


def _others(indices: Indices, length: int) -> Indices:
    """All indices below ``length`` that are not given."""
    mark = np.ones(length, dtype=bool)
    mark[indices] = False
    return np.flatnonzero(mark)


def _cells_of(cells: Cells, lower: Rows, match: Indices, theirs: Indices) -> Rows:
    """The cell of each facet without a partner; a repeated facet has the cell of its twin."""
    found = cells.containing(lower[theirs])
    repeated = match[theirs] >= 0
    found[repeated] = cells.labels[match[theirs[repeated]]]
    return found
