"""Filled contours: valid polygons, without gaps, of the right area, whatever is at a level."""

from __future__ import annotations

import json
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import geopandas
import numpy as np
import pytest
import shapely
from hypothesis import given, settings, strategies as st
from surfaces import LATTICE, drawn, exactly, meadow, terrain, trimmed

import liftmesh
from liftmesh import FormatError, InputError

LEVELS = st.sampled_from([[-9, -3, 0, 3], [0], [-0.5, 0.5, 1.5], np.arange(-9, 10), [99], []])


def exact_areas(surface: liftmesh.Surface, levels: list[float]) -> list[Fraction]:
    """The area of each band, in rationals: what is above each level, less what is above the next.

    Flat faces at a level are above it.
    """
    exact = exactly(surface)

    def above(level: float | None) -> Fraction:
        total = Fraction(0)
        for face in exact.faces:
            (ax, ay), (bx, by), (cx, cy) = (exact.points[each] for each in face)
            area = abs((bx - ax) * (cy - ay) - (by - ay) * (cx - ax)) / 2
            low, middle, high = sorted(Fraction(exact.heights[each]) for each in face)
            if level is None or low >= level:
                total += area
            elif middle >= level:
                total += area * (1 - (level - low) ** 2 / ((middle - low) * (high - low)))
            elif high > level:
                total += area * (high - level) ** 2 / ((high - low) * (high - middle))
        return total

    limits = [None, *map(Fraction, levels)]
    shares = [*map(above, limits), Fraction(0)]
    return [one - other for one, other in pairwise(shares)]


def check(surface: liftmesh.Surface, found: liftmesh.FilledContours, rtol: float = 1e-9) -> None:
    shapes = found.to_shapely()
    assert shapely.is_valid(shapes).all()
    parts = shapely.get_parts(shapes)
    one, other = np.triu_indices(len(parts), 1)
    assert shapely.relate_pattern(parts[one], parts[other], "F********").all()  # none overlap
    assert shapely.is_ccw(shapely.get_exterior_ring(parts)).all()
    area = surface.area(planar=True)
    np.testing.assert_allclose(found.areas, shapely.area(shapes), rtol=rtol, atol=area * 1e-12)
    assert found.areas.sum() == pytest.approx(area, rel=rtol)


@pytest.mark.slow
@settings(max_examples=120, deadline=None)
@given(LATTICE, LEVELS, st.none() | st.floats(1.1, 4))
def test_bands_are_valid_and_have_the_exact_areas(points, levels, limit) -> None:
    surface = drawn(points)
    surface = trimmed(surface, max_edge=limit) if surface and limit else surface
    if surface is None:
        return
    found = surface.filled_contours(levels)
    check(surface, found)
    areas = exact_areas(surface, levels)
    expected = {band: float(area) for band, area in enumerate(areas) if area}
    assert found.areas == pytest.approx([*expected.values()], abs=1e-11)
    limits = [found.lower.min(), *levels, found.upper.max()]
    assert found.lower[1:].tolist() == [limits[band] for band in [*expected][1:]]
    assert found.upper[:-1].tolist() == [limits[band + 1] for band in [*expected][:-1]]


@pytest.mark.slow
def test_borders_are_contours_and_shared_bit_for_bit() -> None:
    surface = liftmesh.triangulate(terrain(300)).trim(max_edge=60)
    found, lines = surface.filled_contours(interval=2), surface.contours(interval=2)
    check(surface, found, 1e-7)

    def sides(points: np.ndarray, starts: np.ndarray) -> list[tuple[float, ...]]:
        inside = np.setdiff1d(np.arange(len(points) - 1), starts[1:-1] - 1)
        return list(map(tuple, np.hstack([points[inside], points[inside + 1]]).tolist()))

    of_bands = sides(found.points, found.rings)
    assert len(of_bands) == len(set(of_bands))
    held = set(of_bands)
    within = {side for side in held if (*side[2:], *side[:2]) in held}
    of_lines = set(sides(lines.points, lines.starts))
    assert of_lines | {(*side[2:], *side[:2]) for side in of_lines} == within


def test_each_band_has_its_heights() -> None:
    surface = liftmesh.triangulate(meadow())
    found = surface.filled_contours(interval=2, contour_base=0.5)
    rng = np.random.default_rng(1)
    points = rng.random((2000, 2)) * 100
    heights = surface.sample(points)
    at = shapely.points(points)
    for low, high, shape in zip(found.lower, found.upper, found.to_shapely(), strict=True):
        inside = shapely.contains_properly(shape, at)
        assert inside.any()
        assert (heights[inside] >= low - 1e-9).all()
        assert (heights[inside] <= high + 1e-9).all()


def test_the_order_of_rows_changes_no_bit() -> None:
    points = np.round(meadow(300), 1)
    order = np.random.default_rng(1).permutation(len(points))
    one, other = (
        liftmesh.triangulate(each, on_duplicate="lowest").filled_contours(interval=0.5)
        for each in (points, points[order])
    )
    for name in ("points", "rings", "polygons", "bands", "lower", "upper"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_a_plateau_is_in_the_band_above_and_a_ridge_in_none() -> None:
    rows = [[0, 0, 0], [6, 0, 0], [6, 6, 0], [0, 6, 0], [2, 2, 4], [4, 2, 4], [4, 4, 4], [2, 4, 4]]
    found = liftmesh.triangulate(rows).filled_contours([4])
    assert (found.areas.tolist(), found.upper.tolist()) == ([32, 4], [4, 4])
    ridge = [[0, 0, 0], [6, 0, 0], [0, 6, 0], [6, 6, 0], [2, 3, 4], [4, 3, 4]]
    assert liftmesh.triangulate(ridge).filled_contours([4]).areas.tolist() == [36]


def test_summits_that_touch_are_two_polygons() -> None:
    heights = np.array([[0, 0, 0, 0, 0], [0, 2, 1, 2, 0], [0, 0, 0, 0, 0]])
    y, x = np.indices(heights.shape)
    rows = np.stack([x, y, heights], axis=-1).reshape(-1, 3)
    found = liftmesh.triangulate(rows).filled_contours([1])
    shapes = found.to_shapely()
    assert shapely.get_num_geometries(shapes).tolist() == [1, 2]
    assert shapely.is_valid(shapes).all()


@pytest.mark.slow
@pytest.mark.parametrize("scale", [1e-9, 1e-8, 1e-7])
def test_vertices_as_near_as_doubles_make_valid_bands(scale: float) -> None:
    rng = np.random.default_rng(3)
    points = rng.random((150, 3)) * (100, 100, 20) + (4.5e5, 5.2e6, 0)
    twins = points[:60] + rng.normal(0, 1, (60, 3)) * (scale, scale, 1)
    surface = liftmesh.triangulate(np.concatenate([points, twins]))
    found = surface.filled_contours(interval=0.5)
    check(surface, found, 1e-6)


@pytest.mark.parametrize("scale", [1e-300, 1e-5, 1e150])
def test_coordinates_of_any_size(scale: float) -> None:
    points = meadow(100) * (scale, scale, 1)
    found = liftmesh.triangulate(points).filled_contours(interval=2)
    expected = liftmesh.triangulate(meadow(100)).filled_contours(interval=2)
    assert (len(found), len(found.polygons)) == (len(expected), len(expected.polygons))


def test_other_values() -> None:
    surface = liftmesh.triangulate(meadow(100))
    found = surface.filled_contours([50], values=surface.vertices[:, 0])
    assert found.areas.sum() == pytest.approx(surface.area(planar=True))
    assert shapely.bounds(found.to_shapely())[0, 2] == pytest.approx(50)


@pytest.mark.parametrize("suffix", ["geojson", "gpkg", "shp"])
def test_files(tmp_path: Path, suffix: str) -> None:
    surface = liftmesh.triangulate(meadow(100), crs="EPSG:25832")
    found = surface.filled_contours(interval=2)
    written = found.save(tmp_path / f"bands.{suffix}")
    assert written.bytes == (tmp_path / f"bands.{suffix}").stat().st_size
    read = geopandas.read_file(tmp_path / f"bands.{suffix}")
    assert read.crs.to_epsg() == 25832
    shapes = shapely.normalize(read.geometry.values)  # shapefiles have one part alone as a Polygon
    expected = shapely.normalize(found.to_shapely())
    single = shapely.get_num_geometries(expected) == 1
    expected[single] = shapely.get_geometry(expected[single], 0)
    if suffix != "shp":
        shapes[single] = shapely.get_geometry(shapes[single], 0)
    assert shapely.equals_exact(shapes, expected).all()
    np.testing.assert_array_equal(read["lower"], found.lower)
    np.testing.assert_array_equal(read["upper"], found.upper)
    if suffix == "geojson":
        assert len(json.loads((tmp_path / "bands.geojson").read_text())["features"]) == len(found)


@pytest.mark.parametrize("scale", [2.0**510, 2.0**1020, 2.0**-500])
def test_areas_at_any_scale(scale: float) -> None:
    hill = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [4, 4, 0], [2, 2, 8]]) - [2, 2, 0]
    found = liftmesh.triangulate(hill * [scale, scale, 1]).filled_contours([4]).areas
    assert found.tolist() == [12 * scale * scale, 4 * scale * scale]


def test_what_cannot_be_filled(tmp_path: Path) -> None:
    surface = liftmesh.triangulate(meadow(100))
    with pytest.raises(InputError, match="either levels or interval"):
        surface.filled_contours()
    with pytest.raises(InputError, match="give finite heights"):
        surface.filled_contours([np.nan])
    points = meadow(100)
    written = liftmesh.triangulate(points)
    points[7, 2] = np.nan
    with pytest.raises(InputError, match="height of vertex 7 is not finite: the array was written"):
        written.filled_contours([0])
    with pytest.raises(FormatError, match=r"bands are written as GeoJSON, Geo"):
        surface.filled_contours([0]).save(tmp_path / "bands.dxf")
