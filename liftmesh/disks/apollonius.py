"""apollonius(): the Delaunay graph of disks, the dual of the additively weighted Voronoi diagram.

The distance of a point from a disk is that from its centre less the radius. Where radii differ, the
cells meet in arcs of hyperbolas. Disks are not lifted points: the lifted disks are circles on the
paraboloid, and a plane that touches three of them from below is a circle that touches three disks.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Floats, Indices, Mask, Progress
from liftmesh.base.arrays import as_coordinates, non_finite, of_one_array
from liftmesh.base.options import NonFinite, check_option, check_progress
from liftmesh.disks.graph import ApolloniusGraph
from liftmesh.errors import InputError, NonFiniteError
from liftmesh.planar.weights import as_weights


@of_one_array
def apollonius(
    centers: ArrayLike,
    radii: ArrayLike,
    *,
    nonfinite: NonFinite = "error",
    progress: Progress | None = None,
) -> ApolloniusGraph:
    """Compute the Delaunay graph of disks, exact where all numbers span at most 256 binary digits.

    A point of the plane belongs to the disk of least distance |x - c| - r, and disks whose cells
    share a side share an edge. So every triangle has a circle that touches its three disks from
    outside and that no disk enters. A disk within another has no cell: it is hidden.

    The result is unique. Where four or more disks touch one circle, it is as if each was
    infinitesimally smaller: the smallest by the most, and of equal ones the last by x, then y. With
    equal radii, the triangles are those of `delaunay`.

    Parameters
    ----------
    centers : array_like of shape (n, 2)
        The centre of each disk. Disks may overlap.
    radii : (n,) array_like
        The radius of each disk, not negative: 0 for a point.
    nonfinite : {"error", "skip"}, default "error"
        Rows whose centre or radius is NaN or infinite raise, or are skipped and listed.
    progress : callable, optional
        As for `delaunay`; called with 0.0 to 1.0.

    Returns
    -------
    ApolloniusGraph
        Indices are rows of `centers`. Fewer than three disks, or disks in a row, may have no
        triangle; they have neighbours.

    Raises
    ------
    InputError
        The shape or the type of the values is wrong, a radius is negative, or there is not one for
        each row; or the lowest binary digit of a number is 2^256 times as small as the highest one
        of another, so that the differences of both have more digits than the exact signs have room
        for. The message names both rows.
    NonFiniteError
        A coordinate or a radius is not finite and `nonfinite` is "error".
    UnsupportedTypeError
        `centers` is a path, or a column for each axis was given.

    Notes
    -----
    M. Karavelas and M. Yvinec, "Dynamic additively weighted Voronoi diagrams in 2D", ESA 2002, for
    the insertion of disks. Its order is random in rounds, so O(log n) expected steps for a disk on
    most inputs; it changes nothing of the result. Signs are decided in floating point where that
    is proved, else in integers; ARCHITECTURE.md derives them.

    Examples
    --------
    >>> graph = apollonius([[0, 0], [6, 0], [0, 6], [6, 6], [1, 0]], [2, 1, 1, 1, 0.5])
    >>> graph
    <ApolloniusGraph: 2 triangles over 5 disks, 1 hidden, 0 duplicates>
    >>> graph.simplices.tolist(), graph.hidden.tolist()
    ([[0, 1, 3], [0, 3, 2]], [4])
    >>> apollonius([[0, 0], [1, 1]], [1, -1])
    Traceback (most recent call last):
    liftmesh.errors.InputError: row 1 has the radius -1.0: radii are not negative
    """
    check_option("nonfinite", nonfinite, NonFinite)
    check_progress(progress)
    disks = as_disks(centers, radii, nonfinite)
    rows = np.flatnonzero(are_finite(disks)).astype(np.int32)
    names = ("simplices", "neighbors", "circles", "convex_hull", "hidden", "duplicates")
    run = _kernel.apollonius(disks[rows], progress)
    found: dict[str, Any] = dict(zip(names, run, strict=True))
    if len(rows) < len(disks):
        of_rows = {
            name: rows[found[name]] for name in names if name not in ("neighbors", "circles")
        }
        skipped = np.flatnonzero(~are_finite(disks)).astype(np.int32)
        found |= of_rows | {"skipped": skipped}
    return ApolloniusGraph(disks[:, :2], disks[:, 2], **found)


def are_finite(disks: Floats) -> Mask:
    """Return which rows of disks are finite."""
    finite: Mask = np.asarray(np.isfinite(disks).all(axis=1))
    return finite


def as_disks(
    centers: ArrayLike,
    radii: ArrayLike,
    nonfinite: NonFinite = "error",
    *,
    skippable: bool = True,
) -> Floats:
    """Convert centres and radii to rows x, y, r."""
    rows = as_coordinates(centers)
    if rows.shape[1] != 2:
        raise InputError(f"centers need the shape (n, 2), not {rows.shape}: give x and y alone")
    disks = np.empty((len(rows), 3))
    disks[:, :2] = rows
    disks[:, 2] = as_weights("radii", radii, len(rows)).values
    finite = are_finite(disks)
    if nonfinite == "error" and not finite.all():
        raise _non_finite(disks, int(finite.argmin()), skippable=skippable)
    negative = finite & (disks[:, 2] < 0)
    if negative.any():
        row = int(negative.argmax())
        raise InputError(
            f"row {row} has the radius {float(disks[row, 2])!r}: radii are not negative"
        )
    _check_range(disks, np.flatnonzero(finite))
    return disks


def _non_finite(disks: Floats, row: int, *, skippable: bool) -> NonFiniteError:
    if not np.isfinite(disks[row, :2]).all():
        return non_finite(row, disks[row, :2], skippable=skippable)
    advice = ", or skip them with nonfinite='skip'" if skippable else " first"
    return NonFiniteError(
        f"row {row} has the radius {float(disks[row, 2])!r}: remove such rows{advice}", row=row
    )


def _check_range(disks: Floats, rows: Indices) -> None:
    digits, *ends = _kernel.binary_range(disks[rows])
    if digits <= _kernel.WIDEST_RANGE_OF_DISKS:
        return
    finest, largest = rows[ends].tolist()
    (small, large) = (tuple(disks[row].tolist()) for row in (finest, largest))
    named = f"rows {finest} and {largest}, {small} and {large}, span"
    raise InputError(
        f"{named if finest != largest else f'row {finest}, {small}, spans'} {digits} binary digits "
        f"from the lowest to the highest, and {_kernel.WIDEST_RANGE_OF_DISKS} are exact: round "
        "what is far smaller than the rest"
    )
