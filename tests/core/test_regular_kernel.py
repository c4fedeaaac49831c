"""Regular triangulations of the kernel, held against an oracle on exact integers."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from regular_oracle import Site, regular, sites
from sites import (
    FAMILIES,
    SETS,
    Sites,
    circle,
    columns,
    exponents,
    giants,
    integers,
    lattice,
    line_and_point,
    under_a_few,
    uniform,
    wide_lattice,
)

from liftmesh import _kernel
from liftmesh._typing import Floats, Reals, Rows


def run(
    points: Reals, values: Reals, lift: str = "weights", threads: int = 1
) -> tuple[str, Rows, Rows, Rows, Rows]:
    """Status, triangles, neighbours, duplicates and hidden rows."""
    outcome, hidden = _kernel.regular(points, values, lift == "radii", False, threads, False, None)
    status, _, _, simplices, neighbors, _, duplicates, _ = outcome
    return status, simplices, neighbors, duplicates, hidden


@pytest.mark.slow
@pytest.mark.parametrize("lift", ["weights", "radii"])
@pytest.mark.parametrize("family", FAMILIES)
def test_small_sets_are_the_oracles(family: Callable[..., Sites], lift: str) -> None:
    for number in range(8 if family in (exponents, giants) else SETS):
        rng = np.random.default_rng([17, number])
        points, values = family(rng, int(rng.integers(3, 13)))
        values = np.abs(values) if lift == "radii" else values
        expected, left_out = regular(sites(points.tolist(), values.tolist(), lift))
        status, simplices, _, duplicates, hidden = run(points, values, lift)
        assert (status == "ok") == bool(expected), number
        if not expected:
            continue
        assert {frozenset(t) for t in simplices.tolist()} == expected, number
        assert len(simplices) == len(expected), number
        assert {*hidden.tolist(), *duplicates[:, 0].tolist()} == left_out, number
        assert not {*hidden.tolist()} & {*duplicates.ravel().tolist()}, number


@pytest.mark.parametrize("family", [lattice, line_and_point, under_a_few])
def test_the_order_of_the_rows_changes_nothing(family: Callable[..., Sites]) -> None:
    rng = np.random.default_rng(18)
    points, weights = family(rng, 300)
    first = {frozenset(map(tuple, points[t])) for t in run(points, weights)[1]}
    for _ in range(5):
        order = rng.permutation(len(points))
        _, simplices, *_ = run(points[order], weights[order])
        assert {frozenset(map(tuple, points[order][t])) for t in simplices} == first


@pytest.mark.parametrize("spread", [0.0, 1e-7, 2e-5, 2e-3])
def test_any_number_of_threads_gives_the_same_bits(spread: float) -> None:
    rng = np.random.default_rng(19)
    points, weights = rng.random((200_000, 2)), rng.random(200_000) * spread
    once = run(points, weights)
    for threads in (2, 3, 7):
        for expected, found in zip(
            once[1:], run(points, weights, threads=threads)[1:], strict=True
        ):
            np.testing.assert_array_equal(expected, found)


def test_rows_at_one_position_on_any_number_of_threads() -> None:
    rng = np.random.default_rng(25)
    points = rng.integers(0, 150, (150_000, 2)).astype(float)
    weights = integers(rng, len(points), 3)
    once = run(points, weights)
    assert min(len(once[3]), len(once[4])) > 30_000
    order = np.lexsort([np.arange(len(points)), -weights, *points.T])
    _, first = np.unique(points[order], axis=0, return_index=True)
    heaviest = order[first]
    assert {*once[1].ravel().tolist()} <= {*heaviest.tolist()}
    for threads in (2, 4):
        for expected, found in zip(
            once[1:], run(points, weights, threads=threads)[1:], strict=True
        ):
            np.testing.assert_array_equal(expected, found)


@pytest.mark.parametrize("values", [np.zeros, np.ones])
def test_equal_weights_give_delaunays_triangles(values: Callable[[int], Floats]) -> None:
    rng = np.random.default_rng(20)
    points = np.r_[rng.random((5000, 2)), rng.integers(0, 60, (5000, 2)) / 64]
    plain = _kernel.delaunay(points, False, 1, False, None)
    _, simplices, neighbors, duplicates, hidden = run(points, values(len(points)))
    # Bit for bit: no merge of equal weights is undone.
    np.testing.assert_array_equal(simplices, plain[3])
    np.testing.assert_array_equal(neighbors, plain[4])
    np.testing.assert_array_equal(duplicates, plain[6])
    assert len(hidden) == 0


METRICS = [
    *((1.0, 0.0, 1.0), (2.0, 0.5, 1.25), (1.0, 0.9999, 1.0), (1e-3, 0.0, 7e5)),
    *((3e-200, 1e-200, 2e-200), (1e300, 0.0, 1e-300), (1 / 3, 0.1, 0.7)),
]


@pytest.mark.parametrize("metric", METRICS)
def test_a_metric_gives_the_oracles_triangles(metric: tuple[float, float, float]) -> None:
    a, b, c = map(Fraction, metric)
    for number in range(60):
        rng = np.random.default_rng([23, number])
        family = (uniform, lattice, wide_lattice, line_and_point, columns, circle)[number % 6]
        points, _ = family(rng, int(rng.integers(4, 12)))
        rows = [(Fraction(x), Fraction(y)) for x, y in points.tolist()]
        expected, _ = regular([(x, y, a * x * x + 2 * b * x * y + c * y * y) for x, y in rows])
        status, _, _, simplices, *_ = _kernel.delaunay_by_metric(
            points, *metric, False, 1, False, None
        )
        assert (status == "ok") == bool(expected)
        assert not expected or {frozenset(t) for t in simplices.tolist()} == expected, number


def test_the_identity_is_the_metric_of_delaunay() -> None:
    rng = np.random.default_rng(24)
    points = np.r_[rng.random((3000, 2)), rng.integers(0, 40, (3000, 2)) / 64]
    plain = _kernel.delaunay(points, False, 1, False, None)
    by_metric = _kernel.delaunay_by_metric(points, 2.0, 0.0, 2.0, False, 1, False, None)
    for expected, found in zip(plain[3:], by_metric[3:], strict=True):
        np.testing.assert_array_equal(expected, found)


def test_neighbors_are_mutual_where_many_sites_are_hidden() -> None:
    rng = np.random.default_rng(21)
    points, weights = rng.random((20_000, 2)), rng.random(20_000) * 1e-3
    _, simplices, neighbors, _, hidden = run(points, weights)
    assert 5_000 < len(hidden) < 19_000
    rows, places = np.nonzero(neighbors >= 0)
    others = neighbors[rows, places]
    assert (np.count_nonzero(neighbors[others] == rows[:, None], axis=1) == 1).all()
    shared = [set(simplices[r]) & set(simplices[o]) for r, o in zip(rows, others, strict=True)]
    opposite = simplices[rows, places]
    assert all(len(s) == 2 and v not in s for s, v in zip(shared, opposite, strict=True))
    assert not set(hidden.tolist()) & set(simplices.ravel().tolist())


@pytest.mark.parametrize("lift", ["weights", "radii"])
def test_hidden_rows_are_above_the_triangle_they_lie_in(lift: str) -> None:
    rng = np.random.default_rng(22)
    points = np.r_[rng.random((1500, 2)), rng.integers(0, 9, (500, 2)) / 8]
    values = np.sqrt(rng.random(2000) * 5e-3) if lift == "radii" else rng.random(2000) * 5e-3
    _, simplices, neighbors, _, hidden = run(points, values, lift)
    below = np.empty(len(hidden), dtype=np.int32)
    locator = _kernel.Locator(points, simplices, neighbors)
    locator.find(np.ascontiguousarray(points[hidden]), below, 1, False)
    assert (below >= 0).all()
    assert len(hidden) > 500
    lifted = sites(points.tolist(), values.tolist(), lift)
    for row, triangle in zip(hidden.tolist(), simplices[below].tolist(), strict=True):
        assert is_strictly_above(lifted[row], [lifted[corner] for corner in triangle])


def is_strictly_above(site: Site, corners: list[Site]) -> bool:
    """Whether a lifted site is above the plane of three others, counter-clockwise."""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (
        [value - own for value, own in zip(corner, site, strict=True)] for corner in corners
    )
    return az * (bx * cy - by * cx) + bz * (cx * ay - cy * ax) + cz * (ax * by - ay * bx) < 0


def test_at_one_position_the_heaviest_row_counts() -> None:
    points = np.array([(0, 0), (4, 0), (0, 4), (0, 0), (4, 0), (0, 4), (0, 0), (1, 1)], dtype=float)
    weights = np.array([0, 3, 1, 2, 3, 5, 2, -9], dtype=float)
    _, simplices, _, duplicates, hidden = run(points, weights)
    assert [set(t) for t in simplices.tolist()] == [{3, 1, 5}]
    assert duplicates.tolist() == [[4, 1], [6, 3]]
    assert hidden.tolist() == [0, 2, 7]
