"""lower_hull(): the lower convex hull of points in space.

Each set of points has one canonical result, and every algorithm finds it.
"""

from __future__ import annotations

import os
from typing import Any, get_args

from liftmesh import _kernel
from liftmesh._typing import Rows
from liftmesh.base.arrays import check_finite, of_one_array
from liftmesh.base.options import Algorithm, HullAlgorithm, check_option
from liftmesh.errors import DegenerateInputError, InputError, Option
from liftmesh.planar.lifting import Counters, LowerHull
from liftmesh.space.points import space_rows

# Salts the order in which points are inserted: nobody can make an input that is slow in every
# process. No result depends on it.
_SECRET = int.from_bytes(os.urandom(8), "little")


@of_one_array
def lower_hull(cloud: Any, *, algorithm: HullAlgorithm = "auto") -> LowerHull:
    """Compute the lower convex hull of points in space, exact for every finite double.

    The result is unique. If four or more points lie on one plane, the facets are those of the
    symbolic perturbation that lifts lexicographically larger points (by x, then y) more: the
    placing triangulation in that order. So every point on the lower hull is a vertex of it, and
    the facets depend on the points alone.

    Parameters
    ----------
    cloud : array_like of shape (n, 3), Cloud, mesh, table or path
        Points in space, or what has such points, as the path of a file; z may be any height. Of
        points at one planar position only the lowest can be on the lower hull, and of equal points
        the first row.
    algorithm : {"auto", "lf"}, default "auto"
        The algorithm; both find the same facets. "auto" is randomised incremental construction, in
        O(n log n) expected time on every input, as each process draws its random numbers anew;
        "lf" is gift wrapping by the paper's procedure LF, in quadratic to cubic time.

    Returns
    -------
    LowerHull
        A mesh of the caller's rows: ``vertices`` is a read-only view of them if they are float64,
        which writes to the caller's array change. ``above`` lists the rows that are not a vertex of
        it. Faces near each other in the plane are near each other in the list; their order, and the
        first vertex of each, depend on the rows alone.

    Raises
    ------
    InputError
        `cloud` has the wrong shape, values that are not real numbers, or too many rows; or the
        algorithm is unknown, or needs planar points.
    NonFiniteError
        A row is not finite.
    DegenerateInputError
        There are fewer than three distinct planar positions, or all lie on one line.
    FormatError
        The file cannot be read.

    See Also
    --------
    delaunay : Exact for planar points.
    lift : From planar points to points in space.

    Notes
    -----
    The hull of lifted points is that of their *rounded* heights: ``lower_hull(lift(p))`` may differ
    from ``delaunay(p)``, which is exact for the planar points.

    Incremental construction with conflict lists: K. L. Clarkson and P. W. Shor (1989), in the
    biased order of N. Amenta, S. Choi and G. Rote (2003). LF: Procedure 1 of "The Lifting
    Projection of Convex Polyhedra for Finding Delaunay Triangulations".

    Examples
    --------
    >>> hull = lower_hull([[0, 0, 0], [2, 0, 1], [0, 2, 1], [2, 2, 0], [1, 1, 5], [1, 0.5, -1]])
    >>> len(hull.faces), hull.above
    (4, array([4], dtype=int32))
    """
    _check_algorithm(algorithm)
    rows = space_rows(
        cloud,
        "a lower hull needs z; for planar points use liftmesh.delaunay, or lift them first with "
        "liftmesh.lift",
    )
    check_finite(rows, skippable=False)
    outcome, counts = _kernel.lower_hull(rows, algorithm, _SECRET)
    status, _, distinct, faces, neighbors, boundary, *_ = outcome
    if status != "ok":
        raise _degenerate(distinct, boundary)
    counters = Counters.from_kernel(counts) if algorithm == "lf" else None
    return LowerHull(rows, faces, neighbors=neighbors, counters=counters)


def _check_algorithm(algorithm: str) -> None:
    known = get_args(HullAlgorithm)
    if isinstance(algorithm, str) and algorithm in get_args(Algorithm) and algorithm not in known:
        raise InputError(
            f"{Option('algorithm')} {algorithm!r} is for planar points only, which it lifts "
            f"itself: use liftmesh.delaunay(points, algorithm={algorithm!r}), or one of "
            f"{', '.join(map(repr, known))} here"
        )
    check_option("algorithm", algorithm, HullAlgorithm)


def _degenerate(distinct: int, boundary: Rows) -> DegenerateInputError:
    if distinct < 3:
        return DegenerateInputError(
            f"the points have {distinct} distinct planar positions: a lower facet needs three"
        )
    return DegenerateInputError(
        f"all {distinct} planar positions lie on one line, from row {int(boundary[0])} to row "
        f"{int(boundary[1])}: points in a vertical plane have no lower facet; rotate them first"
    )
