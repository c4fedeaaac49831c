"""Triangles and cells with the signatures of shapely, beside shapely's own."""

from __future__ import annotations

import geopandas
import numpy as np
import pytest
import shapely
from hypothesis import given, strategies as st
from shapely import MultiPoint, Polygon

import liftmesh
from liftmesh.plugins import shapely as ours

RNG = np.random.default_rng(8)
POINTS = RNG.random((300, 2))
MANY = MultiPoint(POINTS)
SMALL = (
    None,
    MultiPoint(),
    shapely.Point(0, 0),
    MultiPoint([(0, 0), (1, 0)]),
    MultiPoint([(0, 0), (2, 2), (1, 1), (1, 1)]),
    MultiPoint([(0, 0), (0, 0)]),
    MultiPoint([(0, 0, 1), (1, 0, 2), (0, 1, 3)]),
    shapely.box(0, 0, 1, 1),
    shapely.LineString([(0, 0), (3, 1), (2, 5)]),
)
whole = st.lists(st.tuples(*[st.integers(0, 6)] * 2), min_size=2, max_size=14)


def same(a: shapely.Geometry, b: shapely.Geometry, tolerance: float = 1e-9) -> bool:
    return shapely.equals_exact(a, b, tolerance=tolerance, normalize=True)


class TestDelaunay:
    @pytest.mark.parametrize("only_edges", [False, True])
    def test_is_that_of_shapely(self, only_edges: bool) -> None:
        found = ours.delaunay_triangles(MANY, only_edges=only_edges)
        assert same(found, shapely.delaunay_triangles(MANY, only_edges=only_edges), 0.0)

    @pytest.mark.parametrize("shape", SMALL)
    @pytest.mark.parametrize("only_edges", [False, True])
    def test_small_ones(self, shape, only_edges: bool) -> None:
        found = ours.delaunay_triangles(shape, only_edges=only_edges)
        expected = shapely.delaunay_triangles(shape, only_edges=only_edges)
        if shape is None:
            assert found is None
            return
        assert found.geom_type == expected.geom_type
        assert len(shapely.get_parts(found)) == len(shapely.get_parts(expected))
        assert shapely.has_z(found) == shapely.has_z(expected)
        assert shapely.equals(shapely.union_all(found), shapely.union_all(expected))

    @given(whole)
    def test_triangles_fill_the_hull(self, rows: list[tuple[int, int]]) -> None:
        points = MultiPoint(rows)
        triangles = ours.delaunay_triangles(points)
        assert all(each.exterior.is_ccw for each in triangles.geoms)
        assert sum(each.area for each in triangles.geoms) == points.convex_hull.area
        again = ours.delaunay_triangles(MultiPoint(rows[::-1]))
        assert same(triangles, again, 0.0)

    def test_arrays_are_broadcast(self) -> None:
        given_shapes = np.array([MANY, None, shapely.box(0, 0, 1, 1)])
        found = ours.delaunay_triangles(given_shapes[:, None], only_edges=[False, True])
        assert found.shape == (3, 2)
        assert found[1].tolist() == [None, None]
        assert [each.geom_type for each in found[2]] == ["GeometryCollection", "MultiLineString"]
        assert ours.delaunay_triangles([MANY], tolerance=np.nan).tolist() == [None]

    def test_tolerance(self) -> None:
        corners = shapely.get_coordinates(ours.delaunay_triangles(MANY, tolerance=0.1))
        kept = np.unique(corners, axis=0)
        apart = np.hypot(*(kept[:, None] - kept).T)
        assert apart[apart > 0].min() >= 0.1
        assert np.hypot(*(POINTS[:, None] - kept).T).min(axis=0).max() < 0.1

    def test_errors(self) -> None:
        with pytest.raises(TypeError, match="shapely's geometries are needed, not str"):
            ours.delaunay_triangles("POINT (0 0)")
        with pytest.raises(liftmesh.NonFiniteError, match=r"row 1\b"):
            ours.delaunay_triangles(MultiPoint([(0, 0), (np.inf, 1), (1, 0)]))
        with pytest.raises(liftmesh.InputError, match=r"tolerance is -1\.0: give 0 or a positive"):
            ours.voronoi_polygons(MANY, tolerance=-1.0)


class TestVoronoi:
    @pytest.mark.parametrize("extend_to", [None, shapely.box(-9, 0, 2, 3), Polygon()])
    def test_is_that_of_shapely(self, extend_to) -> None:
        options = {"extend_to": extend_to, "ordered": True}
        found = ours.voronoi_polygons(MANY, **options)
        expected = shapely.voronoi_polygons(MANY, **options)
        for mine, theirs in zip(found.geoms, expected.geoms, strict=True):
            assert mine.symmetric_difference(theirs).area < 1e-12
        mine, theirs = (
            lib.voronoi_polygons(MANY, only_edges=True, extend_to=extend_to)
            for lib in (ours, shapely)
        )
        assert len(mine.geoms) == len(theirs.geoms)
        assert mine.length == pytest.approx(theirs.length, rel=1e-12)

    @pytest.mark.parametrize("shape", SMALL)
    @pytest.mark.parametrize("only_edges", [False, True])
    def test_small_ones(self, shape, only_edges: bool) -> None:
        found = ours.voronoi_polygons(shape, only_edges=only_edges)
        expected = shapely.voronoi_polygons(shape, only_edges=only_edges)
        if shape is None:
            assert found is None
            return
        assert found.geom_type == expected.geom_type
        assert same(found, expected)

    @given(whole)
    def test_each_coordinate_has_its_cell(self, rows: list[tuple[int, int]]) -> None:
        cells = ours.voronoi_polygons(MultiPoint(rows), ordered=True)
        if len({*rows}) < 2:
            assert cells.is_empty
            return
        first = {row: place for place, row in reversed([*enumerate(rows)])}
        for place, (row, cell) in enumerate(zip(rows, cells.geoms, strict=True)):
            assert cell.is_empty == (first[row] != place)
            assert cell.is_empty or cell.contains(shapely.Point(row))
        box = shapely.box(*shapely.total_bounds(cells))
        assert sum(cell.area for cell in cells.geoms) == pytest.approx(box.area)

    def test_cells_do_not_overlap(self) -> None:
        points = MultiPoint(np.round(RNG.random((400, 2)), 2) * 1e-3 + 5e5)
        cells = ours.voronoi_polygons(points)
        assert shapely.coverage_is_valid(shapely.get_parts(cells))

    def test_tolerance(self) -> None:
        cells = shapely.get_parts(ours.voronoi_polygons(MANY, tolerance=0.1, ordered=True))
        assert len(cells) == len(POINTS)
        left = POINTS[~shapely.is_empty(cells)]
        apart = np.hypot(*(left[:, None] - left).T)
        assert apart[apart > 0].min() >= 0.1


class TestConstrained:
    def test_holes_that_touch(self) -> None:
        shape = Polygon(
            [(0, 0), (4, 0), (4, 4), (0, 4)],
            [[(0, 2), (1, 1), (2, 2), (1, 3)], [(2, 2), (3, 1), (3, 3)]],
        )
        triangles = ours.constrained_delaunay_triangles(shape)
        assert sum(each.area for each in triangles.geoms) == shape.area
        assert shapely.equals(shapely.union_all(triangles), shape)

    @given(st.integers(3, 40), st.integers(0, 2**32 - 1))
    def test_a_star_is_filled(self, count: int, seed: int) -> None:
        rng = np.random.default_rng(seed)
        turn = np.linspace(0, 2 * np.pi, count, endpoint=False)
        ring = (np.stack([np.cos(turn), np.sin(turn)]) * rng.uniform(1, 9, count)).T
        shape = Polygon(ring)
        triangles = ours.constrained_delaunay_triangles(shape)
        assert len(triangles.geoms) == count - 2
        assert sum(each.area for each in triangles.geoms) == pytest.approx(shape.area)
        theirs = shapely.constrained_delaunay_triangles(shape)
        assert same(triangles, theirs)

    def test_kinds(self) -> None:
        box, line = shapely.box(0, 0, 1, 1), shapely.LineString([(0, 0), (1, 1)])
        nested = shapely.GeometryCollection(
            [shapely.MultiPolygon([box, shapely.box(2, 2, 3, 4)]), line]
        )
        found = ours.constrained_delaunay_triangles([box, nested, line, None, Polygon()])
        assert [len(each.geoms) for each in found[:3]] == [2, 4, 0]
        assert found[3] is None
        assert found[4].is_empty
        high = Polygon([(0, 0, 5), (1, 0, 6), (0, 1, 7)])
        assert same(ours.constrained_delaunay_triangles(high).geoms[0], high, 0.0)

    def test_a_polygon_that_crosses_itself(self) -> None:
        bow = Polygon([(0, 0), (2, 2), (2, 0), (0, 2)])
        with pytest.raises(liftmesh.CrossingError, match=r"\(1\.0, 1\.0\).*make_valid"):
            ours.constrained_delaunay_triangles(bow)


class TestTables:
    FRAME = geopandas.GeoDataFrame(
        {"name": ["a", "b", "c", "d"]},
        geometry=geopandas.points_from_xy([0, 2, 0, 0], [0, 0, 2, 0], crs=25832),
        index=[7, 5, 3, 1],
    )

    def test_each_row_has_its_cell(self) -> None:
        cells = ours.voronoi_polygons(self.FRAME)
        assert (cells.index == self.FRAME.index).all()
        assert (cells.crs, cells["name"].tolist()) == (self.FRAME.crs, ["a", "b", "c", "d"])
        assert cells.area.tolist() == [9.0, 13.5, 13.5, 0.0]
        series = ours.voronoi_polygons(self.FRAME.geometry)
        assert series.geom_equals(cells.geometry).all()
        edges = ours.voronoi_polygons(self.FRAME, only_edges=True)
        assert (len(edges), edges.crs) == (3, self.FRAME.crs)

    def test_of_other_geometries_each_vertex(self) -> None:
        boxes = self.FRAME.set_geometry(self.FRAME.buffer(0.5, cap_style="square"))[:3]
        cells = ours.voronoi_polygons(boxes)
        assert cells.index.tolist() == [7] * 5 + [5] * 5 + [3] * 5
        assert np.count_nonzero(cells.area > 0) == 12
        missing = self.FRAME.copy()
        missing.loc[[5, 1], "geometry"] = [None, shapely.Point()]
        cells = ours.voronoi_polygons(missing)
        assert cells["name"].tolist() == ["a", "b", "c", "d"]
        assert cells.area.tolist() == [12.0, 0.0, 12.0, 0.0]
        nothing = ours.voronoi_polygons(self.FRAME[:1])
        assert nothing.geometry.is_empty.tolist() == [True]

    def test_triangles(self) -> None:
        triangles = ours.delaunay_triangles(self.FRAME)
        expected = self.FRAME.delaunay_triangles()
        assert (triangles.crs, len(triangles)) == (self.FRAME.crs, len(expected))
        assert shapely.equals(triangles.union_all(), expected.union_all())
        boxes = self.FRAME.set_geometry(self.FRAME.buffer(0.5, cap_style="square"))
        inside = ours.constrained_delaunay_triangles(boxes)
        assert (inside.index == boxes.index).all()
        assert (inside.crs, inside["name"].tolist()) == (boxes.crs, boxes["name"].tolist())
        assert all(len(each.geoms) == 2 for each in inside.geometry)
