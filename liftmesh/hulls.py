"""The engines: delaunay() for planar points, lower_hull() for points in space.

Each set of points has one canonical result, and every method finds it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from liftmesh import _kernel
from liftmesh.arrays import as_coordinates, as_rows3, check_finite, non_finite
from liftmesh.counters import Counters
from liftmesh.errors import DegenerateInputError, InputError
from liftmesh.lifting import LowerHull, ParaboloidVertex, resolve_q
from liftmesh.threads import as_threads
from liftmesh.triangulation import Triangulation

Method = Literal["auto", "divide-and-conquer", "lf", "lfres", "lfres-indexed"]
HullMethod = Literal["auto", "lf"]
NonFinite = Literal["error", "skip"]
RowOrder = Literal["engine", "canonical"]
Progress = Callable[[float], None]

METHODS = get_args(Method)
_WRAPPING = ("lf", "lfres", "lfres-indexed")


def delaunay(
    points: ArrayLike,
    *,
    method: Method = "auto",
    q: ParaboloidVertex = "origin",
    nonfinite: NonFinite = "error",
    order: RowOrder = "engine",
    threads: int | None = None,
    progress: Progress | None = None,
) -> Triangulation:
    """Triangulate planar points: exact for every finite double, and one result for one set.

    Where four or more points lie on a circle, the triangulation is the one of the symbolic
    perturbation that lifts lexicographically larger points (by x, then y) more. So the triangles,
    as sets of coordinates, depend on nothing but the points.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        Planar points, n at most 357,913,941; of three columns the third is ignored. float64 and
        float32 arrays of any strides are read in place; integers must be exact as doubles. Masked
        entries count as not finite.
    method : {"auto", "divide-and-conquer", "lf", "lfres", "lfres-indexed"}, default "auto"
        The engine. All give the same triangles; "auto" picks divide and conquer. The others wrap
        the lower hull of the lifted points facet by facet: "lf" and "lfres" are the paper's
        procedures as printed, in quadratic to cubic time; "lfres-indexed" asks a grid for the
        points of the restricted region, in linear expected time where points are evenly spread, and
        in quadratic time or worse where they crowd, as in clusters or on a circle.
    q : {"origin", "median"} or (2,) array_like, default "origin"
        The vertex of the paraboloid on which "lf" and "lfres" lift the points: the origin, the
        coordinate-wise median, or any finite point. It changes their work, and never a triangle;
        the other methods do without.
    nonfinite : {"error", "skip"}, default "error"
        Rows with NaN or infinity raise, or stay unused and are listed in ``skipped``.
    order : {"engine", "canonical"}, default "engine"
        With "canonical" the order of the triangles, and the first vertex of each, are functions of
        the coordinates alone too, at the price of a sort.
    threads : int, optional
        How many threads divide and conquer may take; the result is bit for bit the same for any
        number. By default the environment variable ``LIFTMESH_NUM_THREADS`` says it, or else one
        for each core is taken, and runs from several Python threads share them. Gift wrapping
        itself runs on one.
    progress : callable, optional
        Called now and then, some twenty times a second at most, with the share of the work that is
        done, and at last with 1.0. What it raises ends the run. Gift wrapping tells its end only.

    Returns
    -------
    Triangulation
        Indices are rows of `points`; nothing is reordered or dropped. Of rows at one position the
        lowest is the vertex; the others are in ``duplicates``. Gift wrapping leaves its
        ``counters``.

    Raises
    ------
    InputError
        `points` has another shape, other values than real numbers, or too many rows; or an option
        is unknown.
    NonFiniteError
        A row is not finite and `nonfinite` is "error".
    DegenerateInputError
        There are fewer than three distinct points, or all lie on one line.

    Notes
    -----
    Divide and conquer on the lifted lower hull: F. P. Preparata and S. J. Hong (1977), D. T. Lee
    and B. J. Schachter (1980), with cuts across both axes (R. A. Dwyer, 1987). O(n log n) on every
    input. Some 120 bytes a point beyond the points at the peak, 48 of them the result.

    Gift wrapping with LF and LFRes: "The Lifting Projection of Convex Polyhedra for Finding
    Delaunay Triangulations", Procedures 1 and 3 and Algorithm 2.

    Examples
    --------
    >>> tri = delaunay([[0, 0], [2, 0], [2, 1], [0, 1]], order="canonical")
    >>> tri.simplices
    array([[0, 1, 3],
           [3, 1, 2]], dtype=int32)
    """
    return Triangulation(**_solve(points, method, q, nonfinite, order, threads, progress))


def lower_hull(points: ArrayLike, *, method: HullMethod = "auto") -> LowerHull:
    """Find the lower convex hull of points in space: exact for every finite double.

    Where four or more points lie on one plane, the facets are those of the symbolic perturbation
    that lifts lexicographically larger points (by x, then y) more: the placing triangulation in
    that order. So every point that lies on the lower hull is a vertex of it, and the facets are a
    function of the points alone.

    Parameters
    ----------
    points : array_like of shape (n, 3)
        Points in space; z may be any height. Of points over one planar position only the lowest can
        be on the lower hull, and of several equal ones the first row is.
    method : {"auto", "lf"}, default "auto"
        The engine; both find the same facets. "auto" is randomised incremental construction, in
        O(n log n) expected steps on every input; "lf" is gift wrapping by the paper's procedure LF,
        in quadratic to cubic time.

    Returns
    -------
    LowerHull
        A mesh over the caller's rows. ``above`` lists the rows that are no vertex of it.

    Raises
    ------
    InputError
        `points` has another shape, other values than real numbers, or too many rows; or the method
        is unknown, or needs planar points.
    NonFiniteError
        A row is not finite.
    DegenerateInputError
        There are fewer than three distinct planar positions, or all lie on one line.

    Notes
    -----
    The hull of lifted points is that of their *rounded* heights: ``lower_hull(lift(p))`` can differ
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
    _check_hull_method(method)
    rows = as_coordinates(points)
    if rows.shape[1] != 3:
        raise InputError(
            "points have two columns: a lower hull needs z; for planar points use "
            "liftmesh.delaunay, or lift them first with liftmesh.lift"
        )
    check_finite(rows, skippable=False)
    outcome, counts = _kernel.lower_hull(rows, method)
    status, _, distinct, faces, neighbors, rim, *_ = outcome
    if status != "ok":
        raise _upright(distinct, rim)
    counters = Counters.from_kernel(counts) if method == "lf" else None
    return LowerHull(as_rows3(rows), faces, neighbors=neighbors, counters=counters)


class Delaunay(Triangulation):
    """The door for code written for ``scipy.spatial.Delaunay``: the same call, the same attributes.

    What differs: points are planar only and cannot be added, arrays are read-only, and degenerate
    input raises `DegenerateInputError`, a ValueError, where SciPy raises its QhullError.

    Parameters
    ----------
    points : array_like of shape (n, 2)
        Planar points.
    furthest_site, incremental : bool, default False
        Accepted as False only.
    qhull_options : str, optional
        Accepted and without effect: there is no Qhull.

    Raises
    ------
    InputError
        As `delaunay`, or an option is asked for that liftmesh does not have.
    NonFiniteError
        A row is not finite.
    DegenerateInputError
        There are fewer than three distinct points, or all lie on one line.

    Examples
    --------
    >>> tri = Delaunay(np.array([[0, 0], [0, 1.1], [1, 0], [1, 1]]))
    >>> tri.find_simplex([(0.1, 0.2), (1.5, 0.5)]) >= 0
    array([ True, False])
    """

    def __init__(
        self,
        points: ArrayLike,
        furthest_site: bool = False,
        incremental: bool = False,
        qhull_options: str | None = None,  # noqa: ARG002 - part of SciPy's signature
    ) -> None:
        for option, asked in {"furthest_site": furthest_site, "incremental": incremental}.items():
            if asked:
                raise InputError(f"{option}=True is not available: use scipy.spatial.Delaunay")
        rows = as_coordinates(points)
        if rows.shape[1] == 3:
            raise InputError(
                "points have three columns: liftmesh.delaunay(points) triangulates their x and y; "
                "for tetrahedra use scipy.spatial.Delaunay"
            )
        super().__init__(**_solve(rows))


def _solve(
    points: ArrayLike,
    method: Method = "auto",
    q: ParaboloidVertex = "origin",
    nonfinite: NonFinite = "error",
    order: RowOrder = "engine",
    threads: int | None = None,
    progress: Progress | None = None,
) -> dict[str, Any]:
    _check_option("method", method, METHODS)
    _check_option("nonfinite", nonfinite, ("error", "skip"))
    _check_option("order", order, ("engine", "canonical"))
    rows = as_coordinates(points)
    planar = rows[:, :2]
    run = (rows, nonfinite == "skip", *as_threads(threads, len(rows)), progress)
    outcome, counters = _run(run, method, resolve_q(q, planar))
    status, row, distinct, simplices, neighbors, hull, duplicates, skipped = outcome
    if status == "non-finite":
        raise non_finite(row, rows[row])
    if status != "ok":
        raise _degenerate(rows, distinct, hull, len(skipped))
    if order == "canonical":
        simplices, neighbors = _canonical_order(rows, simplices, neighbors)
    if progress is not None:
        progress(1.0)
    return {
        "points": planar,
        "simplices": simplices,
        "neighbors": neighbors,
        "hull": hull,
        "duplicates": duplicates,
        "skipped": skipped,
        "counters": counters,
    }


def _run(
    run: _kernel.Run, method: Method, q: tuple[float, float]
) -> tuple[_kernel.Outcome, Counters | None]:
    if method not in _WRAPPING:
        return _kernel.delaunay(*run), None
    outcome, counts = _kernel.gift_wrap(*run, method, *q)
    return outcome, Counters.from_kernel(counts)


def _check_hull_method(method: str) -> None:
    known = get_args(HullMethod)
    if method in METHODS and method not in known:
        raise InputError(
            f"method {method!r} is for planar points only, which it lifts itself: use "
            f"liftmesh.delaunay(points, method={method!r}), or one of "
            f"{', '.join(map(repr, known))} here"
        )
    _check_option("method", method, known)


def _check_option(name: str, value: object, known: tuple[str, ...]) -> None:
    if value not in known:
        raise InputError(f"{name} is {value!r}: give one of {', '.join(map(repr, known))}")


def _degenerate(
    rows: NDArray[Any], distinct: int, hull: NDArray[np.int32], skipped: int
) -> DegenerateInputError:
    held = f"{len(rows)} rows" + (f", {skipped} of them skipped as not finite," if skipped else "")
    if distinct < 3:
        return DegenerateInputError(
            f"{held} hold {distinct} distinct planar points: a triangle needs three"
        )
    first, last = int(hull[0]), int(hull[len(hull) // 2])
    return DegenerateInputError(
        f"all {distinct} distinct points lie on one line, from row {first} to row {last}: "
        "a triangle needs a point off it (for a cloud in a vertical plane: "
        "liftmesh.triangulate(cloud, plane='fit'))"
    )


def _upright(distinct: int, rim: NDArray[np.int32]) -> DegenerateInputError:
    if distinct < 3:
        return DegenerateInputError(
            f"the points have {distinct} distinct planar positions: a lower facet needs three"
        )
    return DegenerateInputError(
        f"all {distinct} planar positions lie on one line, from row {int(rim[0])} to row "
        f"{int(rim[1])}: points in a vertical plane have no lower facet; turn them first"
    )


def _canonical_order(
    rows: NDArray[Any], simplices: NDArray[np.int32], neighbors: NDArray[np.int32]
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Turn each triangle to begin with its least point, and sort the triangles by their points."""
    rank = np.empty(len(rows), dtype=np.int32)
    rank[np.lexsort((rows[:, 1], rows[:, 0]))] = np.arange(len(rows), dtype=np.int32)
    turn = (rank[simplices].argmin(axis=1)[:, None] + np.arange(3)) % 3
    simplices = np.take_along_axis(simplices, turn, axis=1)
    neighbors = np.take_along_axis(neighbors, turn, axis=1)
    by_points = np.lexsort(rank[simplices].T[::-1])
    new_name = np.empty(len(simplices) + 1, dtype=np.int32)
    new_name[by_points] = np.arange(len(simplices), dtype=np.int32)
    new_name[-1] = -1
    return simplices[by_points], new_name[neighbors[by_points]]
