"""delaunay_many(): thousands of small sets of points, triangulated in one call."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Array, Integers, Progress, Reals, Rows
from liftmesh.base.arrays import as_coordinates, non_finite, of_one_array, read_only
from liftmesh.base.frozen import FrozenResult, check_numbers, check_starts
from liftmesh.base.options import (
    NonFinite,
    as_count,
    as_threads,
    check_option,
    check_progress,
    refused,
)
from liftmesh.errors import DegenerateInputError, InputError, Option
from liftmesh.planar.points import rows_of
from liftmesh.planar.triangulation import Triangulation


@dataclass(frozen=True, eq=False, repr=False)
class Triangulations(FrozenResult):
    """The Delaunay triangulations of many sets of points, as returned by `delaunay_many`.

    Lists are those of all sets, one after the other; for each there are the places where those of
    each set begin, and the end. All numbers of rows count from the first row of their set, so that
    the arrays of set i are exactly those that `delaunay` returns. Read-only.

    Parameters
    ----------
    points : (n, 2) ndarray of float64 or float32
        The points of all sets.
    offsets : (s + 1,) ndarray of int64
        Set i consists of the rows ``points[offsets[i]:offsets[i + 1]]``.
    simplices : (m, 3) ndarray of int32
        The triangles, those of set i at ``simplices[simplex_offsets[i]:simplex_offsets[i + 1]]``.
    simplex_offsets : (s + 1,) ndarray of int64
        Where the triangles and neighbours of each set begin.
    neighbors : (m, 3) ndarray of int32
        The triangle of the same set across the edge opposite vertex k; -1 outside.
    convex_hull : (h,) ndarray of int32
        The rows on the convex hull of each set, counter-clockwise.
    hull_offsets : (s + 1,) ndarray of int64
        Where these begin.
    duplicates : (k, 2) ndarray of int32
        Rows that are not a vertex because another row of the set has the same position, each with
        the row that is kept, which is the first.
    duplicate_offsets : (s + 1,) ndarray of int64
        Where these begin.
    skipped : (j,) ndarray of int32
        Rows skipped because they are not finite.
    skipped_offsets : (s + 1,) ndarray of int64
        Where these begin.

    See Also
    --------
    delaunay_many : Makes it.
    Triangulation : What each set has by itself.

    Examples
    --------
    >>> import liftmesh, numpy as np
    >>> made = liftmesh.delaunay_many(np.random.default_rng(1).random((10, 2)), [0, 4, 6, 10])
    >>> made
    <Triangulations of 3 sets: 4 triangles over 10 rows, 1 set without>
    >>> made.triangulation(2)
    <Triangulation: 2 triangles over 4 rows, 0 duplicates, 0 skipped>
    """

    points: Reals
    offsets: Integers
    simplices: Rows
    simplex_offsets: Integers
    neighbors: Rows
    convex_hull: Rows
    hull_offsets: Integers
    duplicates: Rows
    duplicate_offsets: Integers
    skipped: Rows
    skipped_offsets: Integers

    def _check_copy(self) -> None:
        check_starts(self.offsets, len(self), len(self.points))
        rows, triangles = np.diff(self.offsets), np.diff(self.simplex_offsets)
        for items, starts, least, beyond in (
            (self.simplices, self.simplex_offsets, 0, rows),
            (self.neighbors, self.simplex_offsets, -1, triangles),
            (self.convex_hull, self.hull_offsets, 0, rows),
            (self.duplicates, self.duplicate_offsets, 0, rows),
            (self.skipped, self.skipped_offsets, 0, rows),
        ):
            check_starts(starts, len(self), len(items))
            ends = np.repeat(beyond, np.diff(starts))
            columns: Array = items.T
            for k in np.nonzero((columns < least) | (columns >= ends))[-1][:1].tolist():
                check_numbers(least, int(ends[k]), items[k])

    def __repr__(self) -> str:
        none = len(self.degenerate)
        return (
            f"<Triangulations of {len(self):,} sets: {len(self.simplices):,} triangles over "
            f"{len(self.points):,} rows, {none:,} {'set' if none == 1 else 'sets'} without>"
        )

    def __len__(self) -> int:
        """The number of sets."""
        return len(self.offsets) - 1

    def triangulation(self, i: int) -> Triangulation:
        """Return the triangulation of one set, whose arrays are views.

        Parameters
        ----------
        i : int
            The number of the set, from 0.

        Returns
        -------
        Triangulation
            As `delaunay` makes it.

        Raises
        ------
        InputError
            There is no such set.
        DegenerateInputError
            The set has fewer than three distinct points, or all lie on a line.

        See Also
        --------
        Triangulations.degenerate : The sets without a triangle.

        Examples
        --------
        >>> import liftmesh
        >>> rows = [[0, 0], [1, 0], [0, 1], [5, 5], [6, 5], [5, 7]]
        >>> liftmesh.delaunay_many(rows, [0, 3, 6]).triangulation(1).points[0].tolist()
        [5.0, 5.0]
        """
        i = as_count("i", i, 0, len(self) - 1)
        if self.simplex_offsets[i] == self.simplex_offsets[i + 1]:
            raise DegenerateInputError(
                f"set {i} has no triangle: its rows, from {self.offsets[i]} to before "
                f"{self.offsets[i + 1]}, hold fewer than three distinct points, or lie on a line"
            )
        triangles = slice(*self.simplex_offsets[i : i + 2])
        return Triangulation(
            self.points[slice(*self.offsets[i : i + 2])],
            self.simplices[triangles],
            self.neighbors[triangles],
            self.convex_hull[slice(*self.hull_offsets[i : i + 2])],
            self.duplicates[slice(*self.duplicate_offsets[i : i + 2])],
            self.skipped[slice(*self.skipped_offsets[i : i + 2])],
        )

    @property
    def degenerate(self) -> Integers:
        """The sets without a triangle: of fewer than three distinct points, or on a line."""
        return read_only(np.nonzero(np.diff(self.simplex_offsets) == 0)[0])

    @property
    def triangles(self) -> Integers:
        """The triangles of all sets, (m, 3) int64, by the rows of all points."""
        first = np.repeat(self.offsets[:-1], np.diff(self.simplex_offsets))
        return read_only(self.simplices + first[:, None])


@of_one_array
def delaunay_many(
    points: ArrayLike,
    offsets: ArrayLike,
    *,
    nonfinite: NonFinite = "error",
    threads: int | None = None,
    progress: Progress | None = None,
) -> Triangulations:
    """Compute the Delaunay triangulations of many sets of planar points in one call.

    Each is what `delaunay` returns for the set, bit for bit, for any number of threads. Thousands
    of small sets take a fraction of the time of as many calls.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        The points of all sets, as for `delaunay`.
    offsets : array_like of integers, of shape (s + 1,)
        Set i consists of the rows ``points[offsets[i]:offsets[i + 1]]``: from 0, ascending, to n.
    nonfinite : {"error", "skip"}, default "error"
        Whether rows with NaN or infinity raise an error, or are skipped and listed in ``skipped``.
    threads : int, optional
        Number of threads, as for `delaunay`. A set is the work of one thread: give a single large
        one to `delaunay`.
    progress : callable, optional
        As for `delaunay`.

    Returns
    -------
    Triangulations
        The arrays of all sets. Those without a triangle, which are an error of `delaunay`, have
        none, and are ``degenerate``.

    Raises
    ------
    InputError
        `points` or an option is invalid, or `offsets` do not divide the rows.
    NonFiniteError
        A row is not finite and `nonfinite` is "error".

    See Also
    --------
    delaunay : A single set.

    Examples
    --------
    >>> import liftmesh
    >>> made = liftmesh.delaunay_many([[0, 0], [1, 0], [0, 1], [5, 5], [6, 5], [5, 7]], [0, 3, 6])
    >>> made.simplices.tolist(), made.triangles.tolist()
    ([[0, 1, 2], [0, 1, 2]], [[0, 1, 2], [3, 4, 5]])
    """
    check_option("nonfinite", nonfinite, NonFinite)
    check_progress(progress)
    rows = as_coordinates(rows_of(points))
    planar = rows if rows.shape[1] == 2 else rows[:, :2]
    starts = _as_offsets(offsets, len(rows))
    run = nonfinite == "skip", *as_threads(threads, len(rows)), progress
    found = _kernel.delaunay_many(planar, starts, *run)
    if len(found) == 1:
        raise non_finite(found[0], rows[found[0]])
    if progress is not None:
        progress(1.0)
    return Triangulations(planar, starts, *found)


def _as_offsets(offsets: ArrayLike, rows: int) -> Integers:
    """Convert the places where sets begin, and the end of the last."""
    try:
        array: Array = np.asarray(offsets)
    except (TypeError, ValueError) as error:
        raise refused("offsets", offsets, "give integers") from error
    if array.dtype.kind not in "iu" or array.ndim != 1 or len(array) == 0:
        raise refused("offsets", offsets, "give integers from 0, ascending, to the number of rows")
    starts = array.astype(np.int64)
    if starts[0] != 0 or starts[-1] != rows:
        raise InputError(
            f"{Option('offsets')} go from {starts[0]} to {starts[-1]}: give those from 0 to "
            f"{rows}, the number of rows"
        )
    if (starts[1:] < starts[:-1]).any():
        i = int(np.argmax(starts[1:] < starts[:-1]))
        raise InputError(
            f"{Option('offsets')} have {starts[i + 1]} after {starts[i]}, at number {i + 1}: let "
            "none be less than the one before"
        )
    return starts
