"""Ask natural neighbours where rounding hurts, and check every weight in rationals.

    python scripts/neighbors.py                    200 sets of each kind
    python scripts/neighbors.py --count 1000 --seed 7 --kinds rims pairs

Points are asked within an ulp of sides of the hull, beside and between rows that almost coincide,
in slivers, on lattices and near the centres of circles; sets are moved by 10^8 and scaled to any
magnitude. The rows must be those whose cells give something to the point's, Sibson's weights and
Laplace's right to 10^-12 of the largest, and linear functions reproduced as far as that allows.
Exits with 1 and the points at a difference.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from fractions import Fraction
from typing import TypeAlias

import numpy as np
from campaign import run_kinds
from numpy.random import Generator
from numpy.typing import NDArray
from oracles.natural import Exact, exact, shares, turn

import liftmesh

Planar: TypeAlias = NDArray[np.float64]
ALLOWED = Fraction(1, 10**12)  # of the largest weight
ASKED = 3  # points of a set


def main() -> None:
    run_kinds(__doc__, KINDS, 200, holds, "sets")


def holds(kind: str, rng: Generator) -> float:
    """Check the weights in one set; ends the program at a difference."""
    points, asked = moved(*KINDS[kind](rng), rng)
    points = np.unique(points, axis=0)
    try:
        tri = liftmesh.delaunay(points)
        found = liftmesh.natural_neighbors(tri, asked)
        by_length = lengths_of(tri.points, asked)
        inside = [exact(q) for q in asked.tolist()]
        return max(
            (
                difference(tri, query, found, place, by_length[place])
                for place, query in enumerate(inside)
                if is_inside(tri, query)
            ),
            default=0.0,
        )
    except liftmesh.DegenerateInputError:
        return 0.0
    except AssertionError as error:
        print(f"{kind}: {error}\n{points.tolist()}\n{asked.tolist()}", file=sys.stderr)
        raise SystemExit(1) from error


def lengths_of(points: Planar, asked: Planar) -> Planar:
    """Compute the weights of Laplace by the heights of surfaces on which one row is up."""
    heights = [
        liftmesh.triangulate(np.column_stack([points, row == np.arange(len(points))])).sample(
            asked, "laplace"
        )
        for row in range(len(points))
    ]
    return np.array(heights).T


def is_inside(tri: liftmesh.Triangulation, query: Exact) -> bool:
    """Whether a point is strictly inside the hull, and at no row."""
    rows = [exact(p) for p in tri.points.tolist()]
    hull = tri.convex_hull.tolist()
    sides = [turn(rows[a], rows[b], query) for a, b in zip(hull, hull[1:] + hull[:1], strict=True)]
    return query not in rows and (min(sides) > 0 or max(sides) < 0)


def difference(
    tri: liftmesh.Triangulation,
    query: Exact,
    found: liftmesh.NaturalNeighbors,
    place: int,
    by_length: Planar,
) -> float:
    """Compare the weights at one point; returns the largest error, in largest weights."""
    rows = [exact(p) for p in tri.points.tolist()]
    used = sorted({rows[row]: row for row in tri.simplices.ravel().tolist()}.values())
    areas, lengths = shares([rows[row] for row in used], query)
    own = slice(found.indptr[place], found.indptr[place + 1])
    given = dict(zip(found.indices[own].tolist(), found.data[own].tolist(), strict=True))
    assert sorted(given) == [used[each] for each in sorted(areas)], "other neighbours"
    of_length = {row: by_length[row] for row in used}
    worst = 0.0
    for weights, expected in ((given, areas), (of_length, lengths)):
        total, most = sum(expected.values()), max(expected.values())
        for row, weight in weights.items():
            right = expected.get(used.index(row), Fraction(0)) / total
            off = abs(Fraction(weight) - right) * total / most
            assert off <= ALLOWED, f"row {row} at {place} is off by {float(off):.1e}"
            worst = max(worst, float(off))
        check_linear(weights, {used[each] for each in expected}, rows, query, most / total)
    return worst


def check_linear(
    weights: dict[int, float], around: set[int], rows: list[Exact], query: Exact, most: Fraction
) -> None:
    """Check that the weighted mean of the rows is the point."""
    for axis in (0, 1):
        steps = {row: rows[row][axis] - query[axis] for row in weights}
        mean = sum(Fraction(weight) * steps[row] for row, weight in weights.items())
        room = ALLOWED * most * sum(abs(steps[row]) for row in around)
        assert abs(mean) <= room, "a linear function is not reproduced"


def moved(points: Planar, asked: Planar, rng: Generator) -> tuple[Planar, Planar]:
    """Move and scale some of the sets."""
    match rng.integers(4):
        case 0:
            offset = rng.choice([1e3, 1e8, -1e8, 5e6 + 0.1], 2)
            return points + offset, asked + offset
        case 1:
            size = 10.0 ** rng.integers(-300, 301)
            return points * size, asked * size
        case _:
            return points, asked


def within(points: Planar, rng: Generator) -> Planar:
    """Points between the rows."""
    weights = rng.dirichlet(np.ones(len(points)), ASKED)
    return weights @ points


def drawn(rng: Generator) -> Planar:
    """Rows on a lattice, in decimal steps, or anywhere."""
    count = int(rng.integers(3, 10))
    if rng.random() < 0.5:
        return rng.integers(0, 6, (count, 2)) * rng.choice([1, 0.1, 0.3])
    return rng.random((count, 2))


def rims(rng: Generator) -> tuple[Planar, Planar]:
    """Points of sides, rounded, and a little inside of them."""
    points = drawn(rng)
    centre = points.mean(axis=0)
    ends = points[rng.integers(0, len(points), (2, 2 * ASKED))]
    share = rng.choice([0.5, rng.random()])
    on = ends[0] * share + ends[1] * (1 - share)
    depth = rng.choice([0, 1e-16, 1e-15, 1e-14, 1e-12, 1e-10, 1e-6], (len(on), 1))
    return points, on + (centre - on) * depth


def pairs(rng: Generator) -> tuple[Planar, Planar]:
    """Rows with a twin at 10^-9 to 3 10^-16, asked around and between them."""
    points = drawn(rng)
    apart = 10.0 ** rng.uniform(-15.5, -6)
    twins = points + apart * rng.standard_normal(points.shape)
    first, second = points[:ASKED], twins[:ASKED]
    between = (first + second) / 2
    around = first + apart * rng.standard_normal(first.shape) * 10.0 ** rng.integers(-1, 5)
    return np.concatenate([points, twins]), np.concatenate([between, around])


def slivers(rng: Generator) -> tuple[Planar, Planar]:
    """Rows that almost lie on a line."""
    points = drawn(rng) * [1, 10.0 ** rng.integers(-300, 0)]
    spread = within(points, rng)
    angle = rng.choice([0.0, 0.0, 1.0])
    turned = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    return points @ turned, spread @ turned


def lattices(rng: Generator) -> tuple[Planar, Planar]:
    """Rows of a lattice, asked at its halves and quarters."""
    points = np.stack(np.meshgrid(np.arange(4.0), np.arange(3.0)), -1).reshape(-1, 2)
    step = rng.choice([1, 0.1, 1 / 3])
    return points * step, rng.integers(0, 13, (ASKED, 2)) / 4 * step


def circles(rng: Generator) -> tuple[Planar, Planar]:
    """Rows of a circle, rounded, asked near its centre or anywhere."""
    angles = rng.random(int(rng.integers(4, 9))) * 2 * np.pi
    points = np.column_stack([np.cos(angles), np.sin(angles)])
    near = rng.standard_normal((ASKED, 2)) * 10.0 ** rng.integers(-20, 0)
    return points, np.concatenate([near, within(points, rng)])


def sizes(rng: Generator) -> tuple[Planar, Planar]:
    """Coordinates of all magnitudes at once."""
    size = 10.0 ** rng.uniform(-rng.choice([3, 20, 150, 300]), 0, (int(rng.integers(3, 8)), 2))
    points = size * rng.choice([-1, 1], size.shape)
    return points, within(points, rng)


KINDS: dict[str, Callable[[Generator], tuple[Planar, Planar]]] = {
    "rims": rims,
    "pairs": pairs,
    "slivers": slivers,
    "lattices": lattices,
    "circles": circles,
    "sizes": sizes,
}


if __name__ == "__main__":
    main()
