"""Graphs of disks: compared with exact square roots, with `delaunay`, and with themselves."""

from __future__ import annotations

import copy
import pickle
from decimal import Decimal, localcontext
from itertools import pairwise

import numpy as np
import pytest
from apollonius_oracle import apollonius as by_definition
from sites import (
    anywhere,
    beside_a_large_one,
    between_two_large_ones,
    graph_of,
    in_a_row,
    on_lattice,
    touching_a_circle,
    triangles,
)

import liftmesh
from liftmesh import InputError, NonFiniteError


@pytest.mark.parametrize(
    "family",
    [
        on_lattice,
        in_a_row,
        anywhere,
        touching_a_circle,
        beside_a_large_one,
        between_two_large_ones,
    ],
)
def test_small_sets_agree_with_the_definition(family: object) -> None:
    rng = np.random.default_rng(19)
    for _ in range(16):
        disks = rng.permutation(family(rng, int(rng.integers(1, 8))))  # type: ignore[operator]
        found, hidden, doubles = by_definition(disks.tolist())
        graph = graph_of(disks)
        assert triangles(graph) == found, disks.tolist()
        assert set(graph.hidden.tolist()) == hidden
        assert {tuple(pair) for pair in graph.duplicates.tolist()} == doubles


def test_a_disk_that_touches_one_which_comes_later_from_inside_leaves_no_trace() -> None:
    touching = [[-4, 3, 0], [-3, -4, 0], [8, 6, 5], [-10, 0, 5], [-6, -8, 5], [20, -15, 20]]
    disks = np.array([*touching, [20, 15, 20], [12, 16, 15]], dtype=float)
    expected = triangles(graph_of(disks[[0, 3, 4, 5, 6, 7]]))
    rows = np.array([0, 3, 4, 5, 6, 7])
    for _ in range(20):  # the order of insertion is drawn anew
        assert {tuple(rows[list(t)]) for t in expected} == triangles(graph_of(disks))


@pytest.mark.slow
@pytest.mark.parametrize("family", ["uniform", "lattice", "circle", "row and apex"])
@pytest.mark.parametrize("radius", [0.0, 0.75])
def test_equal_radii_give_delaunay_triangles(family: str, radius: float) -> None:
    angles = np.arange(300) * 0.02
    points = {
        "uniform": np.random.default_rng(1).random((3000, 2)),
        "lattice": np.stack(np.meshgrid(np.arange(40.0), np.arange(40.0)), -1).reshape(-1, 2),
        "circle": np.c_[np.cos(angles), np.sin(angles)],
        "row and apex": np.array([[i, 0.0] for i in range(50)] + [[3.0, 5]]),
    }[family]
    graph = liftmesh.apollonius(points, np.full(len(points), radius))
    expected = {
        tuple(np.roll(t, -int(np.argmin(t))).tolist()) for t in liftmesh.delaunay(points).simplices
    }
    assert triangles(graph) == expected
    assert len(graph.hidden) == 0


@pytest.mark.parametrize("kind", ["lattice", "anywhere"])
def test_the_order_of_rows_changes_nothing(kind: str) -> None:
    rng = np.random.default_rng(2)
    disks = np.c_[rng.random((2000, 2)), rng.random(2000) * 0.05]
    if kind == "lattice":
        disks = np.c_[rng.integers(0, 60, (2000, 2)), rng.integers(0, 4, 2000)].astype(float)
    disks = np.unique(disks, axis=0)
    shuffle = rng.permutation(len(disks))
    first, second = graph_of(disks), graph_of(disks[shuffle])
    renamed = shuffle[second.simplices]
    assert triangles(first) == {tuple(np.roll(t, -int(np.argmin(t))).tolist()) for t in renamed}
    assert set(first.hidden) == set(shuffle[second.hidden])


def test_circles_touch_their_disks_and_no_other_enters() -> None:
    rng = np.random.default_rng(3)
    disks = np.c_[rng.random((400, 2)), rng.random(400) ** 3 * 0.1]
    graph = graph_of(disks)
    x, y, radius = graph.circles.T
    distances = np.hypot(x[:, None] - disks[:, 0], y[:, None] - disks[:, 1]) - disks[:, 2]
    clearance = distances - radius[:, None]
    assert clearance.min() > -1e-8 * (1 + np.abs(radius)).max()
    of_corners = np.take_along_axis(clearance, graph.simplices.astype(np.intp), 1)
    assert np.abs(of_corners / (1 + np.abs(radius))[:, None]).max() < 1e-9


@pytest.mark.parametrize("near", [2.0**-100, 2.0**-200])
def test_circles_of_disks_that_are_far_nearer_to_each_other_than_to_others(near: float) -> None:
    pair = np.array([[0, 0, 0], [near, 0, 0], [0, 3 * near, near], [1, 0, 0], [0, 1, 0]])
    graph = graph_of(pair)
    assert graph.verify().canonical
    assert np.isfinite(graph.circles).all()
    for corners, (x, y, radius) in zip(graph.simplices, graph.circles, strict=True):
        distances = np.hypot(*(pair[corners, :2] - (x, y)).T) - pair[corners, 2]
        np.testing.assert_allclose(distances, radius, rtol=1e-12)


def circles_in_decimals(corners: list[list[float]]) -> list[list[float]]:
    """Both circles that touch three disks, centres not on a line, to hundreds of digits."""
    with localcontext() as context:
        context.prec = 600
        (x, y, r), *others = ([Decimal(value) for value in each] for each in corners)
        (a, b, c), (d, e, f) = rows = [(u - x, v - y, s - r) for u, v, s in others]
        g, h = ((u * u + v * v - s * s) / 2 for u, v, s in rows)
        det = a * e - b * d
        x0, x1, y0, y1 = (
            each / det for each in (g * e - b * h, b * f - c * e, a * h - d * g, c * d - a * f)
        )
        two, one, none = x1 * x1 + y1 * y1 - 1, x0 * x1 + y0 * y1, x0 * x0 + y0 * y0
        root = (one * one - two * none).sqrt()
        distances = [(sign * root - one) / two for sign in (-1, 1)]
        return [[float(x + x0 + x1 * s), float(y + y0 + y1 * s), float(s - r)] for s in distances]


TINY = 2.0**-76
NEARLY_ON_TANGENTS = (
    [[128 * TINY, 32, 96 * TINY], [96, 192, 96], [0, -4 * TINY, 4 * TINY]],
    [[-3 * TINY, TINY, 0], [64, 256, 3], [-4 * TINY, -TINY, 64], [4, -64, 0], [192, -64, TINY]],
    [[-32, 0, 64], [3, -6 * TINY, TINY], [-96, 64, 128], [32, -192, 4 * TINY]],
)


@pytest.mark.parametrize("disks", NEARLY_ON_TANGENTS)
def test_circles_of_disks_whose_numbers_are_far_apart_in_size(disks: list[list[float]]) -> None:
    graph = graph_of(np.array(disks, dtype=float))
    for corners, circle in zip(graph.simplices, graph.circles, strict=True):
        known = np.array(circles_in_decimals([disks[row] for row in corners]))
        apart = np.abs(known - circle).max(axis=1) / np.abs(known).max(axis=1)
        assert apart.min() < 1e-12
    assert np.abs(graph.circles).max() > 1e15
    assert graph.verify().valid


def test_neighbors_share_an_edge_and_the_outer_ones_are_the_hull() -> None:
    rng = np.random.default_rng(4)
    graph = graph_of(np.c_[rng.random((1000, 2)), rng.random(1000) * 0.03])
    outer = []
    for t, (corners, beside) in enumerate(zip(graph.simplices, graph.neighbors, strict=True)):
        for k in range(3):
            a, b = corners[(k + 1) % 3], corners[(k + 2) % 3]
            if beside[k] < 0:
                outer.append((a, b))
                continue
            other = graph.simplices[beside[k]].tolist()
            at = next(j for j in range(3) if (other[j], other[j - 2]) == (b, a))
            assert graph.neighbors[beside[k]][at - 1] == t
    hull = graph.convex_hull.tolist()
    assert sorted(outer) == sorted(zip(hull, hull[1:] + hull[:1], strict=True))
    seen = len(graph.radii) - len(graph.hidden)
    assert len(graph.edges) == seen + len(graph.simplices) - 1  # Euler


def test_a_small_disk_between_two_large_ones_has_two_triangles() -> None:
    graph = liftmesh.apollonius([[-4, 0], [4, 0], [0, 0]], [3, 3, 0.5])
    assert graph.neighbors.tolist() == [[1, 1, -1], [0, -1, 0]]
    assert graph.neighbors_of(2).tolist() == [0, 1]
    assert graph.edges.tolist() == [[0, 1], [0, 1], [0, 2], [1, 2]]


def test_few_disks_have_no_triangle_but_neighbors() -> None:
    assert len(liftmesh.apollonius(np.empty((0, 2)), []).edges) == 0
    assert liftmesh.apollonius([[1, 2]], [3]).convex_hull.shape == (0,)
    pair = liftmesh.apollonius([[0, 0], [5, 0], [0, 0]], [1, 2, 1])
    assert pair.edges.tolist() == [[0, 1]]
    assert pair.duplicates.tolist() == [[2, 0]]
    assert liftmesh.apollonius([[0, 0], [0, 0], [0, 0]], [1, 2, 1]).hidden.tolist() == [0, 2]


def test_signs_are_exact_across_many_binary_digits() -> None:
    disks = np.array([[0, 0, 1.0], [4, 0, 1], [4, 4, 1], [0, 4, 1]])
    spread = disks.copy()
    spread[:, 2] = [2.0**-190, 0, 2.0**-191, 0]
    assert triangles(graph_of(spread)) == by_definition(spread.tolist())[0]
    spread[:, 2] = [0, 2.0**-190, 0, 2.0**-191]
    assert triangles(graph_of(spread)) == by_definition(spread.tolist())[0]
    for scale in (2.0**900, 2.0**-1000):
        assert triangles(graph_of(disks * scale)) == triangles(graph_of(disks))


@pytest.mark.parametrize(
    ("radii", "error", "message"),
    [
        ([1, -2.0, 1], InputError, "row 1 has the radius -2.0: radii are not negative"),
        ([1, 1, np.nan], NonFiniteError, "row 2 has the radius nan: remove such rows, or"),
        ([1, np.inf, 1], NonFiniteError, "row 1 has the radius inf"),
        ([1, 1], InputError, "radii hold 2 numbers for 3 rows"),
        ([1, 1, 1e-90], InputError, r"rows 2 and 0, .* span \d+ binary digits .* 256 are exact"),
    ],
)
def test_errors_name_the_row(radii: object, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        liftmesh.apollonius([[0, 9.5], [7, 0], [0, 1]], radii)  # type: ignore[arg-type]


def test_a_row_that_is_too_wide_alone_is_named_once() -> None:
    with pytest.raises(InputError, match=r"^row 1, \(.*\), spans \d+ binary digits"):
        liftmesh.apollonius([[0, 0], [1e100, 1]], [1, 1e-90])


def test_disks_on_one_tangent_follow_each_other_on_the_hull() -> None:
    order = [2, 0, 3, 1]
    disks = np.array([[0, 1, 1], [4, 1, 1], [8, 1, 1], [14, 1, 1]], dtype=float)[order]
    hull = liftmesh.apollonius(disks[:, :2], disks[:, 2]).convex_hull
    along = [(order[a], order[b]) for a, b in zip(hull, np.roll(hull, -1), strict=True)]
    assert sorted(along) == [(0, 1), (1, 0), (1, 2), (2, 1), (2, 3), (3, 2)]


def test_errors_of_centers() -> None:
    with pytest.raises(NonFiniteError, match="row 1 is not finite") as caught:
        liftmesh.apollonius([[0, 0], [np.nan, 0]], [1, 1])
    assert caught.value.row == 1
    with pytest.raises(InputError, match="give x and y alone"):
        liftmesh.apollonius([[0, 0, 0]], [1])
    with pytest.raises(InputError, match="no row 7"):
        liftmesh.apollonius([[0, 0]], [1]).neighbors_of(7)


def test_results_stay_as_they_are_also_in_copies() -> None:
    graph = liftmesh.apollonius([[0, 0], [5, 0], [0, 5]], [1, 1, 1])
    for each in (graph, pickle.loads(pickle.dumps(graph)), copy.deepcopy(graph)):
        assert not each.simplices.flags.writeable
        assert each.simplices.tolist() == [[0, 1, 2]]


def test_a_run_reports_and_stops() -> None:
    rng = np.random.default_rng(5)
    centers = rng.random((100_000, 2))

    def stop(done: float) -> None:
        assert 0 <= done < 1
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        liftmesh.apollonius(centers, np.zeros(len(centers)), progress=stop)


@pytest.mark.parametrize("kind", ["apart", "overlapping", "equal in a row"])
def test_sides_of_cells_are_where_two_distances_are_least(kind: str) -> None:
    rng = np.random.default_rng(6)
    disks = np.c_[rng.random((40, 2)), rng.random(40) * (0.03 if kind == "apart" else 0.2)]
    if kind == "equal in a row":
        disks = np.array([[0.2, 0.5, 0.1], [0.5, 0.5, 0.1], [0.9, 0.5, 0.1]])
    graph = graph_of(disks)
    box, tolerance = (-0.2, -0.1, 1.2, 1.1), 1e-4
    found = graph.cell_sides(box, tolerance)
    length = 0
    for pair, line in found:
        assert (line >= np.array(box[:2]) - 1e-12).all()
        assert (line <= np.array(box[2:]) + 1e-12).all()
        length += len(line)
        for share in (0.0, 0.3, 0.5):
            places = line[:-1] * (1 - share) + line[1:] * share
            apart = np.hypot(*(places[:, None] - disks[:, :2]).transpose(2, 0, 1)) - disks[:, 2]
            least = apart.min(1)[:, None]
            assert (np.abs(apart[:, pair] - least) < 2.1 * tolerance).all()
    assert {pair for pair, _ in found} <= {tuple(edge) for edge in graph.edges.tolist()}
    assert len(found) >= len(graph.simplices)
    assert length < 40 * len(found)


@pytest.mark.parametrize("kind", ["apart", "overlapping"])
def test_sides_part_the_box_into_cells(kind: str) -> None:
    """Along a line the nearest disk changes only where the line crosses a side, and there."""
    rng = np.random.default_rng(7)
    disks = np.c_[rng.random((40, 2)), rng.random(40) * (0.03 if kind == "apart" else 0.2)]
    found = graph_of(disks).cell_sides((0, 0, 1, 1), 1e-5)
    y = 0.437
    x = np.linspace(0, 1, 20_001)
    apart = np.hypot(x[:, None] - disks[:, 0], y - disks[:, 1]) - disks[:, 2]
    nearest = apart.argmin(1)
    changes = x[1:][nearest[1:] != nearest[:-1]]
    crossings = [
        a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
        for _, line in found
        for a, b in pairwise(line)
        if (a[1] - y) * (b[1] - y) < 0
    ]
    np.testing.assert_allclose(sorted(crossings), changes, atol=1e-3)


def test_a_box_may_have_no_side_in_it() -> None:
    graph = liftmesh.apollonius([[0, 0], [4, 0]], [1, 1.5])
    assert graph.cell_sides((-2, -2, -1, -1), 0.1) == []
    assert liftmesh.apollonius([[0, 0]], [1]).cell_sides((0, 0, 1, 1), 0.1) == []
    assert liftmesh.apollonius(np.empty((0, 2)), []).cell_sides((0, 0, 1, 1), 0.1) == []


def test_errors_of_boxes_and_tolerances() -> None:
    graph = liftmesh.apollonius([[0, 0], [4, 0]], [1, 1])
    for box, tolerance, message in (
        ((0, 0, 1), 0.1, "four finite numbers"),
        ((0, 0, 0, 1), 0.1, "give xmin, ymin, xmax, ymax"),
        ((0, 0, 1, 1), 0.0, "give a positive, finite number"),
        ((0, 0, 1e9, 1), 1e-9, "near the rounding of coordinates there: give 1.4e-05"),
    ):
        with pytest.raises(InputError, match=message):
            graph.cell_sides(box, tolerance)  # type: ignore[arg-type]


def test_a_copy_of_a_disk_on_both_sides_of_an_edge_is_found() -> None:
    """Where doubles lead the walk astray, beside numbers of 2^-76, in one of seven orders."""
    near = ["-0x1.43fffp-76 0x1.6001cp-79 0x1.cp-95", "-0x1.4400000000001p-76 0x1.6p-79 0x0p0"]
    texts = [*near, *["0x1.88p5 0x1.6001cp-79 0x1.88p5"] * 2]
    disks = np.array([[*map(float.fromhex, text.split())] for text in texts])
    for _ in range(80):
        graph = liftmesh.apollonius(disks[:, :2], disks[:, 2])
        assert graph.simplices.tolist() == [[0, 1, 2], [0, 2, 1]]
        assert graph.duplicates.tolist() == [[3, 2]]
