"""Matching of two sets of triangles, and the rows that triangles use.

Triangles are equal if they have the same corners, whichever corner comes first.
"""

from __future__ import annotations

import numpy as np

from liftmesh._typing import Indices, Integers, Mask, Rows


def match_triangles(simplices: Rows, facets: Rows) -> Indices:
    """Find each facet among the triangles of a triangulation."""
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
    return (corner[0].astype(np.int64) << 32) | corner[1], corner[2]


def first_of_each(indices: Indices) -> Mask:
    """Mark the first occurrence of every index that is not negative."""
    first = np.full(indices.max(initial=-1) + 2, -1)
    # The last of repeated assignments wins: in reverse order, that is the first occurrence.
    first[indices[::-1]] = np.arange(len(indices))[::-1]
    mark: Mask = (first[indices] == np.arange(len(indices))) & (indices >= 0)
    return mark
