"""`SpaceVoronoi`: SciPy's class for the Voronoi diagram of points in space."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats, Integers, Rows
from liftmesh.base.arrays import as_any_columns, read_only
from liftmesh.base.frozen import cached_property, check_numbers
from liftmesh.errors import InputError
from liftmesh.optional import load
from liftmesh.qhull.common import scipys_errors
from liftmesh.qhull.dual import Centers, Solids, centers_of, solids_of
from liftmesh.qhull.lists import Lists
from liftmesh.space.tetrahedra import tetrahedralize

if TYPE_CHECKING:
    from scipy import spatial
else:
    spatial = load("scipy.spatial", extra="scipy")


class SpaceVoronoi(Lists, spatial.Voronoi):  # type: ignore[misc]
    """What ``liftmesh.scipy.Voronoi`` makes of points in space.

    It is an instance of ``liftmesh.scipy.Voronoi`` and of ``scipy.spatial.Voronoi``. The topology
    is exact: tetrahedra on one sphere share one vertex, so that of a lattice every region is a
    cube, and no ridge is there that has no area. Each coordinate of a vertex is the double nearest
    to the exact one. The corners of a ridge are in order around it, and unbounded ones begin with
    -1.

    Parameters
    ----------
    points : array_like of shape (n, 3)
        Points in space. More columns are refused: nothing proves what SciPy makes of them.
    furthest_site : bool, default False
        Only False: farthest-site diagrams are planar.
    incremental : bool, default False
        Whether points can be added, by `add_points`, until `close` is called.
    qhull_options : str, optional
        As for `liftmesh.scipy.Voronoi`.
    copy : bool, default False
        Whether to copy the points first; `incremental` always does.

    Attributes
    ----------
    vertices : (v, 3) ndarray of float64
        The Voronoi vertices. Beyond the greatest double, a coordinate is infinite.
    overflowed : int
        How many vertices have an infinite coordinate.
    ridge_points : (r, 2) ndarray of int32
        The rows of the two sites between which each ridge lies, the lesser first.
    ridge_vertices : list of list of int
        The corners of each ridge, counter-clockwise seen from the second site; unbounded ones begin
        with -1.
    ridge_corners : tuple of ndarray
        The same as arrays: those of ridge i are ``indices[indptr[i]:indptr[i + 1]]``.
    ridge_dict : dict
        `ridge_vertices` by the two rows of `ridge_points`.
    point_region : (n,) ndarray of intp
        The region of each row. Duplicates share one.
    regions : list of list of int
        The vertices of each region, ascending; those of unbounded ones begin with -1.
    simplices : (m, 4) ndarray of int32
        The Delaunay tetrahedra.
    simplex_to_vertex : (m,) ndarray of int32
        The vertex that is the centre of each tetrahedron's sphere.
    duplicates : (k, 2) ndarray of int32
        Rows at the position of another, each with the first row there.

    Raises
    ------
    InputError
        An option is not for points in space, or `points` are no such points.
    NonFiniteError
        A row is not finite.
    DegenerateInputError
        All points lie on one plane, or there are fewer than four. The error is a
        ``scipy.spatial.QhullError`` too.

    See Also
    --------
    tetrahedralize : The dual tetrahedra.
    liftmesh.scipy.Voronoi : The same in the plane.

    Examples
    --------
    >>> import liftmesh
    >>> grid = np.indices((3, 3, 3)).reshape(3, -1).T
    >>> diagram = liftmesh.scipy.Voronoi(grid)
    >>> len(diagram.vertices), len(diagram.regions[diagram.point_region[13]])
    (8, 8)
    >>> len(diagram.ridge_dict[4, 13])
    4
    """

    def _as_rows(self, points: ArrayLike) -> Floats:
        rows = as_any_columns(points)
        if rows.shape[1] != 3:
            raise InputError(
                f"points have {rows.shape[1]} columns where three are needed: use "
                "scipy.spatial.Voronoi for more, which nothing proves"
            )
        return rows

    def _compute(self, rows: Floats, *, copy: bool) -> None:
        if self.furthest_site:
            raise InputError(
                "furthest_site=True is for planar points: use scipy.spatial.Voronoi, whose result "
                "in space nothing proves"
            )
        rows = read_only(rows.copy() if copy else rows)
        with scipys_errors(rows):
            tetra = tetrahedralize(rows)
        centers = centers_of(tetra)
        self._forget()
        self._points, self._tetra = rows, tetra
        self.npoints, self.ndim = rows.shape
        corners = rows[np.unique(tetra.convex_hull)]
        self.min_bound, self.max_bound = corners.min(axis=0), corners.max(axis=0)
        self.simplices, self.duplicates = tetra.simplices, tetra.duplicates
        self.vertices = centers.vertices.copy()  # SciPy's users write to it
        self.simplex_to_vertex = read_only(centers.simplex_to_vertex)
        self.overflowed = centers.overflowed

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        check_numbers(0, len(self.vertices), self.simplex_to_vertex)

    @cached_property
    def _found(self) -> Solids:
        return solids_of(
            self._tetra, Centers(self.vertices, self.simplex_to_vertex, self.overflowed)
        )

    @cached_property
    def ridge_points(self) -> Rows:
        """The rows of the two sites of each ridge, (r, 2) int32, the lesser first."""
        rows: Rows = self._found.ridge_points.copy()
        return rows

    @property
    def ridge_corners(self) -> tuple[Integers, Rows]:
        """The corners of each ridge as arrays: indptr, (r + 1,), and indices, int32."""
        return self._found.ridge_starts, self._found.ridge_corners

    @cached_property
    def ridge_vertices(self) -> list[list[int]]:
        """The corners of each ridge as lists, in order; unbounded ones begin with -1."""
        starts, corners = (part.tolist() for part in self.ridge_corners)
        return [corners[start:end] for start, end in pairwise(starts)]
