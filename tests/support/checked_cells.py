"""The whole check of cells by definition, in rationals: corners, areas, sides and neighbours."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import pytest
from rational_cells import (
    Exact,
    area,
    cell_area,
    crossing,
    exact_point,
    power_centre,
    rounded,
    shared_length,
)

if TYPE_CHECKING:
    import liftmesh


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
        assert length == pytest.approx(expected[min(pair), max(pair)], rel=1e-6, abs=1e-320)
    found = [expected[pair] for pair in sorted(expected)]
    np.testing.assert_allclose(cells.shared_lengths, found, rtol=1e-6, atol=1e-15)
