"""Surfaces cut along polygons: areas of shapely, heights and volumes of the whole surface."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import shapely
from commands import failed, liftmesh as run
from hypothesis import given, settings, strategies as st
from surfaces import meadow

import liftmesh

SQUARE = np.array([[0.0, 0, 0], [10, 0, 0], [0, 10, 0], [10, 10, 0]])
SLOPE = SQUARE + SQUARE[:, :1] * (0, 0, 1)  # z = x
RING = [[1.0, 2.0], [7.0, 2.0], [7.0, 5.0], [1.0, 5.0]]
HOLE = [[2.0, 3.0], [3.0, 3.0], [3.0, 4.0], [2.0, 4.0]]
POINTS = st.lists(st.tuples(*[st.integers(0, 16).map(lambda x: x / 2)] * 2), min_size=3, max_size=7)


def faces_of(surface: liftmesh.Surface) -> shapely.Geometry:
    corners = surface.triangulation.points[surface.faces]
    return shapely.union_all(shapely.polygons(np.concatenate([corners, corners[:, :1]], axis=1)))


def border_of(surface: liftmesh.Surface) -> set[tuple[float, ...]]:
    return {tuple(surface.vertices[row]) for ring in surface.boundary() for row in ring}


def clipped(surface: liftmesh.Surface, area, **options) -> liftmesh.Surface | None:
    try:
        return surface.clip(area, **options)
    except liftmesh.InputError as error:
        if "no face is left" not in str(error):
            raise
        return None


def test_a_rectangle_with_a_hole_out_of_a_slope() -> None:
    area = {"type": "Polygon", "coordinates": [RING, HOLE]}
    surface = liftmesh.triangulate(SLOPE)
    inside, outside = surface.clip(area), surface.clip(area, invert=True)
    assert inside.area(planar=True) == 17
    assert outside.area(planar=True) == 83
    assert inside.area() == pytest.approx(17 * np.sqrt(2))
    assert inside.vertices[:, 2] == pytest.approx(inside.vertices[:, 0], rel=1e-14)
    assert inside.volume().above == pytest.approx(surface.volume(within=area).above)
    assert len(inside.boundary()) == 2
    assert np.isnan(inside.sample([[2.5, 3.5], [0.5, 0.5]])).all()
    assert outside.sample([[2.5, 3.5], [0.5, 0.5]]) == pytest.approx([2.5, 0.5])


@settings(max_examples=60, deadline=None)
@given(POINTS, st.integers(0, 2**32 - 1), st.sampled_from([1.0, 1 / 3, 0.7]))
def test_inside_and_outside_make_the_whole(ring, seed: int, scale: float) -> None:
    shape = shapely.Polygon(np.array(ring) * scale)
    if not shape.is_valid or shape.area == 0:
        return
    rng = np.random.default_rng(seed)
    points = np.column_stack([rng.integers(-1, 10, (40, 2)) * scale, rng.normal(size=40)])
    whole = liftmesh.triangulate(points).trim(max_edge=6 * scale)
    parts = [clipped(whole, shape), clipped(whole, shape, invert=True)]
    covered = faces_of(whole)
    common = covered.intersection(shape).area
    measured = [0.0 if each is None else each.area(planar=True) for each in parts]
    assert measured == pytest.approx([common, covered.area - common], rel=1e-9, abs=1e-9)
    level = whole.volume(0.2)
    volumes = [(0, 0) if v is None else (v.above, v.below) for v in volumes_of(parts, 0.2)]
    assert np.sum(volumes, axis=0) == pytest.approx([level.above, level.below], rel=1e-9, abs=1e-9)
    for part in parts:
        if part is not None:
            assert_part_of(whole, part, rng)


def volumes_of(parts, level: float) -> list[liftmesh.VolumeResult | None]:
    return [None if each is None else each.volume(level) for each in parts]


def assert_part_of(whole, part, rng) -> None:
    """Valid, with all rows in use, and the heights of the whole where it has faces."""
    assert part.verify().valid
    assert len(np.unique(part.faces)) == len(part.vertices)
    low, high = np.array(part.bounds[:2]), np.array(part.bounds[2:])
    places = rng.uniform(low, high, (50, 2))
    heights = part.sample(places)
    known = np.isfinite(heights)
    assert heights[known] == pytest.approx(whole.sample(places[known]), abs=1e-9)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(3, 12))
def test_parts_share_their_border_to_the_bit(seed: int, corners: int) -> None:
    rng = np.random.default_rng(seed)
    whole = liftmesh.triangulate(rng.random((60, 3)) * (90, 90, 9) + (4.5e5, 5.2e6, 100))
    angles = np.sort(rng.random(corners)) * 2 * np.pi
    if np.diff(angles, append=angles[:1] + 2 * np.pi).max() >= np.pi:
        return
    ring = np.column_stack([np.cos(angles), np.sin(angles)]) * rng.uniform(5, 30, (corners, 1))
    ring += (450045, 5200045)
    inside, outside = whole.clip(ring), whole.clip(ring, invert=True)
    around = shapely.box(449900, 5199900, 450200, 5200200).difference(shapely.Polygon(ring))
    assert border_of(inside) <= border_of(outside)
    assert border_of(whole.clip(around)) == border_of(outside)
    again = inside.clip(ring)
    assert again.area(planar=True) == pytest.approx(inside.area(planar=True), rel=1e-9)
    assert again.volume(100).above == pytest.approx(inside.volume(100).above, rel=1e-9)


def test_no_bit_depends_on_the_order_of_the_rows() -> None:
    points, rng = meadow(), np.random.default_rng(3)
    ring = [[10.3, 9.1], [91.7, 30.2], [62.9, 88.8], [40.1, 50.5]]
    one = liftmesh.triangulate(points).clip(ring)
    two = liftmesh.triangulate(rng.permutation(points)).clip(ring)
    assert corners_of(one) == corners_of(two)


def corners_of(surface: liftmesh.Surface) -> set[frozenset[tuple[float, ...]]]:
    return {frozenset(map(tuple, each)) for each in surface.vertices[surface.faces].tolist()}


def test_faces_that_the_border_does_not_touch_stay() -> None:
    surface = liftmesh.triangulate(meadow())
    shape = shapely.Polygon([[10.3, 9.1], [91.7, 30.2], [62.9, 88.8]])
    inside, outside = surface.clip(shape), surface.clip(shape, invert=True)
    faces = corners_of(surface)
    whole = {each for each in faces if not shapely.Polygon([*each]).intersects(shape.exterior)}
    assert len(whole) > 400
    assert (corners_of(inside) | corners_of(outside)) & faces >= whole


def test_rows_keep_what_they_have() -> None:
    rng = np.random.default_rng(5)
    points = rng.random((50, 3)) * 10
    cloud = liftmesh.Cloud(
        points,
        colors=rng.integers(0, 255, (50, 3)).astype(np.uint8),
        attributes={"code": np.arange(50)},
        metadata={"survey": "2024"},
        crs="EPSG:28992",
    )
    part = liftmesh.triangulate(cloud).clip([[2, 2], [8, 2], [8, 8], [2, 8]])
    old = part.attributes["steiner"] == 0
    codes = part.attributes["code"][old]
    assert np.array_equal(part.vertices[old], points[codes])
    assert np.array_equal(part.colors[old], cloud.colors[codes])
    assert (np.diff(codes) > 0).all()
    assert (part.crs, part.metadata["survey"]) == ("EPSG:28992", "2024")
    new = part.vertices[~old]
    assert np.array_equal(np.lexsort(new[:, 1::-1].T), np.arange(len(new)))


def test_breaklines_stay() -> None:
    rng = np.random.default_rng(2)
    line = [[1.0, 1.0, 5.0], [9.0, 8.0, 5.0]]
    surface = liftmesh.triangulate(rng.random((60, 3)) * 10, breaklines=[line])
    part = surface.clip([[3, 0], [9.5, 0], [9.5, 9.5], [3, 9.5]])
    ends = part.triangulation.points[part.triangulation.constraints]
    slope = (ends[..., 1] - 1) * 8 - (ends[..., 0] - 1) * 7
    on_line = (np.abs(slope) < 1e-9).all(axis=1)
    lengths = np.hypot(*np.diff(ends[on_line], axis=1)[:, 0].T)
    assert lengths.sum() == pytest.approx(6 * np.hypot(8, 7) / 8)


def test_weights_of_the_whole_do_not_bind_the_part() -> None:
    rng = np.random.default_rng(4)
    points, weights = rng.random((80, 3)) * 10, rng.random(80)
    surface = liftmesh.triangulate(points, weights=weights)
    part = surface.clip([[2, 2], [8, 2], [8, 8]])
    common = faces_of(surface).intersection(shapely.Polygon([[2, 2], [8, 2], [8, 8]]))
    assert part.area(planar=True) == pytest.approx(common.area)
    places = rng.uniform(2, 8, (50, 2))
    heights = part.sample(places)
    known = np.isfinite(heights)
    assert heights[known] == pytest.approx(surface.sample(places[known]), abs=1e-9)


def test_progress() -> None:
    surface = liftmesh.triangulate(meadow())
    for call in (
        lambda said: surface.clip([[20, 20], [60, 25], [40, 70]], progress=said),
        lambda said: surface.accuracy(progress=said),
    ):
        heard: list[float] = []
        call(heard.append)
        assert heard == sorted(heard)
        assert heard[-1] == 1


def test_other_planes() -> None:
    wall = liftmesh.triangulate(SLOPE[:, [0, 2, 1]], plane="xz")
    assert wall.clip(RING).area(planar=True) == 18
    tilted = liftmesh.triangulate(SLOPE, plane=[1, 0, 3])
    with pytest.raises(liftmesh.InputError, match="new rows need a plane"):
        tilted.clip(RING)


def test_a_polygon_around_all_and_one_beside() -> None:
    surface = liftmesh.triangulate(SLOPE)
    around = shapely.box(-5, -5, 20, 20)
    assert np.array_equal(surface.clip(around).vertices, surface.vertices)
    for area, invert in ((around, True), (shapely.box(50, 50, 60, 60), False)):
        with pytest.raises(liftmesh.InputError, match="no face is left: give a polygon"):
            surface.clip(area, invert=invert)
    beside = surface.clip(shapely.box(50, 50, 60, 60), invert=True)
    assert corners_of(beside) == corners_of(surface)


def test_borders_along_sides_and_through_corners() -> None:
    grid = np.stack(np.meshgrid(np.arange(5.0), np.arange(5.0)), axis=-1).reshape(-1, 2)
    surface = liftmesh.triangulate(np.column_stack([grid, grid[:, 0] * grid[:, 1]]))
    part = surface.clip([[1, 1], [3, 1], [3, 3], [1, 3]])
    assert (len(part.vertices), len(part.faces)) == (9, 8)
    assert "steiner" not in part.attributes or not part.attributes["steiner"].any()
    corner = surface.clip([[2, 2], [4, 2], [4, 4]])
    assert corner.area(planar=True) == 2


def test_several_polygons_are_kept_together() -> None:
    surface = liftmesh.triangulate(SLOPE)
    area = shapely.MultiPolygon([shapely.box(1, 1, 3, 3), shapely.box(5, 5, 6, 9)])
    part = surface.clip(area)
    assert part.area(planar=True) == 8
    assert len(part.boundary()) == 2


@pytest.mark.parametrize(
    ("polygon", "said"),
    [
        ([[0, 0], [4, 4], [4, 0], [0, 4]], "polygon 0 is not valid: Self-intersection"),
        ([[0, 0], [4, 4]], "a ring"),
        ([[0, 0], [4, 4], [np.nan, 1]], "not finite"),
        ("sea.geojson", "sea.geojson"),
        (None, "a ring"),
    ],
)
def test_what_is_no_polygon_is_refused(polygon, said: str) -> None:
    with pytest.raises((liftmesh.InputError, OSError), match=said):
        liftmesh.triangulate(SLOPE).clip(polygon)


@pytest.mark.parametrize("scale", [1e-300, 1e-30, 1e30, 1e150])
def test_scales(scale: float) -> None:
    surface = liftmesh.triangulate(meadow() * scale)
    ring = np.array([[10.3, 9.1], [91.7, 30.2], [62.9, 88.8]]) * scale
    part = surface.clip(ring)
    span = np.ptp(part.vertices[:, :2] / scale, axis=0)
    assert span == pytest.approx(np.ptp(ring / scale, axis=0))
    assert part.verify().valid


@pytest.mark.parametrize("seed", [1, 2, 32, 45, 202])
def test_borders_along_sides_but_for_rounding(seed: int) -> None:
    """Where cut faces would bend a side of another one, that one is cut, too."""
    rng = np.random.default_rng(seed)
    surface = liftmesh.triangulate(rng.random((40, 3)) * (90, 90, 9) + (4.5e5, 5.2e6, 100))
    corners = surface.triangulation.points[surface.faces[rng.integers(0, len(surface.faces), 6)]]
    area = max(shapely.get_parts(shapely.union_all(shapely.polygons(corners))), key=shapely.area)
    ring = shapely.get_coordinates(area.exterior)[:-1]
    shape = shapely.Polygon(ring + rng.integers(-2, 3, ring.shape) * np.spacing(ring))
    inside, outside = surface.clip(shape), surface.clip(shape, invert=True)
    assert inside.area(planar=True) == pytest.approx(shape.area, abs=1e-5)
    whole = inside.area(planar=True) + outside.area(planar=True)
    assert whole == pytest.approx(surface.area(planar=True), abs=1e-5)
    assert border_of(inside) & border_of(outside)


class TestCommand:
    @pytest.fixture
    def folder(self, tmp_path: Path) -> Path:
        liftmesh.triangulate(SLOPE).save(tmp_path / "tin.ply")
        area = {"type": "Polygon", "coordinates": [RING, HOLE]}
        (tmp_path / "lot.geojson").write_text(json.dumps(area))
        return tmp_path

    def test_inside_and_outside(self, folder) -> None:
        for words, expected in (((), 17), (("--invert",), 83)):
            done = run(
                "clip",
                "tin.ply",
                "a.ply",
                "--within",
                "lot.geojson",
                "--overwrite",
                *words,
                cwd=folder,
            )
            assert f"planar area {expected}" in done.stdout
            left = liftmesh.as_surface(folder / "a.ply")
            assert left.area(planar=True) == expected
            assert left.vertices[:, 2] == pytest.approx(left.vertices[:, 0], rel=1e-14)

    def test_json(self, folder) -> None:
        words = ("clip", "tin.ply", "a.ply", "--within", "lot.geojson", "--json")
        found = json.loads(run(*words, cwd=folder).stdout)
        assert found["planar_area"] == 17
        assert found["n_added"] == found["n_rows"]

    def test_another_surface_comes_inside(self, folder) -> None:
        liftmesh.triangulate(SQUARE + np.array([0, 0, 20])).save(folder / "pad.ply")
        words = ("clip", "tin.ply", "a.ply", "--within", "lot.geojson", "--paste", "pad.ply")
        assert "planar area 100" in run(*words, cwd=folder).stdout
        assert liftmesh.as_surface(folder / "a.ply").sample([5, 4.5]) == pytest.approx(20)
        failed(run(*words, "--invert", "--overwrite", cwd=folder), 2, "leave --invert out")

    def test_bad_input_is_one_line(self, folder) -> None:
        failed(run("clip", "tin.ply", "a.ply", cwd=folder), 2, "--within")
        failed(run("clip", "tin.ply", "a.ply", "--within", "b.shp", cwd=folder), 3, "b.shp")
        assert not (folder / "a.ply").exists()
