"""Edges beyond which a node knows no triangle, on their way up the tree to their partners.

Beyond such an edge is the hull, or a triangle that another node writes, above or below this one.
Two edges with the same ends in opposite order are the same edge, seen from both sides: they are
paired at the first cut that knows both. What has no partner at the root is on the hull.
"""

from __future__ import annotations

import numpy as np

from liftmesh._typing import Array, Integers


def open_edges(name: int, triangles: Integers, neighbors: Array) -> Integers:
    """List the edges without a neighbour among the triangles of a node.

    Parameters
    ----------
    name : int
        The node: a cut, or ``~t`` for tile t.
    triangles : (m, 3) ndarray of int64
        What it writes.
    neighbors : (m, 3) ndarray of int32
        Which of them is beyond each edge, or -1.

    Returns
    -------
    (e, 4) ndarray of int64
        Tail, head, the node, and ``3 * row + side``; edge k is opposite corner k.
    """
    triangle, side = np.nonzero(neighbors < 0)
    tail, head = (triangles[triangle, (side + turn) % 3] for turn in (1, 2))
    return np.column_stack((tail, head, np.full(len(tail), name), 3 * triangle + side))


def paired(edges: Integers) -> tuple[Integers, Integers]:
    """Pair edges with the same ends in opposite order.

    Parameters
    ----------
    edges : (e, 4) ndarray of int64
        As from `open_edges`, of any nodes.

    Returns
    -------
    links : (l, 4) ndarray of int64
        Node and ``3 * row + side`` of either side of an edge.
    others : (r, 4) ndarray of int64
        The edges without a partner, in the order in which they were given.
    """
    ends = np.sort(edges[:, :2], axis=1)
    order = np.lexsort((edges[:, 0] > edges[:, 1], ends[:, 1], ends[:, 0]))
    one, other = order[:-1], order[1:]
    is_pair = (ends[one] == ends[other]).all(axis=1) & (edges[one, 0] == edges[other, 1])
    one, other = one[is_pair], other[is_pair]
    is_open = np.ones(len(edges), dtype=np.bool_)
    is_open[one] = is_open[other] = False
    return np.column_stack((edges[one, 2:], edges[other, 2:])), edges[is_open]
