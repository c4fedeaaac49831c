"""convex_hull(): the convex hull of points in space, as a mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Floats, Progress, Rows
from liftmesh.base.arrays import of_one_array
from liftmesh.base.frozen import check_numbers
from liftmesh.base.options import NonFinite
from liftmesh.planar.lifting import HullMesh
from liftmesh.space.tetrahedra import tetrahedralize

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class ConvexHull(HullMesh):
    """The convex hull of points in space, as a watertight mesh. Its arrays are read-only.

    Parameters
    ----------
    points : (n, 3) ndarray of float64
        All points, in the order of the caller's rows.
    faces : (h, 3) ndarray of int32
        The facets as rows, counter-clockwise seen from outside.

    See Also
    --------
    convex_hull : Makes it.
    LowerHull : The part that is seen from below.

    Examples
    --------
    >>> import liftmesh
    >>> hull = liftmesh.convex_hull([[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4], [1, 1, 1]])
    >>> hull
    <ConvexHull of 4 facets on 4 of 5 points>
    """

    points: Floats
    faces: Rows

    def _check_copy(self) -> None:
        check_numbers(0, len(self.points), self.faces)

    def __repr__(self) -> str:
        corners, count = len(self.vertices), len(self.points)
        return f"<ConvexHull of {len(self.faces):,} facets on {corners:,} of {count:,} points>"

    @property
    def vertices(self) -> Rows:
        """The rows that are a corner of a facet, in ascending order.

        Returns
        -------
        (v,) ndarray of int32
            Those between corners of the hull, on its edges and facets, are among them.

        Examples
        --------
        >>> import liftmesh
        >>> corners = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]]
        >>> liftmesh.convex_hull([[1, 1, 1], *corners]).vertices
        array([1, 2, 3, 4], dtype=int32)
        """
        used: Rows = np.unique(self.faces)
        return used

    def to_cloud(self) -> Cloud:
        """Convert the hull to a cloud with faces, of its vertices alone.

        Returns
        -------
        Cloud
            Vertex i is row ``vertices[i]``.

        See Also
        --------
        ConvexHull.to_trimesh : As a mesh of trimesh.
        ConvexHull.to_open3d : As a mesh of Open3D.

        Examples
        --------
        >>> import liftmesh
        >>> corners = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [0, 0, 4]]
        >>> len(liftmesh.convex_hull([[1, 1, 1], *corners]).to_cloud())
        4
        """
        from liftmesh.base.cloud import Cloud  # noqa: PLC0415 - a hull does without

        rows, faces = np.unique(self.faces, return_inverse=True)
        corners = faces.reshape(-1, 3).astype(np.int32)
        return Cloud(np.asarray(self.points[rows], dtype=np.float64), faces=corners)


@of_one_array
def convex_hull(
    cloud: Any,
    *,
    nonfinite: NonFinite = "error",
    threads: int | None = None,
    progress: Progress | None = None,
) -> ConvexHull:
    """Compute the convex hull of points in space, exact for every finite double.

    The result is unique: a watertight, outward-oriented mesh. Where four or more points of the hull
    are on one plane, its facets are the Delaunay triangulation in that plane, with the ties of
    `tetrahedralize`. So points on facets and edges of the hull are vertices too, and the facets
    depend on the points alone.

    Parameters
    ----------
    cloud : array_like of shape (n, 3), Cloud, mesh, table or path
        As for `tetrahedralize`.
    nonfinite : {"error", "skip"}, default "error"
        Whether rows with NaN or infinity raise an error, or are skipped.
    threads : int, optional
        As for `tetrahedralize`.
    progress : callable, optional
        As for `delaunay`.

    Returns
    -------
    ConvexHull
        A mesh of the caller's rows; of rows at one position the first is a vertex.

    Raises
    ------
    InputError, NonFiniteError, FormatError
        As by `tetrahedralize`.
    DegenerateInputError
        There are fewer than four distinct points, or all lie on one line or one plane: the hull of
        a flat cloud is that in its plane, which bounds no volume.

    See Also
    --------
    lower_hull : The part that is seen from below, in less time.
    tetrahedralize : What is inside.

    Notes
    -----
    It is the surface of the tetrahedra, and takes their time.

    Examples
    --------
    >>> import numpy as np
    >>> cube = np.indices((2, 2, 2)).reshape(3, -1).T
    >>> convex_hull(cube).faces.shape
    (12, 3)
    """
    tetra = tetrahedralize(cloud, nonfinite=nonfinite, threads=threads, progress=progress)
    return ConvexHull(tetra.points, tetra.convex_hull)
