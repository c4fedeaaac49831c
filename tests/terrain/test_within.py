"""Volumes inside of polygons, cut at their borders."""

from __future__ import annotations

import json

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


def test_a_rectangle_with_a_hole_under_a_slope() -> None:
    area = {"type": "Polygon", "coordinates": [RING, HOLE]}
    surface = liftmesh.triangulate(SLOPE)
    found = surface.volume(within=area)
    assert (found.above, found.below) == (pytest.approx(6 * 3 * 4 - 2.5), 0)
    assert found.area == pytest.approx(17)
    split = surface.volume(4, within=RING)
    assert (split.above, split.below) == (pytest.approx(3 * 4.5), pytest.approx(3 * 4.5))
    work = liftmesh.triangulate(SQUARE + np.array([0, 0, 4])).cut_and_fill(surface, within=RING)
    assert (work.cut, work.fill) == (pytest.approx(13.5), pytest.approx(13.5))


POINTS = st.lists(st.tuples(*[st.integers(0, 8).map(float)] * 2), min_size=3, max_size=7)


@settings(max_examples=40, deadline=None)
@given(POINTS, st.integers(0, 2**32 - 1))
def test_polygons_and_what_is_around_them_make_the_whole(ring, seed: int) -> None:
    shape = shapely.Polygon(ring)
    if not shape.is_valid or shape.area == 0:
        return
    rng = np.random.default_rng(seed)
    one, other = (
        liftmesh.triangulate(
            np.column_stack([rng.integers(-1, 10, (40, 2)), rng.normal(size=40)])
        ).trim(max_edge=6)
        for _ in range(2)
    )
    around = shapely.box(-2, -2, 11, 11).difference(shape)
    whole = one.cut_and_fill(other)
    parts = [measured(one, other, each) for each in (shape, around)]
    for name in ("cut", "fill", "area"):
        total = sum(getattr(each, name) for each in parts)
        assert total == pytest.approx(getattr(whole, name), rel=1e-9, abs=1e-9)


def measured(one: liftmesh.Surface, other: liftmesh.Surface, area) -> liftmesh.CutFillResult:
    """Nothing, where polygons are outside of the faces."""
    try:
        return one.cut_and_fill(other, within=area)
    except liftmesh.InputError:
        return liftmesh.CutFillResult(0.0, 0.0, 0.0)


def test_several_polygons_count_once_where_they_overlap() -> None:
    surface = liftmesh.triangulate(meadow())
    one, other = shapely.box(10, 10, 50, 50), shapely.box(30, 20, 80, 60)
    found = surface.volume(within=shapely.MultiPolygon([one]).union(other))
    tree = {
        "type": "GeometryCollection",
        "geometries": [each.__geo_interface__ for each in (one, other)],
    }
    both = surface.volume(within=tree)
    assert both.above == pytest.approx(found.above, rel=1e-12)
    apart = [surface.volume(within=each).above for each in (one, other, one & other)]
    assert both.above == pytest.approx(apart[0] + apart[1] - apart[2], rel=1e-12)


@pytest.mark.parametrize(
    ("polygon", "said"),
    [
        ([[0, 0], [2, 2], [2, 0], [0, 2]], "polygon 0 is not valid: Self-intersection"),
        ([[20, 20], [30, 20], [20, 30]], "no area in common with the faces"),
        ([[0, 0], [1, 1]], "three corners"),
    ],
)
def test_other_polygons_are_refused(polygon, said: str) -> None:
    with pytest.raises(liftmesh.InputError, match=said):
        liftmesh.triangulate(SLOPE).volume(within=polygon)


def test_the_command_measures_inside(tmp_path) -> None:
    liftmesh.triangulate(SLOPE).save(tmp_path / "tin.ply")
    liftmesh.triangulate(SQUARE).save(tmp_path / "flat.ply")
    area = tmp_path / "area.geojson"
    area.write_text(json.dumps({"type": "Polygon", "coordinates": [RING]}))
    done = run("volume", tmp_path / "tin.ply", "--within", area, "--json")
    assert json.loads(done.stdout)["above"] == pytest.approx(72)
    words = (tmp_path / "flat.ply", tmp_path / "tin.ply", "--within", area, "--json")
    assert json.loads(run("volume", *words).stdout)["fill"] == pytest.approx(72)
    failed(run("volume", tmp_path / "tin.ply", "--within", tmp_path / "none.json"), 3, "none.json")


LOTS = {
    "type": "FeatureCollection",
    "features": [
        {
            "type": "Feature",
            "properties": {"name": name} if name else {},
            "geometry": {"type": "Polygon", "coordinates": [ring]},
        }
        for name, ring in [
            ("A 7", RING),
            ("", [[0, 0], [4, 0], [4, 10], [0, 10]]),
            ("outside", [[20, 0], [24, 0], [24, 10]]),
        ]
    ],
}


def test_each_polygon_is_measured_by_itself(tmp_path) -> None:
    flat, slope = liftmesh.triangulate(SQUARE + np.array([0, 0, 4])), liftmesh.triangulate(SLOPE)
    works = flat.cut_and_fill_by_polygon(slope, LOTS)
    volumes = slope.volume_by_polygon(LOTS, 4)
    assert [*works] == [*volumes] == ["A 7", 1, "outside"]
    triples = zip(LOTS["features"], works.values(), volumes.values(), strict=True)
    for feature, work, volume in triples:
        if feature["properties"].get("name") == "outside":
            assert (work.cut, work.fill, work.area) == (volume.above, volume.below, volume.area)
            assert work.area == 0
            continue
        alone = flat.cut_and_fill(slope, within=feature)
        assert (work.cut, work.fill, work.area) == (alone.cut, alone.fill, alone.area)
        assert volume == slope.volume(4, within=feature)
    assert works[1].cut == pytest.approx(80)
    liftmesh.triangulate(SQUARE + np.array([0, 0, 4])).save(tmp_path / "before.ply")
    slope.save(tmp_path / "after.ply")
    lots = tmp_path / "lots.geojson"
    lots.write_text(json.dumps(LOTS))
    words = "volume", tmp_path / "before.ply", tmp_path / "after.ply", "--within", lots
    found = json.loads(run(*words, "--json").stdout)
    assert [each["polygon"] for each in found["polygons"]] == ["A 7", 1, "outside"]
    assert [each["cut"] for each in found["polygons"]] == [each.cut for each in works.values()]
    assert found["cut"] == flat.cut_and_fill(slope, within=LOTS).cut
    printed = run(*words).stdout
    assert "A 7" in printed
    assert "cut 80" in printed


def test_rows_of_a_table_have_their_names(tmp_path) -> None:
    import geopandas

    frame = geopandas.GeoDataFrame.from_features(LOTS["features"][:2], crs="EPSG:28992")
    frame.to_file(tmp_path / "lots.gpkg")
    slope = liftmesh.triangulate(SLOPE)
    expected = slope.volume_by_polygon(LOTS)
    for given_as in (frame, tmp_path / "lots.gpkg"):
        found = slope.volume_by_polygon(given_as)
        assert [*found] == ["A 7", 1]
        assert all(found[name] == expected[name] for name in found)
    assert [*slope.volume_by_polygon(frame.geometry)] == [0, 1]


def numbered(*values: object) -> dict:
    """Give the lots another property, with values or without."""
    lots = json.loads(json.dumps(LOTS))
    for feature, value in zip(lots["features"], values, strict=True):
        feature["properties"] |= {} if value is None else {"lot": value}
    return lots


def test_another_property_names_polygons(tmp_path) -> None:
    slope = liftmesh.triangulate(SLOPE)
    lots = numbered("x", 12, None)
    assert [*slope.volume_by_polygon(lots, by="lot")] == ["x", "12", 2]
    assert [*slope.volume_by_polygon(lots)] == ["A 7", 1, "outside"]
    assert [*slope.cut_and_fill_by_polygon(slope, numbered(1, 2.0, 2.5), by="lot")] == [
        "1", "2", "2.5"
    ]  # fmt: skip
    one = lots["features"][0]
    assert [*slope.volume_by_polygon(one)] == [0]
    assert [*slope.volume_by_polygon(one, by="lot")] == ["x"]
    there = "no polygon has the property 'plot', but 'name', 'lot': give by= one of these"
    with pytest.raises(liftmesh.InputError, match=there):
        slope.volume_by_polygon(lots, by="plot")
    with pytest.raises(liftmesh.InputError, match="nor any other: by= is for features"):
        slope.volume_by_polygon(RING, by="lot")
    with pytest.raises(liftmesh.InputError, match="give each its own, or by= a property"):
        slope.volume_by_polygon(numbered(3, 3, 4), by="lot")
    with pytest.raises(liftmesh.InputError, match="by is 3: give the name of a property"):
        slope.volume_by_polygon(lots, by=3)


def test_the_command_names_polygons_by_another_property(tmp_path) -> None:
    slope, lots = tmp_path / "tin.ply", tmp_path / "lots.geojson"
    liftmesh.triangulate(SLOPE).save(slope)
    lots.write_text(json.dumps(numbered("x", 12, None)))
    for words in (("volume", slope), ("volume", slope, slope)):
        found = json.loads(run(*words, "--within", lots, "--by", "lot", "--json").stdout)
        assert [each["polygon"] for each in found["polygons"]] == ["x", "12", 2]
        done = run(*words, "--within", lots, "--by", "plot")
        failed(done, 3, "lots.geojson: no polygon has the property 'plot', but 'name', 'lot'")
        assert "give --by one of these" in " ".join(done.stderr.split())
        failed(run(*words, "--by", "lot"), 2, "--by goes with --within")


def test_polygons_of_one_name_and_invalid_ones_are_named() -> None:
    slope = liftmesh.triangulate(SLOPE)
    twice = LOTS | {"features": LOTS["features"][:1] * 2}
    with pytest.raises(liftmesh.InputError, match="two polygons have the name 'A 7'"):
        slope.volume_by_polygon(twice)
    assert slope.volume(within=twice).area == pytest.approx(18)  # together, names do not matter
    crossed = json.loads(json.dumps(LOTS))
    crossed["features"][0]["geometry"]["coordinates"] = [[[0, 0], [2, 2], [2, 0], [0, 2]]]
    with pytest.raises(liftmesh.InputError, match="polygon 'A 7': polygon 0 is not valid"):
        slope.cut_and_fill_by_polygon(slope, crossed)


@settings(max_examples=15, deadline=None)
@given(st.integers(-480, 500))
def test_volumes_in_polygons_scale_with_the_coordinates(exponent: int) -> None:
    ground, cut = hills(4, 0), hills(4, 1)
    lot = np.array([[0.5, 0.5], [2.5, 0.6], [2.4, 2.5], [0.5, 2.4]])
    expected = ground.volume(within=lot), ground.cut_and_fill(cut, within=lot)
    ground, cut = hills(4, 0, exponent), hills(4, 1, exponent)
    lot = np.ldexp(lot, exponent)
    found = ground.volume(within=lot), ground.cut_and_fill(cut, within=lot)
    for one, other in zip(found, expected, strict=True):
        assert np.ldexp(one.area, -2 * exponent) == pytest.approx(other.area, rel=1e-12)
        assert np.ldexp(one.net, -2 * exponent) == pytest.approx(other.net, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("scale", [(512, 1.0), (1020, 1.0), (500, 1e300), (500, 1e100)])
def test_what_is_beyond_the_doubles_is_refused(scale: tuple[int, float]) -> None:
    ground, cut = hills(4, 0, *scale), hills(4, 1, *scale)
    lot = np.ldexp([[0.5, 0.5], [2.5, 0.6], [2.4, 2.5], [0.5, 2.4]], scale[0])
    for measure in (
        lambda: ground.volume(within=lot),
        lambda: ground.volume_by_polygon(lot),
        lambda: ground.cut_and_fill(cut),
        lambda: ground.cut_and_fill(cut, within=lot),
        lambda: ground.cut_and_fill_by_polygon(cut, lot),
    ):
        with pytest.raises(liftmesh.InputError, match="beyond the largest double: scale the coord"):
            measure()


def hills(size: int, seed: int, exponent: int = 0, rise: float = 1.0) -> liftmesh.Surface:
    grid = np.stack(np.meshgrid(np.arange(size), np.arange(size)), -1).reshape(-1, 2) + seed / 4
    heights = np.random.default_rng(seed).integers(1, 9, len(grid)) * rise
    return liftmesh.triangulate(np.column_stack([np.ldexp(grid, exponent), heights]))


@pytest.mark.parametrize("features", [[3], [None], 5, "ab", [{"type": "Feature", "geometry": 3}]])
def test_collections_that_are_no_geojson_are_one_line(features: object) -> None:
    surface = liftmesh.triangulate([[0, 0, 1], [4, 0, 1], [0, 4, 1]])
    with pytest.raises(liftmesh.InputError, match="the polygon is no GeoJSON: give"):
        surface.volume(0, within={"type": "FeatureCollection", "features": features})
    with pytest.raises(liftmesh.InputError, match="the polygon is no GeoJSON: give"):
        surface.volume_by_polygon({"type": "FeatureCollection", "features": features}, 0)


@pytest.mark.parametrize("far", [1e40, 1e307, 1e308])
def test_polygons_that_shapely_has_no_digits_for_are_refused(far: float) -> None:
    surface = liftmesh.triangulate(SLOPE)
    ring = [[-far, -far], [3 * (far / 3), -far], [far, far], [-far, -far]]
    with pytest.raises(liftmesh.InputError, match=r"polygon 0 reaches as far as 1e\+\d+, and"):
        surface.volume(within=ring)
    with pytest.raises(liftmesh.InputError, match="cut it nearer to them"):
        surface.cut_and_fill(surface, within=ring)


def test_a_polygon_that_is_far_larger_counts_what_it_covers() -> None:
    surface = liftmesh.triangulate(SLOPE)
    far = 1e16
    half = surface.volume(within=[[-far, -far], [far, -far], [far, far], [-far, -far]])
    near = surface.volume(within=[[-99, -99], [99, -99], [99, 99], [-99, -99]])
    assert half.area == pytest.approx(near.area, rel=1e-12)
    assert half.above == pytest.approx(near.above, rel=1e-12)
