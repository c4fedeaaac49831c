"""Faces left out of surfaces: which they are, what is left, and its boundary."""

from __future__ import annotations

import json
import pickle
import tracemalloc
from fractions import Fraction
from types import SimpleNamespace

import geopandas
import numpy as np
import pytest
import shapely
from hypothesis import given, settings, strategies as st
from oracles.surfaces import ExactSurface, exact_point, turn
from surfaces import LATTICE, LIMITS, covering, drawn, exactly, meadow, raster, trimmed

import liftmesh
from liftmesh.vector.polygons import as_polygons, contains, polygons_in

RING = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]]
HOLE = [[1.0, 1.0], [1.0, 2.0], [2.0, 2.0], [2.0, 1.0]]
POINTS = np.array([[0.5, 0.5], [1.5, 1.5], [3.0, 3.0], [5.0, 1.0]])


def is_inside(rings: list[np.ndarray], point: list[float]) -> bool:
    """Whether a ray to the right crosses the rings an odd number of times, in rationals."""
    at, crossed = exact_point(point), 0
    for ring in rings:
        for ends in zip(ring.tolist(), np.roll(ring, -1, axis=0).tolist(), strict=True):
            low, high = sorted(map(exact_point, ends), key=lambda end: end[1])
            crossed += low[1] <= at[1] < high[1] and turn(low, high, at) > 0
    return crossed % 2 == 1


def squares(oracle: ExactSurface, number: int) -> list[Fraction]:
    """The squares of the sides opposite each corner."""
    corners = [oracle.points[row] for row in oracle.faces[number]]
    ends = [(corners[k - 2], corners[k - 1]) for k in range(3)]
    return [(p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2 for p, q in ends]


def rim_flood(surface: liftmesh.Surface, is_long: list[list[bool]], gone: set[int]) -> set[int]:
    """Go through all faces until none is left out any more."""
    neighbors = surface.triangulation.neighbors.tolist()
    gone = {-1, *gone}
    while True:
        more = {
            face
            for face, sides in enumerate(is_long)
            if face not in gone and any(sides[k] and neighbors[face][k] in gone for k in range(3))
        }
        if not more:
            return gone - {-1}
        gone |= more


def mask_of(surface: liftmesh.Surface) -> set[int]:
    return set() if surface.mask is None else set(np.flatnonzero(surface.mask).tolist())


@settings(max_examples=50)
@given(LATTICE, LIMITS)
def test_masks_are_those_of_exact_lengths(points, limit: float) -> None:
    surface = drawn(points)
    if surface is None:
        return
    oracle = exactly(surface)
    every = range(len(oracle.faces))
    sides = [squares(oracle, number) for number in every]
    is_long = [[each > Fraction(limit) ** 2 for each in three] for three in sides]
    expected = {number for number in every if any(is_long[number])}
    found = trimmed(surface, max_edge=limit)
    assert (mask_of(found) if found else set(every)) == expected
    found = trimmed(surface, max_edge=limit, boundary_only=True)
    assert (mask_of(found) if found else set(every)) == rim_flood(surface, is_long, set())


@settings(max_examples=60)
@given(LATTICE, st.floats(0.4, 6))
def test_what_is_left_by_radius_is_the_alpha_shape(points, alpha: float) -> None:
    surface = drawn(points)
    if surface is None:
        return
    oracle = exactly(surface)
    radii = []
    for number, face in enumerate(oracle.faces):
        a, b, c = squares(oracle, number)
        area = turn(*(oracle.points[row] for row in face))
        radii.append(a * b * c / (4 * area * area))
    if any(abs(float(each) - alpha**2) < 1e-9 for each in radii):
        return
    expected = {number for number, each in enumerate(radii) if each > Fraction(alpha) ** 2}
    found = trimmed(surface, max_radius=alpha)
    assert (mask_of(found) if found else {*range(len(radii))}) == expected


@settings(max_examples=50)
@given(LATTICE, LIMITS, st.booleans(), st.randoms(use_true_random=False))
def test_the_boundary_bounds_the_faces(points, limit: float, inwards: bool, rng) -> None:
    surface = drawn(points)
    surface = surface and trimmed(surface, max_edge=limit, boundary_only=inwards)
    if surface is None:
        return
    oracle = exactly(surface)
    ends = {(face[k], face[(k + 1) % 3]) for face in oracle.faces for k in range(3)}
    rim = {(p, q) for p, q in ends if (q, p) not in ends}
    rings = [ring.tolist() for ring in surface.boundary()]
    found = [(ring[k - 1], ring[k]) for ring in rings for k in range(len(ring))]
    assert len(found) == len(rim)
    assert set(found) == rim
    for ring in rings:
        corners = [oracle.points[row] for row in ring]
        assert len(set(ring)) == len(ring)
        assert corners[0] == min(corners)
    assert [oracle.points[r[0]] for r in rings] == sorted(oracle.points[r[0]] for r in rings)
    rows = list(range(len(points)))
    rng.shuffle(rows)
    other = liftmesh.triangulate([points[row] for row in rows], on_duplicate="highest")
    other = other.trim(max_edge=limit, boundary_only=inwards)
    places = [[surface.triangulation.points[row].tolist() for row in ring] for ring in rings]
    assert places == [other.triangulation.points[r].tolist() for r in other.boundary()]


def test_the_rings_enclose_the_area_of_the_faces() -> None:
    surface = liftmesh.triangulate(meadow()).trim(max_edge=9)
    oracle = exactly(surface)
    origin = exact_point((0, 0))
    area = sum(turn(*(oracle.points[row] for row in face)) for face in oracle.faces)
    rings = [[oracle.points[row] for row in ring] for ring in surface.boundary()]
    signed = [sum(turn(origin, p, q) for p, q in zip(r, r[1:] + r[:1], strict=True)) for r in rings]
    assert sum(signed) == area
    assert min(signed) < 0 < max(signed)  # there is a pond


def test_trimming_inwards_keeps_the_pond_and_opens_the_bay() -> None:
    surface = liftmesh.triangulate(meadow())
    inwards, everywhere = surface.trim(max_edge=12, boundary_only=True), surface.trim(max_edge=12)
    assert np.isnan(everywhere.sample([50, 50]))
    assert np.isfinite(inwards.sample([50, 50]))
    assert np.isnan(inwards.sample([97, 50]))
    assert len(inwards.boundary()) == 1
    assert len(everywhere.boundary()) > 1
    again = inwards.trim(max_edge=12)
    np.testing.assert_array_equal(again.mask, everywhere.mask)


@settings(max_examples=60)
@given(LATTICE, LIMITS, st.lists(st.tuples(*[st.integers(0, 20).map(lambda i: i / 4)] * 2)))
def test_heights_are_those_of_the_faces_that_are_left(points, limit: float, queries) -> None:
    surface = drawn(points)
    surface = surface and trimmed(surface, max_edge=limit)
    if surface is None or not queries:
        return
    oracle = exactly(surface)
    gradients = surface.gradient(np.array(queries))
    for query, height, gradient in zip(
        queries, surface.sample(np.array(queries)).tolist(), gradients.tolist(), strict=True
    ):
        expected = oracle.height(exact_point(query))
        assert (expected is None) == np.isnan(height) == np.isnan(gradient[0])
        if expected is not None:
            assert abs(height - float(expected)) < 1e-12
            owner = oracle.owner(exact_point(query))
            exact = [float(each) for each in oracle.gradient_of(owner)]
            np.testing.assert_allclose(gradient, exact, rtol=1e-14, atol=1e-13)


@pytest.mark.parametrize("turned", [False, True])
def test_rasters_end_where_the_faces_do(turned: bool) -> None:
    grid = np.stack(np.meshgrid(np.arange(30.0), np.arange(30.0)), axis=-1).reshape(-1, 2)
    rows = np.random.default_rng(1).random((900, 1))
    surface = liftmesh.triangulate(np.column_stack([grid, rows]))
    ring = np.array([[3.5, 3.0], [22.0, 5.0], [25.0, 25.0], [4.0, 20.5]])
    surface = surface.trim(polygon=ring)
    layout = covering(surface, 50, 61, turned=turned)
    for each in (layout, covering(surface, 30, 30, turned=False)):
        for quantity, method in (("height", "sample"), ("aspect", "aspect")):
            found = raster(surface, each, quantity=quantity)
            expected = getattr(surface, method)(found.centers())
            np.testing.assert_array_equal(found.values, expected)
    on_vertices = surface.raster(transform=(1, 0, -0.5, 0, 1, -0.5), shape=(30, 30)).values
    used = np.unique(surface.faces)
    assert np.isfinite(on_vertices).sum() == len(used)
    np.testing.assert_array_equal(on_vertices.ravel()[used], surface.vertices[used, 2])


@pytest.mark.parametrize("power", [-1060, -570, -510, 510, 570, 1010])
@pytest.mark.parametrize("options", [{"max_edge": 10}, {"max_radius": 8}])
def test_lengths_of_any_size(power: int, options) -> None:
    """Powers of two change no mask; their squares would leave the range of doubles."""
    points = np.round(meadow())
    expected = liftmesh.triangulate(points, on_duplicate="highest").trim(**options).mask
    points[:, :2] = np.ldexp(points[:, :2], power)
    scaled = {name: float(np.ldexp(each, power)) for name, each in options.items()}
    found = liftmesh.triangulate(points, on_duplicate="highest").trim(**scaled).mask
    np.testing.assert_array_equal(found, expected)


class TestMasks:
    @pytest.fixture
    def surface(self) -> liftmesh.Surface:
        return liftmesh.triangulate(meadow())

    def test_they_compose_in_any_order(self, surface) -> None:
        ring = [[0, 0], [80, 0], [80, 90], [0, 90]]
        one = surface.trim(max_edge=15).trim(polygon=ring).trim(max_radius=12)
        other = surface.trim(max_radius=12).trim(polygon=ring, max_edge=15)
        np.testing.assert_array_equal(one.mask, other.mask)
        np.testing.assert_array_equal(one.faces, other.faces)

    def test_nothing_is_computed_again(self, surface) -> None:
        trimmed = surface.trim(max_edge=15)
        assert trimmed.triangulation is surface.triangulation
        assert trimmed.vertices is surface.vertices
        assert surface.mask is None
        assert len(trimmed.faces) == np.count_nonzero(~trimmed.mask)
        assert surface.trim(max_edge=1e9).faces is surface.triangulation.simplices

    def test_copies_and_files_keep_them(self, surface, tmp_path) -> None:
        trimmed = surface.trim(max_edge=15)
        copy = pickle.loads(pickle.dumps(trimmed))
        np.testing.assert_array_equal(copy.mask, trimmed.mask)
        np.testing.assert_array_equal(copy.sample([[50, 50]]), trimmed.sample([[50, 50]]))
        raised = trimmed.replace(vertices=trimmed.vertices + np.array([0, 0, 1]))
        np.testing.assert_array_equal(raised.mask, trimmed.mask)
        trimmed.save(tmp_path / "a.ply")
        np.testing.assert_array_equal(liftmesh.read(tmp_path / "a.ply").faces, trimmed.faces)
        assert len(trimmed.to_matplotlib().triangles) == len(trimmed.faces)

    def test_masks_are_read_only(self, surface) -> None:
        with pytest.raises(ValueError, match="read-only"):
            surface.trim(max_edge=15).mask[0] = True

    @pytest.mark.parametrize(
        ("options", "said"),
        [
            ({}, "nothing is asked for"),
            ({"max_edge": 0}, "max_edge is 0: give a positive length"),
            ({"max_edge": "long"}, "max_edge is 'long'"),
            ({"max_edge": [1, 2]}, "give a positive length"),
            ({"max_radius": np.nan}, "max_radius is nan"),
            ({"max_edge": 1e-9}, "no face is left"),
            ({"boundary_only": True, "max_radius": 3}, "boundary_only needs max_edge"),
            ({"max_edge": 3, "boundary_only": "no"}, "boundary_only"),
            ({"polygon": []}, "a ring needs three corners"),
            ({"polygon": {"type": "Point", "coordinates": [0, 0]}}, "there is no polygon"),
            ({"polygon": {"type": "Polygon", "coordinates": 3}}, "no GeoJSON"),
            ({"polygon": {"type": "Polygon", "coordinates": [[[0, 0], [1, "a"]]]}}, "be read"),
            ({"polygon": [[0, 0], [1, 0], [np.inf, 1]]}, "not finite"),
        ],
    )
    def test_what_cannot_be_is_refused(self, surface, options, said: str) -> None:
        with pytest.raises(liftmesh.InputError, match=said):
            surface.trim(**options)


class TestPolygons:
    @pytest.mark.parametrize(
        "polygon",
        [
            {"type": "Polygon", "coordinates": [RING, HOLE]},
            {"type": "MultiPolygon", "coordinates": [[RING, HOLE]]},
            {"type": "Feature", "geometry": {"type": "Polygon", "coordinates": [RING, HOLE]}},
            {
                "type": "FeatureCollection",
                "features": [
                    {"type": "Feature", "geometry": None},
                    {
                        "type": "Feature",
                        "geometry": {
                            "type": "GeometryCollection",
                            "geometries": [{"type": "Polygon", "coordinates": [RING, HOLE]}],
                        },
                    },
                ],
            },
        ],
    )
    def test_forms_of_geojson(self, polygon, tmp_path) -> None:
        expected = [True, False, True, False]
        assert contains(as_polygons(polygon), POINTS).tolist() == expected
        held = SimpleNamespace(__geo_interface__=polygon)
        assert contains(as_polygons(held), POINTS).tolist() == expected
        path = tmp_path / "area.geojson"
        path.write_text(json.dumps(polygon))
        assert contains(polygons_in(None, path), POINTS).tolist() == expected

    @pytest.mark.parametrize("text", ["", "{", "[]", '{"type": "Point"}', "[" * 100_000])
    def test_other_files_are_refused(self, tmp_path, text: str) -> None:
        path = tmp_path / "area.geojson"
        path.write_text(text)
        with pytest.raises(liftmesh.FormatError, match=r"area\.geojson"):
            polygons_in(None, path)
        with pytest.raises(FileNotFoundError):
            polygons_in(None, tmp_path / "nowhere.geojson")

    @pytest.mark.parametrize("ring", [RING, HOLE, [[2.0, 2.0], [9.0, 2.0], [9.0, 9.0]]])
    def test_what_several_polygons_share_is_inside(self, ring) -> None:
        """The same polygon twice, one within another, and two that overlap."""
        parts = [{"type": "Polygon", "coordinates": [each]} for each in (RING, ring)]
        tree = {"type": "GeometryCollection", "geometries": parts}
        points = np.random.default_rng(6).uniform(-1, 10, (500, 2))
        one, other = (contains(as_polygons(each), points) for each in parts)
        np.testing.assert_array_equal(contains(as_polygons(tree), points), one | other)
        assert (one & other).any()

    @pytest.mark.parametrize("few", [1, 64])
    @pytest.mark.parametrize("seed", range(24))
    def test_any_rings_by_definition(self, monkeypatch, few: int, seed: int) -> None:
        """In narrow strips or in one, crossing rings, corners on points, the largest numbers."""
        monkeypatch.setattr("liftmesh.vector.polygons._FEW", few)
        monkeypatch.setattr("liftmesh.vector.polygons._NEAR", 0 if few == 1 else 16)
        monkeypatch.setattr("liftmesh.vector.polygons._LONG", 8 if seed % 8 > 3 else 4096)
        rng = np.random.default_rng(seed)
        corners, count = rng.integers(3, 90), rng.integers(1, 60)
        grid = [0.0, 1.0, 3.0, -7.0, 5e-324, 1e-300, 1e308, -1e308]
        choices = [np.arange(6.0), rng.random(5000), 1e8 + np.arange(40) / 7, grid]
        drawn = [rng.choice(choices[seed % 4], (k, 2)) for k in (corners, 5, count)]
        found = contains([drawn[:2]], drawn[2])
        assert found.tolist() == [is_inside(drawn[:2], point) for point in drawn[2].tolist()]

    def test_a_mark_of_the_encoding_is_no_part_of_the_text(self, tmp_path) -> None:
        path = tmp_path / "area.geojson"
        path.write_text(json.dumps({"type": "Polygon", "coordinates": [RING]}), "utf-8-sig")
        assert len(polygons_in(None, path)) == 1

    def test_files_of_geopandas(self, tmp_path) -> None:
        shape = shapely.Polygon(RING, [HOLE])
        frame = geopandas.GeoDataFrame(geometry=[shape], crs="EPSG:25832")
        frame.to_file(tmp_path / "area.gpkg")
        for source in (tmp_path / "area.gpkg", frame):
            found = contains(polygons_in("EPSG:25832", source), POINTS)
            assert found.tolist() == [True, False, True, False]
            with pytest.raises(liftmesh.InputError, match="the surface in 'EPSG:7415': transform"):
                polygons_in("EPSG:7415", source)
        (tmp_path / "cut.gpkg").write_bytes(b"SQLite format 3\0" + bytes(84))
        with pytest.raises(liftmesh.FormatError, match=r"cut\.gpkg: damaged, or no GeoPackage"):
            polygons_in(None, tmp_path / "cut.gpkg")

    def test_the_system_of_geojson_is_compared(self) -> None:
        tree = {"type": "Polygon", "coordinates": [RING]}
        for name in ("urn:ogc:def:crs:OGC:1.3:CRS84", "urn:ogc:def:crs:EPSG::25833"):
            stated = tree | {"crs": {"type": "name", "properties": {"name": name}}}
            assert polygons_in(None, stated)
            with pytest.raises(liftmesh.InputError, match="the polygon is in"):
                polygons_in("EPSG:25832", stated)
        for odd in ("EPSG:25832", {}, {"properties": 3}, {"properties": {"name": 4}}):
            assert polygons_in("EPSG:25832", tree | {"crs": odd})

    def test_heights_in_rings_are_left_out(self) -> None:
        ring = [[*corner, 7.0] for corner in RING]
        assert as_polygons({"type": "Polygon", "coordinates": [ring]})[0][0].shape == (5, 2)

    @settings(max_examples=50)
    @given(st.lists(st.tuples(*[st.integers(0, 5).map(float)] * 2), min_size=3, max_size=9))
    def test_neighbours_share_no_point_and_leave_none_out(self, ring) -> None:
        """A ring and what is around it in a large square: every point is in one of them."""
        ring = np.array(ring)
        square = np.array([[-1.0, -1.0], [7.0, -1.0], [7.0, 7.0], [-1.0, 7.0]])
        points = np.stack(np.meshgrid(np.arange(0, 6, 0.5), np.arange(0, 6, 0.5)), axis=-1)
        points = points.reshape(-1, 2)
        inside, around = contains([[ring]], points), contains([[square, ring]], points)
        assert (inside ^ around).all()
        np.testing.assert_array_equal(contains([[ring[::-1]]], points), inside)


def test_one_point_of_a_trimmed_surface_costs_no_memory_per_row() -> None:
    rng = np.random.default_rng(4)
    trimmed = liftmesh.triangulate(rng.random((20_000, 3))).trim(max_edge=0.05)
    trimmed.sample([0.5, 0.5])  # makes what is kept for the next ones
    tracemalloc.start()
    trimmed.sample([0.4, 0.5])
    assert tracemalloc.get_traced_memory()[1] < 10_000
    tracemalloc.stop()
