"""Points of geopandas: GeoDataFrames and GeoSeries, wherever points are taken."""

from __future__ import annotations

from pathlib import Path

import geopandas as gpd
import numpy as np
import pytest
from shapely import LineString, Point

import liftmesh
from liftmesh import InputError

XYZ = np.array([[0, 0, 5], [8, 0, 6], [0, 8, 7], [9, 9, 8.5]])


def frame(points: np.ndarray = XYZ, **columns: object) -> gpd.GeoDataFrame:
    return gpd.GeoDataFrame(columns, geometry=gpd.points_from_xy(*points.T), crs=25832)


def test_a_frame_is_a_cloud_with_columns_and_system() -> None:
    found = liftmesh.as_cloud(frame(intensity=[1, 2, 3, 4], kind=["a", "b", "c", "d"], x=[9] * 4))
    assert found.points.tolist() == XYZ.tolist()
    assert found.crs == "EPSG:25832"
    assert found.attributes["intensity"].tolist() == [1, 2, 3, 4]
    assert "column x" in found.metadata["not_read"]
    assert any("kind" in each for each in found.metadata["not_read"])
    surface = liftmesh.triangulate(frame(red=[1] * 4, green=[2] * 4, blue=[255] * 4))
    assert surface.crs == "EPSG:25832"
    assert surface.colors is not None
    assert surface.colors[0].tolist() == [1, 2, 255]


def test_heights_may_be_a_column() -> None:
    planar = frame(XYZ[:, :2], elevation=XYZ[:, 2])
    assert liftmesh.as_cloud(planar).points.tolist() == XYZ.tolist()
    named = frame(XYZ[:, :2], h2=XYZ[:, 2])
    assert liftmesh.as_cloud(named, columns="x=x,y=y,z=h2").points.tolist() == XYZ.tolist()
    with pytest.raises(InputError, match="height"):
        liftmesh.as_cloud(frame(XYZ[:, :2], h2=XYZ[:, 2]))
    assert liftmesh.as_cloud(frame(XYZ[:, :2]), flat=True).points[:, 2].tolist() == [0] * 4


def test_another_geometry_and_a_series() -> None:
    renamed = frame().rename_geometry("place")
    assert liftmesh.as_cloud(renamed).points.tolist() == XYZ.tolist()
    series = frame().geometry
    assert liftmesh.as_cloud(series).points.tolist() == XYZ.tolist()
    assert liftmesh.as_cloud(series).crs == "EPSG:25832"


def test_every_function_takes_them() -> None:
    points, planar = frame(), XYZ[:, :2]
    expected = liftmesh.delaunay(planar)
    assert np.array_equal(liftmesh.delaunay(points).simplices, expected.simplices)
    assert np.array_equal(liftmesh.delaunay(points.geometry).simplices, expected.simplices)
    assert np.array_equal(
        liftmesh.regular(points, weights=np.zeros(4)).simplices, expected.simplices
    )
    assert liftmesh.verify(points, expected.simplices).valid
    assert len(liftmesh.voronoi(points, domain=(-1, -1, 10, 10))) == 4
    assert len(liftmesh.lower_hull(points).faces)
    assert len(liftmesh.apollonius(frame(planar), np.ones(4)).centers) == 4
    dynamic = liftmesh.DynamicTriangulation(points)
    assert len(dynamic) == 4
    surface = liftmesh.triangulate(points)
    assert surface.sample(points).tolist() == XYZ[:, 2].tolist()
    assert liftmesh.constrained_delaunay(points, [[0, 3]]).constraints.tolist() == [[0, 3]]


def test_points_in_another_system_than_the_surface_are_refused(tmp_path: Path) -> None:
    surface = liftmesh.triangulate(frame())
    elsewhere = frame().to_crs(25833)
    line = {"spacing": 1, "half_width": 1}
    for points in (elsewhere, elsewhere.geometry):
        for name in ("sample", "weights", "gradient", "slope", "aspect", "height_above",
                     "accuracy", "profile"):  # fmt: skip
            with pytest.raises(InputError, match=r"zone 33N.*zone 32N.*: transform one of them"):
                getattr(surface, name)(points)
        with pytest.raises(InputError, match="transform one of them"):
            surface.interpolator()(points)
        with pytest.raises(InputError, match="transform one of them"):
            surface.cross_sections(points, **line)
    tiled = liftmesh.tile_surface(frame(), tmp_path / "out")
    with pytest.raises(InputError, match="transform one of them"):
        tiled.sample(elsewhere)
    unstated = gpd.GeoDataFrame(geometry=gpd.points_from_xy(*XYZ.T))
    for points in (unstated, unstated.set_crs(5972)):  # the same plane, with heights
        assert surface.sample(points).tolist() == XYZ[:, 2].tolist()
    side = liftmesh.triangulate(frame(), plane="xz")  # in whose plane there is no such system
    middle = frame(XYZ[:, [0, 2]].mean(axis=0)[None]).set_crs(25833, allow_override=True)
    assert np.isfinite(side.sample(middle)).all()


@pytest.mark.parametrize(
    ("shapes", "cause"),
    [
        ([Point(0, 0, 1), LineString([(0, 0), (1, 1)])], "row 1 is LineString: give points"),
        ([Point(0, 0, 1), None], "row 1 is nothing: give points"),
        ([Point(0, 0, 1).buffer(1)], "row 0 is Polygon"),
    ],
)
def test_other_geometries_are_refused(shapes: list, cause: str) -> None:
    for call in (liftmesh.as_cloud, liftmesh.delaunay, liftmesh.triangulate):
        with pytest.raises(InputError, match=cause):
            call(gpd.GeoDataFrame(geometry=shapes))


@pytest.mark.parametrize("columns", [{}, {"depth": [1, 2, 3, 4]}, {"a": [1] * 4, "b": [2] * 4}])
def test_heights_are_those_of_the_points_whatever_columns_there_are(columns: dict) -> None:
    table = frame(**columns)
    surface = liftmesh.triangulate(XYZ - [0, 0, 2], crs="EPSG:25832")
    assert surface.height_above(table).tolist() == [2, 2, 2, 2]
    assert surface.accuracy(table).mean == -2
    flat = gpd.GeoDataFrame(columns, geometry=gpd.points_from_xy(*XYZ.T[:2]), crs="EPSG:25832")
    with pytest.raises(InputError, match=r"height|no z"):
        surface.height_above(flat)
    assert len(liftmesh.merge([table, table])) == 8
    with pytest.raises(InputError, match="clouds is one GeoDataFrame: give a list of clouds"):
        liftmesh.merge(table)


@pytest.mark.parametrize("suffix", ["gpkg", "geojson", "shp"])
def test_files_of_geometries_are_clouds(tmp_path: Path, suffix: str) -> None:
    table = frame(class_=[1, 2, 3, 4], kind=["a", "b", "c", "d"], red=[9] * 4)
    table.to_file(tmp_path / f"a.{suffix}")
    found = liftmesh.read(tmp_path / f"a.{suffix}")
    expected = liftmesh.as_cloud(gpd.read_file(tmp_path / f"a.{suffix}"))
    assert found.points.tolist() == expected.points.tolist() == XYZ.tolist()
    assert found.crs == expected.crs == "EPSG:25832"
    assert found.attributes.keys() == expected.attributes.keys()
    for name, values in expected.attributes.items():
        assert found.attributes[name].tolist() == values.tolist()
    assert any("column kind" in each for each in found.metadata["not_read"])


def test_files_of_other_geometries_say_how_they_become_clouds(tmp_path: Path) -> None:
    with pytest.raises(liftmesh.FormatError, match=r"'fgb', but points that geopandas.read_file"):
        liftmesh.read(tmp_path / "a.fgb")


def test_empty_points_are_not_finite() -> None:
    points = gpd.GeoDataFrame(geometry=[*gpd.points_from_xy(*XYZ.T), Point()])
    with pytest.raises(InputError, match="row 4"):
        liftmesh.triangulate(points)
    assert liftmesh.triangulate(points, nonfinite="skip").report.n_skipped == 1


def test_a_frame_without_geometries_is_a_table() -> None:
    table = gpd.GeoDataFrame({"x": [0.0, 1, 0], "y": [0.0, 0, 1], "z": [1.0, 2, 3]})
    assert liftmesh.as_cloud(table).points.tolist() == [[0, 0, 1], [1, 0, 2], [0, 1, 3]]
