"""`Tetrahedralization`: tetrahedra of the caller's rows, with SciPy's attribute names."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Floats, Progress, Rows
from liftmesh.base.arrays import as_numbers, as_triples
from liftmesh.base.frozen import FrozenResult, cached_property, check_copied
from liftmesh.errors import InputError
from liftmesh.optional import load
from liftmesh.planar.alpha import AlphaMethods
from liftmesh.planar.space_verification import verify_tetrahedra
from liftmesh.space.interpolation import interpolated

if TYPE_CHECKING:
    import pyvista

    from liftmesh.io.write import WriteResult
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

    def interpolate(self, values: ArrayLike, xi: ArrayLike, *, fill: float = np.nan) -> Floats:
        """Interpolate values of the rows linearly, each in the tetrahedron that contains it.

        Parameters
        ----------
        values : (n,) or (n, k) array_like
            The values of the rows. Those of duplicates are not used.
        xi : array_like of shape (..., 3)
            Places in space.
        fill : float, default NaN
            The value outside the convex hull, and at places that are not finite.

        Returns
        -------
        (...) or (..., k) ndarray of float64
            The values, with the same bits in any order of the rows; at a vertex exactly its value.

        Raises
        ------
        InputError
            `values` are not one for each row, or no numbers; or the last axis of `xi` is not of
            length three.

        See Also
        --------
        Tetrahedralization.find_simplex : The tetrahedra.
        Surface.sample : The same in the plane.

        Examples
        --------
        >>> import liftmesh
        >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        >>> tetra = liftmesh.tetrahedralize(corners)
        >>> tetra.interpolate([0, 1, 10, 100], [[0.25, 0.25, 0.25], [2, 0, 0]])
        array([27.75,   nan])
        """
        given = as_numbers("values", values, "give a number for each row", verb="are")
        if given.ndim not in (1, 2) or len(given) != len(self.points):
            raise InputError(
                f"values have the shape {given.shape}: give one for each of the "
                f"{len(self.points):,} rows, or a row of them"
            )
        places = as_triples(xi)
        found = self.find_simplex(places)
        is_inside = found >= 0
        result = np.full((*found.shape, *given.shape[1:]), float(fill))
        if is_inside.any():
            corners = self.simplices[found[is_inside]]
            result[is_inside] = interpolated(self.points, corners, places[is_inside], given)
        return result

    def save(self, path: Any, *, overwrite: bool = True) -> WriteResult:
        """Write the tetrahedra to a file, with every row of the points in its place.

        Parameters
        ----------
        path : path
            Where to write; the suffix determines the format: VTU, or VTK or MSH of Gmsh (4.1),
            which meshio writes.
        overwrite : bool, default True
            Whether a file that exists is replaced.

        Returns
        -------
        WriteResult
            Summary of what was written.

        Raises
        ------
        FormatError
            The suffix is another.
        FileExistsError
            The file exists, and is not to be replaced.
        OSError
            The file cannot be written; the message gives the reason.

        See Also
        --------
        verify : Reads such files, and proves them.

        Examples
        --------
        >>> import liftmesh, tempfile
        >>> tetra = liftmesh.tetrahedralize([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     written = tetra.save(f"{folder}/cells.vtu")
        ...     print(written.format, liftmesh.verify(written.path).canonical)
        vtu True
        """
        from liftmesh.io.tetrahedra import write_tetrahedra  # noqa: PLC0415 - arrays do without

        return write_tetrahedra(path, self.points, self.simplices, overwrite=overwrite)

    def to_pyvista(self) -> pyvista.UnstructuredGrid:
        """Convert the tetrahedra to a grid of PyVista.

        Returns
        -------
        pyvista.UnstructuredGrid
            All rows of the points, with the tetrahedra as cells.

        Raises
        ------
        MissingDependencyError
            PyVista is not installed.

        See Also
        --------
        Tetrahedralization.save : As a file, which PyVista reads, too.

        Examples
        --------
        >>> import liftmesh
        >>> from importlib.util import find_spec
        >>> tetra = liftmesh.tetrahedralize([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
        >>> tetra.to_pyvista().n_cells if find_spec("pyvista") else 1
        1
        """
        made = load("pyvista", extra="pyvista")
        grid: pyvista.UnstructuredGrid = made.UnstructuredGrid(
            {made.CellType.TETRA: self.simplices.astype(np.int64)}, self.points.copy()
        )
        return grid

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
