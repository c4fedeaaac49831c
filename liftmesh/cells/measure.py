"""What cells hold: mass, centroid and energy, by area or by a density."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Floats, Rows
from liftmesh.cells.parts import binary_scale
from liftmesh.errors import InputError

if TYPE_CHECKING:
    from liftmesh.cells.cells import Cells
    from liftmesh.cells.density import Density
    from liftmesh.cells.domain import Domain

_RANGE = 2.0**250  # of lengths whose fourth powers float64 holds


@dataclass(frozen=True)
class Measure:
    """The contents of cells."""

    cells: Cells
    density: Density | None = None

    @cached_property
    def masses(self) -> Floats:
        """The mass of each row's cell, (n,) float64."""
        if self.density is None:
            return self.cells.areas
        return np.maximum(self._integrals[:, 0], 0) * float(self.density.pixel.prod())

    @cached_property
    def centroids(self) -> Floats:
        """The centroid of each row's cell, (n, 2) float64; NaN for rows without a mass."""
        if self.density is None:
            return self.cells.centroids
        mass = self._integrals[:, :1]
        with np.errstate(all="ignore"):
            centre = self._integrals[:, 1:3] / np.where(mass > 0, mass, np.nan)
        return self.density.low + centre * self.density.pixel

    @cached_property
    def energy(self) -> float:
        """The integral of the squared distance to the row of each cell."""
        if self.density is None:
            return energy(self.cells)
        pixel = self.density.pixel
        mass, first, second = np.split(self._integrals, [1, 3], axis=1)
        site = (self.cells.points - self.density.low) / pixel
        about = (second - 2 * site * first + site * site * mass) * pixel**2
        held = self.masses > 0
        return float(about[held].sum() * pixel.prod())

    def mixed(self, share: float) -> Floats:
        """The masses by a density of which so much is spread evenly over the domain."""
        return (1 - share) * self.masses + share * self.mean * self.cells.areas

    def walls(self, share: float = 0.0) -> tuple[Rows, Rows, Floats]:
        """Two rows with a side between their cells, and the mass along it per width; mixed, too."""
        if self.density is None:
            pairs = self.cells.neighbors
            return pairs[:, 0], pairs[:, 1], self.cells.shared_lengths
        row, start, end = self._sides
        side = np.flatnonzero(self.cells.beyond >= 0)
        length = np.hypot(*(end[side] - start[side]).T) / 2  # there is a side on either cell
        held = length * ((1 - share) * self._means + share * self.mean)
        pair = np.sort(np.stack([row[side], self.cells.beyond[side]], axis=1), axis=1)
        names, place = np.unique(pair @ np.array([1 << 32, 1]), return_inverse=True)
        total = np.bincount(place.reshape(-1), held, minlength=len(names)).astype(np.float64)
        return (names >> 32).astype(np.int32), (names & 0xFFFFFFFF).astype(np.int32), total

    @cached_property
    def mean(self) -> float:
        """The mass of the domain over its area."""
        return float(self.masses.sum() / self.cells.areas.sum())

    @cached_property
    def _means(self) -> Floats:
        """The mean density along each side between two cells."""
        _, start, end = self._sides
        side = np.flatnonzero(self.cells.beyond >= 0)
        return self._image.means(start[side], end[side])

    @property
    def _image(self) -> Density:
        return cast("Density", self.density)

    @cached_property
    def _sides(self) -> tuple[NDArray[np.intp], Floats, Floats]:
        """The row of each side, its start and its end."""
        cells = self.cells
        following = np.arange(1, len(cells.corners) + 1)
        following[cells.ring_corners[1:] - 1] = cells.ring_corners[:-1]
        row = np.repeat(np.arange(len(cells.points)), np.diff(cells.parts))
        row = np.repeat(np.repeat(row, np.diff(cells.rings)), np.diff(cells.ring_corners))
        return row, cells.corners, cells.corners[following]

    @cached_property
    def _integrals(self) -> Floats:
        """Mass, first and second moments of each cell, in pixels from the corner of the box."""
        row, start, end = self._sides
        found = self._image.integrals(start, end)
        count = len(self.cells.points)
        return np.stack([np.bincount(row, each, minlength=count) for each in found.T], axis=1)


def energy(cells: Cells) -> float:
    """Integrate the squared distance to the row of each cell."""
    start, end = cells.sides()
    scale = binary_scale(start)
    (x, y), (u, v) = np.ldexp(start, -scale).T, np.ldexp(end, -scale).T
    polar = x * x + x * u + u * u + y * y + y * v + v * v
    with np.errstate(over="ignore"):
        return float(np.ldexp(((x * v - y * u) * polar).sum() / 12, 4 * scale))


def total_mass(measure: Measure) -> float:
    """Add up the masses of all cells."""
    total = float(measure.masses.sum())
    if not total > 0:
        raise InputError("density is 0 in the whole domain: give one that is positive somewhere")
    return total


def check_extent(domain: Domain, points: Floats) -> None:
    """Raise if float64 does not hold the fourth powers of lengths."""
    low, high = domain.corners.min(axis=0), domain.corners.max(axis=0)
    with np.errstate(over="ignore"):
        longest = float((high - low).max())
        distance = np.abs(points - low).max(axis=1)
    if not 1 / _RANGE <= longest <= _RANGE:
        verb = "exceeds" if longest > 1 else "falls below"
        raise InputError(
            f"the domain is {longest!r} wide or high, and the fourth power of that {verb} float64: "
            "scale it and the points"
        )
    if distance.max() > _RANGE:
        row = int(distance.argmax())
        raise InputError(
            f"row {row} is {float(distance[row])!r} away from the domain, and the fourth power of "
            "that exceeds float64: leave it out"
        )
