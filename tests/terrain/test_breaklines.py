"""Surfaces that follow lines: which edges they have, and what heights."""

from __future__ import annotations

import json
from pathlib import Path

import ezdxf
import geopandas
import numpy as np
import pytest
import shapely
from hypothesis import given, settings, strategies as st
from surfaces import hills, plane_area

import liftmesh
from liftmesh import InputError
from liftmesh.errors import FormatError
from liftmesh.planar import crossing_edges

KERB = np.array([[0, 8, 10], [64, 24, 14]], dtype=float)
OTHER_KERB = np.array([[0, 12, 10], [64, 28, 14]], dtype=float)
SQUARE = np.array([[8, 4], [56, 4], [56, 28], [8, 28]], dtype=float)


def sides(surface: liftmesh.Surface) -> set[tuple[int, int]]:
    a, b, c = surface.faces.T
    ends = np.sort(np.concatenate([np.stack(each, 1) for each in ((a, b), (b, c), (c, a))]), axis=1)
    return set(map(tuple, ends.tolist()))


@pytest.mark.parametrize("threads", [1, 2])
def test_cross_sections_of_a_road_are_straight(threads: int) -> None:
    """Kerbs over hills, with the cloud between them left out: exact at dyadic coordinates."""
    points = hills()
    across = points[:, 1] - points[:, 0] / 4
    points = points[(across < 8) | (across > 12)]
    kerbs = [KERB, OTHER_KERB + np.array([0, 0, 0.5])]
    surface = liftmesh.triangulate(points, breaklines=kerbs, threads=threads)
    rows = len(points) + np.arange(4)
    np.testing.assert_array_equal(surface.vertices, np.concatenate([points, *kerbs]))
    assert {tuple(rows[:2]), tuple(rows[2:])} <= sides(surface)
    assert surface.triangulation.constraints.tolist() == rows.reshape(2, 2).tolist()
    x = np.arange(1, 64) / 1.0
    for share in np.arange(9) / 8:
        found = surface.sample(np.column_stack([x, 8 + x / 4 + 4 * share]))
        np.testing.assert_array_equal(found, 10 + x / 16 + share / 2)
    np.testing.assert_array_equal(surface.attributes["breakline"][-5:], [0, 1, 1, 1, 1])
    assert surface.report.lines == {
        "rows": 4,
        "rows_from_around": 0,
        "rows_at_crossings": 0,
        "rows_at_other_heights": 0,
        "edges": 2,
        "flat_triangles": 0,
        "lines_beyond": 0,
    }
    assert "Lines: 4 rows in 2 edges." in str(surface.report)
    assert "lines" not in str(liftmesh.triangulate(points).report).lower()


def test_a_row_of_the_cloud_on_a_line_divides_it_and_keeps_its_height() -> None:
    points = [[0, 0, 0], [8, 0, 0], [0, 8, 0], [8, 8, 0], [4, 4, 7]]
    surface = liftmesh.triangulate(points, breaklines=[[0, 4, 1], [8, 4, 1]])
    assert {(4, 5), (4, 6)} <= sides(surface)
    assert surface.sample([[4, 4], [2, 4]]).tolist() == [7, 4]


@pytest.mark.parametrize("policy", ["first", "last", "lowest", "highest", "mean", "error"])
def test_the_height_of_a_line_holds_at_its_corners(policy: str) -> None:
    points = [[0, 0, 0], [8, 0, 0], [0, 8, 0], [8, 8, 0], [4, 4, 7], [4, 4, 7]]
    line = [[4, 4, 3], [8, 6, 3]]
    surface = liftmesh.triangulate(points, breaklines=line, on_duplicate=policy)
    assert surface.sample([4, 4]) == 3
    report = surface.report
    assert report.left_out.tolist() == [4, 5]
    assert report.representatives.tolist() == [6, 6]
    assert (report.n_rows, report.n_used, report.n_overhangs) == (8, 6, 2)


def test_two_lines_at_one_corner_follow_the_policy() -> None:
    points = [[0, 0, 0], [8, 0, 0], [0, 8, 0], [8, 8, 0]]
    lines = [[[1, 1, 3], [4, 4, 3]], [[4, 4, 5], [7, 2, 5]]]
    for policy, height in (("first", 3), ("highest", 5), ("mean", 4)):
        surface = liftmesh.triangulate(points, breaklines=lines, on_duplicate=policy)
        assert surface.sample([4, 4]) == height
        assert surface.report.lines["rows_at_other_heights"] == 1
        assert "1 left out, as lines meet there at other heights" in str(surface.report)
    with pytest.warns(liftmesh.DataWarning, match="the points have 2 edges, not used here"):
        again = liftmesh.triangulate(surface, breaklines=[[2, 6, 3], [3, 6, 3], [2, 6, 4]])
    assert again.report.lines["rows"] == 3
    assert again.report.lines["rows_at_other_heights"] == 1
    level = [[[1, 1, 3], [4, 4, 3]], [[4, 4, 3], [7, 2, 5]]]
    assert not liftmesh.triangulate(points, breaklines=level).report.lines["rows_at_other_heights"]
    with pytest.raises(liftmesh.DuplicateHeightError, match=r"rows 5 and 6 .* heights 3.0 and 5.0"):
        liftmesh.triangulate(points, breaklines=lines, on_duplicate="error")


def test_lines_that_cross_are_named_with_both_heights() -> None:
    lines = [KERB, [[10, 0, 3], [10, 32, 5]], [[0, 30, 1], [64, 30, 1]]]
    with pytest.raises(InputError) as caught:
        liftmesh.triangulate(hills(), breaklines=lines)
    assert str(caught.value) == (
        "lines cross where they have no corner: breakline 0 and breakline 1 at (10.0, 10.5), at "
        "the heights 10.625 and 3.65625; breakline 1 and breakline 2 at (10.0, 30.0), at the "
        "heights 4.875 and 1.0. Give both a corner there, or crossing='split', which takes the "
        "height of the first"
    )
    surface = liftmesh.triangulate(hills(), breaklines=lines, crossing="split")
    assert surface.vertices[-2:].tolist() in (
        [[10, 10.5, 10.625], [10, 30, 4.875]],
        [[10, 30, 4.875], [10, 10.5, 10.625]],
    )
    assert surface.report.lines["rows_at_crossings"] == 2
    apart = liftmesh.triangulate(hills(), breaklines=lines[::2], crossing="split")
    assert apart.report.lines["rows_at_crossings"] == 0
    turned = liftmesh.triangulate(hills(), breaklines=lines[1::-1], crossing="split")
    assert turned.vertices[-1].tolist() == [10, 10.5, 3.65625]


def test_draped_lines_follow_the_surface() -> None:
    points = hills()
    plain = liftmesh.triangulate(points)
    line = np.array([[-5, 3, 99], [30.25, 30, 99], [60, 2, 99]])
    surface = liftmesh.triangulate(points, soft_breaklines=line)
    share = np.linspace(0.2, 1, 200)[:, None]
    places = np.vstack(
        [line[0] + share * (line[1] - line[0]), line[1] + share * (line[2] - line[1])]
    )
    expected = plain.sample(places[:, :2])
    np.testing.assert_allclose(surface.sample(places[:, :2]), expected, atol=1e-9)
    assert (surface.attributes["breakline"][len(points) :] == 2).all()
    profile = plain.profile(line[:, :2])
    assert surface.report.lines["rows_from_around"] == len(profile.points)
    assert surface.report.lines["edges"] == len(profile.points) - 1


def test_a_line_with_heights_is_above_draped_ones() -> None:
    surface = liftmesh.triangulate(
        hills(), breaklines=KERB, soft_breaklines=[[[30, 1], [34, 31]], [[34, 31], [30, 1]]]
    )
    (crossing,) = surface.triangulation.crossing_rows
    x, y, z = surface.vertices[crossing]
    assert z == pytest.approx(10 + x / 16, abs=1e-12)
    assert y == pytest.approx(8 + x / 4, abs=1e-12)
    np.testing.assert_allclose(surface.sample([[x / 2, 8 + x / 8]]), 10 + x / 32, atol=1e-12)


def test_lines_without_heights_take_those_around_at_their_corners() -> None:
    points = [[0, 0, 0], [8, 0, 0], [0, 8, 8], [8, 8, 8], [4, 4, 9]]
    plain = liftmesh.triangulate(points)
    line = np.array([[1.0, 2], [7, 2]])
    for given_line in (line, np.column_stack([line, [5, np.nan]])):
        surface = liftmesh.triangulate(points, breaklines=given_line)
        assert surface.sample(line).tolist() == plain.sample(line).tolist()
        assert surface.sample([4, 2]) == plain.sample(line).mean() < plain.sample([4, 2])
        assert surface.report.lines["rows_from_around"] == 2
    dense = liftmesh.triangulate(points, breaklines=line, densify=1.5)
    assert dense.report.lines["rows"] == 5
    assert dense.sample([4, 2]) == plain.sample([4, 2])
    with pytest.raises(InputError, match=r"breakline 1 has no heights.*corner \(9.0, 2.0\)"):
        liftmesh.triangulate(points, breaklines=[line, [[1, 1], [9, 2]]])


@given(
    st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), min_size=2, max_size=5, unique=True),
    st.floats(0.3, 20),
)
@settings(max_examples=30)
def test_densified_lines_are_straight_and_the_same_in_both_directions(corners, distance) -> None:
    from liftmesh.terrain.frame import resolve_plane
    from liftmesh.terrain.lines import Line

    space = np.column_stack([corners, np.arange(len(corners))]).astype(float)
    frame = resolve_plane("xy", space)
    found = Line("a", space, draped=False).densified(frame, distance)
    back = Line("a", space[::-1].copy(), draped=False).densified(frame, distance)
    np.testing.assert_array_equal(found, back[::-1])
    gaps = np.hypot(*np.diff(found[:, :2], axis=0).T)
    assert (gaps <= distance * (1 + 1e-12)).all()
    assert {*map(tuple, space.tolist())} <= {*map(tuple, found.tolist())}
    assert gaps.sum() == pytest.approx(np.hypot(*np.diff(space[:, :2], axis=0).T).sum())


def test_contour_lines_leave_flat_triangles() -> None:
    ring = np.array([[0, 0], [8, 0], [8, 8], [0, 8], [0, 0]], dtype=float)
    contours = [np.column_stack([ring, np.zeros(5)]), np.column_stack([ring / 2 + 2, np.ones(5)])]
    corners = np.concatenate(contours)[:4]
    surface = liftmesh.triangulate(corners, breaklines=contours)
    assert surface.report.lines["flat_triangles"] == 2
    assert "2 flat triangles" in str(surface.report)
    assert surface.report.n_duplicates == 4


def test_values_of_rows_of_lines_are_those_of_the_nearest_row() -> None:
    points = hills()
    rng = np.random.default_rng(3)
    values = rng.integers(0, 9, len(points))
    colors = rng.integers(0, 256, (len(points), 3)).astype(np.uint8)
    surface = liftmesh.triangulate(
        points, colors=colors, attributes={"class": values}, breaklines=KERB
    )
    far = np.hypot(*(points[:, :2] - KERB[1, :2]).T)
    assert surface.attributes["class"][-1] == values[far.argmin()]
    assert surface.colors[-1].tolist() == colors[far.argmin()].tolist()
    with pytest.warns(liftmesh.DataWarning, match="1 edge, not used here"):
        again = liftmesh.triangulate(surface, breaklines=OTHER_KERB)
    assert again.attributes["breakline"][-5:].tolist() == [0, 1, 1, 1, 1]
    named = {"breakline": values.astype(float)}
    with pytest.raises(InputError, match="values named 'breakline'"):
        liftmesh.triangulate(points, attributes=named, breaklines=KERB)


def test_heights_of_crossings_are_those_along_the_first_line() -> None:
    lines = [[[2, 2, 10], [10, 10, 18]], [[2, 10, 0], [10, 2, 0]], [[4, 1, 3], [4, 11, 8]]]
    surface = liftmesh.triangulate(hills(), breaklines=lines, crossing="split")
    heights = {tuple(row[:2].tolist()): row[2] for row in surface.vertices[-3:]}
    assert heights == {(4, 4): 12, (6, 6): 14, (4, 8): 0}


def test_other_planes() -> None:
    wall = hills()[:, [0, 2, 1]] * [1, -1, 1]  # seen against y
    line = KERB[:, [0, 2, 1]] * [1, -1, 1]
    surface = liftmesh.triangulate(wall, breaklines=line, plane="xz")
    flat = liftmesh.triangulate(hills(), breaklines=KERB)
    assert sides(surface) == sides(flat)
    draped = liftmesh.triangulate(wall, boundary=SQUARE, plane="xz")
    level = liftmesh.triangulate(hills(), boundary=SQUARE).triangulation
    np.testing.assert_array_equal(draped.triangulation.points, level.points)
    np.testing.assert_array_equal(draped.frame.planar(draped.vertices), draped.triangulation.points)
    for more in ({}, {"densify": 3.0}):  # with heights a draped line is in space, too
        draped = liftmesh.triangulate(wall, soft_breaklines=line, plane="xz", **more)
        level = liftmesh.triangulate(hills(), soft_breaklines=KERB, **more).triangulation
        np.testing.assert_array_equal(draped.triangulation.points, level.points)
    tilted = liftmesh.triangulate(hills(), breaklines=KERB, plane="fit")
    assert len(tilted.triangulation.constraints) >= 1
    with pytest.raises(InputError, match="'xy', 'xz' or 'yz'"):
        liftmesh.triangulate(hills(), boundary=SQUARE, plane="fit")
    lines = [KERB, [[10, 0, 3], [10, 32, 5]]]
    with pytest.raises(InputError, match=r"new rows need a plane .*, not 'fit'"):
        liftmesh.triangulate(hills(), breaklines=lines, plane="fit", crossing="split")
    with pytest.raises(InputError, match="new rows need a plane whose coordinates are exact"):
        liftmesh.triangulate(hills(), soft_breaklines=KERB, plane="fit")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"breaklines": KERB, "weights": "z"}, "weights and lines are given"),
        ({"breaklines": KERB, "metric": np.eye(2)}, "metric and lines are given"),
        ({"breaklines": KERB, "algorithm": "lf"}, "algorithm 'lf' takes no lines"),
        ({"densify": 3.0}, "densify is for lines"),
        ({"breaklines": KERB, "densify": 0}, "densify is 0"),
        ({"breaklines": KERB, "densify": 1e-300}, "too short for breakline 0"),
        ({"breaklines": 5}, "breaklines are 5"),
        ({"breaklines": [[1, 2, 3]]}, "breakline 0 needs two corners"),
        ({"boundary": [[1, 2], [3, 4]]}, "needs three corners"),
        ({"breaklines": [[0, 0, np.inf], [1, 1, 1]]}, "a height of breakline 0 is not finite"),
        ({"breaklines": [[0, np.nan, 1], [1, 1, 1]]}, "a corner of breakline 0 is not finite"),
        ({"breaklines": KERB, "crossing": "ignore"}, "crossing is 'ignore'"),
        ({"holes": {"type": "Point", "coordinates": [1, 2]}}, "Polygon or MultiPolygon"),
        ({"holes": {"type": "Feature", "geometry": [3]}}, "no GeoJSON"),
    ],
)
def test_what_is_refused(options, message) -> None:
    cloud = liftmesh.Cloud(hills(), attributes={"z": hills()[:, 2]})
    with pytest.raises(InputError, match=message):
        liftmesh.triangulate(cloud, **options)


def test_too_many_corners_are_refused_before_they_are_made() -> None:
    lines = [[[0, k, 0], [64, k, 1]] for k in range(1, 40)]
    with pytest.raises(
        InputError, match="would be 24,960,000 corners, and 16,777,216 are the most"
    ):
        liftmesh.triangulate(hills(), breaklines=lines, densify=1e-4)


def test_lines_beyond_the_points_are_told() -> None:
    points, away = hills(), np.array([5e5, 5e6])
    plain = liftmesh.triangulate(points)
    for option in ("soft_breaklines", "holes"):
        with pytest.warns(liftmesh.DataWarning, match=f"of {option} lie beyond all points") as told:
            surface = liftmesh.triangulate(points, **{option: SQUARE + away})
        assert told[0].filename == __file__
        np.testing.assert_array_equal(surface.faces, plain.faces)
        assert surface.report.lines["lines_beyond"] == 1
        assert "1 line beyond all faces" in str(surface.report)
    where = r"reach from .* to .*; they from \[500000.0, 8.0\] to"
    with pytest.warns(liftmesh.DataWarning, match=where):
        liftmesh.triangulate(points, breaklines=KERB + np.array([5e5, 0, 0]))
    some = liftmesh.triangulate(points, soft_breaklines=[SQUARE, SQUARE + away])
    assert some.report.lines["lines_beyond"] == 1
    wide = liftmesh.triangulate(points, boundary=[[-1e308, -9], [1e308, -9], [0, 1e308]])
    assert wide.report.lines["lines_beyond"] == 0


def test_heights_of_lines_are_in_the_unit_of_the_points() -> None:
    lines = [shapely.LineString(KERB)]
    feet, metres = "EPSG:6347+6360", "EPSG:6347+5703"
    frame = geopandas.GeoDataFrame(geometry=lines, crs=feet)
    with pytest.raises(InputError, match="in the unit US survey foot, and the points in metre"):
        liftmesh.triangulate(hills(), breaklines=frame, crs=metres)
    with pytest.warns(liftmesh.DataWarning):  # x in metres, z in feet
        same = liftmesh.triangulate(hills(), breaklines=frame, crs=feet)
    flat = liftmesh.triangulate(hills(), breaklines=frame.set_crs("EPSG:6347", allow_override=True))
    np.testing.assert_array_equal(same.vertices, flat.vertices)


def test_lines_that_touch_or_overlap_keep_the_heights_of_their_corners() -> None:
    points = [[0, 0, 0], [8, 0, 0], [0, 8, 0], [8, 8, 0]]
    touching = [[[0, 4, 1], [8, 4, 1]], [[4, 4, 7], [4, 8, 7]]]
    surface = liftmesh.triangulate(points, breaklines=touching)
    assert surface.sample([[2, 4], [4, 4], [4, 6]]).tolist() == [4, 7, 7]
    overlapping = [[[0, 4, 1], [8, 4, 1]], [[2, 4, 5], [6, 4, 5]]]
    surface = liftmesh.triangulate(points, breaklines=overlapping)
    assert surface.sample([[1, 4], [2, 4], [4, 4], [7, 4]]).tolist() == [3, 5, 5, 3]


def test_closed_contour_lines_alone_are_a_surface() -> None:
    turns = np.linspace(0, 2 * np.pi, 61)
    rings = [
        np.column_stack([32 + r * np.cos(turns), 16 + r * np.sin(turns), np.full(61, 20.0 - r)])
        for r in (15.0, 10, 5)
    ]
    for ring in rings:
        ring[-1] = ring[0]
    surface = liftmesh.triangulate(np.empty((0, 3)), breaklines=rings)
    assert (surface.report.lines["rows"], surface.report.lines["edges"]) == (180, 180)
    assert surface.report.lines["flat_triangles"] == 58  # of the innermost ring
    assert len(surface.triangulation.constraints) == 180


def test_lines_of_other_libraries_and_files(tmp_path: Path) -> None:
    lines = [shapely.LineString(KERB), shapely.LineString(OTHER_KERB)]
    plain = liftmesh.triangulate(hills(), breaklines=[KERB, OTHER_KERB])
    frame = geopandas.GeoDataFrame(geometry=lines, crs="EPSG:25832")
    (tmp_path / "kerbs.json").write_text(
        json.dumps(shapely.geometry.mapping(shapely.union_all(lines)))
    )
    frame.to_file(tmp_path / "kerbs.gpkg")
    frame.to_file(tmp_path / "kerbs.shp")
    given_forms = [lines, frame, shapely.MultiLineString(lines)]
    given_forms += [tmp_path / name for name in ("kerbs.json", "kerbs.gpkg", "kerbs.shp")]
    for each in given_forms:
        found = liftmesh.triangulate(hills(), breaklines=each, crs="EPSG:25832")
        np.testing.assert_array_equal(found.vertices, plain.vertices)
    with pytest.raises(InputError, match=r"kerbs.gpkg is in 'EPSG:25832', the surface in"):
        liftmesh.triangulate(hills(), breaklines=tmp_path / "kerbs.gpkg", crs="EPSG:25833")
    with pytest.raises(FormatError, match=r"kerbs.json: .*no Polygon or MultiPolygon"):
        liftmesh.triangulate(hills(), holes=tmp_path / "kerbs.json")
    island = shapely.Polygon(SQUARE, [[(20, 8), (20, 20), (30, 20)]])
    geopandas.GeoDataFrame(geometry=[island], crs="EPSG:25832").to_file(tmp_path / "lots.shp")
    for each in (island, tmp_path / "lots.shp"):
        found = liftmesh.triangulate(hills(), boundary=each)
        assert plane_area(found) == pytest.approx(island.area)


@pytest.mark.parametrize("suffix", ["dxf", "obj"])
def test_drawings(tmp_path: Path, suffix: str) -> None:
    """Lines with heights, and those of a plan, which has none; closed ones bound what is hidden."""
    for height, flagged in ((1.0, 1), (0.0, 2)):
        line = KERB * [1, 1, height]
        path, rings = tmp_path / f"kerb.{suffix}", tmp_path / f"rings.{suffix}"
        if suffix == "dxf":
            drawing, other = ezdxf.new(), ezdxf.new()
            drawing.modelspace().add_polyline3d(line)
            other.modelspace().add_lwpolyline(SQUARE, close=True)
            other.modelspace().add_lwpolyline(SQUARE / 2 + [16, 8], close=True)
            drawing.saveas(path)
            other.saveas(rings)
        else:
            path.write_text("".join("v {} {} {}\n".format(*row) for row in line) + "l 1 2\n")
            corners = np.concatenate([SQUARE, SQUARE / 2 + [16, 8]])
            content = "".join("v {} {}\n".format(*row) for row in corners)
            rings.write_text(content + "l 1 2 3 4 1\nl 5 6 7 8 5\n")
        surface = liftmesh.triangulate(hills(), breaklines=path)
        assert surface.attributes["breakline"][-2:].tolist() == [flagged] * 2
        assert surface.sample(KERB[1, :2]) == (14 if flagged == 1 else surface.vertices[-1, 2])
        hidden = liftmesh.triangulate(hills(), holes=rings)
        whole = plane_area(liftmesh.triangulate(hills()))
        assert plane_area(hidden) == pytest.approx(whole - 48 * 24 * 3 / 4)


def test_lines_that_cross_without_end_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(crossing_edges, "_MOST_ROUNDS", 0)
    lines = [[[8.0, 4.0], [56.0, 28.0]], [[8.0, 28.0], [56.0, 4.0]]]
    with pytest.raises(
        liftmesh.CrossingError,
        match=r"soft breakline 0 and soft breakline 1 still cross after many splits, at \(32.*move",
    ):
        liftmesh.triangulate(hills(), soft_breaklines=lines)
