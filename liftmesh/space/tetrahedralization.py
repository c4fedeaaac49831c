"""`Tetrahedralization`: tetrahedra of the caller's rows, with SciPy's attribute names."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Floats, Progress, Rows
from liftmesh.base.arrays import as_triples
from liftmesh.base.frozen import FrozenResult, cached_property, check_copied
from liftmesh.planar.alpha import AlphaMethods
from liftmesh.planar.tetrahedra import verify_tetrahedra

if TYPE_CHECKING:
    from liftmesh.planar.certificate import Certificate


@dataclass(frozen=True, eq=False, repr=False)
class Tetrahedralization(FrozenResult, AlphaMethods):
    """A Delaunay triangulation of points in space, as returned by `tetrahedralize`.

    Every index is a row of the caller's array. The arrays are read-only: copy one to change it.

    Parameters
    ----------
    points : (n, 3) ndarray of float64
        The points, in the order of the caller's rows: a read-only view of them if they are float64,
        which writes to the caller's array change.
    simplices : (m, 4) ndarray of int32
        The tetrahedra, positively oriented: `orient3d` of their corners is 1.
    neighbors : (m, 4) ndarray of int32
        The tetrahedron across the facet opposite vertex k; -1 outside.
    convex_hull : (h, 3) ndarray of int32
        The facets of the convex hull, counter-clockwise seen from outside.
    duplicates : (k, 2) ndarray of int32
        Rows that are not a vertex because an earlier row has the same position, ascending, each
        with that row.
    skipped : (j,) ndarray of int32
        Rows that were skipped because they are not finite, ascending.

    See Also
    --------
    tetrahedralize : Makes them.
    Triangulation : The same in the plane.

    Examples
    --------
    >>> import liftmesh
    >>> liftmesh.tetrahedralize([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    <Tetrahedralization of 4 points: 1 tetrahedron>
    """

    points: Floats
    simplices: Rows
    neighbors: Rows
    convex_hull: Rows
    duplicates: Rows
    skipped: Rows

    def _check_copy(self) -> None:
        others = self.convex_hull, self.duplicates, self.skipped
        check_copied(len(self.points), self.simplices, self.neighbors, *others, corners=4)

    def __repr__(self) -> str:
        count = len(self.simplices)
        what = "1 tetrahedron" if count == 1 else f"{count:,} tetrahedra"
        return f"<Tetrahedralization of {len(self.points):,} points: {what}>"

    def find_simplex(self, xi: ArrayLike) -> Rows:
        """Find the tetrahedra that contain the given points, exactly.

        Parameters
        ----------
        xi : array_like of shape (..., 3)
            Points in space.

        Returns
        -------
        (...) ndarray of int32
            The tetrahedron that contains each point; on a facet, an edge or a vertex the first such
            row of ``simplices``; -1 outside the convex hull, and for points that are not finite.

        Raises
        ------
        InputError
            The last axis is not of length three.

        See Also
        --------
        Triangulation.find_simplex : The same in the plane.

        Notes
        -----
        Visibility walks with exact orientations, for the points along a Hilbert curve, by a single
        thread.

        Examples
        --------
        >>> import liftmesh
        >>> tetra = liftmesh.tetrahedralize([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
        >>> tetra.find_simplex([[0, 0, 0.5], [0, 0, -5e-324], [0, 0, np.nan]])
        array([ 0, -1, -1], dtype=int32)
        """
        places = as_triples(xi)
        found = np.empty(places.shape[:-1], dtype=np.int32)
        self._locator.find(places.reshape(-1, 3), found.reshape(-1))
        return found

    @cached_property
    def _locator(self) -> _kernel.SpaceLocator:
        arrays = self.points, self.simplices, self.neighbors
        return _kernel.SpaceLocator(*map(np.ascontiguousarray, arrays))

    def verify(
        self, *, threads: int | None = None, progress: Progress | None = None
    ) -> Certificate:
        """Verify the tetrahedra from scratch, as `liftmesh.verify` does for any.

        Parameters
        ----------
        threads : int, optional
            As for `tetrahedralize`.
        progress : callable, optional
            As for `tetrahedralize`.

        Returns
        -------
        Certificate
            True if the tetrahedra are a Delaunay triangulation of the points.

        Raises
        ------
        InputError
            `threads` is not a valid number, or `progress` cannot be called.

        See Also
        --------
        verify : The check of tetrahedra from any source.

        Examples
        --------
        >>> import liftmesh, numpy as np
        >>> cube = np.indices((2, 2, 2)).reshape(3, -1).T
        >>> print(liftmesh.tetrahedralize(cube).verify())
        valid: these 6 tetrahedra are the canonical Delaunay triangulation of 8 rows
        """
        is_skipping = len(self.skipped) > 0
        return verify_tetrahedra(self.points, self.simplices, is_skipping, threads, progress)
