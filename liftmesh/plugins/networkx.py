"""Graphs of near points in networkx.

>>> import liftmesh
>>> from liftmesh.plugins.networkx import to_networkx
>>> tri = liftmesh.delaunay([[0, 0], [3, 0], [0, 4], [1, 1]])
>>> sorted(to_networkx(tri, "minimum_spanning_tree").edges)
[(0, 3), (1, 3), (2, 3)]
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from liftmesh._typing import Floats
from liftmesh.base.options import Coincident, GraphKind, GraphWeights
from liftmesh.optional import load
from liftmesh.planar.graph import graph

if TYPE_CHECKING:
    import networkx as nx

    from liftmesh.planar.triangulation import Triangulation
else:
    nx = load("networkx", extra="trimesh")


def to_networkx(
    found: Triangulation,
    kind: GraphKind = "delaunay",
    weights: GraphWeights | Callable[[Floats], ArrayLike] = "length",
    *,
    coincident: Coincident = "first",
) -> nx.Graph[int]:
    """Make a graph of networkx, of rows that are near each other.

    Parameters
    ----------
    found, kind, weights, coincident
        As for `liftmesh.Triangulation.graph`.

    Returns
    -------
    networkx.Graph
        The nodes are all rows, with their place as ``pos``, which networkx draws them at; rows that
        are no vertex have no edges. Edges have their weight as ``weight``.

    Raises
    ------
    InputError
        As for `liftmesh.Triangulation.graph`.

    See Also
    --------
    liftmesh.Triangulation.graph : The same as a sparse matrix.

    Examples
    --------
    >>> import liftmesh
    >>> from liftmesh.plugins.networkx import to_networkx
    >>> found = to_networkx(liftmesh.delaunay([[0, 0], [3, 0], [0, 4]]))
    >>> found.edges[1, 2], found.nodes[2]
    ({'weight': 5.0}, {'pos': (0.0, 4.0)})
    """
    made: nx.Graph[int] = nx.from_scipy_sparse_array(
        graph(found, kind, weights, coincident=coincident)
    )
    nx.set_node_attributes(made, dict(enumerate(map(tuple, found.points.tolist()))), "pos")
    return made
