"""Cells where corners and edges of the domain lie on ridges and vertices, to the last bit."""

from __future__ import annotations

import math
from fractions import Fraction

import hypothesis.strategies as st
import numpy as np
import pytest
import shapely
from hypothesis import assume, given
from oracles.cells import area, cell_area, check, domain_rings, exact_corners, exact_point, rings_of
from strategies import SITES

import liftmesh
from liftmesh.cells.domain import following_corners

BOX = (-1, -1, 3, 1)


@pytest.mark.parametrize("points", [[[2, 0], [0, 0]], [[0, 0], [2, 0]]])
def test_a_domain_that_ends_at_a_ridge_has_no_neighbors(points) -> None:
    cells = liftmesh.voronoi(points, domain=(1, -1, 3, 1))
    assert cells.neighbors.tolist() == []
    assert cells.shared_lengths.tolist() == []
    assert cells.beyond.tolist() == [-1] * 4
    check(cells)


def test_a_bridge_without_width_joins_no_parts() -> None:
    domain = [(0, -1), (1, -1), (1, 0), (2, 0), (2, -1), (3, -1), (3, 2), (0, 2)]
    cells = liftmesh.voronoi([[1.5, -2], [1.5, 2]], domain=domain)
    assert np.diff(cells.parts).tolist() == [2, 1]
    assert cells.shared_lengths.tolist() == [2.0]
    check(cells)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("hole", [[(1, 0), (1.5, 0.3), (1.5, -0.3)], [(1, 0), (0.5, 0), (1, 0.5)]])
def test_a_hole_that_touches_a_ridge_is_a_hole(hole, side: int) -> None:
    turned = [((x - 1) * side + 1, y) for x, y in hole]
    domain = shapely.Polygon(shapely.box(*BOX).exterior, [turned])
    cells = liftmesh.voronoi([[0, 0], [2, 0]], domain=domain)
    assert cells.not_simple.tolist() == []
    check(cells)


def within_sides(cells: liftmesh.Cells) -> list[tuple[int, list[float]]]:
    """Corners that lie within a side that two cells share."""
    places, found = np.unique(cells.corners, axis=0), []
    following = following_corners(cells.ring_corners)
    for start in np.flatnonzero(cells.beyond >= 0).tolist():
        a, b = cells.corners[start], cells.corners[following[start]]
        near = ((places >= np.minimum(a, b)) & (places <= np.maximum(a, b))).all(axis=1)
        inner = places[near & (places != a).any(axis=1) & (places != b).any(axis=1)]
        ends = exact_point(a), exact_point(b)
        found += [(start, p.tolist()) for p in inner if area([*ends, exact_point(p)]) == 0]
    return found


def test_a_corner_of_the_domain_on_a_side_is_a_corner_of_both_cells() -> None:
    hole = [(4, 4), (3, 5), (3, 3)]
    domain = shapely.Polygon(shapely.box(0, 0, 8, 8).exterior, [hole])
    cells = liftmesh.voronoi([[2, 4], [6, 4]], domain=domain)
    for cell in cells.to_shapely():
        assert (4.0, 4.0) in cell.exterior.coords[:]
    assert within_sides(cells) == []
    assert cells.shared_lengths.tolist() == [8.0]
    check(cells)


@pytest.mark.slow
@given(
    st.lists(st.tuples(*[st.integers(0, 8)] * 2), min_size=2, max_size=10, unique=True),
    st.lists(st.tuples(*[st.integers(1, 7)] * 2), min_size=3, max_size=5, unique=True),
)
def test_neighbors_share_all_corners_of_their_sides(rows, hole) -> None:
    cut = shapely.Polygon(hole)
    assume(cut.is_valid and cut.area > 0)
    cells = liftmesh.voronoi(np.array(rows, dtype=float), domain=shapely.box(0, 0, 8, 8) - cut)
    assert within_sides(cells) == []
    check(cells)


@pytest.mark.parametrize("side", [1, -1])
def test_a_notch_down_to_a_ridge_leaves_two_parts(side: int) -> None:
    notch = [(0, -2), (3, -2), (3, 2), (2, 2), (1.5, 0), (1, 2), (0, 2)]
    cells = liftmesh.voronoi([[1.5, -1], [1.5, 1]], domain=[(x, side * y) for x, y in notch])
    assert sorted(np.diff(cells.parts).tolist()) == [1, 2]
    assert cells.not_simple.tolist() == []
    check(cells)


@pytest.mark.parametrize("order", [[0, 1, 2, 3], [2, 0, 1, 3], [1, 3, 2, 0], [3, 2, 1, 0]])
def test_neighbors_meet_across_a_degenerate_cell(order: list[int]) -> None:
    points, weights = np.array([[0, 0], [2, 0], [1, 0], [9, 9]]), np.array([0, 0, -1, 0])
    cells = liftmesh.power_diagram(points[order], weights=weights[order], domain=BOX)
    names = np.array(order)[cells.neighbors]
    assert np.sort(names, axis=1).tolist() == [[0, 1]]
    assert cells.shared_lengths.tolist() == [2.0]
    assert np.array(order)[cells.degenerate].tolist() == [2]
    assert cells.degenerate in cells.empty
    line = liftmesh.power_diagram(points[:3], weights=weights[:3], domain=BOX)
    assert line.neighbors.tolist() == [[0, 1]]
    assert (line.degenerate.tolist(), line.hidden.tolist()) == ([2], [])


def test_rows_on_a_line_are_degenerate_or_hidden_by_the_hull_at_the_end() -> None:
    steps = np.arange(-6.0, 7.0)
    weights = steps**2 - np.array([0, 1, 0, 2, 0, 0, 3, 0, 0, 1, 0, 0, 0])
    weights -= np.abs(steps) * 4  # the lift is a wedge, with some rows above it
    cells = liftmesh.power_diagram(np.c_[steps, steps], weights=2 * weights, domain=(-9, -9, 9, 9))
    check(cells, [Fraction(2 * w) for w in weights.tolist()])
    assert cells.hidden.tolist() == [1, 3, 9]
    assert cells.degenerate.tolist() == [2, 4, 8, 10, 11]


def test_rings_of_the_domain_that_touch_at_an_edge() -> None:
    hole = [(1, 0), (2, 1), (1, 2)]
    domain = shapely.Polygon([(0, 0), (4, 0), (4, 4), (0, 4)], [hole])
    for points in ([[1, 1]], [[0.5, 1], [1.5, 1]], [[1, 0.5], [1, 1.5]], [[0, 0], [2, 2]]):
        cells = liftmesh.voronoi(points, domain=domain)
        assert cells.not_simple.tolist() == []
        check(cells)


def test_a_hole_too_small_for_products_is_a_hole() -> None:
    hole = np.array([[1, 1], [3, 1], [2, 3]]) * 1e-170
    domain = shapely.Polygon(shapely.box(0, 0, 1, 1).exterior, [hole])
    cells = liftmesh.voronoi([[0.5, 0.5]], domain=domain)
    assert (np.diff(cells.parts).tolist(), np.diff(cells.rings).tolist()) == ([1], [2])


CORNER = st.tuples(st.integers(-4, 4), st.integers(-4, 4))
PIECE = st.tuples(CORNER, st.integers(1, 5), st.integers(1, 5), st.integers(0, 4), st.booleans())


def domain_of(pieces) -> shapely.Geometry:
    """Boxes and halves of squares, united or taken away."""
    domain = shapely.Polygon()
    for (x, y), width, height, corner, is_added in pieces:
        box = shapely.box(x, y, x + width, y + (height if corner == 4 else width))
        if corner < 4:
            box = shapely.Polygon(np.delete(shapely.get_coordinates(box)[:4], corner, axis=0))
        domain = domain.union(box) if is_added else domain.difference(box)
    return domain


@pytest.mark.slow
@given(SITES, st.lists(PIECE, min_size=1, max_size=6), st.sampled_from([1, 2]), st.data())
def test_cells_of_points_and_domains_on_one_lattice(points, pieces, finer: int, data) -> None:
    domain = domain_of(pieces)
    assume(domain.geom_type in ("Polygon", "MultiPolygon") and domain.area > 0 and domain.is_valid)
    values = st.lists(st.integers(-4, 4), min_size=len(points), max_size=len(points))
    weights = data.draw(st.one_of(st.just([0] * len(points)), values))
    cells = liftmesh.power_diagram(points / finer, weights=weights, domain=domain)
    check(cells, [*map(Fraction, weights)])


WHEEL = sorted(
    {(x, y) for x in range(-325, 326) for y in range(-325, 326) if x * x + y * y == 325**2},
    key=lambda at: math.atan2(at[1], at[0]),
)
"""Sixty points on a circle: the cell of its centre is searched, not scanned."""


@pytest.mark.parametrize("kind", ["plain", "weights"])
@pytest.mark.parametrize("reach", [[2], [2, 3], [1, 3, 3], [2, 1, 2, 3]])
def test_a_hub_with_corners_and_edges_of_the_domain_on_its_ridges(kind: str, reach) -> None:
    """Half way to a neighbour is its ridge; an edge lies along that of (325, 0)."""
    star = np.array(WHEEL) * np.resize(np.array(reach) / 4, len(WHEEL))[:, None]
    star = np.vstack([star[: len(WHEEL) // 2 - 1], [(162.5, -4), (162.5, 4)], star[30:]])
    domain = shapely.Polygon(star, [[(1, 1), (2, 1), (1, 2)], [(9, 1), (9, 2), (8, 1)]])
    weights = np.zeros(len(WHEEL) + 1) if kind == "plain" else np.arange(61.0) % 2
    cells = liftmesh.power_diagram([(0, 0), *WHEEL], weights=weights, domain=domain)
    exact_weights, rings = [*map(Fraction, weights)], domain_rings(cells)
    parts = rings_of(cells, exact_corners(cells, exact_weights))
    areas = [sum((area(ring) for part in of for ring in part), Fraction(0)) for of in parts]
    sites = [exact_point(point) for point in cells.points]
    assert areas[0] == cell_area(0, sites, exact_weights, rings)
    assert sum(areas) == sum(map(area, rings))
    assert cells.not_simple.tolist() == []
