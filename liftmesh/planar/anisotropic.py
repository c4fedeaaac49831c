"""anisotropic_stars(): the star of each point, exact in its own metric.

J.-D. Boissonnat, C. Wormser and M. Yvinec, "Locally uniform anisotropic meshing", SoCG 2008. In the
metric of one point, the Delaunay triangulation of all points is that of a constant metric, and the
star of the point is part of it. Stars of points with different metrics need not agree.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Floats, Indices, Integers, Mask, Progress, Rows
from liftmesh.base.arrays import as_coordinates, of_one_array
from liftmesh.base.frozen import FrozenResult
from liftmesh.base.options import NonFinite, as_count, check_option, check_progress
from liftmesh.errors import InputError, NonFiniteError, Option
from liftmesh.planar.delaunay import delaunay
from liftmesh.planar.kinds import METRIC_REMEDY, as_matrices, is_positive_definite
from liftmesh.planar.points import edges_around

_REMEDY = f"{METRIC_REMEDY} for each row"


@of_one_array
def anisotropic_stars(
    points: ArrayLike,
    metrics: ArrayLike,
    *,
    nonfinite: NonFinite = "error",
    progress: Progress | None = None,
) -> AnisotropicStars:
    """Compute the star of each point in its own metric, exact for every finite double.

    The star of a row holds its triangles in the Delaunay triangulation of all points in the metric
    of that row, as ``delaunay(points, metric=metrics[row])`` has them. A triangle is consistent if
    it is in the stars of all its three corners. Where metrics differ, some are not; to make all of
    them consistent takes further points. So no triangulation is promised: consistent triangles
    cover the plane only if every star is consistent, and may not even then if metrics vary much.

    Parameters
    ----------
    points : array_like of shape (n, 2)
        Planar points, at least three that are not on one line.
    metrics : array_like of shape (n, 2, 2)
        For each row a symmetric, positive definite matrix M: the square of the length of a vector
        v is v^T M v.
    nonfinite : {"error", "skip"}, default "error"
        Rows whose point or metric holds NaN or infinity raise, or are skipped and listed.
    progress : callable, optional
        As for `delaunay`; called with 0.0 to 1.0.

    Returns
    -------
    AnisotropicStars
        Indices are rows of `points`. Rows that are no vertex of `delaunay`, as they equal a row
        before, have no star.

    Raises
    ------
    InputError
        The shape or the type of the values is wrong, or a matrix is not symmetric or not positive
        definite, of which the exact determinant decides. The message names the row.
    NonFiniteError
        A coordinate or a number of a matrix is not finite and `nonfinite` is "error".
    DegenerateInputError
        There are fewer than three distinct points, or all lie on one line.
    UnsupportedTypeError
        `points` is a path, or a column for each axis was given.

    See Also
    --------
    delaunay : The triangulation in one metric for all points.

    Notes
    -----
    A star starts with the Euclidean neighbours of its point. A tree of boxes finds points inside
    the ellipses of its triangles, until there are none. With metrics whose largest and smallest
    length of a unit vector have a bounded ratio, a star takes O(log n) on points that are evenly
    spread; in general it may take O(n).

    Examples
    --------
    >>> points = [[0, 0], [2, 0], [0, 1], [2, 1]]
    >>> stretched = [[[1, 0.5], [0.5, 1]]] * 4
    >>> stars = anisotropic_stars(points, stretched)
    >>> stars
    <AnisotropicStars: 2 consistent triangles over 4 points, 0 inconsistent rows>
    >>> stars.simplices.tolist()
    [[0, 1, 2], [1, 3, 2]]
    >>> anisotropic_stars(points, [[[1, 0], [0, 0]]] * 4)
    Traceback (most recent call last):
    liftmesh.errors.InputError: row 0 has the metric [[1.0, 0.0], [0.0, 0.0]], which is not ...
    """
    check_option("nonfinite", nonfinite, NonFinite)
    check_progress(progress)
    rows = as_coordinates(points)
    if rows.shape[1] != 2:
        raise InputError(f"points need the shape (n, 2), not {rows.shape}: give x and y alone")
    matrices = as_metrics(metrics, len(rows), nonfinite)
    planar = rows.astype(np.float64, order="C") + 0.0
    finite = np.isfinite(planar).all(axis=1) & np.isfinite(matrices).all(axis=(1, 2))
    if nonfinite == "error" or finite.all():
        return _stars(planar, matrices, progress)
    kept = np.flatnonzero(finite).astype(np.int32)
    return _among_all_rows(_stars(planar[kept], matrices[kept], progress), planar, matrices, kept)


def _stars(planar: Floats, matrices: Floats, progress: Progress | None) -> AnisotropicStars:
    tri = delaunay(planar)
    starts, neighbors = tri.vertex_neighbor_vertices
    upper = np.ascontiguousarray(matrices.reshape(-1, 4)[:, [0, 1, 3]])
    given = (
        planar,
        upper,
        starts,
        np.ascontiguousarray(neighbors),
        edges_around(tri.convex_hull),
        progress,
    )
    indptr, indices = _kernel.anisotropic_stars(*given)
    return AnisotropicStars(planar, matrices, indptr, indices, tri.convex_hull, tri.duplicates)


def _among_all_rows(
    stars: AnisotropicStars, planar: Floats, matrices: Floats, kept: Rows
) -> AnisotropicStars:
    """Number the rows that were kept as the caller does."""
    lengths = np.zeros(len(planar), dtype=np.int64)
    lengths[kept] = np.diff(stars.indptr)
    indptr = np.concatenate([[0], np.cumsum(lengths)])
    of_rows = (kept[stars.indices], kept[stars.convex_hull], kept[stars.duplicates])
    skipped = np.setdiff1d(np.arange(len(planar), dtype=np.int32), kept)
    return AnisotropicStars(planar, matrices, indptr, *of_rows, skipped)


def as_metrics(metrics: ArrayLike, rows: int, nonfinite: NonFinite = "error") -> Floats:
    """Convert a matrix for each row."""
    matrices = as_matrices("metrics", metrics, (rows, 2, 2), _REMEDY)
    _check(matrices, nonfinite)
    return matrices


def _check(matrices: Floats, nonfinite: NonFinite) -> None:
    finite = np.isfinite(matrices).all(axis=(1, 2))
    if nonfinite == "error" and not finite.all():
        row = int(finite.argmin())
        raise NonFiniteError(
            f"{_named(matrices, row)}, which is not finite: {_REMEDY}, or skip such rows with "
            f"{Option('nonfinite', 'skip')}",
            row=row,
        )
    symmetric = ~finite | (matrices[:, 0, 1] == matrices[:, 1, 0])
    if not symmetric.all():
        row = int(symmetric.argmin())
        raise InputError(
            f"{_named(matrices, row)}, which is not symmetric: {_REMEDY}, or, if only "
            "rounding differs, (M + M.transpose(0, 2, 1)) / 2"
        )
    for row in np.flatnonzero(finite & ~_surely_definite(matrices)).tolist():
        if not is_positive_definite(matrices[row]):
            raise InputError(f"{_named(matrices, row)}, which is not positive definite: {_REMEDY}")


def _surely_definite(matrices: Floats) -> Mask:
    """Return where rounding, and underflow, cannot have decided."""
    a, b, _, c = matrices.reshape(-1, 4).T
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        product = a * c
        sure: Mask = (a > 0) & (product > b * b * (1 + 1e-15))
        sure &= (product > 1e-290) & (product < 1e300)
    return sure


def _named(matrices: Floats, row: int) -> str:
    return f"row {row} has the metric {matrices[row].tolist()}"


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
    convex_hull : (h,) ndarray of int32
        The rows on the convex hull, counter-clockwise. It is the same in every metric.
    duplicates : (d, 2) ndarray of int32
        Rows equal to a row before, each with that row. They have no star.
    skipped : (i,) ndarray of int32
        Rows skipped because they are not finite. They have no star either.

    See Also
    --------
    anisotropic_stars : Computes them.
    Triangulation : The triangulation in one metric for all points.

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
    convex_hull: Rows
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

        See Also
        --------
        Triangulation.vertex_neighbor_vertices : The same in one metric for all points.

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
        triangles = np.column_stack([owners, self.indices, self.indices[following]])
        on_hull = np.zeros(len(self.points), dtype=bool)
        on_hull[self.convex_hull] = True
        is_gap = np.zeros(len(self.indices), dtype=bool)
        is_gap[last] = on_hull[has_star]
        return triangles[~is_gap].astype(np.int32)

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
        consistent = np.diff(self.indptr) > 0
        consistent[triangles[~agrees, 0]] = False
        return consistent

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
