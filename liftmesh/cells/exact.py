"""Corners of clipped cells as exact rationals, from where they come from.

Nearly all corners are known well enough without. These are for the few whose rounding is in doubt,
and for rings in which corners seem to coincide, or sides to overlap.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from liftmesh.cells.domain import Domain
    from liftmesh.cells.dual import Dual

Exact = tuple[Fraction, Fraction]


def turn(a: Exact, b: Exact, c: Exact) -> Fraction:
    """Twice the signed area of a triangle."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def doubled_area(ring: Sequence[Exact]) -> Fraction:
    """Twice the signed area of a polygon."""
    pairs = zip(ring, (*ring[1:], *ring[:1]), strict=True)
    return sum((a[0] * b[1] - a[1] * b[0] for a, b in pairs), Fraction(0))


def is_within(point: Exact, a: Exact, b: Exact) -> bool:
    """Whether a point on the line through two others is strictly between them."""
    return all(
        (point[i] - p[i]) * (q[i] - p[i]) >= 0 and point != p
        for p, q in ((a, b), (b, a)) for i in (0, 1)
    )  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class DomainCorners(ABC):
    """Corners of clipped cells: those of the domain are the same whatever the cells."""

    domain: Domain

    @abstractmethod
    def at(self, cell: int, edge: int, other: int) -> Exact:
        """Compute a corner."""

    def ends(self, edge: int) -> tuple[Exact, Exact]:
        """Return the ends of an edge of the domain."""
        corners, starts = self.domain.corners, self.domain.starts
        after, ring = edge + 1, int(np.searchsorted(starts, edge + 1))
        if starts[ring] == after:
            after = int(starts[ring - 1])
        return as_exact(corners[edge]), as_exact(corners[after])


@dataclass(frozen=True, slots=True, eq=False)
class ExactCorners(DomainCorners):
    """Corners of clipped Voronoi or power cells."""

    dual: Dual

    def at(self, cell: int, edge: int, other: int) -> Exact:
        """Compute a corner."""
        if edge < 0:
            return self._centre(self.dual.simplices[other].tolist())
        start, end = self.ends(edge)
        return start if other < 0 else self._crossing(start, end, cell, other)

    def _crossing(self, start: Exact, end: Exact, cell: int, other: int) -> Exact:
        a, b, c = self._axis(cell, other)
        first, last = a * start[0] + b * start[1] - c, a * end[0] + b * end[1] - c
        share = first / (first - last)
        return start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])

    def _centre(self, rows: Sequence[int]) -> Exact:
        a, b, p = self._axis(rows[0], rows[1])
        c, d, q = self._axis(rows[0], rows[2])
        determinant = a * d - b * c
        return (p * d - b * q) / determinant, (a * q - p * c) / determinant

    def _axis(self, row: int, other: int) -> tuple[Fraction, Fraction, Fraction]:
        """Coefficients a, b, c of the line a x + b y = c of equal power to two rows."""
        (x, y), (u, v) = as_exact(self.dual.points[row]), as_exact(self.dual.points[other])
        height = u * u + v * v - x * x - y * y - self._lowering(other) + self._lowering(row)
        return 2 * (u - x), 2 * (v - y), height

    def _lowering(self, row: int) -> Fraction:
        if self.dual.kind == "plain":
            return Fraction(0)
        value = Fraction(float(self.dual.values[row]))
        return value * value if self.dual.kind == "radii" else value


def as_exact(point: Sequence[float]) -> Exact:
    """The coordinates of a point as rationals."""
    return Fraction(float(point[0])), Fraction(float(point[1]))
