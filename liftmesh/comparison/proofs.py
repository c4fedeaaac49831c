"""Exact proofs that triangles are or are not Delaunay, in rational numbers without rounding.

The in-circle determinant of counter-clockwise a, b, c and a point d is computed with `fractions`
from the unchanged doubles. It is positive if and only if d lies strictly inside the circle
through a, b and c, that is, if and only if the lifted d lies strictly below their plane
(Lemma 4.2): then no lower facet has the corners a, b, c.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from itertools import islice
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Floats, Rows
from liftmesh.comparison.differences import Cells, opposite_rows
from liftmesh.predicates import incircle, orient2d

if TYPE_CHECKING:
    from liftmesh.comparison.differences import Differences
    from liftmesh.planar.triangulation import Triangulation

Claim = Literal["wrong facet", "broken cell", "right triangle", "wrong triangle"]

_SENTENCES: dict[Claim, str] = {
    "wrong facet": (
        "trimesh's facet {rows} is wrong: row {row} lies strictly inside its circle, "
        "in-circle determinant {value} > 0"
    ),
    "broken cell": (
        "trimesh's facet {rows} has an empty circle, but trimesh's facets overlap or leave a gap "
        "among the cocircular points around it"
    ),
    "right triangle": (
        "liftmesh's triangle {rows} is correct and missing from trimesh's hull: none of the other "
        "{tested:,} points lies strictly inside its circle; determinants across its edges: {values}"
    ),
    "wrong triangle": (
        "liftmesh's triangle {rows} is wrong: row {row} lies strictly inside its circle, "
        "in-circle determinant {value} > 0"
    ),
}


@dataclass(frozen=True, slots=True)
class Proof:
    """An exact statement about one triangle."""

    claim: Claim
    rows: tuple[int, int, int]  # counter-clockwise
    determinants: tuple[tuple[int, Fraction], ...]  # of the row inside, or of those across edges
    tested: int  # other points, all exactly

    def __str__(self) -> str:
        row, value = self.determinants[0] if self.determinants else (-1, Fraction(0))
        values = ", ".join(f"{as_short(value)} (row {row})" for row, value in self.determinants)
        return _SENTENCES[self.claim].format(
            rows=self.rows, row=row, value=as_short(value), values=values, tested=self.tested
        )


def as_short(value: Fraction) -> str:
    """Format a number exactly if that is short, otherwise its leading digits."""
    exact = str(value)
    if len(exact) <= 12:
        return exact
    return f"{Decimal(value.numerator) / Decimal(value.denominator):.5e}"


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """The data for proofs."""

    triangulation: Triangulation
    rows: Rows
    lower: Rows
    cells: Cells
    differences: Differences

    def proofs(self, limit: int) -> list[Proof]:
        """Prove the first differences: liftmesh's errors if any, then half of each kind."""
        faults = list(islice(self._faults(), limit))
        limit -= len(faults)
        for_wrong = limit - min(limit // 2, len(self.differences.missing))
        wrong = list(islice(self._wrong(), for_wrong))
        return [*faults, *wrong, *islice(self._missing(), limit - len(wrong))]

    def _faults(self) -> Iterator[Proof]:
        """Refute triangles of liftmesh that are not Delaunay."""
        simplices, points = self.triangulation.simplices, self.triangulation.points
        for index, _ in self.cells.violations:
            proof = refute(points, self.rows, simplices[index], claim="wrong triangle")
            if proof is not None:  # pragma: no branch - there is always one
                yield proof

    def _wrong(self) -> Iterator[Proof]:
        """Refute facets of trimesh: by a point inside their circle, or by their cell."""
        facets = self.lower[self.differences.wrong]
        for facet, cell in zip(facets, self.differences.wrong_cell, strict=True):
            proof = refute(self.triangulation.points, self.rows, facet) if cell < 0 else None
            yield proof or broken_cell(facet)

    def _missing(self) -> Iterator[Proof]:
        """Confirm triangles of liftmesh that trimesh lacks."""
        simplices, points = self.triangulation.simplices, self.triangulation.points
        for index in self.differences.missing:
            proof = confirm(points, self.rows, simplices[index], self._apexes(int(index)))
            if proof is not None:
                yield proof

    def _apexes(self, index: int) -> list[int]:
        """Return the rows opposite the edges of a triangle that have a neighbour."""
        neighbors = self.triangulation.neighbors[index]
        edge = np.flatnonzero(neighbors >= 0)
        triangle = np.full(len(edge), index, dtype=np.intp)
        apexes = opposite_rows(self.triangulation.simplices, triangle, edge, neighbors[edge])
        return [int(row) for row in apexes]


def incircle_determinant(points: Floats, rows: Sequence[int]) -> Fraction:
    """Compute the exact in-circle determinant of four rows."""
    (ax, ay), (bx, by), (cx, cy), (dx, dy) = (map(Fraction, points[row].tolist()) for row in rows)
    ax, ay, bx, by, cx, cy = ax - dx, ay - dy, bx - dx, by - dy, cx - dx, cy - dy
    a, b, c = ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy
    return a * (bx * cy - by * cx) - b * (ax * cy - ay * cx) + c * (ax * by - ay * bx)


def refute(
    points: Floats, rows: Rows, triangle: Rows, *, claim: Claim = "wrong facet"
) -> Proof | None:
    """Prove that a triangle is not Delaunay by a point strictly inside its circle."""
    inside = rows[_signs(points, rows, triangle) > 0]
    if len(inside) == 0:
        return None
    corners = _as_tuple(triangle)
    witness = int(inside[_deepest(points, inside, triangle)])
    determinant = incircle_determinant(points, (*corners, witness))
    return Proof(claim, corners, ((witness, determinant),), len(rows) - 3)


def confirm(points: Floats, rows: Rows, triangle: Rows, apexes: Sequence[int]) -> Proof | None:
    """Prove that a triangle is Delaunay: no row lies strictly inside its circle."""
    if (_signs(points, rows, triangle) > 0).any():
        return None
    corners = _as_tuple(triangle)
    determinants = tuple((row, incircle_determinant(points, (*corners, row))) for row in apexes)
    return Proof("right triangle", corners, determinants, len(rows) - 3)


def broken_cell(triangle: Rows) -> Proof:
    """Return the proof that a facet is Delaunay, but its cell is not covered exactly once."""
    return Proof("broken cell", _as_tuple(triangle), (), 0)


def _signs(points: Floats, rows: Rows, triangle: Rows) -> NDArray[np.int8]:
    """Return the exact in-circle signs of the rows; check that the triangle is oriented."""
    a, b, c = points[triangle]
    if orient2d(a, b, c) <= 0:
        message = f"triangle {_as_tuple(triangle)} is not counter-clockwise"
        raise AssertionError(message)
    return incircle(a, b, c, points[rows])


def _deepest(points: Floats, inside: Rows, triangle: Rows) -> int:
    """Return the index of the row with the largest rounded determinant; any choice is valid."""
    with np.errstate(all="ignore"):
        corners = points[triangle] - points[inside][:, None, :]
        (ax, bx, cx), (ay, by, cy) = corners[..., 0].T, corners[..., 1].T
        a, b, c = (corners**2).sum(axis=2).T
        depth = a * (bx * cy - by * cx) - b * (ax * cy - ay * cx) + c * (ax * by - ay * bx)
    return int(np.argmax(np.nan_to_num(depth)))


def _as_tuple(triangle: Rows) -> tuple[int, int, int]:
    a, b, c = triangle.tolist()
    return a, b, c
