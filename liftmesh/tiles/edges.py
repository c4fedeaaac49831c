"""Edges beyond which a node knows no triangle, on their way up the tree to their partners.

Beyond such an edge is the hull, or a triangle that another node writes, above or below this one.
Two edges with the same ends in opposite order are the same edge, seen from both sides: they are
paired at the first cut that knows both. What has no partner at the root is on the hull.
"""

from __future__ import annotations

import numpy as np

from liftmesh._typing import Array, Integers


def open_edges(name: int, triangles: Integers, neighbors: Array) -> Integers:
    """List the edges without a neighbour among the triangles of a node."""
    triangle, side = np.nonzero(neighbors < 0)
    tail, head = (triangles[triangle, (side + turn) % 3] for turn in (1, 2))
    return np.column_stack((tail, head, np.full(len(tail), name), 3 * triangle + side))


def paired(edges: Integers) -> tuple[Integers, Integers]:
    """Pair edges with the same ends in opposite order."""
    ends = np.sort(edges[:, :2], axis=1)
    order = np.lexsort((edges[:, 0] > edges[:, 1], ends[:, 1], ends[:, 0]))
    one, other = order[:-1], order[1:]
    is_pair = (ends[one] == ends[other]).all(axis=1) & (edges[one, 0] == edges[other, 1])
    one, other = one[is_pair], other[is_pair]
    is_open = np.ones(len(edges), dtype=np.bool_)
    is_open[one] = is_open[other] = False
    return np.column_stack((edges[one, 2:], edges[other, 2:])), edges[is_open]
