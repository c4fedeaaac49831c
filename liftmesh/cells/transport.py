"""transport(): power cells of given areas, by a damped Newton method.

The weights for which the power cells of sites have given areas solve the semi-discrete optimal
transport problem with squared distances: each part of the domain goes to the site of its cell. They
maximise a concave function, whose gradient is the areas that are missing, and whose second
derivatives are the lengths of shared sides over the distances of their sites. Newton's steps are
halved until every cell keeps an area and the error falls: J. Kitagawa, Q. Merigot and B. Thibert,
"Convergence of a Newton algorithm for semi-discrete optimal transport", JEMS 21 (2019).

With a density, areas and lengths are integrals of it. Where it is 0, cells may have no mass, or
their sides none, and Newton's method no start or no step. So it is approached: at first, half of it
is spread evenly over the domain; once the masses are reached by and large, a quarter of this share
is, and so on. It need not be 0 in the end: what is spread is too little to matter once it is less
than the tolerance. If no step helps on the way, it starts again from a half, by smaller ratios.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, sqrt
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats
from liftmesh.base.arrays import as_numbers, read_only
from liftmesh.base.options import as_count, as_switch, counted, refused
from liftmesh.cells.domain import Domain, as_domain
from liftmesh.cells.dual import Dual, dual_of, sites_of
from liftmesh.cells.measure import Density, Measure, as_density, as_share, check_extent, total_mass
from liftmesh.cells.voronoi import Cells
from liftmesh.crs.comparison import crs_of
from liftmesh.errors import InputError
from liftmesh.optional import load

_SHORTEST = 2.0**-40  # share of a step
_LEAST = 2.0**-200  # share of the whole
_SMALL = 2.0**-20  # share of the mean
_HALF, _RATIO, _LEAST_RATIO = 0.5, 4.0, 1.4  # of what is spread: the first share, and by what less
_SYMMETRIC = {
    "permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True},
}  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Transported:
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
        Whether the last error is within the tolerance.
    stalled : bool
        Whether it ended above the tolerance because no step helped, so that a higher limit of steps
        changes nothing. If neither this nor `converged`, the steps are used up.

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

    def __repr__(self) -> str:
        state = "converged" if self.converged else "not converged"
        state = "stalled" if self.stalled else state
        return (
            f"<Transported: {counted(len(self.masses), 'row')}, {state} after "
            f"{counted(len(self.damping), 'step')}, "
            f"{self.errors[-1]:.2g} of the whole in the wrong cells>"
        )


def transport(
    points: ArrayLike,
    masses: ArrayLike,
    *,
    domain: Any = None,
    density: Any = None,
    strict: bool = False,
    tolerance: float = 1e-8,
    steps: int = 100,
) -> Transported:
    """Find the power cells that have given areas inside a connected domain.

    Parameters
    ----------
    points : array_like of shape (n, 2) or (n, 3)
        Planar points, all at different positions; they may lie outside of the domain.
    masses : (n,) array_like
        The area of each cell, or its mass by `density`, positive: as shares of the whole, whatever
        they add up to.
    domain : (xmin, ymin, xmax, ymax), shapely geometry or (k, 2) array_like, optional
        As for `voronoi`, in one part.
    density : (h, w) array_like, or a tuple of one and (xmin, ymin, xmax, ymax), optional
        As for `lloyd`; by default 1.
    strict : bool, default False
        Whether masses that do not add up to the mass of the domain, but for rounding, are an
        error. Otherwise they are multiplied by one factor.
    tolerance : float, default 1e-8
        The share of the whole that may be in the wrong cells.
    steps : int, default 100
        How many steps are made at most.

    Returns
    -------
    Transported
        The weights, the cells, and how the error fell.

    Raises
    ------
    InputError
        As for `voronoi` and `lloyd`; two rows are at one position, a mass is not positive, the
        domain is not connected, or has no mass; `strict` masses have another sum; or the rows are
        so far from the domain that float64 has no weights by which they share it.
    NonFiniteError
        A row is not finite.

    Notes
    -----
    Newton's method needs a start at which no cell is empty, or next to it. If the Voronoi cells are
    no such start, the cells of the sites moved and scaled into a circle inside the domain are:
    these are power cells of the sites where they are, by other weights.

    Steps are short where masses differ by factors of a million, and a hundred may not suffice:
    `converged` and the errors tell. A density that is 0 in most places takes tens of steps for
    tens of rows, and hundreds for a thousand rows. There the weights are not unique.

    Areas come from corners in float64. A domain of side 1 at an offset of 1e8 has corners rounded
    to 1.5e-8, and `stalled` is True if that is too coarse for the tolerance: subtract the offset,
    or give a larger tolerance. So are weights where some rows are much nearer to each other than
    to the rest, by a factor of 1e7 or more.

    Examples
    --------
    >>> rows = np.random.default_rng(2).random((30, 2))
    >>> found = transport(rows, np.ones(30), domain=(0, 0, 1, 1))
    >>> found.converged, bool(np.ptp(found.cells.areas) < 1e-8)
    (True, True)
    """
    most = as_count("steps", steps, 0)
    share = as_share(tolerance, 1)
    dual = dual_of(sites_of(points, domain))
    inside = as_domain(domain, dual.points, crs_of(points))
    _check_apart(dual)
    _check_connected(inside)
    check_extent(inside, dual.points)
    image = None if density is None else as_density(density, inside)
    start, weights = _start(dual, inside, image)
    total = total_mass(start)
    wanted = _normalised(masses, len(dual.points), total, strict=as_switch("strict", strict))
    return _newton(start, weights, wanted, share * total, most)


def _start(dual: Dual, domain: Domain, density: Density | None) -> tuple[Measure, Floats]:
    """Cells that all have an area, not much less than others, and their weights."""
    start, weights = Cells(dual, domain), np.zeros(len(dual.points))
    if start.areas.min() <= _SMALL * start.areas.mean():
        spread = _feasible(dual.points, domain)
        trial = _clipped(dual.points, spread, domain)
        if trial.areas.min() > start.areas.min():
            start, weights = trial, spread
    if start.areas.min() <= 0:
        row = int(start.areas.argmin())
        raise InputError(
            f"row {row} gets no share of the domain: the rows are too far from it, or too near "
            "each other, for weights in float64; move them nearer"
        )
    return Measure(start, density), weights


def _check_apart(dual: Dual) -> None:
    if len(dual.duplicates):
        row, kept = dual.duplicates[0].tolist()
        raise InputError(f"rows {kept} and {row} are at one position: give each mass a place")


def _check_connected(domain: Domain) -> None:
    parts = int(np.count_nonzero(~domain.is_hole))
    if parts > 1:
        raise InputError(f"domain has {parts} parts: give one that is connected")


def _normalised(masses: ArrayLike, rows: int, total: float, *, strict: bool) -> Floats:
    given = as_numbers("masses", masses, "give a number for each row", verb="are")
    if given.ndim == 0:
        raise refused(
            "masses", masses, f"give a number for each of {counted(rows, 'row')}", verb="are"
        )
    if given.shape != (rows,):
        raise InputError(
            f"masses have the shape {given.shape} for {counted(rows, 'row')}: give one each"
        )
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


def _feasible(points: Floats, domain: Domain) -> Floats:
    """Weights by which the power cells are the Voronoi cells of points inside the domain."""
    shapely = load("shapely", extra="shapes")
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


def _clipped(points: Floats, weights: Floats, domain: Domain) -> Cells:
    return Cells(dual_of(points, "weights", weights), domain)


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


def _newton(
    here: Measure, weights: Floats, wanted: Floats, tolerance: float, most: int
) -> Transported:
    state, stalled = _State(here, weights, (_missing(here, wanted, 0.0),)), False
    spread, best = _first_spread(here, wanted, tolerance), None
    while state.errors[-1] > tolerance and len(state.damping) < most and not stalled:
        if spread.share > spread.floor and _is_near(state.here, wanted, spread.share):
            spread.lower(_least_spread(state.here, wanted))
        elif (stepped := _stepped(state.here, state.weights, wanted, spread.share)) is not None:
            here, weights, taken = stepped
            errors = (*state.errors, _missing(here, wanted, 0.0))
            state = _State(here, weights, errors, (*state.damping, taken))
        else:
            best = _better(best, state)
            stalled = here.density is None or not spread.restart()
    return _transported(_better(best, state), wanted, tolerance, stalled=stalled)


def _better(one: _State | None, other: _State) -> _State:
    """Which has the smaller error; what no step improved is kept, as a restart may come to less."""
    return other if one is None or other.errors[-1] < one.errors[-1] else one


def _transported(state: _State, wanted: Floats, tolerance: float, *, stalled: bool) -> Transported:
    here, converged = state.here, state.errors[-1] <= tolerance
    shares = read_only(np.array(state.errors) / wanted.sum())
    return Transported(
        read_only(state.weights), here.cells, wanted, read_only(here.masses), shares,
        read_only(np.array(state.damping)), bool(converged), stalled,
    )  # fmt: skip


def _is_near(here: Measure, wanted: Floats, spread: float) -> bool:
    return bool(_missing(here, wanted, spread) <= wanted.min() / 4)


def _first_spread(here: Measure, wanted: Floats, tolerance: float) -> _Spread:
    floor = tolerance / float(wanted.sum()) / 4
    if _least_spread(here, wanted) > 0:
        return _Spread(_HALF, floor, _RATIO)
    return _Spread(0.0, floor, inf)  # if no step helps, the ratio becomes finite


def _least_spread(here: Measure, wanted: Floats) -> float:
    """How much of a density must be spread evenly for every cell to have a mass."""
    if here.density is None:
        return 0.0
    even = here.mixed(1.0)
    least = min(float(even.min()), float(wanted.min())) / 4
    lacking = here.masses < least
    share = (least - here.masses[lacking]) / (even - here.masses)[lacking]
    return float(share.max(initial=0.0))


def _stepped(
    here: Measure, weights: Floats, wanted: Floats, spread: float
) -> tuple[Measure, Floats, float] | None:
    """Take a step of Newton's, halved until it helps; None if none does."""
    masses, error = here.mixed(spread), _missing(here, wanted, spread)
    least = min(float(masses.min()), float(wanted.min())) / 2
    step, share = _step(here, wanted - masses, spread), 1.0
    while least > 0 and share > _SHORTEST and np.isfinite(step).all():
        moved = weights + share * step
        trial = Measure(_clipped(here.cells.points, moved, here.cells.domain), here.density)
        is_better = _missing(trial, wanted, spread) <= (1 - share / 2) * error
        if is_better and trial.mixed(spread).min() >= least:
            return trial, moved, share
        share /= 2
    return None


def _missing(here: Measure, wanted: Floats, spread: float) -> float:
    return float(np.abs(here.mixed(spread) - wanted).sum()) / 2


def _step(here: Measure, missing: Floats, spread: float) -> Floats:
    """Newton's step; the weight of the first row stays. NaN if there is none."""
    sparse, linalg = load("scipy.sparse"), load("scipy.sparse.linalg")
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
