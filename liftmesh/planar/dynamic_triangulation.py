"""`DynamicTriangulation`: points are inserted and removed, and the triangles are always canonical.

The rule for ties compares coordinates, never ranks. So the triangles are those that `delaunay`
makes of the points present, whatever was there before, and in whichever order it came.
"""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Floats, Rows
from liftmesh.base.arrays import MOST_ROWS, as_coordinates, as_pairs, check_finite
from liftmesh.base.options import refused
from liftmesh.errors import InputError
from liftmesh.planar.delaunay import delaunay

if TYPE_CHECKING:
    from liftmesh.planar.triangulation import Triangulation


class DynamicTriangulation:
    """A Delaunay triangulation that takes points in and out.

    At every moment it is the one that `delaunay` makes of the points present, ties included.

    Every position has a number, which `insert` returns: that of the row, for distinct points to
    begin with. It stays until the point is removed; later points get the numbers of removed ones.
    Fewer than three points, or points on one line, have no triangles. Calls from several threads at
    once are refused.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3), optional
        Points to begin with, as for `insert`.

    Attributes
    ----------
    points : (n, 2) ndarray of float64
        The position of each number; NaN for one that is not in use.
    vertices : (k,) ndarray of int32
        The numbers in use, increasing.
    simplices : (m, 3) ndarray of int32
        The triangles, counter-clockwise, as numbers of points.
    neighbors : (m, 3) ndarray of int32
        The triangle across the edge opposite vertex k; -1 outside.
    convex_hull : (h,) ndarray of int32
        The numbers of the points on the convex hull, counter-clockwise; empty without triangles.

    See Also
    --------
    delaunay : All points at once.

    Notes
    -----
    A point takes away the triangles whose circle contains it (A. Bowyer, D. F. Watson, 1981), and
    is found by a walk from a point nearby. What a removal leaves is filled with the triangles of
    the neighbours. Both take constant expected time once the place is known; a removal takes
    O(d log d) for d neighbours. Where an eighth of the points changes at once, all is made anew.

    Examples
    --------
    >>> tri = DynamicTriangulation([[0, 0], [2, 0], [0, 2], [2, 3]])
    >>> found = tri.insert([[1, 1], [0, 0]])
    >>> found.tolist(), len(tri), len(tri.simplices)
    ([4, 0], 5, 4)
    >>> tri.remove(found[:1])
    >>> len(tri), len(tri.simplices)
    (4, 2)
    """

    def __init__(self, points: ArrayLike | None = None) -> None:
        self._mesh = _kernel.DynamicMesh()
        self._lock = threading.Lock()
        self._points: Floats | None = None
        self._triangles: tuple[Rows, Rows, Rows] | None = None
        if points is not None:
            self.insert(points)

    def __len__(self) -> int:
        with _Use(self._lock):
            return self._mesh.count()

    def __repr__(self) -> str:
        return f"<DynamicTriangulation of {len(self):,} points>"

    def __reduce__(self) -> tuple[type, tuple[Floats]]:
        """Copies and pickles have the same points, numbered from 0."""
        return type(self), (self.points[self.vertices],)

    @property
    def points(self) -> Floats:
        """The position of each number; NaN for one that is not in use."""
        if self._points is None:
            with _Use(self._lock):
                self._points = self._mesh.points()
        return self._points

    @property
    def vertices(self) -> Rows:
        """The numbers in use, increasing."""
        return np.flatnonzero(~np.isnan(self.points[:, 0])).astype(np.int32)

    @property
    def simplices(self) -> Rows:
        """The triangles, counter-clockwise, as numbers of points."""
        return self._read_triangles()[0]

    @property
    def neighbors(self) -> Rows:
        """The triangle across the edge opposite vertex k; -1 outside."""
        return self._read_triangles()[1]

    @property
    def convex_hull(self) -> Rows:
        """The numbers of the points on the convex hull, counter-clockwise."""
        return self._read_triangles()[2]

    def insert(self, points: ArrayLike) -> Rows:
        """Insert points.

        Parameters
        ----------
        points : array_like of shape (n, 2) or (n, 3)
            Planar points; a third column is ignored. Many at once take less time than each alone.

        Returns
        -------
        (n,) ndarray of int32
            The number of each. Where a point is present already, it is that of the position.

        Raises
        ------
        InputError
            The shape or the type is wrong, or the points would be more than 357,913,941.
        NonFiniteError
            A row is not finite: then none is inserted.

        See Also
        --------
        DynamicTriangulation.remove : The opposite.

        Examples
        --------
        >>> DynamicTriangulation().insert([[0, 0], [1, 0], [0, 0]]).tolist()
        [0, 1, 0]
        """
        rows = as_coordinates(points)[:, :2]
        check_finite(rows)
        numbers = np.empty(len(rows), np.int32)
        with _Use(self._lock):
            if self._mesh.end() + len(rows) > MOST_ROWS:
                message = f"{len(rows):,} more rows are too many: {MOST_ROWS:,} is the limit"
                raise InputError(message)
            self._forget()
            self._mesh.insert(rows, numbers)
        return numbers

    def remove(self, vertices: ArrayLike) -> None:
        """Remove points.

        Parameters
        ----------
        vertices : array_like of int
            Their numbers, one or several.

        Raises
        ------
        InputError
            A number is not in use, or occurs twice: then none is removed.

        See Also
        --------
        DynamicTriangulation.insert : The opposite.

        Examples
        --------
        >>> tri = DynamicTriangulation([[0, 0], [1, 0], [0, 1]])
        >>> tri.remove(1)
        >>> tri.vertices.tolist()
        [0, 2]
        """
        numbers = np.atleast_1d(np.asarray(vertices))
        if numbers.size == 0:
            return
        if numbers.dtype.kind not in "iu" or numbers.ndim > 1:
            raise refused("vertices", vertices, "give the numbers of points", verb="are")
        if len(np.unique(numbers)) < len(numbers):
            raise InputError("a number occurs twice: a point can be removed once")
        rows = np.where((numbers < 0) | (numbers > MOST_ROWS), -1, numbers).astype(np.int32)
        with _Use(self._lock):
            absent = self._mesh.first_absent(rows)
            if absent >= 0:
                raise InputError(f"no point has the number {int(numbers[absent])}")
            self._forget()
            self._mesh.remove(rows)

    def find(self, points: ArrayLike) -> Rows:
        """Find the points at positions.

        Parameters
        ----------
        points : array_like of shape (..., 2)
            Positions.

        Returns
        -------
        (...) ndarray of int32
            The number of the point at each position; -1 where none is, and for NaN.

        Raises
        ------
        InputError
            The shape or the type is wrong.

        See Also
        --------
        Triangulation.find_simplex : The triangle of each point.

        Examples
        --------
        >>> DynamicTriangulation([[0, 0], [1, 0]]).find([[1, 0], [2, 2]]).tolist()
        [1, -1]
        """
        positions = as_pairs(points)
        flat = positions.reshape(-1, 2)
        is_finite = np.isfinite(flat).all(axis=1)
        numbers = np.full(len(flat), -1, np.int32)
        part = np.empty(int(is_finite.sum()), np.int32)
        with _Use(self._lock):
            self._mesh.find(np.ascontiguousarray(flat[is_finite]), part)
        numbers[is_finite] = part
        return numbers.reshape(positions.shape[:-1])

    def to_triangulation(self) -> Triangulation:
        """Convert to a `Triangulation` that does not change.

        Returns
        -------
        Triangulation
            Of the points present: its rows are those of ``vertices``.

        Raises
        ------
        DegenerateInputError
            There are fewer than three points, or all lie on one line.

        See Also
        --------
        delaunay : The same from points.

        Examples
        --------
        >>> tri = DynamicTriangulation([[0, 0], [1, 0], [0, 1], [1, 1]])
        >>> tri.remove(0)
        >>> tri.to_triangulation().simplices.tolist()
        [[0, 2, 1]]
        """
        return delaunay(self.points[self.vertices])

    def _forget(self) -> None:
        """Drop what was read before a change."""
        self._points = self._triangles = None

    def _read_triangles(self) -> tuple[Rows, Rows, Rows]:
        if self._triangles is None:
            with _Use(self._lock):
                self._triangles = self._mesh.triangles()
        return self._triangles


class _Use:
    """The use of a triangulation by one call at a time."""

    def __init__(self, lock: threading.Lock) -> None:
        self._lock = lock

    def __enter__(self) -> None:
        if not self._lock.acquire(blocking=False):
            raise RuntimeError("another call is using this triangulation: let it end first")

    def __exit__(self, *_: object) -> None:
        self._lock.release()
