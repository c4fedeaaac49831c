"""Contours: the segments of every face, chained; closed, or from border to border."""

from __future__ import annotations

import json
import pickle
import sys
from collections import Counter
from dataclasses import astuple
from decimal import Context, localcontext
from fractions import Fraction
from itertools import pairwise

import ezdxf
import geopandas
import numpy as np
import pyproj
import pytest
from hypothesis import given, settings, strategies as st
from matplotlib.figure import Figure
from oracles.surfaces import ExactSurface
from surfaces import LATTICE, drawn, exactly, meadow, trimmed

import liftmesh

LEVELS = st.lists(st.integers(-18, 18).map(lambda each: each / 2), min_size=1, max_size=4)


def exact_segments(oracle: ExactSurface, level: float) -> Counter:
    """From where the line enters each face to where it leaves, above on the left, in floats."""
    found: Counter = Counter()
    at = Fraction(level)
    for face in oracle.faces:
        above = [oracle.heights[row] >= at for row in face]
        enters = [k for k in range(3) if not above[k - 1] and above[k]]
        leaves = [k for k in range(3) if above[k - 1] and not above[k]]
        if enters:
            # Counter-clockwise around the face, the line has what is above to its left where it
            # comes in across the side on which heights fall.
            ends = [crossing(oracle, face[k - 1], face[k], at) for k in (leaves[0], enters[0])]
            if ends[0] != ends[1]:
                found[tuple(tuple(map(float, each)) for each in ends)] += 1
    return found


def crossing(oracle: ExactSurface, u: int, v: int, level: Fraction):
    share = (level - oracle.heights[u]) / (oracle.heights[v] - oracle.heights[u])
    p, q = oracle.points[u], oracle.points[v]
    return p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])


def near(segments: Counter) -> Counter:
    """Round what is computed in different ways."""
    found: Counter = Counter()
    for ends, count in segments.items():
        found[tuple(tuple(round(each, 9) + 0.0 for each in end) for end in ends)] += count
    return found


def segments_of(lines: liftmesh.Contours, level: float) -> Counter:
    found: Counter = Counter()
    for line in lines:
        if line.level == level:
            points = [tuple(each) for each in line.points.tolist()]
            found.update(pairwise(points))
    return found


@pytest.mark.slow
@settings(max_examples=60)
@given(LATTICE, LEVELS, st.none() | st.floats(1.1, 4))
def test_lines_are_the_segments_of_all_faces(points, levels, limit) -> None:
    surface = drawn(points)
    surface = trimmed(surface, max_edge=limit) if surface and limit else surface
    if surface is None:
        return
    oracle = exactly(surface)
    lines = surface.contours(levels)
    for level in levels:
        assert near(segments_of(lines, level)) == near(exact_segments(oracle, level))


@settings(max_examples=60)
@given(LATTICE, LEVELS, st.none() | st.floats(1.1, 4))
def test_lines_close_or_end_at_the_border(points, levels, limit) -> None:
    surface = drawn(points)
    surface = trimmed(surface, max_edge=limit) if surface and limit else surface
    if surface is None:
        return
    planar = surface.triangulation.points
    rim = [(planar[r[k - 1]], planar[r[k]]) for r in surface.boundary() for k in range(len(r))]
    for line in surface.contours(levels):
        assert len(line.points) >= 2
        assert (line.points[1:] != line.points[:-1]).any(axis=1).all()
        if line.closed:
            assert (line.points[0] == line.points[-1]).all()
            least = min(map(tuple, line.points.tolist()))
            assert tuple(line.points[0]) == least
        else:
            for end in line.points[[0, -1]]:
                assert min(distance(end, p, q) for p, q in rim) < 1e-9


def distance(point, tail, head) -> float:
    """From a point to a segment."""
    along = head - tail
    share = np.clip((point - tail) @ along / (along @ along), 0, 1)
    return float(np.hypot(*(tail + share * along - point)))


@settings(max_examples=60)
@given(LATTICE, LEVELS, st.randoms(use_true_random=False))
def test_no_bit_depends_on_the_order_of_the_rows(points, levels, rng) -> None:
    surface = drawn(points)
    if surface is None:
        return
    lines = surface.contours(levels)
    shuffled = list(points)
    rng.shuffle(shuffled)
    other = drawn(shuffled).contours(levels)
    for name in ("points", "starts", "levels", "closed"):
        np.testing.assert_array_equal(getattr(other, name), getattr(lines, name))


def test_no_bit_depends_on_threads() -> None:
    surface = liftmesh.triangulate(np.random.default_rng(3).random((20_000, 3)))
    one, three = (surface.contours(interval=0.1, threads=each) for each in (1, 3))
    np.testing.assert_array_equal(one.points, three.points)
    np.testing.assert_array_equal(one.starts, three.starts)


def steps_of_faces(surface: liftmesh.Surface, level: float) -> np.ndarray:
    """Where a level enters and leaves each face, above on the left, from the lesser ends."""
    corners = surface.vertices[surface.faces]  # counter-clockwise
    tails, heads = corners, np.roll(corners, -1, axis=1)
    lesser = (tails[..., 0] < heads[..., 0]) | (
        (tails[..., 0] == heads[..., 0]) & (tails[..., 1] < heads[..., 1])
    )
    low, high = (np.where(lesser[..., None], *each) for each in ((tails, heads), (heads, tails)))
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (level - low[..., 2]) / (high[..., 2] - low[..., 2])
        points = low[..., :2] + share[..., None] * (high - low)[..., :2]
    above = tails[..., 2] >= level, heads[..., 2] >= level
    enters, leaves = above[0] & ~above[1], ~above[0] & above[1]
    return np.hstack([points[enters], points[leaves]])


def test_every_crossed_face_has_one_step() -> None:
    rng = np.random.default_rng(31)
    points = rng.random((40_000, 3)) * (100, 100, 1)
    points[:, 2] += 5 * np.sin(points[:, 0] / 9)
    surface = liftmesh.triangulate(points).trim(max_edge=1.5)
    levels = [-3.01, 0.017, 2.9, 4.0]
    lines = surface.contours(levels, threads=2)
    for level in levels:
        found = [np.hstack([x.points[:-1], x.points[1:]]) for x in lines if x.level == level]
        expected = steps_of_faces(surface, level)
        assert len(expected) > 1000
        np.testing.assert_array_equal(in_order(np.vstack(found)), in_order(expected))


def in_order(rows: np.ndarray) -> np.ndarray:
    return rows[np.lexsort(rows.T)]


def rolling(n: int = 4000) -> liftmesh.Surface:
    rng = np.random.default_rng(5)
    x, y = rng.random((2, n)) * 100
    return liftmesh.triangulate(
        np.column_stack([x, y, 20 * np.sin(x / 9) * np.cos(y / 11) + rng.random(n)])
    )


@pytest.mark.parametrize("trim", [False, True])
def test_the_same_lines_as_matplotlib(trim: bool) -> None:
    surface = rolling()
    surface = surface.trim(max_edge=3.5) if trim else surface
    drawing = surface.to_matplotlib()
    axes = Figure().add_subplot()
    for level in (-10.3, 0.01, 7.77):
        lines = surface.contours([level])
        theirs = axes.tricontour(drawing, surface.vertices[:, 2], levels=[level]).allsegs[0]
        assert len(lines) == len(theirs)
        ours = sorted(lines.lengths)
        lengths = sorted(float(np.hypot(*np.diff(each, axis=0).T).sum()) for each in theirs)
        np.testing.assert_allclose(ours, lengths, rtol=1e-12)
        mine, other = (
            np.unique(np.concatenate(each).round(9), axis=0)
            for each in ([line.points for line in lines], theirs)
        )
        np.testing.assert_allclose(mine, other, atol=2e-9)


class TestRule:
    """What corners at a level do."""

    def surface(self, **heights: float) -> liftmesh.Surface:
        """A lattice with some heights by names such as x2y2."""
        rows = {(x, y): 0.0 for x in range(5) for y in range(5)}
        for name, height in heights.items():
            rows[int(name[1]), int(name[3])] = height
        return liftmesh.triangulate([[x, y, z] for (x, y), z in rows.items()])

    def test_a_summit_at_the_level_has_no_line(self) -> None:
        assert len(self.surface(x2y2=1).contours([1])) == 0

    def test_a_ridge_has_a_line_there_and_back(self) -> None:
        (line,) = self.surface(x1y2=1, x2y2=1, x3y2=1).contours([1])
        assert line.closed
        assert line.points.tolist() == [[1, 2], [2, 2], [3, 2], [2, 2], [1, 2]]

    def test_a_plateau_has_a_line_around_it(self) -> None:
        (line,) = self.surface(x2y2=1, x3y2=1, x2y3=1, x3y3=1).contours([1])
        assert line.closed
        assert line.points.tolist()[0] == [2, 2]
        assert {*map(tuple, line.points.tolist())} == {(2, 2), (3, 2), (3, 3), (2, 3)}

    def test_a_pit_at_the_level_has_no_line(self) -> None:
        assert len(self.surface(x2y2=-1).contours([-1])) == 0

    def test_level_ground_has_no_line(self) -> None:
        assert len(self.surface().contours([0, 1, -1])) == 0

    def test_what_is_above_is_on_the_left(self) -> None:
        (line,) = self.surface(x2y2=2).contours([1])
        x, y = line.points.T
        assert np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]) > 0  # around a summit: counter-clockwise
        (line,) = self.surface(x2y2=-2).contours([-1])
        x, y = line.points.T
        assert np.sum(x[:-1] * y[1:] - x[1:] * y[:-1]) < 0


class TestLevels:
    SLOPE = np.array([[0, 0, 0.05], [10, 0, 1.0], [0, 10, 0.05], [10, 10, 1.0]])

    def test_multiples_are_decimal(self) -> None:
        lines = liftmesh.triangulate(self.SLOPE).contours(interval=0.1)
        assert lines.levels.tolist() == [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]
        assert lines.is_index.tolist() == [level in {0.5, 1.0} for level in lines.levels]
        assert all(each.is_index == (each.level in {0.5, 1.0}) for each in lines)

    def test_heights_of_no_face_make_no_level(self) -> None:
        points = meadow()
        expected = liftmesh.triangulate(points).contours(interval=1)
        strange = np.vstack([points, [[50, 50, np.inf]]])
        found = liftmesh.triangulate(strange, nonfinite="skip").contours(interval=1)
        np.testing.assert_array_equal(found.points, expected.points)
        far = np.vstack([points, [[-900, -900, 1e30]]])
        found = liftmesh.triangulate(far).trim(max_edge=200).contours(interval=1)
        assert found.levels.max() < 11

    def test_heights_that_were_written_since_are_refused(self) -> None:
        points = meadow()
        surface = liftmesh.triangulate(points)
        points[:, 2] = np.nan
        with pytest.raises(liftmesh.InputError, match="a height of a face is not finite"):
            surface.contours(interval=1)

    @pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
    def test_one_height_that_was_written_since_is_enough(self, value: float) -> None:
        points = np.random.default_rng(4).random((40_000, 3))
        surface = liftmesh.triangulate(points)
        assert surface.contours(interval=0.25, threads=2).levels.tolist()[-1] == 0.75
        points[12_345, 2] = value
        with pytest.raises(liftmesh.InputError, match="a height of a face is not finite"):
            surface.contours(interval=0.25, threads=2)

    def test_the_callers_decimals_change_no_level(self) -> None:
        points = meadow() + np.array([0, 0, 1000])
        surface = liftmesh.triangulate(points)
        expected = surface.contours(interval=1.25)
        with localcontext(Context(prec=3)):
            np.testing.assert_array_equal(surface.contours(interval=1.25).levels, expected.levels)

    def test_multiples_are_counted_from_the_base(self) -> None:
        lines = liftmesh.triangulate(self.SLOPE).contours(
            interval=0.3, contour_base=0.05, index_every=2
        )
        assert lines.levels.tolist() == [0.35, 0.65, 0.95]
        assert lines.is_index.tolist() == [False, True, False]

    def test_levels_ascend_each_once(self) -> None:
        lines = liftmesh.triangulate(self.SLOPE).contours([0.5, 0.2, 0.5, 7.0])
        assert lines.levels.tolist() == [0.2, 0.5]
        assert not lines.is_index.any()

    def test_short_lines_are_left_out(self) -> None:
        lines = rolling().contours(interval=5)
        long = lines.longer_than(30)
        assert 0 < len(long) < len(lines)
        kept = [line for line, length in zip(lines, lines.lengths, strict=True) if length >= 30]
        for one, other in zip(long, kept, strict=True):
            assert one.level == other.level
            np.testing.assert_array_equal(one.points, other.points)
        assert len(lines.longer_than(1e9)) == 0
        assert len(lines.longer_than(1e9).lengths) == 0

    @pytest.mark.parametrize(
        "taken", [slice(1, 3), slice(None, None, -2), slice(5, 2), slice(-2, None), slice(0, 99)]
    )
    def test_a_slice_has_the_lines_that_a_list_has(self, taken: slice) -> None:
        lines = rolling().contours(interval=5)
        found, expected = lines[taken], [*lines][taken]
        assert isinstance(found, liftmesh.Contours)
        assert len(found) == len(expected)
        np.testing.assert_array_equal(found.lengths, lines.lengths[taken])
        for one, other in zip(found, expected, strict=True):
            assert (one.level, one.closed, one.is_index) == (
                other.level,
                other.closed,
                other.is_index,
            )
            np.testing.assert_array_equal(one.points, other.points)

    @pytest.mark.parametrize("height", [1.7e308, 5e-324, 1e-300])
    def test_heights_of_any_size(self, height: float) -> None:
        surface = liftmesh.triangulate(
            [[0, 0, -height], [4, 0, height], [0, 4, -height], [4, 4, height]]
        )
        (line,) = surface.contours([0])
        assert (line.points[[0, -1], 0] == 2).all()

    @pytest.mark.parametrize(
        ("options", "said"),
        [
            ({}, "give either levels or interval"),
            ({"levels": [1], "interval": 1}, "give either"),
            ({"interval": 0}, "interval is 0: give a positive height"),
            ({"interval": -1}, "positive"),
            ({"interval": np.nan}, "interval is nan: give a finite"),
            ({"interval": 1, "contour_base": "sea"}, "contour_base is 'sea'"),
            ({"interval": 1e-9}, "levels: give a larger one"),
            ({"interval": 1, "index_every": 0}, "index_every"),
            ({"levels": [np.inf]}, "finite heights"),
            ({"levels": ["a"]}, "cannot be read as numbers"),
            ({"levels": [1, "3"]}, "cannot be read as numbers"),
            ({"levels": np.array([1, "3"], object)}, "cannot be read as numbers"),
            ({"levels": np.array([3], "m8[s]")}, "cannot be read as numbers"),
            ({"interval": "3"}, "interval is '3'"),
        ],
    )
    def test_what_are_no_levels_is_refused(self, options, said: str) -> None:
        with pytest.raises(liftmesh.InputError, match=said):
            liftmesh.triangulate(self.SLOPE).contours(**options)


class TestResult:
    @pytest.fixture
    def lines(self) -> liftmesh.Contours:
        return liftmesh.triangulate(meadow(), crs="EPSG:7415").contours(interval=2)

    def test_it_is_a_sequence(self, lines) -> None:
        assert len([*lines]) == len(lines) > 3
        np.testing.assert_array_equal(lines[-1].points, lines[len(lines) - 1].points)
        with pytest.raises(IndexError):
            lines[len(lines)]
        assert repr(lines).startswith(f"<Contours: {len(lines):,} lines at ")

    def test_it_stays_as_it_is(self, lines) -> None:
        with pytest.raises(ValueError, match="read-only"):
            lines.points[0, 0] = 1
        copy = pickle.loads(pickle.dumps(lines))
        np.testing.assert_array_equal(copy.points, lines.points)

    def test_geojson_holds_everything(self, lines, tmp_path) -> None:
        path = lines.save(tmp_path / "lines.geojson").path
        tree = json.loads(path.read_text())
        assert tree["crs"]["properties"]["name"] == "urn:ogc:def:crs:EPSG::7415"
        for feature, line in zip(tree["features"], lines, strict=True):
            assert feature["properties"] == {
                "height": line.level,
                "index": line.is_index,
                "closed": line.closed,
            }
            assert feature["geometry"]["type"] == "LineString"
            assert feature["geometry"]["coordinates"] == line.points.tolist()

    @pytest.mark.parametrize(
        ("crs", "name"),
        [
            ("epsg:25832", "urn:ogc:def:crs:EPSG::25832"),
            ("urn:ogc:def:crs:EPSG::25832", "urn:ogc:def:crs:EPSG::25832"),
            ("EPSG:25832+7837", "EPSG:25832+7837"),
            (pyproj.CRS("EPSG:25832").to_wkt(), "urn:ogc:def:crs:EPSG::25832"),
            (pyproj.CRS("EPSG:7415").to_wkt("WKT1_GDAL"), "urn:ogc:def:crs:EPSG::7415"),
            ('LOCAL_CS["site",UNIT["metre",1]]', 'LOCAL_CS["site",UNIT["metre",1]]'),
        ],
    )
    def test_no_coordinate_system_is_lost(self, crs: str, name: str, tmp_path) -> None:
        lines = liftmesh.triangulate(meadow(), crs=crs).contours([5])
        tree = json.loads(lines.save(tmp_path / "lines.json").path.read_text())
        assert tree["crs"] == {"type": "name", "properties": {"name": name}}
        if not name.startswith("LOCAL"):
            assert pyproj.CRS(name) == pyproj.CRS(crs)

    @pytest.mark.parametrize("name", ["lines.kml", "lines.dwg", "lines.png", "lines", "-"])
    def test_other_formats_are_refused(self, lines, name: str, tmp_path) -> None:
        with pytest.raises(
            liftmesh.FormatError, match=r"as GeoJSON, GeoPackage .*: name it \*\.geojson"
        ):
            lines.save(tmp_path / name)
        assert list(tmp_path.iterdir()) == []

    @pytest.mark.parametrize("crs", [None, "EPSG:25832"])
    def test_geopackage_has_the_same_lines(self, crs, tmp_path) -> None:
        lines = liftmesh.triangulate(meadow(), crs=crs).contours(interval=2)
        path, kind, size, *_ = astuple(lines.save(tmp_path / "lines.gpkg"))
        assert (kind, size) == ("geopackage", path.stat().st_size)
        frame = geopandas.read_file(path, layer="contours")
        assert frame["height"].tolist() == lines.levels.tolist()
        assert frame["index"].tolist() == lines.is_index.tolist()
        for shape, line in zip(frame.geometry, lines, strict=True):
            assert [*map(list, shape.coords)] == line.points.tolist()
        assert (None if crs is None else frame.crs.to_epsg()) == (crs and 25832)
        assert [each.name for each in tmp_path.iterdir()] == ["lines.gpkg"]

    def test_shapefiles_have_the_same_lines(self, tmp_path) -> None:
        lines = liftmesh.triangulate(meadow(), crs="EPSG:25832").contours(interval=2)
        path, kind, size, *_ = astuple(lines.save(tmp_path / "lines.shp"))
        assert (kind, size) == ("shapefile", path.stat().st_size)
        frame = geopandas.read_file(path)
        assert frame["height"].tolist() == lines.levels.tolist()
        assert frame["index"].tolist() == lines.is_index.tolist()
        for shape, line in zip(frame.geometry, lines, strict=True):
            assert [*map(list, shape.coords)] == line.points.tolist()
        assert frame.crs.to_epsg() == 25832
        written = {each.name for each in tmp_path.iterdir()}
        assert written == {f"lines.{each}" for each in ("cpg", "dbf", "prj", "shp", "shx")}
        (tmp_path / "lines.sbn").write_text("an index of the old lines")
        unplaced = liftmesh.triangulate(meadow()).contours([1e9])
        unplaced.save(path)
        frame = geopandas.read_file(path)
        assert (len(frame), frame.crs) == (0, None)
        written -= {"lines.prj"}
        assert {each.name for each in tmp_path.iterdir()} == written

    def test_a_shapefile_replaces_nothing_that_is_not_its_own(self, lines, tmp_path) -> None:
        (tmp_path / "lines.dbf").write_text("somebody's table")
        with pytest.raises(FileExistsError, match=r"lines\.dbf"):
            lines.save(tmp_path / "lines.shp")
        assert [each.name for each in tmp_path.iterdir()] == ["lines.dbf"]
        assert (tmp_path / "lines.dbf").read_text() == "somebody's table"

    def test_drawings_have_the_same_lines_at_their_heights(self, tmp_path) -> None:
        lines = liftmesh.triangulate(meadow(), crs="EPSG:25832").contours(interval=1)
        written = lines.save(tmp_path / "lines.dxf")
        assert (written.format, written.dropped) == ("dxf", ("crs",))
        found = ezdxf.readfile(tmp_path / "lines.dxf").modelspace().query("POLYLINE")
        assert len(found) == len(lines)
        for each, line in zip(found, lines, strict=True):
            assert each.is_closed == line.closed
            assert each.dxf.elevation.z == line.level
            assert each.dxf.layer == ("contours-index" if line.is_index else "contours")
            points = [[*vertex.dxf.location] for vertex in each.vertices]
            expected = line.points[:-1] if line.closed else line.points
            assert points == [[*place, line.level] for place in expected.tolist()]
        again = liftmesh.read(tmp_path / "lines.dxf")
        assert {*again.points[:, 2]} == {*lines.levels}
        assert len(again.edges) == sum(len(line.points) - 1 for line in lines)

    def test_geopackage_needs_what_geopandas_writes_by(self, lines, tmp_path, monkeypatch) -> None:
        monkeypatch.setitem(sys.modules, "pyogrio", None)
        with pytest.raises(liftmesh.MissingDependencyError, match=r"pyogrio.*liftmesh\[shapes\]"):
            lines.save(tmp_path / "lines.gpkg")
        assert list(tmp_path.iterdir()) == []

    @pytest.mark.parametrize("length", [np.nan, -1, "a", [1, 2], None])
    def test_what_is_no_length_is_refused(self, lines, length) -> None:
        with pytest.raises(liftmesh.InputError, match=r"length is .*: give a number"):
            lines.longer_than(length)

    def test_a_surface_without_lines_is_a_file_without_features(self, tmp_path) -> None:
        path = rolling().contours([1e9]).save(tmp_path / "lines.geojson").path
        assert json.loads(path.read_text()) == {"type": "FeatureCollection", "features": []}

    def test_errors_leave_nothing_behind(self, lines, tmp_path) -> None:
        with pytest.raises(FileNotFoundError, match="does not exist"):
            lines.save(tmp_path / "nowhere" / "lines.geojson")
        assert list(tmp_path.iterdir()) == []
