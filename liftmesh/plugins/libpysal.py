"""Graphs of near points in libpysal: `build_triangulation` of `libpysal.graph.Graph`.

>>> import geopandas
>>> from liftmesh.plugins.libpysal import build_triangulation
>>> wells = geopandas.GeoSeries.from_xy([0, 3, 0, 1], [0, 0, 4, 1], index=["a", "b", "c", "d"])
>>> build_triangulation(wells, "gabriel").neighbors["d"]
('a', 'b', 'c')

What differs from libpysal's own:

- There are "minimum_spanning_tree" and "sphere_of_influence", too, and no "voronoi".
- Edges with a point on their circle are no Gabriel edges, as by the definition of Gabriel and
  Sokal. libpysal keeps those of them that Qhull happens to have: of squares one diagonal.
- Rows to both ends of which a point is as near as they are to each other are relative neighbours,
  as by the definition of Toussaint, so that the graph contains the minimum spanning tree. libpysal
  leaves them out: of triangles with three equal sides, all sides.
- With ``coplanar="clique"``, rows at one position are neighbours of each other, and all of them of
  all at each neighbouring position; libpysal leaves out pairs whose rows are both repeated ones.
- Nothing is moved: there is no ``coplanar="jitter"``.
- Rows that a kernel leaves without neighbours stay in the graph, as isolates.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from liftmesh.base.options import GraphKind, check_option, counted, refused
from liftmesh.errors import InputError
from liftmesh.optional import load
from liftmesh.planar.delaunay import delaunay

if TYPE_CHECKING:
    import libpysal.graph as host
else:
    host = load("libpysal.graph", extra="libpysal")

_COPLANAR = Literal["raise", "clique"]


def build_triangulation(  # noqa: PLR0913, PLR0917 - libpysal's parameters
    data: Any,
    method: GraphKind | Literal["voronoi"] = "delaunay",
    bandwidth: float | Literal["auto"] | None = np.inf,
    kernel: str | Callable[..., Any] | None = "boxcar",
    clip: Any = "bounding_box",  # noqa: ARG001 - of Voronoi cells
    rook: Any = True,  # noqa: ARG001 - of Voronoi cells
    coplanar: Literal["raise", "clique"] = "raise",
    taper: bool = True,
    decay: bool = False,
) -> host.Graph:
    """Make a graph of libpysal, as its ``Graph.build_triangulation`` does.

    Parameters
    ----------
    data : array_like, GeoSeries or GeoDataFrame
        Points; the index of a series or table names the nodes, otherwise their rows.
    method : {"delaunay", "gabriel", "relative_neighborhood", "minimum_spanning_tree", \
              "sphere_of_influence"}, default "delaunay"
        The kind of `liftmesh.Triangulation.graph`.
    bandwidth, kernel, taper, decay
        As in libpysal, whose kernels weigh the lengths; by default, and without a kernel, weights
        are 1.
    clip, rook
        Of Voronoi cells, which this does not make: ignored.
    coplanar : {"raise", "clique"}, default "raise"
        Whether rows at one position are an error, or neighbours of each other and of all near them.

    Returns
    -------
    libpysal.graph.Graph
        The graph.

    Raises
    ------
    InputError
        An option is none of these, or rows are at one position.

    See Also
    --------
    liftmesh.Triangulation.graph : The same as a sparse matrix.

    Examples
    --------
    >>> from liftmesh.plugins.libpysal import build_triangulation
    >>> build_triangulation([[0, 0], [3, 0], [0, 4]], kernel="identity").adjacency.tolist()
    [3.0, 4.0, 3.0, 5.0, 4.0, 5.0]
    """
    if method == "voronoi":
        reason = "use libpysal's own, or the neighbours of liftmesh.voronoi"
        raise refused("method", method, reason)
    check_option("method", method, GraphKind)
    check_option("coplanar", coplanar, _COPLANAR)
    found = delaunay(data)
    if coplanar == "raise" and len(found.duplicates):
        row, kept = found.duplicates[0].tolist()
        raise InputError(
            f"{counted(len(found.duplicates), 'row')} at the position of another, first row {row} "
            f"at that of row {kept}: give coplanar='clique' to make them neighbours"
        )
    if kernel is None or (kernel == "boxcar" and bandwidth == np.inf):
        made = host.Graph.from_sparse(found.graph(method, "binary", coincident="clique"))
    else:
        lengths = found.graph(method, coincident="clique")
        options = {"bandwidth": bandwidth, "taper": taper, "decay": decay}
        made = host.Graph.build_kernel(lengths, kernel=kernel, metric="precomputed", **options)
    index = getattr(data, "index", None)
    names = np.arange(found.npoints) if index is None or callable(index) else np.asarray(index)
    series = made.adjacency
    focal, neighbor = (series.index.get_level_values(level) for level in (0, 1))
    return host.Graph.from_arrays(names[focal], names[neighbor], series.to_numpy())
