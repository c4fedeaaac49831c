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

FINE, FORCED, CAPPED, PRECISION = "", "input angle", "cap", "precision"  # causes
NEAR = 2**50  # points are at most this part of the greatest coordinate from their line


@dataclass(frozen=True)
class Refined:
    """The result, the triangulation before, why each triangle is as it is, and the cosine."""

    result: Any
    before: Any
    causes: NDArray[Any]  # of each triangle
    cosine: float
    told: str = ""  # by warnings

    @property
    def points(self) -> NDArray[Any]:
        return self.result.triangulation.points

    @property
    def simplices(self) -> NDArray[Any]:
        return self.result.triangulation.simplices

    @cached_property
    def at(self) -> list[Point]:
        return exact(self.points.tolist())

    @cached_property
    def chains(self) -> dict[Rows, list[int]]:
        """The rows from each row before to the next one along constraints."""
        beside = defaultdict(list)
        for a, b in self.result.triangulation.constraints.tolist():
            beside[a].append(b)
            beside[b].append(a)
        for row in self.result.steiner[self.result.steiner_edges < 0].tolist():
            assert row not in beside, f"row {row} is on a constraint"
        found: dict[Rows, list[int]] = {}
        for start in [row for row in beside if row < self.given]:
            for chain in (self._chain(start, onward, beside) for onward in beside[start]):
                assert (start, chain[-1]) not in found, f"two chains from {start} to {chain[-1]}"
                found[start, chain[-1]] = chain
        return found

    def _chain(self, start: int, onward: int, beside: dict[int, list[int]]) -> list[int]:
        found = [start, onward]
        while found[-1] >= self.given:
            back, *others = sorted(beside[found[-1]], key=lambda row: row != found[-2])
            assert (back, len(others)) == (found[-2], 1), f"the chain forks at {found[-1]}"
            found += others
        return found

    @property
    def given(self) -> int:
        """The number of points that were not added."""
        return self.before.npoints

    @cached_property
    def pieces(self) -> set[Rows]:
        """What the parts must make up: constraints before, and sides of the boundary."""
        sides = {*map(tuple, self.before.constraints.tolist())}
        return sides | {_sorted(*side) for side in _boundary(self.before.simplices.tolist())}

    def check(self) -> None:
        """Assert that the triangles fill the same domain, and that each is fine or has a cause."""
        assert {_sorted(*ends) for ends in self.chains} == self.pieces, "other chains than pieces"
        for chain in self.chains.values():
            self._check_chain(chain)
        assert self._domain() == _boundary(self.simplices.tolist()), "another domain"
        for corners, cause in zip(self.simplices.tolist(), self.causes.tolist(), strict=True):
            self._check_triangle(corners, cause)

    def check_smoothed(self, plain: Refined) -> None:
        """Assert that only rows between edges moved, and no smallest angle or cause got worse."""
        edges = self.result.steiner_edges
        assert edges.tolist() == plain.result.steiner_edges.tolist(), "other rows are added"
        free = {*self.result.steiner[edges < 0].tolist()}
        moved = {*(self.points != plain.points).any(axis=1).nonzero()[0].tolist()}
        assert moved <= free, f"rows {moved - free} moved"
        assert self.sharpest <= plain.sharpest, "the smallest angle got smaller"
        for cause in (CAPPED, PRECISION):
            count, before_it = ((each.causes == cause).sum() for each in (self, plain))
            assert count <= before_it, f"there are more with the cause {cause!r}"

    @property
    def sharpest(self) -> Fraction:
        """The square of the largest cosine."""
        return max(self._squared_cosine(*corners) for corners in self.simplices.tolist())

    def _squared_cosine(self, *corners: int) -> Fraction:
        a, b, c = sorted(corners)
        sides = sorted(self._length2(*ends) for ends in ((a, b), (b, c), (c, a)))
        twice_dot = sides[1] + sides[2] - sides[0]
        return Fraction(twice_dot**2, 4 * sides[1] * sides[2])

    def _check_chain(self, chain: list[int]) -> None:
        """Assert that rows are in order and on their piece, but for rounding."""
        a, b = chain[0], chain[-1]
        far2 = self._length2(a, b) * self._greatest**2
        for row, following in pairwise(chain):
            off = cross(self.at[a], self.at[b], self.at[row])
            assert (NEAR * off) ** 2 <= far2, f"row {row} is off its piece {a, b}"
            on = self._along(a, b, following) - self._along(a, b, row)
            assert on > 0 or (NEAR * on) ** 2 <= far2, f"row {following} is before {row} on {a, b}"

    @cached_property
    def _greatest(self) -> int:
        return max(abs(value) for point in self.at for value in point)

    def _along(self, a: int, b: int, row: int) -> int:
        return dot(self.at[a], self.at[b], self.at[row])

    def _domain(self) -> set[Rows]:
        """The boundary before, in parts."""
        sides = _boundary(self.before.simplices.tolist())
        return {part for side in sides for part in pairwise(self.chains[side])}

    def _check_triangle(self, corners: list[int], cause: int) -> None:
        a, b, c = (self.at[row] for row in corners)
        area = cross(a, b, c)
        assert area > 0, f"{corners} is not counter-clockwise"
        lengths2 = [self._length2(corners[k - 2], corners[k - 1]) for k in range(3)]
        least = min(lengths2)
        bases = [k for k in range(3) if (lengths2[k] - least) * NEAR <= least]  # but for rounding
        ends = [(corners[k - 2], corners[k - 1]) for k in bases]
        is_sharp = any(self._is_sharp(corners[k], *ends[i]) for i, k in enumerate(bases))
        assert is_sharp == (cause != FINE), f"{corners} has the cause {cause!r}"
        is_forced = any(self._is_forced(*each) for each in ends)
        assert cause != FORCED or is_forced, f"no input angle forces {corners}"
        assert cause != CAPPED or self.result.capped, f"{corners} blames a cap"

    def _length2(self, a: int, b: int) -> int:
        return dot(self.at[a], self.at[b], self.at[b])

    def _is_sharp(self, apex: int, one: int, other: int) -> bool:
        """Whether the cosine is beyond that of the bound."""
        top, bottom = self.squared_cosine
        product = dot(self.at[apex], self.at[one], self.at[other])
        squares = self._length2(apex, one) * self._length2(apex, other)
        return product > 0 and product**2 * bottom > top * squares

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
                    if product > 0 and 4 * product**2 > squares:
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


def _sorted(a: int, b: int) -> Rows:
    return min(a, b), max(a, b)


def _boundary(triangles: list[list[int]]) -> set[Rows]:
    """The directed edges with a triangle on their left only."""
    edges = [(t[k - 2], t[k - 1]) for t in triangles for k in range(3)]
    found = set(edges)
    assert len(found) == len(edges), "two triangles are on one side of an edge"
    return {(a, b) for a, b in found if (b, a) not in found}
