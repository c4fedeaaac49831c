"""`Delaunay` and `Voronoi`: SciPy's classes, exact, for code that asks for an instance of them.

SciPy's interpolators, and many libraries, read the attributes of its classes in compiled code:
C-contiguous arrays of float64 and int32. These classes inherit from SciPy's and have these
attributes, but never run Qhull. What SciPy's `Delaunay` computes when it is made is an ordinary
attribute, which a caller may replace; what it computes on first access comes from `Triangulation`,
and is computed from the triangles as the caller may have rewritten them. Callers write to
``simplices`` (``tri.simplices.sort()``). Point location must not see that, so it has the kernel's
arrays, and the caller has copies.

The vertices of a `Voronoi` come from the exact triangulation. Ridges and regions are found when one
of them is first asked for; lists, which take longer than everything else, when they are.

In space the classes are others, which `qhull/` has; SciPy is imported with them, at the first use
of ``liftmesh.scipy``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Apex, Array, Floats, Rows
from liftmesh.base.arrays import edges_of_faces, pair_keys, pairs_of_keys, read_only, widened
from liftmesh.base.display import Plotted
from liftmesh.base.frozen import cached_property, check_adjacent, check_copied, check_numbers
from liftmesh.errors import InputError
from liftmesh.optional import load
from liftmesh.planar.delaunay import Solution, solve, solve_farthest
from liftmesh.planar.diagram import Regions, diagram_of, regions_of
from liftmesh.planar.points import edges_around
from liftmesh.planar.triangulation import Triangulation
from liftmesh.qhull.common import Growing, planar_rows, scipys_errors
from liftmesh.qhull.lists import Lists
from liftmesh.qhull.space import SpaceDelaunay
from liftmesh.qhull.voronoi import SpaceVoronoi

if TYPE_CHECKING:
    from scipy import spatial

    from liftmesh.planar.lifting import LowerHull
else:
    spatial = load("scipy.spatial", extra="scipy")

__all__ = ["Delaunay", "SpaceDelaunay", "SpaceVoronoi", "Voronoi"]


class Delaunay(Growing, Triangulation, spatial.Delaunay):  # type: ignore[misc]
    """Drop-in replacement for ``scipy.spatial.Delaunay``, and an instance of it.

    SciPy's interpolators, ``tsearch`` and ``delaunay_plot_2d`` take it. Differences from SciPy: the
    triangulation is exact and canonical, and so is `find_simplex`; ``points`` is read-only;
    `lift_points`, `plane_distance` and `equations` are of the paraboloid
    z = x^2 + y^2, which SciPy scales. As with SciPy, ``simplices`` and ``neighbors`` may be written
    to or replaced; `find_simplex` keeps to the triangulation as it was computed.

    Of points with three and more columns it makes a `liftmesh.scipy.SpaceDelaunay`, which is an
    instance of this class, too: the exact tetrahedra in space, and beyond Qhull's simplices with an
    exact check. What is said here of edges, lifted triangles and `furthest_site` is of the plane.

    Parameters
    ----------
    points : array_like of shape (n, d)
        Planar points, or points of more columns.
    furthest_site : bool, default False
        Whether to compute the farthest-point Delaunay triangulation: the upper hull of the lifted
        points, in which the circle of every triangle contains every point. Its vertices are the
        corners of the convex hull; the other rows are in ``hidden``. It is exact and canonical, too
        (lexicographically larger points are lifted less: of points on one circle it is the
        triangulation that `delaunay` makes).
    incremental : bool, default False
        Whether points can be added, by `add_points`, until `close` is called.
    qhull_options : str, optional
        Options of Qhull. Those that serve its rounding or its output have no effect; those that
        would change the triangulation raise an error. ``coplanar`` is filled without ``Qc``, too.
    copy : bool, default False
        Whether to copy the points first, as for `delaunay`; `incremental` always does.

    Attributes
    ----------
    furthest_site : bool
        As given.
    certified : bool
        True: the triangles are a Delaunay triangulation.
    hidden : (h,) ndarray of int32
        With `furthest_site`, the rows that are no vertices, and not at one, in ascending order;
        those at a vertex are in ``duplicates`` and ``coplanar``. Otherwise none.

    Raises
    ------
    InputError
        As for `delaunay`, or an option is set that liftmesh does not support.
    NonFiniteError
        A row is not finite.
    DegenerateInputError
        There are fewer than three distinct points, or all lie on one line. The error is a
        ``scipy.spatial.QhullError`` too.

    See Also
    --------
    delaunay : Without SciPy, with all options.
    Triangulation : What it adds to SciPy's class.
    liftmesh.scipy.SpaceDelaunay : What it makes of more columns.
    liftmesh.scipy.Voronoi : The dual diagram.

    Examples
    --------
    >>> tri = Delaunay(np.array([[0, 0], [0, 1.1], [1, 0], [1, 1]]))
    >>> tri.find_simplex([(0.1, 0.2), (1.5, 0.5)]) >= 0
    array([ True, False])
    >>> from scipy.interpolate import LinearNDInterpolator
    >>> float(LinearNDInterpolator(tri, [0.0, 1.1, 2.0, 3.0])(0.5, 0.25))
    1.25
    >>> far = Delaunay([[0, 0], [4, 0], [5, 3], [0, 2], [1, 1]], furthest_site=True)
    >>> far.hidden, far.nsimplex
    (array([4], dtype=int32), 2)
    """

    npoints = 0
    nsimplex = 0
    certified = True
    _kind = "triangulation"
    _in_space = SpaceDelaunay
    _as_rows = staticmethod(planar_rows)

    def _compute(self, rows: Floats, *, copy: bool) -> None:
        solution = solve_for_scipy(rows, furthest_site=self.furthest_site, copy=copy)
        for name in _COMPUTED_LATER:
            self.__dict__.pop(name, None)
        self._exact = solution.simplices, solution.neighbors
        simplices, neighbors = solution.simplices.copy(), solution.neighbors.copy()
        self.hidden = read_only(solution.hidden)
        Triangulation.__init__(self, solution.points, simplices, neighbors, *solution[3:6])
        self.npoints = len(solution.points)
        self.nsimplex = len(self.simplices)

    def _given(self) -> tuple[Rows, ...]:
        return *self._exact, self._hull, self.duplicates, self.skipped

    def _protect(self) -> None:
        for array in (self._rows, *self._given()):
            array.setflags(write=False)

    def _kept(self, array: Array) -> Array:
        return array  # SciPy's users write to it

    @property
    def convex_hull(self) -> Rows:
        """The edges of the convex hull, (h, 2) int32, as SciPy has them; here counter-clockwise.

        A `Triangulation` has the cycle of rows instead: ``convex_hull[:, 0]``.
        """
        return edges_around(self._hull)

    @cached_property
    def coplanar(self) -> Rows:
        """The duplicates, (k, 3) int32: row, a triangle at the row, row kept.

        In the order of the triangles, then of the rows.
        """
        return super().coplanar

    @cached_property
    def equations(self) -> Floats:
        """The planes of the lifted triangles, (m, 4) float64: outward unit normal and offset.

        Outward is downward; with `furthest_site`, it is upward.
        """
        return -super().equations if self.furthest_site else super().equations

    def lifted(self, apex: Apex = "median") -> LowerHull:
        """Return the lower hull of the lifted points; its projection is this triangulation.

        Parameters
        ----------
        apex : {"median", "origin"} or (2,) array_like, default "median"
            The apex of the paraboloid, as for `lift`.

        Returns
        -------
        LowerHull
            A mesh in space, as for `Triangulation`.

        Raises
        ------
        InputError
            The apex is not one of these, or the triangles are the upper hull.

        See Also
        --------
        Triangulation.lifted : The same without SciPy.

        Examples
        --------
        >>> len(Delaunay([[0, 0], [1, 0], [0, 1]]).lifted().faces)
        1
        """
        if self.furthest_site:
            raise InputError(
                "with furthest_site=True the triangles are the upper hull of the lifted points: "
                "liftmesh.lift(points) and simplices are its vertices and faces"
            )
        return super().lifted(apex)

    @cached_property
    def good(self) -> Rows:
        """Ones, (m,) int32: SciPy's mark of triangles that `qhull_options` did not exclude."""
        return super().good

    @cached_property
    def edges(self) -> Rows:
        """The edges, (e, 2) int32: each once, with its lesser row first, in order of the triangles.

        For arrays of the two ends, as for plotting: ``points[edges]`` has the shape (e, 2, 2).
        """
        return read_only(edges_of_faces(self.simplices)) if self._is_rewritten() else super().edges

    @cached_property
    def vertex_neighbor_vertices(self) -> tuple[Rows, Rows]:
        """The neighbours of each row: indptr, (n + 1,) int32, and indices, int32.

        Those of row i are ``indices[indptr[i]:indptr[i + 1]]``.
        """
        if self._is_rewritten():
            return _neighbors_in(self.simplices, self.npoints)
        return super().vertex_neighbor_vertices

    def _is_rewritten(self) -> bool:
        """Whether the caller has changed the triangles or their neighbours."""
        given = (self.simplices, self.neighbors)
        return not all(map(np.array_equal, given, self._exact))

    @cached_property
    def _locator(self) -> _kernel.Locator:
        return _kernel.Locator(self._rows, *self._exact)


_COMPUTED_LATER = [
    name
    for kind in (Triangulation, Delaunay)
    for name, member in vars(kind).items()
    if isinstance(member, cached_property)
]


def _neighbors_in(simplices: Rows, npoints: int) -> tuple[Rows, Rows]:
    """Return the neighbours of each row in any triangles, as SciPy does."""
    start = simplices[:, [0, 1, 2, 0, 1, 2]].reshape(-1)
    end = simplices[:, [1, 2, 0, 2, 0, 1]].reshape(-1)
    rows, others = pairs_of_keys(np.unique(pair_keys(start, end)))
    indptr = np.zeros(npoints + 1, dtype=np.int32)
    np.cumsum(np.bincount(rows, minlength=npoints), out=indptr[1:])
    return indptr, others.astype(np.int32)


class Voronoi(Lists, Plotted, spatial.Voronoi):  # type: ignore[misc]
    """Drop-in replacement for ``scipy.spatial.Voronoi``, and an instance of it.

    The topology is exact: sites on one circle share one vertex, and no region is lost at any
    offset. Each coordinate of a vertex is the double nearest to the exact one. Further differences
    from SciPy: the corners of a region are counter-clockwise, those of an unbounded one begin with
    -1, and unbounded regions come first. As with SciPy, ``vertices``,
    ``ridge_points``, ``point_region`` and the lists may be written to; other arrays are read-only.
    Of points in space it makes a `liftmesh.scipy.SpaceVoronoi`, which is an instance of it, too.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        Planar points, or points in space.
    furthest_site : bool, default False
        Whether to compute the farthest-site diagram: a region holds what is farther from its site
        than from all others.
    incremental : bool, default False
        Whether points can be added, by `add_points`, until `close` is called.
    qhull_options : str, optional
        Options of Qhull, by default "Qbb Qc Qz", or "Qbb Qc" if `incremental`. "Qz" adds an empty
        region, which is the first. Others that serve Qhull's rounding or its output have no effect;
        those that would change the diagram raise an error.
    copy : bool, default False
        Whether to copy the points first, as for `delaunay`; `incremental` always does.

    Attributes
    ----------
    points : (n, 2) ndarray of float64
        The sites.
    vertices : (v, 2) ndarray of float64
        The Voronoi vertices. Beyond the greatest double, a coordinate is infinite.
    overflowed : int
        How many vertices have an infinite coordinate.
    ridge_points : (r, 2) ndarray of int32
        The rows of the two sites between which each ridge lies. The second site of a ray follows
        the first on the hull, counter-clockwise: the ray runs to the right of the line from one to
        the other, or to its left with `furthest_site`.
    ridge_ends : (r, 2) ndarray of int32
        The vertices at both ends of each ridge, the lesser first; the first of a ray is -1.
    ridge_vertices : list of list of int
        The same as lists.
    ridge_dict : dict
        `ridge_vertices` by the two rows of `ridge_points`.
    point_region : (n,) ndarray of intp
        The region of each row. Duplicates share one. With `furthest_site`, rows that are no corners
        of the convex hull have the empty region, or -1 if there is none; SciPy makes an empty
        region for each.
    simplices : (m, 3) ndarray of int32
        The Delaunay triangles.
    simplex_to_vertex : (m,) ndarray of int32
        The vertex that is the centre of each triangle's circle.
    duplicates : (k, 2) ndarray of int32
        Rows at the position of another, each with the first row there.
    ndim, npoints, min_bound, max_bound, furthest_site
        As for `Delaunay`.

    Raises
    ------
    InputError
        As for `delaunay`, or an option is set that liftmesh does not support.
    NonFiniteError
        A row is not finite.
    DegenerateInputError
        There are fewer than three distinct points, or all lie on one line. The error is a
        ``scipy.spatial.QhullError`` too.

    See Also
    --------
    voronoi : Cells clipped to a domain.
    liftmesh.scipy.Delaunay : The dual triangulation.
    liftmesh.scipy.SpaceVoronoi : What it makes of points in space.

    Examples
    --------
    >>> diagram = Voronoi([[0, 0], [2, 0], [2, 2], [0, 2], [5, 1]])
    >>> diagram.vertices
    array([[1.        , 1.        ],
           [3.33333333, 1.        ]])
    >>> diagram.regions[diagram.point_region[4]]
    [-1, 1]
    """

    _in_space = SpaceVoronoi

    def _as_rows(self, points: ArrayLike) -> Floats:
        return planar_rows(points, "Voronoi")

    def _compute(self, rows: Floats, *, copy: bool) -> None:
        solution = solve_for_scipy(rows, furthest_site=self.furthest_site, copy=copy)
        self._forget()
        points, simplices = read_only(widened(solution.points)), read_only(solution.simplices)
        diagram = diagram_of(points, simplices, solution.neighbors)
        self._points = points
        self.npoints, self.ndim = points.shape
        on_hull = points[solution.hull]
        self.min_bound, self.max_bound = on_hull.min(axis=0), on_hull.max(axis=0)
        self.simplices, self.duplicates = simplices, solution.duplicates
        self.vertices = diagram.vertices.copy()  # SciPy's users write to it, as to ridge_points
        self.simplex_to_vertex = read_only(diagram.simplex_to_vertex)
        self.overflowed = diagram.overflowed
        self._neighbors = solution.neighbors

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        check_copied(len(self._points), self.simplices, self._neighbors, self.duplicates)
        check_adjacent(self.simplices, self._neighbors)
        check_numbers(0, len(self.vertices), self.simplex_to_vertex)

    @cached_property
    def _found(self) -> Regions:
        return regions_of(self.npoints, self.simplices, self._neighbors, self.simplex_to_vertex)

    @cached_property
    def ridge_points(self) -> Rows:
        """The rows of the two sites of each ridge, (r, 2) int32."""
        rows: Rows = self._found.ridge_points.copy()
        return rows

    @property
    def ridge_ends(self) -> Rows:
        """The vertices at both ends of each ridge, (r, 2) int32; the first of a ray is -1."""
        return self._found.ridge_ends

    @cached_property
    def ridge_vertices(self) -> list[list[int]]:
        """The vertices at both ends of each ridge as lists; -1 is at infinity."""
        ends: list[list[int]] = self.ridge_ends.tolist()
        return ends


def solve_for_scipy(rows: Floats, *, furthest_site: bool, copy: bool) -> Solution:
    """Triangulate points, with the errors that SciPy's callers expect."""
    with scipys_errors(rows):
        return (solve_farthest if furthest_site else solve)(rows, copy=copy)
