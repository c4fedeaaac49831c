"""Disks as arrays, checked, and the arrays of their Delaunay graph."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from liftmesh import _kernel
from liftmesh._typing import Floats, Indices, Mask, Rows
from liftmesh.base.arrays import as_coordinates, non_finite
from liftmesh.base.frozen import FrozenResult, check_copied, check_numbers
from liftmesh.base.options import NonFinite
from liftmesh.errors import InputError, NonFiniteError
from liftmesh.planar.kinds import TriangulationKind, as_weights
from liftmesh.planar.points import edges_around


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class DiskGraph(FrozenResult):
    """The arrays of an `ApolloniusGraph`, which says what each holds."""

    centers: Floats
    radii: Floats
    simplices: Rows
    neighbors: Rows
    circles: Floats
    convex_hull: Rows
    hidden: Rows
    duplicates: Rows
    skipped: Rows = field(default_factory=lambda: np.empty(0, dtype=np.int32))

    @property
    def hull_pairs(self) -> Rows:
        """The pairs of disks that follow each other on the hull, (h, 2)."""
        return edges_around(self.convex_hull)

    def _check_copy(self) -> None:
        rows = len(self.radii)
        check_copied(rows, self.simplices, self.neighbors, self.hidden, self.duplicates)
        check_numbers(0, rows, self.convex_hull, self.skipped)


def as_disks(
    points: ArrayLike,
    radii: ArrayLike,
    nonfinite: NonFinite = "error",
    *,
    skippable: bool = True,
) -> Floats:
    """Convert centres and radii to rows x, y, r: an array of its own."""
    rows = as_coordinates(points)
    if rows.shape[1] != 2:
        raise InputError(f"points need the shape (n, 2), not {rows.shape}: give x and y alone")
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


def are_finite(disks: Floats) -> Mask:
    """Return which rows of disks are finite."""
    finite: Mask = np.asarray(np.isfinite(disks).all(axis=1))
    return finite


def _non_finite(disks: Floats, row: int, *, skippable: bool) -> NonFiniteError:
    if not np.isfinite(disks[row, :2]).all():
        return non_finite(row, disks[row, :2], skippable=skippable)
    return TriangulationKind("radii", disks[:, 2]).non_finite(row, skippable=skippable)


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
