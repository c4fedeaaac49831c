"""Measures of cells: mass, centroid and energy, by area or by a density over the plane.

A density is an image, constant in each pixel, integrated over cells exactly. By Green's theorem the
mass of a polygon is the integral of F dy along its sides, where F(x, y) is the integral of the
density from the left up to x. Sides are cut at the lines between pixels. On each piece F is linear,
and the functions that stand in its place for first and second moments are polynomials of degree
three at most, which Gauss's rule of two nodes integrates exactly. So rounding is all that is lost;
sums of pixels that are integers lose nothing either.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Array, Floats, Integers, Rows
from liftmesh.base.arrays import as_numbers, as_reals, read_only
from liftmesh.base.frozen import cached_property
from liftmesh.base.options import as_number, shown
from liftmesh.cells.clipped import rows_of_corners, sums_by_pair
from liftmesh.cells.domain import Domain, following_corners
from liftmesh.cells.rings import binary_scale
from liftmesh.errors import InputError
from liftmesh.io.columns import places

if TYPE_CHECKING:
    from liftmesh.cells.voronoi import Cells


_RANGE = 2.0**250  # of lengths whose fourth powers float64 holds
_PIECES = 1 << 19  # of sides, cut at a time
_NODES = (0.5 - 12**-0.5, 0.5 + 12**-0.5)


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
        beside = np.sort(np.stack([row[side], self.cells.beyond[side]], axis=1), axis=1)
        pairs, total = sums_by_pair(beside, held)
        return pairs[:, 0], pairs[:, 1], total

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
    def _sides(self) -> tuple[Integers, Floats, Floats]:
        """The row of each side, its start and its end."""
        cells = self.cells
        end = cells.corners[following_corners(cells.ring_corners)]
        return rows_of_corners(cells), cells.corners, end

    @cached_property
    def _integrals(self) -> Floats:
        """Mass, first and second moments of each cell, in pixels from the corner of the box."""
        row, start, end = self._sides
        of_sides = self._image.integrals(start, end)
        count = len(self.cells.points)
        return np.stack([np.bincount(row, each, minlength=count) for each in of_sides.T], axis=1)


def energy(cells: Cells) -> float:
    """Integrate the squared distance to the row of each cell."""
    start, end = cells.sides
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
    low, high = np.reshape(domain.bounds, (2, 2))
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


def as_share(value: object, most: float) -> float:
    """Convert a tolerance that is a share; where it is limited it must be positive."""
    is_limited = most < np.inf
    wanted = f"a number between 0 and {most}" if is_limited else "a number from 0"

    def is_wanted(share: float) -> bool:
        return 0 <= share < most and (share > 0 or not is_limited)

    return as_number("tol", value, wanted, is_wanted)


def as_density(given: Any, domain: Domain) -> Density:
    """Convert the option ``density``."""
    low, high = np.reshape(domain.bounds, (2, 2))
    if isinstance(given, tuple) and len(given) == 2 and np.shape(given[1]) == (4,):
        given, box = given
        low, high = as_reals(box).reshape(2, 2)
        if not (np.isfinite(high - low).all() and (high > low).all()):
            raise InputError(f"the box of density is {shown(box)}: give xmin, ymin, xmax, ymax")
    values = _values(given)
    pixel = (high - low) / values.shape[::-1]
    return Density(read_only(values[::-1]), low, pixel)


def _values(given: Any) -> Array:
    values = as_numbers("density", given, "give an image, as an array")
    if values.ndim != 2 or not values.size:
        hint = "; of colours, their mean" if values.ndim == 3 else ""
        raise InputError(f"density has the shape {values.shape}: give an (h, w) array{hint}")
    bad = ~((values >= 0) & (values <= 2.0**200))
    if bad.any():
        row, column = np.unravel_index(int(bad.argmax()), bad.shape)
        raise InputError(
            f"density is {float(values[row, column])!r} in row {row}, column {column}: give "
            "numbers from 0"
        )
    return values


@dataclass(frozen=True)
class Density:
    """An image over a box, and 0 outside."""

    values: Floats  # of each pixel; the first row is the lowest
    low: Floats  # the lower left corner of the box
    pixel: Floats  # width and height
    _padded: Floats = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_padded", np.pad(self.values, 1))

    @cached_property
    def _sums(self) -> tuple[Floats, Floats, Floats]:
        """Integrals of the density times 1, u and u^2 up to the left side of each pixel."""
        left = np.arange(-1.0, self.values.shape[1] + 1)
        widths = (np.ones_like(left), left + 0.5, ((left + 1) ** 3 - left**3) / 3)
        sums = (np.cumsum(self._padded * width, axis=1) for width in widths)
        before = tuple(np.pad(each, ((0, 0), (1, 0)))[:, :-1] for each in sums)
        return before[0], before[1], before[2]

    def integrals(self, start: Floats, end: Floats) -> Floats:
        """Integrate along sides what Green's theorem asks for, (k, 5)."""
        # Added up around a polygon: its mass, its first moments and its second ones in x and y, in
        # units of pixels from the lower left corner of the box.
        return self._along(start, end, self._integrals, 5)

    def means(self, start: Floats, end: Floats) -> Floats:
        """Average the density along sides, (k,)."""
        return self._along(start, end, self._values_there, 1)[:, 0]

    def _along(
        self, start: Floats, end: Floats, integrand: Callable[..., list[Floats]], count: int
    ) -> Floats:
        """Add up an integrand over the pieces of each side, block by block."""
        begin, step = (start - self.low) / self.pixel, (end - start) / self.pixel
        most = np.minimum(np.abs(step), self.values.shape[::-1]).sum(axis=1) + 4
        blocks = np.unique(np.searchsorted(np.cumsum(most), np.arange(0, most.sum(), _PIECES)))
        sums = np.empty((len(start), count))
        for first, last in pairwise([*blocks.tolist(), len(start)]):
            block = slice(first, last)
            side, one, other = self._cut(begin[block], step[block])
            ends = (
                begin[block][side] + share[:, None] * step[block][side] for share in (one, other)
            )
            for k, each in enumerate(integrand(*ends, other - one)):
                sums[block, k] = np.bincount(side, each, minlength=last - first)
        return sums

    def _cut(self, begin: Floats, step: Floats) -> tuple[NDArray[np.intp], Floats, Floats]:
        """Cut sides at the lines between pixels: the side of each piece, and its shares of it."""
        side = np.arange(len(begin))
        sides, shares = [side, side], [np.zeros(len(begin)), np.ones(len(begin))]
        for axis, count in enumerate(self.values.shape[::-1]):
            of, share = _crossings(begin[:, axis], step[:, axis], count)
            sides.append(of)
            shares.append(share)
        side, share = np.concatenate(sides), np.concatenate(shares)
        order = np.lexsort((share, side))
        side, share = side[order], share[order]
        inner = side[:-1] == side[1:]
        return side[:-1][inner], share[:-1][inner], share[1:][inner]

    def _pixels(self, at: Floats) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Row and column among the padded values."""
        height, width = self.values.shape
        column, row = (
            np.clip(np.floor(at[:, axis]), -1, most).astype(np.intp) + 1
            for axis, most in enumerate((width, height))
        )
        return row, column

    def _values_there(self, one: Floats, other: Floats, share: Floats) -> list[Floats]:
        return [self._padded[self._pixels((one + other) / 2)] * share]

    def _integrals(self, one: Floats, other: Floats, _share: Floats) -> list[Floats]:
        row, column = self._pixels((one + other) / 2)
        value, left = self._padded[row, column], column - 1.0
        mass, first, second = (sums[row, column] for sums in self._sums)
        total = np.zeros((5, len(row)))
        for node in _NODES:
            u, v = (one + node * (other - one)).T
            flow = mass + value * (u - left)
            total[0] += flow
            total[1] += first + value * (u**2 - left**2) / 2
            total[2] += v * flow
            total[3] += second + value * (u**3 - left**3) / 3
            total[4] += v * v * flow
        return [*(total * (other[:, 1] - one[:, 1]) / 2)]


def _crossings(begin: Floats, step: Floats, count: int) -> tuple[NDArray[np.intp], Floats]:
    """Where sides cross the lines 0 to `count` of one axis: which side, and at what share of it."""
    low, high = np.minimum(begin, begin + step), np.maximum(begin, begin + step)
    first = np.clip(np.floor(low) + 1, 0, count + 1)
    last = np.clip(np.ceil(high) - 1, -1, count)
    number = np.maximum(last - first + 1, 0).astype(np.int64)
    side = np.repeat(np.arange(len(begin)), number)
    line = places(first.astype(np.int64), number)
    share = (line - begin[side]) / step[side]
    return side, np.clip(share, 0.0, 1.0)
