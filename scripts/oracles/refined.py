"""What must hold of a refined triangulation, in integers: angles, chains of parts, and causes.

Nothing here is shared with the program. Points are pairs of integers, as in `oracles.planar`.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from typing import Any

from numpy.typing import NDArray
from oracles.planar import Point, cross, dot, exact

Rows = tuple[int, int]

FINE, FORCED, CAPPED, PRECISION = range(4)  # causes
SLACK = 10**12  # what doubles tell of squares of cosines, in ones of it
NEAR = 2**50  # of which the greatest coordinate is as many as a point may be from its line, or more


@dataclass(frozen=True)
class Refined:
    """Triangles inside, and what became of pieces: pairs of rows, and rows that divide them."""

    points: NDArray[Any]
    simplices: NDArray[Any]
    constraints: NDArray[Any]  # all edges that are parts of pieces
    causes: NDArray[Any]  # of each triangle
    pieces: NDArray[Any]
    divided: NDArray[Any]  # the piece of each of the last points, or -1
    before: NDArray[Any]  # the triangles that were refined
    cosine: float
    largest: float | None = None
    is_capped: bool = False

    @cached_property
    def at(self) -> list[Point]:
        return exact([*self.points.tolist()])

    @cached_property
    def chains(self) -> dict[Rows, list[int]]:
        """The rows along each piece, from its first end to its other end."""
        ends: list[Rows] = [(a, b) for a, b in self.pieces.tolist()]
        own: dict[Rows, set[int]] = {piece: set() for piece in ends}
        for row, piece in enumerate(self.divided.tolist(), self.given):
            if piece >= 0:
                own[ends[piece]].add(row)
        beside = defaultdict(set)
        for a, b in self.constraints.tolist():
            beside[a].add(b)
            beside[b].add(a)
        return {piece: _chain(*piece, rows, beside) for piece, rows in own.items()}

    @property
    def given(self) -> int:
        """The number of points that were not added."""
        return len(self.points) - len(self.divided)

    def check(self) -> None:
        """Assert that the triangles fill the same domain, and that each is fine or has a cause."""
        self._check_chains()
        self._check_domain()
        for corners, cause in zip(self.simplices.tolist(), self.causes.tolist(), strict=True):
            self._check_triangle(corners, cause)

    def _check_chains(self) -> None:
        parts = {_sorted(*part) for chain in self.chains.values() for part in pairwise(chain)}
        found = {_sorted(a, b) for a, b in self.constraints.tolist()}
        assert parts == found, f"parts {sorted(parts ^ found)[:4]} are not those of the pieces"
        unit = max(abs(value) for point in self.at for value in point) // NEAR
        for (a, b), rows in self.chains.items():
            far2 = self._length2(a, b) * unit**2
            for row, following in pairwise(rows):
                off = cross(self.at[a], self.at[b], self.at[row])
                assert off**2 <= far2, f"row {row} is off its piece {a, b}"
                on = self._along(a, b, following) - self._along(a, b, row)
                assert on > 0 or on**2 <= far2, f"row {following} is before {row} on {a, b}"

    def _along(self, a: int, b: int, row: int) -> int:
        return dot(self.at[a], self.at[b], self.at[row])

    def _check_domain(self) -> None:
        directed = {
            part
            for a, b in _boundary(self.before.tolist())
            for part in pairwise(self._between(a, b))
        }
        assert directed == _boundary(self.simplices.tolist()), "another domain"

    def _between(self, a: int, b: int) -> list[int]:
        return self.chains[a, b] if a < b else self.chains[b, a][::-1]

    def _check_triangle(self, corners: list[int], cause: int) -> None:
        a, b, c = (self.at[row] for row in corners)
        area = cross(a, b, c)
        assert area > 0, f"{corners} is not counter-clockwise"
        base = min(range(3), key=lambda k: self._length2(corners[k - 2], corners[k - 1]))
        apex, one, other = corners[base], corners[base - 2], corners[base - 1]
        excess, whole = self._sharpness(apex, one, other)
        assert cause != FINE or excess * SLACK <= whole, f"{corners} lacks a cause"
        assert cause == FINE or excess * SLACK >= -whole, (
            f"{corners} has a cause, but no small angle"
        )
        if cause == FORCED:
            assert self._is_forced(one, other), f"no input angle forces {corners}"
        assert cause != CAPPED or self.is_capped, f"{corners} blames a cap"

    def _length2(self, a: int, b: int) -> int:
        return dot(self.at[a], self.at[b], self.at[b])

    def _sharpness(self, apex: int, one: int, other: int) -> tuple[int, int]:
        """How much the cosine's square is beyond that of the bound, and what it is a share of."""
        top, bottom = self.squared_cosine
        product = max(dot(self.at[apex], self.at[one], self.at[other]), 0)
        squares = self._length2(apex, one) * self._length2(apex, other)
        return product**2 * bottom - top * squares, bottom * squares

    @cached_property
    def squared_cosine(self) -> Rows:
        return (Fraction(self.cosine) ** 2).as_integer_ratio()

    def _is_forced(self, one: int, other: int) -> bool:
        """Whether rows are on pieces with a common end and less than 60 degrees between them."""
        for p in self.pieces_of[one]:
            for q in self.pieces_of[other]:
                for corner in {*p} & {*q} if p != q else ():
                    far = [end for piece in (p, q) for end in piece if end != corner]
                    product = dot(self.at[corner], self.at[far[0]], self.at[far[1]])
                    squares = self._length2(corner, far[0]) * self._length2(corner, far[1])
                    if product > 0 and 4 * product**2 * SLACK > squares * (SLACK - 1):
                        return True
        return False

    @cached_property
    def pieces_of(self) -> list[list[Rows]]:
        """The pieces on which each row is."""
        found: list[list[Rows]] = [[] for _ in self.at]
        for (a, b), rows in self.chains.items():
            for row in rows:
                found[row].append((a, b))
        return found


def _chain(a: int, b: int, rows: set[int], beside: dict[int, set[int]]) -> list[int]:
    """Walk from one end to the other along the rows that divide a piece, each once."""
    found, rest = [a], rows.copy()
    while rest:
        onward = beside[found[-1]] & rest
        assert len(onward) == 1, f"the chain from {a} to {b} forks or ends at {found[-1]}"
        found += onward
        rest -= onward
    return [*found, b]


def _sorted(a: int, b: int) -> Rows:
    return min(a, b), max(a, b)


def _boundary(triangles: list[list[int]]) -> set[Rows]:
    """The directed edges with a triangle on their left only."""
    edges = [(t[k - 2], t[k - 1]) for t in triangles for k in range(3)]
    found = set(edges)
    assert len(found) == len(edges), "two triangles are on one side of an edge"
    return {(a, b) for a, b in found if (b, a) not in found}
