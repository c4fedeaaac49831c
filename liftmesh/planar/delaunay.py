"""delaunay(): planar Delaunay triangulation.

Each set of points has one canonical triangulation, and every algorithm finds it.
"""

from __future__ import annotations

import os
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Apex, Array, Floats, Progress, Reals, Rows
from liftmesh.base.arrays import as_coordinates, non_finite, of_one_array
from liftmesh.base.options import (
    Algorithm,
    NonFinite,
    RowOrder,
    as_folder,
    as_switch,
    as_threads,
    check_option,
    check_progress,
    counted,
)
from liftmesh.errors import DegenerateInputError, InputError, Option
from liftmesh.planar.kinds import TriangulationKind, as_metric
from liftmesh.planar.lifting import Counters, given_apex, resolve_apex
from liftmesh.planar.points import rows_of
from liftmesh.planar.triangulation import Triangulation

_WRAPPING = ("lf", "lfres", "lfres-indexed")
_AUTO: Algorithm = "auto"  # the defaults are not checked, which takes as long as a point or two
_ERROR: NonFinite = "error"
_ENGINE: RowOrder = "engine"
_MEDIAN: Apex = "median"
_NO_ROWS = np.empty(0, dtype=np.int32)


@of_one_array
def delaunay(  # noqa: PLR0913 - options are keywords
    points: ArrayLike,
    *,
    algorithm: Algorithm = "auto",
    apex: Apex = "median",
    nonfinite: NonFinite = "error",
    order: RowOrder = "engine",
    threads: int | None = None,
    progress: Progress | None = None,
    copy: bool = False,
    metric: ArrayLike | None = None,
    scratch: str | os.PathLike[str] | None = None,
) -> Triangulation:
    """Compute the Delaunay triangulation of planar points, exact for every finite double.

    The result is unique. If four or more points lie on a circle, it is the triangulation of the
    symbolic perturbation that lifts lexicographically larger points (by x, then y) more. So the
    triangles, as sets of coordinates, depend on the points alone.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        Planar points, n at most 357,913,941; a third column is ignored. float64 and float32 arrays
        of any strides are read in place; integers must be exactly representable as float64. Masked
        entries count as not finite. Of clouds and meshes of trimesh and Open3D, also as tensors,
        of tables whose columns have names, such as DataFrames and arrays of records, and of a
        `Cloud`, x and y are taken.
    algorithm : {"auto", "divide-and-conquer", "lf", "lfres", "lfres-indexed"}, default "auto"
        The algorithm. All give the same triangles; "auto" is divide and conquer. The others
        construct the lower hull of the lifted points facet by facet (gift wrapping): "lf" and
        "lfres" are the paper's procedures as printed, in quadratic to cubic time; "lfres-indexed"
        searches the restricted region with a grid, in linear expected time for evenly distributed
        points, and in quadratic time or worse for clusters or points on a circle.
    apex : {"median", "origin"} or (2,) array_like, default "median"
        The apex of the paraboloid to which "lf" and "lfres" lift the points, as for `lift`. It
        changes their work, but never a triangle; the other algorithms do not use it.
    nonfinite : {"error", "skip"}, default "error"
        Whether rows with NaN or infinity raise an error, or are skipped and listed in ``skipped``.
    order : {"engine", "canonical"}, default "engine"
        With "canonical" the order of the triangles, and the first vertex of each, depend on the
        coordinates alone too, at the cost of a sort.
    threads : int, optional
        Number of threads for divide and conquer; the result is bit for bit the same for any
        number. By default the value of the environment variable ``LIFTMESH_NUM_THREADS``, or else
        one per core, shared by concurrent runs. Gift wrapping uses a single thread.
    progress : callable, optional
        Called at most about twenty times a second with the fraction of the work done, and with 1.0
        at the end. An exception that it raises aborts the run. Gift wrapping reports only its end.
    copy : bool, default False
        Whether to copy the points first. Otherwise the triangulation reads an array of floats where
        it is: do not write to the array while the triangulation is in use.
    metric : (2, 2) array_like, optional
        A symmetric, positive definite matrix [[a, b], [b, c]]: lengths are those of the metric
        a x^2 + 2 b x y + c y^2, and circles are its ellipses. The points are lifted to this form
        instead of the paraboloid, and nothing is rounded. By default, as with the identity, the
        metric of the plane.
    scratch : str or path, optional
        A folder in which large arrays are files, also those of the result: some 75 bytes a row,
        which are free again when the result is released. What memory does not hold is then slow,
        but right. The points may be a mapped array. Only divide and conquer without a metric, in
        the order of the engine, works so.

    Returns
    -------
    Triangulation
        Indices are rows of `points`; nothing is reordered or dropped. Of rows at one position the
        first is the vertex; the others are in ``duplicates``. Gift wrapping sets ``counters``.

    Raises
    ------
    InputError
        `points` has the wrong shape, values that are not real numbers, or too many rows; an option
        is unknown; `metric` is not symmetric and positive definite, or gift wrapping is to use it;
        `scratch` is no folder, or cannot be used with the other options.
    NonFiniteError
        A row is not finite and `nonfinite` is "error".
    DegenerateInputError
        There are fewer than three distinct points, or all lie on one line.
    UnsupportedTypeError
        `points` is a path, or a column for each axis was given.
    OSError
        The disk of `scratch` is full, or fails.

    See Also
    --------
    delaunay_many : Thousands of small sets in one call.
    Triangulation.graph : Gabriel graphs, relative neighbours, minimum spanning trees.
    regular : Triangulations of weighted points.
    DynamicTriangulation : Points that come and go.
    liftmesh.scipy.Delaunay : The same as SciPy's class.
    triangulate : From a cloud to a surface.
    tile : More points than memory holds.
    verify : An exact check of the result.

    Notes
    -----
    Divide and conquer on the lifted lower hull: F. P. Preparata and S. J. Hong (1977), D. T. Lee
    and B. J. Schachter (1980), with cuts across both axes (R. A. Dwyer, 1987). O(n log n) on every
    input. Peak memory is about 70 bytes per point beyond the points, 78 on a circle; 48 of them are
    the result.

    Gift wrapping with LF and LFRes: "The Lifting Projection of Convex Polyhedra for Finding
    Delaunay Triangulations", Procedures 1 and 3 and Algorithm 2.

    Examples
    --------
    >>> tri = delaunay([[0, 0], [2, 0], [2, 1], [0, 1]], order="canonical")
    >>> tri.simplices
    array([[0, 1, 3],
           [3, 1, 2]], dtype=int32)
    >>> rhombus = [[0, -2], [3, 0], [0, 2], [-3, 0]]
    >>> [0, 2] in delaunay(rhombus).edges.tolist()
    True
    >>> [1, 3] in delaunay(rhombus, metric=[[1, 0], [0, 9]]).edges.tolist()
    True
    """
    options = (algorithm, apex, nonfinite, order, threads, progress, copy)
    return triangulation_of(solve(rows_of(points), *options, metric=metric, scratch=scratch))


class Solution(NamedTuple):
    """What a triangulation is made of: first the arrays in the order of `Triangulation`."""

    points: Reals
    simplices: Rows
    neighbors: Rows
    hull: Rows
    duplicates: Rows
    skipped: Rows
    hidden: Rows = _NO_ROWS
    counters: Counters | None = None
    metric: Floats | None = None
    weights: TriangulationKind | None = None  # or radii


def solve(  # noqa: PLR0913 - as above
    points: ArrayLike,
    algorithm: Algorithm = "auto",
    apex: Apex = "median",
    nonfinite: NonFinite = "error",
    order: RowOrder = "engine",
    threads: int | None = None,
    progress: Progress | None = None,
    copy: bool = False,
    *,
    metric: ArrayLike | None = None,
    scratch: str | os.PathLike[str] | None = None,
) -> Solution:
    """Compute what a `Triangulation` is made of."""
    if not (algorithm is _AUTO and nonfinite is _ERROR and order is _ENGINE and progress is None):
        check_option("algorithm", algorithm, Algorithm)
        check_options(nonfinite, order, progress)
    is_copied = copy is not False and as_switch("copy", copy)
    form = None if metric is None else as_metric(metric)
    rows = as_coordinates(points)
    planar = rows if rows.shape[1] == 2 else rows[:, :2]
    planar = planar.copy() if is_copied else planar
    count, shared = as_threads(threads, len(rows))
    run = planar, nonfinite == "skip", count, shared, progress
    folder = None if scratch is None else _folder(scratch, algorithm, order, form)
    counters = None
    if algorithm in _WRAPPING:
        if form is not None:
            raise InputError(
                f"{Option('algorithm')} {algorithm!r} has no {Option('metric')}: leave one of the "
                "two out"
            )
        outcome, counts = _kernel.gift_wrap(*run, algorithm, *resolve_apex(apex, planar))
        counters = Counters.from_kernel(counts)
    else:
        if apex is not _MEDIAN:
            given_apex(apex)  # unused by divide and conquer, but an invalid one is an error
        outcome = _kernel.delaunay(*run, folder) if form is None else _by_metric(form, run)
    solution = solution_of(outcome, rows, planar, order, progress, threads)
    if counters is None and form is None:
        return solution
    return solution._replace(counters=counters, metric=form)


def _folder(
    scratch: str | os.PathLike[str], algorithm: Algorithm, order: RowOrder, form: Floats | None
) -> str:
    """Check what has no arrays in files."""
    folder = as_folder("scratch", scratch)
    if not os.path.isdir(folder):  # noqa: PTH112 - Path raises for odd names
        raise InputError(f"{Option('scratch')} {folder!r} is no folder: make it first")
    for name, is_given in (
        (f"{Option('algorithm', algorithm)}", algorithm in _WRAPPING),
        (f"order={order!r}", order != _ENGINE),
        ("metric", form is not None),
    ):
        if is_given:
            raise InputError(f"{Option('scratch')} and {name} exclude each other: leave one out")
    return folder


def _by_metric(form: Floats, run: _kernel.Run) -> _kernel.Outcome:
    (a, b), (_, c) = form.tolist()
    return _kernel.delaunay_by_metric(run[0], a, b, c, *run[1:])


def solve_farthest(rows: Floats, *, copy: bool = False) -> Solution:
    """Compute what a farthest-point `Delaunay` is made of, the upper hull."""
    planar = rows.copy() if copy else rows
    outcome, hidden = _kernel.farthest(planar, False, *as_threads(None, len(rows)), None)
    return solution_of(outcome, rows, planar, "engine", None)._replace(hidden=hidden)


def solution_of(
    outcome: _kernel.Outcome,
    rows: Array,
    planar: Array,
    order: RowOrder,
    progress: Progress | None,
    threads: int | None = None,
) -> Solution:
    """Convert the outcome of a run of the kernel."""
    status, row, distinct, simplices, neighbors, hull, duplicates, skipped = outcome
    if status == "non-finite":
        raise non_finite(row, rows[row])
    if status != "ok":
        raise _degenerate(rows, distinct, hull, len(skipped))
    if order == "canonical":
        simplices, neighbors, _ = _kernel.canonical_order(
            planar,
            simplices,
            neighbors,
            None,
            len(planar),
            *as_threads(threads, len(simplices)),
        )
    if progress is not None:
        progress(1.0)
    return Solution(planar, simplices, neighbors, hull, duplicates, skipped)


def triangulation_of(solution: Solution) -> Triangulation:
    """Make a triangulation without weights."""
    return Triangulation(*solution[:6], solution.counters, solution.metric)


def check_options(nonfinite: NonFinite, order: RowOrder, progress: object) -> None:
    """Raise unless the options that all triangulations share have valid values."""
    check_option("nonfinite", nonfinite, NonFinite)
    check_option("order", order, RowOrder)
    check_progress(progress)


def _degenerate(rows: Array, distinct: int, hull: Rows, skipped: int) -> DegenerateInputError:
    held = counted(len(rows), "row") + (
        f", {skipped} of them skipped as not finite," if skipped else ""
    )
    if distinct < 3:
        columns = "; if these are columns, give points.T" if rows.shape == (2, 3) else ""
        return DegenerateInputError(
            f"{held} hold{'s' * (len(rows) == 1)} {counted(distinct, 'distinct planar point')}: a "
            f"triangle needs three{columns}"
        )
    first, last = int(hull[0]), int(hull[len(hull) // 2])
    return DegenerateInputError(
        f"all {distinct} distinct points lie on one line, from row {first} to row {last}: "
        "a triangle needs a point off it (for a cloud in a vertical plane: "
        f"triangulate it with {Option('plane', 'fit')})"
    )
