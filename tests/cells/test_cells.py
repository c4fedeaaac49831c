"""`voronoi` and `power_diagram`: cells that tile the domain exactly."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import hypothesis.strategies as st
import numpy as np
import pytest
import shapely
import shapely.affinity
from hypothesis import given
from numpy.typing import NDArray
from oracles.cells import cell_area, check, domain_rings, exact_point
from strategies import SITES

import liftmesh

Points = NDArray[np.float64]
RNG = np.random.default_rng(1802)
SQUARE = [(0, 0), (6, 0), (6, 6), (0, 6)]
DOMAINS = {
    "box": shapely.box(-1, -1, 5, 3),
    "narrow": shapely.box(0, 0, 4, 1),
    "triangle": shapely.Polygon([(-3, -3), (7, -2), (1, 5)]),
    "L": shapely.Polygon([(-2, -2), (4, -2), (4, 0), (1, 0), (1, 4), (-2, 4)]),
    "U": shapely.Polygon([(-3, -3), (5, -3), (5, 4), (3, 4), (3, -1), (-1, -1), (-1, 4), (-3, 4)]),
    "hole": shapely.Polygon(SQUARE, [[(2, 2), (4, 2), (4, 4), (2, 4)]]),
    "diamond hole": shapely.Polygon(SQUARE, [[(3, 1), (5, 3), (3, 5), (1, 3)]]),
    "holes": shapely.Polygon(
        [(-4, -4), (4, -4), (4, 4), (-4, 4)],
        [
            [(-3, -3), (-1, -3), (-1, -1)],
            [(0, 0), (1, 0), (1, 1), (0, 1)],
            [(2, -3), (3, -3), (3, 3)],
        ],
    ),
    "islands": shapely.MultiPolygon(
        [
            (SQUARE, [[(1, 1), (5, 1), (5, 5), (1, 5)]]),
            ([(2, 2), (4, 2), (4, 4), (2, 4)], [[(2.5, 2.5), (3.5, 2.5), (3, 3.5)]]),
            ([(-3, 0), (-1, 0), (-2, 2)], []),
        ]
    ),
    "touching": shapely.MultiPolygon(
        [([(0, 0), (2, 0), (2, 2), (0, 2)], []), ([(2, 2), (4, 2), (4, 4), (2, 4)], [])]
    ),
    "star": shapely.Polygon(
        [(0, 5), (1, 1), (5, 0), (1, -1), (0, -5), (-1, -1), (-5, 0), (-1, 1)]
    ),
    "slit": shapely.Polygon([(0, 0), (4, 0), (4, 4), (2.001, 4), (2, 1), (1.999, 4), (0, 4)]),
}  # fmt: skip


@pytest.mark.slow
@given(SITES, st.sampled_from([*DOMAINS]), st.sampled_from([(0, 0), (1, 1), (0.5, -1)]))
def test_cells_tile_the_domain_exactly(points: Points, domain: str, shift: Any) -> None:
    moved = shapely.affinity.translate(DOMAINS[domain], *shift)
    check(liftmesh.voronoi(points, domain=moved))


@pytest.mark.slow
@given(SITES, st.sampled_from([*DOMAINS]), st.data())
def test_power_cells_tile_the_domain_exactly(points: Points, domain: str, data: Any) -> None:
    kind = data.draw(st.sampled_from(["weights", "radii"]))
    least = -4 if kind == "weights" else 0
    value = st.integers(least, 6).map(float)
    values = data.draw(st.lists(value, min_size=len(points), max_size=len(points)))
    cells = liftmesh.power_diagram(points, **{kind: values}, domain=DOMAINS[domain])
    check(cells, [Fraction(v) ** (2 if kind == "radii" else 1) for v in values])


@pytest.mark.slow
@pytest.mark.parametrize("domain", DOMAINS)
def test_generic_sites(domain: str) -> None:
    points = RNG.random((14, 2)) * 9 - 3
    check(liftmesh.voronoi(points, domain=DOMAINS[domain]))
    weights = RNG.random(14) * 2
    check(
        liftmesh.power_diagram(points, weights=weights, domain=DOMAINS[domain]),
        [Fraction(w) for w in weights.tolist()],
    )


LINES = {
    "one": [[1, 1]],
    "two": [[1, 1], [3, 2]],
    "on a line": [[0, 0], [1, 1], [3, 3], [2, 2], [1, 1]],
    "upright": [[2, 0], [2, 3], [2, 1]],
    "one position": [[2, 2], [2, 2]],
}


@pytest.mark.parametrize("domain", DOMAINS)
@pytest.mark.parametrize("name", LINES)
def test_few_sites_and_sites_on_a_line(name: str, domain: str) -> None:
    points = np.array(LINES[name], dtype=float)
    check(liftmesh.voronoi(points, domain=DOMAINS[domain]))
    weights = np.arange(len(points)) * 2.0
    lowered = [Fraction(w) for w in weights.tolist()]
    cells = liftmesh.power_diagram(points, weights=weights, domain=DOMAINS[domain])
    hidden = {*cells.hidden.tolist()}
    seen = [row for row in range(len(points)) if row not in hidden]
    sites = [exact_point(point) for point in points]
    for row in seen:
        area_of_row = cell_area(
            seen.index(row), [sites[i] for i in seen], [lowered[i] for i in seen],
            domain_rings(cells),
        )  # fmt: skip
        assert cells.areas[row] == pytest.approx(float(area_of_row))
    assert cells.areas.sum() == pytest.approx(DOMAINS[domain].area)


def test_hidden_rows_on_a_line() -> None:
    cells = liftmesh.power_diagram([[0, 0], [1, 0], [2, 0]], radii=[2, 0, 2], domain=(0, 0, 2, 1))
    assert cells.hidden.tolist() == [1]
    assert cells.areas.tolist() == [1, 0, 1]
    assert cells.neighbors.tolist() == [[0, 2]]


@pytest.mark.parametrize("offset", [0, 1e6, 1e8])
def test_cells_are_those_of_shapely(offset: float) -> None:
    points = np.round(RNG.random((300, 2)) * 2**20) / 2**20 + offset
    star = shapely.affinity.scale(DOMAINS["star"], 0.1, 0.1, origin=(0, 0))
    domain = shapely.affinity.translate(star, offset + 0.5, offset + 0.5)
    ours = liftmesh.voronoi(points, domain=domain)
    near = liftmesh.voronoi(points - offset, domain=shapely.affinity.translate(star, 0.5, 0.5))
    np.testing.assert_array_equal(ours.beyond, near.beyond)
    np.testing.assert_allclose(ours.areas, near.areas, atol=1e-7 if offset else 0)
    if offset:
        return
    sites = shapely.MultiPoint(points)
    theirs = shapely.voronoi_polygons(sites, extend_to=domain, ordered=True)
    clipped = shapely.intersection([*theirs.geoms], domain)
    np.testing.assert_allclose(ours.areas, shapely.area(clipped), atol=1e-12)
    np.testing.assert_allclose(shapely.area(ours.to_shapely()), ours.areas, atol=1e-12)
    full = ours.areas > 1e-9
    centres = shapely.get_coordinates(shapely.centroid(clipped[full]))
    np.testing.assert_allclose(ours.centroids[full], centres, atol=1e-9)
    assert np.isnan(ours.centroids[ours.empty]).all()
    assert ours.not_simple.tolist() == []


@pytest.mark.slow
def test_a_large_set_tiles_its_domain() -> None:
    points = RNG.random((8_000, 2))
    turns = np.sort(RNG.random(2000)) * 2 * np.pi
    radius = 0.45 + 0.05 * RNG.random(2000)
    coast = np.c_[np.cos(turns), np.sin(turns)] * radius[:, None] + 0.5
    cells = liftmesh.voronoi(points, domain=coast)
    polygons = cells.to_shapely()
    domain = shapely.Polygon(coast)
    assert cells.areas.sum() == pytest.approx(domain.area, rel=1e-12)
    assert shapely.is_valid(polygons).all()
    assert shapely.union_all(polygons).symmetric_difference(domain).area < 1e-9
    assert shapely.covers(domain.buffer(1e-12), polygons[cells.areas > 0]).all()


def test_the_default_box_is_said() -> None:
    cells = liftmesh.voronoi([[0, 0], [10, 0], [0, 5]])
    assert cells.domain.corners.tolist() == [[-1, -1], [11, -1], [11, 6], [-1, 6]]
    assert "widened by 1.0 on each side (a tenth of its longer side)" in repr(cells)
    assert liftmesh.voronoi([[3, 4]]).areas.tolist() == [4]


def test_domains_of_every_form() -> None:
    points = RNG.random((30, 2)) * 6
    shape = DOMAINS["L"]
    expected = liftmesh.voronoi(points, domain=shape).areas
    corners = shapely.get_coordinates(shape)
    for domain in (
        shape.reverse(), shape.__geo_interface__, corners, corners[:-1], corners[::-1].tolist(),
        shapely.force_3d(shape), shapely.MultiPolygon([shape]),
    ):  # fmt: skip
        found = liftmesh.voronoi(points, domain=domain).areas
        np.testing.assert_allclose(found, expected, atol=1e-12)


def test_polygons_and_a_geodataframe() -> None:
    cells = liftmesh.voronoi([[1, 3], [1, -3], [99, 99]], domain=DOMAINS["U"])
    shapes = cells.to_shapely()
    assert [shape.geom_type for shape in shapes] == ["MultiPolygon", "Polygon", "Polygon"]
    assert shapes[2].is_empty
    assert cells.empty.tolist() == [2]
    frame = cells.to_geodataframe({"name": ["a", "b", "c"]}, crs="EPSG:32633")
    assert [*frame.columns] == ["name", "area", "geometry"]
    np.testing.assert_allclose(frame.geometry.area, cells.areas)


BAD = {
    "crossing": ([(0, 0), (2, 2), (2, 0), (0, 2)], r"Self-intersection\[1 1\]"),
    "spike": (shapely.Polygon([(0, 0), (4, 0), (4, 4), (4, -2)]), "no valid polygon"),
    "empty": (shapely.Polygon(), "domain is empty"),
    "point": (shapely.Point(1, 1), "domain is a Point"),
    "flat box": ((0, 0, 0, 1), "which has no area"),
    "turned box": ((2, 0, 0, 1), "which has no area"),
    "nan": ((0, 0, np.nan, 1), "not finite"),
    "infinite": ([(0, 0), (np.inf, 0), (1, 1)], "not finite"),
    "too large": (
        shapely.affinity.scale(DOMAINS["hole"], 2.0**900, 2.0**900, origin=(0, 0)),
        "GEOS cannot tell",
    ),
    "word": ("box", "domain is 'box'"),
    "shape": ([1, 2, 3], r"shape \(3,\)"),
    "mapping": ({"type": "Point"}, "cannot be converted to a polygon"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_domains_are_named(name: str) -> None:
    domain, message = BAD[name]
    with pytest.raises(liftmesh.InputError, match=message):
        liftmesh.voronoi([[0, 0], [1, 0], [0, 1]], domain=domain)


def test_bad_points_and_weights_are_named() -> None:
    square = [[0, 0], [1, 0], [0, 1], [1, 1]]
    with pytest.raises(liftmesh.InputError, match="no points"):
        liftmesh.voronoi(np.empty((0, 2)))
    with pytest.raises(liftmesh.NonFiniteError, match="row 1 is not finite"):
        liftmesh.voronoi([[0, 0], [np.nan, 0], [0, 1], [1, 1]])
    with pytest.raises(liftmesh.NonFiniteError, match="row 2 has the weight inf"):
        liftmesh.power_diagram(square, weights=[0, 0, np.inf, 0])
    with pytest.raises(liftmesh.InputError, match="row 3 has the radius -1"):
        liftmesh.power_diagram(square, radii=[0, 0, 0, -1])
    with pytest.raises(liftmesh.InputError, match="weights hold 2 numbers for 4 rows"):
        liftmesh.power_diagram(square, weights=[0, 0])
    with pytest.raises(liftmesh.InputError, match="neither weights nor radii"):
        liftmesh.power_diagram(square)
    with pytest.raises(liftmesh.InputError, match="cannot be widened"):
        liftmesh.voronoi([[-1.5e308, 0], [1.5e308, 0], [0, 1]])


def test_coordinates_of_every_magnitude() -> None:
    points = RNG.random((12, 2)) * 9 - 3
    for scale in (2.0**-1060, 2.0**-400, 2.0**300, 2.0**900):
        box = tuple(scale * side for side in (-1, -1, 5, 3))
        rounded_points = np.round(points * 64) / 64 * scale
        cells = liftmesh.voronoi(rounded_points, domain=box)
        check(cells)
        assert np.isfinite(np.delete(cells.centroids, cells.empty, axis=0)).all()
    hole = shapely.affinity.scale(DOMAINS["hole"], 2.0**300, 2.0**300, origin=(0, 0))
    check(liftmesh.voronoi([[2.0**300 * 3, 2.0**300 * 3]], domain=hole))


@pytest.mark.parametrize("far", [1e155, 1e308, 1.7e308])
@pytest.mark.filterwarnings("error")
def test_small_cells_beside_huge_ones_keep_area_and_centroid(far: float) -> None:
    points = np.random.default_rng(0).random((30, 2))
    near = liftmesh.voronoi(points, domain=(-1e3, -1e3, 1e3, 1e3))
    cells = liftmesh.voronoi(points, domain=(-far, -far, far, far))
    inner = near.areas < 1
    assert inner.sum() == 21
    np.testing.assert_array_equal(cells.areas[inner], near.areas[inner])
    np.testing.assert_array_equal(cells.centroids[inner], near.centroids[inner])
    assert np.isinf(cells.areas[~inner]).all()
    assert not np.isnan(cells.centroids).any()
    assert len(cells.shared_lengths) == len(near.shared_lengths)
