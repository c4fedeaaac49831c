"""`DynamicTriangulation`: points are inserted and removed, and the triangles are always canonical.

The rule for ties compares coordinates, never ranks. So the triangles are those that `delaunay`
makes of the points present, whatever was there before, and in whichever order it came; and those of
`constrained_delaunay`, where there are constraints.
"""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Mask, Rows
from liftmesh.base.arrays import MOST_ROWS, as_coordinates, as_pairs, check_finite, pair_keys
from liftmesh.base.display import card_of
from liftmesh.base.options import as_count, counted, refused
from liftmesh.errors import CrossingError, InputError
from liftmesh.planar.constrained import constrained_delaunay
from liftmesh.planar.constraints import gather
from liftmesh.planar.crossing_edges import crossing_error
from liftmesh.planar.delaunay import delaunay

if TYPE_CHECKING:
    from liftmesh.planar.triangulation import Triangulation

_NAMED = 20  # constraints in a message


class DynamicTriangulation:
    """A Delaunay triangulation that takes points in and out.

    At every moment it is the one that `delaunay` makes of the points present, ties included; or,
    with constraints, the constrained Delaunay triangulation of these points and constraints.

    Every position has a number, which `insert` returns: that of the row, for distinct points to
    begin with. It stays until the point is removed; later points get the numbers of removed ones.
    Fewer than three points, or points on one line, have no triangles. Calls from several threads at
    once are refused.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3), optional
        Points to begin with, as for `insert`.
    edges : array_like of int of shape (k, 2), optional
        Constraints to begin with, as rows of `points`. Those whose ends are at one position are
        left out.

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
    input_edges : (k, 2) ndarray of int32
        The constraints, as they were inserted: the lesser number first, in ascending order.
    constraints : (p, 2) ndarray of int32
        The edges that they have become, in the same form: a constraint through other points is
        several of them, and one edge may belong to several constraints.
    constraint_inputs : tuple of ndarray of int32
        The rows of ``input_edges`` of each constraint: indptr, (p + 1,), and indices, as in
        `ConstrainedTriangulation`.
    is_constrained : (m, 3) ndarray of bool
        Whether the edge opposite vertex k of each triangle is a constraint.

    See Also
    --------
    delaunay : All points at once.
    constrained_delaunay : All points and constraints at once.

    Notes
    -----
    A point takes away the triangles whose circle contains it (A. Bowyer, D. F. Watson, 1981), and
    is found by a walk from a point nearby. What a removal leaves is filled with the triangles of
    the neighbours. Both take constant expected time once the place is known; a removal takes
    O(d log d) for d neighbours. Where an eighth of the points changes at once, all is made anew. A
    constraint takes away the triangles that it crosses, and its sides are filled (J. R. Shewchuk,
    B. C. Brown, 2015); without it, the triangles of its sides are merged (L. Guibas, J. Stolfi,
    1985). Both take time in proportion to the triangles that change.

    Examples
    --------
    >>> tri = DynamicTriangulation([[0, 0], [2, 0], [0, 2], [2, 3]])
    >>> found = tri.insert([[1, 1], [0, 0]])
    >>> found.tolist(), len(tri), len(tri.simplices)
    ([4, 0], 5, 4)
    >>> tri.remove(found[:1])
    >>> len(tri), len(tri.simplices)
    (4, 2)
    >>> tri.insert_constraint(0, 3)
    >>> tri.insert([[1, 1.5]]).tolist(), tri.constraints.tolist()
    ([4], [[0, 4], [3, 4]])
    """

    _repr_html_ = card_of

    def __init__(self, points: ArrayLike | None = None, edges: ArrayLike | None = None) -> None:
        self._mesh = _kernel.DynamicMesh()
        self._lock = threading.Lock()
        self._points: Floats | None = None
        self._triangles: tuple[Rows, Rows, Rows] | None = None
        self._edges: tuple[Rows, Rows, Rows, Rows] | None = None
        rows = np.empty((0, 2)) if points is None else as_coordinates(points)
        numbers = self.insert(rows)
        if edges is not None:
            given = gather(rows, edges, None, None)
            ends = numbers[given.edges]
            try:
                self._insert_constraints(ends[ends[:, 0] != ends[:, 1]])
            except CrossingError:  # of the first of them
                planar, remedy = rows[:, :2], "leave out some of these edges"
                *_, pairs = _kernel.constrained(planar, given.edges, False, 1, False, None)
                raise crossing_error(planar, given, pairs, remedy) from None

    def __len__(self) -> int:
        with _Use(self._lock):
            return self._mesh.count()

    def __repr__(self) -> str:
        return f"<DynamicTriangulation of {len(self):,} points>"

    def __reduce__(self) -> tuple[type, tuple[Floats, Rows]]:
        """Copies and pickles have the same points, numbered from 0, and constraints."""
        edges = np.searchsorted(self.vertices, self.input_edges).astype(np.int32)
        return type(self), (self.points[self.vertices], edges)

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

    @property
    def input_edges(self) -> Rows:
        """The constraints, as they were inserted."""
        return self._read_edges()[0]

    @property
    def constraints(self) -> Rows:
        """The edges that constraints have become."""
        return self._read_edges()[1]

    @property
    def constraint_inputs(self) -> tuple[Rows, Rows]:
        """The rows of ``input_edges`` of each constraint: indptr and indices."""
        return self._read_edges()[2:]

    @property
    def is_constrained(self) -> Mask:
        """Whether the edge opposite vertex k of each triangle is a constraint."""
        with _Use(self._lock):
            marks = self._mesh.marks()
        return (marks[:, None] >> np.arange(3, dtype=np.uint8) & 1).astype(np.bool_)

    def insert(self, points: ArrayLike) -> Rows:
        """Insert points. One on a constraint splits it.

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
        """Remove points. Without one that splits a constraint, that is whole again.

        Parameters
        ----------
        vertices : array_like of int
            Their numbers, one or several.

        Raises
        ------
        InputError
            A number is not in use, or occurs twice; or it is that of the end of a constraint, or of
            the place where two constraints cross: then none is removed. Remove these constraints
            first.

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
            self._check_present(rows, numbers)
            place, holders = self._mesh.first_held(rows)
            if len(holders):
                raise _held_error(int(rows[place]), holders)
            self._forget()
            self._mesh.remove(rows)

    def insert_constraint(self, a: int, b: int) -> None:
        """Insert an edge that the triangulation must have from now on, whole or in pieces.

        Points on it split it, and it may overlap others. One that is there already stays as it is.

        Parameters
        ----------
        a, b : int
            The numbers of its ends.

        Raises
        ------
        InputError
            A number is not in use, or both are the same.
        CrossingError
            It crosses other constraints where no point is: then it is not inserted. Its number
            among the edges of the error is the one after those of ``input_edges``.

        See Also
        --------
        DynamicTriangulation.remove_constraint : The opposite.
        constrained_delaunay : All constraints at once.

        Examples
        --------
        >>> tri = DynamicTriangulation([[0, 0], [2, -1], [4, 0], [2, 1]])
        >>> tri.simplices.tolist()
        [[1, 2, 3], [0, 1, 3]]
        >>> tri.insert_constraint(0, 2)
        >>> tri.constraints.tolist(), tri.is_constrained.sum(axis=1)
        ([[0, 2]], array([1, 1]))
        """
        self._insert_constraints(self._edge(a, b))

    def remove_constraint(self, a: int, b: int) -> None:
        """Remove a constraint. Its points stay.

        Parameters
        ----------
        a, b : int
            The numbers of its ends, in any order.

        Raises
        ------
        InputError
            There is no such constraint.

        See Also
        --------
        DynamicTriangulation.insert_constraint : The opposite.

        Examples
        --------
        >>> tri = DynamicTriangulation([[0, 0], [2, -1], [4, 0], [2, 1]])
        >>> tri.insert_constraint(0, 2)
        >>> tri.remove_constraint(2, 0)
        >>> tri.input_edges.tolist(), tri.simplices.tolist()
        ([], [[3, 0, 1], [2, 3, 1]])
        """
        edge = self._edge(a, b)
        with _Use(self._lock):
            self._forget()
            if not self._mesh.remove_constraint(*edge[0].tolist()):
                raise InputError(
                    f"no constraint goes from {a} to {b}: those that there are stand in input_edges"
                )

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
            Of the points present: its rows are those of ``vertices``. With constraints it is a
            `ConstrainedTriangulation`.

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
        _, (points, edges) = self.__reduce__()
        return constrained_delaunay(points, edges) if len(edges) else delaunay(points)

    def _insert_constraints(self, edges: Rows) -> None:
        with _Use(self._lock):
            self._forget()
            done, crossed = self._mesh.insert_constraints(edges)
        if len(crossed):
            raise self._crossing_error(edges[done], crossed)

    def _crossing_error(self, edge: Rows, crossed: Rows) -> CrossingError:
        ends = np.concatenate([self.input_edges, edge[None]])
        others = np.searchsorted(pair_keys(*ends[:-1].T), pair_keys(*crossed.T))
        pairs = np.stack([others, np.full(len(others), len(ends) - 1)], axis=1).astype(np.int32)
        given = gather(self.points, ends, None, None)
        remedy = "remove those that the last edge would cross"
        return crossing_error(self.points, given, pairs, remedy)

    def _edge(self, a: int, b: int) -> Rows:
        ends = as_count("a", a, 0, MOST_ROWS), as_count("b", b, 0, MOST_ROWS)
        if a == b:
            raise InputError(f"both ends of a constraint are point {a}: give two points")
        edge = np.array([ends], np.int32)
        with _Use(self._lock):
            self._check_present(edge[0], ends)
        return edge

    def _check_present(self, rows: Rows, numbers: Array | tuple[int, ...]) -> None:
        absent = self._mesh.first_absent(rows)
        if absent >= 0:
            raise InputError(f"no point has the number {int(numbers[absent])}")

    def _forget(self) -> None:
        """Drop what was read before a change."""
        self._points = self._triangles = self._edges = None

    def _read_edges(self) -> tuple[Rows, Rows, Rows, Rows]:
        if self._edges is None:
            with _Use(self._lock):
                self._edges = self._mesh.constraints()
        return self._edges

    def _read_triangles(self) -> tuple[Rows, Rows, Rows]:
        if self._triangles is None:
            with _Use(self._lock):
                self._triangles = self._mesh.triangles()
        return self._triangles


def _held_error(number: int, holders: Rows) -> InputError:
    """Name the constraints that keep a point from being removed."""
    if (holders == number).any():
        return InputError(f"point {number} is an end of {_named(holders)}: remove these first")
    return InputError(
        f"without point {number}, constraints would cross where no point is: it is on "
        f"{_named(holders)}; remove those on one line first"
    )


def _named(edges: Rows) -> str:
    shown = ", ".join(f"from {a} to {b}" for a, b in edges[:_NAMED].tolist())
    rest = f", and {len(edges) - _NAMED:,} more" if len(edges) > _NAMED else ""
    return f"{counted(len(edges), 'constraint')} ({shown}{rest})"


class _Use:
    """The use of a triangulation by one call at a time."""

    def __init__(self, lock: threading.Lock) -> None:
        self._lock = lock

    def __enter__(self) -> None:
        if not self._lock.acquire(blocking=False):
            raise RuntimeError("another call is using this triangulation: let it end first")

    def __exit__(self, *_: object) -> None:
        self._lock.release()
