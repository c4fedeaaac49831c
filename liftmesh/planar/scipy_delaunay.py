"""`Delaunay`: a `Triangulation` that is also a ``scipy.spatial.Delaunay``.

SciPy's interpolators, and many libraries, ask for an instance of SciPy's class, and read its
attributes in compiled code: C-contiguous arrays of float64 and int32. This class inherits from both
and has these attributes, but never runs Qhull. What SciPy's class computes when it is made is an
ordinary attribute, which a caller may replace; what it computes on first access comes from
`Triangulation`, and is computed from the triangles as the caller may have rewritten them.

Callers write to ``simplices`` (``tri.simplices.sort()``). Point location must not see that, so it
has the kernel's arrays, and the caller has copies.

SciPy is imported with this module, which is when ``liftmesh.Delaunay`` is first asked for.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, ParaboloidVertex, Rows
from liftmesh.base.arrays import read_only
from liftmesh.base.frozen import cached_property
from liftmesh.base.options import as_switch
from liftmesh.errors import InputError
from liftmesh.optional import load
from liftmesh.planar.scipy_class import Growing, check_qhull_options, planar_rows, solved
from liftmesh.planar.triangulation import Triangulation

if TYPE_CHECKING:
    from scipy import spatial

    from liftmesh.planar.lifting import LowerHull
else:
    spatial = load("scipy.spatial")


class Delaunay(Growing, Triangulation, spatial.Delaunay):  # type: ignore[misc]
    """Drop-in replacement for ``scipy.spatial.Delaunay``, and an instance of it.

    SciPy's interpolators, ``tsearch`` and ``delaunay_plot_2d`` take it. Differences from SciPy: the
    triangulation is exact and canonical, and so is `find_simplex`; points are planar only;
    ``points`` is read-only; `lift_points`, `plane_distance` and `equations` are of the paraboloid
    z = x^2 + y^2, which SciPy scales. As with SciPy, ``simplices`` and ``neighbors`` may be written
    to or replaced; `find_simplex` keeps to the triangulation as it was computed.

    Parameters
    ----------
    points : array_like of shape (n, 2)
        Planar points.
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
    _kind = "triangulation"

    def __init__(
        self,
        points: ArrayLike,
        furthest_site: bool = False,
        incremental: bool = False,
        qhull_options: str | None = None,
        *,
        copy: bool = False,
    ) -> None:
        rows = planar_rows(points)  # first: of columns x and y, the second is no option
        self.furthest_site = as_switch("furthest_site", furthest_site)
        check_qhull_options(qhull_options)
        is_growing = as_switch("incremental", incremental)
        self._compute(rows, copy=as_switch("copy", copy) or is_growing)
        self._can_grow = is_growing

    def _compute(self, rows: Floats, *, copy: bool) -> None:
        solution = solved(rows, furthest_site=self.furthest_site, copy=copy)
        for name in _COMPUTED_LATER:
            self.__dict__.pop(name, None)
        self._exact = solution["simplices"], solution["neighbors"]
        own = {name: solution[name].copy() for name in ("simplices", "neighbors")}
        self.hidden = read_only(solution.pop("hidden", np.empty(0, dtype=np.int32)))
        super().__init__(**(solution | own))
        self.npoints = len(solution["points"])
        self.nsimplex = len(self.simplices)

    def _given(self) -> tuple[Rows, ...]:
        return *self._exact, self._hull, self.duplicates, self.skipped

    def _protect(self) -> None:
        for array in (self._rows, *self._given()):
            array.setflags(write=False)

    def _kept(self, array: Array) -> Array:
        return array  # SciPy's users write to it

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

    def lifted(self, q: ParaboloidVertex = "origin") -> LowerHull:
        """Return the lower hull of the lifted points; its projection is this triangulation.

        Parameters
        ----------
        q : {"origin", "median"} or (2,) array_like, default "origin"
            The vertex of the paraboloid.

        Returns
        -------
        LowerHull
            A mesh in space, as for `Triangulation`.

        Raises
        ------
        InputError
            q is not one of these, or the triangles are the upper hull.

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
        return super().lifted(q)

    @cached_property
    def good(self) -> Rows:
        """Ones, (m,) int32: SciPy's mark of triangles that `qhull_options` did not exclude."""
        return super().good

    @cached_property
    def edges(self) -> Rows:
        """The edges, (e, 2) int32: each once, with its lesser row first, in order of the triangles.

        For arrays of the two ends, as for plotting: ``points[edges]`` has the shape (e, 2, 2).
        """
        return _edges_in(self.simplices) if self._is_rewritten() else super().edges

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


def _edges_in(simplices: Rows) -> Rows:
    """Return the edges of any triangles, in the order in which these have them first."""
    ends = np.sort(simplices[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2), axis=1)
    _, first = np.unique(ends.astype(np.int64) @ (1 << 32, 1), return_index=True)
    return read_only(ends[np.sort(first)])


def _neighbors_in(simplices: Rows, npoints: int) -> tuple[Rows, Rows]:
    """Return the neighbours of each row in any triangles, as SciPy does."""
    start = simplices[:, [0, 1, 2, 0, 1, 2]].reshape(-1).astype(np.int64)
    end = simplices[:, [1, 2, 0, 2, 0, 1]].reshape(-1)
    pairs = np.unique(start << 32 | end)
    indptr = np.zeros(npoints + 1, dtype=np.int32)
    np.cumsum(np.bincount(pairs >> 32, minlength=npoints), out=indptr[1:])
    return indptr, (pairs & 0xFFFFFFFF).astype(np.int32)
