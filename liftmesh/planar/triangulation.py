"""`Triangulation`: triangles of the caller's rows, with SciPy's attribute names."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Apex, Array, Floats, Progress, Reals, Rows
from liftmesh.base.arrays import as_pairs, read_only
from liftmesh.base.display import Plotted
from liftmesh.base.frozen import cached_property, check_copied
from liftmesh.base.options import Coincident, GraphKind, GraphWeights, NonFinite, as_threads
from liftmesh.errors import InputError
from liftmesh.planar.alpha import AlphaMethods
from liftmesh.planar.kinds import options_of
from liftmesh.planar.lifting import Counters, Heights, LowerHull, resolve_apex
from liftmesh.predicates import orient2d

if TYPE_CHECKING:
    from collections.abc import Callable

    import scipy.sparse
    import scipy.spatial

    from liftmesh.planar.certificate import Certificate


class Triangulation(AlphaMethods, Plotted):
    """A Delaunay triangulation of planar points, as returned by `delaunay`.

    Every index is a row of the caller's array. Attributes that cost memory are computed on first
    access. The arrays are read-only: copy one to change it. `points` may share the memory of the
    caller's array; writing to that array changes them under the triangulation, which `copy=True`
    of `delaunay` prevents.

    Parameters
    ----------
    points : (n, 2) ndarray of float64 or float32
        The planar points.
    simplices, neighbors : (m, 3) ndarray of int32
        See the attributes.
    convex_hull : (h,) ndarray of int32
        See the attribute.
    duplicates : (k, 2) ndarray of int32
        See the attribute.
    skipped : (j,) ndarray of int32
        See the attribute.
    counters : Counters, optional
        See the attribute.
    metric : (2, 2) ndarray of float64, optional
        See the attribute.

    Attributes
    ----------
    simplices : (m, 3) ndarray of int32
        The triangles, counter-clockwise.
    neighbors : (m, 3) ndarray of int32
        The triangle across the edge opposite vertex k; -1 outside.
    duplicates : (k, 2) ndarray of int32
        Rows that are not a vertex because another row has the same position, in ascending order,
        each with the row that is kept: the first, or the one that `triangulate` chose.
    skipped : (j,) ndarray of int32
        Rows skipped because they are not finite.
    counters : Counters or None
        Work counters of the paper's procedures; None for divide and conquer.
    metric : (2, 2) ndarray of float64 or None
        The metric that `delaunay` was given; then the lift is its quadratic form.
    paraboloid_scale, paraboloid_shift : float
        1 and 0: without a metric the lift is z = x^2 + y^2.
    ndim : int
        2.
    furthest_site : bool
        False.

    See Also
    --------
    delaunay : Computes it.
    RegularTriangulation : Of weighted points.
    liftmesh.scipy.Delaunay : The same as SciPy's class.

    Examples
    --------
    >>> import liftmesh
    >>> tri = liftmesh.delaunay([[0, 0], [2, 0], [0, 2], [2, 3], [0, 0]])
    >>> tri.nsimplex, tri.duplicates.tolist()
    (2, [[4, 0]])
    >>> tri.find_simplex([[0.1, 0.1], [5, 5]]).tolist()
    [1, -1]
    """

    ndim = 2
    furthest_site = False
    paraboloid_scale = 1.0
    paraboloid_shift = 0.0

    def __init__(
        self,
        points: Reals,
        simplices: Rows,
        neighbors: Rows,
        convex_hull: Rows,
        duplicates: Rows,
        skipped: Rows,
        counters: Counters | None = None,
        metric: Floats | None = None,
    ) -> None:
        self._rows = read_only(points)  # the array itself may be the caller's
        self._hull = convex_hull
        self.simplices = simplices
        self.neighbors = neighbors
        self.duplicates = duplicates
        self.skipped = skipped
        self.counters = counters
        self.metric = None if metric is None else read_only(metric)
        for array in self._given():
            if array.flags.writeable:  # the kernel's are not, and asking takes a third of the time
                array.setflags(write=False)

    def _given(self) -> tuple[Rows, ...]:
        """Return the arrays that must stay as they are: point location relies on them."""
        return self.simplices, self.neighbors, self._hull, self.duplicates, self.skipped

    def _protect(self) -> None:
        """Make all arrays read-only, as those of copies are not."""
        for value in self.__dict__.values():
            if isinstance(value, np.ndarray):
                value.setflags(write=False)

    def _kept(self, array: Array) -> Array:
        """Make a computed array read-only, too: it is computed once."""
        return read_only(array)

    def __repr__(self) -> str:
        return (
            f"<{type(self).__name__}: {self.nsimplex} triangles over {self.npoints} rows, "
            f"{len(self.duplicates)} duplicates, {len(self.skipped)} skipped>"
        )

    def __getstate__(self) -> dict[str, Any]:
        shared = ("_locator", "points", "convex_hull")  # made again when asked for
        return {name: value for name, value in self.__dict__.items() if name not in shared}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state)
        check_copied(len(self._rows), *self._given())
        self._protect()  # copied and unpickled arrays are writable

    @property
    def npoints(self) -> int:
        """The number of rows."""
        return len(self._rows)

    @property
    def nsimplex(self) -> int:
        """The number of triangles."""
        return len(self.simplices)

    @cached_property
    def points(self) -> Floats:
        """The planar points, (n, 2) float64, read-only.

        If the caller's array is float64, it shares its memory, unless the triangulation was made
        with ``copy=True``. Being read-only does not protect from writes through the caller's own
        array: afterwards `verify` fails, and `find_simplex` gives meaningless triangles.
        """
        return read_only(self._rows.astype(np.float64, copy=False))

    @cached_property
    def convex_hull(self) -> Rows:
        """The rows on the convex hull, (h,) int32, counter-clockwise.

        From the lexicographically least point. Rows between two corners are among them.
        """
        return read_only(np.ascontiguousarray(self._hull))

    @cached_property
    def edges(self) -> Rows:
        """The edges, (e, 2) int32: each once, with its lesser row first, in order of the triangles.

        For arrays of the two ends, as for plotting: ``points[edges]`` has the shape (e, 2, 2).
        """
        ends = np.stack([np.roll(self.simplices, -1, axis=1), np.roll(self.simplices, 1, axis=1)])
        # Of the two triangles at an edge the later one counts it; outside, the number is -1.
        counted = self.neighbors < np.arange(self.nsimplex, dtype=np.int32)[:, None]
        return read_only(np.sort(ends[:, counted].T, axis=1))

    @property
    def coplanar(self) -> Rows:
        """The duplicates in SciPy's form, (k, 3) int32: row, a triangle at the row, row kept.

        In the order of the triangles, then of the rows.
        """
        row, kept = self.duplicates.T
        triangle = self.vertex_to_simplex[row]
        return np.stack([row, triangle, kept], axis=1)[np.argsort(triangle, kind="stable")]

    @property
    def good(self) -> Rows:
        """Ones, (m,) int32, for compatibility with SciPy."""
        return np.ones(self.nsimplex, dtype=np.int32)

    @cached_property
    def min_bound(self) -> Floats:
        """The lower left corner of the bounding box, (2,) float64."""
        return self._kept(self.points[self._hull].min(axis=0))

    @cached_property
    def max_bound(self) -> Floats:
        """The upper right corner of the bounding box, (2,) float64."""
        return self._kept(self.points[self._hull].max(axis=0))

    @cached_property
    def vertex_to_simplex(self) -> Rows:
        """The first triangle at the position of each row, (n,) int32; -1 for skipped rows."""
        first = np.full(self.npoints, -1, dtype=np.int32)
        names = np.repeat(np.arange(len(self.simplices), dtype=np.int32), 3)
        # The last of repeated assignments wins: in reverse order, that is the first triangle.
        first[self.simplices.reshape(-1)[::-1]] = names[::-1]
        row, kept = self.duplicates.T
        first[row] = first[kept]
        return self._kept(first)

    @cached_property
    def vertex_neighbor_vertices(self) -> tuple[Rows, Rows]:
        """The neighbours of each row: indptr, (n + 1,) int32, and indices, int32.

        Those of row i are ``indices[indptr[i]:indptr[i + 1]]``.
        """
        a, b, c = self.simplices.T
        outer = (self.neighbors < 0).T
        # Each triangle yields its three edges in one direction; edges of the rim lack the other.
        start = np.concatenate([a, b, c, c[outer[0]], a[outer[1]], b[outer[2]]])
        end = np.concatenate([b, c, a, b[outer[0]], c[outer[1]], a[outer[2]]])
        indptr = np.zeros(self.npoints + 1, dtype=np.int32)
        np.cumsum(np.bincount(start, minlength=self.npoints), out=indptr[1:])
        return self._kept(indptr), self._kept(end[np.argsort(start, kind="stable")])

    @cached_property
    def transform(self) -> Floats:
        """The barycentric transforms, (m, 3, 2) float64; NaN for slivers, as in SciPy.

        With ``T = transform[i, :2]`` and ``r = transform[i, 2]``, ``T @ (x - r)`` gives the first
        two barycentric coordinates of x in triangle i. A triangle is NaN if it is so thin that
        less than three digits of its transform would be right.
        """
        return self._kept(barycentric_transforms(self.points, self.simplices))

    @cached_property
    def equations(self) -> Floats:
        """The planes of triangles lifted by `lift_points`, (m, 4): downward unit normal, offset."""
        return self._kept(self._heights.planes(self.points, self.simplices))

    @property
    def _heights(self) -> Heights:
        return Heights(metric=self.metric)

    def lift_points(self, x: ArrayLike) -> Floats:
        """Lift planar points to the paraboloid of `equations`, or to the form of the metric.

        Parameters
        ----------
        x : array_like of shape (..., 2)
            Planar points.

        Returns
        -------
        (..., 3) ndarray of float64
            The points with z = x^2 + y^2; with a metric, with the value of its quadratic form.

        Raises
        ------
        InputError
            The last axis is not of length two.

        See Also
        --------
        lift : Any apex.
        Triangulation.plane_distance : How far points are from the lifted triangles.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.delaunay([[0, 0], [1, 0], [0, 1]]).lift_points([3, 4])
        array([ 3.,  4., 25.])
        """
        pairs = as_pairs(x)
        return self._heights.lifted(pairs.reshape(-1, 2)).reshape(*pairs.shape[:-1], 3)

    def plane_distance(self, xi: ArrayLike) -> Floats:
        """Compute the distances of lifted points from the plane of each triangle.

        Parameters
        ----------
        xi : array_like of shape (..., 2)
            Planar points.

        Returns
        -------
        (..., m) ndarray of float64
            Signed distances, positive below the plane. Rounded: use `incircle` for exact signs.

        Raises
        ------
        InputError
            The last axis is not of length two.

        See Also
        --------
        Triangulation.lift_points : The lift of points.
        incircle : Exact signs.

        Examples
        --------
        >>> import liftmesh
        >>> tri = liftmesh.delaunay([[0, 0], [1, 0], [0, 1]])
        >>> tri.plane_distance([0.5, 0.5]) > 0
        array([ True])
        """
        normals, offsets = self.equations[:, :3], self.equations[:, 3]
        with np.errstate(all="ignore"):
            distances: Floats = self.lift_points(xi) @ normals.T + offsets
        return distances

    def find_simplex(
        self,
        xi: ArrayLike,
        bruteforce: bool = False,  # noqa: ARG002 - part of SciPy's signature
        tol: float | None = None,  # noqa: ARG002 - part of SciPy's signature
    ) -> Rows:
        """Find the triangles that contain the given points, exactly.

        Parameters
        ----------
        xi : array_like of shape (..., 2)
            Planar points.
        bruteforce, tol
            Accepted for compatibility with SciPy; ignored, as the result is exact.

        Returns
        -------
        (...) ndarray of int32
            The triangle that contains each point; on an edge or a vertex, the first such triangle
            of ``simplices``; -1 outside the convex hull, where regions were removed, and for points
            that are not finite. Neither order nor threads change anything.

        Raises
        ------
        InputError
            The last axis is not of length two, or LIFTMESH_NUM_THREADS is no number of threads.

        See Also
        --------
        Surface.sample, natural_neighbors : Heights at points; rows around points, with weights.

        Notes
        -----
        By visibility walks in spatial order, with exact orientations, on as many threads as
        `delaunay` uses by default: O(log m) steps in expectation on every triangulation of m rows,
        with an index of at most 8 bytes for each row, or 400 KB if that is more.

        Examples
        --------
        >>> import liftmesh
        >>> tri = liftmesh.delaunay([[0, 0], [1, 0], [0, 1]])
        >>> tri.find_simplex([[0.5, 0.5], [0.5, np.nextafter(0.5, 1)], [np.nan, 0]])
        array([ 0, -1, -1], dtype=int32)
        """
        pairs = as_pairs(xi)
        triangles = np.empty(pairs.shape[:-1], dtype=np.int32)
        threads = as_threads(None, triangles.size)
        self._locator.find(pairs.reshape(-1, 2), triangles.reshape(-1), *threads)
        return self._left(triangles)

    def _left(self, found: Rows) -> Rows:
        """Return what was found, without triangles that were removed."""
        return found

    @cached_property
    def _locator(self) -> _kernel.Locator:
        return _kernel.Locator(
            self._rows,
            np.ascontiguousarray(self.simplices),
            np.ascontiguousarray(self.neighbors),
        )

    def lifted(self, apex: Apex = "median") -> LowerHull:
        """Return the lower hull of the lifted points; its projection is this triangulation.

        Parameters
        ----------
        apex : {"median", "origin"} or (2,) array_like, default "median"
            The apex of the paraboloid, as for `lift`.

        Returns
        -------
        LowerHull
            A mesh in space: all rows lifted, the triangles as its lower facets.

        Raises
        ------
        InputError
            The apex is not one of these, or there are constraints.

        See Also
        --------
        lift, lower_hull : The lift of any points, and the lower hull of any in space.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.delaunay([[0, 0], [1, 0], [0, 1]]).lifted("origin").apex
        (0.0, 0.0)
        """
        place = resolve_apex(apex, self.points)
        lifted = self._heights.lifted_rows(self.points, place)
        return LowerHull(lifted, self.simplices, place, self.neighbors)

    def verify(
        self, *, threads: int | None = None, progress: Progress | None = None
    ) -> Certificate:
        """Verify the triangles from scratch: the Certificate is true if they are what they say.

        In full: `liftmesh.verify`.

        Parameters
        ----------
        threads, progress : as for `delaunay`
        """
        from liftmesh.planar.verification import verify  # noqa: PLC0415 - hashes are rarely needed

        nonfinite: NonFinite = "skip" if len(self.skipped) else "error"
        return verify(
            self._rows,
            self.simplices,
            nonfinite=nonfinite,
            threads=threads,
            progress=progress,
            **options_of(self),
        )

    def graph(
        self,
        kind: GraphKind = "delaunay",
        weights: GraphWeights | Callable[[Floats], ArrayLike] = "length",
        *,
        coincident: Coincident = "first",
    ) -> scipy.sparse.csr_array:
        """Make a graph of rows that are near each other, as a sparse matrix.

        In full: `liftmesh.planar.graph.graph`.

        Parameters
        ----------
        kind, weights, coincident : str, or of weights a callable
        """
        from liftmesh.planar.graph import graph  # noqa: PLC0415 - sparse matrices are not small

        return graph(self, kind, weights, coincident=coincident)

    def to_scipy(self) -> scipy.spatial.Delaunay:
        """Convert to ``scipy.spatial.Delaunay``, for code that requires this class.

        Returns
        -------
        scipy.spatial.Delaunay
            Made without running Qhull. ``NearestNDInterpolator`` takes its points alone, those of
            duplicates too, and gives the value of any row at the nearest position.

        Raises
        ------
        InputError
            Regions were removed, of a `ConstrainedTriangulation`: SciPy's point location would end
            at them.

        See Also
        --------
        liftmesh.scipy.Delaunay : A class that SciPy takes without conversion.

        Examples
        --------
        >>> import liftmesh
        >>> from scipy.interpolate import LinearNDInterpolator
        >>> tri = liftmesh.delaunay([[0, 0], [1, 0], [0, 1]])
        >>> float(LinearNDInterpolator(tri.to_scipy(), [0.0, 1.0, 2.0])(0.25, 0.25))
        0.75
        """
        from liftmesh.io.objects.triangulations import to_delaunay  # noqa: PLC0415

        return to_delaunay(self)


_WORST = 2.0**-42  # 1024 eps: what SciPy allows, and a margin for rounding


def check_unwritten(tri: Triangulation) -> None:
    """Raise if rows were written after they were triangulated, so that triangles are turned."""
    hull = tri._hull  # noqa: SLF001 - of this module
    turns = np.stack([hull, np.roll(hull, -1), np.roll(hull, -2)], axis=1)
    is_finite = np.asarray(np.isfinite(tri.points).all(axis=1))
    for rows, least in ((tri.simplices, 1), (turns, 0)):
        is_wrong = np.asarray(~is_finite.take(rows.T).all(axis=0))
        is_wrong[~is_wrong] = orient2d(*tri.points.take(rows[~is_wrong].T, axis=0)) < least
        if is_wrong.any():
            named = rows[np.argmax(is_wrong)].tolist()
            raise InputError(
                f"rows {named} are at {tri.points[named].tolist()} now, and were elsewhere when "
                "they were triangulated: triangulate them again, or a copy that is not written"
            )


def barycentric_transforms(points: Floats, simplices: Rows) -> Floats:
    """Compute the barycentric transforms of triangles, (m, 3, 2), as SciPy does."""
    # The transform of a triangle with the corners a, b and c inverts the matrix with the columns
    # a - c and b - c. An inverse has three digits or more if the reciprocal condition number of its
    # matrix is at least 1000 eps. SciPy gives NaN below that, and so does this function: the
    # interpolators treat such slivers apart. SciPy estimates the norm of the inverse, from below;
    # here it is computed, so what is NaN for SciPy is NaN here.
    #
    # Each matrix is first scaled by a power of two, which is exact: products of very large or very
    # small differences would overflow or vanish otherwise.
    origin = points.take(simplices[:, 2], axis=0)
    result = np.empty((len(simplices), 3, 2))
    result[:, 2] = origin
    with np.errstate(all="ignore"):
        sides = points.take(simplices[:, :2].T, axis=0) - origin
        exponents = np.frexp(np.abs(sides).max(axis=(0, 2)))[1]
        (ax, ay), (bx, by) = np.moveaxis(np.ldexp(sides, -exponents[:, None]), 2, 1)
        area = ax * by - ay * bx
        result[:, 0] = np.ldexp(np.stack([by, -bx]) / area, -exponents).T
        result[:, 1] = np.ldexp(np.stack([-ay, ax]) / area, -exponents).T
        accurate = np.abs(area) >= _WORST * _norms(ax, ay, bx, by)
        accurate &= np.isfinite(result).all(axis=(1, 2))
    result[~accurate] = np.nan
    return result


def _norms(ax: Array, ay: Array, bx: Array, by: Array) -> Array:
    """Return the product of the matrix's norm and that of its inverse times the determinant."""
    ax, ay, bx, by = np.abs(ax), np.abs(ay), np.abs(bx), np.abs(by)
    norms: Array = np.maximum(ax + bx, ay + by) * np.maximum(ax + ay, bx + by)
    return norms
