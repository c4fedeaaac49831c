"""tetrahedralize(): the Delaunay triangulation of points in space.

Each set of points has one canonical triangulation.
"""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Mask, Progress, Rows
from liftmesh.base.arrays import non_finite, of_one_array
from liftmesh.base.options import NonFinite, RowOrder, as_threads, counted
from liftmesh.errors import DegenerateInputError, InputError, Option
from liftmesh.planar.delaunay import check_options
from liftmesh.space.points import space_rows
from liftmesh.space.tetrahedralization import Tetrahedralization

# Salts the order in which points are inserted: nobody can make an input that is slow in every
# process. No result depends on it.
_SECRET = int.from_bytes(os.urandom(8), "little")
_MOST_ROWS = 2**29 // 7  # each has seven tetrahedra or so, and four facets of each have a number


@of_one_array
def tetrahedralize(
    cloud: Any,
    *,
    nonfinite: NonFinite = "error",
    order: RowOrder = "engine",
    threads: int | None = None,
    progress: Progress | None = None,
) -> Tetrahedralization:
    """Compute the Delaunay triangulation of points in space, exact for every finite double.

    The result is unique. If five or more points lie on a sphere, as on every lattice, it is the
    triangulation of the symbolic perturbation that lifts lexicographically larger points (by x,
    then y, then z) more. So the tetrahedra, as sets of coordinates, depend on the points alone, and
    none of them is flat.

    Parameters
    ----------
    cloud : array_like of shape (n, 3), Cloud, mesh, table or path
        Points in space, n at most 76,695,844, or what has such points, as the path of a file. A
        mesh gives its vertices.
    nonfinite : {"error", "skip"}, default "error"
        Whether rows with NaN or infinity raise an error, or are skipped and listed in ``skipped``.
    order : {"engine", "canonical"}, default "engine"
        The order of the tetrahedra, which depends on the coordinates alone either way: along a
        Hilbert curve, or with "canonical" by their points, as in `delaunay`, at the cost of a sort.
    threads : int, optional
        As for `delaunay`. The result does not depend on it.
    progress : callable, optional
        As for `delaunay`.

    Returns
    -------
    Tetrahedralization
        Indices are rows of the cloud; nothing is reordered or dropped. Of rows at one position the
        first is the vertex; the others are in ``duplicates``.

    Raises
    ------
    InputError
        `cloud` has the wrong shape, values that are not real numbers, or too many rows; an option
        is unknown.
    NonFiniteError
        A row is not finite and `nonfinite` is "error".
    DegenerateInputError
        There are fewer than four distinct points, or all lie on one line or one plane.
    FormatError
        The file cannot be read.
    MemoryError
        There are more than 2^29 tetrahedra: n points on a curve may have n^2.

    See Also
    --------
    delaunay : The same in the plane.
    convex_hull : The surface of the result.
    verify : An exact check of the result.

    Notes
    -----
    Incremental insertion: A. Bowyer and D. F. Watson (1981), in the biased order of N. Amenta, S.
    Choi and G. Rote (2003) along Hilbert curves; several threads insert along stretches of them (C.
    Marot, J. Pellerin and J.-F. Remacle, 2019), and gain nothing where most tetrahedra are long, as
    on a sphere. Most sets have between six and seven tetrahedra a point, and take some 350 bytes.

    Examples
    --------
    >>> tetra = tetrahedralize([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]])
    >>> tetra.simplices.shape, tetra.convex_hull.shape
    ((2, 4), (6, 3))
    >>> import numpy as np
    >>> cube = np.indices((2, 2, 2)).reshape(3, -1).T
    >>> tetrahedralize(cube, order="canonical").simplices[0]
    array([0, 1, 4, 2], dtype=int32)
    """
    check_options(nonfinite, order, progress)
    rows = space_rows(
        cloud, "tetrahedra need z; for planar points use liftmesh.delaunay, or give a third column"
    )
    if len(rows) > _MOST_ROWS:
        raise InputError(
            f"{len(rows):,} rows are more than the {_MOST_ROWS:,} whose tetrahedra 32-bit facet "
            "numbers allow: thin the points"
        )
    used = as_threads(threads, len(rows))
    status, row, distinct, simplices, neighbors, hull, duplicates, skipped, witness = (
        _kernel.tetrahedralize(rows, nonfinite == "skip", _SECRET, *used, progress)
    )
    if status == "non-finite":
        raise non_finite(row, rows[row])
    if status != "ok":
        raise _degenerate(status, rows, distinct, witness, len(skipped))
    if order == "canonical":
        simplices, neighbors, hull = _canonical_order(rows, simplices, neighbors, hull)
    if progress is not None:
        progress(1.0)
    return Tetrahedralization(rows, simplices, neighbors, hull, duplicates, skipped)


def _degenerate(
    status: str, rows: Array, distinct: int, witness: Rows, skipped: int
) -> DegenerateInputError:
    held = counted(len(rows), "row") + (
        f", {skipped} of them skipped as not finite," if skipped else ""
    )
    if status == "too few":
        return DegenerateInputError(
            f"{held} hold{'s' * (len(rows) == 1)} {counted(distinct, 'distinct point')}: a "
            "tetrahedron needs four"
        )
    if status == "collinear":
        first, second = sorted(witness.tolist())
        return DegenerateInputError(
            f"all {distinct} distinct points lie on one line, that of rows {first} and {second}: "
            "tetrahedra need points off every plane"
        )
    first, second, third = sorted(witness.tolist())
    return DegenerateInputError(
        f"all {distinct} distinct points lie on one plane, that of rows {first}, {second} and "
        f"{third}: tetrahedra need a point off it; triangulate the points in their plane, with "
        f"liftmesh.triangulate and {Option('plane', 'fit')}, whose boundary is the hull of a flat "
        "cloud"
    )


def _canonical_order(
    rows: Floats, simplices: Rows, neighbors: Rows, hull: Rows
) -> tuple[Rows, Rows, Rows]:
    """Begin each tetrahedron with its two least points, and sort all by their points."""
    rank = np.empty(len(rows), dtype=np.int32)
    rank[np.lexsort(rows.T[::-1])] = np.arange(len(rows), dtype=np.int32)
    places = rank.take(simplices, axis=0).argsort(axis=1)
    is_odd = _is_odd(places)
    places[is_odd] = places[is_odd][:, [0, 1, 3, 2]]
    simplices = np.take_along_axis(simplices, places, axis=1)
    neighbors = np.take_along_axis(neighbors, places, axis=1)
    by_points = np.lexsort(rank.take(simplices, axis=0).T[::-1])
    new_name = np.empty(len(simplices) + 1, dtype=np.int32)
    new_name[by_points] = np.arange(len(simplices), dtype=np.int32)
    new_name[-1] = -1
    turn = (rank[hull].argmin(axis=1)[:, None] + np.arange(3)) % 3
    hull = np.take_along_axis(hull, turn, axis=1)
    hull = hull[np.lexsort(rank[hull].T[::-1])]
    return simplices[by_points], new_name[neighbors[by_points]], hull


def _is_odd(places: Array) -> Mask:
    inversions = [places[:, i] > places[:, j] for j in range(4) for i in range(j)]
    odd: Mask = np.bitwise_xor.reduce(inversions)
    return odd
