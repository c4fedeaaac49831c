"""Merges of frontiers: the union of all tiles is the triangulation that one call returns."""

from __future__ import annotations

import fuzz_tiles
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from oracles import planar as oracle
from strategies import ANY_MAGNITUDE, clouds
from tilings import FAMILIES, Points, adjacent, ordered, tiled

import liftmesh
from liftmesh import _kernel
from liftmesh.errors import DegenerateInputError
from liftmesh.tiles.node import Frontier, merge
from liftmesh.tiles.plan import Plan, planned

INFINITE = (-np.inf, -np.inf, np.inf, np.inf)
NOWHERE = np.empty((0, 4))


def check(points: Points, tiles: int, sample: Points | None = None, **options: object) -> None:
    plan = planned(points if sample is None else sample, tiles)
    found = tiled(points, plan, **options)
    try:
        expected = liftmesh.delaunay(points, nonfinite="skip", order="canonical")
    except DegenerateInputError:
        assert found.root.is_flat
        assert len(found.triangles) == 0
        return
    assert np.array_equal(ordered(found.triangles), ordered(expected.simplices))
    assert np.array_equal(found.duplicates, expected.duplicates)
    assert np.array_equal(found.skipped, expected.skipped)
    assert np.array_equal(found.root.hull, expected.convex_hull)
    assert len(found.root.frontier) == 0
    assert np.array_equal(
        adjacent(found.triangles, found.neighbors),
        adjacent(expected.simplices, expected.neighbors),
    )


@pytest.mark.parametrize("name", FAMILIES)
def test_every_distribution_is_that_of_one_call(name: str) -> None:
    rng = np.random.default_rng(22)
    points = FAMILIES[name](2_000 if name == "mixed-magnitudes" else 10_000, rng)
    points[rng.integers(0, len(points), 200)] = points[rng.integers(0, len(points), 200)]
    for tiles in (2, 41):
        check(points, tiles, points[:: max(1, len(points) // (200 * tiles))], chunk=3_001)


@pytest.mark.slow
@settings(max_examples=100, deadline=None)
@given(rows=clouds(), seed=st.integers(0, 1 << 30), tiles=st.integers(1, 9))
def test_small_clouds_through_random_trees(rows: Points, seed: int, tiles: int) -> None:
    rng = np.random.default_rng(seed)
    points = np.array(rows, dtype=np.float64).reshape(-1, 2)
    if len(points) == 0:
        return
    sample = points[rng.integers(0, len(points), 1 + int(rng.integers(0, len(points))))]
    chunk = 1 + int(rng.integers(0, len(points)))
    flat = rng.random(tiles) < 0.4
    check(points, tiles, sample, chunk=chunk, flatten=lambda cut: bool(flat[cut]))


def test_tiny_sets_of_ties_agree_with_exact_integers() -> None:
    for seed in range(120):
        fuzz_tiles.check(seed)


def test_rows_that_are_not_finite_are_left_out_by_their_number() -> None:
    points = np.random.default_rng(1).random((500, 2))
    points[[3, 77, 499], [0, 1, 0]] = np.nan, np.inf, -np.inf
    check(points, 5, points[np.isfinite(points).all(axis=1)], chunk=100)


def test_equal_points_share_a_tile_however_many() -> None:
    points = np.concatenate((np.full((5_000, 2), 0.5), np.random.default_rng(1).random((500, 2))))
    plan = planned(points, 8)
    _, begins, _, _ = plan.partition(points, 0)
    assert max(np.diff(begins)) >= 5_000
    check(points, 8, chunk=999)
    assert planned(np.full((9, 2), 0.5), 8).tiles == 1


def test_little_goes_up() -> None:
    """A uniform tile of m points passes about 5 sqrt(m), and a merge far less than it was given."""
    points = np.random.default_rng(3).random((160_000, 2))
    found = tiled(points, planned(points[::20], 16))
    leaves = [name for name in found.points_up if name < 0]
    assert sum(found.points_up[name] for name in leaves) < 16 * 8 * 100
    assert found.points_in[0] < 2_000


def test_frontiers_that_do_not_fit_are_refused() -> None:
    points = np.random.default_rng(3).random((400, 2))
    plan = planned(points, 2)
    records, begins, boxes, _ = plan.partition(points, 0)
    left = merge(Frontier(records[: begins[1]]), plan.cells[~0], boxes[1:], is_root=False)
    shuffled = Frontier(left.frontier.records[::-1].copy(), left.frontier.rim)
    with pytest.raises(RuntimeError, match="do not fit together"):
        merge(shuffled, INFINITE, NOWHERE, is_root=True)


@pytest.mark.parametrize("threads", [2, 3])
def test_threads_change_nothing(threads: int) -> None:
    points = np.random.default_rng(3).random((60_000, 2))
    plan = planned(points[::20], 2)
    records, begins, boxes, _ = plan.partition(points, 0)
    part = Frontier(records[: begins[1]])
    one = merge(part, plan.cells[~0], boxes[1:], is_root=False)
    many = merge(part, plan.cells[~0], boxes[1:], is_root=False, threads=threads)
    assert np.array_equal(one.triangles, many.triangles)
    assert np.array_equal(one.frontier.records, many.frontier.records)
    assert np.array_equal(one.frontier.rim, many.frontier.rim)


def is_settled(corners: Points, cell: tuple[float, ...], foreign: Points) -> bool:
    records = np.zeros((3, 3), dtype=np.int64)
    records[:, 1:] = corners.view(np.int64)
    empty = np.empty((0, 2), dtype=np.int32)
    return len(_kernel.merge_frontiers(
        records, empty, np.array([cell]), foreign, False, False, 1, False, None
    )[2]) == 1  # fmt: skip


def exact_side(corners: Points, query: Points) -> int:
    """Return 1 inside the circle, 0 on it, -1 outside: in Python's integers."""
    *abc, d = oracle.exact(np.concatenate((corners, [query])))
    rows = [(x - d[0], y - d[1]) for x, y in abc]
    (ax, ay), (bx, by), (cx, cy) = rows
    lifts = [x * x + y * y for x, y in rows]
    det = (
        lifts[0] * (bx * cy - cx * by)
        - lifts[1] * (ax * cy - cx * ay)
        + lifts[2] * (ax * by - bx * ay)
    )
    turn = oracle.cross(*abc)
    return int(np.sign(det)) * (1 if turn > 0 else -1)


SCALES = st.integers(-1074, 1022)
NUDGES = st.integers(-1, 3)


@settings(max_examples=250, deadline=None)
@given(data=st.data())
def test_no_triangle_is_settled_whose_circle_holds_or_touches_a_point(data: st.DataObject) -> None:
    """Points on or near a circle, at any scale; or of any magnitude whatever."""
    if data.draw(st.booleans()):
        ring = np.array([(5, 0), (3, 4), (0, 5), (-4, 3), (-3, -4), (0, -5), (4, -3)], float)
        four = ring[data.draw(st.permutations(range(7)))[:4]]
        four = np.ldexp(four + data.draw(st.integers(-8, 8)), data.draw(SCALES) // 2 * 2 - 3)
        four[3] *= 1 + data.draw(NUDGES) * 2.0 ** -data.draw(st.integers(30, 52))
    else:
        four = np.array(
            data.draw(st.lists(st.tuples(ANY_MAGNITUDE, ANY_MAGNITUDE), min_size=4, max_size=4))
        )
    corners, query = four[:3], four[3]
    if not np.isfinite(four).all() or oracle.cross(*oracle.exact(corners)) == 0:
        return
    if is_settled(corners, (0.0, 0.0, 0.0, 0.0), np.array([[*query, *query]])):
        assert exact_side(corners, query) < 0


def exactly_within(corners: Points, cell: Points) -> bool:
    """Whether the closed disk is in the interior of a box: in Python's integers."""
    a, b, c, *sides = oracle.exact(np.concatenate((corners, cell.reshape(2, 2))))
    (dx, dy), (ex, ey) = ((p[0] - a[0], p[1] - a[1]) for p in (b, c))
    d, e, det = dx * dx + dy * dy, ex * ex + ey * ey, 2 * (dx * ey - dy * ex)
    center = ey * d - dy * e, dx * e - ex * d  # from a, times det, as all that follows
    gaps = [
        sign * (center[axis] + det * (a[axis] - side[axis])) * int(np.sign(det))
        for side, sign in zip(sides, (1, -1), strict=True)
        for axis in (0, 1)
    ]
    return all(gap > 0 and gap**2 > center[0] ** 2 + center[1] ** 2 for gap in gaps)


@settings(max_examples=250, deadline=None)
@given(data=st.data())
def test_no_triangle_is_settled_whose_circle_leaves_the_cell(data: st.DataObject) -> None:
    """Cells that a circle touches, nearly, at any scale; or of any magnitude whatever."""
    if data.draw(st.booleans()):
        ring = np.array([(-5, 0), (-4, 3), (-3, 4), (0, 5), (4, 3), (3, -4), (-4, -3)], float)
        corners = ring[data.draw(st.permutations(range(7)))[:3]]
        sides = np.array([data.draw(NUDGES) for _ in range(4)])
        cell = np.array([-5.0, -5.0, 5.0, 5.0]) * (
            1 + sides * 2.0 ** -data.draw(st.integers(8, 52))
        )
        power = data.draw(SCALES) - 3
        corners, cell = np.ldexp(corners, power), np.ldexp(cell, power)
        shift = np.ldexp(float(data.draw(st.integers(-8, 8))), power)
        corners, cell = corners + shift, cell + shift
    else:
        drawn = st.lists(ANY_MAGNITUDE, min_size=10, max_size=10)
        values = np.array(data.draw(drawn))
        corners, (one, other) = values[:6].reshape(3, 2), values[6:].reshape(2, 2)
        cell = np.concatenate((np.minimum(one, other), np.maximum(one, other)))
    everywhere = np.array([[-1.0, -1.0, 1.0, 1.0]]) * np.finfo(float).max
    both = np.concatenate((corners, cell.reshape(2, 2)))
    if not np.isfinite(both).all() or oracle.cross(*oracle.exact(corners)) == 0:
        return
    if is_settled(corners, tuple(cell), everywhere):
        assert exactly_within(corners, cell)


@settings(max_examples=250, deadline=None)
@given(data=st.data())
def test_a_cell_that_ends_a_diameter_away_from_a_corner(data: st.DataObject) -> None:
    """There disks are found near without their centre, or not: with half of it they would be."""
    ring = np.array([(-5, 0), (0, 5), (5, 0), (0, -5), (-4, 3), (3, -4), (4, 3)], float)
    corners = ring[data.draw(st.permutations(range(7)))[:3]]
    sides = np.array([float(data.draw(NUDGES)) for _ in range(4)])
    sides *= 2.0 ** -data.draw(st.integers(8, 52))
    around = np.tile(corners[data.draw(st.integers(0, 2))], 2)
    power = data.draw(st.integers(-600, 400))
    cell = np.ldexp(around + np.array([-10.0, -10.0, 10.0, 10.0]) * (1 + sides), power)
    corners = np.ldexp(corners, power)
    everywhere = np.array([[-1.0, -1.0, 1.0, 1.0]]) * np.finfo(float).max
    if is_settled(corners, tuple(cell), everywhere):
        assert exactly_within(corners, cell)


@pytest.mark.parametrize("power", [-1040, -600, -150, 0, 150, 300, 1000])
def test_triangles_far_from_all_others_are_settled_at_every_scale(power: int) -> None:
    corners = np.ldexp(np.array([(5.0, 0.0), (-4.0, 3.0), (0.0, -5.0)]), power)
    box = np.ldexp(np.array([[-5.01, -5.01, 5.01, 5.01]]), power)
    touching = np.ldexp(np.array([[-5.0, -5.0, 5.0, 5.0]]), power)
    beside = np.ldexp(np.array([[5.01, 0.0, 9.0, 1.0], [-9.0, -3.7, -3.7, -3.6]]), power)
    at_five = np.ldexp(np.array([[3.0, 4.0, 9.0, 5.0]]), power)
    assert is_settled(corners, tuple(box[0]), touching)
    assert not is_settled(corners, tuple(touching[0]), touching)
    assert is_settled(corners, tuple(touching[0]), beside)
    assert not is_settled(corners, tuple(touching[0]), at_five)


def tiles_of(plan: Plan, nodes: list[int]) -> list[int]:
    """List the tiles below some nodes."""
    found = [~node for node in nodes if node < 0]
    below = [child for node in nodes if node >= 0 for child in plan.children[node].tolist()]
    return [*found, *tiles_of(plan, below)] if below else found


def test_the_boxes_around_a_node_hold_all_other_points() -> None:
    points = np.random.default_rng(5).random((3_000, 2))
    plan = planned(points, 300)
    _, begins, tight, _ = plan.partition(points, 0)
    boxes = plan.around(tight)
    assert np.array_equal(boxes[0], [*points.min(axis=0), *points.max(axis=0)])
    for name in (~0, ~299, 1, 17, *range(0, 299, 50)):
        others = plan.others(name)
        assert sorted([*tiles_of(plan, others), *tiles_of(plan, [name])]) == list(range(300))
        assert len(others) <= 32 * 10
    assert len(plan.others(~0)) < 299
    assert begins[-1] == 3_000


@pytest.mark.parametrize("spread", [1, 40, 1 << 40, 1 << 61])
def test_rows_are_found_wherever_they_are(spread: int) -> None:
    rng = np.random.default_rng(spread)
    near = rng.integers(0, 900, 500)
    far = rng.integers(0, 900, 500) * spread + rng.integers(0, spread, 500)
    rows = np.unique(np.concatenate((near, far)))
    sought = np.concatenate((rows, rows - 1, rows + 1, [-1, -(2**63), 2**63 - 1]))
    sought = sought[: len(sought) // 3 * 3].reshape(-1, 3)
    places = _kernel.find_rows(rows, sought, 2)
    assert np.array_equal(places >= 0, np.isin(sought, rows))
    assert np.array_equal(rows[places[places >= 0]], sought[places >= 0])
    assert (_kernel.find_rows(rows[:0], sought, 1) == -1).all()
    assert (_kernel.find_rows(rows[:1], sought, 1) == np.where(sought == rows[0], 0, -1)).all()
