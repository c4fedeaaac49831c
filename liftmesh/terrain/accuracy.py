"""How accurate a surface is: at checkpoints, or at each vertex by the surface of the others.

An error is the height of the surface less the one that was measured. What is said of errors is what
the standards ask for: RMSE, and at 95 % either 1.96 RMSE, where errors are normal (NSSDA, FGDC
1998; the non-vegetated vertical accuracy of ASPRS 2014), or the 95th percentile of their amounts
(the vegetated one). ASPRS 2023 asks for the RMSE of both, and adds that of the checkpoints to it,
in squares. Sums are rounded once, so no bit depends on the order of the points.

*Leave-one-out.* Without a vertex v, triangles between its neighbours fill the hole. Let S be
vertices of which no two are neighbours. In the triangulation without S, the hole of v in S is
filled as it is without v alone: the circles of these triangles have no other vertex inside, the
rule for ties compares coordinates, and none of their corners is in S. The natural neighbours of v
are its neighbours, and so is the nearest vertex. So one triangulation for each of some ten such
sets removes and returns every vertex exactly.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from liftmesh._typing import Array, Floats, Mask, Progress, Rows
from liftmesh.base.arrays import check_finite, ends_of, used_rows
from liftmesh.base.frozen import FrozenResult
from liftmesh.base.options import Interpolation, check_progress, counted, refused
from liftmesh.errors import InputError
from liftmesh.planar.constrained_triangulation import ConstrainedTriangulation
from liftmesh.planar.delaunay import delaunay
from liftmesh.terrain.boundary import mask_of
from liftmesh.terrain.sampling import heights_at, points_above
from liftmesh.terrain.surface_data import SurfaceData, bounds_of_faces, unit_names

_NORMAL = 1.96  # standard deviations that 95 % of normal errors are within


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Accuracy(FrozenResult):
    """Errors of heights, as `Surface.accuracy` returns them; read-only. As text, a table.

    Parameters
    ----------
    points : (n, 3) ndarray of float64
        The checkpoints, or the vertices.
    residuals : (n,) ndarray of float64
        The height of the surface less that of each point; NaN where the surface has none.
    unit : str, optional
        The name of the unit of heights.

    See Also
    --------
    Surface.accuracy : Computes them.
    Surface.height_above : The heights of points above a surface.

    Examples
    --------
    >>> import liftmesh
    >>> slope = liftmesh.triangulate([[0, 0, 0], [4, 0, 8], [0, 4, 0]])
    >>> print(slope.accuracy([[1, 1, 2.1], [2, 1, 3.8], [1, 2, 2], [9, 9, 9]]))
    points                              4
    outside, not counted                1
    RMSE                                0.1290994449
    mean                                0.03333333333
    standard deviation                  0.1527525232
    95 % confidence (1.96 RMSE)         0.253034912
    95th percentile (of amounts)        0.19
    lowest                              -0.1
    highest                             0.2
    """

    points: Floats
    residuals: Floats
    unit: str | None = None

    def __repr__(self) -> str:
        return f"<Accuracy: RMSE {self.rmse:.6g} of {counted(len(self._known), 'error')}>"

    def __str__(self) -> str:
        return "\n".join(f"{name:<36}{value}" for name, value in table(self))

    @property
    def _known(self) -> Floats:
        known: Floats = self.residuals[~np.isnan(self.residuals)]
        return known

    @property
    def n_points(self) -> int:
        """How many points there are."""
        return len(self.residuals)

    @property
    def n_outside(self) -> int:
        """How many of them have no error, as the surface has no height there."""
        return self.n_points - len(self._known)

    @property
    def rmse(self) -> float:
        """The root mean square error: RMSEz of ASPRS 2014, RMSEv1 of ASPRS 2023."""
        return _root_mean_square(self._known, len(self._known))

    @property
    def mean(self) -> float:
        """The mean error: positive where the surface is too high."""
        return _mean(self._known)

    @property
    def std(self) -> float:
        """The standard deviation of a sample; NaN of one error."""
        errors = self._known
        if len(errors) < 2:
            return math.nan
        return 2 * _root_mean_square(errors / 2 - _mean(errors) / 2, len(errors) - 1)

    @property
    def confidence_95(self) -> float:
        """1.96 RMSE, the accuracy at 95 % of NSSDA: that of ASPRS 2014 where nothing grows."""
        return _NORMAL * self.rmse

    @property
    def percentile_95(self) -> float:
        """The 95th percentile of the amounts: that of ASPRS 2014 under vegetation."""
        return float(np.percentile(np.abs(self._known), 95))

    @property
    def min(self) -> float:
        """The lowest error."""
        return float(self._known.min())

    @property
    def max(self) -> float:
        """The highest error."""
        return float(self._known.max())


def table(found: Accuracy) -> list[tuple[str, str]]:
    """Return what is said of errors, name by name."""
    unit = "" if found.unit is None else f" {found.unit}"
    measures = {
        "RMSE": found.rmse,
        "mean": found.mean,
        "standard deviation": found.std,
        "95 % confidence (1.96 RMSE)": found.confidence_95,
        "95th percentile (of amounts)": found.percentile_95,
        "lowest": found.min,
        "highest": found.max,
    }
    counts = [("points", f"{found.n_points:,}"), ("outside, not counted", f"{found.n_outside:,}")]
    return counts + [(name, f"{value:.10g}{unit}") for name, value in measures.items()]


def accuracy_of(
    surface: SurfaceData,
    checkpoints: object = None,
    *,
    interpolation: Interpolation = "linear",
    threads: int | None = None,
    progress: Progress | None = None,
) -> Accuracy:
    """Compare the surface with checkpoints, or each vertex with the surface of the others.

    Parameters
    ----------
    surface : Surface
        The triangulated cloud.
    checkpoints : Cloud, array_like of shape (n, 3), path or object, optional
        Points that were measured otherwise, in the coordinate system of the surface: all rows.
        Without them, each vertex is left out in turn, exactly: the surface is that of
        `triangulate` without its position.
    interpolation, threads
        As for `heights_at`.
    progress : callable, optional
        As for `triangulate`; called with the share of the vertices that were left out.

    Returns
    -------
    Accuracy
        An error for each point, or row of the surface, and what the standards say of them. Points
        where there is no face are counted, and have NaN; so have vertices on the boundary, as
        nothing is around them, and rows that are no vertices.

    Raises
    ------
    InputError
        No point is over a face, or none of the vertices is inside; the points have no z, or are in
        another coordinate system; an error is beyond the largest double; without checkpoints, the
        surface has lines, faces of its own, weights, radii or a metric, or the interpolation is
        "c1".
    NonFiniteError
        A checkpoint is not finite.
    UnsupportedTypeError, FormatError, OSError
        As for `read`.

    See Also
    --------
    Surface.height_above : The heights of points above a surface.
    Surface.raster : With the quantity "longest-edge", where the surface is a guess.

    Notes
    -----
    Measures are those of FGDC, "National Standard for Spatial Data Accuracy" (1998), and of ASPRS,
    "Positional Accuracy Standards for Digital Geospatial Data" (2014; edition 2, 2023), which asks
    for 30 checkpoints at least, more accurate than the surface by a factor of two.

    A vertex is left out as in the cross-validation of an interpolation. The surface without it has
    longer faces there, so these errors are larger than those of the surface itself. It takes some
    ten times as long as `triangulate`, whatever the number of neighbours.

    Examples
    --------
    >>> import liftmesh
    >>> hill = liftmesh.triangulate([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0], [2, 2, 8]])
    >>> hill.accuracy([[1, 1, 4.5], [3, 3, 4], [2, 1, 3.5]]).residuals
    array([-0.5,  0. ,  0.5])
    >>> hill.accuracy().residuals  # without the summit, 0
    array([nan, nan, nan, nan, -8.])
    """
    check_progress(progress)
    if checkpoints is None:
        points, found = surface.vertices, _left_out(surface, interpolation, threads, progress)
    else:
        points = points_above(surface, checkpoints).points
        check_finite(points, skippable=False)
        at = surface.frame.planar(points)
        found = heights_at(surface, at, interpolation, threads=threads)
    if progress is not None:
        progress(1.0)
    with np.errstate(over="ignore"):
        residuals = found - surface.frame.heights(points) + 0.0
    _check(surface, residuals, are_checkpoints=checkpoints is not None)
    return Accuracy(points, residuals, unit_names(surface)[1])


def _check(surface: SurfaceData, residuals: Floats, *, are_checkpoints: bool) -> None:
    """Raise unless there are errors, all of them doubles."""
    if (row := np.flatnonzero(np.isinf(residuals))).size:
        raise InputError(f"the error of point {row[0]} is beyond the largest double: scale heights")
    if not np.isnan(residuals).all():
        return
    if not are_checkpoints:
        raise InputError("no vertex has faces all around it: give checkpoints")
    if not len(residuals):
        raise InputError("there are no checkpoints: give some")
    left, low, right, high = (f"{each:.10g}" for each in bounds_of_faces(surface))
    raise InputError(
        f"none of the {counted(len(residuals), 'checkpoint')} is over a face: x is from {left} to "
        f"{right}, and y from {low} to {high}; are both in the same system?"
    )


def _left_out(
    surface: SurfaceData,
    interpolation: Interpolation,
    threads: int | None,
    progress: Progress | None,
) -> Floats:
    """Return the height of each vertex by the triangulation without it."""
    solved, found = surface.triangulation, np.full(len(surface.vertices), np.nan)
    _check_delaunay(surface)
    if interpolation == "c1":  # gradients depend on more than the neighbours
        reason = "which is for checkpoints: give another, to leave out vertices"
        raise refused("interpolation", interpolation, reason, mark=", ")
    used = np.zeros(len(found), np.bool_)
    used[used_rows(len(found), solved.simplices)] = True
    inner = _inner(surface)
    wanted, done = int(np.count_nonzero(inner)), 0
    for rows in _apart(solved.edges, inner):
        used[rows] = False
        left = np.where(used[:, None], solved.points, np.nan)
        used[rows] = True
        other = delaunay(left, nonfinite="skip", threads=threads)
        rest = replace(surface, triangulation=other, faces=other.simplices, mask=None)
        found[rows] = heights_at(rest, solved.points[rows], interpolation, threads=threads)
        done += len(rows)
        if progress is not None:
            progress(done / wanted)
    return found


def _check_delaunay(surface: SurfaceData) -> None:
    solved = surface.triangulation
    is_lined = isinstance(solved, ConstrainedTriangulation)
    if is_lined or solved.metric is not None or hasattr(solved, "hidden"):
        own = "follows lines or has faces of its own"
        reason = own if is_lined else "has weights, radii or a metric"
        raise InputError(
            f"vertices are left out of a Delaunay triangulation, and the surface {reason}: give "
            "checkpoints"
        )


def _inner(surface: SurfaceData) -> Mask:
    """Tell which vertices have faces all around."""
    solved, left_out = surface.triangulation, mask_of(surface)
    beyond = (solved.neighbors < 0) | left_out[solved.neighbors]
    face, k = np.nonzero(beyond & ~left_out[:, None])
    inner = np.zeros(len(surface.vertices), np.bool_)
    inner[used_rows(len(inner), surface.faces)] = True
    inner[ends_of(solved.simplices, face, k)] = False
    return inner


def _apart(edges: Array, rows: Mask) -> Iterator[Rows]:
    """Divide rows into sets without neighbours, each as large as it can be (M. Luby, 1986)."""
    rank = np.random.default_rng(1).permutation(len(rows))
    rows = rows.copy()
    while rows.any():
        edges = edges[rows[edges].all(axis=1)]
        free, chosen, near = rows.copy(), np.zeros(len(rows), np.bool_), edges
        while free.any():
            first, (a, b) = free.copy(), near.T
            first[np.where(rank[a] < rank[b], b, a)] = False
            chosen |= first
            free &= ~first
            free[near[first[near].any(axis=1)]] = False
            near = near[free[near].all(axis=1)]
        yield np.flatnonzero(chosen).astype(np.int32)
        rows &= ~chosen


def _scale(values: Floats) -> int:
    """Return the power of two that makes the largest of some values about 1."""
    return int(np.frexp(np.abs(values).max())[1])


def _mean(values: Floats) -> float:
    scale = _scale(values)
    return math.ldexp(math.fsum(np.ldexp(values, -scale)) / len(values), scale)


def _root_mean_square(values: Floats, count: int) -> float:
    scale = _scale(values)
    return math.ldexp(math.sqrt(math.fsum(np.ldexp(values, -scale) ** 2) / count), scale)
