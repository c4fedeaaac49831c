"""Cells of disks: polygons that fill the domain, near exact arcs, and equal to `voronoi`'s."""

from __future__ import annotations

import decimal
from decimal import Decimal
from itertools import pairwise, product
from typing import TYPE_CHECKING, Any

import geopandas
import numpy as np
import pandas as pd
import pytest
import shapely
from sites import (
    anywhere,
    beside_a_large_one,
    between_two_large_ones,
    in_a_row,
    on_lattice,
    touching_a_circle,
)

import liftmesh
from liftmesh import ApolloniusCells, InputError, NonFiniteError
from liftmesh.disks.sides import Arcs

if TYPE_CHECKING:
    from liftmesh.cells.domain import Domain

Disks = np.ndarray
HARBOUR = (
    shapely.Point(0.5, 0.5).buffer(0.6)
    - shapely.Point(0.45, 0.5).buffer(0.1)
    - shapely.box(0.2, 0.7, 0.2001, 0.7002)
    - shapely.box(0.7, -0.2, 0.72, 0.6)
) | shapely.box(2, 0, 3, 1)


def cells_of(
    disks: Disks, domain: object = None, max_deviation: float | None = None
) -> ApolloniusCells:
    return liftmesh.apollonius_diagram(
        disks[:, :2], disks[:, 2], domain=domain, max_deviation=max_deviation
    )


def size_of(domain: Domain) -> float:
    rings = [domain.corners[a:b] for a, b in pairwise(domain.starts.tolist())]
    return float(
        sum(shapely.Polygon(ring).area * (1 - 2 * hole)
            for ring, hole in zip(rings, domain.is_hole, strict=True))
    )  # fmt: skip


def row_of_corners(cells: ApolloniusCells) -> np.ndarray:
    rows = np.repeat(np.arange(len(cells.points)), np.diff(cells.parts))
    return np.repeat(np.repeat(rows, np.diff(cells.rings)), np.diff(cells.ring_corners))


def next_corners(cells: ApolloniusCells) -> np.ndarray:
    following = np.arange(1, len(cells.corners) + 1)
    following[cells.ring_corners[1:] - 1] = cells.ring_corners[:-1]
    return following


def excess(disks: Disks, places: np.ndarray, rows: np.ndarray) -> float:
    """By how much another disk is nearer to a place than that of its cell, at most."""
    apart = np.hypot(*(places[:, None] - disks[:, :2]).transpose(2, 0, 1)) - disks[:, 2]
    return float((apart[np.arange(len(rows)), rows] - apart.min(1)).max())


def check(disks: Disks, cells: ApolloniusCells) -> None:
    """Cells fill the domain without overlap, share their sides, and are near the true ones."""
    shapes = cells.to_shapely()
    assert shapely.is_valid(shapes).all()
    total = size_of(cells.domain)
    rounding = 1e-15 * shapely.length(shapes).sum() * (1 + np.abs(cells.corners).max())
    assert abs(cells.areas.sum() - total) <= 1e-12 * total + rounding
    assert abs(shapely.union_all(shapes).area - total) <= 1e-9 * total + rounding
    rows, ahead = row_of_corners(cells), cells.corners[next_corners(cells)]
    for share in (0.0, 0.25, 0.5, 0.75):
        places = (1 - share) * cells.corners + share * ahead
        assert (
            excess(disks, places, rows) < 2.01 * cells.max_deviation
        )  # a place is so far off a side
    inner = cells.beyond >= 0
    there = np.concatenate([cells.corners[inner], ahead[inner]], axis=1)
    back = np.concatenate([ahead[inner], cells.corners[inner]], axis=1)
    assert set(map(tuple, there.tolist())) == set(map(tuple, back.tolist()))
    assert set(cells.hidden) | {row for row, _ in cells.duplicates} <= set(cells.empty)


@pytest.mark.parametrize(
    "family",
    [on_lattice, in_a_row, anywhere, touching_a_circle, beside_a_large_one, between_two_large_ones],
)
def test_cells_fill_boxes_and_polygons(family: object) -> None:
    for seed, n in product(range(2), (1, 2, 3, 9, 40)):
        rng = np.random.default_rng(seed)
        disks = family(rng, max(n, 2))[:n]  # type: ignore[operator]
        low, high = disks[:, :2].min(0), disks[:, :2].max(0)
        size = max(float((high - low).max()), 1.0)
        moved = shapely.affinity.translate(shapely.affinity.scale(HARBOUR, size, size), *low)
        part = (*low, *(low + size * np.array([0.3, 0.4])))
        for domain, max_deviation in (
            (None, None),
            (moved, None),
            (moved, size),
            (part, size / 1e4),
        ):
            check(disks, cells_of(disks, domain, max_deviation))


def test_equal_radii_give_the_cells_of_voronoi() -> None:
    points = np.random.default_rng(1).random((200, 2))
    points[7] = points[5]
    for radius, domain in product((0.0, 0.3), (None, HARBOUR)):
        expected = liftmesh.voronoi(points, domain=domain)
        found = liftmesh.apollonius_diagram(points, np.full(200, radius), domain=domain)
        for name in ("corners", "rings", "parts", "ring_corners", "beyond", "duplicates", "areas",
                     "corner_kinds", "corner_sources"):  # fmt: skip
            np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))


def test_sides_of_equal_disks_are_straight_also_among_others() -> None:
    cells = cells_of(np.array([[0, 0, 1], [4, 0, 1], [2, 9, 0.5]]), (-2, -2, 6, 3))
    straight = [k for k in cells.corner_sources.tolist() if set(k[:2]) == {0, 1} and k[2] == -1]
    assert straight == []
    assert cells.shared_lengths[0] == pytest.approx(5, abs=0.6)


def true_distance(place: np.ndarray, disk: np.ndarray) -> Decimal:
    x, y, r = (Decimal(float(v)) for v in disk)
    u, v = (Decimal(float(w)) for w in place)
    return ((u - x) ** 2 + (v - y) ** 2).sqrt() - r


@pytest.mark.parametrize("scale", [1.0, 2.0**-300, 2.0**300])
@pytest.mark.parametrize("kind", ["apart", "nearly hidden", "many sizes"])
def test_points_are_on_arcs_and_chords_near_them(kind: str, scale: float) -> None:
    """With 60 digits: how far a place is off an arc is half of what its two distances differ by.

    That is so at right angles to a line through both centres, where both distances change with the
    full step; elsewhere they change by less, and the place is farther off: by the sine of half of
    the angle between the directions to both disks.
    """
    decimal.getcontext().prec = 60
    rng = np.random.default_rng(11)
    disks = np.c_[rng.random((12, 2)), rng.random(12) * 0.1]
    if kind == "nearly hidden":
        angles, radii = rng.random(12) * 2 * np.pi, rng.random(12) * 0.5
        out = radii * (1 + 10.0 ** -rng.integers(3, 14, 12))
        disks = np.column_stack([(1 - radii) * np.cos(angles), (1 - radii) * np.sin(angles), out])
        disks[0] = 0, 0, 1
    if kind == "many sizes":
        disks[:, 2] = 10.0 ** rng.uniform(-9, -0.7, 12)
    cells = cells_of(disks * scale, tuple(np.array([-1.5, -1.5, 1.5, 1.5]) * scale), 1e-3 * scale)
    rows, ahead = row_of_corners(cells), cells.corners[next_corners(cells)]
    own = np.flatnonzero(cells.beyond >= 0)
    assert len(own) > 20
    for k in own.tolist():
        pair = disks[[rows[k], cells.beyond[k]]] * scale
        for share in (0.0, 0.3, 0.5):
            place = (1 - share) * cells.corners[k] + share * ahead[k]
            off = abs(true_distance(place, pair[0]) - true_distance(place, pair[1]))
            towards = (pair[:, :2] - place) / scale
            a, b = np.arctan2(*towards.T[::-1])
            sine = max(abs(np.sin((a - b) / 2)), 1e-12)
            is_node = share == 0 and cells.corner_kinds[k] != 1
            limit = 1e-13 if is_node else 1.02e-3 * 2 * sine + 1e-13
            assert off < limit * scale


def test_a_finer_tolerance_has_more_points_and_nearer_areas() -> None:
    disks = anywhere(np.random.default_rng(3), 30)
    exact = cells_of(disks, (0, 0, 1, 1), 1e-9).areas
    errors, counts = [], []
    for max_deviation in (1e-2, 1e-4, 1e-6):
        cells = cells_of(disks, (0, 0, 1, 1), max_deviation)
        errors.append(np.abs(cells.areas - exact).max())
        counts.append(len(cells.corners))
    assert errors[0] > 10 * errors[1] > 100 * errors[2]
    assert counts == sorted(counts)
    assert errors[2] < 4e-6


@pytest.mark.parametrize("exponent", [-900, 900])
def test_the_default_tolerance_follows_the_coordinates(exponent: int) -> None:
    disks, scale = anywhere(np.random.default_rng(18), 30), 2.0**exponent
    for domain in (None, (0, 0, 1, 0.5)):
        box = None if domain is None else tuple(scale * value for value in domain)
        cells, scaled = cells_of(disks, domain), cells_of(scale * disks, box)
        assert scaled.max_deviation == scale * cells.max_deviation
        np.testing.assert_allclose(scaled.corners / scale, cells.corners, rtol=1e-12)
        np.testing.assert_array_equal(scaled.parts, cells.parts)


@pytest.mark.parametrize("max_deviation", [1e9, 1e20, 1e300])
def test_a_tolerance_beyond_the_domain_is_that_of_its_side(max_deviation: float) -> None:
    disks = anywhere(np.random.default_rng(18), 30)
    cells, widest = cells_of(disks, HARBOUR, max_deviation), cells_of(disks, HARBOUR, 3.1)
    check(disks, cells)
    np.testing.assert_array_equal(cells.corners, widest.corners)
    sides, coarse = (cells.graph.cell_sides((0, 0, 1, 2), by) for by in (max_deviation, 2.0))
    assert all(np.array_equal(a, b) for (_, a), (_, b) in zip(sides, coarse, strict=True))


def test_the_area_of_a_cell_is_that_of_a_parabola_where_a_hyperbola_is_known() -> None:
    """Between (0, 0) with 0 and (4, 0) with 2: x = 1 + ... on (x - 2)^2 - y^2 / 3 = 1."""
    cells = cells_of(np.array([[0, 0, 0.0], [4, 0, 2]]), (-1, -1, 4, 1), 1e-7)
    root = 1 / np.sqrt(3)
    beyond = np.sqrt(1 + 1 / 3) / 2 * 2 + np.arcsinh(root) / root  # integral of sqrt(1 + y^2 / 3)
    assert cells.areas[0] == pytest.approx(6 - beyond, abs=4e-7)
    x, y = cells.corners[cells.corner_kinds == 3].T
    np.testing.assert_allclose((x - 2) ** 2 - y**2 / 3, 1, atol=1e-14)


def test_few_disks_and_domains_without_a_vertex() -> None:
    one = cells_of(np.array([[5, 5, 2.0]]), (0, 0, 1, 1))
    assert (one.areas.tolist(), one.neighbors.tolist()) == ([1.0], [])
    far = cells_of(np.array([[0, 0, 1.0], [5, 0, 0]]), (1e6, 1e6, 1e6 + 1, 1e6 + 1))
    assert far.areas.tolist() == [0.0, 1.0]
    disks = np.array([[0, 0, 3.0], [0, 0, 1], [10, 0, 1], [10, 0, 1], [3.5, 0, 0.25]])
    cells = cells_of(disks, (-5, -5, 15, 5))
    check(disks, cells)
    assert cells.hidden.tolist() == [1]
    assert cells.duplicates.tolist() == [[3, 2]]
    assert cells.empty.tolist() == [1, 3]
    assert np.isnan(cells.centroids[1]).all()
    hole = shapely.box(8, 8, 30, 30) - shapely.box(24, 24, 25, 25)
    inside = cells_of(disks, hole)
    assert np.flatnonzero(inside.areas).tolist() == [0, 2]
    check(disks, inside)


@pytest.mark.parametrize("scale", [1.0, 2.0**-900, 2.0**900])
@pytest.mark.parametrize(
    ("disks", "domain", "row"),
    [
        ([(3, 0, 1), (2, 0, 2)], (4, 0, 5, 1), 1),  # tangent from inside: as near, and hidden
        ([(2, 0, 2), (3, 0, 1)], (4, 0, 5, 1), 0),
        ([(1, 1, 2), (0, 0, 1), (1, 1, 2)], (4, 0, 5, 1), 0),
        ([(0, 0, 0), (0, 1, 1e-9)], (1e9, 30, 1e9 + 1, 31), 1),  # nearer by 3e-8
        ([(0, 1, 1e-9), (0, 0, 0)], (1e9, 30, 1e9 + 1, 31), 0),
        ([(0, 0, 0), (0, 1, 1e-9)], (1e9, -30, 1e9 + 1, -29), 0),
        ([(0, 1, 1e-9), (0, 0, 0)], (1e9, -30, 1e9 + 1, -29), 1),
        # Rounded, the first of each pair is nearer.
        ([(-6, -1, 1.6952849536743164), (0, 0, 0)], (1095872739, 9.3e9, 1095872740, 9.3e9 + 1), 1),
        ([(0, 0, 0), (-5, -9, 10.295016046325683)], (5088626994, 9.4e9, 5088626995, 9.4e9 + 1), 1),
        ([(0, 0, 0), (0, 1, 1e-9)], (1e15, 10, 1e15 + 1, 11), 1),  # all but the radius is rounded
    ],
)
def test_a_domain_without_sides_is_of_the_nearest_disk(
    disks: list[tuple[float, ...]], domain: tuple[float, ...], row: int, scale: float
) -> None:
    box, coarse = scale * np.array(domain), scale * max(1.0, 1e-13 * domain[0])
    cells = cells_of(scale * np.array(disks), tuple(box), coarse)
    assert np.flatnonzero(np.diff(cells.parts)).tolist() == [row]


def test_rings_that_no_side_crosses_are_found_wherever_they_are() -> None:
    rng = np.random.default_rng(8)
    disks = np.c_[rng.random((20, 2)), rng.random(20) * 0.2]
    places = rng.random((40, 2))
    lakes = shapely.union_all([shapely.box(x, y, x + 1e-5, y + 2e-5) for x, y in places])
    islands = shapely.union_all([shapely.box(x, y, x + 1e-5, y + 2e-5) for x, y in places + 0.001])
    for domain in (shapely.box(-1, -1, 2, 2) - lakes, islands):
        cells = cells_of(disks, domain)
        check(disks, cells)
        held = cells.to_shapely()
        for x, y in places + (0.001 if domain is islands else -1e-7):
            apart = np.hypot(*(disks[:, :2] - (x, y)).T) - disks[:, 2]
            first, second = np.sort(apart)[:2]
            if second - first > 3 * cells.max_deviation:
                assert held[apart.argmin()].distance(shapely.Point(x, y)) < 1e-12


def test_ties_with_the_domain_leave_whole_cells() -> None:
    """Edges of the domain lie on straight sides, and its corners on vertices and sides."""
    grid = np.stack(np.meshgrid(np.arange(6.0), np.arange(6.0)), -1).reshape(-1, 2)
    disks = np.column_stack([grid, np.full(36, 0.25)])
    disks[14, 2] = 0.5
    corner = [(0.5, 0.5), (4.5, 0.5), (4.5, 4.5), (2.5, 4.5), (2.5, 3.5), (0.5, 3.5)]
    for domain in ((0.5, 0.5, 4.5, 4.5), (0, 0, 5, 5), shapely.Polygon(corner), corner):
        cells = cells_of(disks, domain, 1e-3)
        check(disks, cells)
        far = (np.abs(grid - grid[14]).max(1) > 1.5) & (cells.areas > 0)
        whole = far & (grid > 0).all(1) & (grid < 5).all(1)
        quarters = cells.areas[far] * 4
        np.testing.assert_allclose(quarters, quarters.round(), rtol=1e-14)
        np.testing.assert_allclose(cells.areas[whole & (grid < 4).all(1)], 1, rtol=1e-14)
    outside = cells_of(disks, (0.5, 0.5, 4.5, 4.5), 1e-3)
    assert set(np.flatnonzero(outside.areas)) == {
        i for i, (x, y) in enumerate(grid) if 0 < x < 5 and 0 < y < 5
    }


def test_corners_say_where_they_come_from() -> None:
    disks = anywhere(np.random.default_rng(9), 25)
    cells = cells_of(disks, HARBOUR)
    rows = row_of_corners(cells)
    assert set(cells.corner_kinds.tolist()) == {0, 1, 2, 3}
    domain = cells.domain
    for kind, source, place, row in zip(
        cells.corner_kinds, cells.corner_sources, cells.corners, rows, strict=True
    ):
        if kind == 2:
            assert place.tolist() == domain.corners[source[0]].tolist()
            continue
        among = source[: 3 if kind == 0 else 2]
        assert row in among
        apart = np.hypot(*(disks[among, :2] - place).T) - disks[among, 2]
        assert np.ptp(apart) < (2.01 * cells.max_deviation if kind == 1 else 1e-14)
        if kind == 1:
            a, b = domain.corners[source[2]], domain.corners[domain.following[source[2]]]
            assert shapely.LineString([a, b]).distance(shapely.Point(place)) < 1e-15


def test_neighbors_are_edges_of_the_graph() -> None:
    disks = anywhere(np.random.default_rng(10), 60)
    cells = cells_of(disks, (-3, -3, 4, 4))
    edges = {tuple(edge) for edge in cells.graph.edges.tolist()}
    assert {tuple(pair) for pair in cells.neighbors.tolist()} <= edges
    shapes = cells.to_shapely()
    for (a, b), length in zip(cells.neighbors.tolist(), cells.shared_lengths, strict=True):
        assert shapes[a].intersection(shapes[b]).length == pytest.approx(length, rel=1e-9)


def test_the_order_of_rows_changes_no_polygon() -> None:
    rng = np.random.default_rng(12)
    disks, order = anywhere(rng, 50), rng.permutation(50)
    first, second = cells_of(disks), cells_of(disks[order])
    for row, shape in enumerate(second.to_shapely()):
        assert shape.symmetric_difference(first.to_shapely()[order[row]]).area < 1e-12


def test_disks_come_from_tables_and_geopandas() -> None:
    disks = anywhere(np.random.default_rng(13), 12)
    expected = cells_of(disks).areas
    table = pd.DataFrame({"x": disks[:, 0], "y": disks[:, 1], "reach": disks[:, 2]})
    points = geopandas.GeoDataFrame(
        table[["reach"]], geometry=shapely.points(disks[:, :2]), crs="EPSG:25832"
    )
    np.testing.assert_array_equal(liftmesh.apollonius_diagram(table, "reach").areas, expected)
    cells = liftmesh.apollonius_diagram(points, "reach")
    np.testing.assert_array_equal(cells.areas, expected)
    frame = cells.to_geodataframe(points)
    assert frame.crs == points.crs
    assert frame.columns.tolist() == ["reach", "area", "geometry"]
    np.testing.assert_allclose(frame.geometry.area, expected, rtol=1e-9)


@pytest.mark.parametrize(
    ("radii", "domain", "max_deviation", "error", "message"),
    [
        ([1, -1.0], None, None, InputError, "row 1 has the radius -1.0"),
        ([1, np.nan], None, None, NonFiniteError, "row 1 has the radius nan: remove .* first$"),
        ([1, 1.5], None, 0, InputError, "max_deviation is 0: give a positive, finite number"),
        (
            [1, 1.5],
            None,
            np.inf,
            InputError,
            "max_deviation is inf: give a positive, finite number",
        ),
        (
            [1, 1.5],
            None,
            np.nan,
            InputError,
            "max_deviation is nan: give a positive, finite number",
        ),
        ([1, 1.5], None, True, InputError, "max_deviation is True: give a positive, finite number"),
        ([1, 1.5], None, -1e-3, InputError, "give a positive, finite number"),
        ([1, 1.5], None, 1e-20, InputError, "near the rounding of coordinates"),
        ([1, 1.5], (0, 0, 0, 1), None, InputError, "has no area"),
        ([1, 1.5], [(0, 0), (1, 1), (1, 0), (0, 1)], None, InputError, "no valid polygon"),
        ("reach", None, None, InputError, "reach"),
    ],
)
def test_errors(
    radii: object, domain: object, max_deviation: object, error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        liftmesh.apollonius_diagram(
            [[0, 0], [4, 0]], radii, domain=domain, max_deviation=max_deviation
        )  # type: ignore[arg-type]


def test_rows_that_are_not_finite_cannot_be_skipped() -> None:
    with pytest.raises(NonFiniteError, match=r"row 0 is not finite: .* remove such rows first$"):
        liftmesh.apollonius_diagram([[0, np.inf], [4, 0]], [1, 2])


@pytest.mark.parametrize("scale", [1.0, 1000.0])
def test_a_tolerance_of_too_many_points_is_refused_before_they_are_made(
    scale: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = []

    def counting(*given: Any) -> Any:
        made.append(len(given[1]))
        return coarse(*given)

    coarse = Arcs._coarse
    monkeypatch.setattr(Arcs, "_coarse", counting)
    rng = np.random.default_rng(19)
    disks = scale * np.c_[rng.random((30, 2)), rng.random(30) / 10]
    text = f"max_deviation is {2e-14 * scale!r}, by which arcs have more than 16,777,216 points"
    with pytest.raises(InputError, match=text):
        liftmesh.apollonius(disks[:, :2], disks[:, 2]).cell_sides(
            (0, 0, scale, scale), max_deviation=2e-14 * scale
        )
    assert 0 < sum(made) < 20_000


@pytest.mark.parametrize("kind", [anywhere, beside_a_large_one, between_two_large_ones])
def test_the_predicted_number_of_points_is_about_the_true_one(
    kind: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also in a small part of long arcs, and where a curve is sharp and its arms are long."""
    disks = kind(np.random.default_rng(20), 20)  # type: ignore[operator]
    disks = np.vstack([disks, [0.5, 0.5, 1e-9]])
    low, high = disks[:, :2].min(0), disks[:, :2].max(0)
    size = float((high - low).max())
    graph = liftmesh.apollonius(disks[:, :2], disks[:, 2])
    vertex, coarse = graph.circles[0, :2], Arcs._coarse
    for part in (1.0, 1e-3):
        told = [0.0]

        def counting(*given: Any, told: list[float] = told) -> Any:
            found = coarse(*given)
            told.append(found[1])
            return found

        monkeypatch.setattr(Arcs, "_coarse", counting)
        box = (*(vertex - part * size), *(vertex + part * size))
        points = sum(len(line) for _, line in graph.cell_sides(box, 1e-8 * size * part))
        monkeypatch.undo()
        assert points / 4 - 100 < max(told) < points


def test_no_disks() -> None:
    with pytest.raises(InputError, match="there are no disks"):
        liftmesh.apollonius_diagram(np.empty((0, 2)), [])


def test_a_run_reports_and_stops() -> None:
    centers = np.random.default_rng(14).random((100_000, 2))
    told: list[float] = []

    def stop(done: float) -> None:
        told.append(done)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        liftmesh.apollonius_diagram(centers, centers[:, 0] / 1000, progress=stop)
    assert len(told) == 1
