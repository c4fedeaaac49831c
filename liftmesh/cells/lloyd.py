"""lloyd(): points relaxed towards the centroids of their cells.

S. P. Lloyd, "Least squares quantization in PCM" (1982): each step moves every point to the centroid
of its Voronoi cell, and none increases the energy, the integral over the domain of the squared
distance to the nearest point. With a density the points become stipples of it: A. Secord, "Weighted
Voronoi Stippling", NPAR 2002.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats
from liftmesh.base.arrays import read_only
from liftmesh.base.options import as_count, counted
from liftmesh.cells.domain import as_domain
from liftmesh.cells.dual import dual_of, sites_of
from liftmesh.cells.measure import Measure, as_density, as_share, check_extent, total_mass
from liftmesh.cells.voronoi import Cells
from liftmesh.crs.comparison import crs_of


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

    def __repr__(self) -> str:
        steps = len(self.energies) - 1
        state = f"{'converged' if self.converged else 'not converged'} after {steps:,} steps"
        rows = counted(len(self.points), "row")
        return f"<LloydResult: {rows}, {state}, the last of {self.largest_move:.3g}>"


def lloyd(
    points: ArrayLike,
    *,
    domain: Any = None,
    density: Any = None,
    max_iter: int = 100,
    tol: float = 1e-3,
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

    Examples
    --------
    >>> found = lloyd(np.random.default_rng(1).random((50, 2)), domain=(0, 0, 1, 1))
    >>> bool((np.diff(found.energies) <= 0).all()), bool(found.cells.areas.min() > 0.01)
    (True, True)
    """
    most = as_count("max_iter", max_iter, 0)
    relative = as_share(tol, np.inf)
    dual = dual_of(sites_of(points, domain))
    inside = as_domain(domain, dual.points, crs_of(points))
    check_extent(inside, dual.points)
    image = None if density is None else as_density(density, inside)
    here = Measure(Cells(dual, inside), image)
    total_mass(here)
    limit = relative * float(np.sqrt(here.cells.areas.sum() / len(dual.points)))
    energies, move = [here.energy], np.inf
    while len(energies) <= most and move > limit:
        moved = here.cells.points.copy()
        full = here.masses > 0
        moved[full] = here.centroids[full]
        move = float(np.hypot(*(moved - here.cells.points).T).max())
        here = Measure(Cells(dual_of(moved), inside), image)
        energies.append(here.energy)
    cells = here.cells
    return LloydResult(cells.points, cells, read_only(np.array(energies)), move, move <= limit)
