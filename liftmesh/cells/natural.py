"""natural_neighbors(): what a new point's Voronoi cell would take from the cells of the others.

The triangles whose circle has the point inside form a cavity around it (Bowyer 1981, Watson 1981);
the rows on its border are its natural neighbours, and exact in-circle tests find them. Sibson's
weight of a row ("A brief description of natural neighbour interpolation", 1981) is the share that
the new cell takes of the row's.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from liftmesh import _kernel
from liftmesh.base.arrays import as_pairs, check_finite
from liftmesh.base.options import as_threads
from liftmesh.base.weights import Weights, weights_of
from liftmesh.cells.dual import sites_of
from liftmesh.errors import InputError
from liftmesh.planar.constrained_triangulation import ConstrainedTriangulation
from liftmesh.planar.delaunay import delaunay
from liftmesh.planar.kinds import options_of
from liftmesh.planar.triangulation import Triangulation


class NaturalNeighbors(Weights):
    """The natural neighbours of points, as `natural_neighbors` returns them: their `Weights`.

    See Also
    --------
    natural_neighbors : Find natural neighbours.

    Examples
    --------
    >>> import liftmesh
    >>> square = [[0, 0], [2, 0], [2, 2], [0, 2]]
    >>> found = liftmesh.natural_neighbors(square, [[1, 1], [5, 5]])
    >>> found.indices, found.data, found.indptr
    (array([0, 1, 2, 3], dtype=int32), array([0.25, 0.25, 0.25, 0.25]), array([0, 4, 4]))
    """

    __slots__ = ()


def natural_neighbors(
    points: object, queries: Any, *, threads: int | None = None
) -> NaturalNeighbors:
    """Find the natural neighbours of points, and Sibson's weights.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3), or Triangulation
        Planar points, as for `voronoi`, or what `delaunay` returns of them.
    queries : array_like of shape (m, 2)
        Where neighbours are asked for; or a cloud, a table or points of GeoPandas.
    threads : int, optional
        As for `delaunay`; the result is the same for any number.

    Returns
    -------
    NaturalNeighbors
        Rows and weights, from the lexicographically least neighbour on, counter-clockwise. At a
        row this alone has a weight, on the convex hull the two rows of the edge; outside there
        are none. Of rows at one position the first counts.

    Raises
    ------
    InputError
        As for `delaunay`; the triangulation is by weights, a metric or the farthest point, or has
        constraints; or its points have changed since.
    NonFiniteError
        A point or a query is not finite.
    DegenerateInputError
        All points lie on one line.

    See Also
    --------
    voronoi : The cells that a new point would take from.
    NaturalNeighbors.interpolate : Means of values by the weights.
    Surface.sample : Heights of a surface, also by natural neighbours.

    Notes
    -----
    Which rows are neighbours is exact. Weights are rounded: each is right to 1e-12 of the largest,
    however near to the hull or to other rows the query is. A query takes time in proportion to the
    triangles that it would replace.

    Examples
    --------
    >>> rng = np.random.default_rng(3)
    >>> points, queries = rng.random((100, 2)), rng.random((5, 2)) / 2 + 0.25
    >>> found = natural_neighbors(points, queries)
    >>> bool(np.allclose(found.interpolate(points), queries))  # linear functions are reproduced
    True
    """
    tri = (
        points
        if isinstance(points, Triangulation)
        else delaunay(sites_of(points, queries), threads=threads, copy=True)
    )
    if isinstance(tri, ConstrainedTriangulation):
        raise InputError(
            "the triangulation has constraints, and natural neighbours are those of a Delaunay "
            "triangulation: give the points"
        )
    if other := options_of(tri):
        raise InputError(
            f"points are triangulated by {', '.join(other)}, and natural neighbours are those of a "
            "Delaunay triangulation: give the points"
        )
    asked = sites_of(queries)
    at = as_pairs(asked if asked is queries else np.asarray(asked)[:, :2]).reshape(-1, 2)
    check_finite(at, skippable=False)
    count = len(tri.points)
    level = np.broadcast_to(0.0, count)
    relief = _kernel.Relief(tri.points, tri.simplices, tri.neighbors, level, None)
    located = tri._locator  # noqa: SLF001 - made once for all that is asked of it
    found = weights_of(relief.weights(located, at, "sibson", *as_threads(threads, len(at))), count)
    return NaturalNeighbors(found.indptr, found.indices, found.data, found.shape)
