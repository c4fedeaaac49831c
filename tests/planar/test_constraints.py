"""Polylines and polygons in all forms become edges between rows."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import geopandas
import numpy as np
import pytest
import shapely
import trimesh
from hypothesis import given, settings, strategies as st

import liftmesh
from liftmesh import constrained_delaunay
from liftmesh.planar import constraints
from liftmesh.planar.constraints import Constraints, gather, match_rows

SQUARE = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]]
HOLE = [[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]]
LINE = shapely.LineString([[0, 0], [3, 3], [4, 3.5]])
LINE_Z = shapely.LineString([[0, 0, 7], [3, 3, 8], [4, 3.5, 9]])
AREA = shapely.Polygon(SQUARE, [HOLE])


def gathered(**options: Any) -> Constraints:
    given: dict[str, Any] = {"edges": None, "polylines": None, "polygons": None, **options}
    return gather(np.array(SQUARE), **given)


def path2d() -> trimesh.path.Path2D:
    return trimesh.load_path(np.array([[0, 0], [3, 3], [4, 3.5]], dtype=float))


LINES: dict[str, Any] = {
    "rows": [np.array([0, 2])],
    "a chain of rows": (0, 2),
    "an array of chains": np.array([[0, 2]], dtype=np.uint8),
    "coordinates": [[[0, 0], [3, 3], [4, 3.5]]],
    "one array": np.array(LINE.coords),
    "one list": [[0.0, 0.0], [3.0, 3.0], (4.0, 3.5)],
    "heights": np.array(LINE_Z.coords),
    "a geometry": LINE,
    "geometries": [LINE],
    "with heights": [LINE_Z],
    "parts": shapely.MultiLineString([LINE]),
    "a collection": shapely.GeometryCollection([shapely.Point(1, 1), LINE]),
    "a frame": geopandas.GeoDataFrame(geometry=[LINE]),
    "a series": geopandas.GeoSeries([LINE]),
    "GeoJSON": LINE.__geo_interface__,
    "a path": path2d(),
    "paths": [path2d()],
}


@pytest.mark.parametrize("form", LINES)
def test_forms_of_polylines(form: str) -> None:
    found = gathered(polylines=LINES[form])
    is_short = "rows" in form or "chains" in form
    assert found.edges.tolist() == ([[0, 2]] if is_short else [[0, 2], [2, 4]])
    assert found.added.tolist() == ([] if is_short else [[4, 3.5]])
    assert (found.polyline == 0).all()
    assert (found.polygon == -1).all()


AREAS: dict[str, Any] = {
    "rings": [[SQUARE, HOLE]],
    "closed rings": [[[*SQUARE, SQUARE[0]], [*HOLE, HOLE[0]]]],
    "arrays": [[np.array(SQUARE), np.array(HOLE)]],
    "rows and coordinates": [[[0, 1, 2, 3], HOLE]],
    "rows that return": [[(0, 1, 2, 3, 0), HOLE]],
    "a geometry": AREA,
    "geometries": [AREA],
    "parts": shapely.MultiPolygon([AREA]),
    "a frame": geopandas.GeoDataFrame(geometry=[AREA]),
    "GeoJSON": AREA.__geo_interface__,
    "a path": trimesh.load_path(AREA),
}


@pytest.mark.parametrize("form", AREAS)
def test_forms_of_polygons(form: str) -> None:
    found = gathered(polygons=AREAS[form])
    assert len(found.edges) == 8
    assert len(found.added) == 4
    is_path = "path" in form  # which does not say what is a hole
    assert found.polygon.tolist() == [0] * 4 + [is_path] * 4
    assert found.winding.any(axis=1).tolist() == [not is_path] * 8
    assert found.bounds.all()
    tri = constrained_delaunay(SQUARE, polygons=AREAS[form], carve="holes")
    assert tri.nsimplex == 8
    assert tri.find_simplex([[1.5, 1.5], [0.5, 0.6]]).tolist()[0] == -1


@pytest.mark.parametrize(
    "ring", [[0, 1, 2], [[0, 0], [3, 0], [3, 3]], np.array([[0, 0], [3, 0], [3, 3]])]
)
@pytest.mark.parametrize("depth", [0, 1, 2])
def test_one_ring_at_any_depth(ring: Any, depth: int) -> None:
    for _ in range(depth):
        ring = [ring]
    found = gathered(polygons=ring)
    assert found.edges.tolist() == [[0, 1], [1, 2], [2, 0]]
    assert found.winding.tolist() == [[1, 0]] * 3


@pytest.mark.parametrize("kind", ["GeoJSON", "GPKG", "ESRI Shapefile"])
def test_files(kind: str, tmp_path: Path) -> None:
    suffix = {"GeoJSON": ".geojson", "GPKG": ".gpkg", "ESRI Shapefile": ".shp"}[kind]
    for name, shape in (("lines", LINE), ("areas", AREA)):
        frame = geopandas.GeoDataFrame(geometry=[shape, shape], crs=25832)
        frame.to_file(tmp_path / f"{name}{suffix}", driver=kind)
    found = gathered(
        polylines=str(tmp_path / f"lines{suffix}"), polygons=tmp_path / f"areas{suffix}"
    )
    assert found.polyline.tolist() == [0, 0, 1, 1] + [-1] * 16
    assert found.polygon.tolist() == [-1] * 4 + [0] * 8 + [1] * 8
    assert found.winding[4:].any(axis=1).all()
    tri = constrained_delaunay(SQUARE, polygons=[tmp_path / f"areas{suffix}"], carve="holes")
    assert tri.nsimplex == 8
    rings = gathered(polylines=tmp_path / f"areas{suffix}")
    assert len(rings.edges) == 16


def test_a_file_of_the_wrong_kind(tmp_path: Path) -> None:
    for shape, name in ((shapely.Point(1, 1), "point"), (LINE, "line")):
        geopandas.GeoSeries([shape], crs=4326).to_file(tmp_path / f"{name}.geojson")
    with pytest.raises(liftmesh.FormatError, match=r"point.geojson: there is no line"):
        gathered(polylines=tmp_path / "point.geojson")
    with pytest.raises(liftmesh.FormatError, match=r"line.geojson: there is no polygon .* closes"):
        gathered(polygons=tmp_path / "line.geojson")
    with pytest.raises(FileNotFoundError):
        gathered(polygons="missing.gpkg")
    (tmp_path / "odd.geojson").write_text('{"type": "LineString", "coordinates": 3}')
    with pytest.raises(liftmesh.FormatError, match=r"odd.geojson: no GeoJSON"):
        gathered(polylines=tmp_path / "odd.geojson")


def test_edges_come_first_then_polylines_then_polygons() -> None:
    found = gathered(edges=[[0, 2]], polylines=[[0, 1, 2]], polygons=[[[0, 1, 2], [2, 1, 0]]])
    assert found.edges.tolist()[:3] == [[0, 2], [0, 1], [1, 2]]
    assert found.polyline.tolist() == [-1, 0, 0, *[-1] * 6]
    assert found.polygon.tolist() == [*[-1] * 3, *[0] * 6]
    assert found.winding.tolist() == [[0, 0]] * 3 + [[1, 0]] * 3 + [[0, -1]] * 3
    assert found.bounds.tolist() == [False] * 3 + [True] * 6
    assert found.named(0) == "edge 0"
    assert gathered(edges=[[0, 2]], polylines=[[0, 1, 0]]).bounds.tolist() == [True, False, False]
    assert gathered(polylines=[[0, 1, 0], [2, 3]]).bounds.tolist() == [True, True, False]


@pytest.mark.parametrize("scale", [5e-324, 1e-300, 1.0, 1e100, 2.0**1022])
@pytest.mark.parametrize("shift", [0, 1])
@pytest.mark.parametrize("turned", [False, True])
def test_which_way_rings_turn(scale: float, shift: int, turned: bool) -> None:
    ring = (np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0, 1]], dtype=float) + shift) * scale
    if scale == 1e100:
        ring = ring + np.array([[0, 0], [0, 0], [0, 1e-3], [0, 0], [0, 0]]) * scale
    rings = [ring[::-1] if turned else ring] * 2
    found = gathered(polygons=[rings])
    sign = -1 if turned else 1
    assert found.winding.tolist() == [[sign, 0]] * 5 + [[0, sign]] * 5


def test_thin_rings_turn_exactly() -> None:
    """A sliver whose doubled area is far below the rounding of its products; and none at all."""
    a, b = np.array([1.0, 1.0]), np.array([2.0**30 + 1, 2.0**30 + 1])
    middle = np.array([2.0**29, np.nextafter(2.0**29, np.inf)])
    for ring, sign in (([a, b, middle], 1), ([b, a, middle], -1), ([a, b, (a + b) / 2], 1)):
        assert gathered(polygons=[ring]).winding.tolist() == [[sign, 0]] * 3


def test_a_ring_without_area_is_a_constraint_alone() -> None:
    tri = constrained_delaunay(SQUARE, polygons=[SQUARE, [[0, 0], [1, 1], [2, 2]]], carve="holes")
    assert [0, 4] in tri.constraints.tolist()
    assert tri.nsimplex == 6


def test_rings_that_touch_themselves() -> None:
    """A hole that hangs on the outer ring, as one ring."""
    ring = [[0, 0], [4, 0], [4, 4], [0, 4], [0, 0], [1, 2], [2, 1]]
    tri = constrained_delaunay([[9, 9]], polygons=[ring], carve="holes")
    assert tri.find_simplex([[1, 1.2], [3, 3], [0.2, 0.1]]).tolist()[0] == -1
    assert (tri.find_simplex([[3, 3], [0.2, 0.02]]) >= 0).all()


@settings(deadline=None, max_examples=50)
@given(st.integers(0, 2**32 - 1))
def test_positions_are_matched_exactly(seed: int) -> None:
    rng = np.random.default_rng(seed)
    points, corners = (rng.integers(-2, 3, (k, 2)).astype(float) for k in rng.integers(1, 12, 2))
    points[rng.random(points.shape) < 0.1] = np.nan
    points[points == 0] *= -1.0
    rows, added = match_rows(points, corners)
    known = [tuple(each) for each in points.tolist()]
    new: list[tuple[float, ...]] = []
    for row, corner in zip(rows.tolist(), map(tuple, corners.tolist()), strict=True):
        if corner not in known:
            known.append(corner)
            new.append(corner)
        assert row == known.index(corner)
    assert list(map(tuple, corners[added].tolist())) == new


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"polylines": 5}, "polylines are 5: give a list of polylines"),
        (
            {"polylines": [[0, 0], [3, 3], [4, 4]]},
            "pairs of integers, .* as edges=, and corners as",
        ),
        ({"polylines": np.array([[0, 1], [2, 3]])}, "polylines are .*, pairs of integers"),
        (
            {"polylines": [[0, 0, 5], [3, 3, 5]]},
            "polylines are .*, triples of integers, .*: give a list of arrays of rows, or corners",
        ),
        ({"polygons": [[0, 0, 5], [3, 0, 5], [3, 3, 5]]}, "polygons are .*, triples of integers"),
        ({"polygons": np.arange(9).reshape(3, 3)}, "triples of integers"),
        ({"polylines": "missing"}, None),
        ({"polylines": [0, 1, 7]}, "polyline 0 has the row 7, where 0 to 3 are possible"),
        ({"polylines": [[0, 1], [0]]}, r"polyline 1 is \[0\]: give 2 rows or more"),
        ({"polylines": [[0, 1], [0.5, 2.0]]}, "polyline 1 is .*give whole numbers"),
        ({"polylines": [[[0, 0], [float("nan"), 1]]]}, "a corner of polyline 0 is not finite"),
        ({"polylines": [[[0, 0], [1]]]}, "polyline 0 cannot be converted to an array"),
        ({"polylines": [[["a", "b"], ["c", "d"]]]}, "polyline 0 cannot be read"),
        ({"polylines": [np.ma.masked_equal([0, 1], 1)]}, "polyline 0 is a masked array"),
        ({"polylines": [shapely.Point(0, 0)]}, "there is no line in what is given"),
        ({"polylines": {"type": "LineString", "coordinates": 3}}, "no GeoJSON"),
        ({"polygons": [[0, 1]]}, "a ring of polygon 0 .*needs three corners|give 3 rows"),
        ({"polygons": [[[0, 0], [1, 1]]]}, "a ring of polygon 0 needs three corners"),
        ({"polygons": [SQUARE, []]}, r"polygon 1 is \[\], without a ring"),
        ({"polygons": [[[0, 1, 2], [1, 2, 3], [0, 1, 2]]]}, "rings of three rows or corners x, y,"),
        ({"polygons": [[SQUARE, [0, -2, 1]]]}, "a ring of polygon 0 has the row -2"),
        ({"polygons": [LINE]}, "there is no polygon in what is given"),
        ({"polygons": [shapely.Point(0, 0)]}, "there is no polygon in what is given"),
        ({"polygons": {"type": "Feature", "geometry": None}}, "there is no polygon in what is"),
        ({"polygons": 1.5}, "polygons are 1.5"),
    ],
)
def test_wrong_lines_are_named(options: dict[str, Any], said: str | None) -> None:
    error = liftmesh.InputError if said else FileNotFoundError
    with pytest.raises(error, match=said):
        gathered(**options)


def test_arrays_of_three_rows_are_rows() -> None:
    triangles = np.array([[0, 1, 2], [0, 2, 3], [1, 2, 3]])
    found = gathered(polygons=list(triangles), polylines=list(triangles))
    assert (len(found.added), found.edges[:2].tolist()) == (0, [[0, 1], [1, 2]])
    assert len(gathered(polygons=triangles[:2].tolist()).added) == 0  # too few for corners


def test_holes_that_share_all_corners_may_differ() -> None:
    corners = [[1, 1], [2, 1], [2, 2], [1, 2], [1.5, 1.75]]
    other = [corners[k] for k in (0, 4, 1, 2, 3)]
    assert len(gathered(polygons=[[SQUARE, corners, other]]).added) == 5


def test_a_hole_as_large_as_its_polygon_is_named() -> None:
    with pytest.raises(liftmesh.InputError, match="the holes of polygons cover all of these"):
        constrained_delaunay([], polygons=[[SQUARE, SQUARE[::-1]]], carve="holes")


def test_rings_of_rows_that_are_not_finite() -> None:
    points = [*SQUARE, [float("nan"), 1]]
    with pytest.raises(liftmesh.NonFiniteError):
        constrained_delaunay(points, polygons=[[0, 1, 4]])
    with pytest.raises(liftmesh.InputError, match=r"2 edges end .*edge 1 \(of polygon 0\), \[1, 4"):
        constrained_delaunay(points, polygons=[[0, 1, 4]], nonfinite="skip")


def test_too_many_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(constraints, "MOST_ROWS", 4)
    assert len(gathered(polylines=[SQUARE]).added) == 0
    with pytest.raises(liftmesh.InputError, match="2 edges of 5 rows are more than 32-bit"):
        gathered(polylines=[LINE])


def test_empty_lists_are_no_constraints() -> None:
    found = gathered(edges=[], polylines=[], polygons=[])
    assert len(found.edges) == len(found.bounds) == len(found.added) == 0
    assert gathered(edges=np.empty((0, 2))).edges.shape == (0, 2)


def test_corners_of_lines_are_points_enough() -> None:
    tri = constrained_delaunay([], polygons=[SQUARE], carve="holes")
    assert tri.points.tolist() == SQUARE
    assert tri.added.tolist() == [0, 1, 2, 3]
    with pytest.raises(liftmesh.DegenerateInputError, match="0 rows"):
        constrained_delaunay([])


def test_added_rows_follow() -> None:
    tri = constrained_delaunay(
        [*SQUARE, [3.0, 0.0]],
        [[0, 4]],
        polylines=[[[3, 0], [1, 1]], [[1, 1], [-0.0, 3]]],
        polygons=[[[1, 1], [2, 1], [2, 2]]],
    )
    assert tri.added.tolist() == [5, 6, 7]
    assert tri.points[tri.added].tolist() == [[1, 1], [2, 1], [2, 2]]
    assert tri.input_edges.tolist() == [[0, 4], [1, 5], [5, 3], [5, 6], [6, 7], [7, 5]]
    assert tri.constraints.tolist()[0] == [0, 1]
