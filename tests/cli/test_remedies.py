"""What errors and notes recommend works, and what a surface leaves out is said."""

from __future__ import annotations

from operator import attrgetter
from pathlib import Path
from typing import Any

import geopandas
import numpy as np
import pandas as pd
import pytest
from commands import liftmesh as command

import liftmesh
from liftmesh import InputError
from liftmesh.crs.transformation import transform

XYZ = np.array([[0.0, 0.0, 5.0], [4, 0, 6], [0, 3, 7], [4.5, 3, 9]])


def geometric(kind: str) -> Any:
    points = geopandas.points_from_xy(*XYZ.T)
    return geopandas.GeoSeries(points) if kind == "GeoSeries" else geopandas.GeoDataFrame(
        {"temp": [1.0, 2, 3, 4]}, geometry=points
    )  # fmt: skip


@pytest.mark.parametrize("kind", ["GeoSeries", "GeoDataFrame"])
def test_points_of_geopandas_are_the_table_of_their_coordinates(kind: str) -> None:
    points = geometric(kind)
    for each in (points, points.get_coordinates(include_z=True)):
        np.testing.assert_array_equal(liftmesh.triangulate(each).vertices, XYZ)


@pytest.mark.parametrize("kind", ["GeoSeries", "GeoDataFrame"])
@pytest.mark.parametrize(
    "name", ["delaunay", "lower_hull", "lift", "scipy.Delaunay", "scipy.Voronoi"]
)
def test_lists_of_geometries_are_no_rows_of_numbers(name: str, kind: str) -> None:
    function, points = attrgetter(name)(liftmesh), geometric(kind)
    function(points.get_coordinates(include_z=name == "lower_hull").to_numpy())
    with pytest.raises(InputError, match=r"give what shapely\.get_coordinates\(points\) returns"):
        function(list(points.geometry))


def test_where_heights_do_not_matter_a_table_needs_none() -> None:
    table = pd.DataFrame({"x": XYZ[:, 0], "y": XYZ[:, 1], "temp": [1.0, 2, 3, 4]})
    expected = liftmesh.delaunay(XYZ).simplices
    np.testing.assert_array_equal(liftmesh.delaunay(table).simplices, expected)
    assert len(liftmesh.regular(table, weights=np.zeros(4)).simplices) == len(expected)
    for function in (liftmesh.triangulate, liftmesh.lower_hull):
        with pytest.raises(InputError, match="is known as the height z, and 'temp' holds numbers"):
            function(table)


def test_a_raster_is_what_its_file_is(tmp_path: Path) -> None:
    raster = liftmesh.triangulate(XYZ).raster(0.5)
    raster.save(tmp_path / "a.tif")
    named = liftmesh.simplify(tmp_path / "a.tif", max_error=1)
    assert liftmesh.simplify(raster, max_error=1).faces.tolist() == named.faces.tolist()


def test_heights_of_a_grid_become_rows() -> None:
    y, x = np.mgrid[:6, :7]
    z = np.sin(x) + y
    with pytest.raises(
        InputError, match=r"np.column_stack\(\[x.ravel\(\), y.ravel\(\), z.ravel\(\)"
    ):
        liftmesh.simplify(z, max_error=0.1)
    rows = np.column_stack([x.ravel(), y.ravel(), z.ravel()])
    assert len(liftmesh.simplify(rows, max_error=0.1).faces)


def test_a_system_without_heights_is_not_asked_for_one_without() -> None:
    cause = r"where the rows are, .*: give another one of the file with src_crs=$"
    with pytest.raises(InputError, match=cause):
        transform(np.array([[-100.0, 40.0, 0.0]]), "EPSG:4267", "EPSG:4269")


def test_overhangs_that_a_surface_leaves_out_are_said(tmp_path: Path) -> None:
    rows = np.vstack([XYZ, XYZ[:2] + np.array([0, 0, 9])])
    np.savetxt(tmp_path / "wall.xyz", rows)
    for words in (("volume", "wall.xyz"), ("contour", "wall.xyz", "c.geojson", "--interval", "1"),
                  ("raster", "wall.xyz", "r.tif", "--resolution", "1")):  # fmt: skip
        done = command(*words, cwd=tmp_path)
        assert "wall.xyz: 2 overhangs left out: where rows share x and y" in done.stderr
    np.savetxt(tmp_path / "bare.xyz", XYZ)
    assert "overhang" not in command("volume", "bare.xyz", cwd=tmp_path).stderr
    done = command("triangulate", "wall.xyz", "high.ply", "--on-duplicate", "highest", cwd=tmp_path)
    assert done.returncode == 0
    assert "overhang" not in command("volume", "high.ply", cwd=tmp_path).stderr


def test_contours_over_long_faces_are_said(tmp_path: Path) -> None:
    y, x = np.mgrid[:20, :20].reshape(2, -1)
    rows = np.vstack([np.column_stack([x, y, x]), [[90, 10, 3]]])
    np.savetxt(tmp_path / "far.xyz", rows)
    np.savetxt(tmp_path / "near.xyz", rows[:-1])
    words = ("lines.geojson", "--interval", "5", "--overwrite")
    done = command("contour", "far.xyz", *words, cwd=tmp_path)
    assert " faces with a side longer than 20, 20 times the median: " in done.stderr
    for given in (("far.xyz", *words, "--max-edge", "20"), ("near.xyz", *words)):
        assert "times the median" not in command("contour", *given, cwd=tmp_path).stderr
