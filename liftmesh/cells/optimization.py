"""lloyd() and transport(): points and weights optimised for the area or mass of their cells.

*Lloyd's method* moves every point to the centroid of its Voronoi cell (S. P. Lloyd, "Least squares
quantization in PCM", 1982). No step increases the energy, the integral over the domain of the
squared distance to the nearest point. With a density the points become stipples of it: A. Secord,
"Weighted Voronoi Stippling", NPAR 2002.

*Transport.* The weights for which the power cells of sites have given areas solve the semi-discrete
optimal transport problem with squared distances: each part of the domain goes to the site of its
cell. They maximise a concave function, whose gradient is the areas that are missing, and whose
second derivatives are the lengths of shared sides over the distances of their sites. Newton's steps
are halved until every cell keeps an area and the error falls: J. Kitagawa, Q. Merigot and
B. Thibert, "Convergence of a Newton algorithm for semi-discrete optimal transport", JEMS 21 (2019).

With a density, areas and lengths are integrals of it. Where it is 0, cells may have no mass, or
their sides none, and Newton's method no start or no step. So it is approached: at first, half of it
is spread evenly over the domain; once the masses are reached by and large, a quarter of this share
is, and so on. It need not be 0 in the end: what is spread is too little to matter once it is less
than `tol`. If no step helps on the way, it starts again from a half, by smaller ratios.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, sqrt
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats, Progress
from liftmesh.base.arrays import as_numbers, read_only
from liftmesh.base.display import card_of
from liftmesh.base.options import as_count, as_switch, check_progress, counted, part_of, shown
from liftmesh.cells.measure import Measure, as_density, as_share, check_extent, total_mass
from liftmesh.cells.voronoi import Cells, cells_of
from liftmesh.errors import InputError, Option
from liftmesh.optional import load

_SHORTEST = 2.0**-40  # share of a step
_LEAST = 2.0**-200  # share of the whole
_SMALL = 2.0**-20  # share of the mean
_HALF, _RATIO, _LEAST_RATIO = 0.5, 4.0, 1.4  # of what is spread: the first share, and by what less
_SYMMETRIC = {
    "permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True},
}  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class LloydResult:
    """Points relaxed by `lloyd`.

    Parameters
    ----------
    points : (n, 2) ndarray of float64
        The points after the last step, in the order of the rows.
    cells : Cells
        Their cells.
    energies : (s + 1,) ndarray of float64
        The energy before each step, and at the end.
    largest_move : float
        How far the last step moved the point that it moved most.
    converged : bool
        Whether that was within what ``tol`` allows.

    See Also
    --------
    lloyd : Relax points.

    Examples
    --------
    >>> import liftmesh
    >>> relaxed = liftmesh.lloyd([[0.1, 0.5], [0.2, 0.5]], domain=(0, 0, 1, 1), tol=1e-6)
    >>> relaxed.points.round(3), relaxed.converged
    (array([[0.25, 0.5 ],
           [0.75, 0.5 ]]), True)
    """

    points: Floats
    cells: Cells
    energies: Floats
    largest_move: float
    converged: bool
    _repr_html_ = card_of

    def __repr__(self) -> str:
        steps = len(self.energies) - 1
        state = f"{'converged' if self.converged else 'not converged'} after {steps:,} steps"
        rows = counted(len(self.points), "row")
        return f"<LloydResult: {rows}, {state}, the last of {self.largest_move:.3g}>"


def lloyd(
    points: object,
    *,
    domain: Any = None,
    density: Any = None,
    max_iter: int = 100,
    tol: float = 1e-3,
    threads: int | None = None,
    progress: Progress | None = None,
) -> LloydResult:
    """Relax points inside a domain by Lloyd's method, towards evenly spread ones.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        Planar points, as for `voronoi`.
    domain : (xmin, ymin, xmax, ymax), shapely geometry, (k, 2) array_like or "bounds", optional
        As for `voronoi`.
    density : (h, w) array_like, or a tuple of one and (xmin, ymin, xmax, ymax), optional
        How much each place counts, from 0: an image, constant in each pixel, whose first row is the
        highest; and the box that it fills, by default that of the domain. It is 0 outside. Points
        crowd where it is high.
    max_iter : int, default 100
        How many steps are made at most.
    tol : float, default 1e-3
        The steps end once none moves a point by more than this share of the side of a square of the
        mean area of a cell.
    threads, progress
        As for `voronoi`. Told is the share of `max_iter` steps.

    Returns
    -------
    LloydResult
        The points, their cells, and how the energy fell. Rows whose cell has no area, or no mass,
        stay where they are: those at the position of an earlier one, and those far outside of the
        domain.

    Raises
    ------
    InputError
        As for `voronoi`; or `max_iter` is no whole number, `tol` is negative, density is no image
        or is 0 in the whole domain, or the domain is so large or small that float64 does not hold
        the energy.
    NonFiniteError
        A row is not finite.

    See Also
    --------
    transport : Weights by which cells have given areas, where points are.
    voronoi : The cells of points.
    thin : Fewer rows of a cloud, some distance apart.

    Examples
    --------
    >>> found = lloyd(np.random.default_rng(1).random((50, 2)), domain=(0, 0, 1, 1))
    >>> bool((np.diff(found.energies) <= 0).all()), bool(found.cells.areas.min() > 0.01)
    (True, True)
    """
    most = as_count("max_iter", max_iter, 0)
    relative = as_share(tol, np.inf)
    check_progress(progress)
    stages = most + 2  # the cells before, those of each step, and the end
    told = part_of(progress, 0.0, 1 / stages)
    here = _measured(cells_of(points, domain, threads=threads, progress=told), density)
    total_mass(here)
    limit = relative * float(np.sqrt(here.cells.areas.sum() / len(here.cells.points)))
    energies, move = [here.energy], np.inf
    while len(energies) <= most and move > limit:
        moved = here.cells.points.copy()
        full = here.masses > 0
        moved[full] = here.centroids[full]
        move = float(np.hypot(*(moved - here.cells.points).T).max())
        told = part_of(progress, len(energies) / stages, (len(energies) + 1) / stages)
        cells = cells_of(moved, here.cells.domain, threads=threads, progress=told)
        here = Measure(cells, here.density)
        energies.append(here.energy)
    if progress is not None:
        progress(1.0)
    cells = here.cells
    return LloydResult(cells.points, cells, read_only(np.array(energies)), move, move <= limit)


def _measured(cells: Cells, density: Any) -> Measure:
    check_extent(cells.domain, cells.points)
    return Measure(cells, None if density is None else as_density(density, cells.domain))


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class TransportResult:
    """The power cells that `transport` found.

    Parameters
    ----------
    weights : (n,) ndarray of float64
        The weight of each row; the first is 0.
    cells : Cells
        The power cells by these weights.
    masses : (n,) ndarray of float64
        The areas that were asked for, normalised; with a density, the masses.
    cell_masses : (n,) ndarray of float64
        What the cells have of these.
    errors : (s + 1,) ndarray of float64
        The share of the whole that is in the wrong cell, before each step and at the end. It falls
        with every step, but for those that approach a density which is 0 somewhere.
    damping : (s,) ndarray of float64
        The share of each Newton step that was taken.
    converged : bool
        Whether the last error is at most ``tol``.
    stalled : bool
        Whether it ended above ``tol`` because no step helped, so that a higher limit of steps
        changes nothing. If neither this nor `converged`, the steps are used up.

    See Also
    --------
    transport : Find such cells.

    Examples
    --------
    >>> import liftmesh
    >>> found = liftmesh.transport([[1, 1], [3, 1]], [3, 1], domain=(0, 0, 4, 2))
    >>> found.cells.areas, found.weights
    (array([6., 2.]), array([ 0., -4.]))
    """

    weights: Floats
    cells: Cells
    masses: Floats
    cell_masses: Floats
    errors: Floats
    damping: Floats
    converged: bool
    stalled: bool
    _repr_html_ = card_of

    def __repr__(self) -> str:
        state = "converged" if self.converged else "not converged"
        state = "stalled" if self.stalled else state
        return (
            f"<TransportResult: {counted(len(self.masses), 'row')}, {state} after "
            f"{counted(len(self.damping), 'step')}, "
            f"{self.errors[-1]:.2g} of the whole in the wrong cells>"
        )


def transport(  # noqa: PLR0913 - options are keywords
    points: object,
    masses: ArrayLike,
    *,
    domain: Any = None,
    density: Any = None,
    strict: bool = False,
    max_iter: int = 100,
    tol: float = 1e-8,
    threads: int | None = None,
    progress: Progress | None = None,
) -> TransportResult:
    """Find the power cells that have given areas inside a connected domain.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        Planar points, all at different positions; they may lie outside of the domain.
    masses : (n,) array_like
        The area of each cell, or its mass by `density`, positive: as shares of the whole, whatever
        they add up to.
    domain : (xmin, ymin, xmax, ymax), shapely geometry, (k, 2) array_like or "bounds", optional
        As for `voronoi`, in one part.
    density : (h, w) array_like, or a tuple of one and (xmin, ymin, xmax, ymax), optional
        As for `lloyd`; by default 1.
    strict : bool, default False
        Whether masses that do not add up to the mass of the domain, but for rounding, are an
        error. Otherwise they are multiplied by one factor.
    max_iter : int, default 100
        How many steps are made at most.
    tol : float, default 1e-8
        The share of the whole that may be in the wrong cells.
    threads, progress
        As for `lloyd`.

    Returns
    -------
    TransportResult
        The weights, the cells, and how the error fell.

    Raises
    ------
    InputError
        As for `voronoi` and `lloyd`; two rows are at one position, a mass is not positive, the
        domain is not connected, or has no mass; `strict` masses have another sum; or the rows are
        so far from the domain that float64 has no weights by which they share it.
    NonFiniteError
        A row is not finite.

    See Also
    --------
    power_diagram : The cells by given weights.
    lloyd : Points whose cells are about even.

    Notes
    -----
    Newton's method needs a start at which no cell is empty, or next to it. If the Voronoi cells are
    no such start, the cells of the sites moved and scaled into a circle inside the domain are:
    these are power cells of the sites where they are, by other weights.

    Steps are short where masses differ by factors of a million, and a hundred may not suffice:
    `converged` and the errors tell. A density that is 0 in most places takes tens of steps for
    tens of rows, and hundreds for a thousand rows. There the weights are not unique.

    Areas come from corners in float64. A domain of side 1 at an offset of 1e8 has corners rounded
    to 1.5e-8, and `stalled` is True if that is too coarse for `tol`: subtract the offset, or
    give a larger one. So are weights where some rows are much nearer to each other than
    to the rest, by a factor of 1e7 or more.

    Examples
    --------
    >>> rows = np.random.default_rng(2).random((30, 2))
    >>> found = transport(rows, np.ones(30), domain=(0, 0, 1, 1))
    >>> found.converged, bool(np.ptp(found.cells.areas) < 1e-8)
    (True, True)
    """
    most = as_count("max_iter", max_iter, 0)
    share = as_share(tol, 1)
    check_progress(progress)
    whole = part_of(progress, 0.0, 1.0)
    told = part_of(whole, 0.0, 0.5 / (most + 2))
    cells = cells_of(points, domain, threads=threads, progress=told)
    if len(cells.duplicates):
        row, kept = cells.duplicates[0].tolist()
        raise InputError(f"rows {kept} and {row} are at one position: give each mass a place")
    if (parts := int(np.count_nonzero(~cells.domain.is_hole))) > 1:
        raise InputError(f"{Option('domain')} has {parts} parts: give one that is connected")
    here = _measured(cells, density)
    told = part_of(whole, 0.5 / (most + 2), 1 / (most + 2))
    cells, weights = _start(cells, threads, told)
    start = Measure(cells, here.density)
    total = total_mass(start)
    wanted = _normalised(masses, len(cells.points), total, strict=as_switch("strict", strict))
    result = _Newton(wanted, share * total, most, threads, whole).solved(start, weights)
    if whole is not None:
        whole(1.0)
    return result


def _start(cells: Cells, threads: int | None, progress: Progress | None) -> tuple[Cells, Floats]:
    """Cells that all have an area, not much less than others, and their weights."""
    weights = np.zeros(len(cells.points))
    if cells.areas.min() <= _SMALL * cells.areas.mean():
        spread = _feasible(cells)
        options: dict[str, Any] = {"threads": threads, "progress": progress}
        trial = cells_of(cells.points, cells.domain, "weights", spread, **options)
        if trial.areas.min() > cells.areas.min():
            cells, weights = trial, spread
    if cells.areas.min() <= 0:
        row = int(cells.areas.argmin())
        raise InputError(
            f"row {row} gets no share of the domain: the rows are too far from it, or too near "
            "each other, for weights in float64; move them nearer"
        )
    return cells, weights


def _normalised(masses: ArrayLike, rows: int, total: float, *, strict: bool) -> Floats:
    given = as_numbers("masses", masses, "give a number for each row", verb="are")
    if given.shape != (rows,):
        what = f"have the shape {given.shape}" if given.ndim else f"are {shown(masses)}"
        raise InputError(f"masses {what}: give a number for each of {counted(rows, 'row')}")
    bad = ~((given > 0) & np.isfinite(given))
    if bad.any():
        row = int(bad.argmax())
        raise InputError(f"row {row} has the mass {float(given[row])!r}: masses are positive")
    relative = given / given.max()  # whose sum is finite
    if strict and abs(relative.sum() - total / given.max()) > 1e-12 * relative.sum():
        raise InputError(
            f"masses add up to {float(relative.sum()) * float(given.max())!r}, and the domain has "
            f"{total!r}: leave strict=False to have them normalised"
        )
    wanted = relative * (total / relative.sum())
    if not wanted.min() > _LEAST * total:
        row = int(wanted.argmin())
        raise InputError(
            f"row {row} has the mass {float(given[row])!r}, which is no share of the whole: leave "
            "it out"
        )
    return read_only(wanted)


def _feasible(cells: Cells) -> Floats:
    """Weights by which the power cells are the Voronoi cells of points inside the domain."""
    shapely = load("shapely", extra="shapes")
    points, domain = cells.points, cells.domain
    rings = np.split(domain.corners, domain.starts[1:-1])
    polygon = shapely.Polygon(rings[0], rings[1:])
    centre, edge = shapely.get_coordinates(shapely.maximum_inscribed_circle(polygon))
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    reach = float(np.hypot(*(points - middle).T).max()) or 1.0
    share = 0.9 * float(np.hypot(*(edge - centre))) / reach
    from_middle = points - middle
    weights: Floats = (1 - share) * (from_middle**2).sum(axis=1)
    weights -= 2 * from_middle @ (centre - middle)
    weights -= weights[0]
    return weights


@dataclass
class _Spread:
    """The share of a density that is spread evenly over the domain, on its way down."""

    share: float
    floor: float
    ratio: float

    def lower(self, least: float) -> None:
        """Spread less, but no less than leaves every cell a mass, if that is less at all."""
        enough = min(least, self.share / 2)
        self.share = max(enough, self.share / self.ratio, self.floor)

    def restart(self) -> bool:
        """Start from a half, to go down by a smaller ratio; False if that has been tried."""
        self.share, self.ratio = _HALF, min(_RATIO, sqrt(self.ratio))
        return self.ratio > _LEAST_RATIO


@dataclass(frozen=True)
class _State:
    """Where Newton's method is, and how it came there."""

    here: Measure
    weights: Floats
    errors: tuple[float, ...]
    damping: tuple[float, ...] = ()


@dataclass(frozen=True)
class _Newton:
    """A run of Newton's method."""

    wanted: Floats
    tol: float  # a mass
    max_iter: int
    threads: int | None
    progress: Progress | None

    def solved(self, here: Measure, weights: Floats) -> TransportResult:
        """Take steps until the error is small enough, or no step helps."""
        state, stalled = _State(here, weights, (self._missing(here),)), False
        spread, best = self._first_spread(here), None
        while state.errors[-1] > self.tol and len(state.damping) < self.max_iter and not stalled:
            here = state.here
            if spread.share > spread.floor and self._is_near(here, spread.share):
                spread.lower(self._least_spread(here))
            elif (stepped := self._stepped(state, spread.share)) is not None:
                state = stepped
            else:
                best = _better(best, state)
                stalled = here.density is None or not spread.restart()
        state = _better(best, state)
        here, converged = state.here, bool(state.errors[-1] <= self.tol)
        shares = read_only(np.array(state.errors) / self.wanted.sum())
        return TransportResult(
            read_only(state.weights), here.cells, self.wanted, read_only(here.masses), shares,
            read_only(np.array(state.damping)), converged, stalled,
        )  # fmt: skip

    def _missing(self, here: Measure, spread: float = 0.0) -> float:
        return float(np.abs(here.mixed(spread) - self.wanted).sum()) / 2

    def _is_near(self, here: Measure, spread: float) -> bool:
        return bool(self._missing(here, spread) <= self.wanted.min() / 4)

    def _first_spread(self, here: Measure) -> _Spread:
        floor = self.tol / float(self.wanted.sum()) / 4
        if self._least_spread(here) > 0:
            return _Spread(_HALF, floor, _RATIO)
        return _Spread(0.0, floor, inf)  # if no step helps, the ratio becomes finite

    def _least_spread(self, here: Measure) -> float:
        """How much of a density must be spread evenly for every cell to have a mass."""
        if here.density is None:
            return 0.0
        even = here.mixed(1.0)
        least = min(float(even.min()), float(self.wanted.min())) / 4
        lacking = here.masses < least
        share = (least - here.masses[lacking]) / (even - here.masses)[lacking]
        return float(share.max(initial=0.0))

    def _stepped(self, state: _State, spread: float) -> _State | None:
        """Take a step of Newton's, halved until it helps; None if none does."""
        here, cells = state.here, state.here.cells
        masses, error = here.mixed(spread), self._missing(here, spread)
        least = min(float(masses.min()), float(self.wanted.min())) / 2
        step, share = _step(here, self.wanted - masses, spread), 1.0
        while least > 0 and share > _SHORTEST and np.isfinite(step).all():
            moved = state.weights + share * step
            made = cells_of(
                cells.points, cells.domain, "weights", moved,
                threads=self.threads, progress=self._within(len(state.damping), share),
            )  # fmt: skip
            trial = Measure(made, here.density)
            is_better = self._missing(trial, spread) <= (1 - share / 2) * error
            if is_better and trial.mixed(spread).min() >= least:
                errors = (*state.errors, self._missing(trial))
                return _State(trial, moved, errors, (*state.damping, share))
            share /= 2
        return None

    def _within(self, steps: int, share: float) -> Progress | None:
        """Return the part of the progress that a trial of the next step has: half of the rest."""
        stages = self.max_iter + 2
        told = part_of(self.progress, (steps + 1) / stages, (steps + 2) / stages)
        return part_of(told, 1 - share, 1 - share / 2)


def _better(one: _State | None, other: _State) -> _State:
    """Which has the smaller error; what no step improved is kept, as a restart may come to less."""
    return other if one is None or other.errors[-1] < one.errors[-1] else one


def _step(here: Measure, missing: Floats, spread: float) -> Floats:
    """Newton's step; the weight of the first row stays. NaN if there is none."""
    sparse, linalg = load("scipy.sparse", extra="scipy"), load("scipy.sparse.linalg", extra="scipy")
    rows, points = len(missing), here.cells.points
    one, other, held = here.walls(spread)
    slope = held / (2 * np.hypot(*(points[one] - points[other]).T))
    grows = np.bincount(one, slope, minlength=rows) + np.bincount(other, slope, minlength=rows)
    names = np.arange(rows)
    places = np.concatenate([names, one, other]), np.concatenate([names, other, one])
    matrix = sparse.csc_matrix((np.concatenate([grows, -slope, -slope]), places), (rows, rows))
    step = np.zeros(rows)
    if rows == 1:
        return step
    try:
        solver = linalg.splu(matrix[1:, 1:], **_SYMMETRIC)
    except RuntimeError:  # singular: the density keeps cells apart
        return np.full(rows, np.nan)
    step[1:] = solver.solve(missing[1:])
    return step
