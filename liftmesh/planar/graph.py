"""Graphs of points that are near each other, as sparse matrices: parts of the Delaunay graph.

The kernel decides which edges a graph has (`_core/proximity`), exactly. Here they become a matrix,
with weights, and with rows at one position.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Floats, Rows
from liftmesh.base.arrays import as_numbers
from liftmesh.base.options import Coincident, GraphKind, GraphWeights, check_option, refused
from liftmesh.optional import load
from liftmesh.planar.alpha import Simplicial, empty_circles

if TYPE_CHECKING:
    import scipy.sparse


class Planar(Simplicial, Protocol):
    """What of a triangulation in the plane is needed here."""

    duplicates: Rows

    @property
    def npoints(self) -> int:
        """Of all rows."""

    @property
    def edges(self) -> Rows:
        """Of the triangles, as pairs of rows."""


def graph(
    found: Planar,
    kind: GraphKind = "delaunay",
    weights: GraphWeights | Callable[[Floats], ArrayLike] = "length",
    *,
    coincident: Coincident = "first",
) -> scipy.sparse.csr_array:
    """Make a graph of rows that are near each other, as a sparse matrix.

    Parameters
    ----------
    found : Triangulation
        For "delaunay" any, for the other kinds one of points alone: with neither constraints nor
        weights nor a metric.
    kind : {"delaunay", "gabriel", "relative_neighborhood", "minimum_spanning_tree", \
            "sphere_of_influence"}, default "delaunay"
        Which edges the graph has.

        - "delaunay": those of the triangles.
        - "gabriel": those whose circle, with the edge as its diameter, has no other point inside
          or on it.
        - "relative_neighborhood": those for which no point is nearer to both ends than the ends
          are to each other.
        - "minimum_spanning_tree": those of the tree that connects all positions with the least sum
          of lengths. Of edges of one length that with the lexicographically lesser end counts as
          shorter, or with the lesser other end.
        - "sphere_of_influence": those between rows whose circles, each through the nearest other
          position, meet in two points. Not all are edges of the triangles.
    weights : {"length", "binary"} or callable, default "length"
        What the entries are: lengths, each the double nearest to the exact one; ones; or what a
        function makes of the array of lengths, such as ``lambda length: 1 / length``.
    coincident : {"first", "clique"}, default "first"
        What becomes of rows at one position. With "first", the first of them has the edges, and
        the others, which are in ``duplicates``, none. With "clique" all of them have, to all rows
        of each neighbour, and to each other with length 0: as many entries as pairs of rows.

    Returns
    -------
    scipy.sparse.csr_array of shape (n, n)
        A symmetric matrix of float64 in canonical form, without a diagonal. Rows and columns are
        rows of the points; those that were skipped, or are no vertex, are empty. Lengths of 0 are
        entries like others, as `scipy.sparse.csgraph` has them.

    Raises
    ------
    InputError
        An option is unknown, a function does not return a number for each length, or the
        triangulation is not of points alone.

    See Also
    --------
    delaunay : Triangulates the points.
    Triangulation.edges : The edges of the triangles as pairs of rows.

    Notes
    -----
    All decisions are exact, so each graph depends on the positions alone. The minimum spanning tree
    is a part of the relative neighbourhood graph, this of the Gabriel graph, and this of the
    Delaunay graph. Spheres of influence have at most 17.5 edges a row. libpysal keeps edges with a
    point on their circle if Qhull happens to have them, as one diagonal of each square of a grid,
    and leaves out relative neighbours where a point is as near to both ends as these are.

    K. R. Gabriel and R. R. Sokal, "A new statistical approach to geographic variation analysis",
    1969. G. T. Toussaint, "The relative neighbourhood graph of a finite planar set", 1980, and "A
    graph-theoretical primal sketch", 1988; J. W. Jaromczyk and M. Kowaluk, "A note on relative
    neighborhood graphs", 1987.

    Examples
    --------
    >>> import liftmesh
    >>> tri = liftmesh.delaunay([[0, 0], [3, 0], [0, 4], [1, 1]])
    >>> tri.graph().shape, tri.graph().nnz, tri.graph("gabriel", "binary").nnz
    ((4, 4), 12, 6)
    >>> print(tri.graph("minimum_spanning_tree").toarray().round(3))
    [[0.    0.    0.    1.414]
     [0.    0.    0.    2.236]
     [0.    0.    0.    3.162]
     [1.414 2.236 3.162 0.   ]]
    """
    check_option("kind", kind, GraphKind)
    check_option("coincident", coincident, Coincident)
    edges = _edges(found, kind)
    places = _loops(found, edges) if coincident == "clique" else edges
    values = _values(found, places, weights)
    if coincident == "clique":
        edges, values = _cliques(found, places, values)
    ends = np.concatenate([edges, edges[:, ::-1]]).T
    shape = found.npoints, found.npoints
    matrix = load("scipy.sparse", extra="scipy").coo_array
    made: scipy.sparse.csr_array = matrix((np.tile(values, 2), tuple(ends)), shape=shape).tocsr()
    return made


def _edges(found: Planar, kind: GraphKind) -> Rows:
    if kind == "delaunay":
        return found.edges
    arrays = empty_circles(found, "graphs of near rows need")
    return _kernel.proximity_graph(found.points, *arrays, kind)


def _loops(found: Planar, edges: Rows) -> Rows:
    """Add an edge to itself at each position of several rows."""
    kept = np.unique(found.duplicates[:, 1])
    return np.concatenate([edges, np.stack([kept, kept], axis=1)])


def _values(
    found: Planar, edges: Rows, weights: GraphWeights | Callable[[Floats], ArrayLike]
) -> Floats:
    if not callable(weights):
        check_option("weights", weights, GraphWeights)
    if weights == "binary":
        return np.ones(len(edges))
    lengths = np.empty(len(edges))
    _kernel.lengths(found.points, np.ascontiguousarray(edges), lengths)
    if not callable(weights):
        return lengths
    values = as_numbers("weights", weights(lengths), "return numbers", verb="returns")
    if values.shape != lengths.shape:
        reason = f"return a number for each of the {len(lengths)} lengths"
        raise refused("weights", values.shape, reason, verb="returns the shape")
    return values


def _cliques(found: Planar, edges: Rows, values: Floats) -> tuple[Rows, Floats]:
    """Join all rows at one end of an edge with all at the other, and of a loop with each other."""
    kept = np.arange(found.npoints)
    kept[found.duplicates[:, 0]] = found.duplicates[:, 1]
    rows = np.argsort(kept, kind="stable").astype(np.int32)
    count = np.bincount(kept, minlength=len(kept))
    first = np.cumsum(count) - count
    (a, b), pairs = edges.T, count.take(edges).prod(axis=1)
    which = np.repeat(np.arange(len(edges)), pairs)
    place = np.arange(len(which)) - np.repeat(np.cumsum(pairs) - pairs, pairs)
    row, other = np.divmod(place, count[b][which])
    ends = np.stack([rows[first[a][which] + row], rows[first[b][which] + other]], axis=1)
    is_pair = (a != b)[which] | (row < other)
    return ends[is_pair], values[which[is_pair]]
