"""Refine random domains, and check each in integers, beside `verify` and `delaunay`.

    python scripts/refine.py                       1,000 domains of each kind
    python scripts/refine.py --count 20000 --seed 7 --kinds stars combs

Domains are stars, combs, needles, fans of edges, rings that touch, boxes and triangles that are
taken off each other, chains that are nearly straight, and edges between points of `small_sets.py`;
as they are, at coordinates of a map, in single precision, or of any magnitude. Each is refined to
an angle of 20, 28 or 33 degrees, perhaps also to an area or a length, or so that it conforms, and
half of them are smoothed: then no row before is elsewhere, none on an edge moves, and the smallest
angle is as large.
`oracles/refined.py` says what must hold in integers; besides, `verify` must accept the triangles,
those that conform must be some of `delaunay`, and rows and edges in another order must make the
same. Those that are larger than asked for, and no others, are listed. Triangles may only be left
for want of precision, or too large, where heights there or beside it are a few units in the last
place, and the cap may only be reached for strips between edges without a common end, which are
printed. Exits with 1 and the domain at a difference.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import permutations
from typing import Any

import domains
import numpy as np
import shapely
from campaign import run_kinds
from constraints import Edges, random_edges
from distributions import UTM_ORIGIN, Points, polar
from numpy.random import Generator
from oracles.refined import PRECISION, Refined
from small_sets import KINDS, small_set

import liftmesh

ANGLES = (20, 28, 33)  # degrees
MOST = 50_000  # points
MOST_OF_HARD = 500  # points where any number is reached
HARD = {"every-exponent", "one-exponent", "powers-of-two", "near-a-line", "huge-and-denormal"}
LEAST = 1e-290  # of areas that doubles tell
MANY = 1_000_000  # points
WIDE = 30_000  # gaps in the length of a strip: several strips are refined to fewer points
SAMPLES = 4000  # of edges
NEAR = 1e-9  # of sizes, whose roundings differ
ROUNDED = 2.0**-50  # of the longest side's square, in areas
FEW = 2.0**-40  # heights that are this part of coordinates may have too few digits
Case = tuple[Points, Edges]


@dataclass(frozen=True)
class Demand:
    """How to refine."""

    angle: float
    share: float | None  # of the domain's area that a triangle may have
    conforming: bool
    carved: bool
    most: int = MOST  # points
    rounds: int = 0  # of smoothing
    by_length: bool = False  # of a square with the area, in place of it


def main() -> None:
    run_kinds(__doc__, DOMAINS, 1000, holds, "domains")


def holds(kind: str, rng: Generator) -> None:
    """Check one domain; ends the program at a difference."""
    case, demand = drawn(kind, rng)
    try:
        mesh = refined(*case, demand)
        check(mesh, case, demand, rng)
        if kind not in HARD:
            check_causes(mesh, case, demand)
    except Exception as error:
        print(f"{kind}: {error!r}\n{said(case)}\n{demand}", file=sys.stderr)
        raise SystemExit(1) from error
    if kind not in HARD and mesh.result.capped:
        print(f"{kind}: at the cap for a strip of length / gap {narrowness(mesh):.0e}")


def said(case: Case) -> str:
    return f"points {case[0].tolist()}\nedges {case[1].tolist()}"


def drawn(kind: str, rng: Generator) -> tuple[Case, Demand]:
    """Draw a domain that has triangles and no crossings, and what is asked for."""
    while True:
        points, edges = DOMAINS[kind](rng)
        if kind not in HARD:
            points = placed(points, rng)
        share = float(10 ** rng.uniform(-3, 0)) if rng.random() < 0.25 else None
        demand = Demand(
            float(rng.choice(ANGLES)), share, bool(rng.random() < 0.3), bool(rng.random() < 0.7),
            MOST_OF_HARD if kind in HARD else MOST, int(rng.choice([0, 0, 1, 4])),
            bool(rng.random() < 0.5),
        )  # fmt: skip
        try:
            constrained(points, edges, demand)
        except liftmesh.InputError:  # edges cross, or there is nothing to refine
            continue
        return (points, edges), demand


def constrained(points: Points, edges: Edges, demand: Demand) -> Any:
    carve = "holes" if demand.carved else None
    return liftmesh.constrained_delaunay(points, edges, carve=carve, threads=1)


def refined(points: Points, edges: Edges, demand: Demand) -> Refined:
    """Refine, and say what a triangle may be as arrays."""
    tri = constrained(points, edges, demand)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", liftmesh.DataWarning)
        found = liftmesh.refine(
            tri, min_angle=demand.angle, **sizes(tri, demand), conforming=demand.conforming,
            max_points=demand.most, smooth=demand.rounds,
        )  # fmt: skip
    causes = np.full(found.triangulation.nsimplex, "", dtype="U16")
    causes[found.below] = found.causes
    said = "; ".join(str(each.message) for each in told)
    return Refined(found, tri, causes, float(np.cos(np.radians(demand.angle))), said)


def sizes(tri: Any, demand: Demand) -> dict[str, float]:
    """What is asked for but angles."""
    whole = area_of(tri.points, tri.simplices)
    if demand.share is None or not LEAST < whole < np.inf:
        return {}
    area = demand.share * whole
    return {"size": float(np.sqrt(area))} if demand.by_length else {"max_area": area}


def area_of(points: Points, triangles: Edges) -> float:
    a, b, c = points[triangles].transpose(1, 0, 2)
    (ux, uy), (vx, vy) = (b - a).T, (c - a).T
    with np.errstate(over="ignore", invalid="ignore"):  # inf or nan where it is too large
        return float((ux * vy - uy * vx).sum() / 2)


def check(mesh: Refined, case: Case, demand: Demand, rng: Generator) -> None:
    """Assert all that must hold of a domain that was refined."""
    assert mesh.result.triangulation.npoints == len(mesh.points)
    found = mesh.result.verify(threads=1)
    assert found, found
    mesh.check()
    check_sizes(mesh, demand)
    if demand.conforming and not mesh.result.capped:
        every = in_place(mesh.points, liftmesh.delaunay(mesh.points, threads=1).simplices)
        others = in_place(mesh.points, mesh.simplices) - every
        assert not others or "not those of `delaunay` across" in mesh.told, (
            "not conforming, and not told"
        )
    if demand.rounds:
        mesh.check_smoothed(refined(*case, replace(demand, rounds=0)))
    points, edges = case
    order = rng.permutation(len(points))
    rank = np.argsort(order)
    again = refined(points[order], rank[rng.permutation(edges)].astype(np.int32), demand)
    same = in_place(again.points, again.simplices) == in_place(mesh.points, mesh.simplices)
    assert same or mesh.result.capped, "rows in another order make other triangles"


def check_sizes(mesh: Refined, demand: Demand) -> None:
    """Assert that the triangles that are too large are those that are listed."""
    exponent = int(np.frexp(abs(mesh.points).max())[1])
    a, b, c = np.ldexp(mesh.points, -exponent)[mesh.simplices].transpose(1, 0, 2)
    sides = np.stack([b - a, c - b, a - c])
    asked, (u, v, _) = sizes(mesh.before, demand), sides
    longest, areas = np.hypot(*sides.T).max(axis=1), (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2
    length = np.ldexp(asked.get("size", np.inf), -exponent) * np.sqrt(2)
    area = np.ldexp(asked.get("max_area", np.inf), -2 * exponent)
    is_listed = np.isin(np.arange(len(mesh.simplices)), mesh.result.too_large)
    slack = np.where(is_listed, NEAR, -NEAR)
    is_large = longest * (1 + slack) > length
    is_large |= areas * (1 + slack) + np.sign(slack) * ROUNDED * longest**2 > area
    for t in np.flatnonzero(is_large != is_listed):  # in doubt, or too small beside the others
        corners = [[*map(Fraction, each)] for each in mesh.points[mesh.simplices[t]].tolist()]
        is_exactly = is_too_large(corners, asked)
        assert is_exactly == is_listed[t], "others are listed than those that are too large"
    assert not is_listed.any() or mesh.result.capped or "larger than asked" in mesh.told, "not told"


def is_too_large(corners: list[list[Fraction]], asked: dict[str, float]) -> bool:
    """Decide in rationals whether a triangle is larger than asked for."""
    sides = [
        (q[0] - p[0], q[1] - p[1]) for p, q in zip(corners, corners[1:] + corners, strict=False)
    ]
    if "size" in asked:
        return max(x * x + y * y for x, y in sides) > 2 * Fraction(asked["size"]) ** 2
    (a, b), (c, d), _ = sides
    return "max_area" in asked and (a * d - b * c) / 2 > Fraction(asked["max_area"])


def check_causes(mesh: Refined, case: Case, demand: Demand) -> None:
    """Assert that what was left, or led to the cap, could not be helped."""
    left = mesh.causes == PRECISION
    if not mesh.result.capped:
        left[mesh.result.too_large] = True
    beyond = mesh.result.triangulation.neighbors  # or of one beside, whose side cannot be split
    for t in np.flatnonzero(left).tolist():
        beside = [u for u in beyond[t].tolist() if u >= 0]
        assert any(has_few_digits(mesh.points[mesh.simplices[u]]) for u in (t, *beside)), (
            "there are digits for a better triangle"
        )
    if not mesh.result.capped or narrowness(mesh) > WIDE:
        return
    more = refined(*case, replace(demand, most=MANY))
    assert not more.result.capped, "the cap is reached without a narrow strip"


def has_few_digits(corners: Points) -> bool:
    u, v = (corners[1:] - corners[0]) / abs(corners).max()
    longest = max(np.hypot(*each) for each in (u, v, u - v))
    return bool(u[0] * v[1] - u[1] * v[0] <= FEW * longest)


def narrowness(mesh: Refined) -> float:
    """Return how often a gap between edges without a common end goes into its length, at most."""
    points = mesh.before.points / abs(mesh.before.points).max()
    pieces = np.array(sorted(mesh.pieces))
    shares, most = np.linspace(0, 1, SAMPLES)[1:-1, None], 0.0
    for (a, b), (c, d) in permutations(pieces.tolist(), 2):
        if {a, b} & {c, d}:
            continue
        places, along = points[a] + shares * (points[b] - points[a]), points[d] - points[c]
        share = ((places - points[c]) @ along / (along @ along)).clip(0, 1)
        gaps = np.hypot(*(places - points[c] - share[:, None] * along).T)
        length = np.hypot(*(points[b] - points[a])) / SAMPLES
        most = max(most, float((length / gaps.clip(1e-300)).sum()))
    return most


def in_place(points: Points, triangles: Edges) -> set[Any]:
    """Triangles as sets of positions."""
    return {frozenset(map(tuple, corners)) for corners in (points[triangles] + 0.0).tolist()}


def placed(points: Points, rng: Generator) -> Points:
    """As it is, at coordinates of a map, in single precision, or of any magnitude."""
    way = rng.integers(0, 5)
    if way == 0:
        return points + UTM_ORIGIN
    if way == 1 and abs(points).max() < np.finfo(np.float32).max:
        return points.astype(np.float32).astype(np.float64)
    if way == 2:
        widest = max(abs(points).max(), 1e-300)
        return points / widest * 10.0 ** rng.uniform(-300, 300)
    return points


def ring(points: Points) -> Case:
    return joined([points])


def joined(rings: list[Points]) -> Case:
    """The points of rings, equal ones once, and their edges."""
    points, row = np.unique(np.concatenate(rings), axis=0, return_inverse=True)
    row = row.reshape(-1)
    edges, start = [], 0
    for each in rings:
        rows = row[start : start + len(each)]
        edges.append(np.column_stack([rows, np.roll(rows, -1)]))
        start += len(each)
    return points, np.concatenate(edges).astype(np.int32)


def stars(rng: Generator) -> Case:
    """Rings around a point with corners near and far from it, perhaps one in the other."""
    outer = star(int(rng.integers(3, 25)), rng)
    return joined([outer, outer * rng.uniform(0.1, 0.99)]) if rng.random() < 0.5 else ring(outer)


def star(count: int, rng: Generator) -> Points:
    turns = np.sort(rng.random(count)) * 2 * np.pi
    return polar(10 ** rng.uniform(-rng.choice([0.1, 1, 3]), 0, count), turns)


def combs(rng: Generator) -> Case:
    """Teeth that are much longer than they are apart."""
    count = int(rng.integers(3, 14))
    up = np.arange(count) % 2
    high = 10 ** rng.uniform(-1, 3)
    teeth = np.column_stack([np.arange(count) * 1.0, high * up * (0.5 + 0.5 * rng.random(count))])
    low = -high * 10 ** rng.uniform(-4, 0)
    return ring(np.vstack([teeth, [[count - 1.0, low], [0, low]]]))


def needles(rng: Generator) -> Case:
    """Triangles with an angle of nearly nothing, some of them from one corner."""
    count = int(rng.integers(1, 4))
    at = np.sort(rng.random(count)) * 6
    wide = 10 ** rng.uniform(-8, -0.5, count)
    found = [
        np.vstack([[[0.0, 0]], polar(10 ** rng.uniform(-1, 1, 2), np.array([a, a + w]))])
        for a, w in zip(at, wide, strict=True)
    ]
    return joined(found)


def fans(rng: Generator) -> Case:
    """Spokes from one corner, in a box or without one."""
    count = int(rng.integers(2, 20))
    turns = rng.uniform(0, rng.choice([0.01, 1, 2 * np.pi]), count)
    ends = polar(rng.uniform(0.2, 1, count), turns)
    points = np.vstack([[[0.0, 0]], ends])
    edges = np.column_stack([np.zeros(count), np.arange(1, count + 1)])
    if rng.random() < 0.5:
        box = np.array([[-2.0, -2], [2, -2], [2, 2], [-2, 2]])
        rows = len(points) + np.arange(4)
        points = np.vstack([points, box])
        edges = np.vstack([edges, np.column_stack([rows, np.roll(rows, -1)])])
    return points, edges.astype(np.int32)


def straight(rng: Generator) -> Case:
    """A ring whose corners are on the lines of a triangle, up to the last digits."""
    corners = rng.uniform(-1, 1, (3, 2))
    shares = np.sort(rng.random((3, int(rng.integers(1, 6)))), axis=1)[:, :, None]
    along = corners[:, None] + shares * (np.roll(corners, -1, axis=0) - corners)[:, None]
    along += rng.integers(-1, 2, along.shape) * np.spacing(abs(along))
    return ring(np.concatenate([corners[:, None], along], axis=1).reshape(-1, 2))


def touching(rng: Generator) -> Case:
    """Rings with a common corner, one in the other or beside it."""
    count, rings = int(rng.integers(2, 5)), []
    for _ in range(count):
        turns = rng.uniform(0, 2 * np.pi) + np.sort(rng.random(2)) * rng.choice([0.05, 1])
        reach = 10 ** rng.uniform(-1, 0, 3)
        tip = polar(reach[2], np.array([turns.mean()]))
        ends = polar(reach[:2] * 0.7, turns)
        rings.append(np.vstack([[[0.0, 0]], ends[:1], tip, ends[1:]]))
    return joined(rings)


def of_shapes(draw: Callable[[Generator], Any]) -> Callable[[Generator], Case]:
    def rings(rng: Generator) -> Case:
        found = [
            np.array(each.coords)[:-1] for each in shapely.get_rings(shapely.get_parts(draw(rng)))
        ]
        return joined(found)

    return rings


def edges_of(kind: str) -> Callable[[Generator], Case]:
    def drawn(rng: Generator) -> Case:
        points = small_set(KINDS[kind], rng, most=int(rng.choice([6, 12, 30])))
        return points, random_edges(points, rng)

    return drawn


DOMAINS: dict[str, Callable[[Generator], Case]] = {
    **{each.__name__: each for each in (stars, combs, needles, fans, straight, touching)},
    "boxes": of_shapes(domains.boxes),
    "triangles": of_shapes(domains.triangles),
    **{kind: edges_of(kind) for kind in KINDS},
}


if __name__ == "__main__":
    main()
