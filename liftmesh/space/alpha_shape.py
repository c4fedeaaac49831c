"""alpha_shape(): the alpha shape of a cloud, in the plane or in space."""

from __future__ import annotations

from typing import Any

from liftmesh.base.arrays import of_one_array
from liftmesh.base.options import NonFinite
from liftmesh.planar.alpha import AlphaMethods, AlphaShape, as_alpha
from liftmesh.planar.delaunay import delaunay
from liftmesh.space.points import coordinates_of
from liftmesh.space.tetrahedra import tetrahedralize


@of_one_array
def alpha_shape(
    cloud: Any, alpha: float | None = None, *, nonfinite: NonFinite = "error"
) -> AlphaShape:
    """Compute the alpha shape of points in the plane or in space, and its surface as a mesh.

    The shape consists of the triangles of the Delaunay triangulation, or tetrahedra, whose circle
    or sphere has at most the radius `alpha`: where a ball of this radius cannot move between the
    points. All comparisons are exact.

    Parameters
    ----------
    cloud : array_like of shape (n, 2) or (n, 3), Cloud, mesh, table or path
        Points as for `delaunay` with two columns, else as for `tetrahedralize`; or what these
        return, of which many shapes can be made.
    alpha : float, optional
        The radius, in units of the coordinates, as for Open3D, PyVista and MATLAB. CGAL and GUDHI
        take its square, the package alphashape its reciprocal. By default the least one for which
        the shape holds all points in one part (``optimal_alpha``).
    nonfinite : {"error", "skip"}, default "error"
        As for `tetrahedralize`.

    Returns
    -------
    AlphaShape
        The simplices of the shape, its boundary, oriented outward, and triangles that belong to no
        tetrahedron. Indices are rows of the cloud.

    Raises
    ------
    InputError
        `alpha` is negative or no number, or as for `tetrahedralize` and `delaunay`.
    NonFiniteError
        A row is not finite and `nonfinite` is "error".
    DegenerateInputError
        All points lie on one line, or in space on one plane.
    FormatError
        The file cannot be read.

    See Also
    --------
    Triangulation.alpha_shape, Tetrahedralization.alpha_shape : More shapes of one triangulation.
    Tetrahedralization.alpha_complex : All faces, with the radii with which they enter.
    Surface.trim : The same of a surface, with ``max_radius``.

    Examples
    --------
    >>> import numpy as np
    >>> shape = alpha_shape(np.random.default_rng(7).random((2000, 3)), 0.2)
    >>> shape
    <AlphaShape of alpha 0.2: 11,909 tetrahedra inside 894 triangles>
    >>> shape.to_trimesh().is_watertight, len(shape.nonmanifold)
    (True, 0)
    """
    if isinstance(cloud, AlphaMethods):
        return cloud.alpha_shape(alpha)
    radius = None if alpha is None else as_alpha(alpha)  # before the triangulation
    rows = coordinates_of(cloud)
    if rows.shape[1] == 2:
        return delaunay(rows, nonfinite=nonfinite).alpha_shape(radius)
    return tetrahedralize(rows, nonfinite=nonfinite).alpha_shape(radius)
