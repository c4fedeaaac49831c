"""Planar triangulations as objects of matplotlib and SciPy, without running their algorithms."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from liftmesh._typing import Floats, Rows
from liftmesh.optional import load

if TYPE_CHECKING:
    import matplotlib.tri
    import scipy.spatial


def to_triangulation(x: Floats, y: Floats, triangles: Rows) -> matplotlib.tri.Triangulation:
    """Convert planar triangles to a matplotlib triangulation.

    Parameters
    ----------
    x, y : (n,) ndarray of float64
        Planar coordinates.
    triangles : (m, 3) ndarray of int32
        Triangles as rows of them.

    Returns
    -------
    matplotlib.tri.Triangulation
        Planar coordinates and faces, for plots of ``surface.vertices[:, 2]`` or of any array
        of one value per vertex. Give matplotlib's cubic interpolator a copy of the values: it
        writes to them if there are rows in no face.

    Raises
    ------
    MissingDependencyError
        matplotlib is not installed.

    See Also
    --------
    Surface.to_trimesh, Surface.to_open3d : Meshes in space.

    Examples
    --------
    >>> import liftmesh
    >>> liftmesh.triangulate([[0, 0, 5], [1, 0, 6], [0, 1, 7]]).to_matplotlib().x
    array([0., 1., 0.])
    """
    tri = load("matplotlib.tri", extra="plot")
    triangulation: matplotlib.tri.Triangulation = tri.Triangulation(x, y, triangles)
    return triangulation


_SHARED = (
    "equations",
    "coplanar",
    "good",
    "nsimplex",
    "npoints",
    "ndim",
    "min_bound",
    "max_bound",
    "paraboloid_scale",
    "paraboloid_shift",
    "furthest_site",
)


class Triangulated(Protocol):
    """An object with SciPy's attributes, such as `liftmesh.Triangulation`."""

    simplices: Rows
    neighbors: Rows

    @property
    def points(self) -> Floats:
        """(n, 2) coordinates."""

    @property
    def transform(self) -> Floats:
        """(m, 3, 2) barycentric transforms."""

    @property
    def vertex_to_simplex(self) -> Rows:
        """(n,) triangles at the rows."""


def to_delaunay(triangulation: Triangulated) -> scipy.spatial.Delaunay:
    """Convert a triangulation to ``scipy.spatial.Delaunay``, for code that requires this class."""
    made = load("scipy.spatial", extra="scipy").Delaunay
    result = made.__new__(made)
    result.__dict__.update({name: getattr(triangulation, name) for name in _SHARED})
    result.__dict__.update(
        simplices=triangulation.simplices.copy(),
        neighbors=triangulation.neighbors.copy(),
        _points=np.ascontiguousarray(triangulation.points),
        _qhull=None,
        _transform=triangulation.transform,
        _vertex_to_simplex=triangulation.vertex_to_simplex,
        _vertex_neighbor_vertices=None,
    )
    return result
