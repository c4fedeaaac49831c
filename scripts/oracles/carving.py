"""What carving leaves of triangles, by its definition in exact integers.

A wall is a side of a triangle on an edge that bounds regions. "outside" removes what is reached
from beyond the hull without crossing a wall. "holes" leaves, where there are polygons, the
triangles around which outer rings wind more often than holes, as a ray from the centre of a
triangle tells. Otherwise it leaves those that are an odd number of walls away from
beyond the hull, by the shortest way; where an even number of walls meets at every corner, the ray
must tell the same. A seed removes what is reached from it without crossing a wall.

Ways are found by trying all sides until nothing changes. Nothing here is shared with the program.
Points are pairs of integers, as in `oracles.planar`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence, Set as AbstractSet
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

from oracles.constrained import Rows, is_between
from oracles.planar import Edge, Point, Triangle, cross, exact

Side = frozenset[Point]
Ring = tuple[bool, int, Sequence[Point]]  # whether a hole; 1, or -1 if clockwise; first = last


@dataclass(frozen=True)
class Given:
    """Constraints as rows; rings of polygons may repeat their first row."""

    edges: Sequence[Rows]
    polylines: Sequence[Sequence[int]]
    polygons: Sequence[Sequence[Sequence[int]]]

    @property
    def chains(self) -> list[Sequence[int]]:
        """All as chains of rows, in the order of their edges."""
        return [*self.edges, *self.polylines, *(ring for _, ring in self.rings)]

    @property
    def rings(self) -> list[tuple[bool, Sequence[int]]]:
        """Whether each ring is a hole, and its rows from its first one back to it."""
        return [
            (k > 0, ring if ring[0] == ring[-1] else [*ring, ring[0]])
            for polygon in self.polygons
            for k, ring in enumerate(polygon)
        ]

    def bounding(self, points: Sequence[Point]) -> list[bool]:
        """Whether each chain bounds regions."""
        edges, lines = len(self.edges), self.polylines
        rings = sum(map(len, self.polygons))
        closed = [points[line[0]] == points[line[-1]] for line in lines]
        is_wall = [not rings] * edges
        is_wall += [not rings and not edges and each for each in closed]
        return is_wall + [True] * rings


@dataclass(frozen=True)
class Carving:
    """Triangles of a whole hull, and what bounds regions there."""

    triangles: Sequence[Triangle]
    walls: AbstractSet[Side]
    rings: Sequence[Ring] | None  # None: there are no polygons

    @cached_property
    def triangle_of(self) -> dict[Edge, int]:
        """The triangle on the left of each side."""
        return {side: t for t, corners in enumerate(self.triangles) for side in sides_of(corners)}

    @cached_property
    def depths(self) -> list[int]:
        """The number of walls on the shortest way from beyond the hull to each triangle."""
        found, changes = [len(self.walls) + 1] * len(self.triangles), True
        while changes:
            changes = False
            for (a, b), t in self.triangle_of.items():
                before = found[other] if (other := self.triangle_of.get((b, a))) is not None else 0
                if (depth := before + ({a, b} in self.walls)) < found[t]:
                    found[t], changes = depth, True
        return found

    def left(self, carve: str | None, seeds: Sequence[Point]) -> set[int]:
        """Return the triangles that are left."""
        every = range(len(self.triangles))
        by = {"outside": self._is_enclosed, "holes": self._is_inside, None: every.__contains__}
        seeded = {t for seed in seeds for t in self.around(seed)}
        return {t for t in every if by[carve](t)} - self.reached(seeded)

    def _is_enclosed(self, t: int) -> bool:
        return self.depths[t] > 0

    def _is_inside(self, t: int) -> bool:
        centre = _sum(*self.triangles[t])
        if self.rings is not None:
            numbers = [0, 0]
            for is_hole, sign, ring in self.rings:
                numbers[is_hole] += sign * winding(ring, centre)
            return abs(numbers[0]) > abs(numbers[1])
        is_odd = self.depths[t] % 2 == 1
        if self._is_even:
            assert is_odd == sum(abs(winding((*wall,), centre)) for wall in self.walls) % 2
        return is_odd

    @cached_property
    def _is_even(self) -> bool:
        degrees = Counter(corner for wall in self.walls for corner in wall)
        return all(degree % 2 == 0 for degree in degrees.values())

    def reached(self, start: Iterable[int]) -> set[int]:
        """Return the triangles that are reached from some without crossing a wall."""
        found = {*start}
        waiting = [*found]
        while waiting:
            for a, b in sides_of(self.triangles[waiting.pop()]):
                other = self.triangle_of.get((b, a))
                if other is not None and {a, b} not in self.walls and other not in found:
                    found.add(other)
                    waiting.append(other)
        return found

    def around(self, p: Point) -> list[int]:
        """List the triangles that a point is in, or on the border of."""
        return [
            t
            for t, corners in enumerate(self.triangles)
            if all(cross(a, b, p) >= 0 for a, b in sides_of(corners))
        ]

    def is_misplaced(self, seed: Point) -> bool:
        """Whether a seed is outside of all triangles, or on a wall."""
        return not self.around(seed) or any(is_between(*wall, seed) for wall in self.walls)


def sides_of(t: Triangle) -> list[Edge]:
    return [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]


def winding(chain: Sequence[Point], centre: Point) -> int:
    """Return how often a chain crosses the ray to the right upwards, rather than downwards.

    The coordinates of the centre are times three.
    """
    number = 0
    for a, b in pairwise((3 * x, 3 * y) for x, y in chain):
        if a[1] <= centre[1] < b[1] and cross(a, b, centre) > 0:
            number += 1
        elif b[1] <= centre[1] < a[1] and cross(a, b, centre) < 0:
            number -= 1
    return number


def turn(ring: Sequence[Point]) -> int:
    """Return -1 for a closed ring that turns clockwise, else 1."""
    return -1 if sum(a[0] * b[1] - a[1] * b[0] for a, b in pairwise(ring)) < 0 else 1


def _sum(*points: Point) -> Point:
    return sum(x for x, _ in points), sum(y for _, y in points)


def carving_of(whole: Any, given: Given, points: Sequence[Point]) -> Carving:
    """Take the triangles and pieces of a triangulation; points are its rows.

    An edge that was split at crossings bends: then it is the chain of its pieces.
    """
    pieces = [(points[a], points[b]) for a, b in whole.constraints.tolist()]
    parts: dict[int, list[Edge]] = {}
    for piece, ends in enumerate(pieces):
        for edge in whole.inputs_of(piece).tolist():
            parts.setdefault(edge, []).append(ends)
    walls: set[Side] = set()
    bent_chains = []
    edges = iter(range(len(whole.input_edges)))
    for chain, bounds in zip(given.chains, given.bounding(points), strict=True):
        bent = [points[chain[0]]]
        for _, head in pairwise(chain):
            along = parts.get(next(edges), [])
            walls |= {frozenset(ends) for ends in along if bounds}
            bent += walked(bent[-1], points[head], along)
        bent_chains.append(bent)
    open_ones = len(given.edges) + len(given.polylines)
    rings = [
        (is_hole, turn([points[row] for row in ring]), bent)
        for (is_hole, ring), bent in zip(given.rings, bent_chains[open_ones:], strict=True)
    ]
    triangles = [tuple(points[row] for row in rows) for rows in whole.simplices.tolist()]
    return Carving(triangles, walls, rings if given.polygons else None)


def walked(start: Point, end: Point, parts: Sequence[Edge]) -> list[Point]:
    """Order the parts of an edge from its start to its end, and return where each ends."""
    left, at, found = [*parts], start, []
    while left:
        on = next(part for part in left if at in part)
        left.remove(on)
        at = on[1] if on[0] == at else on[0]
        found.append(at)
    assert at == end, "the pieces of an edge are no way to its end"
    return found


def check_carved(whole: Any, given: Given, carve: str | None, seeds: Any, carved: Any) -> None:
    """Assert that a carved triangulation is what is left of the whole one.

    It is None if nothing is left, or a seed is misplaced.
    """
    every = exact([*whole.points.tolist(), *seeds])
    points, places = every[: len(whole.points)], every[len(whole.points) :]
    carving = carving_of(whole, given, points)
    if any(map(carving.is_misplaced, places)):
        assert carved is None, "a misplaced seed is taken"
        return
    left = sorted(carving.left(carve, places))
    assert (carved is None) == (not left), f"{len(left)} triangles are left"
    if carved is None:
        return
    assert carved.simplices.tolist() == whole.simplices[left].tolist()
    pieces = {frozenset((points[a], points[b])) for a, b in whole.constraints.tolist()}
    separated = Carving([carving.triangles[t] for t in left], pieces, None)
    assert carved.regions.tolist() == labels(separated)
    beyond = [
        [separated.triangle_of.get((b, a), -1) for a, b in (sides[1], sides[2], sides[0])]
        for sides in map(sides_of, separated.triangles)
    ]
    assert carved.neighbors.tolist() == beyond


def labels(mesh: Carving) -> list[int]:
    """Number what walls separate, in the order of the first triangles."""
    found: dict[int, int] = {}
    for t in range(len(mesh.triangles)):
        if t not in found:
            found |= dict.fromkeys(mesh.reached([t]), len({*found.values()}))
    return [found[t] for t in range(len(mesh.triangles))]
