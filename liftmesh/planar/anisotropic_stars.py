"""`AnisotropicStars`: for each point its neighbours in its own metric, and what agrees."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from liftmesh._typing import Floats, Indices, Integers, Mask, Rows
from liftmesh.base.frozen import FrozenResult
from liftmesh.base.options import as_count
from liftmesh.errors import InputError


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class AnisotropicStars(FrozenResult):
    """The stars of points, each in the metric of its point, as returned by `anisotropic_stars`.

    Every index is a row of the caller's arrays. The arrays are read-only.

    Parameters
    ----------
    points : (n, 2) ndarray of float64
        The points.
    metrics : (n, 2, 2) ndarray of float64
        The metric of each.
    indptr : (n + 1,) ndarray of int64
        The neighbours of row i are ``indices[indptr[i]:indptr[i + 1]]``.
    indices : (k,) ndarray of int32
        The neighbours, counter-clockwise: from the next row on the hull to the one before, or from
        the lowest row once around.
    hull : (h,) ndarray of int32
        The rows on the convex hull, counter-clockwise. It is the same in every metric.
    duplicates : (d, 2) ndarray of int32
        Rows equal to a row before, each with that row. They have no star.
    skipped : (i,) ndarray of int32
        Rows skipped because they are not finite. They have no star either.

    Examples
    --------
    >>> import numpy as np
    >>> import liftmesh
    >>> points = [[0, 0], [3, 0], [3, 3], [0, 3], [1, 1]]
    >>> stars = liftmesh.anisotropic_stars(points, [np.eye(2)] * 5)
    >>> stars.star(4).tolist(), stars.inconsistent.tolist()
    ([0, 1, 2, 3], [])
    """

    points: Floats
    metrics: Floats
    indptr: Integers
    indices: Rows
    hull: Rows
    duplicates: Rows
    skipped: Rows = field(default_factory=lambda: np.empty(0, dtype=np.int32))

    def __repr__(self) -> str:
        skipped = f", {len(self.skipped):,} skipped" if len(self.skipped) else ""
        return (
            f"<AnisotropicStars: {len(self.simplices):,} consistent triangles over "
            f"{len(self.points):,} points, {len(self.inconsistent):,} inconsistent rows{skipped}>"
        )

    def star(self, row: int) -> Rows:
        """Return the neighbours of a point in its own metric.

        Parameters
        ----------
        row : int
            A row.

        Returns
        -------
        (k,) ndarray of int32
            Counter-clockwise, as in `indices`; empty for a duplicate or a skipped row.

        Raises
        ------
        InputError
            It is no number of a row, or there is no such row.

        Examples
        --------
        >>> import numpy as np
        >>> import liftmesh
        >>> liftmesh.anisotropic_stars([[0, 0], [2, 0], [0, 2]], [np.eye(2)] * 3).star(1)
        array([2, 0], dtype=int32)
        """
        if as_count("row", row, 0) >= len(self.points):
            raise InputError(f"there is no row {row} among {len(self.points):,} points")
        return self.indices[self.indptr[row] : self.indptr[row + 1]]

    @property
    def triangles(self) -> Rows:
        """The triangles of all stars, (t, 3) int32: the row whose star it is, and two neighbours.

        They are counter-clockwise, by ascending row, each in the order of `indices`.
        """
        owners = np.repeat(np.arange(len(self.points)), np.diff(self.indptr))
        following = np.arange(1, len(self.indices) + 1)
        has_star = np.diff(self.indptr) > 0
        last = self.indptr[1:][has_star] - 1
        following[last] = self.indptr[:-1][has_star]
        found = np.column_stack([owners, self.indices, self.indices[following]])
        on_hull = np.zeros(len(self.points), dtype=bool)
        on_hull[self.hull] = True
        is_gap = np.zeros(len(self.indices), dtype=bool)
        is_gap[last] = on_hull[has_star]
        return found[~is_gap].astype(np.int32)

    @property
    def simplices(self) -> Rows:
        """The triangles that are in the stars of all their corners, (m, 3) int32.

        Each is counter-clockwise from its lowest row on, and they are in ascending order.
        """
        triangles = self.triangles
        firsts, agrees = self._agreeing(triangles)
        return _from_lowest(triangles[firsts[agrees[firsts]]])

    @property
    def consistent(self) -> Mask:
        """Which rows have a star all of whose triangles are in `simplices`, (n,) bool."""
        triangles = self.triangles
        _, agrees = self._agreeing(triangles)
        found = np.diff(self.indptr) > 0
        found[triangles[~agrees, 0]] = False
        return found

    @property
    def inconsistent(self) -> Rows:
        """The rows with a star that is not consistent, (i,) int32, in ascending order."""
        has_star = np.diff(self.indptr) > 0
        return np.flatnonzero(has_star & ~self.consistent).astype(np.int32)

    def _agreeing(self, triangles: Rows) -> tuple[Indices, Mask]:
        """Return the first of equal triangles, in order, and which stand there three times."""
        keys = _from_lowest(triangles)
        order = np.lexsort(keys.T[::-1])
        is_new = np.ones(len(keys), dtype=bool)
        is_new[1:] = (keys[order[1:]] != keys[order[:-1]]).any(1)
        group = np.cumsum(is_new) - 1
        agrees = np.empty(len(keys), dtype=bool)
        agrees[order] = np.bincount(group)[group] == 3 if len(keys) else False
        return order[is_new], agrees


def _from_lowest(triangles: Rows) -> Rows:
    """Turn each triangle until its lowest row comes first."""
    turn = triangles.argmin(1)[:, None] + np.arange(3)
    turned: Rows = np.take_along_axis(triangles, turn % 3, 1)
    return turned
