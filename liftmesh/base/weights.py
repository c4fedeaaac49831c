"""`Weights`: which rows the values at points are made of, with which weights; found only once.

A value is z = a + sum of w (z_i - a) over the rows i after the first of the point, whose value is
a, added up in their order, and never beyond the values of these rows. So a constant stays the same
bits, and rows in an order of coordinates give the same bits for any order of the caller's. The
kernel computes heights by the same formula (`_core/surface/facet.hpp`, `sample.cpp`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liftmesh._typing import Array, Floats, Integers, Rows
from liftmesh.base.arrays import as_numbers, read_only
from liftmesh.base.display import card_of
from liftmesh.base.options import counted
from liftmesh.errors import InputError, MissingDependencyError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from scipy.sparse import csr_array


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Weights:
    """The weights of rows at points, as `Surface.weights` returns them: a sparse matrix.

    Parameters
    ----------
    indptr : (m + 1,) ndarray of int64
        Point i has the entries from ``indptr[i]`` to ``indptr[i + 1]``; none where there is no
        face.
    indices : (k,) ndarray of int32
        The row of each entry: for each point the lexicographically least by x, then y, comes
        first, and others follow counter-clockwise. Beyond the hull, the ends of a side follow
        counter-clockwise.
    data : (k,) ndarray of float64
        The weight of each entry: those of a point add up to 1.
    shape : tuple of int
        How many points there are, and how many rows, with weights or not.

    See Also
    --------
    Surface.weights : Of points over a surface.
    natural_neighbors : Sibson's weights of points alone.

    Examples
    --------
    >>> import liftmesh
    >>> surface = liftmesh.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 1]])
    >>> weights = surface.weights([[1, 1], [0, 4], [9, 9]])
    >>> weights.indices, weights.data, weights.indptr
    (array([0, 1, 2, 2], dtype=int32), array([0.5 , 0.25, 0.25, 1.  ]), array([0, 3, 4, 4]))
    >>> weights @ [10, 20, 30]
    array([17.5, 30. ,  nan])
    """

    indptr: NDArray[np.int64]
    indices: Rows
    data: Floats
    shape: tuple[int, int]
    _repr_html_ = card_of

    def __repr__(self) -> str:
        points, rows = self.shape
        return (
            f"<{type(self).__name__}: {len(self.data):,} of {counted(rows, 'row')} at "
            f"{counted(points, 'point')}>"
        )

    def __matmul__(self, values: ArrayLike) -> Floats:
        """Interpolate values of the rows, as `interpolate`."""
        return self.interpolate(values)

    def interpolate(self, values: ArrayLike) -> Floats:
        """Interpolate values of the rows; ``weights @ values`` does the same.

        Parameters
        ----------
        values : (n, ...) array_like
            A value for each row, or several.

        Returns
        -------
        (m, ...) ndarray of float64
            The bits that `Surface.sample` returns; NaN for points without weights, and where a row
            that has a weight has no value.

        Raises
        ------
        InputError
            There are more or fewer values than rows.

        See Also
        --------
        Surface.sample : Once, without weights.

        Examples
        --------
        >>> import liftmesh
        >>> found = liftmesh.natural_neighbors([[0, 0], [4, 0], [0, 4]], [[1, 1], [9, 9]])
        >>> found.interpolate([0, 10, 20])
        array([7.5, nan])
        """
        held = as_numbers("values", values, "give a number for each row", verb="are")
        if held.ndim == 0 or len(held) != self.shape[1]:
            raise InputError(
                f"values have the shape {held.shape}: give one for each of the "
                f"{counted(self.shape[1], 'row')}"
            )
        columns = held.reshape(len(held), math.prod(held.shape[1:]))
        found = np.empty((columns.shape[1], self.shape[0]))
        for each, column in zip(found, columns.T, strict=True):
            each[:] = self._blended(column)
        shaped: Floats = found.T.reshape(self.shape[0], *held.shape[1:])
        return shaped

    def to_scipy(self) -> csr_array:
        """Convert to a sparse matrix of SciPy, for what else is done with one.

        Returns
        -------
        scipy.sparse.csr_array
            Of ``shape``, with these arrays. Its products with values differ from `interpolate` by
            rounding: a constant may change in its last bits. For points without weights they
            are 0, not NaN.

        Raises
        ------
        MissingDependencyError
            SciPy is not installed: ``pip install 'liftmesh[scipy]'``.

        See Also
        --------
        Weights.interpolate : The bits of `Surface.sample`.

        Examples
        --------
        >>> import liftmesh
        >>> surface = liftmesh.triangulate([[0, 0, 5], [4, 0, 9], [0, 4, 1]])
        >>> matrix = surface.weights([[1, 1], [0, 4]]).to_scipy()
        >>> matrix.T @ [1, 1]  # what each vertex counts for
        array([0.5 , 0.25, 1.25])
        """
        try:
            from scipy.sparse import csr_array  # noqa: PLC0415 - a large library
        except ImportError as error:
            reason = f"a sparse matrix needs scipy, which cannot be imported ({error})"
            raise MissingDependencyError(f"{reason}: pip install 'liftmesh[scipy]'") from error

        return csr_array((self.data.copy(), self.indices.copy(), self.indptr.copy()), self.shape)

    def _blended(self, values: Floats) -> Floats:
        counts = np.diff(self.indptr)
        has_some = counts > 0
        starts, counts = self.indptr[:-1][has_some], counts[has_some]
        blended = np.full(len(has_some), np.nan)
        if not len(starts):
            return blended
        held = values[self.indices] + 0.0
        with np.errstate(over="ignore", invalid="ignore"):
            found = _added_up(held, self.data, starts, counts)
            is_wide = ~np.isfinite(found)
            if is_wide.any():  # as differences may be: those of halves are not
                found[is_wide] = 2 * _added_up(held / 2, self.data, starts, counts)[is_wide]
        low, high = np.fmin.reduceat(held, starts), np.fmax.reduceat(held, starts)
        blended[has_some] = np.clip(found, low, high)
        return blended


def _added_up(held: Floats, weights: Floats, starts: Integers, counts: Integers) -> Floats:
    """Add up in the order of the entries, as `bincount` does and `reduceat` does not."""
    first = held[starts]
    steps = weights * (held - np.repeat(first, counts))
    steps[starts] = 0
    sums: Floats = first + np.bincount(np.repeat(np.arange(len(starts)), counts), steps)
    return sums


def weights_of(arrays: tuple[Array, Array, Array] | None, rows: int) -> Weights:
    """Take what the kernel returns."""
    if arrays is None:
        raise InputError(
            "the points are not those that were triangulated: their array has changed since; "
            "triangulate them again, by delaunay(points, copy=True)"
        )
    starts, indices, data = (read_only(each) for each in arrays)
    return Weights(starts.view(np.int64), indices, data, (len(starts) - 1, rows))


def spread(parts: Sequence[tuple[Integers, Weights]], count: int) -> Weights:
    """Put weights where their points are among so many; the other points have none."""
    counts = np.zeros(count, np.int64)
    for places, part in parts:
        counts[places] = np.diff(part.indptr)
    starts = np.concatenate([[0], np.cumsum(counts)])
    indices, data = np.empty(starts[-1], np.int32), np.empty(starts[-1])
    for places, part in parts:
        moves = np.repeat(starts[places] - part.indptr[:-1], np.diff(part.indptr))
        at = moves + np.arange(len(moves))
        indices[at], data[at] = part.indices, part.data
    return weights_of((starts, indices, data), parts[0][1].shape[1])
