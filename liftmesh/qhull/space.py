"""`SpaceDelaunay`: SciPy's class for points of three and more columns.

In space the tetrahedra are those of `tetrahedralize`. In more dimensions Qhull makes the simplices,
and they are checked in exact integers: it is never silently trusted. SciPy's own properties work on
the arrays that its class has, which the caller may rewrite.
"""

from __future__ import annotations

import inspect
import traceback
import warnings
from itertools import takewhile
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats, Rows
from liftmesh.base.arrays import as_any_columns, check_finite, read_only
from liftmesh.base.frozen import check_copied
from liftmesh.base.options import counted
from liftmesh.errors import DataWarning, DegenerateInputError, InputError
from liftmesh.optional import load
from liftmesh.qhull.certification import faults_of, rank_of
from liftmesh.qhull.common import Growing, scipys_errors
from liftmesh.space.tetrahedra import tetrahedralize

if TYPE_CHECKING:
    from scipy import spatial
else:
    spatial = load("scipy.spatial", extra="scipy")


class SpaceDelaunay(Growing, spatial.Delaunay):  # type: ignore[misc]
    """What ``liftmesh.scipy.Delaunay`` makes of points of three and more columns.

    It is an instance of ``liftmesh.scipy.Delaunay`` and of ``scipy.spatial.Delaunay``, which says
    what further attributes are. In space, the tetrahedra are those of `tetrahedralize`: exact,
    canonical, positively oriented, none of them flat, and `find_simplex` is exact.

    In more dimensions Qhull makes the simplices, and their order, and `find_simplex`, are SciPy's.
    They are checked in exact integers; if they are no Delaunay triangulation of all points, as
    often of lattices, `certified` is False, ``faults`` has the reasons, and a `DataWarning` counts
    them. The check takes some 50 microseconds for each simplex in four dimensions, and twice that
    or more in each further one: 1.4 s for 1,000 uniform points in four. Where more than 10^8
    products of integers were needed, as for some 15,000 points in four dimensions or 1,500 in five,
    it is not made, and `certified` is False, too.

    Parameters
    ----------
    points : array_like of shape (n, d)
        Points of three or more columns.
    furthest_site : bool, default False
        Only False: the farthest-point triangulation is planar.
    incremental : bool, default False
        Whether points can be added, by `add_points`, until `close` is called; all are triangulated
        anew.
    qhull_options : str, optional
        As for `liftmesh.scipy.Delaunay`.
    copy : bool, default False
        Whether to copy the points first; `incremental` always does.

    Attributes
    ----------
    simplices, neighbors : (m, d + 1) ndarray of int32
        The simplices, and the one across the facet opposite each corner; -1 outside.
    duplicates : (k, 2) ndarray of int32
        Rows at the position of an earlier one, each with the first there. ``coplanar`` has a
        simplex, too; in more dimensions than three it has all rows that Qhull left out.
    equations : (m, d + 2) ndarray of float64
        The planes of simplices lifted by `lift_points`: outward unit normals and offsets.
    certified : bool
        Whether the simplices are proved to be a Delaunay triangulation of all points.
    faults : tuple of str
        Why they are not, with counts.
    convex_hull : (h, d) ndarray of int32
        The facets of the convex hull; in space counter-clockwise seen from outside.

    Raises
    ------
    InputError
        An option is not for points in space, or `points` are no such points.
    NonFiniteError
        A row is not finite.
    DegenerateInputError
        The points do not span the space. The error is a ``scipy.spatial.QhullError`` too.

    See Also
    --------
    tetrahedralize : Without SciPy, with all options.
    liftmesh.scipy.Delaunay : The same in the plane.

    Examples
    --------
    >>> import liftmesh
    >>> cube = np.indices((2, 2, 2)).reshape(3, -1).T
    >>> tri = liftmesh.scipy.Delaunay(cube)
    >>> tri.nsimplex, tri.find_simplex([[0.5, 0.5, 0.5], [2, 0, 0]]) >= 0
    (6, array([ True, False]))
    >>> from scipy.interpolate import LinearNDInterpolator
    >>> float(LinearNDInterpolator(tri, cube @ [1, 10, 100])(0.5, 0.25, 0.125))
    15.5
    >>> liftmesh.scipy.Delaunay(np.vstack([np.eye(4), np.zeros(4)])).certified
    True
    """

    _kind = "triangulation"

    def _as_rows(self, points: ArrayLike) -> Floats:
        rows = as_any_columns(points)
        there = self.__dict__.get("ndim")
        if rows.shape[1] != (there or max(rows.shape[1], 3)):
            needed = f"{there}, as those that are there" if there else "three or more"
            raise InputError(f"points have {rows.shape[1]} columns: give points of {needed}")
        return rows

    def _compute(self, rows: Floats, *, copy: bool) -> None:
        if self.furthest_site:
            raise InputError(
                "furthest_site=True is for planar points: use scipy.spatial.Delaunay, whose "
                f"result in {rows.shape[1]} dimensions nothing proves"
            )
        rows = read_only(rows.copy() if copy else rows)
        with scipys_errors(rows):
            made = _in_three(rows) if rows.shape[1] == 3 else _by_qhull(rows)
        corners = rows[np.unique(made["simplices"])]
        made |= {"npoints": len(rows), "ndim": rows.shape[1], "nsimplex": len(made["simplices"])}
        made |= {"min_bound": corners.min(axis=0), "max_bound": corners.max(axis=0)}
        made |= dict.fromkeys(("_transform", "_vertex_to_simplex", "_vertex_neighbor_vertices"))
        self.__dict__.update(made, _points=rows, _qhull=None)
        if self.faults:
            # By the class itself, by that for any columns, or by adding points: the caller is told.
            frames = traceback.walk_stack(inspect.currentframe())
            names = (frame.f_globals.get("__name__", "") for frame, _ in frames)
            own = takewhile(lambda name: name.startswith("liftmesh."), names)
            warnings.warn(DataWarning(self._warning()), stacklevel=1 + len([*own]))

    def _warning(self) -> str:
        return (
            f"not certified: of the {counted(self.nsimplex, 'cell')} that Qhull made of "
            f"{self.npoints:,} points in {self.ndim} dimensions, {'; '.join(self.faults)}"
        )

    @property
    def certified(self) -> bool:
        """Whether the simplices are proved to be a Delaunay triangulation of all points."""
        return not self.faults

    @property
    def convex_hull(self) -> Rows:
        """The facets of the convex hull, (h, d) int32."""
        exact = self.__dict__.get("_exact")
        facets: Rows = super().convex_hull if exact is None else exact.convex_hull.copy()
        return facets

    def find_simplex(
        self, xi: ArrayLike, bruteforce: bool = False, tol: float | None = None
    ) -> Rows:
        """Find the simplices that contain the given points: exactly in space.

        Parameters
        ----------
        xi : array_like of shape (..., d)
            Points.
        bruteforce, tol
            As in SciPy; without effect in space, as the result is exact.

        Returns
        -------
        (...) ndarray of int32
            As by `Tetrahedralization.find_simplex`; in more dimensions as by SciPy, which allows
            for rounding.

        Raises
        ------
        InputError
            The last axis is not of length three, in space.

        See Also
        --------
        Tetrahedralization.find_simplex : The same without SciPy.

        Examples
        --------
        >>> import liftmesh
        >>> tri = liftmesh.scipy.Delaunay([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
        >>> tri.find_simplex([[0, 0, 0.5], [0, 0, -5e-324]])
        array([ 0, -1], dtype=int32)
        """
        exact = self.__dict__.get("_exact")
        scipys = super().find_simplex
        found: Rows = scipys(xi, bruteforce, tol) if exact is None else exact.find_simplex(xi)
        return found

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__dict__.update(state, _points=read_only(state["_points"]))
        arrays = self.simplices, self.neighbors, self.duplicates
        check_copied(self.npoints, *arrays, corners=self._points.shape[1] + 1)


def _in_three(rows: Floats) -> dict[str, Any]:
    exact = tetrahedralize(rows)
    simplices, row = exact.simplices.copy(), exact.duplicates[:, 0]
    first = np.zeros(len(rows), np.int32)
    first[simplices[::-1]] = np.arange(len(simplices), dtype=np.int32)[::-1, None]
    at = first[exact.duplicates[:, 1]]
    return {
        "simplices": simplices,
        "neighbors": exact.neighbors.copy(),
        "equations": _planes(rows.take(simplices, axis=0)),
        "coplanar": np.stack([row, at, exact.duplicates[:, 1]], axis=1),
        "good": np.ones(len(simplices), np.int32),
        "duplicates": exact.duplicates,
        "paraboloid_scale": 1.0,
        "paraboloid_shift": 0.0,
        "faults": (),
        "_exact": exact,
    }


def _planes(corners: Floats) -> Floats:
    """Return the planes of lifted tetrahedra: downward unit normals and offsets."""
    origin = corners[:, :1]
    with np.errstate(all="ignore"):
        edges = corners[:, 1:] - origin
        rises = (edges * (corners[:, 1:] + origin)).sum(axis=2)
        across = np.cross(np.roll(edges, -1, axis=1), np.roll(edges, -2, axis=1))
        slope = (rises[:, :, None] * across).sum(axis=1)
        slope /= (edges[:, 0] * across[:, 0]).sum(axis=1)[:, None]
        at = corners[:, 0]
        height = (at * at).sum(axis=1) - (slope * at).sum(axis=1)
        planes = np.column_stack([slope, np.full(len(at), -1.0), height])
        unit: Floats = planes / np.sqrt((slope * slope).sum(axis=1) + 1)[:, None]
    return unit


_OF_QHULL = ("simplices", "neighbors", "equations", "coplanar", "good")
_OF_LIFT = ("paraboloid_scale", "paraboloid_shift")


def _by_qhull(rows: Floats) -> dict[str, Any]:
    """Have Qhull make simplices, and check them."""
    check_finite(rows, skippable=False)
    count, dimension = rows.shape
    if count <= dimension:
        raise DegenerateInputError(
            f"{counted(count, 'row')} of {dimension} columns: a simplex needs {dimension + 1}"
        )
    try:
        found = spatial.Delaunay(rows)
    except spatial.QhullError:
        if (rank := rank_of(rows)) == dimension:
            raise
        raise DegenerateInputError(
            f"all points lie in a flat of {counted(rank, 'dimension')}: simplices of "
            f"{dimension} need points that span it"
        ) from None
    _, first, same = np.unique(rows + 0.0, axis=0, return_index=True, return_inverse=True)
    kept = first[same.reshape(-1)].astype(np.int32)
    later = np.flatnonzero(kept < np.arange(count)).astype(np.int32)
    return {
        **{name: getattr(found, name) for name in (*_OF_QHULL, *_OF_LIFT)},
        "duplicates": np.stack([later, kept[later]], axis=1),
        "faults": tuple(faults_of(rows, found.simplices)),
    }
