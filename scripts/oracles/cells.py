"""Voronoi and power cells by definition, in rationals: corners, areas, sides and neighbours."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import liftmesh

Exact = tuple[Fraction, Fraction]


def exact_point(point: Sequence[float]) -> Exact:
    """A position without rounding."""
    return Fraction(float(point[0])), Fraction(float(point[1]))


def power_centre(sites: Sequence[Exact], weights: Sequence[Fraction] = (Fraction(0),) * 3) -> Exact:
    """The point of equal power to three sites: where two radical axes meet, by Cramer's rule."""
    (ax, ay), *others = sites
    rows = [
        (2 * (x - ax), 2 * (y - ay), x * x + y * y - w - (ax * ax + ay * ay - weights[0]))
        for (x, y), w in zip(others, weights[1:], strict=True)
    ]
    (a, b, p), (c, d, q) = rows
    determinant = a * d - b * c
    return (p * d - b * q) / determinant, (a * q - p * c) / determinant


def rounded(value: Fraction) -> float:
    """The nearest double, or infinity."""
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def crossing(
    sites: Sequence[Exact], weights: Sequence[Fraction], start: Exact, end: Exact
) -> Exact:
    """Where a segment has equal power to two sites."""

    def gap(x: Fraction, y: Fraction) -> Fraction:
        powers = [(x - u) ** 2 + (y - v) ** 2 - w for (u, v), w in zip(sites, weights, strict=True)]
        return powers[0] - powers[1]

    first, last = gap(*start), gap(*end)
    share = first / (first - last)
    return start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])


def area(ring: Sequence[Exact]) -> Fraction:
    """The signed area of a polygon."""
    pairs = zip(ring, [*ring[1:], *ring[:1]], strict=True)
    return sum((a[0] * b[1] - a[1] * b[0] for a, b in pairs), Fraction(0)) / 2


def half_plane(ring: Sequence[Exact], a: Fraction, b: Fraction, c: Fraction) -> list[Exact]:
    """What of a convex polygon has a x + b y <= c."""
    found = []
    for p, q in zip(ring, [*ring[1:], *ring[:1]], strict=True):
        at_p, at_q = a * p[0] + b * p[1] - c, a * q[0] + b * q[1] - c
        if at_p <= 0:
            found.append(p)
        if at_p * at_q < 0:
            share = at_p / (at_p - at_q)
            found.append((p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])))
    return found


def cell_area(
    row: int, sites: Sequence[Exact], weights: Sequence[Fraction], rings: Sequence[Sequence[Exact]]
) -> Fraction:
    """The area of a cell in a domain, by definition.

    The domain is a sum of triangles with one corner at a fixed point, each positive or negative;
    each is cut by the half plane of every other site.
    """
    x, y = sites[row]
    total, fixed = Fraction(0), rings[0][0]
    for ring in rings:
        for p, q in zip(ring, [*ring[1:], *ring[:1]], strict=True):
            triangle = [fixed, p, q]
            sign = 1 if area(triangle) >= 0 else -1
            for other, (u, v) in enumerate(sites):
                if other != row and triangle:
                    right = u * u + v * v - weights[other] - x * x - y * y + weights[row]
                    triangle = half_plane(triangle, 2 * (u - x), 2 * (v - y), right)
            total += sign * abs(area(triangle))
    return total


def interval(a: Fraction, b: Fraction, bounds: list[Fraction]) -> list[Fraction]:
    """What of the numbers between two bounds has a t <= b; nothing if that is empty."""
    low, high = bounds
    if a == 0:
        return bounds if b >= 0 else []
    bounds = [low, min(high, b / a)] if a > 0 else [max(low, b / a), high]
    return bounds if bounds[0] < bounds[1] else []


def is_inside(point: Exact, rings: Sequence[Sequence[Exact]]) -> bool:
    """Whether a point is strictly inside a domain."""
    winding = 0
    for ring in rings:
        for a, b in zip(ring, [*ring[1:], *ring[:1]], strict=True):
            side = area([a, b, point])
            reach = (point[0] - a[0]) * (point[0] - b[0]) + (point[1] - a[1]) * (point[1] - b[1])
            if side == 0 and reach <= 0:
                return False
            winding += (a[1] <= point[1] < b[1] and side > 0) - (
                b[1] <= point[1] < a[1] and side < 0
            )
    return winding > 0


def shared_length(
    pair: tuple[int, int],
    sites: Sequence[Exact],
    weights: Sequence[Fraction],
    rings: Sequence[Sequence[Exact]],
) -> float:
    """The length of what two cells share inside a domain, by definition.

    Along the line of equal power to both, the others leave an interval; edges of the domain cut it,
    and of each piece the middle tells whether it is inside.
    """
    (x, y), (u, v) = sites[pair[0]], sites[pair[1]]
    if (x, y) == (u, v):
        return 0.0
    along = y - v, u - x
    unit = along[0] ** 2 + along[1] ** 2
    first, last = weights[pair[0]] - x * x - y * y, weights[pair[1]] - u * u - v * v
    share = (first - last) / (2 * unit)
    start = share * (u - x), share * (v - y)
    bounds = [Fraction(-(10**9)), Fraction(10**9)]
    for (p, q), w in zip(sites, weights, strict=True):
        a, b = 2 * (p - x), 2 * (q - y)
        right = p * p + q * q - w + first - a * start[0] - b * start[1]
        bounds = bounds and interval(a * along[0] + b * along[1], right, bounds)
    if not bounds:
        return 0.0
    cuts = {*bounds} | {t for ring in rings for t in cuts_of_line(start, along, ring)}
    ordered = sorted(t for t in cuts if bounds[0] <= t <= bounds[1])
    total = Fraction(0)
    for low, high in pairwise(ordered):
        middle = (low + high) / 2
        if is_inside((start[0] + middle * along[0], start[1] + middle * along[1]), rings):
            total += high - low
    return float(total) * math.hypot(*map(float, along))


def cuts_of_line(start: Exact, along: Exact, ring: Sequence[Exact]) -> Iterator[Fraction]:
    """Yield t of each point start + t along that is on a ring, or an end of what is."""
    x, y = along[0] / (along[0] ** 2 + along[1] ** 2), along[1] / (along[0] ** 2 + along[1] ** 2)
    place = [((p - start[0]) * x + (q - start[1]) * y,
              (p - start[0]) * y - (q - start[1]) * x) for p, q in ring]  # fmt: skip
    for (t, side), (u, other) in zip(place, [*place[1:], *place[:1]], strict=True):
        if side == 0:
            yield t
        elif side * other < 0:
            yield t + side / (side - other) * (u - t)


def exact_corners(cells: liftmesh.Cells, weights: list[Fraction]) -> list[Exact]:
    domain = cells.domain
    following = np.arange(1, len(domain.corners) + 1)
    following[domain.starts[1:] - 1] = domain.starts[:-1]
    found = []
    for kind, (a, b, c) in zip(cells.corner_kinds, cells.corner_sources.tolist(), strict=True):
        if kind == 2:
            found.append(exact_point(domain.corners[a]))
            continue
        rows = [a, b, c] if kind == 0 else [a, b]
        sites, lowered = [exact_point(cells.points[r]) for r in rows], [weights[r] for r in rows]
        if kind == 0:
            found.append(power_centre(sites, lowered))
        else:
            ends = exact_point(domain.corners[c]), exact_point(domain.corners[following[c]])
            found.append(crossing(sites, lowered, *ends))
    return found


def rings_of(cells: liftmesh.Cells, corners: list[Exact]) -> list[list[list[list[Exact]]]]:
    rings = [corners[i:j] for i, j in pairwise(cells.ring_corners)]
    parts = [rings[i:j] for i, j in pairwise(cells.rings)]
    return [parts[i:j] for i, j in pairwise(cells.parts)]


def domain_rings(cells: liftmesh.Cells) -> list[list[Exact]]:
    corners = [exact_point(corner) for corner in cells.domain.corners]
    starts = cells.domain.starts
    return [corners[i:j] for i, j in pairwise(starts)]


def power(at: Exact, site: Exact, weight: Fraction) -> Fraction:
    return (at[0] - site[0]) ** 2 + (at[1] - site[1]) ** 2 - weight


def turn(a: Exact, b: Exact, c: Exact) -> Fraction:
    return area([a, b, c])


def is_on_boundary(p: Exact, q: Exact, rings: list[list[Exact]]) -> bool:
    for ring in rings:
        for a, b in zip(ring, [*ring[1:], ring[0]], strict=True):
            if turn(a, b, p) == turn(a, b, q) == 0:
                return True
    return False


def check(cells: liftmesh.Cells, weights: list[Fraction] | None = None) -> None:
    weights = weights or [Fraction(0)] * len(cells.points)
    corners = exact_corners(cells, weights)
    assert [*map(tuple, cells.corners.tolist())] == [(rounded(x), rounded(y)) for x, y in corners]
    rings = domain_rings(cells)
    sites = [exact_point(point) for point in cells.points]
    doubles = {row for row, _ in cells.duplicates.tolist()}
    alone = [row for row in range(len(sites)) if row not in doubles]
    total = Fraction(0)
    for row, parts in enumerate(rings_of(cells, corners)):
        assert all(area(part[0]) > 0 for part in parts)
        assert all(area(hole) < 0 for part in parts for hole in part[1:])
        found = sum((area(ring) for part in parts for ring in part), Fraction(0))
        total += found
        if row in alone:
            own = alone.index(row)
            others = [sites[i] for i in alone]
            assert found == cell_area(own, others, [weights[i] for i in alone], rings)
        else:
            assert not parts
    assert total == sum(map(area, rings))
    check_sides(cells, corners, sites, weights, rings)


def check_sides(cells, corners, sites, weights, rings) -> None:
    lengths: dict[tuple[int, int], float] = {}
    starts = cells.ring_corners.tolist()
    owner = np.repeat(np.repeat(np.arange(len(sites)), np.diff(cells.parts)), np.diff(cells.rings))
    for row, first, last in zip(owner.tolist(), starts, starts[1:], strict=False):
        assert len({*corners[first:last]}) == last - first
        for i in range(first, last):
            p, q = corners[i], corners[i + 1 if i + 1 < last else first]
            before = corners[i - 1 if i > first else last - 1]
            assert turn(before, p, q) != 0 or (
                (p[0] - before[0]) * (q[0] - p[0]) + (p[1] - before[1]) * (q[1] - p[1]) > 0
            )
            beyond = int(cells.beyond[i])
            if beyond < 0:
                assert is_on_boundary(p, q, rings)
                continue
            for at in (p, q):
                own = power(at, sites[row], weights[row])
                assert own == power(at, sites[beyond], weights[beyond])
            step = math.hypot(q[0] - p[0], q[1] - p[1])
            lengths[row, beyond] = lengths.get((row, beyond), 0.0) + step
    check_neighbors(cells, lengths, sites, weights, rings)
    if [*map(exact_point, cells.corners)] == corners:
        assert cells.not_simple.tolist() == []


def check_neighbors(cells, lengths, sites, weights, rings) -> None:
    """What either cell has beside the other is what they share by definition."""
    full = np.flatnonzero(np.diff(cells.parts)).tolist()
    expected = {
        pair: length
        for pair in itertools.combinations(full, 2)
        if (length := shared_length(pair, sites, weights, rings))
    }
    assert [*map(tuple, cells.neighbors.tolist())] == sorted(expected)
    assert {*lengths} == {*expected} | {pair[::-1] for pair in expected}
    for pair, length in lengths.items():
        right = expected[min(pair), max(pair)]
        assert math.isclose(length, right, rel_tol=1e-6, abs_tol=1e-320)
    found = [expected[pair] for pair in sorted(expected)]
    np.testing.assert_allclose(cells.shared_lengths, found, rtol=1e-6, atol=1e-15)
